/* SPDX-License-Identifier: BSD-3-Clause
 * Arcs with byte shuffles (part of AVX2 machines): a cell's neighbours in front move together in one instruction. */
#include "arcs.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

/* By the faces in front: which bytes of the four neighbours go where; 128 writes zero. */
static const _Alignas(64) uint8_t shuffles[16][16] = {
    {128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128},
    {0, 1, 2, 3, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128},
    {4, 5, 6, 7, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128},
    {0, 1, 2, 3, 4, 5, 6, 7, 128, 128, 128, 128, 128, 128, 128, 128},
    {8, 9, 10, 11, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128},
    {0, 1, 2, 3, 8, 9, 10, 11, 128, 128, 128, 128, 128, 128, 128, 128},
    {4, 5, 6, 7, 8, 9, 10, 11, 128, 128, 128, 128, 128, 128, 128, 128},
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 128, 128, 128, 128},
    {12, 13, 14, 15, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128, 128},
    {0, 1, 2, 3, 12, 13, 14, 15, 128, 128, 128, 128, 128, 128, 128, 128},
    {4, 5, 6, 7, 12, 13, 14, 15, 128, 128, 128, 128, 128, 128, 128, 128},
    {0, 1, 2, 3, 4, 5, 6, 7, 12, 13, 14, 15, 128, 128, 128, 128},
    {8, 9, 10, 11, 12, 13, 14, 15, 128, 128, 128, 128, 128, 128, 128, 128},
    {0, 1, 2, 3, 8, 9, 10, 11, 12, 13, 14, 15, 128, 128, 128, 128},
    {4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 128, 128, 128, 128},
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
};
static const uint8_t counts[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};

__attribute__((target("avx2"))) size_t sort_list_arcs_avx2(const uint32_t *neighbours, const uint8_t *state,
                                                           const uint32_t *tets, size_t count, const uint32_t *ahead,
                                                           uint32_t *arcs, uint32_t *states) {
  size_t arc_count = 0;
  uint32_t seen = 0;
  for (size_t i = 0; i < count; i++) {
    __builtin_prefetch(&neighbours[4 * (size_t)ahead[i]]);
    const uint32_t front = state[tets[i]];
    const __m128i all = _mm_loadu_si128((const __m128i *)&neighbours[4 * (size_t)tets[i]]);
    const __m128i shuffle = _mm_load_si128((const __m128i *)shuffles[front & 15]);
    seen |= front;
    _mm_storeu_si128((__m128i *)&arcs[arc_count], _mm_shuffle_epi8(all, shuffle));
    arc_count += counts[front & 15];
  }
  *states = seen;
  return arc_count;
}

#else

size_t sort_list_arcs_avx2(const uint32_t *neighbours, const uint8_t *state, const uint32_t *tets, size_t count,
                           const uint32_t *ahead, uint32_t *arcs, uint32_t *states) {
  return sort_list_arcs_portable(neighbours, state, tets, count, ahead, arcs, states);
}

#endif
