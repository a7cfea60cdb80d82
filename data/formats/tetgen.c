/* SPDX-License-Identifier: BSD-3-Clause
 * TetGen: .node (points and their attributes), .ele (tets and their region) and .face (counted only), whichever of
 * them is named. Ids begin at 0 or 1, as the first point says. */
#include <string.h>

#include "read.h"
#include "text.h"

struct tetgen {
  cellist_context *context;
  int64_t first_id;
  struct grid *grid;
};

static cellist_result read_nodes(struct tetgen *tetgen, const struct source *source) {
  cellist_context *context = tetgen->context;
  struct grid *grid = tetgen->grid;
  struct text text = text_of(source, '#');
  int64_t dimension = 0, marker_count = 0;
  size_t attribute_count = 0;
  if (!text_next_count(&text, 8, &grid->point_count) || !text_next_integer(&text, &dimension) ||
      !text_next_count(&text, 2, &attribute_count) || !text_next_integer(&text, &marker_count) || dimension != 3)
    return text_fail(context, source, &text, "does not begin with 'points 3 attributes markers' that it can hold");
  /* A line has at least two bytes for each number. */
  const size_t width = 4 + attribute_count + (marker_count > 0);
  if (grid->point_count > 0 && width > ((size_t)(text.end - text.at) + 1) / 2 / grid->point_count)
    return text_fail(context, source, &text, "is too short for %zu points of %zu attributes", grid->point_count,
                     attribute_count);
  grid->points = cellist_allocate(context, grid->point_count, 3 * sizeof *grid->points);
  if (grid->points == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  double *attributes = cellist_allocate(context, grid->point_count, attribute_count * sizeof *attributes);
  if (attributes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < grid->point_count && result == CELLIST_SUCCESS; i++) {
    int64_t id = 0;
    double marker = 0;
    bool ok = text_next_integer(&text, &id);
    if (i == 0) tetgen->first_id = id;
    if (!ok || (id != 0 && id != 1 && i == 0) || id != tetgen->first_id + (int64_t)i) {
      result = text_fail(context, source, &text, "point %zu has another id", i);
      break;
    }
    for (size_t k = 0; k < 3 && ok; k++) ok = text_next_double(&text, &grid->points[3 * i + k]);
    for (size_t k = 0; k < attribute_count && ok; k++)
      ok = text_next_double(&text, &attributes[attribute_count * i + k]);
    if (ok && marker_count > 0) ok = text_next_double(&text, &marker);
    if (!ok) result = text_fail(context, source, &text, "a number of point %lld is missing or none", (long long)id);
  }
  if (result == CELLIST_SUCCESS && attribute_count > 0)
    return grid_add_field(context, grid, "attribute", CELLIST_ON_POINTS, attribute_count, attributes);
  cellist_deallocate(context, attributes);
  return result;
}

static cellist_result read_elements(struct tetgen *tetgen, const struct source *source) {
  cellist_context *context = tetgen->context;
  struct grid *grid = tetgen->grid;
  struct text text = text_of(source, '#');
  size_t tet_count = 0;
  int64_t corner_count = 0, attribute_count = 0;
  if (!text_next_count(&text, 10, &tet_count) || !text_next_integer(&text, &corner_count) ||
      !text_next_integer(&text, &attribute_count) || (corner_count != 4 && corner_count != 10) || attribute_count < 0 ||
      attribute_count > 1)
    return text_fail(context, source, &text, "does not begin with 'tets 4 (or 10) attributes' that it can hold");
  cellist_result result =
      grid_make_uniform(context, grid, tet_count, GRID_TETRA, 4, NULL); /* 10: the corners come first */
  double *regions = cellist_allocate(context, attribute_count > 0 ? tet_count : 0, sizeof *regions);
  if (regions == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < tet_count && result == CELLIST_SUCCESS; i++) {
    int64_t id = 0;
    bool ok = text_next_integer(&text, &id) && id == tetgen->first_id + (int64_t)i;
    for (int64_t k = 0; k < corner_count && ok; k++) {
      ok = text_next_integer(&text, &id);
      id -= tetgen->first_id;
      if (ok && k < 4) ok = element_store_integer(ELEMENT_AS_ID, grid->connectivity, 4 * i + (size_t)k, id);
    }
    if (ok && attribute_count > 0) ok = text_next_double(&text, &regions[i]);
    if (!ok) result = text_fail(context, source, &text, "tet %zu has another id, or a number is missing", i);
  }
  if (result == CELLIST_SUCCESS && attribute_count > 0)
    return grid_add_field(context, grid, "region", CELLIST_ON_CELLS, 1, regions);
  cellist_deallocate(context, regions);
  if (result == CELLIST_SUCCESS && corner_count == 10)
    cellist_log(context, CELLIST_LOG_INFO, "%s: %zu cells of higher order are taken by their corners", source->name,
                tet_count);
  return result;
}

static cellist_result read_faces(struct tetgen *tetgen, const struct source *source) {
  struct text text = text_of(source, '#');
  if (text_next_count(&text, 8, &tetgen->grid->skipped_cell_count)) return CELLIST_SUCCESS;
  return text_fail(tetgen->context, source, &text, "does not begin with a count of faces that it can hold");
}

/* Reads the file with this ending: the source itself or the one beside it. */
static cellist_result read_part(struct tetgen *tetgen, const struct source *source, const char *ending, bool is_needed,
                                cellist_result (*read)(struct tetgen *tetgen, const struct source *source)) {
  if (source_has_suffix(source, ending)) return read(tetgen, source);
  struct source part;
  bool found = false;
  const size_t own_length = source_has_suffix(source, ".ele") ? 4 : 5; /* of .node or .face */
  cellist_result result = source_try_sibling(tetgen->context, source, own_length, ending, &part, &found);
  if (result == CELLIST_SUCCESS && found) result = read(tetgen, &part);
  if (result == CELLIST_SUCCESS && !found && is_needed)
    result = cellist_fail(tetgen->context, CELLIST_ERROR_IO, "%s: the %s file of this TetGen mesh is not beside it",
                          source->name, ending);
  source_close(tetgen->context, &part);
  return result;
}

cellist_result read_tetgen(cellist_context *context, const struct source *source, struct grid *grid) {
  struct tetgen tetgen = {.context = context, .grid = grid};
  *grid = (struct grid){.file = source->name};
  cellist_result result = read_part(&tetgen, source, ".node", true, read_nodes);
  if (result == CELLIST_SUCCESS) result = read_part(&tetgen, source, ".ele", true, read_elements);
  if (result == CELLIST_SUCCESS) result = read_part(&tetgen, source, ".face", false, read_faces);
  if (result != CELLIST_SUCCESS) grid_release(context, grid);
  return result;
}
