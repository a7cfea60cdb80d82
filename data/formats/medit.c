/* SPDX-License-Identifier: BSD-3-Clause
 * MEDIT .mesh: sections of a keyword, a count and lines that end in a reference number. Cells count through the file's
 * sections of edges, faces and volumes in their order; references become the fields "ref" where they say anything. */
#include <string.h>

#include "read.h"
#include "text.h"

struct section {
  const char *keyword;
  uint8_t type; /* VTK's; 0: no cells */
  uint8_t file_corners, corners;
};

static const struct section SECTIONS[] = {
    {"Tetrahedra", 10, 4, 4}, {"Hexahedra", 12, 8, 8},  {"Hexaedra", 12, 8, 8},      {"Prisms", 13, 6, 6},
    {"Wedges", 13, 6, 6},     {"Pentahedra", 13, 6, 6}, {"Pyramids", 14, 5, 5},      {"TetrahedraP2", 24, 10, 4},
    {"Edges", 3, 2, 0},       {"Triangles", 5, 3, 0},   {"Quadrilaterals", 9, 4, 0}, {"EdgesP2", 21, 3, 0},
    {"TrianglesP2", 22, 6, 0}};

struct medit {
  cellist_context *context;
  const struct source *source;
  struct text text;
  struct grid *grid;
  size_t file_cell_count;
  double *cell_refs;
  size_t cell_capacity, corner_capacity, corner_count;
  bool any_cell_ref;
};

#define FAIL(medit, ...) text_fail((medit)->context, (medit)->source, &(medit)->text, __VA_ARGS__)

static cellist_result read_vertices(struct medit *medit) {
  struct grid *grid = medit->grid;
  if (grid->points != NULL) return FAIL(medit, "has Vertices twice");
  if (!text_next_count(&medit->text, 8, &grid->point_count))
    return FAIL(medit, "Vertices is not followed by a count that the file can hold");
  grid->points = cellist_allocate(medit->context, grid->point_count, 3 * sizeof *grid->points);
  double *refs = cellist_allocate(medit->context, grid->point_count, sizeof *refs);
  cellist_result result = grid->points != NULL && refs != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  bool any = false;
  for (size_t i = 0; i < grid->point_count && result == CELLIST_SUCCESS; i++) {
    bool ok = true;
    for (size_t k = 0; k < 4 && ok; k++)
      ok = text_next_double(&medit->text, k < 3 ? &grid->points[3 * i + k] : &refs[i]);
    if (!ok) result = FAIL(medit, "a number of vertex %zu is missing or none", i + 1);
    any |= ok && refs[i] != 0;
  }
  if (result == CELLIST_SUCCESS && any) return grid_add_field(medit->context, grid, "ref", CELLIST_ON_POINTS, 1, refs);
  cellist_deallocate(medit->context, refs);
  return result;
}

/* An array of old_count elements with room for new_count. */
static bool grow(struct medit *medit, void **array, size_t old_count, size_t new_count, size_t size) {
  void *grown = cellist_reallocate(medit->context, *array, old_count, new_count, size);
  if (grown != NULL) *array = grown;
  return grown != NULL;
}

/* Exact for the first section, then at least doubling, so that many small sections cost no quadratic time. */
static cellist_result reserve(struct medit *medit, size_t cells, size_t corners) {
  struct grid *grid = medit->grid;
  size_t cell_count = grid->cell_count + cells + 1, corner_count = medit->corner_count + corners; /* 1: last offset */
  if (cell_count > medit->cell_capacity) {
    if (grid->cell_count > 0 && cell_count < 2 * medit->cell_capacity) cell_count = 2 * medit->cell_capacity;
    const bool ok = grow(medit, (void **)&grid->types, grid->cell_count, cell_count, 1) &&
                    grow(medit, (void **)&grid->offsets, grid->cell_count, cell_count, sizeof *grid->offsets) &&
                    grow(medit, (void **)&grid->cell_origin, grid->cell_count, cell_count, sizeof(uint32_t)) &&
                    grow(medit, (void **)&medit->cell_refs, grid->cell_count, cell_count, sizeof(double));
    if (!ok) return CELLIST_ERROR_OUT_OF_MEMORY;
    medit->cell_capacity = cell_count;
  }
  if (corner_count > medit->corner_capacity) {
    if (medit->corner_count > 0 && corner_count < 2 * medit->corner_capacity) corner_count = 2 * medit->corner_capacity;
    if (!grow(medit, (void **)&grid->connectivity, medit->corner_count, corner_count, sizeof(uint32_t)))
      return CELLIST_ERROR_OUT_OF_MEMORY;
    medit->corner_capacity = corner_count;
  }
  return CELLIST_SUCCESS;
}

static cellist_result read_cells(struct medit *medit, const struct section *section) {
  struct grid *grid = medit->grid;
  size_t count = 0;
  if (!text_next_count(&medit->text, 2 * ((size_t)section->file_corners + 1), &count) ||
      count > CELLIST_NONE - 1 - medit->file_cell_count)
    return FAIL(medit, "%s is not followed by a count that the file can hold", section->keyword);
  const cellist_result result =
      section->corners > 0 ? reserve(medit, count, count * section->corners) : CELLIST_SUCCESS;
  if (result != CELLIST_SUCCESS) return result;
  for (size_t i = 0; i < count; i++) {
    for (size_t k = 0; k <= section->file_corners; k++) {
      int64_t number = 0;
      bool ok = text_next_integer(&medit->text, &number);
      if (ok && k < section->corners)
        ok = element_store_integer(ELEMENT_AS_ID, grid->connectivity, medit->corner_count + k, number - 1);
      if (!ok) return FAIL(medit, "number %zu of cell %zu of %s is missing or no vertex", k, i + 1, section->keyword);
      if (k < section->file_corners || section->corners == 0) continue;
      medit->cell_refs[grid->cell_count] = (double)number;
      medit->any_cell_ref |= number != 0;
    }
    if (section->corners > 0) {
      grid->types[grid->cell_count] = section->type;
      grid->offsets[grid->cell_count] = medit->corner_count;
      grid->cell_origin[grid->cell_count++] = (uint32_t)(medit->file_cell_count + i);
      medit->corner_count += section->corners;
    } else {
      grid->skipped_cell_count++;
    }
  }
  medit->file_cell_count += count;
  return CELLIST_SUCCESS;
}

static bool is_keyword(struct text_word word) {
  return word.length > 0 &&
         ((word.begin[0] >= 'A' && word.begin[0] <= 'Z') || (word.begin[0] >= 'a' && word.begin[0] <= 'z'));
}

static cellist_result read_section(struct medit *medit, struct text_word word) {
  int64_t number = 0;
  if (text_word_is(word, "MeshVersionFormatted"))
    return text_next_integer(&medit->text, &number) ? CELLIST_SUCCESS : FAIL(medit, "has no version");
  if (text_word_is(word, "Dimension")) {
    if (text_next_integer(&medit->text, &number) && number == 3) return CELLIST_SUCCESS;
    return FAIL(medit, "is not three-dimensional");
  }
  if (text_word_is(word, "Vertices")) return read_vertices(medit);
  for (size_t i = 0; i < sizeof SECTIONS / sizeof *SECTIONS; i++)
    if (text_word_is(word, SECTIONS[i].keyword)) return read_cells(medit, &SECTIONS[i]);
  if (!is_keyword(word))
    return FAIL(medit, "'%.*s' is no keyword", (int)(word.length < 40 ? word.length : 40), (const char *)word.begin);
  for (;;) { /* corners, ridges, normals: numbers that a mesh of volumes does not need */
    struct text ahead = medit->text;
    const struct text_word next = text_next_word(&ahead);
    if (next.length == 0 || is_keyword(next)) return CELLIST_SUCCESS;
    medit->text = ahead;
  }
}

static cellist_result read_sections(struct medit *medit) {
  struct grid *grid = medit->grid;
  cellist_result result = reserve(medit, 0, 0);
  while (result == CELLIST_SUCCESS) {
    const struct text_word word = text_next_word(&medit->text);
    if (word.length == 0 || text_word_is(word, "End")) break;
    result = read_section(medit, word);
  }
  if (result == CELLIST_SUCCESS && grid->points == NULL) result = FAIL(medit, "has no Vertices");
  if (result != CELLIST_SUCCESS) return result;
  grid->offsets[grid->cell_count] = medit->corner_count;
  if (!medit->any_cell_ref) return CELLIST_SUCCESS;
  double *refs = medit->cell_refs;
  medit->cell_refs = NULL;
  return grid_add_field(medit->context, grid, "ref", CELLIST_ON_CELLS, 1, refs);
}

cellist_result read_medit(cellist_context *context, const struct source *source, struct grid *grid) {
  *grid = (struct grid){.file = source->name};
  struct medit medit = {.context = context, .source = source, .text = text_of(source, '#'), .grid = grid};
  const cellist_result result = read_sections(&medit);
  cellist_deallocate(context, medit.cell_refs);
  if (result != CELLIST_SUCCESS) grid_release(context, grid);
  return result;
}
