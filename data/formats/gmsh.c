/* SPDX-License-Identifier: BSD-3-Clause
 * Gmsh .msh, versions 2.x and 4.1, text and binary: the frame of sections, tags, and $NodeData / $ElementData. Physical
 * groups, entities and periodicity are passed over. */
#include "gmsh.h"

#include <cellist/radix.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "read.h"

cellist_result gmsh_fail(struct gmsh *gmsh, const char *format, ...) {
  char reason[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason, sizeof reason, format, arguments);
  va_end(arguments);
  if (!gmsh->is_binary) return text_fail(gmsh->context, gmsh->source, &gmsh->text, "%s", reason);
  return source_fail_at(gmsh->context, gmsh->source, (size_t)(gmsh->text.at - gmsh->text.begin), "%s", reason);
}

static size_t bytes_left(const struct gmsh *gmsh) { return (size_t)(gmsh->text.end - gmsh->text.at); }

bool gmsh_next_integer(struct gmsh *gmsh, size_t size, int64_t *value) {
  if (!gmsh->is_binary) return text_next_integer(&gmsh->text, value);
  if (bytes_left(gmsh) < size) return false;
  if (size == 4)
    *value = (int32_t)element_load_u32(gmsh->text.at, gmsh->swap);
  else
    *value = (int64_t)element_load_u64(gmsh->text.at, gmsh->swap);
  gmsh->text.at += size;
  return true;
}

bool gmsh_next_double(struct gmsh *gmsh, double *value) {
  if (!gmsh->is_binary) return text_next_double(&gmsh->text, value);
  if (bytes_left(gmsh) < 8) return false;
  const uint64_t bits = element_load_u64(gmsh->text.at, gmsh->swap);
  memcpy(value, &bits, sizeof bits);
  gmsh->text.at += 8;
  return true;
}

bool gmsh_next_count(struct gmsh *gmsh, size_t size, size_t text_bytes, size_t binary_bytes, size_t *count) {
  int64_t value = 0;
  if (!gmsh_next_integer(gmsh, size, &value) || value < 0) return false;
  const size_t each = gmsh->is_binary ? binary_bytes : text_bytes;
  if ((size_t)value > (bytes_left(gmsh) + 1) / each) return false;
  *count = (size_t)value;
  return true;
}

cellist_result gmsh_tags_add(struct gmsh *gmsh, struct gmsh_tags *tags, int64_t tag, size_t expected) {
  if (tags->count == tags->capacity) {
    const size_t capacity = tags->capacity == 0 ? (expected > 16 ? expected : 16) : 2 * tags->capacity;
    uint64_t *grown = cellist_reallocate(gmsh->context, tags->tags, tags->count, capacity, sizeof *grown);
    if (grown == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    tags->tags = grown;
    uint32_t *indices = cellist_reallocate(gmsh->context, tags->indices, tags->count, capacity, sizeof *indices);
    if (indices == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    tags->indices = indices;
    tags->capacity = capacity;
  }
  tags->tags[tags->count] = (uint64_t)tag;
  tags->indices[tags->count] = (uint32_t)tags->count;
  tags->count++;
  return CELLIST_SUCCESS;
}

cellist_result gmsh_tags_sort(struct gmsh *gmsh, struct gmsh_tags *tags, bool *are_unique) {
  uint64_t *scratch = cellist_allocate(gmsh->context, tags->count, sizeof *scratch);
  uint32_t *scratch_indices = cellist_allocate(gmsh->context, tags->count, sizeof *scratch_indices);
  const bool ok = scratch != NULL && scratch_indices != NULL;
  if (ok && tags->count > 0) cellist_radix_sort(tags->tags, tags->indices, tags->count, scratch, scratch_indices, 64);
  cellist_deallocate(gmsh->context, scratch);
  cellist_deallocate(gmsh->context, scratch_indices);
  *are_unique = true;
  for (size_t i = 1; i < tags->count && ok; i++) *are_unique &= tags->tags[i] != tags->tags[i - 1];
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

uint32_t gmsh_tags_find(const struct gmsh_tags *tags, int64_t tag) {
  const uint64_t wanted = (uint64_t)tag;
  /* Tags without gaps, as most files have them, need no search. */
  if (tags->count > 0 && wanted - tags->tags[0] < tags->count && tags->tags[wanted - tags->tags[0]] == wanted)
    return tags->indices[wanted - tags->tags[0]];
  size_t low = 0, high = tags->count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (tags->tags[middle] < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  return low < tags->count && tags->tags[low] == wanted ? tags->indices[low] : CELLIST_NONE;
}

/* The string in quotes that stands alone in its line. */
static void read_name(struct gmsh *gmsh, char *name, size_t capacity) {
  struct text *text = &gmsh->text;
  while (text->at < text->end && (*text->at == '\n' || *text->at == '\r' || *text->at == ' ')) text->at++;
  const uint8_t *begin = text->at;
  text_skip_line(text);
  const uint8_t *end = text->at;
  while (end > begin && (end[-1] == '\n' || end[-1] == '\r' || end[-1] == ' ')) end--;
  if (end - begin >= 2 && *begin == '"' && end[-1] == '"') begin++, end--;
  const size_t length = (size_t)(end - begin) < capacity - 1 ? (size_t)(end - begin) : capacity - 1;
  memcpy(name, begin, length);
  name[length] = '\0';
  for (size_t i = 0; i < length; i++)
    if (name[i] == '\0') name[i] = ' ';
}

/* The tags of a data section: strings, reals, then integers: step, components, count. These are text always. */
static bool read_data_header(struct gmsh *gmsh, char *name, size_t capacity, size_t *component_count, size_t *count) {
  struct text *text = &gmsh->text;
  size_t tag_count = 0;
  double real = 0;
  if (!text_next_count(text, 1, &tag_count)) return false;
  for (size_t i = 0; i < tag_count; i++) {
    char other[8];
    if (text->at >= text->end) return false;
    read_name(gmsh, i == 0 ? name : other, i == 0 ? capacity : sizeof other);
  }
  if (!text_next_count(text, 2, &tag_count)) return false;
  for (size_t i = 0; i < tag_count; i++)
    if (!text_next_double(text, &real)) return false;
  if (!text_next_count(text, 2, &tag_count) || tag_count < 3) return false;
  int64_t integer = 0;
  for (size_t i = 0; i < tag_count; i++) {
    if (!text_next_integer(text, &integer) || integer < 0) return false;
    if (i == 1) *component_count = (size_t)integer;
    if (i == 2) *count = (size_t)integer;
  }
  text_skip_line(text);
  return *component_count >= 1 && *component_count <= 64;
}

/* What no line mentions is NaN: such cells are not drawn. */
static cellist_result read_data(struct gmsh *gmsh, bool on_points) {
  char name[128] = "data";
  size_t component_count = 0, count = 0;
  if (!read_data_header(gmsh, name, sizeof name, &component_count, &count))
    return gmsh_fail(gmsh, "a data section's tags are malformed");
  const size_t each = gmsh->is_binary ? 4 + 8 * component_count : 2 + 2 * component_count;
  if (count > (bytes_left(gmsh) + 1) / each)
    return gmsh_fail(gmsh, "data '%s' has more values than the file holds", name);
  struct grid *grid = gmsh->grid;
  const struct gmsh_tags *tags = on_points ? &gmsh->nodes : &gmsh->elements;
  const size_t size = on_points ? grid->point_count : grid->cell_count;
  /* Only as much memory as the section has values for: a file may have many sections. */
  const bool is_sparse = count < size / 2;
  if (is_sparse)
    cellist_log(gmsh->context, CELLIST_LOG_WARNING, "%s: data '%s' are given for less than half of the mesh: left out",
                gmsh->source->name, name);
  double *values = is_sparse ? NULL : cellist_allocate(gmsh->context, size, component_count * sizeof *values);
  if (values == NULL && !is_sparse) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < size * component_count && !is_sparse; i++) values[i] = NAN;
  for (size_t i = 0; i < count; i++) {
    int64_t tag = 0;
    bool ok = gmsh_next_integer(gmsh, 4, &tag);
    const uint32_t at = ok && !is_sparse ? gmsh_tags_find(tags, tag) : CELLIST_NONE;
    for (size_t k = 0; k < component_count && ok; k++) {
      double value = 0;
      ok = gmsh_next_double(gmsh, &value);
      if (ok && at < size) values[component_count * at + k] = value;
    }
    if (ok) continue;
    cellist_deallocate(gmsh->context, values);
    return gmsh_fail(gmsh, "value %zu of data '%s' is missing or malformed", i, name);
  }
  if (is_sparse) return CELLIST_SUCCESS;
  return grid_add_field(gmsh->context, grid, name, on_points ? CELLIST_ON_POINTS : CELLIST_ON_CELLS, component_count,
                        values);
}

/* Goes behind the line "$EndNAME". */
static cellist_result skip_section(struct gmsh *gmsh, struct text_word name) {
  struct text *text = &gmsh->text;
  char end[80];
  const int length = snprintf(end, sizeof end, "$End%.*s", (int)(name.length < 64 ? name.length - 1 : 63),
                              (const char *)name.begin + 1);
  while (text->at < text->end) {
    const uint8_t *dollar = memchr(text->at, '$', bytes_left(gmsh));
    if (dollar == NULL) break;
    text->at = dollar + 1;
    if ((size_t)(text->end - dollar) >= (size_t)length && memcmp(dollar, end, (size_t)length) == 0) {
      text_skip_line(text);
      return CELLIST_SUCCESS;
    }
  }
  return gmsh_fail(gmsh, "the section %.*s has no end", (int)(name.length < 64 ? name.length : 64),
                   (const char *)name.begin);
}

static cellist_result read_format(struct gmsh *gmsh) {
  const struct text_word version = text_next_word(&gmsh->text);
  int64_t is_binary = 0, size = 0;
  double number = 0;
  if (!text_word_to_double(version, &number) || !text_next_integer(&gmsh->text, &is_binary) ||
      !text_next_integer(&gmsh->text, &size))
    return gmsh_fail(gmsh, "$MeshFormat is not followed by a version, 0 or 1, and 8");
  gmsh->is_version_4 = text_word_is(version, "4.1");
  if (!gmsh->is_version_4 && !(number >= 2 && number < 3))
    return cellist_fail(gmsh->context, CELLIST_ERROR_UNSUPPORTED,
                        "%s: is of Gmsh's version %.*s; 2.x and 4.1 are read (gmsh -save -format msh41 converts)",
                        gmsh->source->name, (int)(version.length < 16 ? version.length : 16),
                        (const char *)version.begin);
  if (size != 8) return gmsh_fail(gmsh, "its numbers are of %lld bytes, not 8", (long long)size);
  gmsh->is_binary = is_binary != 0;
  text_skip_line(&gmsh->text);
  if (!gmsh->is_binary) return CELLIST_SUCCESS;
  if (bytes_left(gmsh) < 4) return gmsh_fail(gmsh, "is cut");
  gmsh->swap = element_load_u32(gmsh->text.at, false) != 1;
  if (gmsh->swap && element_load_u32(gmsh->text.at, true) != 1)
    return gmsh_fail(gmsh, "its byte order is not told by a 1");
  gmsh->text.at += 4;
  return CELLIST_SUCCESS;
}

static cellist_result read_sections(struct gmsh *gmsh) {
  bool has_format = false, is_linked = false;
  for (;;) {
    const struct text_word name = text_next_word(&gmsh->text);
    if (name.length == 0) break;
    if (name.begin[0] != '$' || name.length < 2) return gmsh_fail(gmsh, "no section begins where one should");
    const bool is_node_data = text_word_is(name, "$NodeData"), is_element_data = text_word_is(name, "$ElementData");
    cellist_result result = CELLIST_SUCCESS;
    if (text_word_is(name, "$MeshFormat") && !has_format) {
      result = read_format(gmsh);
      has_format = true;
    } else if (!has_format && !text_word_is(name, "$Comments")) {
      return gmsh_fail(gmsh, "has no $MeshFormat before its other sections");
    } else if (text_word_is(name, "$Nodes") && gmsh->grid->points == NULL) {
      text_skip_line(&gmsh->text);
      result = gmsh_read_nodes(gmsh);
    } else if (text_word_is(name, "$Elements") && gmsh->cell_capacity == 0) {
      text_skip_line(&gmsh->text);
      result = gmsh_read_elements(gmsh);
    } else if (is_node_data || is_element_data) {
      if (!is_linked) result = gmsh_link(gmsh);
      is_linked = true;
      if (result == CELLIST_SUCCESS) result = read_data(gmsh, is_node_data);
    }
    if (result == CELLIST_SUCCESS) result = skip_section(gmsh, name);
    if (result != CELLIST_SUCCESS) return result;
  }
  return is_linked ? CELLIST_SUCCESS : gmsh_link(gmsh);
}

cellist_result read_gmsh(cellist_context *context, const struct source *source, struct grid *grid) {
  *grid = (struct grid){.file = source->name};
  struct gmsh gmsh = {.context = context, .source = source, .text = text_of(source, 0), .grid = grid};
  const cellist_result result = read_sections(&gmsh);
  cellist_deallocate(context, gmsh.nodes.tags);
  cellist_deallocate(context, gmsh.nodes.indices);
  cellist_deallocate(context, gmsh.elements.tags);
  cellist_deallocate(context, gmsh.elements.indices);
  if (result != CELLIST_SUCCESS) grid_release(context, grid);
  return result;
}
