/* SPDX-License-Identifier: BSD-3-Clause
 * Grid: making, filling and joining. */
#include "grid.h"

#include <string.h>

void grid_release(cellist_context *context, struct grid *grid) {
  for (size_t i = 0; i < grid->field_count; i++) {
    cellist_deallocate(context, (void *)grid->fields[i].name);
    cellist_deallocate(context, (void *)grid->fields[i].values);
  }
  cellist_deallocate(context, grid->fields);
  cellist_deallocate(context, grid->points);
  cellist_deallocate(context, grid->types);
  cellist_deallocate(context, grid->offsets);
  cellist_deallocate(context, grid->connectivity);
  cellist_deallocate(context, grid->faces);
  cellist_deallocate(context, grid->face_starts);
  cellist_deallocate(context, grid->cell_origin);
  cellist_deallocate(context, grid->hidden_points);
  cellist_deallocate(context, grid->hidden_cells);
  *grid = (struct grid){0};
}

static const cellist_field *find_field(const struct grid *grid, const char *name, cellist_association association) {
  for (size_t i = 0; i < grid->field_count; i++)
    if (grid->fields[i].association == association && strcmp(grid->fields[i].name, name) == 0) return &grid->fields[i];
  return NULL;
}

cellist_result grid_add_field(cellist_context *context, struct grid *grid, const char *name,
                              cellist_association association, size_t component_count, double *values) {
  /* Looking a name up is linear; the limit keeps hostile files with many arrays from quadratic time. */
  enum { FIELD_LIMIT = 4096 };
  if (component_count == 0 || component_count > UINT32_MAX || grid->field_count >= FIELD_LIMIT ||
      find_field(grid, name, association) != NULL) {
    cellist_log(context, CELLIST_LOG_WARNING, "%s: array '%s' is left out (a second one of its name, or too many)",
                grid->file, name);
    cellist_deallocate(context, values);
    return CELLIST_SUCCESS;
  }
  char *copy = cellist_allocate(context, strlen(name) + 1, 1);
  if (copy != NULL && (grid->field_count & (grid->field_count - 1)) == 0) {
    const size_t capacity = grid->field_count > 0 ? 2 * grid->field_count : 1;
    cellist_field *grown = cellist_reallocate(context, grid->fields, grid->field_count, capacity, sizeof *grid->fields);
    if (grown != NULL) {
      grid->fields = grown;
    } else {
      cellist_deallocate(context, copy);
      copy = NULL;
    }
  }
  if (copy == NULL) {
    cellist_deallocate(context, values);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  memcpy(copy, name, strlen(name) + 1);
  grid->fields[grid->field_count++] = (cellist_field){copy, association, (uint32_t)component_count, values};
  return CELLIST_SUCCESS;
}

cellist_result grid_make_uniform(cellist_context *context, struct grid *grid, size_t cell_count, uint8_t type,
                                 size_t corner_count, uint32_t *connectivity) {
  grid->connectivity =
      connectivity != NULL ? connectivity : cellist_allocate(context, cell_count, corner_count * sizeof *connectivity);
  grid->types = cellist_allocate(context, cell_count, 1);
  grid->offsets = cellist_allocate(context, cell_count + 1, sizeof *grid->offsets);
  if (grid->connectivity == NULL || grid->types == NULL || grid->offsets == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  grid->cell_count = cell_count;
  if (cell_count > 0) memset(grid->types, type, cell_count);
  for (size_t i = 0; i <= cell_count; i++) grid->offsets[i] = corner_count * i;
  return CELLIST_SUCCESS;
}

/* Corners in VTK's order. */
static void hexahedron_at(size_t at, size_t dy, size_t dz, uint32_t ids[8]) {
  const size_t corners[8] = {at, at + 1, at + 1 + dy, at + dy, at + dz, at + 1 + dz, at + 1 + dy + dz, at + dy + dz};
  for (int k = 0; k < 8; k++) ids[k] = (uint32_t)corners[k];
}

/* Six times the volume at the first corner: a sum of these tells which way round a block is numbered. */
static double corner_volume(const double *points, const uint32_t ids[8]) {
  const double *o = &points[3 * (size_t)ids[0]], *a = &points[3 * (size_t)ids[1]];
  const double *b = &points[3 * (size_t)ids[3]], *c = &points[3 * (size_t)ids[4]];
  const double x[3] = {a[0] - o[0], a[1] - o[1], a[2] - o[2]}, y[3] = {b[0] - o[0], b[1] - o[1], b[2] - o[2]};
  const double z[3] = {c[0] - o[0], c[1] - o[1], c[2] - o[2]};
  return z[0] * (x[1] * y[2] - x[2] * y[1]) + z[1] * (x[2] * y[0] - x[0] * y[2]) + z[2] * (x[0] * y[1] - x[1] * y[0]);
}

/* The block's hexahedra, and whether they are left-handed. */
static bool fill_block(const double *points, const size_t n[3], size_t first, uint32_t *ids) {
  const size_t dy = n[0], dz = n[0] * n[1];
  double volume = 0;
  for (size_t z = 0; z + 1 < n[2]; z++)
    for (size_t y = 0; y + 1 < n[1]; y++)
      for (size_t x = 0; x + 1 < n[0]; x++, ids += 8) {
        hexahedron_at(first + x + dy * y + dz * z, dy, dz, ids);
        volume += corner_volume(points, ids);
      }
  return volume < 0;
}

cellist_result grid_make_structured(cellist_context *context, struct grid *grid, size_t block_count,
                                    const struct grid_block *blocks) {
  size_t cell_count = 0;
  for (size_t b = 0; b < block_count; b++) {
    const size_t *n = blocks[b].size;
    if (n[0] > 0 && n[1] > 0 && n[2] > 0) cell_count += (n[0] - 1) * (n[1] - 1) * (n[2] - 1);
  }
  const cellist_result result = grid_make_uniform(context, grid, cell_count, GRID_HEXAHEDRON, 8, NULL);
  if (result != CELLIST_SUCCESS) return result;
  uint32_t *ids = grid->connectivity;
  size_t first = 0;
  for (size_t b = 0; b < block_count; b++) {
    const size_t *n = blocks[b].size;
    if (n[0] == 0 || n[1] == 0 || n[2] == 0) continue;
    const size_t count = (n[0] - 1) * (n[1] - 1) * (n[2] - 1);
    const bool is_left_handed = fill_block(grid->points, n, first, ids);
    for (size_t i = 0; i < count && is_left_handed; i++)
      for (size_t k = 0; k < 4; k++) {
        const uint32_t swap = ids[8 * i + k];
        ids[8 * i + k] = ids[8 * i + k + 4];
        ids[8 * i + k + 4] = swap;
      }
    ids += 8 * count;
    first += n[0] * n[1] * n[2];
  }
  return CELLIST_SUCCESS;
}

cellist_result grid_hide_by_ghost_type(cellist_context *context, struct grid *grid, cellist_association association,
                                       const double *ghost_types, bool are_levels) {
  /* vtkDataSetAttributes: duplicate 1, refined 8, hidden 32 for cells; hidden 2 for points (a duplicate point is
   * still a point). Levels, the older way, are above 0 for duplicates. */
  enum { LEFT_OUT_CELL = 1 | 8 | 32, LEFT_OUT_POINT = 2 };
  const bool of_cells = association == CELLIST_ON_CELLS;
  const size_t count = of_cells ? grid->cell_count : grid->point_count;
  uint8_t **hidden = of_cells ? &grid->hidden_cells : &grid->hidden_points;
  if (are_levels && !of_cells) return CELLIST_SUCCESS;
  if (*hidden == NULL) *hidden = cellist_allocate_zeroed(context, count, 1);
  if (*hidden == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < count; i++) {
    const double value = ghost_types[i];
    const unsigned bits = value >= 0 && value < 256 ? (unsigned)value : 0;
    (*hidden)[i] |= are_levels ? bits > 0 : (bits & (of_cells ? LEFT_OUT_CELL : LEFT_OUT_POINT)) != 0;
  }
  return CELLIST_SUCCESS;
}

/* A joined array of per_item bytes each; pieces without the array give zeros. */
static void *join(cellist_context *context, size_t total, size_t per_item, size_t piece_count,
                  const struct grid *pieces, size_t count_at, size_t array_at) {
  char *joined = cellist_allocate(context, total, per_item);
  if (joined == NULL) return NULL;
  char *to = joined;
  for (size_t p = 0; p < piece_count; p++) {
    size_t count;
    const void *array;
    memcpy(&count, (const char *)&pieces[p] + count_at, sizeof count);
    memcpy(&array, (const char *)&pieces[p] + array_at, sizeof array);
    if (count > 0 && array != NULL) memcpy(to, array, count * per_item);
    if (count > 0 && array == NULL) memset(to, 0, count * per_item);
    to += count * per_item;
  }
  return joined;
}

#define JOIN(array, total, count)                                                              \
  join(context, total, sizeof *grid->array, piece_count, pieces, offsetof(struct grid, count), \
       offsetof(struct grid, array))

static cellist_result join_cells(cellist_context *context, size_t piece_count, const struct grid *pieces,
                                 struct grid *grid) {
  size_t connectivity_count = 0;
  bool any_faces = false;
  for (size_t p = 0; p < piece_count; p++) {
    connectivity_count += pieces[p].cell_count > 0 ? pieces[p].offsets[pieces[p].cell_count] : 0;
    any_faces |= pieces[p].face_starts != NULL;
  }
  grid->offsets = cellist_allocate(context, grid->cell_count + 1, sizeof *grid->offsets);
  grid->connectivity = cellist_allocate(context, connectivity_count, sizeof *grid->connectivity);
  if (grid->offsets == NULL || grid->connectivity == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (any_faces) {
    grid->face_starts = cellist_allocate(context, grid->cell_count, sizeof *grid->face_starts);
    grid->faces = JOIN(faces, grid->face_count, face_count);
    if (grid->face_starts == NULL || grid->faces == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  size_t cell = 0, at = 0, first_point = 0, first_face = 0;
  for (size_t p = 0; p < piece_count; p++) {
    const struct grid *piece = &pieces[p];
    for (size_t i = 0; i < piece->cell_count; i++, cell++) {
      grid->offsets[cell] = at + piece->offsets[i];
      if (any_faces) grid->face_starts[cell] = piece->face_starts != NULL ? piece->face_starts[i] : SIZE_MAX;
      if (any_faces && grid->face_starts[cell] != SIZE_MAX) grid->face_starts[cell] += first_face;
    }
    const size_t count = piece->cell_count > 0 ? piece->offsets[piece->cell_count] : 0;
    for (size_t i = 0; i < count; i++) {
      /* An id out of its piece's range must not hit another piece's point. */
      const uint32_t id = piece->connectivity[i];
      grid->connectivity[at + i] = id < piece->point_count ? (uint32_t)(id + first_point) : CELLIST_NONE;
    }
    at += count;
    first_point += piece->point_count;
    first_face += piece->face_count;
  }
  grid->offsets[cell] = at;
  return CELLIST_SUCCESS;
}

/* The numbers in faces are point ids only where a face's size says so. */
static void shift_faces(const struct grid *pieces, size_t piece_count, struct grid *grid) {
  size_t first_point = 0, cell = 0;
  for (size_t p = 0; p < piece_count; first_point += pieces[p].point_count, p++)
    for (size_t i = 0; i < pieces[p].cell_count; i++, cell++) {
      size_t at = grid->face_starts[cell];
      if (at >= grid->face_count) continue;
      size_t left = grid->faces[at++];
      for (; left > 0 && at < grid->face_count; left--) {
        size_t corners = grid->faces[at++];
        for (; corners > 0 && at < grid->face_count; corners--, at++)
          grid->faces[at] =
              grid->faces[at] < pieces[p].point_count ? (uint32_t)(grid->faces[at] + first_point) : CELLIST_NONE;
      }
    }
}

static cellist_result join_fields(cellist_context *context, size_t piece_count, const struct grid *pieces,
                                  struct grid *grid) {
  for (size_t i = 0; i < pieces[0].field_count; i++) {
    const cellist_field *field = &pieces[0].fields[i];
    const bool on_points = field->association == CELLIST_ON_POINTS;
    const size_t total = on_points ? grid->point_count : grid->cell_count;
    bool everywhere = true;
    for (size_t p = 1; p < piece_count && everywhere; p++) {
      const size_t count = on_points ? pieces[p].point_count : pieces[p].cell_count;
      const cellist_field *other = find_field(&pieces[p], field->name, field->association);
      everywhere = count == 0 || (other != NULL && other->component_count == field->component_count);
    }
    if (!everywhere) {
      cellist_log(context, CELLIST_LOG_WARNING, "%s: array '%s' is not in every piece: left out", grid->file,
                  field->name);
      continue;
    }
    double *values = cellist_allocate(context, total, field->component_count * sizeof *values);
    if (values == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    size_t at = 0;
    for (size_t p = 0; p < piece_count; p++) {
      const size_t count = (on_points ? pieces[p].point_count : pieces[p].cell_count) * field->component_count;
      const cellist_field *other = find_field(&pieces[p], field->name, field->association);
      if (count > 0 && other != NULL) memcpy(values + at, other->values, count * sizeof *values);
      at += count;
    }
    const cellist_result result =
        grid_add_field(context, grid, field->name, field->association, field->component_count, values);
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

static cellist_result join_pieces(cellist_context *context, size_t piece_count, const struct grid *pieces,
                                  struct grid *grid) {
  bool any_hidden_points = false, any_hidden_cells = false;
  for (size_t p = 0; p < piece_count; p++) {
    grid->point_count += pieces[p].point_count;
    grid->cell_count += pieces[p].cell_count;
    grid->face_count += pieces[p].face_count;
    grid->skipped_cell_count += pieces[p].skipped_cell_count;
    any_hidden_points |= pieces[p].hidden_points != NULL;
    any_hidden_cells |= pieces[p].hidden_cells != NULL;
  }
  if (grid->point_count >= CELLIST_NONE)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: %zu points are more than 32-bit ids allow", grid->file,
                        grid->point_count);
  grid->points = join(context, grid->point_count, 3 * sizeof(double), piece_count, pieces,
                      offsetof(struct grid, point_count), offsetof(struct grid, points));
  grid->types = JOIN(types, grid->cell_count, cell_count);
  if (grid->points == NULL || grid->types == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (any_hidden_points) {
    grid->hidden_points = JOIN(hidden_points, grid->point_count, point_count);
    if (grid->hidden_points == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  if (any_hidden_cells) {
    grid->hidden_cells = JOIN(hidden_cells, grid->cell_count, cell_count);
    if (grid->hidden_cells == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  const cellist_result result = join_cells(context, piece_count, pieces, grid);
  if (result != CELLIST_SUCCESS) return result;
  if (grid->face_starts != NULL) shift_faces(pieces, piece_count, grid);
  return join_fields(context, piece_count, pieces, grid);
}

cellist_result grid_concatenate(cellist_context *context, size_t piece_count, struct grid *pieces, struct grid *grid) {
  if (piece_count == 1) {
    *grid = pieces[0];
    pieces[0] = (struct grid){0};
    return CELLIST_SUCCESS;
  }
  grid->file = pieces[0].file;
  const cellist_result result = join_pieces(context, piece_count, pieces, grid);
  for (size_t p = 0; p < piece_count; p++) grid_release(context, &pieces[p]);
  if (result != CELLIST_SUCCESS) grid_release(context, grid);
  return result;
}
