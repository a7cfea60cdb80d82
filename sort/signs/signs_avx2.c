/* SPDX-License-Identifier: BSD-3-Clause
 * Signs with AVX2: a tet's four planes are one 256-bit word. On other machines the portable kernel stands in. */
#include "../state.h"
#include "kernel.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

bool sort_has_avx2(void) { return __builtin_cpu_supports("avx2"); }

/* Sixteen lanes in the order below become four states. */
__attribute__((target("avx2"))) static inline void store_states(__m256i outside, __m256i inside, __m256i faces,
                                                                uint8_t *states) {
  const __m256i wait = _mm256_set1_epi16(SORT_WAIT), ones = _mm256_set1_epi16(1);
  const __m256i parts = _mm256_or_si256(_mm256_and_si256(outside, faces), _mm256_and_si256(inside, wait));
  const __m256i pairs = _mm256_madd_epi16(parts, ones); /* faces 0 + 1, and 2 + 3, of each tet */
  __m128i sums = _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
  sums = _mm_packs_epi32(sums, sums);
  sums = _mm_add_epi8(_mm_packus_epi16(sums, sums), _mm_set1_epi8((char)SORT_READY));
  _mm_storeu_si32(states, sums);
}

__attribute__((target("avx2"))) void sort_signs_avx2(const int16_t *planes, const uint16_t *inner, const int16_t eye[4],
                                                     int32_t doubt, size_t group_count, uint8_t *states,
                                                     uint8_t *mirrored, uint16_t *undecided) {
  const __m256i at = _mm256_setr_epi16(eye[0], eye[1], eye[2], eye[3], eye[0], eye[1], eye[2], eye[3], eye[0], eye[1],
                                       eye[2], eye[3], eye[0], eye[1], eye[2], eye[3]);
  const __m256i above = _mm256_set1_epi32(doubt), below = _mm256_set1_epi32(-doubt);
  /* After the sums the sixteen planes stand as faces 0 1 of tets 0 to 3, then faces 2 3 of tets 0 to 3. */
  const __m256i bits = _mm256_setr_epi16(1 << 0, 1 << 1, 1 << 4, 1 << 5, 1 << 8, 1 << 9, 1 << 12, 1 << 13, 1 << 2,
                                         1 << 3, 1 << 6, 1 << 7, 1 << 10, 1 << 11, 1 << 14, (short)(1 << 15));
  const __m256i faces = _mm256_setr_epi16(1, 2, 1, 2, 1, 2, 1, 2, 4, 8, 4, 8, 4, 8, 4, 8);
  for (size_t group = 0; group < group_count; group++) {
    const __m256i *four = (const __m256i *)&planes[64 * group];
    const __m256i p0 = _mm256_madd_epi16(_mm256_loadu_si256(&four[0]), at);
    const __m256i p1 = _mm256_madd_epi16(_mm256_loadu_si256(&four[1]), at);
    const __m256i p2 = _mm256_madd_epi16(_mm256_loadu_si256(&four[2]), at);
    const __m256i p3 = _mm256_madd_epi16(_mm256_loadu_si256(&four[3]), at);
    const __m256i low = _mm256_hadd_epi32(p0, p1), high = _mm256_hadd_epi32(p2, p3);
    __m256i outside = _mm256_packs_epi32(_mm256_cmpgt_epi32(low, above), _mm256_cmpgt_epi32(high, above));
    __m256i inside = _mm256_packs_epi32(_mm256_cmpgt_epi32(below, low), _mm256_cmpgt_epi32(below, high));
    const __m256i counts = _mm256_cmpeq_epi16(_mm256_and_si256(_mm256_set1_epi16((short)inner[group]), bits), bits);
    outside = _mm256_and_si256(outside, counts);
    inside = _mm256_and_si256(inside, counts);
    const __m256i doubtful = _mm256_andnot_si256(_mm256_or_si256(outside, inside), counts);
    store_states(outside, inside, faces, &states[4 * group]);
    if (mirrored != NULL) store_states(inside, outside, faces, &mirrored[4 * group]);
    undecided[group] = 0;
    if (_mm256_testz_si256(doubtful, doubtful)) continue;
    const __m256i left = _mm256_and_si256(doubtful, bits);
    __m128i mask = _mm_or_si128(_mm256_castsi256_si128(left), _mm256_extracti128_si256(left, 1));
    mask = _mm_or_si128(mask, _mm_srli_si128(mask, 8));
    mask = _mm_or_si128(mask, _mm_srli_si128(mask, 4));
    mask = _mm_or_si128(mask, _mm_srli_si128(mask, 2));
    undecided[group] = (uint16_t)_mm_cvtsi128_si32(mask);
  }
}

#else

bool sort_has_avx2(void) { return false; }

void sort_signs_avx2(const int16_t *planes, const uint16_t *inner, const int16_t eye[4], int32_t doubt,
                     size_t group_count, uint8_t *states, uint8_t *mirrored, uint16_t *undecided) {
  sort_signs_portable(planes, inner, eye, doubt, group_count, states, mirrored, undecided);
}

#endif
