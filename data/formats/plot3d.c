/* SPDX-License-Identifier: BSD-3-Clause
 * PLOT3D: whole three-dimensional grids, with the solution beside them.
 *
 * The format does not say what it is: little- or big-endian, with or without Fortran's record markers, one block or
 * several, float or double, with or without IBLANK. Each of the 32 variants predicts the file's size from its first
 * numbers; the one that fits (zeros may follow) is it. A solution must have the grid's dimensions. */
#include <string.h>

#include "element.h"
#include "read.h"

struct variant {
  bool swap, has_records, is_multi, is_double, has_iblank;
};

struct layout {
  struct variant variant;
  size_t block_count;
  size_t sizes;       /* where the blocks' sizes stand */
  size_t data;        /* where the first block's data (or its record marker) stand */
  size_t point_count; /* of all blocks */
  size_t end;         /* what the variant predicts */
};

static uint32_t word_at(const struct source *source, const struct layout *layout, size_t at) {
  return element_load_u32(source->bytes + at, layout->variant.swap);
}

static struct grid_block block_size(const struct source *source, const struct layout *layout, size_t block) {
  const size_t at = layout->sizes + 12 * block;
  return (struct grid_block){
      {word_at(source, layout, at), word_at(source, layout, at + 4), word_at(source, layout, at + 8)}};
}

/* Whether a record of size bytes stands at *at, which is moved to its content; without records always. */
static bool open_record(const struct source *source, const struct layout *layout, size_t *at, size_t size) {
  if (!layout->variant.has_records) return source->size - *at >= size;
  if (source->size - *at < 8 || source->size - *at - 8 < size || word_at(source, layout, *at) != size ||
      word_at(source, layout, *at + 4 + size) != size)
    return false;
  *at += 4;
  return true;
}

static void close_record(const struct layout *layout, size_t *at, size_t size) {
  *at += size + (layout->variant.has_records ? 4 : 0);
}

/* The bytes of a block: of a grid, or of a solution (four numbers and five arrays). False if it is too large. */
static bool block_bytes(const struct layout *layout, const struct grid_block *block, bool is_solution, size_t *points,
                        size_t *bytes) {
  const size_t *n = block->size, real = layout->variant.is_double ? 8 : 4;
  if (n[0] == 0 || n[1] == 0 || n[2] == 0 || n[0] > INT32_MAX || n[1] > INT32_MAX || n[2] > INT32_MAX) return false;
  if (__builtin_mul_overflow(n[0], n[1], points) || __builtin_mul_overflow(*points, n[2], points)) return false;
  if (*points >= CELLIST_NONE) return false;
  *bytes =
      is_solution ? 4 * real + 5 * real * *points : 3 * real * *points + (layout->variant.has_iblank ? 4 * *points : 0);
  return true;
}

/* Fills layout by its variant; false if the file does not fit it. */
static bool predict(const struct source *source, bool is_solution, struct layout *layout) {
  size_t at = 0;
  layout->block_count = 1;
  if (layout->variant.is_multi) {
    if (!open_record(source, layout, &at, 4)) return false;
    layout->block_count = word_at(source, layout, at);
    close_record(layout, &at, 4);
  }
  if (layout->block_count == 0 || layout->block_count > (source->size - at) / 12) return false;
  if (!open_record(source, layout, &at, 12 * layout->block_count)) return false;
  layout->sizes = at;
  close_record(layout, &at, 12 * layout->block_count);
  layout->data = at;
  layout->point_count = 0;
  for (size_t b = 0; b < layout->block_count; b++) {
    const struct grid_block block = block_size(source, layout, b);
    size_t points = 0, bytes = 0;
    if (!block_bytes(layout, &block, is_solution, &points, &bytes)) return false;
    if (at > source->size || !open_record(source, layout, &at, bytes)) return false;
    close_record(layout, &at, bytes);
    layout->point_count += points;
  }
  layout->end = at;
  return layout->point_count < CELLIST_NONE;
}

static bool are_zeros(const struct source *source, size_t from) {
  for (size_t i = from; i < source->size; i++)
    if (source->bytes[i] != 0) return false;
  return true;
}

/* The variant that leaves the fewest bytes over, which must be zeros. */
static bool detect(const struct source *source, bool is_solution, struct layout *best) {
  bool found = false;
  for (unsigned bits = 0; bits < 32; bits++) {
    struct layout layout = {
        .variant = {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0, (bits & 16) != 0}};
    if (is_solution && layout.variant.has_iblank) continue;
    if (!predict(source, is_solution, &layout) || (found && layout.end <= best->end)) continue;
    *best = layout;
    found = true;
  }
  return found && are_zeros(source, best->end);
}

bool plot3d_is_grid(const struct source *source) {
  struct layout layout;
  return detect(source, false, &layout);
}

/* One array of count numbers into values, width apart. */
static void load_array(const struct source *source, const struct layout *layout, size_t at, size_t count,
                       double *values, size_t width) {
  double batch[512];
  const size_t each = layout->variant.is_double ? 8 : 4;
  for (size_t begin = 0; begin < count; begin += 512) {
    const size_t part = count - begin < 512 ? count - begin : 512;
    struct element_sink sink = {.type = layout->variant.is_double ? ELEMENT_FLOAT64 : ELEMENT_FLOAT32,
                                .swap = layout->variant.swap,
                                .kind = ELEMENT_AS_DOUBLE,
                                .values = batch,
                                .count = part};
    element_sink_push(&sink, source->bytes + at + each * begin, each * part);
    for (size_t i = 0; i < part; i++) values[width * (begin + i)] = batch[i];
  }
}

static cellist_result read_points(cellist_context *context, const struct source *source, const struct layout *layout,
                                  struct grid *grid) {
  const size_t each = layout->variant.is_double ? 8 : 4;
  grid->point_count = layout->point_count;
  grid->points = cellist_allocate(context, grid->point_count, 3 * sizeof *grid->points);
  if (grid->points == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (layout->variant.has_iblank) {
    grid->hidden_points = cellist_allocate(context, grid->point_count, 1);
    if (grid->hidden_points == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  size_t at = layout->data, first = 0;
  for (size_t b = 0; b < layout->block_count; b++) {
    const struct grid_block block = block_size(source, layout, b);
    size_t count = 0, bytes = 0;
    block_bytes(layout, &block, false, &count, &bytes);
    open_record(source, layout, &at, bytes);
    for (size_t k = 0; k < 3; k++)
      load_array(source, layout, at + k * each * count, count, grid->points + 3 * first + k, 3);
    for (size_t i = 0; i < count && layout->variant.has_iblank; i++)
      grid->hidden_points[first + i] = word_at(source, layout, at + 3 * each * count + 4 * i) == 0;
    close_record(layout, &at, bytes);
    first += count;
  }
  return CELLIST_SUCCESS;
}

static bool have_same_sizes(const struct source *grid_source, const struct layout *grid_layout,
                            const struct source *source, const struct layout *layout) {
  if (grid_layout->block_count != layout->block_count) return false;
  for (size_t b = 0; b < layout->block_count; b++) {
    const struct grid_block x = block_size(grid_source, grid_layout, b), y = block_size(source, layout, b);
    if (memcmp(&x, &y, sizeof x) != 0) return false;
  }
  return true;
}

/* Density, momentum and energy, named as VTK's reader names them. */
static cellist_result read_solution(cellist_context *context, const struct source *source, const struct layout *layout,
                                    struct grid *grid) {
  static const struct {
    const char *name;
    size_t first, width;
  } variables[] = {{"Density", 0, 1}, {"Momentum", 1, 3}, {"StagnationEnergy", 4, 1}};
  const size_t each = layout->variant.is_double ? 8 : 4;
  for (size_t v = 0; v < 3; v++) {
    const size_t width = variables[v].width;
    double *values = cellist_allocate(context, grid->point_count, width * sizeof *values);
    if (values == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    size_t at = layout->data, first = 0;
    for (size_t b = 0; b < layout->block_count; b++) {
      const struct grid_block block = block_size(source, layout, b);
      size_t count = 0, bytes = 0;
      block_bytes(layout, &block, true, &count, &bytes);
      open_record(source, layout, &at, bytes);
      for (size_t k = 0; k < width; k++)
        load_array(source, layout, at + each * (4 + (variables[v].first + k) * count), count,
                   values + width * first + k, width);
      close_record(layout, &at, bytes);
      first += count;
    }
    const cellist_result result = grid_add_field(context, grid, variables[v].name, CELLIST_ON_POINTS, width, values);
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

/* Opens the user's solution, or the one beside the grid; *found says whether there is one. */
static cellist_result open_solution(cellist_context *context, const struct source *source, struct source *solution,
                                    bool *found) {
  static const char *const endings[][2] = {{"xyz.bin", "q.bin"}, {".xyz", ".q"}, {".x", ".q"},  {".g", ".q"},
                                           {".grd", ".q"},       {".p3d", ".q"}, {".bin", ".q"}};
  *found = true;
  if (source->solution != NULL) return source_open(context, source->solution, solution);
  *found = false;
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < sizeof endings / sizeof *endings && result == CELLIST_SUCCESS && !*found; i++)
    if (source_has_suffix(source, endings[i][0]))
      result = source_try_sibling(context, source, strlen(endings[i][0]), endings[i][1], solution, found);
  return result;
}

static cellist_result read_beside(cellist_context *context, const struct source *source, const struct layout *layout,
                                  struct grid *grid) {
  struct source solution = {0};
  struct layout variables;
  bool found = false;
  cellist_result result = open_solution(context, source, &solution, &found);
  if (result != CELLIST_SUCCESS || !found) return result;
  if (!detect(&solution, true, &variables))
    result = source_fail(context, &solution, "is no PLOT3D solution: its size fits no variant of the format");
  else if (!have_same_sizes(source, layout, &solution, &variables))
    result = source_fail(context, &solution, "has other dimensions than its grid %s", source->name);
  else
    result = read_solution(context, &solution, &variables, grid);
  source_close(context, &solution);
  return result;
}

cellist_result read_plot3d(cellist_context *context, const struct source *source, struct grid *grid) {
  struct layout layout;
  *grid = (struct grid){.file = source->name};
  if (!detect(source, false, &layout))
    return source_fail(context, source, "is no PLOT3D grid: its size fits no variant of the format");
  struct grid_block *blocks = cellist_allocate(context, layout.block_count, sizeof *blocks);
  if (blocks == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t b = 0; b < layout.block_count; b++) blocks[b] = block_size(source, &layout, b);
  cellist_result result = read_points(context, source, &layout, grid);
  if (result == CELLIST_SUCCESS) result = grid_make_structured(context, grid, layout.block_count, blocks);
  if (result == CELLIST_SUCCESS) result = read_beside(context, source, &layout, grid);
  cellist_deallocate(context, blocks);
  if (result != CELLIST_SUCCESS) grid_release(context, grid);
  return result;
}
