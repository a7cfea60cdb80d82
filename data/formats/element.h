/* SPDX-License-Identifier: BSD-3-Clause
 * Element: numbers of a file's type and byte order into those that a grid holds. Private to data/. */
#ifndef CELLIST_FORMATS_ELEMENT_H
#define CELLIST_FORMATS_ELEMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum element_type {
  ELEMENT_INT8,
  ELEMENT_UINT8,
  ELEMENT_INT16,
  ELEMENT_UINT16,
  ELEMENT_INT32,
  ELEMENT_UINT32,
  ELEMENT_INT64,
  ELEMENT_UINT64,
  ELEMENT_FLOAT32,
  ELEMENT_FLOAT64
};

size_t element_size(enum element_type type);

/* What a grid keeps: values, ids below 2^32 - 1, sizes and offsets (-1 becomes SIZE_MAX), bytes. */
enum element_kind { ELEMENT_AS_DOUBLE, ELEMENT_AS_ID, ELEMENT_AS_SIZE, ELEMENT_AS_BYTE };

size_t element_kind_size(enum element_kind kind);

/* Takes a file's bytes in portions of any size and stores what they mean. */
struct element_sink {
  enum element_type type;
  bool swap; /* the file's byte order is not the machine's */
  enum element_kind kind;
  void *values; /* [count] of kind */
  size_t count, filled;
  uint8_t partial[8]; /* an element that a portion ended in */
  size_t partial_size;
};

/* False if a value does not fit its kind (negative, too large, not whole): it is number sink->filled. Bytes beyond
 * count are ignored. */
bool element_sink_push(struct element_sink *sink, const uint8_t *bytes, size_t size);

/* Stores one value that came as text; false as above. */
bool element_store_integer(enum element_kind kind, void *values, size_t at, int64_t value);
bool element_store_double(enum element_kind kind, void *values, size_t at, double value);

/* Unsigned integers of 4 and 8 bytes anywhere in a file. */
uint32_t element_load_u32(const uint8_t *bytes, bool swap);
uint64_t element_load_u64(const uint8_t *bytes, bool swap);

/* Whether the machine stores the lowest byte first. */
static inline bool element_machine_is_little(void) {
  const uint16_t one = 1;
  return *(const uint8_t *)&one == 1;
}

#endif
