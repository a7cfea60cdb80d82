/* SPDX-License-Identifier: BSD-3-Clause
 * Coincident triangles: of those with the same three corners the first is kept. They lie at the same depth on every
 * ray, so which one was seen would be up to each renderer's rounding: where surfaces of cells share faces with the
 * mesh's boundary, say. A hash table of triangles by their corners, in any order. */
#include <string.h>

#include "surface_private.h"

static uint64_t hash_of(const cellist_surface_arrays *arrays, size_t triangle) {
  uint64_t sum = 0;
  for (size_t c = 0; c < 3; c++) {
    uint64_t hash = 0;
    for (size_t k = 0; k < 3; k++) {
      const double number = arrays->positions[3 * (size_t)arrays->triangles[3 * triangle + c] + k] + 0.0; /* -0 is 0 */
      uint64_t bits;
      memcpy(&bits, &number, sizeof bits);
      hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    }
    sum += hash * 0xbf58476d1ce4e5b9u;
  }
  return sum ^ sum >> 32;
}

static bool are_at_one_place(const cellist_surface_arrays *arrays, uint32_t a, uint32_t b) {
  const double *p = &arrays->positions[3 * (size_t)a], *q = &arrays->positions[3 * (size_t)b];
  return a == b || (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]);
}

static bool coincide(const cellist_surface_arrays *arrays, size_t a, size_t b) {
  static const uint8_t orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  const uint32_t *of_a = &arrays->triangles[3 * a], *of_b = &arrays->triangles[3 * b];
  for (int i = 0; i < 6; i++) {
    int same = 0;
    while (same < 3 && are_at_one_place(arrays, of_a[same], of_b[orders[i][same]])) same++;
    if (same == 3) return true;
  }
  return false;
}

cellist_result surface_keep_first(cellist_context *context, const cellist_surface_arrays *arrays, uint32_t **triangles,
                                  size_t *triangle_count) {
  size_t slots = 4;
  while (slots < 2 * arrays->triangle_count) slots *= 2;
  uint32_t *table = cellist_allocate_zeroed(context, slots, sizeof *table); /* triangle + 1; 0: free */
  uint32_t *kept = cellist_allocate(context, arrays->triangle_count, 3 * sizeof *kept);
  if (table == NULL || kept == NULL) {
    cellist_deallocate(context, table);
    cellist_deallocate(context, kept);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  size_t count = 0;
  for (size_t i = 0; i < arrays->triangle_count; i++) {
    size_t slot = hash_of(arrays, i) & (slots - 1);
    while (table[slot] != 0 && !coincide(arrays, table[slot] - 1, i)) slot = (slot + 1) & (slots - 1);
    if (table[slot] != 0) continue;
    table[slot] = (uint32_t)i + 1;
    memcpy(&kept[3 * count++], &arrays->triangles[3 * i], 3 * sizeof *kept);
  }
  cellist_deallocate(context, table);
  *triangles = kept;
  *triangle_count = count;
  return CELLIST_SUCCESS;
}
