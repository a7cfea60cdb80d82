/* SPDX-License-Identifier: BSD-3-Clause
 * Fast optics for eight segments at once: fast_optics.h in AVX2 registers. Private to project/; include only in files
 * compiled for AVX2 and FMA, and reached only where the processor has them. The results differ from the scalar ones by
 * rounding (fused operations), and a lane's do not depend on the other lanes. */
#ifndef CELLIST_FAST_OPTICS_AVX2_H
#define CELLIST_FAST_OPTICS_AVX2_H

#include <immintrin.h>

#include "fast_optics.h"

/* What eight rays have gathered. */
typedef struct fast_light8 {
  __m256 colour[3];
  __m256 transmittance, alpha;
} fast_light8;

/* The interval in which each lane's scalar is, kept from segment to segment: most end in the interval where they
 * began, and then nothing is loaded. */
typedef struct fast_interval8 {
  __m256i index;
  __m256 low, high;
  __m256 extinction, extinction_slope;
  __m256 colour[3], colour_slope[3];
} fast_interval8;

static inline bool fast_any(__m256 mask) { return _mm256_movemask_ps(mask) != 0; }

static inline __m256 fast_select(__m256 mask, __m256 yes, __m256 no) { return _mm256_blendv_ps(no, yes, mask); }

static inline __m256 fast_q8(__m256 m, __m256 g) {
  __m256 q = _mm256_setzero_ps();
  for (int i = 4; i >= 0; i--) {
    const int top = i == 4 ? 1 : 4; /* the last row has two terms */
    __m256 row = _mm256_set1_ps(FAST_Q[i][top]);
    for (int j = top - 1; j >= 0; j--) row = _mm256_fmadd_ps(row, g, _mm256_set1_ps(FAST_Q[i][j]));
    q = i == 4 ? row : _mm256_fmadd_ps(q, m, row);
  }
  return q;
}

static inline __m256 fast_alpha8(__m256 m) {
  __m256 sum = _mm256_set1_ps(FAST_ALPHA[6]);
  for (int i = 5; i >= 0; i--) sum = _mm256_fmadd_ps(sum, m, _mm256_set1_ps(FAST_ALPHA[i]));
  return _mm256_mul_ps(sum, m);
}

/* fast_add_piece; a lane with a = b = 0 gathers nothing. */
static inline void fast_add_piece8(const fast_interval8 *in, __m256 from, __m256 to, __m256 a, __m256 b,
                                   fast_light8 *light) {
  const __m256 sum = _mm256_add_ps(a, b), m = _mm256_mul_ps(_mm256_set1_ps(0.5f), sum);
  const __m256 g = _mm256_div_ps(_mm256_sub_ps(b, a), _mm256_max_ps(sum, _mm256_set1_ps(1e-30f)));
  const __m256 share = _mm256_mul_ps(fast_alpha8(m), light->transmittance);
  const __m256 s = _mm256_fmadd_ps(fast_q8(m, g), _mm256_sub_ps(from, to), to);
  const __m256 at = _mm256_sub_ps(s, in->low);
  for (int k = 0; k < 3; k++)
    light->colour[k] =
        _mm256_fmadd_ps(share, _mm256_fmadd_ps(in->colour_slope[k], at, in->colour[k]), light->colour[k]);
  light->transmittance = _mm256_sub_ps(light->transmittance, share);
  light->alpha = _mm256_add_ps(light->alpha, share);
}

/* Extinction at a scalar of the interval, times length. */
static inline __m256 fast_depth8(const fast_interval8 *in, __m256 s, __m256 length) {
  const __m256 e = _mm256_fmadd_ps(in->extinction_slope, _mm256_sub_ps(s, in->low), in->extinction);
  return _mm256_mul_ps(_mm256_max_ps(e, _mm256_setzero_ps()), length);
}

/* The part of fast_add_interval that cuts deep pieces: for all lanes, until none is deep. */
static inline void fast_add_deep8(const fast_interval8 *in, __m256 from, __m256 to, __m256 a, __m256 b, __m256 opaque,
                                  fast_light8 *light) {
  const __m256 one = _mm256_set1_ps(1), limit = _mm256_set1_ps(2 * FAST_DEPTH);
  for (;;) {
    const __m256 deep = _mm256_cmp_ps(_mm256_add_ps(a, b), limit, _CMP_GT_OQ);
    if (!fast_any(deep)) break;
    const __m256 tilt = _mm256_sub_ps(b, a);
    const __m256 inside = _mm256_max_ps(_mm256_fmadd_ps(a, a, _mm256_mul_ps(limit, tilt)), _mm256_setzero_ps());
    const __m256 root = _mm256_div_ps(limit, _mm256_add_ps(a, _mm256_sqrt_ps(inside)));
    const __m256 w = fast_select(deep, root, one);
    const __m256 middle = fast_select(deep, _mm256_fmadd_ps(w, _mm256_sub_ps(to, from), from), to);
    const __m256 there = fast_select(deep, _mm256_fmadd_ps(w, tilt, a), b);
    fast_add_piece8(in, from, middle, _mm256_mul_ps(a, w), _mm256_mul_ps(there, w), light);
    const __m256 left = _mm256_and_ps(_mm256_sub_ps(one, w), _mm256_cmp_ps(light->transmittance, opaque, _CMP_GE_OQ));
    from = middle;
    a = _mm256_mul_ps(there, left);
    b = _mm256_mul_ps(b, left);
  }
  fast_add_piece8(in, from, to, a, b, light);
}

static inline void fast_add_interval8(const fast_interval8 *in, __m256 from, __m256 to, __m256 length, __m256 opaque,
                                      fast_light8 *light) {
  const __m256 a = fast_depth8(in, from, length), b = fast_depth8(in, to, length);
  const __m256 sum = _mm256_add_ps(a, b);
  if (!fast_any(_mm256_cmp_ps(sum, _mm256_setzero_ps(), _CMP_GT_OQ))) return;
  if (fast_any(_mm256_cmp_ps(sum, _mm256_set1_ps(2 * FAST_DEPTH), _CMP_GT_OQ)))
    fast_add_deep8(in, from, to, a, b, opaque, light);
  else
    fast_add_piece8(in, from, to, a, b, light);
}

/* Eight records, transposed. */
static inline void fast_gather_intervals8(const fast_transfer *transfer, fast_interval8 *in) {
  uint32_t index[8];
  _mm256_storeu_si256((__m256i *)index, in->index);
  __m256 row[8], pair[8], quad[8];
  for (int i = 0; i < 8; i++) row[i] = _mm256_loadu_ps(&transfer->intervals[index[i]].low);
  for (int i = 0; i < 8; i += 2) {
    pair[i] = _mm256_unpacklo_ps(row[i], row[i + 1]);
    pair[i + 1] = _mm256_unpackhi_ps(row[i], row[i + 1]);
  }
  for (int i = 0; i < 8; i += 4) {
    quad[i] = _mm256_shuffle_ps(pair[i], pair[i + 2], 0x44);
    quad[i + 1] = _mm256_shuffle_ps(pair[i], pair[i + 2], 0xee);
    quad[i + 2] = _mm256_shuffle_ps(pair[i + 1], pair[i + 3], 0x44);
    quad[i + 3] = _mm256_shuffle_ps(pair[i + 1], pair[i + 3], 0xee);
  }
  in->low = _mm256_permute2f128_ps(quad[0], quad[4], 0x20);
  in->high = _mm256_permute2f128_ps(quad[1], quad[5], 0x20);
  in->extinction = _mm256_permute2f128_ps(quad[2], quad[6], 0x20);
  in->extinction_slope = _mm256_permute2f128_ps(quad[3], quad[7], 0x20);
  in->colour[0] = _mm256_permute2f128_ps(quad[0], quad[4], 0x31);
  in->colour[1] = _mm256_permute2f128_ps(quad[1], quad[5], 0x31);
  in->colour[2] = _mm256_permute2f128_ps(quad[2], quad[6], 0x31);
  in->colour_slope[0] = _mm256_permute2f128_ps(quad[3], quad[7], 0x31);
  float slope[2][8];
  for (int i = 0; i < 8; i++) {
    slope[0][i] = transfer->intervals[index[i]].colour_slope[1];
    slope[1][i] = transfer->intervals[index[i]].colour_slope[2];
  }
  in->colour_slope[1] = _mm256_loadu_ps(slope[0]);
  in->colour_slope[2] = _mm256_loadu_ps(slope[1]);
}

/* Loads the intervals of in->index. */
static inline void fast_load_intervals8(const fast_transfer *transfer, fast_interval8 *in) {
  if (!transfer->is_small) {
    fast_gather_intervals8(transfer, in);
    return;
  }
  __m256 field[FAST_FIELDS];
  for (int k = 0; k < FAST_FIELDS; k++)
    field[k] = _mm256_permutevar8x32_ps(_mm256_loadu_ps(transfer->small[k]), in->index);
  in->low = field[0];
  in->high = field[1];
  in->extinction = field[2];
  in->extinction_slope = field[3];
  for (int k = 0; k < 3; k++) {
    in->colour[k] = field[4 + k];
    in->colour_slope[k] = field[7 + k];
  }
}

/* Sets the intervals anew where a lane's scalar is not inside, or constant at the lower end of its interval (at a step
 * the part below holds). */
static inline void fast_seek_intervals8(const fast_transfer *transfer, __m256 s, __m256 lanes, fast_interval8 *in) {
  if (transfer->is_small) {
    __m256i found = _mm256_setzero_si256(); /* a comparison that holds is -1 */
    for (uint32_t k = 1; k < transfer->interval_count; k++) {
      const __m256 above = _mm256_cmp_ps(s, _mm256_broadcast_ss(&transfer->small[0][k]), _CMP_GT_OQ);
      found = _mm256_sub_epi32(found, _mm256_castps_si256(above));
    }
    in->index = _mm256_blendv_epi8(in->index, found, _mm256_castps_si256(lanes));
  } else {
    float place[8];
    uint32_t index[8];
    _mm256_storeu_ps(place, s);
    _mm256_storeu_si256((__m256i *)index, in->index);
    const int mask = _mm256_movemask_ps(lanes);
    for (int i = 0; i < 8; i++)
      if (mask >> i & 1) index[i] = fast_find_interval(transfer, place[i]);
    in->index = _mm256_loadu_si256((const __m256i *)index);
  }
  fast_load_intervals8(transfer, in);
}

/* fast_add_segment, for the lanes of the mask; `from` must lie in each lane's interval. The intervals follow.
 * pieces: counts them. seen: NULL, or the parts of the segment where its contribution begins and ends (2 and -1 where
 * there is none). */
static inline void fast_add_segment8(const fast_transfer *transfer, fast_interval8 *in, __m256 from, __m256 to,
                                     __m256 length, __m256 lanes, fast_light8 *light, __m256i *pieces, __m256 seen[2]) {
  const __m256 opaque = _mm256_set1_ps(transfer->opaque);
  const __m256 whole = length;
  length = _mm256_and_ps(length, lanes);
  const __m256 at_step = _mm256_and_ps(
      _mm256_and_ps(_mm256_cmp_ps(from, to, _CMP_EQ_OQ), _mm256_cmp_ps(from, in->low, _CMP_LE_OQ)), lanes);
  if (fast_any(at_step)) fast_seek_intervals8(transfer, from, at_step, in);
  const __m256i step = _mm256_set1_epi32(1);
  for (bool is_first = true;; is_first = false) {
    const __m256 above = _mm256_cmp_ps(to, in->high, _CMP_GT_OQ), below = _mm256_cmp_ps(to, in->low, _CMP_LT_OQ);
    const __m256 beyond = _mm256_and_ps(_mm256_or_ps(above, below), lanes);
    const bool is_last = !fast_any(beyond);
    *pieces = _mm256_sub_epi32(*pieces, _mm256_castps_si256(lanes));
    const __m256 before = light->transmittance;
    __m256 end = to, part = length;
    if (!is_last) {
      end = fast_select(beyond, _mm256_min_ps(_mm256_max_ps(to, in->low), in->high), to);
      const __m256 share = _mm256_div_ps(_mm256_sub_ps(end, from), _mm256_sub_ps(to, from));
      part = fast_select(beyond, _mm256_mul_ps(length, share), length);
    }
    fast_add_interval8(in, from, end, part, opaque, light);
    if (seen != NULL) {
      const __m256 gained = _mm256_cmp_ps(light->transmittance, before, _CMP_LT_OQ), one = _mm256_set1_ps(1);
      const __m256 begin = is_first ? _mm256_setzero_ps() : _mm256_sub_ps(one, _mm256_div_ps(length, whole));
      const __m256 finish = is_last ? one : _mm256_sub_ps(one, _mm256_div_ps(_mm256_sub_ps(length, part), whole));
      seen[0] = fast_select(gained, _mm256_min_ps(seen[0], begin), seen[0]);
      seen[1] = fast_select(gained, finish, seen[1]);
    }
    if (is_last) return;
    lanes = _mm256_and_ps(beyond, _mm256_cmp_ps(light->transmittance, opaque, _CMP_GE_OQ));
    if (!fast_any(lanes)) return;
    const __m256i up = _mm256_and_si256(_mm256_castps_si256(_mm256_and_ps(above, lanes)), step);
    const __m256i down = _mm256_and_si256(_mm256_castps_si256(_mm256_and_ps(below, lanes)), step);
    in->index = _mm256_sub_epi32(_mm256_add_epi32(in->index, up), down);
    fast_load_intervals8(transfer, in);
    from = fast_select(lanes, end, from);
    length = _mm256_and_ps(_mm256_sub_ps(length, part), lanes);
    to = fast_select(lanes, to, from);
  }
}

#endif
