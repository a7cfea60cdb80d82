/* SPDX-License-Identifier: BSD-3-Clause
 * Legacy VTK: arrays of numbers, and the attributes of points and cells. */
#include <string.h>

#include "legacy.h"

enum { NAME_CAPACITY = 256 };

cellist_result legacy_read_values(struct legacy *legacy, enum element_type type, enum element_kind kind, size_t count,
                                  void **values) {
  *values = NULL;
  if (legacy->is_binary) text_skip_line(&legacy->text);
  const size_t left = (size_t)(legacy->text.end - legacy->text.at);
  const size_t possible = legacy->is_binary ? left / element_size(type) : left / 2 + 1;
  if (count > possible) return legacy_fail(legacy, "%zu numbers are more than the rest of the file holds", count);
  void *made = cellist_allocate(legacy->context, count, element_kind_size(kind));
  if (made == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  bool ok = false;
  size_t filled = 0;
  if (legacy->is_binary) {
    struct element_sink sink = {
        .type = type, .swap = element_machine_is_little(), .kind = kind, .values = made, .count = count};
    ok = element_sink_push(&sink, legacy->text.at, count * element_size(type));
    filled = sink.filled;
    legacy->text.at += filled * element_size(type);
  } else {
    ok = text_read_values(&legacy->text, kind, made, count, &filled);
  }
  if (ok) {
    *values = made;
    return CELLIST_SUCCESS;
  }
  cellist_deallocate(legacy->context, made);
  return legacy_fail(legacy, "number %zu of %zu is missing, negative, too large or no number", filled, count);
}

/* Passes over count numbers, bits or strings. */
static cellist_result skip_values(struct legacy *legacy, struct text_word type_name, size_t count) {
  enum element_type type;
  bool is_packed = false;
  const bool is_string = text_word_is_like(type_name, "string") || text_word_is_like(type_name, "utf8_string");
  if (!is_string && !legacy_type_of(type_name, &type, &is_packed))
    return legacy_fail(legacy, "an array's type is not known");
  struct text *text = &legacy->text;
  if (!legacy->is_binary) {
    if (is_string) text_skip_line(text);
    for (size_t i = 0; i < count; i++) {
      if (text->at >= text->end) return legacy_fail(legacy, "an array is cut");
      if (is_string)
        text_skip_line(text);
      else
        text_next_word(text);
    }
    return CELLIST_SUCCESS;
  }
  text_skip_line(text);
  if (!is_string) {
    const size_t each = element_size(type), left = (size_t)(text->end - text->at);
    if (is_packed ? count / 8 + (count % 8 > 0) > left : count > left / each)
      return legacy_fail(legacy, "an array is cut");
    text->at += is_packed ? count / 8 + (count % 8 > 0) : count * each;
    return CELLIST_SUCCESS;
  }
  for (size_t i = 0; i < count; i++) {
    /* The two highest bits say in how many bytes the length stands: 8, 4, 2 or 1. */
    if (text->at >= text->end) return legacy_fail(legacy, "an array of strings is cut");
    const size_t bytes = (size_t)8 >> (*text->at >> 6);
    if ((size_t)(text->end - text->at) < bytes) return legacy_fail(legacy, "an array of strings is cut");
    uint64_t length = text->at[0] & 0x3f;
    for (size_t k = 1; k < bytes; k++) length = length << 8 | text->at[k];
    text->at += bytes;
    if (length > (uint64_t)(text->end - text->at)) return legacy_fail(legacy, "an array of strings is cut");
    text->at += length;
  }
  return CELLIST_SUCCESS;
}

static int hexadecimal(uint8_t c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
                                : -1;
}

/* A name without its %XX. */
static void decode_name(struct text_word word, char name[NAME_CAPACITY]) {
  size_t length = 0;
  for (size_t i = 0; i < word.length && length + 1 < NAME_CAPACITY; i++) {
    const bool is_code = word.begin[i] == '%' && i + 2 < word.length && hexadecimal(word.begin[i + 1]) >= 0 &&
                         hexadecimal(word.begin[i + 2]) >= 0;
    const int byte = is_code ? 16 * hexadecimal(word.begin[i + 1]) + hexadecimal(word.begin[i + 2]) : word.begin[i];
    if (is_code) i += 2;
    name[length++] = (char)(byte != 0 ? byte : ' ');
  }
  name[length] = '\0';
}

static cellist_result add_array(struct legacy *legacy, const char *name, cellist_association association,
                                struct text_word type_name, size_t component_count, size_t tuple_count) {
  struct grid *grid = legacy->grid;
  const bool on_points = association == CELLIST_ON_POINTS;
  enum element_type type;
  bool is_packed = false;
  size_t count = 0;
  if (component_count > UINT16_MAX || __builtin_mul_overflow(component_count, tuple_count, &count))
    return legacy_fail(legacy, "array '%s' is too large", name);
  const bool is_known = legacy_type_of(type_name, &type, &is_packed);
  if (component_count == 0 || !is_known || is_packed ||
      tuple_count != (on_points ? grid->point_count : grid->cell_count)) {
    cellist_log(legacy->context, CELLIST_LOG_WARNING, "%s: array '%s' does not fit points or cells: left out",
                legacy->source->name, name);
    return skip_values(legacy, type_name, count);
  }
  void *values = NULL;
  cellist_result result = legacy_read_values(legacy, type, ELEMENT_AS_DOUBLE, count, &values);
  if (result != CELLIST_SUCCESS) return result;
  const bool is_level = strcmp(name, "vtkGhostLevels") == 0;
  if (component_count == 1 && (is_level || strcmp(name, "vtkGhostType") == 0)) {
    result = grid_hide_by_ghost_type(legacy->context, grid, association, values, is_level);
    cellist_deallocate(legacy->context, values);
    return result;
  }
  return grid_add_field(legacy->context, grid, name, association, component_count, values);
}

/* FIELD name count, then count arrays: name components tuples type, values. association NULL: passed over. */
static cellist_result read_field(struct legacy *legacy, const cellist_association *association) {
  struct text *text = &legacy->text;
  size_t array_count = 0;
  text_next_word(text);
  if (!text_next_count(text, 1, &array_count))
    return legacy_fail(legacy, "FIELD is not followed by a name and a count");
  for (size_t i = 0; i < array_count; i++) {
    char name[NAME_CAPACITY];
    struct text_word word = text_next_word(text);
    if (text_word_is_like(word, "METADATA")) {
      legacy_skip_metadata(legacy);
      word = text_next_word(text);
    }
    if (text_word_is(word, "NULL_ARRAY")) continue;
    decode_name(word, name);
    size_t components = 0, tuples = 0, count = 0;
    if (!text_next_count(text, 0, &components) || !text_next_count(text, 0, &tuples) ||
        __builtin_mul_overflow(components, tuples, &count))
      return legacy_fail(legacy, "array '%s' of a FIELD has no counts", name);
    const struct text_word type = text_next_word(text);
    const cellist_result result = association != NULL ? add_array(legacy, name, *association, type, components, tuples)
                                                      : skip_values(legacy, type, count);
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

cellist_result legacy_skip_field(struct legacy *legacy) { return read_field(legacy, NULL); }

void legacy_skip_metadata(struct legacy *legacy) {
  struct text *text = &legacy->text;
  do {
    text_skip_line(text);
  } while (text->at < text->end && text_count_words_in_line(text) > 0);
}

/* LOOKUP_TABLE name after SCALARS, which a few writers leave out. */
static void skip_table_name(struct legacy *legacy) {
  struct text ahead = legacy->text;
  if (text_word_is_like(text_next_word(&ahead), "LOOKUP_TABLE")) {
    text_next_word(&ahead);
    legacy->text = ahead;
  }
}

static struct text_word word_of(const char *text) { return (struct text_word){(const uint8_t *)text, strlen(text)}; }

/* One attribute; keyword has been read. */
static cellist_result read_attribute(struct legacy *legacy, struct text_word keyword, cellist_association association,
                                     size_t tuple_count) {
  static const struct {
    const char *keyword;
    size_t component_count;
  } plain[] = {{"VECTORS", 3},    {"NORMALS", 3},      {"TENSORS", 9},   {"TENSORS6", 6},
               {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1}};
  struct text *text = &legacy->text;
  char name[NAME_CAPACITY];
  if (text_word_is_like(keyword, "FIELD")) return read_field(legacy, &association);
  decode_name(text_next_word(text), name);
  for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
    if (text_word_is_like(keyword, plain[i].keyword))
      return add_array(legacy, name, association, text_next_word(text), plain[i].component_count, tuple_count);
  if (text_word_is_like(keyword, "SCALARS")) {
    const struct text_word type = text_next_word(text), components = text_next_word_in_line(text);
    int64_t component_count = 1;
    if (components.length > 0 && (!text_word_to_integer(components, &component_count) || component_count < 1))
      return legacy_fail(legacy, "SCALARS '%s' have no component count", name);
    skip_table_name(legacy);
    return add_array(legacy, name, association, type, (size_t)component_count, tuple_count);
  }
  size_t number = 0;
  if (text_word_is_like(keyword, "TEXTURE_COORDINATES") && text_next_count(text, 0, &number))
    return add_array(legacy, name, association, text_next_word(text), number, tuple_count);
  if (text_word_is_like(keyword, "COLOR_SCALARS") && text_next_count(text, 0, &number))
    return add_array(legacy, name, association, word_of(legacy->is_binary ? "unsigned_char" : "float"), number,
                     tuple_count);
  if (text_word_is_like(keyword, "LOOKUP_TABLE") && text_next_count(text, 4, &number))
    return skip_values(legacy, word_of(legacy->is_binary ? "unsigned_char" : "float"), 4 * number);
  return legacy_fail(legacy, "'%.*s' is no attribute of points or cells",
                     (int)(keyword.length < 40 ? keyword.length : 40), (const char *)keyword.begin);
}

cellist_result legacy_read_attributes(struct legacy *legacy, struct text_word keyword) {
  cellist_association association = CELLIST_ON_POINTS;
  size_t tuple_count = 0;
  for (; keyword.length > 0; keyword = text_next_word(&legacy->text)) {
    const bool is_point_data = text_word_is_like(keyword, "POINT_DATA");
    cellist_result result = CELLIST_SUCCESS;
    if (is_point_data || text_word_is_like(keyword, "CELL_DATA")) {
      association = is_point_data ? CELLIST_ON_POINTS : CELLIST_ON_CELLS;
      const size_t expected = is_point_data ? legacy->grid->point_count : legacy->grid->cell_count;
      if (!text_next_count(&legacy->text, 0, &tuple_count) || tuple_count != expected)
        result = legacy_fail(legacy, "%s_DATA is not for %zu values", is_point_data ? "POINT" : "CELL", expected);
    } else if (text_word_is_like(keyword, "METADATA")) {
      legacy_skip_metadata(legacy);
    } else {
      result = read_attribute(legacy, keyword, association, tuple_count);
    }
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}
