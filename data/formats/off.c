/* SPDX-License-Identifier: BSD-3-Clause
 * OFF with scalars: the tetrahedral variant of the classic volume-rendering sets. After an optional line "OFF" come the
 * counts of points and tets, a line "x y z" or "x y z scalar" a point, and a line "a b c d" or "4 a b c d" a tet. */
#include <string.h>

#include "read.h"
#include "text.h"

/* The shortest line: "0 0 0\n", "0 1 2 3\n". */
enum { POINT_BYTES = 6, TET_BYTES = 8 };

/* Words in the next line that has any. */
static size_t words_in_next_line(struct text *text) {
  size_t count = 0;
  while (text->at < text->end && (count = text_count_words_in_line(text)) == 0) text_skip_line(text);
  return count;
}

static cellist_result read_points(cellist_context *context, const struct source *source, struct text *text,
                                  struct grid *grid) {
  const size_t width = grid->point_count > 0 ? words_in_next_line(text) : 3;
  if (width != 3 && width != 4)
    return text_fail(context, source, text, "the first point has %zu numbers instead of x y z or x y z scalar", width);
  grid->points = cellist_allocate(context, grid->point_count, 3 * sizeof *grid->points);
  double *scalars = cellist_allocate(context, width == 4 ? grid->point_count : 0, sizeof *scalars);
  cellist_result result = grid->points != NULL && scalars != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < grid->point_count && result == CELLIST_SUCCESS; i++)
    for (size_t k = 0; k < width && result == CELLIST_SUCCESS; k++)
      if (!text_next_double(text, k < 3 ? &grid->points[3 * i + k] : &scalars[i]))
        result = text_fail(context, source, text, "number %zu of point %zu is missing or no number", k, i);
  if (result == CELLIST_SUCCESS && width == 4)
    return grid_add_field(context, grid, "scalar", CELLIST_ON_POINTS, 1, scalars);
  cellist_deallocate(context, scalars);
  return result;
}

static cellist_result read_tets(cellist_context *context, const struct source *source, struct text *text,
                                size_t tet_count, struct grid *grid) {
  const size_t width = tet_count > 0 ? words_in_next_line(text) : 4;
  if (width != 4 && width != 5)
    return text_fail(context, source, text, "the first cell has %zu numbers; tets have 4, or 5 with their size", width);
  cellist_result result = grid_make_uniform(context, grid, tet_count, GRID_TETRA, 4, NULL);
  for (size_t i = 0; i < tet_count && result == CELLIST_SUCCESS; i++) {
    int64_t size = 4;
    size_t filled = 0;
    if (width == 5 && (!text_next_integer(text, &size) || size != 4))
      result = text_fail(context, source, text, "cell %zu is no tet", i);
    else if (!text_read_values(text, ELEMENT_AS_ID, &grid->connectivity[4 * i], 4, &filled))
      result = text_fail(context, source, text, "corner %zu of cell %zu is missing or no point id", filled, i);
  }
  return result;
}

cellist_result read_off(cellist_context *context, const struct source *source, struct grid *grid) {
  struct text text = text_of(source, '#'), ahead = text;
  *grid = (struct grid){.file = source->name};
  if (text_word_is(text_next_word(&ahead), "OFF")) text = ahead;
  words_in_next_line(&text);
  size_t tet_count = 0;
  cellist_result result = CELLIST_SUCCESS;
  if (!text_next_count(&text, POINT_BYTES, &grid->point_count) || !text_next_count(&text, TET_BYTES, &tet_count))
    result = text_fail(context, source, &text, "does not begin with counts of points and tets that it can hold");
  text_skip_line(&text); /* a count of edges */
  if (result == CELLIST_SUCCESS) result = read_points(context, source, &text, grid);
  if (result == CELLIST_SUCCESS) result = read_tets(context, source, &text, tet_count, grid);
  if (result == CELLIST_SUCCESS && text_next_word(&text).length > 0)
    result = text_fail(context, source, &text, "goes on after its last cell");
  if (result != CELLIST_SUCCESS) grid_release(context, grid);
  return result;
}
