/* SPDX-License-Identifier: BSD-3-Clause
 * What the tests of readers and writers share. */
#ifndef CELLIST_TESTS_FORMATS_H
#define CELLIST_TESTS_FORMATS_H

#include <cellist/mesh.h>
#include <cellist/mesh_write.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

/* A file's bytes, made piece by piece. */
struct bytes {
  uint8_t *data;
  size_t size, capacity;
};

static inline void bytes_add(struct bytes *bytes, const void *data, size_t size) {
  if (bytes->size + size > bytes->capacity) {
    bytes->capacity = 2 * (bytes->size + size);
    bytes->data = realloc(bytes->data, bytes->capacity);
    assert_non_null(bytes->data);
  }
  if (size > 0) memcpy(bytes->data + bytes->size, data, size);
  bytes->size += size;
}

static inline void bytes_text(struct bytes *bytes, const char *text) { bytes_add(bytes, text, strlen(text)); }

/* The lowest size bytes of value. */
static inline void bytes_number(struct bytes *bytes, uint64_t value, size_t size, bool big_endian) {
  for (size_t i = 0; i < size; i++) {
    const uint8_t byte = (uint8_t)(value >> 8 * (big_endian ? size - 1 - i : i));
    bytes_add(bytes, &byte, 1);
  }
}

static inline void bytes_float(struct bytes *bytes, double value, size_t size, bool big_endian) {
  const float narrow = (float)value;
  uint64_t wide_bits = 0;
  uint32_t narrow_bits = 0;
  memcpy(&wide_bits, &value, 8);
  memcpy(&narrow_bits, &narrow, 4);
  bytes_number(bytes, size == 4 ? narrow_bits : wide_bits, size, big_endian);
}

static inline void bytes_free(struct bytes *bytes) {
  free(bytes->data);
  *bytes = (struct bytes){0};
}

/* Reads what must be readable. */
static inline cellist_mesh *read_bytes(cellist_context *context, const char *name, const struct bytes *bytes) {
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read_memory(context, name, bytes->data, bytes->size, NULL, &mesh));
  return mesh;
}

static inline cellist_mesh *read_text(cellist_context *context, const char *name, const char *text) {
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read_memory(context, name, text, strlen(text), NULL, &mesh));
  return mesh;
}

static inline void assert_unreadable(cellist_context *context, const char *name, const char *text,
                                     cellist_result expected, const char *part) {
  cellist_mesh *mesh = NULL;
  assert_failure(context, cellist_mesh_read_memory(context, name, text, strlen(text), NULL, &mesh), expected, part);
  assert_null(mesh);
}

/* Six times the volume of all tets. */
static inline double mesh_volume6(const cellist_mesh *mesh) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  double sum = 0;
  for (size_t i = 0; i < a->tet_count; i++) {
    double e[3][3];
    for (int r = 0; r < 3; r++)
      for (int k = 0; k < 3; k++)
        e[r][k] = a->positions[3 * (size_t)a->tets[4 * i + (size_t)r + 1] + (size_t)k] -
                  a->positions[3 * (size_t)a->tets[4 * i] + (size_t)k];
    sum += e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) - e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
           e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
  }
  return sum;
}

/* One tet by the user's ids: its cell and its corners, rising. */
struct user_tet {
  uint32_t origin, corners[4], index;
};

static inline int compare_user_tets(const void *first, const void *second) {
  const struct user_tet *a = first, *b = second;
  if (a->origin != b->origin) return a->origin < b->origin ? -1 : 1;
  for (int k = 0; k < 4; k++)
    if (a->corners[k] != b->corners[k]) return a->corners[k] < b->corners[k] ? -1 : 1;
  return 0;
}

/* All tets in the order of the user's ids; free() it. */
static inline struct user_tet *user_tets(const cellist_mesh *mesh) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  struct user_tet *tets = calloc(a->tet_count + 1, sizeof *tets);
  assert_non_null(tets);
  for (uint32_t i = 0; i < a->tet_count; i++) {
    tets[i].origin = a->tet_origin[i];
    tets[i].index = i;
    for (int k = 0; k < 4; k++) {
      const uint32_t id = a->point_origin[a->tets[4 * i + (uint32_t)k]];
      int at = k;
      for (; at > 0 && tets[i].corners[at - 1] > id; at--) tets[i].corners[at] = tets[i].corners[at - 1];
      tets[i].corners[at] = id;
    }
  }
  qsort(tets, a->tet_count, sizeof *tets, compare_user_tets);
  return tets;
}

/* Both hold the same points, tets (as sets of points) and fields at the same user's ids. */
static inline void assert_same_mesh(const cellist_mesh *first, const cellist_mesh *second) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(first), *b = cellist_mesh_get_arrays(second);
  assert_int_equal(a->point_count, b->point_count);
  assert_int_equal(a->tet_count, b->tet_count);
  assert_int_equal(a->field_count, b->field_count);
  /* Points stand in an order that follows from coordinates and ids alone. */
  assert_memory_equal(a->positions, b->positions, 3 * a->point_count * sizeof *a->positions);
  assert_memory_equal(a->point_origin, b->point_origin, a->point_count * sizeof *a->point_origin);
  struct user_tet *s = user_tets(first), *t = user_tets(second);
  for (size_t i = 0; i < a->tet_count; i++) assert_int_equal(compare_user_tets(&s[i], &t[i]), 0);
  for (size_t i = 0; i < a->field_count; i++) {
    const cellist_field *f = &a->fields[i];
    const cellist_field *g = NULL;
    for (size_t j = 0; j < b->field_count; j++)
      if (strcmp(b->fields[j].name, f->name) == 0 && b->fields[j].association == f->association) g = &b->fields[j];
    if (g == NULL) fail_msg("no field '%s'", f->name);
    assert_int_equal(g->component_count, f->component_count);
    const size_t size = f->component_count * sizeof *f->values;
    if (f->association == CELLIST_ON_POINTS) assert_memory_equal(f->values, g->values, a->point_count * size);
    for (size_t tet = 0; tet < a->tet_count && f->association == CELLIST_ON_CELLS; tet++)
      assert_memory_equal(&f->values[s[tet].index * f->component_count], &g->values[t[tet].index * f->component_count],
                          size);
  }
  free(s);
  free(t);
}

#endif
