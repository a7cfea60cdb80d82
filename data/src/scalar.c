/* SPDX-License-Identifier: BSD-3-Clause
 * Scalar: from a selector such as "velocity:mag" to one number per point or tet. */
#include <cellist/mesh.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAGNITUDE = -1 };

static const cellist_field *find_field(const cellist_mesh_arrays *arrays, const char *name, size_t name_length) {
  for (int pass = CELLIST_ON_POINTS; pass <= CELLIST_ON_CELLS; pass++)
    for (size_t i = 0; i < arrays->field_count; i++) {
      const cellist_field *field = &arrays->fields[i];
      if ((int)field->association == pass && strlen(field->name) == name_length &&
          memcmp(field->name, name, name_length) == 0)
        return field;
    }
  return NULL;
}

static cellist_result fail_not_found(cellist_context *context, const cellist_mesh_arrays *arrays,
                                     const char *selector) {
  char list[512] = "";
  size_t length = 0;
  for (size_t i = 0; i < arrays->field_count && length < sizeof list - 1; i++) {
    const cellist_field *field = &arrays->fields[i];
    const int written = snprintf(list + length, sizeof list - length, "%s%s (%s, %u component%s)", i > 0 ? ", " : "",
                                 field->name, field->association == CELLIST_ON_POINTS ? "points" : "cells",
                                 field->component_count, field->component_count == 1 ? "" : "s");
    length += written > 0 ? (size_t)written : 0;
  }
  return cellist_fail(context, CELLIST_ERROR_NOT_FOUND, "no scalar '%s'; there %s%s", selector,
                      arrays->field_count > 0 ? "are: " : "are none", list);
}

/* The field and the component (or MAGNITUDE) that the selector names. A field whose own name holds a colon wins. */
static cellist_result resolve(cellist_context *context, const cellist_mesh_arrays *arrays, const char *selector,
                              const cellist_field **field, int *component) {
  *component = MAGNITUDE;
  *field = find_field(arrays, selector, strlen(selector));
  if (*field != NULL) return CELLIST_SUCCESS;
  const char *colon = strrchr(selector, ':');
  if (colon != NULL) *field = find_field(arrays, selector, (size_t)(colon - selector));
  if (*field == NULL) return fail_not_found(context, arrays, selector);
  if (strcmp(colon + 1, "mag") == 0) return CELLIST_SUCCESS;
  char *end = NULL;
  const long index = strtol(colon + 1, &end, 10);
  if (end == colon + 1 || *end != '\0' || index < 0 || index >= (long)(*field)->component_count)
    return cellist_fail(context, CELLIST_ERROR_NOT_FOUND, "no scalar '%s': %s has components 0 to %u, and mag",
                        selector, (*field)->name, (*field)->component_count - 1);
  *component = (int)index;
  return CELLIST_SUCCESS;
}

static double value_of(const cellist_field *field, int component, size_t i) {
  const double *v = &field->values[i * field->component_count];
  if (component != MAGNITUDE) return v[component];
  if (field->component_count == 1) return v[0];
  double length = 0; /* hypot step by step: no overflow, no underflow */
  for (uint32_t k = 0; k < field->component_count; k++) length = hypot(length, v[k]);
  return length;
}

static void include(cellist_scalar *scalar, double value, bool *any) {
  if (!*any || value < scalar->minimum) scalar->minimum = value;
  if (!*any || value > scalar->maximum) scalar->maximum = value;
  *any = true;
}

static void measure(const cellist_mesh_arrays *arrays, cellist_scalar *scalar) {
  bool any = false;
  for (size_t i = 0; i < arrays->tet_count; i++) {
    bool finite = true;
    for (int k = 0; k < 4; k++) {
      const size_t at = scalar->association == CELLIST_ON_POINTS ? arrays->tets[4 * i + (size_t)k] : i;
      if (isfinite(scalar->values[at]))
        include(scalar, scalar->values[at], &any);
      else
        finite = false;
    }
    scalar->nan_cell_count += !finite;
  }
}

cellist_result cellist_scalar_select(cellist_context *context, const cellist_mesh *mesh, const char *selector,
                                     cellist_scalar *scalar) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || scalar == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_scalar_select: mesh or scalar is NULL");
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_field *field = NULL;
  int component = MAGNITUDE;
  if (selector != NULL) {
    const cellist_result result = resolve(context, arrays, selector, &field, &component);
    if (result != CELLIST_SUCCESS) return result;
  } else if (arrays->field_count > 0) {
    field = &arrays->fields[0];
    for (size_t i = arrays->field_count; i-- > 0;)
      if (arrays->fields[i].association == CELLIST_ON_POINTS) field = &arrays->fields[i];
  }
  const char *name = selector != NULL ? selector : field != NULL ? field->name : "none";
  cellist_scalar made = {0};
  made.association = field != NULL ? field->association : CELLIST_ON_POINTS;
  made.count = made.association == CELLIST_ON_POINTS ? arrays->point_count : arrays->tet_count;
  made.name = cellist_allocate(context, strlen(name) + 1, 1);
  made.values = cellist_allocate_zeroed(context, made.count, sizeof *made.values);
  if (made.name == NULL || made.values == NULL) {
    cellist_scalar_release(context, &made);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  memcpy(made.name, name, strlen(name) + 1);
  if (field != NULL)
    for (size_t i = 0; i < made.count; i++) made.values[i] = value_of(field, component, i);
  measure(arrays, &made);
  *scalar = made;
  return CELLIST_SUCCESS;
}

void cellist_scalar_release(cellist_context *context, cellist_scalar *scalar) {
  cellist_deallocate(context, scalar->name);
  cellist_deallocate(context, scalar->values);
  *scalar = (cellist_scalar){0};
}
