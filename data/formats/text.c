/* SPDX-License-Identifier: BSD-3-Clause
 * Text: a scanner over mapped bytes.
 *
 * Numbers of up to 15 digits with a power of ten up to 22 are exact in one multiplication or division (Clinger, "How
 * to read floating point numbers accurately", 1990); the others go to strtod in the C locale. */
#include "text.h"

#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* No number needs more; a longer word is no number. */
enum { NUMBER_LIMIT = 1100 };

struct text text_of(const struct source *source, char comment) {
  return (struct text){source->bytes, source->bytes, source->bytes + source->size, comment};
}

static bool is_blank(uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

static void skip_blanks(struct text *text, bool over_lines) {
  while (text->at < text->end) {
    if (text->comment != 0 && *text->at == (uint8_t)text->comment) {
      while (text->at < text->end && *text->at != '\n') text->at++;
    } else if (is_blank(*text->at) && (over_lines || *text->at != '\n')) {
      text->at++;
    } else {
      return;
    }
  }
}

static struct text_word take_word(struct text *text) {
  struct text_word word = {text->at, 0};
  while (text->at < text->end && !is_blank(*text->at)) text->at++;
  word.length = (size_t)(text->at - word.begin);
  return word;
}

struct text_word text_next_word(struct text *text) {
  skip_blanks(text, true);
  return take_word(text);
}

struct text_word text_next_word_in_line(struct text *text) {
  skip_blanks(text, false);
  return take_word(text);
}

void text_skip_line(struct text *text) {
  const uint8_t *newline = text->at < text->end ? memchr(text->at, '\n', (size_t)(text->end - text->at)) : NULL;
  text->at = newline != NULL ? newline + 1 : text->end;
}

size_t text_count_words_in_line(const struct text *text) {
  struct text ahead = *text;
  size_t count = 0;
  while (text_next_word_in_line(&ahead).length > 0) count++;
  return count;
}

bool text_word_is(struct text_word word, const char *expected) {
  return word.length == strlen(expected) && memcmp(word.begin, expected, word.length) == 0;
}

bool text_word_is_like(struct text_word word, const char *expected) {
  if (word.length != strlen(expected)) return false;
  for (size_t i = 0; i < word.length; i++) {
    const uint8_t c = word.begin[i], e = (uint8_t)expected[i];
    const uint8_t lower = c >= 'A' && c <= 'Z' ? (uint8_t)(c + 32) : c;
    if (lower != (e >= 'A' && e <= 'Z' ? e + 32 : e)) return false;
  }
  return true;
}

bool text_word_to_integer(struct text_word word, int64_t *value) {
  const uint8_t *at = word.begin, *end = word.begin + word.length;
  const bool negative = at < end && *at == '-';
  if (at < end && (*at == '-' || *at == '+')) at++;
  if (at == end || end - at > 18) return false;
  int64_t sum = 0;
  for (; at < end; at++) {
    if (*at < '0' || *at > '9') return false;
    sum = 10 * sum + (*at - '0');
  }
  *value = negative ? -sum : sum;
  return true;
}

static bool slow_double(struct text_word word, double *value) {
  char copy[NUMBER_LIMIT + 1];
  if (word.length == 0 || word.length > NUMBER_LIMIT) return false;
  for (size_t i = 0; i < word.length; i++) {
    /* Fortran writes 1.0D+00; hexadecimal digits and C's suffixes are not for mesh files. */
    const char c = (char)word.begin[i];
    if (c == 'x' || c == 'X' || c == '(') return false;
    copy[i] = c == 'D' || c == 'd' ? 'e' : c;
  }
  copy[word.length] = '\0';
  const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  const locale_t previous = plain != (locale_t)0 ? uselocale(plain) : (locale_t)0;
  char *end = NULL;
  *value = strtod(copy, &end);
  if (plain != (locale_t)0) {
    uselocale(previous);
    freelocale(plain);
  }
  return end == copy + word.length;
}

bool text_word_to_double(struct text_word word, double *value) {
  static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                  1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const uint8_t *at = word.begin, *end = word.begin + word.length;
  const bool negative = at < end && *at == '-';
  if (at < end && (*at == '-' || *at == '+')) at++;
  uint64_t digits = 0;
  int digit_count = 0, exponent = 0;
  bool any = false;
  for (; at < end && *at >= '0' && *at <= '9'; at++, any = true)
    if (digit_count < 16) digits = 10 * digits + (*at - '0'), digit_count += digits > 0;
  if (at < end && *at == '.') {
    for (at++; at < end && *at >= '0' && *at <= '9'; at++, any = true)
      if (digit_count < 16) digits = 10 * digits + (*at - '0'), digit_count += digits > 0, exponent--;
  }
  if (!any || digit_count > 15) return slow_double(word, value);
  if (at < end && (*at == 'e' || *at == 'E')) {
    int64_t power = 0;
    const struct text_word rest = {at + 1, (size_t)(end - at - 1)};
    if (!text_word_to_integer(rest, &power)) return false;
    if (power < -1000 || power > 1000) return slow_double(word, value);
    exponent += (int)power;
    at = end;
  }
  if (at != end || exponent < -22 || exponent > 22) return slow_double(word, value);
  const double magnitude = exponent < 0 ? (double)digits / powers[-exponent] : (double)digits * powers[exponent];
  *value = negative ? -magnitude : magnitude;
  return true;
}

bool text_next_integer(struct text *text, int64_t *value) { return text_word_to_integer(text_next_word(text), value); }
bool text_next_double(struct text *text, double *value) { return text_word_to_double(text_next_word(text), value); }

bool text_next_count(struct text *text, size_t bytes_each, size_t *count) {
  int64_t value = 0;
  if (!text_next_integer(text, &value) || value < 0) return false;
  /* One byte more: the last value needs no blank after it. */
  const size_t left = (size_t)(text->end - text->at) + 1;
  if (bytes_each > 0 && (size_t)value > left / bytes_each) return false;
  *count = (size_t)value;
  return true;
}

bool text_read_values(struct text *text, enum element_kind kind, void *values, size_t count, size_t *filled) {
  for (*filled = 0; *filled < count; ++*filled) {
    const struct text_word word = text_next_word(text);
    int64_t integer = 0;
    double number = 0;
    if (kind != ELEMENT_AS_DOUBLE && text_word_to_integer(word, &integer)) {
      if (!element_store_integer(kind, values, *filled, integer)) return false;
    } else if (!text_word_to_double(word, &number) || !element_store_double(kind, values, *filled, number)) {
      return false;
    }
  }
  return true;
}

cellist_result text_fail(cellist_context *context, const struct source *source, const struct text *text,
                         const char *format, ...) {
  size_t line = 1;
  for (const uint8_t *at = text->begin; at < text->at; at++) line += *at == '\n' && at + 1 < text->at;
  char reason[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason, sizeof reason, format, arguments);
  va_end(arguments);
  return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: line %zu: %s", source->name, line, reason);
}
