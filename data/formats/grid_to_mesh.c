/* SPDX-License-Identifier: BSD-3-Clause
 * From a grid of any cells to a mesh of tets: leaves out what has no volume or is hidden, splits the rest, and keeps
 * for every tet the file's cell. A grid of sound tets alone gives its arrays away without a copy. */
#include "grid.h"

#include <math.h>
#include <string.h>

/* Why a point's cells are left out. */
enum { POINT_IS_FINE, POINT_IS_HIDDEN, POINT_IS_INFINITE };

struct conversion {
  cellist_context *context;
  struct grid *grid;
  bool strict;
  uint8_t *point_states; /* NULL: all fine */
  cellist_mesh_facts facts;
  size_t simplified_count;
  size_t tet_count;
};

static size_t file_cell(const struct grid *grid, size_t cell) {
  return grid->cell_origin != NULL ? grid->cell_origin[cell] : cell;
}

/* The ids of one cell are in range and as many as its type has. */
static cellist_result check_cell(const struct conversion *conversion, size_t cell, int corners, bool is_simplified) {
  const struct grid *grid = conversion->grid;
  const uint8_t type = grid->types[cell];
  if (corners < 0)
    return cellist_fail(conversion->context, CELLIST_ERROR_UNSUPPORTED,
                        "%s: cell %zu is of VTK's type %u, which has no decomposition into tets here", grid->file,
                        file_cell(grid, cell), type);
  const size_t begin = grid->offsets[cell], count = grid->offsets[cell + 1] - begin;
  if (corners > 0 && (count < (size_t)corners || (!is_simplified && count > (size_t)corners)))
    return cellist_fail(conversion->context, CELLIST_ERROR_FORMAT,
                        "%s: cell %zu of VTK's type %u has %zu points instead of %d", grid->file, file_cell(grid, cell),
                        type, count, corners);
  for (size_t i = begin; i < begin + count; i++)
    if (grid->connectivity[i] >= grid->point_count)
      return cellist_fail(conversion->context, CELLIST_ERROR_FORMAT,
                          "%s: cell %zu uses point %u, but there are only %zu points", grid->file,
                          file_cell(grid, cell), grid->connectivity[i], grid->point_count);
  return CELLIST_SUCCESS;
}

/* Counts a cell that is left out; *keep says whether it is not. */
static cellist_result judge_cell(struct conversion *conversion, size_t cell, bool *keep) {
  const struct grid *grid = conversion->grid;
  bool is_simplified = false;
  const int corners = grid_cell_corners(grid->types[cell], &is_simplified);
  const cellist_result result = check_cell(conversion, cell, corners, is_simplified);
  *keep = false;
  if (result != CELLIST_SUCCESS) return result;
  uint8_t worst = POINT_IS_FINE;
  const uint32_t *ids = &grid->connectivity[grid->offsets[cell]];
  for (int k = 0; k < corners && conversion->point_states != NULL; k++) {
    const uint8_t state = conversion->point_states[ids[k]];
    worst = state > worst ? state : worst;
  }
  if (corners == 0) {
    conversion->facts.skipped_cell_count++;
  } else if ((grid->hidden_cells != NULL && grid->hidden_cells[cell]) || worst == POINT_IS_HIDDEN) {
    conversion->facts.hidden_cell_count++;
  } else if (worst == POINT_IS_INFINITE) {
    if (conversion->strict)
      return cellist_fail(conversion->context, CELLIST_ERROR_GEOMETRY,
                          "%s: cell %zu has a corner with a NaN or infinite coordinate", grid->file,
                          file_cell(grid, cell));
    mesh_note_cell(conversion->facts.infinite_cells, &conversion->facts.infinite_cell_count,
                   (uint32_t)file_cell(grid, cell));
  } else {
    conversion->simplified_count += is_simplified;
    *keep = true;
  }
  return CELLIST_SUCCESS;
}

static cellist_result judge_points(struct conversion *conversion) {
  struct grid *grid = conversion->grid;
  bool all_fine = grid->hidden_points == NULL;
  for (size_t i = 0; i < 3 * grid->point_count && all_fine; i++) all_fine = isfinite(grid->points[i]);
  if (all_fine) return CELLIST_SUCCESS;
  conversion->point_states = cellist_allocate(conversion->context, grid->point_count, 1);
  if (conversion->point_states == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < grid->point_count; i++) {
    const double *p = &grid->points[3 * i];
    const bool is_hidden = grid->hidden_points != NULL && grid->hidden_points[i] != 0;
    const bool is_finite = isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
    conversion->point_states[i] = is_hidden ? POINT_IS_HIDDEN : is_finite ? POINT_IS_FINE : POINT_IS_INFINITE;
  }
  return CELLIST_SUCCESS;
}

static double volume_of(const struct grid *grid, const uint32_t v[4]) {
  const double *a = &grid->points[3 * (size_t)v[0]], *b = &grid->points[3 * (size_t)v[1]];
  const double *c = &grid->points[3 * (size_t)v[2]], *d = &grid->points[3 * (size_t)v[3]];
  const double x[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, y[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const double z[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
  return z[0] * (x[1] * y[2] - x[2] * y[1]) + z[1] * (x[2] * y[0] - x[0] * y[2]) + z[2] * (x[0] * y[1] - x[1] * y[0]);
}

static void mirror(size_t count, uint32_t tets[][4]) {
  for (size_t i = 0; i < count; i++) {
    const uint32_t swap = tets[i][0];
    tets[i][0] = tets[i][1];
    tets[i][1] = swap;
  }
}

/* VTK's text and its code disagree on which way round a wedge's triangles go, and files follow either. */
static bool is_wedge(uint8_t type) {
  return type == 13 || type == 26 || type == 31 || type == 32 || type == 73 || type == 80;
}

static size_t split_cell(const struct grid *grid, size_t cell, uint32_t tets[][4]) {
  const size_t count = grid_split_cell(grid->types[cell], &grid->connectivity[grid->offsets[cell]], tets);
  if (!is_wedge(grid->types[cell])) return count;
  double volume = 0;
  for (size_t i = 0; i < count; i++) volume += volume_of(grid, tets[i]);
  if (volume < 0) mirror(count, tets);
  return count;
}

/* First pass: judges every cell and counts the tets; keep[cell] for the second one. */
static cellist_result count_tets(struct conversion *conversion, uint8_t *keep, bool *are_all_tets) {
  const struct grid *grid = conversion->grid;
  uint32_t tets[SPLIT_LIMIT][4];
  *are_all_tets = true;
  for (size_t cell = 0; cell < grid->cell_count; cell++) {
    bool is_kept = false;
    const cellist_result result = judge_cell(conversion, cell, &is_kept);
    if (result != CELLIST_SUCCESS) return result;
    const size_t count =
        is_kept ? grid_split_cell(grid->types[cell], &grid->connectivity[grid->offsets[cell]], tets) : 0;
    keep[cell] = count > 0;
    if (is_kept && count == 0)
      mesh_note_cell(conversion->facts.collapsed_cells, &conversion->facts.collapsed_cell_count,
                     (uint32_t)file_cell(grid, cell));
    conversion->tet_count += count;
    *are_all_tets &= count == 1 && grid->types[cell] == GRID_TETRA;
  }
  return CELLIST_SUCCESS;
}

/* Second pass; tet_origin is the grid's cell for now. */
static cellist_result fill_tets(struct conversion *conversion, const uint8_t *keep, mesh_parts *parts) {
  const struct grid *grid = conversion->grid;
  parts->tets = cellist_allocate(conversion->context, conversion->tet_count, 4 * sizeof *parts->tets);
  parts->tet_origin = cellist_allocate(conversion->context, conversion->tet_count, sizeof *parts->tet_origin);
  if (parts->tets == NULL || parts->tet_origin == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  size_t at = 0;
  for (size_t cell = 0; cell < grid->cell_count; cell++) {
    if (!keep[cell]) continue;
    uint32_t tets[SPLIT_LIMIT][4];
    const size_t count = split_cell(grid, cell, tets);
    memcpy(&parts->tets[4 * at], tets, count * sizeof *tets);
    for (size_t i = 0; i < count; i++) parts->tet_origin[at++] = (uint32_t)cell;
  }
  return CELLIST_SUCCESS;
}

/* Fields on cells become fields on tets; all move to the parts. */
static cellist_result move_fields(cellist_context *context, struct grid *grid, mesh_parts *parts) {
  for (size_t f = 0; f < grid->field_count && parts->tet_origin != NULL; f++) {
    cellist_field *field = &grid->fields[f];
    if (field->association != CELLIST_ON_CELLS) continue;
    const size_t width = field->component_count;
    double *values = cellist_allocate(context, parts->tet_count, width * sizeof *values);
    if (values == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    for (size_t i = 0; i < parts->tet_count; i++)
      memcpy(&values[width * i], &field->values[width * parts->tet_origin[i]], width * sizeof *values);
    cellist_deallocate(context, (void *)field->values);
    field->values = values;
  }
  parts->fields = grid->fields;
  parts->field_count = grid->field_count;
  grid->fields = NULL;
  grid->field_count = 0;
  return CELLIST_SUCCESS;
}

static cellist_result convert(struct conversion *conversion, mesh_parts *parts) {
  cellist_context *context = conversion->context;
  struct grid *grid = conversion->grid;
  uint8_t *keep = cellist_allocate(context, grid->cell_count, 1);
  if (keep == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  bool are_all_tets = false;
  cellist_result result = judge_points(conversion);
  if (result == CELLIST_SUCCESS) result = count_tets(conversion, keep, &are_all_tets);
  if (result == CELLIST_SUCCESS && are_all_tets) {
    parts->tets = grid->connectivity;
    grid->connectivity = NULL;
  } else if (result == CELLIST_SUCCESS) {
    result = fill_tets(conversion, keep, parts);
  }
  cellist_deallocate(context, keep);
  if (result != CELLIST_SUCCESS) return result;
  parts->tet_count = conversion->tet_count;
  parts->point_count = grid->point_count;
  parts->positions = grid->points;
  grid->points = NULL;
  result = move_fields(context, grid, parts);
  if (result != CELLIST_SUCCESS || grid->cell_origin == NULL) return result;
  if (parts->tet_origin == NULL) {
    parts->tet_origin = grid->cell_origin;
    grid->cell_origin = NULL;
  } else {
    for (size_t i = 0; i < parts->tet_count; i++) parts->tet_origin[i] = grid->cell_origin[parts->tet_origin[i]];
  }
  return CELLIST_SUCCESS;
}

static void log_what_was_left_out(const struct conversion *conversion) {
  const cellist_mesh_facts *facts = &conversion->facts;
  const char *file = conversion->grid->file;
  if (conversion->simplified_count > 0)
    cellist_log(conversion->context, CELLIST_LOG_INFO, "%s: %zu cells of higher order are taken by their corners", file,
                conversion->simplified_count);
  if (facts->skipped_cell_count > 0)
    cellist_log(conversion->context, CELLIST_LOG_INFO,
                "%s: %zu cells without volume (points, lines, faces) are skipped", file, facts->skipped_cell_count);
  if (facts->hidden_cell_count > 0)
    cellist_log(conversion->context, CELLIST_LOG_INFO, "%s: %zu ghost or blanked cells are left out", file,
                facts->hidden_cell_count);
  if (facts->infinite_cell_count > 0)
    cellist_log(conversion->context, CELLIST_LOG_WARNING, "%s: %zu cells with NaN or infinite corners are left out",
                file, facts->infinite_cell_count);
  if (facts->collapsed_cell_count > 0)
    cellist_log(conversion->context, CELLIST_LOG_WARNING, "%s: %zu cells that collapse to less than a tet are left out",
                file, facts->collapsed_cell_count);
  if (facts->coincident_point_count > 0)
    cellist_log(conversion->context, CELLIST_LOG_INFO, "%s: %zu points coincide with others and are not joined", file,
                facts->coincident_point_count);
}

/* Polyhedra add points; with merged points, their ids go on after the file's. */
static cellist_result split_polyhedra(cellist_context *context, struct grid *grid, size_t file_point_count,
                                      uint32_t **point_origin) {
  if (grid->cell_count == 0 || memchr(grid->types, GRID_POLYHEDRON, grid->cell_count) == NULL) return CELLIST_SUCCESS;
  const size_t old_count = grid->point_count;
  const cellist_result result = grid_split_polyhedra(context, grid);
  if (result != CELLIST_SUCCESS || *point_origin == NULL) return result;
  uint32_t *origin = cellist_reallocate(context, *point_origin, old_count, grid->point_count, sizeof *origin);
  if (origin == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = old_count; i < grid->point_count; i++) origin[i] = (uint32_t)(file_point_count + i - old_count);
  *point_origin = origin;
  return CELLIST_SUCCESS;
}

cellist_result grid_to_mesh(cellist_context *context, struct grid *grid, const cellist_mesh_read_desc *desc,
                            cellist_mesh **mesh) {
  struct conversion conversion = {.context = context, .grid = grid, .strict = desc != NULL && desc->strict};
  mesh_parts parts = {0};
  cellist_result result = CELLIST_SUCCESS;
  const size_t file_point_count = grid->point_count;
  const size_t file_cell_count = grid->cell_count + grid->skipped_cell_count;
  conversion.facts.skipped_cell_count = grid->skipped_cell_count;
  if (desc != NULL && desc->merge)
    result = grid_merge_points(context, grid, desc->merge_distance, &parts.point_origin,
                               &conversion.facts.merged_point_count);
  /* After an exact merge there are none left; after one by distance neither. */
  else
    result = grid_count_coincident_points(context, grid, &conversion.facts.coincident_point_count);
  if (result == CELLIST_SUCCESS) result = split_polyhedra(context, grid, file_point_count, &parts.point_origin);
  if (result == CELLIST_SUCCESS) result = convert(&conversion, &parts);
  if (result == CELLIST_SUCCESS) {
    conversion.facts.file_cell_count = file_cell_count;
    parts.facts = conversion.facts;
    log_what_was_left_out(&conversion);
  }
  cellist_deallocate(context, conversion.point_states);
  grid_release(context, grid);
  if (result == CELLIST_SUCCESS) return mesh_assemble(context, &parts, mesh);
  mesh_parts_release(context, &parts);
  return result;
}
