/* SPDX-License-Identifier: BSD-3-Clause
 * Legacy VTK, text and binary, versions 1 to 5: the header, points and cells of UNSTRUCTURED_GRID and
 * STRUCTURED_GRID. Up to version 4 a cell's size stands before its points; from 5 on offsets stand apart. */
#include "legacy.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "../read.h"

cellist_result legacy_fail(struct legacy *legacy, const char *format, ...) {
  char reason[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason, sizeof reason, format, arguments);
  va_end(arguments);
  if (!legacy->is_binary) return text_fail(legacy->context, legacy->source, &legacy->text, "%s", reason);
  return source_fail_at(legacy->context, legacy->source, (size_t)(legacy->text.at - legacy->text.begin), "%s", reason);
}

bool legacy_type_of(struct text_word word, enum element_type *type, bool *is_packed) {
  static const struct {
    const char *name;
    enum element_type type;
  } types[] = {{"char", ELEMENT_INT8},
               {"signed_char", ELEMENT_INT8},
               {"unsigned_char", ELEMENT_UINT8},
               {"short", ELEMENT_INT16},
               {"unsigned_short", ELEMENT_UINT16},
               {"int", ELEMENT_INT32},
               {"vtkidtype", ELEMENT_INT32}, /* always 32 bits in a file */
               {"unsigned_int", ELEMENT_UINT32},
               {"long", ELEMENT_INT64},
               {"unsigned_long", ELEMENT_UINT64},
               {"vtktypeint64", ELEMENT_INT64},
               {"vtktypeuint64", ELEMENT_UINT64},
               {"float", ELEMENT_FLOAT32},
               {"double", ELEMENT_FLOAT64},
               {"bit", ELEMENT_UINT8}};
  *is_packed = text_word_is_like(word, "bit");
  for (size_t i = 0; i < sizeof types / sizeof *types; i++)
    if (text_word_is_like(word, types[i].name)) {
      *type = types[i].type;
      return true;
    }
  return false;
}

static bool next_type(struct legacy *legacy, enum element_type *type) {
  bool is_packed = false;
  return legacy_type_of(text_next_word(&legacy->text), type, &is_packed) && !is_packed;
}

/* A count, of which the rest of the file can hold the values' bytes (or their text) at least. */
static bool next_count(struct legacy *legacy, size_t *count) { return text_next_count(&legacy->text, 1, count); }

static cellist_result read_points(struct legacy *legacy) {
  struct grid *grid = legacy->grid;
  size_t count = 0;
  enum element_type type;
  void *values = NULL;
  if (grid->points != NULL) return legacy_fail(legacy, "has POINTS twice");
  if (!next_count(legacy, &count) || !next_type(legacy, &type))
    return legacy_fail(legacy, "POINTS is not followed by a count that the file can hold and a type");
  if (legacy->is_structured && count != grid->point_count)
    return legacy_fail(legacy, "has %zu points, but its DIMENSIONS ask for %zu", count, grid->point_count);
  if (count >= CELLIST_NONE / 3) return legacy_fail(legacy, "has %zu points, too many", count);
  grid->point_count = count;
  const cellist_result result = legacy_read_values(legacy, type, ELEMENT_AS_DOUBLE, 3 * count, &values);
  grid->points = values;
  return result;
}

/* Up to version 4: size, points, size, points, ... */
static cellist_result split_sizes(struct legacy *legacy, const uint32_t *numbers, size_t number_count) {
  struct grid *grid = legacy->grid;
  grid->offsets = cellist_allocate(legacy->context, grid->cell_count + 1, sizeof *grid->offsets);
  if (grid->offsets == NULL || number_count < grid->cell_count)
    return grid->offsets == NULL ? CELLIST_ERROR_OUT_OF_MEMORY : legacy_fail(legacy, "CELLS holds too few numbers");
  grid->connectivity = cellist_allocate(legacy->context, number_count - grid->cell_count, sizeof *grid->connectivity);
  if (grid->connectivity == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  size_t at = 0, end = 0;
  grid->offsets[0] = 0;
  for (size_t i = 0; i < grid->cell_count; i++) {
    if (at >= number_count || numbers[at] > number_count - at - 1 ||
        numbers[at] > number_count - grid->cell_count - end)
      return legacy_fail(legacy, "cell %zu goes beyond the end of CELLS", i);
    const size_t size = numbers[at++];
    if (size > 0) memcpy(&grid->connectivity[end], &numbers[at], size * sizeof *numbers);
    at += size;
    end += size;
    grid->offsets[i + 1] = end;
  }
  return at == number_count ? CELLIST_SUCCESS : legacy_fail(legacy, "CELLS holds more numbers than its cells");
}

static cellist_result read_old_cells(struct legacy *legacy, size_t number_count) {
  void *values = NULL;
  cellist_result result = legacy_read_values(legacy, ELEMENT_INT32, ELEMENT_AS_ID, number_count, &values);
  if (result == CELLIST_SUCCESS) result = split_sizes(legacy, values, number_count);
  cellist_deallocate(legacy->context, values);
  return result;
}

static cellist_result read_new_cells(struct legacy *legacy, size_t offset_count, size_t number_count) {
  struct grid *grid = legacy->grid;
  enum element_type type;
  void *values = NULL;
  if (!text_word_is_like(text_next_word(&legacy->text), "OFFSETS") || !next_type(legacy, &type))
    return legacy_fail(legacy, "CELLS is not followed by OFFSETS and a type");
  cellist_result result = legacy_read_values(legacy, type, ELEMENT_AS_SIZE, offset_count, &values);
  grid->offsets = values;
  if (result != CELLIST_SUCCESS) return result;
  if (!text_word_is_like(text_next_word(&legacy->text), "CONNECTIVITY") || !next_type(legacy, &type))
    return legacy_fail(legacy, "OFFSETS is not followed by CONNECTIVITY and a type");
  result = legacy_read_values(legacy, type, ELEMENT_AS_ID, number_count, &values);
  grid->connectivity = values;
  if (result != CELLIST_SUCCESS) return result;
  for (size_t i = 0; i < offset_count; i++)
    if (grid->offsets[i] > number_count || grid->offsets[i] < (i > 0 ? grid->offsets[i - 1] : 0))
      return legacy_fail(legacy, "offset %zu of the cells is out of order", i);
  if (offset_count > 0 && (grid->offsets[0] != 0 || grid->offsets[offset_count - 1] != number_count))
    return legacy_fail(legacy, "the cells' offsets do not cover CONNECTIVITY");
  return CELLIST_SUCCESS;
}

static cellist_result read_cells(struct legacy *legacy) {
  size_t count = 0, number_count = 0;
  if (legacy->grid->offsets != NULL || legacy->is_structured)
    return legacy_fail(legacy, "has CELLS that it should not have");
  if (!next_count(legacy, &count) || !next_count(legacy, &number_count))
    return legacy_fail(legacy, "CELLS is not followed by two counts that the file can hold");
  if (legacy->version < 5) {
    legacy->grid->cell_count = count;
    return read_old_cells(legacy, number_count);
  }
  legacy->grid->cell_count = count > 0 ? count - 1 : 0;
  return read_new_cells(legacy, count, number_count);
}

/* The numbers of polyhedra are faces, not points: they go where grids keep these. */
static cellist_result move_polyhedra(struct legacy *legacy) {
  struct grid *grid = legacy->grid;
  if (grid->cell_count == 0 || memchr(grid->types, GRID_POLYHEDRON, grid->cell_count) == NULL) return CELLIST_SUCCESS;
  grid->face_count = grid->offsets[grid->cell_count];
  grid->faces = cellist_allocate(legacy->context, grid->face_count, sizeof *grid->faces);
  grid->face_starts = cellist_allocate(legacy->context, grid->cell_count, sizeof *grid->face_starts);
  if (grid->faces == NULL || grid->face_starts == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (grid->face_count > 0) memcpy(grid->faces, grid->connectivity, grid->face_count * sizeof *grid->faces);
  for (size_t i = 0; i < grid->cell_count; i++)
    grid->face_starts[i] = grid->types[i] == GRID_POLYHEDRON ? grid->offsets[i] : SIZE_MAX;
  return CELLIST_SUCCESS;
}

static cellist_result read_cell_types(struct legacy *legacy) {
  struct grid *grid = legacy->grid;
  size_t count = 0;
  void *values = NULL;
  if (grid->types != NULL || grid->offsets == NULL || !next_count(legacy, &count) || count != grid->cell_count)
    return legacy_fail(legacy, "CELL_TYPES does not follow CELLS with as many cells");
  const cellist_result result = legacy_read_values(legacy, ELEMENT_INT32, ELEMENT_AS_BYTE, count, &values);
  grid->types = values;
  return result == CELLIST_SUCCESS ? move_polyhedra(legacy) : result;
}

static cellist_result read_dimensions(struct legacy *legacy, struct grid_block *block) {
  struct grid *grid = legacy->grid;
  for (int k = 0; k < 3; k++) {
    int64_t size = 0;
    if (!text_next_integer(&legacy->text, &size) || size < 1 || size > INT32_MAX)
      return legacy_fail(legacy, "DIMENSIONS is not followed by three sizes");
    block->size[k] = (size_t)size;
  }
  if (__builtin_mul_overflow(block->size[0], block->size[1], &grid->point_count) ||
      __builtin_mul_overflow(grid->point_count, block->size[2], &grid->point_count))
    return legacy_fail(legacy, "DIMENSIONS are too large");
  return CELLIST_SUCCESS;
}

static cellist_result read_sections(struct legacy *legacy, struct grid_block *block) {
  struct grid *grid = legacy->grid;
  for (;;) {
    const struct text_word word = text_next_word(&legacy->text);
    cellist_result result = CELLIST_SUCCESS;
    if (word.length == 0 || text_word_is_like(word, "POINT_DATA") || text_word_is_like(word, "CELL_DATA")) {
      if (grid->points == NULL) return legacy_fail(legacy, "has no POINTS");
      if (legacy->is_structured) result = grid_make_structured(legacy->context, grid, 1, block);
      if (!legacy->is_structured && grid->cell_count > 0 && grid->types == NULL)
        return legacy_fail(legacy, "has no CELL_TYPES");
      return result == CELLIST_SUCCESS && word.length > 0 ? legacy_read_attributes(legacy, word) : result;
    }
    if (text_word_is_like(word, "POINTS"))
      result = read_points(legacy);
    else if (text_word_is_like(word, "CELLS"))
      result = read_cells(legacy);
    else if (text_word_is_like(word, "CELL_TYPES"))
      result = read_cell_types(legacy);
    else if (text_word_is_like(word, "DIMENSIONS") && legacy->is_structured && grid->points == NULL)
      result = read_dimensions(legacy, block);
    else if (text_word_is_like(word, "FIELD"))
      result = legacy_skip_field(legacy);
    else if (text_word_is_like(word, "METADATA"))
      legacy_skip_metadata(legacy);
    else
      result = legacy_fail(legacy, "'%.*s' is no section of this kind of file",
                           (int)(word.length < 40 ? word.length : 40), (const char *)word.begin);
    if (result != CELLIST_SUCCESS) return result;
  }
}

/* DATASET may come after a FIELD with the time. */
static cellist_result read_dataset(struct legacy *legacy) {
  struct text_word word = text_next_word(&legacy->text);
  while (text_word_is_like(word, "FIELD") || text_word_is_like(word, "METADATA")) {
    if (text_word_is_like(word, "FIELD")) {
      const cellist_result result = legacy_skip_field(legacy);
      if (result != CELLIST_SUCCESS) return result;
    } else {
      legacy_skip_metadata(legacy);
    }
    word = text_next_word(&legacy->text);
  }
  if (!text_word_is_like(word, "DATASET")) return legacy_fail(legacy, "has no DATASET");
  word = text_next_word(&legacy->text);
  legacy->is_structured = text_word_is_like(word, "STRUCTURED_GRID");
  if (!legacy->is_structured && !text_word_is_like(word, "UNSTRUCTURED_GRID"))
    return cellist_fail(legacy->context, CELLIST_ERROR_UNSUPPORTED,
                        "%s: is a data set of kind %.*s; only UNSTRUCTURED_GRID and STRUCTURED_GRID are meshes",
                        legacy->source->name, (int)(word.length < 40 ? word.length : 40), (const char *)word.begin);
  struct grid_block block = {{0, 0, 0}};
  return read_sections(legacy, &block);
}

cellist_result read_vtk_legacy(cellist_context *context, const struct source *source, struct grid *grid) {
  static const char magic[] = "# vtk DataFile Version ";
  struct legacy legacy = {.context = context, .source = source, .text = text_of(source, 0), .grid = grid};
  *grid = (struct grid){.file = source->name};
  if (source->size <= sizeof magic || memcmp(source->bytes, magic, sizeof magic - 1) != 0)
    return source_fail(context, source, "does not begin with '%s'", magic);
  legacy.text.at += sizeof magic - 1;
  const uint8_t digit = *legacy.text.at;
  legacy.version = digit - '0';
  if (digit < '1' || digit > '5')
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: is of a legacy VTK version that is not known",
                        source->name);
  text_skip_line(&legacy.text);
  text_skip_line(&legacy.text); /* the title */
  const struct text_word kind = text_next_word(&legacy.text);
  cellist_result result = CELLIST_SUCCESS;
  if (!text_word_is_like(kind, "ASCII") && !text_word_is_like(kind, "BINARY"))
    result = legacy_fail(&legacy, "the third line is neither ASCII nor BINARY");
  legacy.is_binary = text_word_is_like(kind, "BINARY");
  if (result == CELLIST_SUCCESS) result = read_dataset(&legacy);
  if (result != CELLIST_SUCCESS) grid_release(context, grid);
  return result;
}
