/* SPDX-License-Identifier: BSD-3-Clause
 * Text: words and numbers of a text file, in one pass, whatever the locale. Private to data/. */
#ifndef CELLIST_FORMATS_TEXT_H
#define CELLIST_FORMATS_TEXT_H

#include "element.h"
#include "source.h"

struct text {
  const uint8_t *begin, *at, *end; /* at: what is next */
  char comment;                    /* a word that starts with it, and the rest of its line, is skipped; 0: none */
};

struct text_word {
  const uint8_t *begin;
  size_t length; /* 0: the text has ended */
};

struct text text_of(const struct source *source, char comment);

/* The next word (between blanks), over line ends. */
struct text_word text_next_word(struct text *text);

/* The next word of this line; length 0 at its end. */
struct text_word text_next_word_in_line(struct text *text);

/* Goes to the start of the next line. */
void text_skip_line(struct text *text);

/* Words left in this line, without moving. */
size_t text_count_words_in_line(const struct text *text);

bool text_word_is(struct text_word word, const char *expected);      /* the letters' case counts */
bool text_word_is_like(struct text_word word, const char *expected); /* it does not */
bool text_word_to_integer(struct text_word word, int64_t *value);    /* decimal, all of the word */
bool text_word_to_double(struct text_word word, double *value);      /* all of the word; nan, inf too */
bool text_next_integer(struct text *text, int64_t *value);
bool text_next_double(struct text *text, double *value);

/* A count that text still to come can justify: at least 0, and bytes_each bytes of what is left for each. */
bool text_next_count(struct text *text, size_t bytes_each, size_t *count);

/* Fills count values; false at a word that is no such number: *filled says which. */
bool text_read_values(struct text *text, enum element_kind kind, void *values, size_t count, size_t *filled);

/* "NAME: line N: reason", as FORMAT. The line is counted now, over what has been read: call it once. */
cellist_result text_fail(cellist_context *context, const struct source *source, const struct text *text,
                         const char *format, ...) CELLIST_PRINTF(4, 5);

#endif
