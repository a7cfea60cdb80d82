/* SPDX-License-Identifier: BSD-3-Clause
 * Cells: the surface around chosen cells of a mesh, or around all of them: faces with a chosen cell on one side only.
 * A face has its own three points, so that colours of cells need no second kind of array. */
#include <math.h>
#include <string.h>

#include "surface_private.h"

static const float GREY = 0.8f;

static bool is_chosen(const cellist_surface_cells *cells, uint32_t tet) {
  return tet != CELLIST_NONE && (cells->chosen == NULL || cells->chosen[tet] != 0);
}

static bool is_shown(const cellist_surface_cells *cells, const cellist_mesh_arrays *mesh, size_t face) {
  return is_chosen(cells, (uint32_t)(face / 4)) && !is_chosen(cells, mesh->neighbours[face]);
}

static void colour_of(const cellist_surface_cells *cells, uint32_t tet, uint32_t point, float colour[3]) {
  double linear[3];
  for (int k = 0; k < 3; k++) linear[k] = cells->colour != NULL ? cells->colour[k] : (double)GREY;
  if (cells->colour == NULL && cells->scalar != NULL) {
    const double value = cells->scalar->values[cells->scalar->association == CELLIST_ON_CELLS ? tet : point];
    if (isfinite(value)) cellist_transfer_evaluate(cells->transfer, value, linear);
  }
  for (int k = 0; k < 3; k++) colour[k] = (float)linear[k];
}

cellist_result cellist_surface_from_cells(cellist_context *context, const cellist_surface_cells *cells,
                                          cellist_surface **surface) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (cells == NULL || cells->mesh == NULL || surface == NULL || (cells->scalar != NULL && cells->transfer == NULL))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "cellist_surface_from_cells: cells, mesh, transfer or surface is NULL");
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(cells->mesh);
  const cellist_scalar *scalar = cells->scalar;
  if (scalar != NULL &&
      scalar->count != (scalar->association == CELLIST_ON_CELLS ? mesh->tet_count : mesh->point_count))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the scalar has %zu values: it is not of this mesh",
                        scalar->count);
  size_t count = 0;
  for (size_t f = 0; f < 4 * mesh->tet_count; f++) count += is_shown(cells, mesh, f);
  double *positions = cellist_allocate(context, count, 9 * sizeof *positions);
  float *colours = cellist_allocate(context, count, 9 * sizeof *colours);
  uint32_t *triangles = cellist_allocate(context, count, 3 * sizeof *triangles);
  cellist_result result = CELLIST_ERROR_OUT_OF_MEMORY;
  if (positions != NULL && colours != NULL && triangles != NULL) {
    size_t at = 0;
    for (size_t f = 0; f < 4 * mesh->tet_count; f++) {
      if (!is_shown(cells, mesh, f)) continue;
      for (int c = 0; c < 3; c++, at++) {
        const uint32_t point = mesh->tets[f / 4 * 4 + CELLIST_TET_FACE[f % 4][c]];
        memcpy(&positions[3 * at], &mesh->positions[3 * (size_t)point], 3 * sizeof *positions);
        colour_of(cells, (uint32_t)(f / 4), point, &colours[3 * at]);
        triangles[at] = (uint32_t)at;
      }
    }
    const cellist_surface_arrays arrays = {3 * count, positions, NULL, colours, count, triangles};
    result = cellist_surface_create(context, &arrays, surface);
  }
  cellist_deallocate(context, positions);
  cellist_deallocate(context, colours);
  cellist_deallocate(context, triangles);
  return result;
}
