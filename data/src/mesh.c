/* SPDX-License-Identifier: BSD-3-Clause
 * Mesh: the one place where parts become a mesh. Checks ids and coordinates, orients every tet by an exact sign,
 * brings tets and points into Hilbert order (a walk or a sort then finds its neighbours in the cache: two to three
 * times faster at a million tets) and links neighbours. */
#include "mesh_private.h"

#include <cellist/predicates.h>
#include <math.h>
#include <string.h>

/* Half of the id range: 4 * tet must fit the sorts' 32-bit face ids with room for CELLIST_NONE. */
enum { TET_LIMIT = 1 << 30 };

void mesh_parts_release(cellist_context *context, mesh_parts *parts) {
  for (size_t i = 0; i < parts->field_count && parts->fields != NULL; i++) {
    cellist_deallocate(context, (void *)parts->fields[i].name);
    cellist_deallocate(context, (void *)parts->fields[i].values);
  }
  cellist_deallocate(context, parts->fields);
  cellist_deallocate(context, parts->positions);
  cellist_deallocate(context, parts->tets);
  cellist_deallocate(context, parts->tet_origin);
  cellist_deallocate(context, parts->point_origin);
  *parts = (mesh_parts){0};
}

static uint32_t origin_of(const mesh_parts *parts, size_t tet) {
  return parts->tet_origin != NULL ? parts->tet_origin[tet] : (uint32_t)tet;
}

/* Ids in range and distinct; coordinates that a tet uses finite. Fills bounds and counts the unused points. */
static cellist_result check_parts(cellist_context *context, const mesh_parts *parts, double bounds[6],
                                  size_t *unused_point_count) {
  if (parts->tet_count >= TET_LIMIT || parts->point_count >= CELLIST_NONE)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%zu tets of %zu points are more than 32-bit ids allow",
                        parts->tet_count, parts->point_count);
  uint8_t *used = cellist_allocate_zeroed(context, parts->point_count, 1);
  if (used == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < 4 * parts->tet_count && result == CELLIST_SUCCESS; i++) {
    const uint32_t point = parts->tets[i];
    if (point >= parts->point_count)
      result =
          cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cell %u uses point %u, but there are only %zu points",
                       origin_of(parts, i / 4), point, parts->point_count);
    else
      used[point] = 1;
  }
  for (size_t i = 0; i < parts->tet_count && result == CELLIST_SUCCESS; i++) {
    const uint32_t *v = &parts->tets[4 * i];
    if (v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3])
      result = cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cell %u uses a point twice (%u %u %u %u)",
                            origin_of(parts, i), v[0], v[1], v[2], v[3]);
    for (int k = 0; k < 4 && result == CELLIST_SUCCESS; k++) {
      const double *p = &parts->positions[3 * (size_t)v[k]];
      if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
        result = cellist_fail(context, CELLIST_ERROR_GEOMETRY, "cell %u uses point %u at (%g, %g, %g)",
                              origin_of(parts, i), v[k], p[0], p[1], p[2]);
    }
  }
  *unused_point_count = 0;
  for (int k = 0; k < 3; k++) {
    bounds[k] = HUGE_VAL;
    bounds[3 + k] = -HUGE_VAL;
  }
  for (size_t i = 0; i < parts->point_count; i++) {
    if (!used[i]) {
      ++*unused_point_count;
      continue;
    }
    for (int k = 0; k < 3; k++) {
      bounds[k] = fmin(bounds[k], parts->positions[3 * i + (size_t)k]);
      bounds[3 + k] = fmax(bounds[3 + k], parts->positions[3 * i + (size_t)k]);
    }
  }
  if (parts->tet_count == 0) memset(bounds, 0, 6 * sizeof *bounds);
  cellist_deallocate(context, used);
  return result;
}

struct orient_job {
  const double *positions;
  uint32_t *tets;
  uint8_t *flags;
};

static void orient_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct orient_job *job = user;
  for (size_t i = begin; i < end; i++) {
    uint32_t *v = &job->tets[4 * i];
    const double *p = job->positions;
    const int sign =
        cellist_orient3d(&p[3 * (size_t)v[0]], &p[3 * (size_t)v[1]], &p[3 * (size_t)v[2]], &p[3 * (size_t)v[3]]);
    job->flags[i] = (uint8_t)(sign < 0 ? CELLIST_TET_INVERTED : sign == 0 ? CELLIST_TET_FLAT : 0);
    if (sign >= 0) continue;
    const uint32_t swap = v[2];
    v[2] = v[3];
    v[3] = swap;
  }
}

static void orient_tets(cellist_context *context, const mesh_parts *parts, uint8_t *flags, cellist_mesh_facts *facts) {
  struct orient_job job = {parts->positions, parts->tets, flags};
  cellist_parallel_for(context, parts->tet_count, 4096, orient_range, &job);
  for (size_t i = 0; i < parts->tet_count; i++) {
    facts->inverted_count += (flags[i] & CELLIST_TET_INVERTED) != 0;
    facts->flat_count += (flags[i] & CELLIST_TET_FLAT) != 0;
  }
  bool counted = false; /* whether the cell of this tet is */
  for (size_t i = 0; i < parts->tet_count; i++) {
    if (i > 0 && origin_of(parts, i) != origin_of(parts, i - 1)) counted = false;
    if (counted || (flags[i] & CELLIST_TET_INVERTED) == 0) continue;
    facts->inverted_cell_count++;
    counted = true;
  }
}

static cellist_result assemble(cellist_context *context, mesh_parts *parts, cellist_mesh *mesh) {
  cellist_mesh_arrays *arrays = &mesh->arrays;
  mesh->context = context;
  cellist_result result = parts->repair ? mesh_leave_out(context, parts) : CELLIST_SUCCESS;
  mesh->facts = parts->facts;
  if (result == CELLIST_SUCCESS) result = check_parts(context, parts, arrays->bounds, &mesh->facts.unused_point_count);
  if (result == CELLIST_SUCCESS) result = cellist_progress(context, "preparing", 0);
  if (result != CELLIST_SUCCESS) return result;

  uint8_t *flags = cellist_allocate(context, parts->tet_count, 1);
  arrays->tet_flags = flags;
  if (flags == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  orient_tets(context, parts, flags, &mesh->facts);

  uint32_t *point_origin = NULL;
  result = mesh_reorder(context, parts, flags, arrays->bounds, &point_origin);
  arrays->point_origin = point_origin;
  if (result == CELLIST_SUCCESS) result = cellist_progress(context, "preparing", 0.5);
  if (result != CELLIST_SUCCESS) return result;

  uint32_t *neighbours = cellist_allocate(context, parts->tet_count, 4 * sizeof *neighbours);
  arrays->neighbours = neighbours;
  if (neighbours == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  result =
      mesh_link_neighbours(context, parts->point_count, parts->tet_count, parts->tets, flags, neighbours, &mesh->facts);
  if (result != CELLIST_SUCCESS) return result;

  arrays->point_count = parts->point_count;
  arrays->positions = parts->positions;
  arrays->tet_count = parts->tet_count;
  arrays->tets = parts->tets;
  arrays->tet_origin = parts->tet_origin;
  arrays->field_count = parts->field_count;
  arrays->fields = parts->fields;
  *parts = (mesh_parts){0};
  return cellist_progress(context, "preparing", 1);
}

cellist_result mesh_assemble(cellist_context *context, mesh_parts *parts, cellist_mesh **mesh) {
  cellist_mesh *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  cellist_result result = created != NULL ? assemble(context, parts, created) : CELLIST_ERROR_OUT_OF_MEMORY;
  mesh_parts_release(context, parts);
  if (result == CELLIST_SUCCESS) {
    *mesh = created;
  } else if (created != NULL) {
    created->context = context;
    cellist_mesh_destroy(created);
  }
  return result;
}

static void *copy_of(cellist_context *context, const void *source, size_t count, size_t size) {
  void *copy = cellist_allocate(context, count, size);
  if (copy != NULL && count * size > 0) memcpy(copy, source, count * size);
  return copy;
}

static cellist_result copy_fields(cellist_context *context, const cellist_mesh_desc *desc, mesh_parts *parts) {
  if (desc->field_count == 0) return CELLIST_SUCCESS;
  parts->fields = cellist_allocate_zeroed(context, desc->field_count, sizeof *parts->fields);
  if (parts->fields == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < desc->field_count; i++) {
    const cellist_field *from = &desc->fields[i];
    cellist_field *to = &parts->fields[parts->field_count++];
    *to = (cellist_field){NULL, from->association, from->component_count, NULL};
    if (from->name == NULL || from->values == NULL || from->component_count == 0)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "field %zu has no name, values or components", i);
    const size_t count = from->association == CELLIST_ON_POINTS ? desc->point_count : desc->tet_count;
    to->name = copy_of(context, from->name, strlen(from->name) + 1, 1);
    to->values = copy_of(context, from->values, count, from->component_count * sizeof *from->values);
    if (to->name == NULL || to->values == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  return CELLIST_SUCCESS;
}

static cellist_result create(cellist_context *context, const cellist_mesh_desc *desc, bool repair,
                             cellist_mesh **mesh) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (desc == NULL || mesh == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_mesh_create: desc or mesh is NULL");
  if ((desc->positions == NULL && desc->point_count > 0) || (desc->tets == NULL && desc->tet_count > 0) ||
      (desc->fields == NULL && desc->field_count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_mesh_create: an array is NULL");
  mesh_parts parts = {0};
  parts.point_count = desc->point_count;
  parts.tet_count = desc->tet_count;
  parts.facts.file_cell_count = desc->tet_count;
  parts.repair = repair;
  parts.positions = copy_of(context, desc->positions, desc->point_count, 3 * sizeof *desc->positions);
  parts.tets = copy_of(context, desc->tets, desc->tet_count, 4 * sizeof *desc->tets);
  cellist_result result = parts.positions != NULL && parts.tets != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS && desc->tet_origin != NULL) {
    parts.tet_origin = copy_of(context, desc->tet_origin, desc->tet_count, sizeof *desc->tet_origin);
    if (parts.tet_origin == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  }
  if (result == CELLIST_SUCCESS) result = copy_fields(context, desc, &parts);
  if (result == CELLIST_SUCCESS) return mesh_assemble(context, &parts, mesh);
  mesh_parts_release(context, &parts);
  return result;
}

cellist_result cellist_mesh_create(cellist_context *context, const cellist_mesh_desc *desc, cellist_mesh **mesh) {
  return create(context, desc, false, mesh);
}

cellist_result cellist_mesh_create_repaired(cellist_context *context, const cellist_mesh_desc *desc,
                                            cellist_mesh **mesh) {
  return create(context, desc, true, mesh);
}

void cellist_mesh_destroy(cellist_mesh *mesh) {
  if (mesh == NULL) return;
  cellist_context *context = mesh->context;
  cellist_mesh_arrays *arrays = &mesh->arrays;
  mesh_parts parts = {0};
  parts.positions = (double *)arrays->positions;
  parts.tets = (uint32_t *)arrays->tets;
  parts.tet_origin = (uint32_t *)arrays->tet_origin;
  parts.field_count = arrays->field_count;
  parts.fields = (cellist_field *)arrays->fields;
  mesh_parts_release(context, &parts);
  cellist_deallocate(context, (void *)arrays->point_origin);
  cellist_deallocate(context, (void *)arrays->neighbours);
  cellist_deallocate(context, (void *)arrays->tet_flags);
  cellist_deallocate(context, mesh);
}

const cellist_mesh_arrays *cellist_mesh_get_arrays(const cellist_mesh *mesh) { return &mesh->arrays; }
const cellist_mesh_facts *cellist_mesh_get_facts(const cellist_mesh *mesh) { return &mesh->facts; }
