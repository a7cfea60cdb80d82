/* SPDX-License-Identifier: BSD-3-Clause
 * Fast optics: emission and absorption along segments of linear scalar, in single precision, for renderers that shade
 * hundreds of millions of segments. Private to project/; fast_optics_avx2.h does the same for eight segments at once.
 *
 * A segment is split where the scalar crosses a knot of the transfer function. On such a piece, extinction and colour
 * are linear; with depth m = its optical depth and tilt g = (e_b - e_f) / (e_b + e_f), e the extinctions at its ends,
 *   alpha = 1 - exp(-m),  colour = alpha c(s'),  s' = s_b + q(m, g) (s_f - s_b):
 * the piece shines with the colour at one scalar between its ends (q = (1 - psi) / alpha; psi as in Moreland and Angel,
 * "A fast high accuracy volume renderer for unstructured data", 2004). q is smooth, between 1/3 and 2/3 for m = 0, and
 * for m <= 1 a polynomial of 22 terms (a truncated Chebyshev series) is exact to 4e-7: neither erfcx nor Dawson's
 * function, no table, no cancellation. A deeper piece is cut where its depth reaches 1; as little is left to see behind
 * a dozen such cuts, that costs less than a second formula would. Only the loop of deep pieces takes a square root. */
#ifndef CELLIST_FAST_OPTICS_H
#define CELLIST_FAST_OPTICS_H

#include <cellist/transfer.h>
#include <math.h>

/* Depth of the deepest piece that the polynomials hold for. They are wrong beyond. */
#define FAST_DEPTH 1.0f

/* A ray ends where its transmittance falls below this: the most by which a value of the picture can be too small
 * (times the largest colour, if that is above 1). Larger: a visible error; smaller: more cells walked in vain. */
#define FAST_OPAQUE 7.62939453125e-6f

/* Extinctions are cut off here (per length unit), so that squares of depths stay finite: opaque in either case. */
#define FAST_EXTINCTION_LIMIT 1e12

/* q(m, g) = sum of FAST_Q[i][j] m^i g^j and alpha(m) = m * sum of FAST_ALPHA[i] m^i; errors 3.3e-7 and 3e-9 relative,
 * over 0 <= m <= FAST_DEPTH, -1 <= g <= 1. */
static const float FAST_Q[5][5] = {
    {0.499999979f, -0.166666504f, 1.64857081e-07f, -2.09967608e-07f, -3.05916484e-08f},
    {0.0833329599f, -5.34416798e-06f, -0.0166716289f, 6.77882812e-06f, 9.20873862e-07f},
    {1.07770666e-05f, 0.00280549567f, 2.21572494e-05f, -0.00122482211f, -4.11229516e-06f},
    {-0.00143525712f, -4.70285865e-05f, 0.000370050288f, 5.6167833e-05f, -6.11674873e-05f},
    {6.81119799e-05f, -3.89758939e-05f, 0, 0, 0}};
static const float FAST_ALPHA[7] = {0.999999998f,    -0.4999998012f,   0.166663449f,    -0.0416470443f,
                                    0.008275879696f, -0.001301107317f, 0.0001291868673f};

/* The transfer function between two knots: at scalar s, extinction + extinction_slope (s - low), colour likewise.
 * Two loads of eight floats; the second half starts with the colour slopes of green and blue. */
typedef struct fast_interval {
  float low, high;
  float extinction, extinction_slope;
  float colour[3], colour_slope[3];
  float unused[6];
} fast_interval;

/* Starting points of the search for an interval, one per 1/1024 of the scalar's range. */
enum { FAST_BUCKET_COUNT = 1024 };

/* Up to FAST_SMALL intervals are also kept field by field, to be looked up in a register. Fields as in fast_interval.
 */
enum { FAST_SMALL = 8, FAST_FIELDS = 10 };

/* A transfer function over scalars scaled to 0..1. The intervals cover -infinity to infinity without gaps; knots far
 * outside 0..1 are left out, and intervals too narrow for single precision. */
typedef struct fast_transfer {
  double scalar_low, scalar_half_range;              /* scaled = (s/2 - scalar_low/2) / scalar_half_range */
  uint32_t interval_count;                           /* at least 1 */
  fast_interval *intervals;                          /* [interval_count] ascending; from the context's allocator */
  float opaque;                                      /* transmittance at which a ray may end */
  uint32_t bucket[FAST_BUCKET_COUNT];                /* interval that holds the scalar i/1024 */
  bool is_small;                                     /* at most FAST_SMALL intervals: */
  _Alignas(32) float small[FAST_FIELDS][FAST_SMALL]; /* low is infinite beyond the last */
} fast_transfer;

/* Makes the table for scalars from minimum to maximum (finite, minimum <= maximum).
 * length_unit: world length that counts as 1 in what the functions below take, above 0. has_colour: false makes all
 * colours black (absorption only). Errors: OUT_OF_MEMORY. Cost: linear in knots. */
CELLIST_API cellist_result fast_transfer_create(cellist_context *context, const cellist_transfer *transfer,
                                                double minimum, double maximum, double length_unit, bool has_colour,
                                                fast_transfer *made);
CELLIST_API void fast_transfer_release(cellist_context *context, fast_transfer *transfer);

/* The largest extinction of scalars from minimum to maximum. */
CELLIST_API double fast_transfer_peak(const cellist_transfer *transfer, double minimum, double maximum);

/* A scalar as the table takes it, with all its digits; NaN for one that is not finite. */
static inline double fast_scalar_exact(const fast_transfer *transfer, double scalar) {
  if (!isfinite(scalar)) return NAN;
  return (0.5 * scalar - 0.5 * transfer->scalar_low) / transfer->scalar_half_range;
}

static inline float fast_scalar(const fast_transfer *transfer, double scalar) {
  return (float)fast_scalar_exact(transfer, scalar);
}

/* What a ray has gathered so far, front to back: premultiplied colour, what is left of the light behind, and 1 - that
 * with its own digits, however thin the medium. */
typedef struct fast_light {
  float colour[3];
  float transmittance, alpha;
} fast_light;

/* Which interval holds s; at a step of the transfer function the one below it. */
static inline uint32_t fast_find_interval(const fast_transfer *transfer, float s) {
  const float place = s * FAST_BUCKET_COUNT;
  uint32_t k = transfer->bucket[place > 0 ? (place < FAST_BUCKET_COUNT - 1 ? (int)place : FAST_BUCKET_COUNT - 1) : 0];
  while (k > 0 && s <= transfer->intervals[k].low) k--;
  while (k + 1 < transfer->interval_count && s > transfer->intervals[k].high) k++;
  return k;
}

static inline float fast_q(float m, float g) {
  float q = 0;
  for (int i = 4; i >= 0; i--) {
    float row = 0;
    for (int j = 4; j >= 0; j--) row = row * g + FAST_Q[i][j];
    q = q * m + row;
  }
  return q;
}

static inline float fast_alpha(float m) {
  float sum = 0;
  for (int i = 6; i >= 0; i--) sum = sum * m + FAST_ALPHA[i];
  return sum * m;
}

/* Adds a piece of depths a and b (extinction at either end times length) with (a + b) / 2 <= FAST_DEPTH. */
static inline void fast_add_piece(const fast_interval *interval, float from, float to, float a, float b,
                                  fast_light *light) {
  const float sum = a + b;
  const float share = fast_alpha(0.5f * sum) * light->transmittance;
  const float q = fast_q(0.5f * sum, (b - a) / fmaxf(sum, 1e-30f));
  const float at = to + q * (from - to) - interval->low;
  for (int k = 0; k < 3; k++) light->colour[k] += share * (interval->colour[k] + interval->colour_slope[k] * at);
  light->transmittance -= share;
  light->alpha += share;
}

/* Adds a piece within one interval; length is in length units. */
static inline void fast_add_interval(const fast_transfer *transfer, const fast_interval *interval, float from, float to,
                                     float length, fast_light *light) {
  float a = fmaxf(interval->extinction + interval->extinction_slope * (from - interval->low), 0) * length;
  float b = fmaxf(interval->extinction + interval->extinction_slope * (to - interval->low), 0) * length;
  while (a + b > 2 * FAST_DEPTH) {
    /* Where the depth reaches FAST_DEPTH: the root of a w + (b - a) w^2 / 2, in its stable form. */
    const float w = 2 * FAST_DEPTH / (a + sqrtf(fmaxf(a * a + 2 * FAST_DEPTH * (b - a), 0)));
    const float middle = from + w * (to - from), there = a + w * (b - a);
    fast_add_piece(interval, from, middle, a * w, there * w, light);
    if (light->transmittance < transfer->opaque) return;
    from = middle;
    a = there * (1 - w);
    b *= 1 - w;
  }
  fast_add_piece(interval, from, to, a, b, light);
}

/* Adds a segment of that length on which the scalar goes from `from` to `to`. interval: holds `from`; the result holds
 * `to`. piece_count: counts the pieces. Ends early where light->transmittance falls below transfer->opaque; the caller
 * then ends the ray. seen: NULL, or set to the parts of the segment (0..1) where its first contribution begins and its
 * last one ends; left alone if there is none. */
static inline uint32_t fast_add_segment(const fast_transfer *transfer, uint32_t interval, float from, float to,
                                        float length, fast_light *light, uint32_t *piece_count, float seen[2]) {
  /* A constant scalar at a step belongs to what lies below it, wherever the ray came from. */
  if (from == to)
    while (interval > 0 && from <= transfer->intervals[interval].low) interval--;
  const float whole = length;
  bool is_first = true;
  for (;;) {
    const fast_interval *in = &transfer->intervals[interval];
    const float end = fminf(fmaxf(to, in->low), in->high);
    const float part = end == to ? length : length * ((end - from) / (to - from));
    const float before = light->transmittance;
    fast_add_interval(transfer, in, from, end, part, light);
    ++*piece_count;
    if (seen != NULL && light->transmittance < before) {
      if (is_first) seen[0] = 1 - length / whole;
      seen[1] = 1 - (length - part) / whole;
      is_first = false;
    }
    if (end == to || light->transmittance < transfer->opaque) return interval;
    interval = to > in->high ? interval + 1 : interval - 1;
    from = end;
    length -= part;
  }
}

#endif
