/* SPDX-License-Identifier: BSD-3-Clause
 * PLY check: a header that ends, elements and numbers as many as it promises, faces that name points that are there.
 * assimp takes all of this for granted: without it, it waits for a header's end for ever, or ends the process. */
#include "ply_check.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_ELEMENTS = 16, MAX_PROPERTIES = 64, WORD = 64 };

/* Types by size and kind: both names of each. */
static const struct {
  const char *names[2];
  uint8_t size;
  bool is_signed, is_real;
} types[] = {{{"char", "int8"}, 1, true, false},    {{"uchar", "uint8"}, 1, false, false},
             {{"short", "int16"}, 2, true, false},  {{"ushort", "uint16"}, 2, false, false},
             {{"int", "int32"}, 4, true, false},    {{"uint", "uint32"}, 4, false, false},
             {{"float", "float32"}, 4, true, true}, {{"double", "float64"}, 8, true, true}};

typedef struct property {
  int type, count_type; /* into types; count_type -1: not a list */
  bool is_corner;       /* the ids of a face's points */
} property;

typedef struct element {
  bool is_vertex;
  unsigned long long count;
  size_t property_count;
  property properties[MAX_PROPERTIES];
} element;

typedef struct reader {
  cellist_context *context;
  const char *name;
  const unsigned char *bytes;
  size_t size, at;
  size_t line; /* of the header, from 1 */
  bool is_text, is_big_endian;
  size_t element_count;
  element elements[MAX_ELEMENTS];
  unsigned long long point_count;
} reader;

static cellist_result wrong_line(const reader *ply, const char *what) {
  return cellist_fail(ply->context, CELLIST_ERROR_FORMAT, "%s: line %zu of the header: %s", ply->name, ply->line, what);
}

/* ---- Header ----------------------------------------------------------------------------------------- */

/* Cuts the header's next line into words; returns their number, -1 at the file's end or for a line too long. */
static int next_line(reader *ply, char words[6][WORD]) {
  int count = 0;
  size_t length = 0;
  ply->line++;
  for (; ply->at < ply->size; ply->at++) {
    const unsigned char c = ply->bytes[ply->at];
    if (c == '\n' || c == ' ' || c == '\t' || c == '\r') {
      if (length > 0 && count < 6) words[count++][length] = '\0';
      length = 0;
      if (c != '\n') continue;
      ply->at++;
      return count;
    }
    if (count < 6) { /* what lies beyond belongs to comments */
      if (length == WORD - 1) return -1;
      words[count][length++] = (char)c;
    }
  }
  return -1;
}

static int type_of(const char *word) {
  for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
    if (strcmp(word, types[i].names[0]) == 0 || strcmp(word, types[i].names[1]) == 0) return (int)i;
  return -1;
}

static cellist_result add_element(reader *ply, char words[6][WORD], int count) {
  if (count != 3 || ply->element_count == MAX_ELEMENTS || words[2][0] < '0' || words[2][0] > '9')
    return wrong_line(ply, "not an element, or too many");
  if (strcmp(words[1], "tristrips") == 0)
    return cellist_fail(ply->context, CELLIST_ERROR_UNSUPPORTED, "%s: triangle strips are not read", ply->name);
  char *end = NULL;
  element *made = &ply->elements[ply->element_count++];
  *made = (element){.is_vertex = strcmp(words[1], "vertex") == 0};
  made->count = strtoull(words[2], &end, 10);
  if (*end != '\0' || made->count > ply->size) return wrong_line(ply, "the file is too short for so many elements");
  if (made->is_vertex) ply->point_count = made->count;
  return CELLIST_SUCCESS;
}

static cellist_result add_property(reader *ply, char words[6][WORD], int count) {
  const bool is_list = count == 5 && strcmp(words[1], "list") == 0;
  element *of = ply->element_count > 0 ? &ply->elements[ply->element_count - 1] : NULL;
  if (of == NULL || of->property_count == MAX_PROPERTIES || !(is_list || count == 3))
    return wrong_line(ply, "not a property, without an element, or too many");
  property *made = &of->properties[of->property_count++];
  *made = (property){type_of(words[is_list ? 3 : 1]), is_list ? type_of(words[2]) : -1, false};
  if (made->type < 0 || (is_list && (made->count_type < 0 || types[made->count_type].is_real)))
    return wrong_line(ply, "no such type");
  made->is_corner = is_list && (strcmp(words[4], "vertex_indices") == 0 || strcmp(words[4], "vertex_index") == 0);
  if (is_list && of->is_vertex) return wrong_line(ply, "points with lists are not read");
  if (made->is_corner && types[made->type].is_real) return wrong_line(ply, "ids of points must be whole numbers");
  return CELLIST_SUCCESS;
}

static cellist_result read_header(reader *ply) {
  char words[6][WORD];
  bool has_format = false;
  if (next_line(ply, words) != 1 || strcmp(words[0], "ply") != 0)
    return cellist_fail(ply->context, CELLIST_ERROR_FORMAT, "%s: not a PLY file", ply->name);
  for (;;) {
    const int count = next_line(ply, words);
    cellist_result result = CELLIST_SUCCESS;
    if (count < 0) return cellist_fail(ply->context, CELLIST_ERROR_FORMAT, "%s: the header has no end", ply->name);
    if (count == 1 && strcmp(words[0], "end_header") == 0) break;
    if (count > 0 && strcmp(words[0], "format") == 0 && count == 3 && !has_format) {
      has_format = true;
      ply->is_text = strcmp(words[1], "ascii") == 0;
      ply->is_big_endian = strcmp(words[1], "binary_big_endian") == 0;
      if ((!ply->is_text && !ply->is_big_endian && strcmp(words[1], "binary_little_endian") != 0) ||
          strcmp(words[2], "1.0") != 0)
        result = wrong_line(ply, "no such format");
    } else if (count > 0 && strcmp(words[0], "element") == 0) {
      result = add_element(ply, words, count);
    } else if (count > 0 && strcmp(words[0], "property") == 0) {
      result = add_property(ply, words, count);
    } else if (count == 0 || (strcmp(words[0], "comment") != 0 && strcmp(words[0], "obj_info") != 0)) {
      result = wrong_line(ply, "neither format, element, property nor comment");
    }
    if (result != CELLIST_SUCCESS) return result;
  }
  return has_format ? CELLIST_SUCCESS : wrong_line(ply, "there was no format");
}

/* ---- Body ------------------------------------------------------------------------------------------- */

static bool is_space(unsigned char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/* The next number of that type; false at the file's end, or if it is none. Real ones only have to be there. */
static bool next_number(reader *ply, int type, long long *value) {
  *value = 0;
  if (!ply->is_text) {
    const size_t size = types[type].size;
    if (ply->size - ply->at < size) return false;
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++) bits = bits << 8 | ply->bytes[ply->at + (ply->is_big_endian ? i : size - 1 - i)];
    ply->at += size;
    if (types[type].is_real) return true;
    const unsigned unused = (unsigned)(64 - 8 * size);
    *value = types[type].is_signed ? (int64_t)(bits << unused) >> unused : (long long)bits;
    return true;
  }
  char word[WORD];
  size_t length = 0;
  while (ply->at < ply->size && is_space(ply->bytes[ply->at])) ply->at++;
  for (; ply->at < ply->size && !is_space(ply->bytes[ply->at]); ply->at++) {
    if (length == WORD - 1 || ply->bytes[ply->at] == '\0') return false;
    word[length++] = (char)ply->bytes[ply->at];
  }
  word[length] = '\0';
  char *end = NULL;
  if (types[type].is_real)
    (void)strtod(word, &end);
  else
    *value = strtoll(word, &end, 10);
  return length > 0 && *end == '\0';
}

static cellist_result check_row(reader *ply, const element *of, size_t number, unsigned long long row) {
  for (size_t p = 0; p < of->property_count; p++) {
    const property *checked = &of->properties[p];
    long long value = 0, count = 1;
    bool ok = checked->count_type < 0 || next_number(ply, checked->count_type, &count);
    if (ok && checked->is_corner && count < 3)
      return cellist_fail(ply->context, CELLIST_ERROR_FORMAT, "%s: face %llu has %lld points", ply->name, row, count);
    for (long long i = 0; i < count && ok; i++) {
      ok = next_number(ply, checked->type, &value);
      if (ok && checked->is_corner && (value < 0 || (unsigned long long)value >= ply->point_count))
        return cellist_fail(ply->context, CELLIST_ERROR_FORMAT,
                            "%s: face %llu names point %lld, but there are only %llu", ply->name, row, value,
                            ply->point_count);
    }
    if (!ok || count < 0)
      return cellist_fail(ply->context, CELLIST_ERROR_FORMAT, "%s: element %zu, number %llu: cut off, or not a number",
                          ply->name, number, row);
  }
  return CELLIST_SUCCESS;
}

cellist_result surface_check_ply(cellist_context *context, const char *name, const char *bytes, size_t size) {
  reader ply = {.context = context, .name = name, .bytes = (const unsigned char *)bytes, .size = size};
  cellist_result result = read_header(&ply);
  for (size_t e = 0; e < ply.element_count && result == CELLIST_SUCCESS; e++)
    for (unsigned long long row = 0; row < ply.elements[e].count && result == CELLIST_SUCCESS; row++)
      result = check_row(&ply, &ply.elements[e], e, row);
  return result;
}
