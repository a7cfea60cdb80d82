/* SPDX-License-Identifier: BSD-3-Clause
 * Lanes: eight floats, eight integers or four doubles that are worked on at once; with AVX2 one register each,
 * otherwise (or with LANES_PORTABLE) arrays. Every operation is the one of IEEE 754, so both give the same bits but for
 * f8_fma, which rounds once in registers and twice in arrays; minimum and maximum return the second operand where the
 * first is not smaller or larger, NaN included. */
#ifndef CELLIST_LANES_H
#define CELLIST_LANES_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "lanes_packing.h"

#if defined(__AVX2__) && !defined(LANES_PORTABLE)

#include <immintrin.h>

typedef __m256 f8;
typedef __m256 m8; /* a mask: all bits of a lane or none */
typedef __m256i i8;
typedef __m256d d4;
typedef __m128 f4;

static inline f8 f8_all(float a) { return _mm256_set1_ps(a); }
static inline f8 f8_load(const float *p) { return _mm256_loadu_ps(p); }
static inline void f8_store(float *p, f8 a) { _mm256_storeu_ps(p, a); }
static inline f8 f8_add(f8 a, f8 b) { return _mm256_add_ps(a, b); }
static inline f8 f8_sub(f8 a, f8 b) { return _mm256_sub_ps(a, b); }
static inline f8 f8_mul(f8 a, f8 b) { return _mm256_mul_ps(a, b); }
static inline f8 f8_div(f8 a, f8 b) { return _mm256_div_ps(a, b); }
static inline f8 f8_sqrt(f8 a) { return _mm256_sqrt_ps(a); }
static inline f8 f8_min(f8 a, f8 b) { return _mm256_min_ps(a, b); }
static inline f8 f8_max(f8 a, f8 b) { return _mm256_max_ps(a, b); }
static inline f8 f8_fma(f8 a, f8 b, f8 c) { return _mm256_fmadd_ps(a, b, c); } /* a b + c */
static inline f8 f8_abs(f8 a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
static inline m8 f8_greater(f8 a, f8 b) { return _mm256_cmp_ps(a, b, _CMP_GT_OQ); }
static inline f8 f8_select(m8 mask, f8 yes, f8 no) { return _mm256_blendv_ps(no, yes, mask); }
static inline m8 m8_and(m8 a, m8 b) { return _mm256_and_ps(a, b); }
static inline m8 m8_or(m8 a, m8 b) { return _mm256_or_ps(a, b); }
static inline unsigned m8_bits(m8 a) { return (unsigned)_mm256_movemask_ps(a); }
static inline m8 m8_from_bits(unsigned bits) {
  const __m256i each = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)bits), each), each));
}

static inline i8 i8_all(int32_t a) { return _mm256_set1_epi32(a); }
static inline i8 i8_load(const int32_t *p) { return _mm256_loadu_si256((const __m256i *)p); }
static inline void i8_store(int32_t *p, i8 a) { _mm256_storeu_si256((__m256i *)p, a); }
static inline i8 i8_add(i8 a, i8 b) { return _mm256_add_epi32(a, b); }
static inline i8 i8_and(i8 a, i8 b) { return _mm256_and_si256(a, b); }
static inline i8 i8_shift_right(i8 a, int count) { return _mm256_srli_epi32(a, count); }
static inline i8 i8_sub(i8 a, i8 b) { return _mm256_sub_epi32(a, b); }
static inline i8 i8_or(i8 a, i8 b) { return _mm256_or_si256(a, b); }
static inline i8 i8_min(i8 a, i8 b) { return _mm256_min_epi32(a, b); }
static inline i8 i8_max(i8 a, i8 b) { return _mm256_max_epi32(a, b); }
static inline i8 i8_shift_left(i8 a, int count) { return _mm256_slli_epi32(a, count); }
static inline m8 i8_equal(i8 a, i8 b) { return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b)); }
static inline i8 i8_rotate(i8 a) { /* lane i takes lane i + 1's value, the last one the first one's */
  return _mm256_permutevar8x32_epi32(a, _mm256_setr_epi32(1, 2, 3, 4, 5, 6, 7, 0));
}
static inline f8 i8_to_float(i8 a) { return _mm256_cvtepi32_ps(a); }
static inline i8 f8_truncate(f8 a) { return _mm256_cvttps_epi32(a); }
static inline i8 f8_as_bits(f8 a) { return _mm256_castps_si256(a); }
static inline f8 i8_as_float(i8 a) { return _mm256_castsi256_ps(a); }
static inline i8 m8_ones(m8 a) { return _mm256_srli_epi32(_mm256_castps_si256(a), 31); } /* 1 where it is set, else 0 */
/* table[index], index in 0..7; the table is aligned to 32 bytes. */
static inline f8 f8_lookup(const float table[8], i8 index) {
  return _mm256_permutevar8x32_ps(_mm256_load_ps(table), index);
}

/* How to store the lanes whose bit is set one after the other; up to 8 entries at p may be overwritten. */
static inline i8 lanes_packing(unsigned bits) {
  return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)LANES_PACKING[bits]));
}
static inline void f8_store_packed(float *p, f8 a, i8 packing) {
  _mm256_storeu_ps(p, _mm256_permutevar8x32_ps(a, packing));
}
static inline void i8_store_packed(int32_t *p, i8 a, i8 packing) {
  _mm256_storeu_si256((__m256i *)p, _mm256_permutevar8x32_epi32(a, packing));
}

/* out[j] lane i = row[i][j]: eight rows of eight floats become eight columns. */
static inline void f8_transpose(const float *const row[8], f8 out[8]) {
  f8 r[8], t[8];
  for (int i = 0; i < 4; i++) {
    r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row[i])), _mm_loadu_ps(row[i + 4]), 1);
    r[i + 4] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row[i] + 4)), _mm_loadu_ps(row[i + 4] + 4), 1);
  }
  for (int half = 0; half < 2; half++) {
    t[0] = _mm256_unpacklo_ps(r[4 * half], r[4 * half + 1]);
    t[1] = _mm256_unpackhi_ps(r[4 * half], r[4 * half + 1]);
    t[2] = _mm256_unpacklo_ps(r[4 * half + 2], r[4 * half + 3]);
    t[3] = _mm256_unpackhi_ps(r[4 * half + 2], r[4 * half + 3]);
    out[4 * half] = _mm256_shuffle_ps(t[0], t[2], 0x44);
    out[4 * half + 1] = _mm256_shuffle_ps(t[0], t[2], 0xee);
    out[4 * half + 2] = _mm256_shuffle_ps(t[1], t[3], 0x44);
    out[4 * half + 3] = _mm256_shuffle_ps(t[1], t[3], 0xee);
  }
}
/* out[i] = {sum[0..3], most[0], most[1], any, any} of lane i. */
static inline void f8_to_rows(const f8 sum[4], const f8 most[2], f8 out[8]) {
  const f8 ab = _mm256_unpacklo_ps(sum[0], sum[1]), ab2 = _mm256_unpackhi_ps(sum[0], sum[1]);
  const f8 cd = _mm256_unpacklo_ps(sum[2], sum[3]), cd2 = _mm256_unpackhi_ps(sum[2], sum[3]);
  const f8 ef = _mm256_unpacklo_ps(most[0], most[1]), ef2 = _mm256_unpackhi_ps(most[0], most[1]);
  const f8 low[4] = {_mm256_shuffle_ps(ab, cd, 0x44), _mm256_shuffle_ps(ab, cd, 0xee),
                     _mm256_shuffle_ps(ab2, cd2, 0x44), _mm256_shuffle_ps(ab2, cd2, 0xee)};
  const f8 high[4] = {ef, _mm256_shuffle_ps(ef, ef, 0xee), ef2, _mm256_shuffle_ps(ef2, ef2, 0xee)};
  for (int i = 0; i < 4; i++) {
    out[i] = _mm256_permute2f128_ps(low[i], high[i], 0x20);
    out[i + 4] = _mm256_permute2f128_ps(low[i], high[i], 0x31);
  }
}
/* The first four of a row are added to, times scale, the others grow to the row's. */
static inline f8 f8_gather(f8 gathered, f8 row, float scale) {
  const f8 sum = _mm256_fmadd_ps(row, _mm256_set1_ps(scale), gathered);
  return _mm256_blend_ps(sum, _mm256_max_ps(row, gathered), 0xf0);
}

/* a, b, c, d of lane i = row[i]: the other way round. */
static inline void f8_from_rows(float (*row)[4], f8 out[4]) {
  f8 r[4];
  for (int i = 0; i < 4; i++)
    r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row[i])), _mm_loadu_ps(row[i + 4]), 1);
  const f8 ab = _mm256_unpacklo_ps(r[0], r[1]), ab2 = _mm256_unpackhi_ps(r[0], r[1]);
  const f8 cd = _mm256_unpacklo_ps(r[2], r[3]), cd2 = _mm256_unpackhi_ps(r[2], r[3]);
  out[0] = _mm256_shuffle_ps(ab, cd, 0x44);
  out[1] = _mm256_shuffle_ps(ab, cd, 0xee);
  out[2] = _mm256_shuffle_ps(ab2, cd2, 0x44);
  out[3] = _mm256_shuffle_ps(ab2, cd2, 0xee);
}
/* out[j] lane i = row[i][j], j = 0..3. */
static inline void f8_transpose_half(const float *const row[8], f8 out[4]) {
  f8 r[4];
  for (int i = 0; i < 4; i++)
    r[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(row[i])), _mm_loadu_ps(row[i + 4]), 1);
  const f8 ab = _mm256_unpacklo_ps(r[0], r[1]), ab2 = _mm256_unpackhi_ps(r[0], r[1]);
  const f8 cd = _mm256_unpacklo_ps(r[2], r[3]), cd2 = _mm256_unpackhi_ps(r[2], r[3]);
  out[0] = _mm256_shuffle_ps(ab, cd, 0x44);
  out[1] = _mm256_shuffle_ps(ab, cd, 0xee);
  out[2] = _mm256_shuffle_ps(ab2, cd2, 0x44);
  out[3] = _mm256_shuffle_ps(ab2, cd2, 0xee);
}

static inline f4 f4_load(const float *p) { return _mm_loadu_ps(p); }
static inline void f4_store(float *p, f4 a) { _mm_storeu_ps(p, a); }
static inline f4 f4_max(f4 a, f4 b) { return _mm_max_ps(a, b); }

static inline d4 d4_all(double a) { return _mm256_set1_pd(a); }
static inline d4 d4_load(const double *p) { return _mm256_loadu_pd(p); }
static inline void d4_store(double *p, d4 a) { _mm256_storeu_pd(p, a); }
static inline void d4_store_float(float *p, d4 a) { _mm_storeu_ps(p, _mm256_cvtpd_ps(a)); }
/* Four doubles at a and four at b, less `from`, rounded once. */
static inline f8 f8_differences(const double *a, const double *b, double from) {
  const d4 low = _mm256_sub_pd(_mm256_loadu_pd(a), _mm256_set1_pd(from));
  const d4 high = _mm256_sub_pd(_mm256_loadu_pd(b), _mm256_set1_pd(from));
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)), _mm256_cvtpd_ps(high), 1);
}
static inline d4 d4_add(d4 a, d4 b) { return _mm256_add_pd(a, b); }
static inline d4 d4_sub(d4 a, d4 b) { return _mm256_sub_pd(a, b); }
static inline d4 d4_mul(d4 a, d4 b) { return _mm256_mul_pd(a, b); }
static inline d4 d4_div(d4 a, d4 b) { return _mm256_div_pd(a, b); }
static inline d4 d4_sqrt(d4 a) { return _mm256_sqrt_pd(a); }
static inline d4 d4_min(d4 a, d4 b) { return _mm256_min_pd(a, b); }
static inline d4 d4_max(d4 a, d4 b) { return _mm256_max_pd(a, b); }
static inline d4 d4_abs(d4 a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a); }
static inline d4 d4_less(d4 a, d4 b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); } /* for d4_select */
static inline d4 d4_select(d4 mask, d4 yes, d4 no) { return _mm256_blendv_pd(no, yes, mask); }
/* Four lanes' columns of floats become four rows, `stride` floats apart. */
static inline void d4_store_rows(float *p, int stride, const d4 column[4]) {
  f4 a = _mm256_cvtpd_ps(column[0]), b = _mm256_cvtpd_ps(column[1]);
  f4 c = _mm256_cvtpd_ps(column[2]), d = _mm256_cvtpd_ps(column[3]);
  _MM_TRANSPOSE4_PS(a, b, c, d);
  _mm_storeu_ps(p, a);
  _mm_storeu_ps(p + stride, b);
  _mm_storeu_ps(p + 2 * stride, c);
  _mm_storeu_ps(p + 3 * stride, d);
}
/* Bit i: a <= b in lane i; not where one is NaN. */
static inline unsigned d4_at_most(d4 a, d4 b) { return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LE_OQ)); }
static inline unsigned d4_greater(d4 a, d4 b) { return (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ)); }
/* out[j] lane i = row[i][j]. */
static inline void d4_transpose(const double *const row[4], d4 out[4]) {
  const d4 a = _mm256_loadu_pd(row[0]), b = _mm256_loadu_pd(row[1]);
  const d4 c = _mm256_loadu_pd(row[2]), d = _mm256_loadu_pd(row[3]);
  const d4 ab = _mm256_unpacklo_pd(a, b), ab2 = _mm256_unpackhi_pd(a, b);
  const d4 cd = _mm256_unpacklo_pd(c, d), cd2 = _mm256_unpackhi_pd(c, d);
  out[0] = _mm256_permute2f128_pd(ab, cd, 0x20);
  out[1] = _mm256_permute2f128_pd(ab2, cd2, 0x20);
  out[2] = _mm256_permute2f128_pd(ab, cd, 0x31);
  out[3] = _mm256_permute2f128_pd(ab2, cd2, 0x31);
}

#else

typedef struct f8 {
  float v[8];
} f8;
typedef struct m8 {
  uint32_t v[8]; /* 0 or 1 */
} m8;
typedef struct i8 {
  int32_t v[8];
} i8;
typedef struct d4 {
  double v[4];
} d4;
typedef struct f4 {
  float v[4];
} f4;

#define LANES_EACH(type, count, expression)                \
  type r;                                                  \
  for (int i = 0; i < (count); i++) r.v[i] = (expression); \
  return r

static inline f8 f8_all(float a) { LANES_EACH(f8, 8, a); }
static inline f8 f8_load(const float *p) { LANES_EACH(f8, 8, p[i]); }
static inline void f8_store(float *p, f8 a) {
  for (int i = 0; i < 8; i++) p[i] = a.v[i];
}
static inline f8 f8_add(f8 a, f8 b) { LANES_EACH(f8, 8, a.v[i] + b.v[i]); }
static inline f8 f8_sub(f8 a, f8 b) { LANES_EACH(f8, 8, a.v[i] - b.v[i]); }
static inline f8 f8_mul(f8 a, f8 b) { LANES_EACH(f8, 8, a.v[i] * b.v[i]); }
static inline f8 f8_div(f8 a, f8 b) { LANES_EACH(f8, 8, a.v[i] / b.v[i]); }
static inline f8 f8_sqrt(f8 a) { LANES_EACH(f8, 8, sqrtf(a.v[i])); }
static inline f8 f8_min(f8 a, f8 b) { LANES_EACH(f8, 8, a.v[i] < b.v[i] ? a.v[i] : b.v[i]); }
static inline f8 f8_max(f8 a, f8 b) { LANES_EACH(f8, 8, a.v[i] > b.v[i] ? a.v[i] : b.v[i]); }
static inline f8 f8_fma(f8 a, f8 b, f8 c) { LANES_EACH(f8, 8, a.v[i] * b.v[i] + c.v[i]); }
static inline f8 f8_abs(f8 a) { LANES_EACH(f8, 8, fabsf(a.v[i])); }
static inline m8 f8_greater(f8 a, f8 b) { LANES_EACH(m8, 8, a.v[i] > b.v[i]); }
static inline f8 f8_select(m8 mask, f8 yes, f8 no) { LANES_EACH(f8, 8, mask.v[i] ? yes.v[i] : no.v[i]); }
static inline m8 m8_and(m8 a, m8 b) { LANES_EACH(m8, 8, a.v[i] & b.v[i]); }
static inline m8 m8_or(m8 a, m8 b) { LANES_EACH(m8, 8, a.v[i] | b.v[i]); }
static inline unsigned m8_bits(m8 a) {
  unsigned bits = 0;
  for (int i = 0; i < 8; i++) bits |= a.v[i] << i;
  return bits;
}
static inline m8 m8_from_bits(unsigned bits) { LANES_EACH(m8, 8, bits >> i & 1); }

static inline i8 i8_all(int32_t a) { LANES_EACH(i8, 8, a); }
static inline i8 i8_load(const int32_t *p) { LANES_EACH(i8, 8, p[i]); }
static inline void i8_store(int32_t *p, i8 a) {
  for (int i = 0; i < 8; i++) p[i] = a.v[i];
}
static inline i8 i8_add(i8 a, i8 b) { LANES_EACH(i8, 8, a.v[i] + b.v[i]); }
static inline i8 i8_and(i8 a, i8 b) { LANES_EACH(i8, 8, a.v[i] & b.v[i]); }
static inline i8 i8_shift_right(i8 a, int count) { LANES_EACH(i8, 8, (int32_t)((uint32_t)a.v[i] >> count)); }
static inline i8 i8_sub(i8 a, i8 b) { LANES_EACH(i8, 8, a.v[i] - b.v[i]); }
static inline i8 i8_or(i8 a, i8 b) { LANES_EACH(i8, 8, a.v[i] | b.v[i]); }
static inline i8 i8_min(i8 a, i8 b) { LANES_EACH(i8, 8, a.v[i] < b.v[i] ? a.v[i] : b.v[i]); }
static inline i8 i8_max(i8 a, i8 b) { LANES_EACH(i8, 8, a.v[i] > b.v[i] ? a.v[i] : b.v[i]); }
static inline i8 i8_shift_left(i8 a, int count) { LANES_EACH(i8, 8, (int32_t)((uint32_t)a.v[i] << count)); }
static inline m8 i8_equal(i8 a, i8 b) { LANES_EACH(m8, 8, a.v[i] == b.v[i]); }
static inline i8 i8_rotate(i8 a) { LANES_EACH(i8, 8, a.v[(i + 1) % 8]); }
static inline f8 i8_to_float(i8 a) { LANES_EACH(f8, 8, (float)a.v[i]); }
/* As the instruction: what does not fit is the smallest integer. */
static inline int32_t lanes_truncate(float a) { return a > -2147483648.f && a < 2147483648.f ? (int32_t)a : INT32_MIN; }
static inline i8 f8_truncate(f8 a) { LANES_EACH(i8, 8, lanes_truncate(a.v[i])); }
static inline i8 f8_as_bits(f8 a) {
  i8 r;
  memcpy(&r, &a, sizeof r);
  return r;
}
static inline f8 i8_as_float(i8 a) {
  f8 r;
  memcpy(&r, &a, sizeof r);
  return r;
}
static inline i8 m8_ones(m8 a) { LANES_EACH(i8, 8, (int32_t)a.v[i]); }
static inline f8 f8_lookup(const float table[8], i8 index) { LANES_EACH(f8, 8, table[index.v[i]]); }

static inline i8 lanes_packing(unsigned bits) { LANES_EACH(i8, 8, LANES_PACKING[bits][i]); }
static inline void f8_store_packed(float *p, f8 a, i8 packing) {
  for (int i = 0; i < 8; i++) p[i] = a.v[packing.v[i]];
}
static inline void i8_store_packed(int32_t *p, i8 a, i8 packing) {
  for (int i = 0; i < 8; i++) p[i] = a.v[packing.v[i]];
}
static inline void f8_transpose(const float *const row[8], f8 out[8]) {
  for (int j = 0; j < 8; j++)
    for (int i = 0; i < 8; i++) out[j].v[i] = row[i][j];
}
static inline void f8_to_rows(const f8 sum[4], const f8 most[2], f8 out[8]) {
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 8; k++) out[i].v[k] = k < 4 ? sum[k].v[i] : most[k & 1].v[i];
}
static inline f8 f8_gather(f8 gathered, f8 row, float scale) {
  for (int k = 0; k < 8; k++)
    if (k < 4)
      gathered.v[k] += row.v[k] * scale;
    else
      gathered.v[k] = row.v[k] > gathered.v[k] ? row.v[k] : gathered.v[k];
  return gathered;
}
static inline void f8_from_rows(float (*row)[4], f8 out[4]) {
  for (int j = 0; j < 4; j++)
    for (int i = 0; i < 8; i++) out[j].v[i] = row[i][j];
}
static inline void f8_transpose_half(const float *const row[8], f8 out[4]) {
  for (int j = 0; j < 4; j++)
    for (int i = 0; i < 8; i++) out[j].v[i] = row[i][j];
}

static inline f4 f4_load(const float *p) { LANES_EACH(f4, 4, p[i]); }
static inline void f4_store(float *p, f4 a) {
  for (int i = 0; i < 4; i++) p[i] = a.v[i];
}
static inline f4 f4_max(f4 a, f4 b) { LANES_EACH(f4, 4, a.v[i] > b.v[i] ? a.v[i] : b.v[i]); }

static inline d4 d4_all(double a) { LANES_EACH(d4, 4, a); }
static inline d4 d4_load(const double *p) { LANES_EACH(d4, 4, p[i]); }
static inline void d4_store(double *p, d4 a) {
  for (int i = 0; i < 4; i++) p[i] = a.v[i];
}
static inline void d4_store_float(float *p, d4 a) {
  for (int i = 0; i < 4; i++) p[i] = (float)a.v[i];
}
static inline f8 f8_differences(const double *a, const double *b, double from) {
  LANES_EACH(f8, 8, (float)((i < 4 ? a[i] : b[i - 4]) - from));
}
static inline d4 d4_add(d4 a, d4 b) { LANES_EACH(d4, 4, a.v[i] + b.v[i]); }
static inline d4 d4_sub(d4 a, d4 b) { LANES_EACH(d4, 4, a.v[i] - b.v[i]); }
static inline d4 d4_mul(d4 a, d4 b) { LANES_EACH(d4, 4, a.v[i] * b.v[i]); }
static inline d4 d4_div(d4 a, d4 b) { LANES_EACH(d4, 4, a.v[i] / b.v[i]); }
static inline d4 d4_sqrt(d4 a) { LANES_EACH(d4, 4, sqrt(a.v[i])); }
static inline d4 d4_min(d4 a, d4 b) { LANES_EACH(d4, 4, a.v[i] < b.v[i] ? a.v[i] : b.v[i]); }
static inline d4 d4_max(d4 a, d4 b) { LANES_EACH(d4, 4, a.v[i] > b.v[i] ? a.v[i] : b.v[i]); }
static inline d4 d4_abs(d4 a) { LANES_EACH(d4, 4, fabs(a.v[i])); }
static inline d4 d4_less(d4 a, d4 b) { LANES_EACH(d4, 4, a.v[i] < b.v[i]); }
static inline d4 d4_select(d4 mask, d4 yes, d4 no) { LANES_EACH(d4, 4, mask.v[i] != 0 ? yes.v[i] : no.v[i]); }
static inline void d4_store_rows(float *p, int stride, const d4 column[4]) {
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) p[i * stride + j] = (float)column[j].v[i];
}
static inline unsigned d4_greater(d4 a, d4 b) {
  unsigned bits = 0;
  for (int i = 0; i < 4; i++) bits |= (unsigned)(a.v[i] > b.v[i]) << i;
  return bits;
}
static inline unsigned d4_at_most(d4 a, d4 b) {
  unsigned bits = 0;
  for (int i = 0; i < 4; i++) bits |= (unsigned)(a.v[i] <= b.v[i]) << i;
  return bits;
}
static inline void d4_transpose(const double *const row[4], d4 out[4]) {
  for (int j = 0; j < 4; j++)
    for (int i = 0; i < 4; i++) out[j].v[i] = row[i][j];
}

#endif
#endif
