/* SPDX-License-Identifier: BSD-3-Clause
 * Element: conversion in batches that stay in the first cache: some 1 ns a number. */
#include "element.h"

#include <string.h>

enum { BATCH = 256 };

size_t element_size(enum element_type type) {
  static const uint8_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[type];
}

size_t element_kind_size(enum element_kind kind) {
  static const uint8_t sizes[] = {sizeof(double), sizeof(uint32_t), sizeof(size_t), 1};
  return sizes[kind];
}

uint32_t element_load_u32(const uint8_t *bytes, bool swap) {
  uint32_t value;
  memcpy(&value, bytes, sizeof value);
  return swap ? __builtin_bswap32(value) : value;
}

uint64_t element_load_u64(const uint8_t *bytes, bool swap) {
  uint64_t value;
  memcpy(&value, bytes, sizeof value);
  return swap ? __builtin_bswap64(value) : value;
}

static uint16_t load_u16(const uint8_t *bytes, bool swap) {
  uint16_t value;
  memcpy(&value, bytes, sizeof value);
  return swap ? __builtin_bswap16(value) : value;
}

static float load_float(const uint8_t *bytes, bool swap) {
  const uint32_t bits = element_load_u32(bytes, swap);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static double load_double(const uint8_t *bytes, bool swap) {
  const uint64_t bits = element_load_u64(bytes, swap);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

#define LOAD(out, expression) \
  for (size_t i = 0; i < count; i++) (out)[i] = expression

static void load_doubles(enum element_type type, bool swap, const uint8_t *bytes, size_t count, double *out) {
  switch (type) {
    case ELEMENT_INT8: LOAD(out, (int8_t)bytes[i]); return;
    case ELEMENT_UINT8: LOAD(out, bytes[i]); return;
    case ELEMENT_INT16: LOAD(out, (int16_t)load_u16(bytes + 2 * i, swap)); return;
    case ELEMENT_UINT16: LOAD(out, load_u16(bytes + 2 * i, swap)); return;
    case ELEMENT_INT32: LOAD(out, (int32_t)element_load_u32(bytes + 4 * i, swap)); return;
    case ELEMENT_UINT32: LOAD(out, element_load_u32(bytes + 4 * i, swap)); return;
    case ELEMENT_INT64: LOAD(out, (double)(int64_t)element_load_u64(bytes + 8 * i, swap)); return;
    case ELEMENT_UINT64: LOAD(out, (double)element_load_u64(bytes + 8 * i, swap)); return;
    case ELEMENT_FLOAT32: LOAD(out, (double)load_float(bytes + 4 * i, swap)); return;
    case ELEMENT_FLOAT64: LOAD(out, load_double(bytes + 8 * i, swap)); return;
  }
}

/* Beyond every id and size: what a number that is no integer becomes, so that storing it fails. */
static const int64_t NOT_AN_INTEGER = INT64_MIN;

static int64_t whole(double value) {
  /* Doubles beyond 2^62 are no sizes; the comparison is false for NaN. */
  if (!(value > -0x1p62 && value < 0x1p62)) return NOT_AN_INTEGER;
  const int64_t integer = (int64_t)value;
  return (double)integer == value ? integer : NOT_AN_INTEGER;
}

static int64_t from_u64(uint64_t value) { return value <= INT64_MAX ? (int64_t)value : NOT_AN_INTEGER; }

static void load_integers(enum element_type type, bool swap, const uint8_t *bytes, size_t count, int64_t *out) {
  switch (type) {
    case ELEMENT_INT8: LOAD(out, (int8_t)bytes[i]); return;
    case ELEMENT_UINT8: LOAD(out, bytes[i]); return;
    case ELEMENT_INT16: LOAD(out, (int16_t)load_u16(bytes + 2 * i, swap)); return;
    case ELEMENT_UINT16: LOAD(out, load_u16(bytes + 2 * i, swap)); return;
    case ELEMENT_INT32: LOAD(out, (int32_t)element_load_u32(bytes + 4 * i, swap)); return;
    case ELEMENT_UINT32: LOAD(out, element_load_u32(bytes + 4 * i, swap)); return;
    case ELEMENT_INT64: LOAD(out, (int64_t)element_load_u64(bytes + 8 * i, swap)); return;
    case ELEMENT_UINT64: LOAD(out, from_u64(element_load_u64(bytes + 8 * i, swap))); return;
    case ELEMENT_FLOAT32: LOAD(out, whole((double)load_float(bytes + 4 * i, swap))); return;
    case ELEMENT_FLOAT64: LOAD(out, whole(load_double(bytes + 8 * i, swap))); return;
  }
}

bool element_store_integer(enum element_kind kind, void *values, size_t at, int64_t value) {
  switch (kind) {
    case ELEMENT_AS_DOUBLE: ((double *)values)[at] = (double)value; return true;
    case ELEMENT_AS_ID:
      if (value < 0 || value >= UINT32_MAX) return false;
      ((uint32_t *)values)[at] = (uint32_t)value;
      return true;
    case ELEMENT_AS_SIZE:
      if (value < -1) return false;
      ((size_t *)values)[at] = value < 0 ? SIZE_MAX : (size_t)value;
      return true;
    case ELEMENT_AS_BYTE:
      if (value < 0 || value > UINT8_MAX) return false;
      ((uint8_t *)values)[at] = (uint8_t)value;
      return true;
  }
  return false;
}

bool element_store_double(enum element_kind kind, void *values, size_t at, double value) {
  if (kind != ELEMENT_AS_DOUBLE) return element_store_integer(kind, values, at, whole(value));
  ((double *)values)[at] = value;
  return true;
}

/* Whole elements only. */
static bool store(struct element_sink *sink, const uint8_t *bytes, size_t count) {
  const size_t size = element_size(sink->type);
  int64_t integers[BATCH];
  while (count > 0) {
    const size_t batch = count < BATCH ? count : BATCH;
    if (sink->kind == ELEMENT_AS_DOUBLE) {
      load_doubles(sink->type, sink->swap, bytes, batch, (double *)sink->values + sink->filled);
      sink->filled += batch;
    } else {
      load_integers(sink->type, sink->swap, bytes, batch, integers);
      for (size_t i = 0; i < batch; i++) {
        if (!element_store_integer(sink->kind, sink->values, sink->filled, integers[i])) return false;
        sink->filled++;
      }
    }
    bytes += batch * size;
    count -= batch;
  }
  return true;
}

bool element_sink_push(struct element_sink *sink, const uint8_t *bytes, size_t size) {
  const size_t each = element_size(sink->type);
  if (sink->partial_size > 0) {
    while (size > 0 && sink->partial_size < each && sink->partial_size < sizeof sink->partial) {
      sink->partial[sink->partial_size++] = *bytes++;
      size--;
    }
    if (sink->partial_size < each) return true;
    sink->partial_size = 0;
    if (sink->filled < sink->count && !store(sink, sink->partial, 1)) return false;
  }
  const size_t whole_count = size / each, room = sink->count - sink->filled;
  if (!store(sink, bytes, whole_count < room ? whole_count : room)) return false;
  sink->partial_size = size - whole_count * each;
  if (sink->partial_size > 0) memcpy(sink->partial, bytes + whole_count * each, sink->partial_size);
  return true;
}
