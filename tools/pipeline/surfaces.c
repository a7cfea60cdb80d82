/* SPDX-License-Identifier: BSD-3-Clause
 * Surfaces: from what the description names to the one opaque surface of the pipeline; what a picture's file says of
 * surfaces and clip planes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline.h"

/* The text after a prefix; NULL if it begins otherwise. */
static const char *after(const char *text, const char *prefix) {
  const size_t length = strlen(prefix);
  return strncmp(text, prefix, length) == 0 ? text + length : NULL;
}

/* LO..HI, either end may be missing. The ends are cut out first: strtod would take one of the dots. */
static bool parse_range(const char *text, double range[2]) {
  const char *dots = strstr(text, "..");
  if (dots == NULL) return false;
  char low[64];
  const size_t length = (size_t)(dots - text);
  if (length >= sizeof low) return false;
  memcpy(low, text, length);
  low[length] = '\0';
  const char *ends[2] = {low, dots + 2};
  for (int i = 0; i < 2; i++) {
    range[i] = i == 0 ? -HUGE_VAL : HUGE_VAL;
    if (ends[i][0] == '\0') continue;
    char *end = NULL;
    range[i] = strtod(ends[i], &end);
    if (*end != '\0' || isnan(range[i])) return false;
  }
  return range[0] <= range[1];
}

/* NAME=LO..HI: cells all of whose values of that scalar lie in the range. */
static cellist_result choose_by_scalar(const cellist_pipeline *pipeline, const char *source, const char *text,
                                       uint8_t *chosen) {
  cellist_context *context = pipeline->context;
  const char *equals = strrchr(text, '=');
  double range[2];
  if (equals == NULL || equals == text || !parse_range(equals + 1, range))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "surface %s: needs cells:SCALAR=LO..HI", source);
  const size_t length = (size_t)(equals - text);
  char *name = cellist_allocate(context, length + 1, 1);
  if (name == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memcpy(name, text, length);
  name[length] = '\0';
  cellist_scalar scalar = {0};
  const cellist_result result = cellist_scalar_select(context, pipeline->mesh, name, &scalar);
  cellist_deallocate(context, name);
  if (result != CELLIST_SUCCESS) return result;
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->mesh);
  for (size_t t = 0; t < arrays->tet_count; t++) {
    chosen[t] = 1;
    for (size_t k = 0; k < 4; k++) {
      const double value = scalar.values[scalar.association == CELLIST_ON_CELLS ? t : arrays->tets[4 * t + k]];
      if (!(value >= range[0] && value <= range[1])) chosen[t] = 0;
    }
  }
  cellist_scalar_release(context, &scalar);
  return CELLIST_SUCCESS;
}

/* A whole number at *text, which then points behind it. */
static bool parse_id(const char **text, uint32_t *id) {
  if (**text < '0' || **text > '9') return false;
  char *end = NULL;
  const unsigned long long value = strtoull(*text, &end, 10);
  *text = end;
  *id = (uint32_t)value;
  return value < CELLIST_NONE;
}

/* ID+ID..ID+...: cells by the file's own ids. */
static cellist_result choose_by_id(const cellist_pipeline *pipeline, const char *source, const char *text,
                                   uint8_t *chosen) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->mesh);
  for (;;) {
    uint32_t ids[2];
    bool ok = parse_id(&text, &ids[0]);
    const char *rest = after(text, "..");
    ids[1] = ids[0];
    if (ok && rest != NULL) {
      text = rest;
      ok = parse_id(&text, &ids[1]);
    }
    if (!ok || (*text != '+' && *text != '\0'))
      return cellist_fail(pipeline->context, CELLIST_ERROR_INVALID_ARGUMENT, "surface %s: needs ids:ID+ID..ID", source);
    for (size_t t = 0; t < arrays->tet_count; t++)
      if (arrays->tet_origin[t] >= ids[0] && arrays->tet_origin[t] <= ids[1]) chosen[t] = 1;
    if (*text++ == '\0') return CELLIST_SUCCESS;
  }
}

static cellist_result make_from_cells(const cellist_pipeline *pipeline, const cellist_pipeline_surface *given,
                                      const char *by_scalar, const char *by_id, cellist_surface **surface) {
  cellist_context *context = pipeline->context;
  cellist_surface_cells cells = {.mesh = pipeline->mesh,
                                 .colour = given->has_colour ? given->colour : NULL,
                                 .scalar = &pipeline->scalar,
                                 .transfer = &pipeline->transfer};
  uint8_t *chosen = NULL;
  cellist_result result = CELLIST_SUCCESS;
  if (by_scalar != NULL || by_id != NULL) {
    chosen = cellist_allocate_zeroed(context, cellist_mesh_get_arrays(pipeline->mesh)->tet_count, 1);
    if (chosen == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    result = by_scalar != NULL ? choose_by_scalar(pipeline, given->source, by_scalar, chosen)
                               : choose_by_id(pipeline, given->source, by_id, chosen);
    cells.chosen = chosen;
  }
  if (result == CELLIST_SUCCESS) result = cellist_surface_from_cells(context, &cells, surface);
  cellist_deallocate(context, chosen);
  if (result == CELLIST_SUCCESS && cellist_surface_get_arrays(*surface)->triangle_count == 0)
    cellist_log(context, CELLIST_LOG_WARNING, "surface %s: no cell is chosen", given->source);
  return result;
}

static cellist_result make_surface(const cellist_pipeline *pipeline, const cellist_pipeline_surface *given,
                                   cellist_surface **surface) {
  cellist_context *context = pipeline->context;
  if (given->source == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a surface has neither a source nor triangles");
  for (int k = 0; k < 3 && given->has_colour; k++)
    if (!isfinite(given->colour[k]) || given->colour[k] < 0)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "surface %s: a colour must be finite, at least 0",
                          given->source);
  const char *by_scalar = after(given->source, "cells:"), *by_id = after(given->source, "ids:");
  if (by_scalar != NULL || by_id != NULL || strcmp(given->source, "boundary") == 0)
    return make_from_cells(pipeline, given, by_scalar, by_id, surface);
  return cellist_surface_read(context, given->source, given->has_colour ? given->colour : NULL, surface);
}

cellist_result pipeline_make_surface(cellist_pipeline *pipeline) {
  cellist_context *context = pipeline->context;
  const size_t count = pipeline->desc.surface_count;
  if (count == 0) return CELLIST_SUCCESS;
  if (pipeline->desc.surfaces == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the pipeline's surfaces are NULL");
  cellist_surface **made = cellist_allocate_zeroed(context, count, sizeof *made);
  const cellist_surface **parts = cellist_allocate_zeroed(context, count, sizeof *parts);
  cellist_result result = made != NULL && parts != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < count && result == CELLIST_SUCCESS; i++) {
    const cellist_pipeline_surface *given = &pipeline->desc.surfaces[i];
    if (given->surface == NULL) result = make_surface(pipeline, given, &made[i]);
    parts[i] = given->surface != NULL ? given->surface : made[i];
  }
  if (result == CELLIST_SUCCESS) result = cellist_surface_join(context, parts, count, &pipeline->surface);
  for (size_t i = 0; i < count && made != NULL; i++) cellist_surface_destroy(made[i]);
  cellist_deallocate(context, made);
  cellist_deallocate(context, parts);
  return result;
}

cellist_result pipeline_describe_cuts(const cellist_pipeline *pipeline, const cellist_frame *frame,
                                      cellist_image *image) {
  char text[128 * CELLIST_MAX_CLIP_PLANES] = "";
  size_t length = 0;
  for (uint32_t i = 0; i < frame->clip_count && length < sizeof text; i++) {
    const cellist_clip_plane *plane = &frame->clips[i];
    length += (size_t)snprintf(text + length, sizeof text - length, "%s%.17g %.17g %.17g at most %.17g",
                               i > 0 ? ", " : "", plane->normal[0], plane->normal[1], plane->normal[2], plane->offset);
  }
  cellist_result result = CELLIST_SUCCESS;
  if (frame->clip_count > 0) result = cellist_image_set_attribute(image, "cellist clip", text);
  if (pipeline->surface != NULL && result == CELLIST_SUCCESS) {
    const cellist_surface_arrays *arrays = cellist_surface_get_arrays(pipeline->surface);
    snprintf(text, sizeof text, "%zu of %zu triangles", pipeline->desc.surface_count, arrays->triangle_count);
    result = cellist_image_set_attribute(image, "cellist surfaces", text);
  }
  return result;
}
