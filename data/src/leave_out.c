/* SPDX-License-Identifier: BSD-3-Clause
 * Leave out: drops the tets that no mesh can hold (a corner that is NaN or infinite, a point used twice) from parts,
 * and says which cells they were. What remains is the user's own geometry: nothing is invented in their place. */
#include "mesh_private.h"

#include <math.h>

static bool is_finite_point(const mesh_parts *parts, uint32_t point) {
  if (point >= parts->point_count) return true; /* wrong in another way: the mesh refuses it by name */
  const double *p = &parts->positions[3 * (size_t)point];
  return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

/* Counts the tet's cell if so, once: tets of one cell stand together. */
static bool is_left_out(mesh_parts *parts, size_t tet, uint32_t cell, uint32_t *last_cell) {
  const uint32_t *v = &parts->tets[4 * tet];
  const bool is_infinite = !is_finite_point(parts, v[0]) || !is_finite_point(parts, v[1]) ||
                           !is_finite_point(parts, v[2]) || !is_finite_point(parts, v[3]);
  const bool is_collapsed =
      v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3];
  if (!is_infinite && !is_collapsed) return false;
  if (cell != *last_cell) {
    if (is_infinite)
      mesh_note_cell(parts->facts.infinite_cells, &parts->facts.infinite_cell_count, cell);
    else
      mesh_note_cell(parts->facts.collapsed_cells, &parts->facts.collapsed_cell_count, cell);
  }
  *last_cell = cell;
  return true;
}

static void move_values(mesh_parts *parts, size_t from, size_t to) {
  for (size_t i = 0; i < parts->field_count; i++) {
    const cellist_field *field = &parts->fields[i];
    if (field->association != CELLIST_ON_CELLS) continue;
    double *values = (double *)field->values;
    for (size_t k = 0; k < field->component_count; k++)
      values[to * field->component_count + k] = values[from * field->component_count + k];
  }
}

cellist_result mesh_leave_out(cellist_context *context, mesh_parts *parts) {
  if (parts->tet_origin == NULL) {
    parts->tet_origin = cellist_allocate(context, parts->tet_count, sizeof *parts->tet_origin);
    if (parts->tet_origin == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    for (size_t i = 0; i < parts->tet_count; i++) parts->tet_origin[i] = (uint32_t)i;
  }
  size_t kept = 0;
  uint32_t last_cell = CELLIST_NONE;
  for (size_t i = 0; i < parts->tet_count; i++) {
    if (is_left_out(parts, i, parts->tet_origin[i], &last_cell)) continue;
    for (size_t k = 0; k < 4; k++) parts->tets[4 * kept + k] = parts->tets[4 * i + k];
    parts->tet_origin[kept] = parts->tet_origin[i];
    move_values(parts, i, kept);
    kept++;
  }
  parts->tet_count = kept;
  return CELLIST_SUCCESS;
}
