/* SPDX-License-Identifier: BSD-3-Clause
 * VTS: a structured grid from VTK's XML format. Pieces share the points between them, so each is put into its place
 * in the whole; the cells are then hexahedra. */
#include "xml.h"

#include <string.h>

/* A box of points (or cells) and the one that holds it. */
struct box {
  size_t begin[3], size[3];
};

static void extent_of(const int64_t extent[6], size_t size[3]) {
  for (int k = 0; k < 3; k++) size[k] = (size_t)(extent[2 * k + 1] - extent[2 * k]) + 1;
}

/* points and cells of an extent; false if there are too many. */
static bool count_extent(const size_t size[3], size_t *points, size_t *cells) {
  if (__builtin_mul_overflow(size[0], size[1], points) || __builtin_mul_overflow(*points, size[2], points))
    return false;
  *cells = (size[0] - 1) * (size[1] - 1) * (size[2] - 1);
  return *points < CELLIST_NONE;
}

/* Copies a box of items of width bytes into its place in the whole. */
static void put(void *whole, const size_t whole_size[3], const void *piece, const struct box *box, size_t width) {
  const char *from = piece;
  for (size_t z = 0; z < box->size[2]; z++)
    for (size_t y = 0; y < box->size[1]; y++, from += box->size[0] * width) {
      const size_t at = box->begin[0] + whole_size[0] * (box->begin[1] + y + whole_size[1] * (box->begin[2] + z));
      memcpy((char *)whole + at * width, from, box->size[0] * width);
    }
}

static cellist_result put_hidden(cellist_context *context, uint8_t **whole, size_t whole_count,
                                 const size_t whole_size[3], const uint8_t *piece, const struct box *box) {
  if (piece == NULL) return CELLIST_SUCCESS;
  if (*whole == NULL) *whole = cellist_allocate_zeroed(context, whole_count, 1);
  if (*whole == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  put(*whole, whole_size, piece, box, 1);
  return CELLIST_SUCCESS;
}

static cellist_result put_piece(cellist_context *context, struct grid *whole, const size_t whole_size[3],
                                const struct grid *piece, const struct box *box, bool is_first) {
  const size_t cell_whole[3] = {whole_size[0] - 1, whole_size[1] - 1, whole_size[2] - 1};
  struct box cells = *box;
  for (int k = 0; k < 3; k++) cells.size[k]--;
  put(whole->points, whole_size, piece->points, box, 3 * sizeof(double));
  cellist_result result =
      put_hidden(context, &whole->hidden_points, whole->point_count, whole_size, piece->hidden_points, box);
  if (result == CELLIST_SUCCESS && piece->cell_count > 0)
    result = put_hidden(context, &whole->hidden_cells, whole->cell_count, cell_whole, piece->hidden_cells, &cells);
  for (size_t i = 0; i < piece->field_count && result == CELLIST_SUCCESS; i++) {
    const cellist_field *field = &piece->fields[i];
    const bool on_points = field->association == CELLIST_ON_POINTS;
    if (is_first) {
      double *values = cellist_allocate_zeroed(context, on_points ? whole->point_count : whole->cell_count,
                                               field->component_count * sizeof *values);
      result = values != NULL
                   ? grid_add_field(context, whole, field->name, field->association, field->component_count, values)
                   : CELLIST_ERROR_OUT_OF_MEMORY;
    }
    for (size_t f = 0; f < whole->field_count && result == CELLIST_SUCCESS; f++) {
      const cellist_field *to = &whole->fields[f];
      if (to->association != field->association || to->component_count != field->component_count ||
          strcmp(to->name, field->name) != 0)
        continue;
      put((void *)to->values, on_points ? whole_size : cell_whole, field->values, on_points ? box : &cells,
          to->component_count * sizeof(double));
    }
  }
  return result;
}

static cellist_result read_piece(cellist_context *context, const struct source *source, struct xml_document *document,
                                 size_t index, struct grid *grid) {
  size_t size[3];
  extent_of(document->pieces[index].extent, size);
  grid->file = source->name;
  if (!count_extent(size, &grid->point_count, &grid->cell_count))
    return source_fail(context, source, "the extent of piece %zu is too large", index);
  cellist_result result = xml_read_points(context, source, document, index, grid->point_count, &grid->points);
  return result == CELLIST_SUCCESS ? xml_read_fields(context, source, document, index, grid) : result;
}

/* The pieces lie in the whole, and together hold at least its points: it costs no more memory than they do. */
static cellist_result check_extents(cellist_context *context, const struct source *source,
                                    const struct xml_document *document, size_t whole_count) {
  size_t sum = 0;
  for (size_t i = 0; i < document->piece_count; i++) {
    const int64_t *extent = document->pieces[i].extent, *whole = document->whole_extent;
    size_t size[3], points = 0, cells = 0;
    for (int k = 0; k < 6; k += 2)
      if (extent[k] < whole[k] || extent[k + 1] > whole[k + 1])
        return source_fail(context, source, "piece %zu does not lie in the whole extent", i);
    extent_of(extent, size);
    if (!count_extent(size, &points, &cells))
      return source_fail(context, source, "the extent of piece %zu is too large", i);
    sum += points;
  }
  return sum >= whole_count
             ? CELLIST_SUCCESS
             : source_fail(context, source, "the pieces hold %zu points of the whole extent's %zu", sum, whole_count);
}

static cellist_result read_pieces(cellist_context *context, const struct source *source, struct xml_document *document,
                                  const size_t size[3], struct grid *grid) {
  cellist_result result = check_extents(context, source, document, grid->point_count);
  for (size_t i = 0; i < document->piece_count && result == CELLIST_SUCCESS; i++) {
    struct grid piece = {0};
    struct box box;
    extent_of(document->pieces[i].extent, box.size);
    for (int k = 0; k < 3; k++)
      box.begin[k] = (size_t)(document->pieces[i].extent[2 * k] - document->whole_extent[2 * k]);
    result = read_piece(context, source, document, i, &piece);
    /* Only now is it known that the file holds the first piece. */
    if (result == CELLIST_SUCCESS && grid->points == NULL) {
      grid->points = cellist_allocate_zeroed(context, grid->point_count, 3 * sizeof *grid->points);
      if (grid->points == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
    }
    if (result == CELLIST_SUCCESS) result = put_piece(context, grid, size, &piece, &box, i == 0);
    grid_release(context, &piece);
  }
  return result;
}

cellist_result read_vts(cellist_context *context, const struct source *source, struct xml_document *document,
                        struct grid *grid) {
  size_t size[3];
  extent_of(document->whole_extent, size);
  grid->file = source->name;
  if (!count_extent(size, &grid->point_count, &grid->cell_count))
    return source_fail(context, source, "the whole extent is too large");
  const bool is_whole = document->piece_count == 1 &&
                        memcmp(document->pieces[0].extent, document->whole_extent, sizeof document->whole_extent) == 0;
  cellist_result result =
      is_whole ? read_piece(context, source, document, 0, grid) : read_pieces(context, source, document, size, grid);
  const struct grid_block block = {{size[0], size[1], size[2]}};
  if (result == CELLIST_SUCCESS) result = grid_make_structured(context, grid, 1, &block);
  return result;
}
