/* SPDX-License-Identifier: BSD-3-Clause
 * Gmsh: $Nodes and $Elements of both versions. Elements of volumes are kept with their corners only (Gmsh lists these
 * first); the others are counted, and all count in the cells' ids. */
#include <string.h>

#include "gmsh.h"

/* By Gmsh's element type: nodes, corners of volumes (0: lower dimension), VTK's type. */
static const struct {
  uint16_t nodes;
  uint8_t corners, type;
} ELEMENTS[] = {{0, 0, 0},   {2, 0, 3},   {3, 0, 5},   {4, 0, 9},   {4, 4, 10},  {8, 8, 12},  {6, 6, 13},  {5, 5, 14},
                {3, 0, 21},  {6, 0, 22},  {9, 0, 28},  {10, 4, 24}, {27, 8, 29}, {18, 6, 32}, {14, 5, 27}, {1, 0, 1},
                {8, 0, 23},  {20, 8, 25}, {15, 6, 26}, {13, 5, 27}, {9, 0, 69},  {10, 0, 69}, {12, 0, 69}, {15, 0, 69},
                {15, 0, 69}, {21, 0, 69}, {4, 0, 68},  {5, 0, 68},  {6, 0, 68},  {20, 4, 71}, {35, 4, 71}, {56, 4, 71}};
enum { ELEMENT_TYPE_COUNT = sizeof ELEMENTS / sizeof *ELEMENTS };

static cellist_result add_nodes(struct gmsh *gmsh, size_t count) {
  struct grid *grid = gmsh->grid;
  if (count >= CELLIST_NONE) return gmsh_fail(gmsh, "has too many nodes");
  grid->points = cellist_allocate(gmsh->context, count, 3 * sizeof *grid->points);
  return grid->points != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

static bool next_point(struct gmsh *gmsh, double *point) {
  return gmsh_next_double(gmsh, &point[0]) && gmsh_next_double(gmsh, &point[1]) && gmsh_next_double(gmsh, &point[2]);
}

static cellist_result read_nodes_2(struct gmsh *gmsh) {
  size_t count = 0;
  int64_t number = 0;
  /* The count is text in binary files too. */
  if (!text_next_integer(&gmsh->text, &number) || number < 0) return gmsh_fail(gmsh, "$Nodes has no count");
  count = (size_t)number;
  if (count > (size_t)(gmsh->text.end - gmsh->text.at) / (gmsh->is_binary ? 28 : 8))
    return gmsh_fail(gmsh, "$Nodes counts more than the file holds");
  text_skip_line(&gmsh->text);
  cellist_result result = add_nodes(gmsh, count);
  for (size_t i = 0; i < count && result == CELLIST_SUCCESS; i++) {
    int64_t tag = 0;
    if (!gmsh_next_integer(gmsh, 4, &tag) || !next_point(gmsh, &gmsh->grid->points[3 * i]))
      result = gmsh_fail(gmsh, "node %zu is cut or malformed", i);
    else
      result = gmsh_tags_add(gmsh, &gmsh->nodes, tag, count);
  }
  gmsh->grid->point_count = count;
  return result;
}

/* One block: tags, then coordinates (and parameters on the entity, which are passed over). */
static cellist_result read_node_block(struct gmsh *gmsh, size_t total) {
  struct grid *grid = gmsh->grid;
  int64_t dimension = 0, entity = 0, is_parametric = 0;
  size_t count = 0;
  if (!gmsh_next_integer(gmsh, 4, &dimension) || !gmsh_next_integer(gmsh, 4, &entity) ||
      !gmsh_next_integer(gmsh, 4, &is_parametric) || !gmsh_next_count(gmsh, 8, 8, 32, &count) ||
      count > total - grid->point_count || dimension < 0 || dimension > 3)
    return gmsh_fail(gmsh, "a block of $Nodes is malformed");
  for (size_t i = 0; i < count; i++) {
    int64_t tag = 0;
    if (!gmsh_next_integer(gmsh, 8, &tag)) return gmsh_fail(gmsh, "a node's tag is missing");
    const cellist_result result = gmsh_tags_add(gmsh, &gmsh->nodes, tag, total);
    if (result != CELLIST_SUCCESS) return result;
  }
  for (size_t i = 0; i < count; i++) {
    double parameter = 0;
    bool ok = next_point(gmsh, &grid->points[3 * (grid->point_count + i)]);
    for (int64_t k = 0; k < dimension && is_parametric != 0 && ok; k++) ok = gmsh_next_double(gmsh, &parameter);
    if (!ok) return gmsh_fail(gmsh, "a node's coordinate is missing or malformed");
  }
  grid->point_count += count;
  return CELLIST_SUCCESS;
}

static cellist_result read_nodes_4(struct gmsh *gmsh) {
  size_t block_count = 0, count = 0;
  int64_t tag = 0;
  if (!gmsh_next_count(gmsh, 8, 8, 20, &block_count) || !gmsh_next_count(gmsh, 8, 8, 32, &count) ||
      !gmsh_next_integer(gmsh, 8, &tag) || !gmsh_next_integer(gmsh, 8, &tag))
    return gmsh_fail(gmsh, "$Nodes does not begin with counts that the file can hold");
  cellist_result result = add_nodes(gmsh, count);
  for (size_t b = 0; b < block_count && result == CELLIST_SUCCESS; b++) result = read_node_block(gmsh, count);
  if (result == CELLIST_SUCCESS && gmsh->grid->point_count != count)
    result = gmsh_fail(gmsh, "$Nodes holds %zu nodes instead of %zu", gmsh->grid->point_count, count);
  return result;
}

cellist_result gmsh_read_nodes(struct gmsh *gmsh) {
  return gmsh->is_version_4 ? read_nodes_4(gmsh) : read_nodes_2(gmsh);
}

static bool grow(struct gmsh *gmsh, void **array, size_t old_count, size_t new_count, size_t size) {
  void *grown = cellist_reallocate(gmsh->context, *array, old_count, new_count, size);
  if (grown != NULL) *array = grown;
  return grown != NULL;
}

/* Room for one more cell of this many corners; both arrays double. */
static cellist_result reserve(struct gmsh *gmsh, size_t corners) {
  struct grid *grid = gmsh->grid;
  if (grid->cell_count + 2 > gmsh->cell_capacity) {
    const size_t capacity = gmsh->cell_capacity > 0 ? 2 * gmsh->cell_capacity : 64, old = grid->cell_count;
    if (!grow(gmsh, (void **)&grid->types, old, capacity, 1) ||
        !grow(gmsh, (void **)&grid->offsets, old, capacity, sizeof *grid->offsets) ||
        !grow(gmsh, (void **)&grid->cell_origin, old, capacity, sizeof *grid->cell_origin))
      return CELLIST_ERROR_OUT_OF_MEMORY;
    gmsh->cell_capacity = capacity;
  }
  if (gmsh->corner_count + corners > gmsh->corner_capacity) {
    const size_t capacity = gmsh->corner_capacity > 0 ? 2 * gmsh->corner_capacity : 256;
    if (!grow(gmsh, (void **)&grid->connectivity, gmsh->corner_count, capacity, sizeof *grid->connectivity))
      return CELLIST_ERROR_OUT_OF_MEMORY;
    gmsh->corner_capacity = capacity;
  }
  return CELLIST_SUCCESS;
}

/* The nodes of one element of a known type; node_size: bytes of a tag. Corners are kept as node tags, which gmsh_link
 * turns into ids: a tag beyond 32 bits is no tag that a file of this size can need, except with gaps. */
static cellist_result read_element(struct gmsh *gmsh, int64_t type, int64_t tag, size_t node_size) {
  struct grid *grid = gmsh->grid;
  const size_t corners = ELEMENTS[type].corners;
  cellist_result result = corners > 0 ? reserve(gmsh, corners) : CELLIST_SUCCESS;
  if (result == CELLIST_SUCCESS && corners > 0) result = gmsh_tags_add(gmsh, &gmsh->elements, tag, 0);
  if (result != CELLIST_SUCCESS) return result;
  for (size_t k = 0; k < ELEMENTS[type].nodes; k++) {
    int64_t node = 0;
    bool ok = gmsh_next_integer(gmsh, node_size, &node);
    if (ok && k < corners) ok = element_store_integer(ELEMENT_AS_ID, grid->connectivity, gmsh->corner_count + k, node);
    if (!ok) return gmsh_fail(gmsh, "node %zu of element %lld is missing, malformed or too large", k, (long long)tag);
  }
  if (gmsh->file_cell_count + 1 >= CELLIST_NONE) return gmsh_fail(gmsh, "has too many elements");
  if (corners > 0) {
    grid->types[grid->cell_count] = ELEMENTS[type].type;
    grid->offsets[grid->cell_count] = gmsh->corner_count;
    grid->cell_origin[grid->cell_count++] = (uint32_t)gmsh->file_cell_count;
    gmsh->corner_count += corners;
  } else {
    grid->skipped_cell_count++;
  }
  gmsh->file_cell_count++;
  return CELLIST_SUCCESS;
}

static cellist_result check_type(struct gmsh *gmsh, int64_t type, int64_t tag) {
  if (type >= 1 && type < ELEMENT_TYPE_COUNT) return CELLIST_SUCCESS;
  return cellist_fail(gmsh->context, CELLIST_ERROR_UNSUPPORTED,
                      "%s: element %lld is of Gmsh's type %lld, which is not handled", gmsh->source->name,
                      (long long)tag, (long long)type);
}

/* Text: tag, type, tag count, tags, nodes. Binary: blocks of a type with a count. */
static cellist_result read_elements_2(struct gmsh *gmsh) {
  int64_t total = 0;
  if (!text_next_integer(&gmsh->text, &total) || total < 0) return gmsh_fail(gmsh, "$Elements has no count");
  if ((size_t)total > (size_t)(gmsh->text.end - gmsh->text.at) / 8)
    return gmsh_fail(gmsh, "$Elements counts more than the file holds");
  text_skip_line(&gmsh->text);
  int64_t type = 0, tag_count = 0, in_block = 0;
  for (int64_t i = 0; i < total; i++) {
    int64_t tag = 0, ignored = 0;
    bool ok = true;
    if (gmsh->is_binary && in_block == 0)
      ok = gmsh_next_integer(gmsh, 4, &type) && gmsh_next_integer(gmsh, 4, &in_block) &&
           gmsh_next_integer(gmsh, 4, &tag_count) && in_block > 0;
    in_block--;
    ok = ok && gmsh_next_integer(gmsh, 4, &tag);
    if (!gmsh->is_binary) ok = ok && gmsh_next_integer(gmsh, 4, &type) && gmsh_next_integer(gmsh, 4, &tag_count);
    for (int64_t k = 0; k < tag_count && ok; k++) ok = gmsh_next_integer(gmsh, 4, &ignored);
    if (!ok || tag_count < 0) return gmsh_fail(gmsh, "element %lld of $Elements is cut or malformed", (long long)i);
    cellist_result result = check_type(gmsh, type, tag);
    if (result == CELLIST_SUCCESS) result = read_element(gmsh, type, tag, 4);
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

static cellist_result read_elements_4(struct gmsh *gmsh) {
  size_t block_count = 0, count = 0;
  int64_t ignored = 0;
  if (!gmsh_next_count(gmsh, 8, 8, 20, &block_count) || !gmsh_next_count(gmsh, 8, 4, 16, &count) ||
      !gmsh_next_integer(gmsh, 8, &ignored) || !gmsh_next_integer(gmsh, 8, &ignored))
    return gmsh_fail(gmsh, "$Elements does not begin with counts that the file can hold");
  for (size_t b = 0; b < block_count; b++) {
    int64_t type = 0, tag = 0;
    size_t in_block = 0;
    if (!gmsh_next_integer(gmsh, 4, &ignored) || !gmsh_next_integer(gmsh, 4, &ignored) ||
        !gmsh_next_integer(gmsh, 4, &type) || !gmsh_next_count(gmsh, 8, 4, 16, &in_block))
      return gmsh_fail(gmsh, "a block of $Elements is malformed");
    cellist_result result = in_block > 0 ? check_type(gmsh, type, 0) : CELLIST_SUCCESS;
    for (size_t i = 0; i < in_block && result == CELLIST_SUCCESS; i++) {
      if (!gmsh_next_integer(gmsh, 8, &tag))
        result = gmsh_fail(gmsh, "an element's tag is missing");
      else
        result = read_element(gmsh, type, tag, 8);
    }
    if (result != CELLIST_SUCCESS) return result;
  }
  return gmsh->file_cell_count == count
             ? CELLIST_SUCCESS
             : gmsh_fail(gmsh, "$Elements holds %zu elements instead of %zu", gmsh->file_cell_count, count);
}

cellist_result gmsh_read_elements(struct gmsh *gmsh) {
  const cellist_result result = reserve(gmsh, 0);
  if (result != CELLIST_SUCCESS) return result;
  return gmsh->is_version_4 ? read_elements_4(gmsh) : read_elements_2(gmsh);
}

cellist_result gmsh_link(struct gmsh *gmsh) {
  struct grid *grid = gmsh->grid;
  if (grid->points == NULL || grid->offsets == NULL)
    return gmsh_fail(gmsh, "lacks $Nodes or $Elements before its data or its end");
  grid->offsets[grid->cell_count] = gmsh->corner_count;
  bool are_unique = false;
  cellist_result result = gmsh_tags_sort(gmsh, &gmsh->nodes, &are_unique);
  if (result == CELLIST_SUCCESS && !are_unique) result = gmsh_fail(gmsh, "two nodes have the same tag");
  if (result == CELLIST_SUCCESS) result = gmsh_tags_sort(gmsh, &gmsh->elements, &are_unique);
  for (size_t i = 0; i < gmsh->corner_count && result == CELLIST_SUCCESS; i++) {
    const uint32_t tag = grid->connectivity[i];
    grid->connectivity[i] = gmsh_tags_find(&gmsh->nodes, tag);
    if (grid->connectivity[i] == CELLIST_NONE)
      result = gmsh_fail(gmsh, "an element uses node %u, which is not there", tag);
  }
  return result;
}
