/* SPDX-License-Identifier: BSD-3-Clause
 * Fast optics for eight pieces at once, each within one interval of the transfer function: fast_optics.h in lanes, for
 * renderers that cut segments at the knots beforehand and pack the pieces, so that no lane waits for another. Private
 * to project/. A lane's result depends on the other lanes only by rounding (thin pieces take a shorter series). */
#ifndef CELLIST_FAST_LANES_H
#define CELLIST_FAST_LANES_H

#include "fast_optics.h"
#include "lanes.h"

/* Eight intervals; fields as in fast_interval. */
typedef struct fast_band8 {
  f8 low, high, extinction, extinction_slope, colour[3], colour_slope[3];
} fast_band8;

/* The interval that holds each scalar, at a step the one below. */
static inline i8 fast_find8(const fast_transfer *transfer, f8 s) {
  if (transfer->is_small) {
    i8 index = i8_all(0);
    for (int k = 1; k < FAST_SMALL; k++) index = i8_add(index, m8_ones(f8_greater(s, f8_all(transfer->small[0][k]))));
    return index;
  }
  float place[8];
  int32_t index[8];
  f8_store(place, s);
  for (int i = 0; i < 8; i++) index[i] = (int32_t)fast_find_interval(transfer, place[i]);
  return i8_load(index);
}

/* The ends of intervals. */
static inline void fast_span8(const fast_transfer *transfer, i8 index, f8 *low, f8 *high) {
  if (transfer->is_small) {
    *low = f8_lookup(transfer->small[0], index);
    *high = f8_lookup(transfer->small[1], index);
    return;
  }
  int32_t place[8];
  const float *row[8];
  f8 field[4];
  i8_store(place, index);
  for (int i = 0; i < 8; i++) row[i] = &transfer->intervals[place[i]].low;
  f8_transpose_half(row, field);
  *low = field[0];
  *high = field[1];
}

static inline fast_band8 fast_band8_at(const fast_transfer *transfer, i8 index) {
  f8 field[12];
  if (transfer->is_small) {
    for (int k = 0; k < FAST_FIELDS; k++) field[k] = f8_lookup(transfer->small[k], index);
  } else {
    int32_t place[8];
    const float *row[8];
    i8_store(place, index);
    for (int i = 0; i < 8; i++) row[i] = &transfer->intervals[place[i]].low;
    f8_transpose(row, field);
    for (int i = 0; i < 8; i++) row[i] += 8;
    f8_transpose_half(row, field + 8);
  }
  return (fast_band8){
      field[0], field[1], field[2], field[3], {field[4], field[5], field[6]}, {field[7], field[8], field[9]}};
}

/* What eight pieces shine with by themselves: premultiplied colour and opacity; and how far from their back ends, as a
 * share of their lengths, lies the scalar that gives the colour. */
typedef struct fast_gain8 {
  f8 colour[3], alpha, place;
} fast_gain8;

/* Up to this depth the short series do: errors of q below 4e-6 and of alpha below 4e-8. */
#define FAST_THIN 0.125f

static inline f8 fast_lanes_q(f8 m, f8 g) {
  f8 q = f8_all(0);
  for (int i = 4; i >= 0; i--) {
    const int top = i == 4 ? 1 : 4; /* the last row has two terms */
    f8 row = f8_all(FAST_Q[i][top]);
    for (int j = top - 1; j >= 0; j--) row = f8_fma(row, g, f8_all(FAST_Q[i][j]));
    q = i == 4 ? row : f8_fma(q, m, row);
  }
  return q;
}

static inline f8 fast_lanes_alpha(f8 m) {
  f8 sum = f8_all(FAST_ALPHA[6]);
  for (int i = 5; i >= 0; i--) sum = f8_fma(sum, m, f8_all(FAST_ALPHA[i]));
  return f8_mul(sum, m);
}

/* The Taylor series of q in m, whose coefficients are polynomials in g; and of alpha / m. */
static inline f8 fast_thin_q(f8 m, f8 g) {
  const f8 square = f8_mul(g, g);
  const f8 second = f8_mul(g, f8_fma(square, f8_all(-1.f / 840), f8_all(1.f / 360)));
  const f8 first = f8_fma(square, f8_all(-1.f / 60), f8_all(1.f / 12));
  return f8_fma(m, f8_fma(m, second, first), f8_fma(g, f8_all(-1.f / 6), f8_all(0.5f)));
}
static inline f8 fast_thin_alpha(f8 m) {
  f8 sum = f8_fma(m, f8_all(1.f / 120), f8_all(-1.f / 24));
  sum = f8_fma(sum, m, f8_all(1.f / 6));
  sum = f8_fma(sum, m, f8_all(-0.5f));
  return f8_mul(m, f8_fma(sum, m, f8_all(1)));
}

/* Depths at the ends, extinction there times length, cannot be negative. */
static inline f8 fast_lanes_depth(const fast_band8 *band, f8 s, f8 length) {
  const f8 extinction = f8_fma(band->extinction_slope, f8_sub(s, band->low), band->extinction);
  return f8_mul(f8_max(extinction, f8_all(0)), length);
}

/* share: of the light, that the piece adds; at: the scalar that gives its colour. */
static inline void fast_lanes_add(const fast_band8 *band, f8 at, f8 share, f8 colour[3]) {
  const f8 above = f8_sub(at, band->low);
  for (int k = 0; k < 3; k++)
    colour[k] = f8_fma(share, f8_fma(band->colour_slope[k], above, band->colour[k]), colour[k]);
}

static inline f8 fast_lanes_tilt(f8 a, f8 b, f8 sum) { return f8_div(f8_sub(b, a), f8_max(sum, f8_all(1e-30f))); }

/* Pieces deeper than FAST_DEPTH are cut where they reach it, until none is. */
static inline fast_gain8 fast_deep_gain8(const fast_band8 *band, f8 from, f8 to, f8 a, f8 b, float opaque) {
  const f8 one = f8_all(1), zero = f8_all(0), limit = f8_all(2 * FAST_DEPTH), start = from;
  fast_gain8 gain = {{zero, zero, zero}, zero, zero};
  f8 left = one, centre = zero; /* transmittance; where the light comes from, times the light */
  for (bool is_deep = true; is_deep;) {
    const m8 deep = f8_greater(f8_add(a, b), limit);
    is_deep = m8_bits(deep) != 0;
    const f8 tilt = f8_sub(b, a);
    const f8 root = f8_div(limit, f8_add(a, f8_sqrt(f8_max(f8_fma(a, a, f8_mul(limit, tilt)), zero))));
    const f8 w = f8_select(deep, root, one);
    const f8 middle = f8_select(deep, f8_fma(w, f8_sub(to, from), from), to);
    const f8 there = f8_select(deep, f8_fma(w, tilt, a), b);
    const f8 near = f8_mul(a, w), far = f8_mul(there, w), sum = f8_add(near, far), m = f8_mul(f8_all(0.5f), sum);
    const f8 share = f8_mul(fast_lanes_alpha(m), left);
    const f8 at = f8_fma(fast_lanes_q(m, fast_lanes_tilt(near, far, sum)), f8_sub(from, middle), middle);
    fast_lanes_add(band, at, share, gain.colour);
    centre = f8_fma(share, f8_sub(to, at), centre);
    left = f8_sub(left, share);
    gain.alpha = f8_add(gain.alpha, share); /* 1 - left would be 0 in a faint lane beside deep ones */
    const f8 rest = f8_select(f8_greater(left, f8_all(opaque)), f8_sub(one, w), zero);
    from = middle;
    a = f8_mul(there, rest);
    b = f8_mul(b, rest);
  }
  gain.alpha = f8_min(gain.alpha, one);
  const f8 extent = f8_sub(to, start);
  const f8 place = f8_div(centre, f8_mul(f8_max(gain.alpha, f8_all(1e-30f)), extent));
  gain.place = f8_select(f8_greater(f8_abs(extent), zero), f8_min(f8_max(place, zero), one), f8_all(0.5f));
  return gain;
}

/* Emission and absorption. gain is filled field by field, here and below: a structure of registers that is returned
 * or chosen as a whole is copied through memory in pieces, which took a quarter of soft's shading. */
static inline void fast_gain8_of(const fast_transfer *transfer, const fast_band8 *band, f8 from, f8 to, f8 length,
                                 fast_gain8 *gain) {
  const f8 a = fast_lanes_depth(band, from, length), b = fast_lanes_depth(band, to, length), sum = f8_add(a, b);
  const m8 thick = f8_greater(sum, f8_all(2 * FAST_THIN));
  if (m8_bits(f8_greater(sum, f8_all(2 * FAST_DEPTH))) != 0) {
    const fast_gain8 deep = fast_deep_gain8(band, from, to, a, b, transfer->opaque);
    for (int k = 0; k < 3; k++) gain->colour[k] = deep.colour[k];
    gain->alpha = deep.alpha;
    gain->place = deep.place;
    return;
  }
  const f8 m = f8_mul(f8_all(0.5f), sum), g = fast_lanes_tilt(a, b, sum);
  f8 alpha, place;
  if (m8_bits(thick) != 0) {
    alpha = fast_lanes_alpha(m);
    place = fast_lanes_q(m, g);
  } else {
    alpha = fast_thin_alpha(m);
    place = fast_thin_q(m, g);
  }
  gain->alpha = alpha;
  gain->place = place;
  for (int k = 0; k < 3; k++) gain->colour[k] = f8_all(0);
  fast_lanes_add(band, f8_fma(place, f8_sub(from, to), to), alpha, gain->colour);
}

/* Emission that nothing absorbs: alpha is the integral of extinction, which light multiplies. The integral of the
 * product with a linear colour is that colour at the extinction's centre, exactly. */
static inline void fast_emission8_of(const fast_band8 *band, f8 from, f8 to, f8 length, fast_gain8 *gain) {
  const f8 a = fast_lanes_depth(band, from, length), b = fast_lanes_depth(band, to, length), sum = f8_add(a, b);
  gain->alpha = f8_mul(f8_all(0.5f), sum);
  gain->place = f8_fma(fast_lanes_tilt(a, b, sum), f8_all(-1.f / 6), f8_all(0.5f));
  for (int k = 0; k < 3; k++) gain->colour[k] = f8_all(0);
  fast_lanes_add(band, f8_fma(gain->place, f8_sub(from, to), to), gain->alpha, gain->colour);
}

/* x^n for 0 <= x <= 1 (a little more by rounding) and 1 <= n: the relative error is some n times 4e-7, for highlights.
 */
static inline f8 fast_power8(f8 x, float n) {
  const f8 one = f8_all(1), least = f8_all(1e-37f);
  const f8 clamped = f8_max(f8_min(x, one), least);
  const i8 bits = f8_as_bits(clamped);
  /* x = 2^exponent (1 + f), log2 by the series of atanh. */
  const i8 whole = i8_sub(i8_shift_right(i8_add(bits, i8_all(0x3f800000 - 0x3f3504f3)), 23), i8_all(127));
  const f8 mantissa = i8_as_float(i8_sub(bits, i8_shift_left(whole, 23)));
  const f8 r = f8_div(f8_sub(mantissa, one), f8_add(mantissa, one)), square = f8_mul(r, r);
  f8 series = f8_fma(square, f8_all(1.f / 9), f8_all(1.f / 7));
  series = f8_fma(series, square, f8_all(1.f / 5));
  series = f8_fma(series, square, f8_all(1.f / 3));
  series = f8_mul(f8_fma(series, square, one), r);
  const f8 log2 = f8_fma(series, f8_all(2.885390082f), i8_to_float(whole));
  /* 2^y, y <= 0: split into an integer and a fraction within half of it. */
  const f8 y = f8_max(f8_mul(log2, f8_all(n)), f8_all(-125));
  const i8 integer = f8_truncate(f8_sub(y, f8_all(0.5f)));
  const f8 t = f8_mul(f8_sub(y, i8_to_float(integer)), f8_all(0.6931471806f));
  f8 sum = f8_fma(t, f8_all(1.f / 720), f8_all(1.f / 120));
  sum = f8_fma(sum, t, f8_all(1.f / 24));
  sum = f8_fma(sum, t, f8_all(1.f / 6));
  sum = f8_fma(sum, t, f8_all(0.5f));
  sum = f8_fma(f8_fma(sum, t, one), t, one);
  return f8_mul(sum, i8_as_float(i8_shift_left(i8_add(integer, i8_all(127)), 23)));
}

#endif
