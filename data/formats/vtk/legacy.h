/* SPDX-License-Identifier: BSD-3-Clause
 * Legacy VTK: what its two files share. Private to data/. */
#ifndef CELLIST_FORMATS_LEGACY_H
#define CELLIST_FORMATS_LEGACY_H

#include "../text.h"

struct legacy {
  cellist_context *context;
  const struct source *source;
  struct text text;
  bool is_binary; /* and then big-endian */
  bool is_structured;
  int version; /* the major one */
  struct grid *grid;
};

/* FORMAT with the line (or the byte, of a binary file). */
cellist_result legacy_fail(struct legacy *legacy, const char *format, ...) CELLIST_PRINTF(2, 3);

/* A type's name, in any case. is_packed: bits. */
bool legacy_type_of(struct text_word word, enum element_type *type, bool *is_packed);

/* legacy_data.c: count numbers that begin after this line (binary) or word (text). *values is the caller's. */
cellist_result legacy_read_values(struct legacy *legacy, enum element_type type, enum element_kind kind, size_t count,
                                  void **values);

/* legacy_data.c: POINT_DATA and CELL_DATA up to the end of the file; keyword is the one just read. */
cellist_result legacy_read_attributes(struct legacy *legacy, struct text_word keyword);

/* legacy_data.c: a FIELD of arrays that belong to neither points nor cells: passed over. */
cellist_result legacy_skip_field(struct legacy *legacy);

/* legacy_data.c: METADATA up to its empty line. */
void legacy_skip_metadata(struct legacy *legacy);

#endif
