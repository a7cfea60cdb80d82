/* SPDX-License-Identifier: BSD-3-Clause
 * Kernel of pre-integration: all pairs of nodes that lie `step` nodes apart, for eight lengths at once. Private;
 * included by preintegration_avx2.c and preintegration_portable.c, which compile it for their processors. Both give
 * the same bits: nothing is fused.
 *
 * A table holds what a segment of length l from node i to node i + step gathers. It passes the nodes between at equal
 * distances l / step, so it is made of `step` elements, each from one node to the next, and what a segment gathers
 * follows from its parts by
 *   C = C1 + T1 C2,  T = T1 T2                                              [W 4]
 * with 1 the front part and 2 the rest; likewise the moments that light needs. [W] takes the parts from slices of
 * shorter segments and must interpolate between nodes, whose errors add up over the slices, and slices uniform in l'
 * are no multiples of one length. Split at nodes, for one length at a time, there is nothing to interpolate. And as the
 * composition is associative, the segments of all starting nodes are a sliding window over the elements, which takes
 * three compositions each however wide it is (van Herk 1992): suffixes within blocks of `step` elements, and a running
 * prefix of the next block. */
#ifndef CELLIST_PREINTEGRATION_KERNEL_H
#define CELLIST_PREINTEGRATION_KERNEL_H

#include <string.h>

#include "preintegration_private.h"

/* Vectors are passed inside this file only: the ABI between files does not matter. */
#pragma GCC diagnostic ignored "-Wpsabi"

typedef float v8 __attribute__((vector_size(32)));

static inline v8 load(const float *p) {
  v8 r;
  memcpy(&r, p, sizeof r);
  return r;
}
static inline void store(float *p, v8 a) { memcpy(p, &a, sizeof a); }
static inline v8 all(float a) { return (v8){a, a, a, a, a, a, a, a}; }
static inline float largest_of(v8 a) {
  float most = a[0];
  for (int i = 1; i < 8; i++) most = a[i] > most ? a[i] : most;
  return most;
}
static inline v8 at_least(v8 a, float low) {
  for (int i = 0; i < 8; i++) a[i] = a[i] > low ? a[i] : low;
  return a;
}
static inline v8 at_most(v8 a, float high) {
  for (int i = 0; i < 8; i++) a[i] = a[i] < high ? a[i] : high;
  return a;
}
static inline v8 root(v8 a) {
  for (int i = 0; i < 8; i++) a[i] = sqrtf(a[i]);
  return a;
}

/* What a stretch gathers; places are counted in nodes from its front end. */
struct gathered {
  v8 through;                    /* transmittance */
  v8 opacity, first, second;     /* integrals of what is emitted, times 1, place, place^2 */
  v8 colour[3], colour_first[3]; /* the same of colours, times 1, place */
};

enum { GATHERED_VECTORS = sizeof(struct gathered) / sizeof(v8) };

/* 1 - exp(-x) for 0 <= x <= 1, to 3e-9 relative: as in fast_optics.h. */
static inline v8 loss_of(v8 x) {
  v8 sum = all(1.291868673e-4f);
  sum = sum * x - 1.301107317e-3f;
  sum = sum * x + 8.275879696e-3f;
  sum = sum * x - 4.16470443e-2f;
  sum = sum * x + 0.166663449f;
  sum = sum * x - 0.4999998012f;
  sum = sum * x + 0.999999998f;
  return sum * x;
}

/* Gauss-Legendre on 0..1. Five points are good to 4e-7 of a piece that is 1 deep, three to 1e-7 of one 1/8 deep. */
static const float NODE3[3] = {0.112701665379f, 0.5f, 0.887298334621f};
static const float WEIGHT3[3] = {0.277777777778f, 0.444444444444f, 0.277777777778f};
static const float NODE5[5] = {0.0469100770307f, 0.230765344947f, 0.5f, 0.769234655053f, 0.953089922969f};
static const float WEIGHT5[5] = {0.118463442528f, 0.239314335250f, 0.284444444444f, 0.239314335250f, 0.118463442528f};
static const float SHALLOW = 0.125f;

/* Adds a panel, at most 1 deep, of optical depth a if its front end's extinction held along it and b with its back
 * end's, from place on for a width; colours are linear on it. */
static inline void add_panel(struct gathered *sum, bool lit, v8 a, v8 b, v8 place, v8 width, const v8 from[3],
                             const v8 to[3], bool shallow) {
  const float *node = shallow ? NODE3 : NODE5, *weight = shallow ? WEIGHT3 : WEIGHT5;
  const int count = shallow ? 3 : 5;
  const v8 rise = b - a, half_rise = 0.5f * rise;
  v8 m0 = all(0), m1 = all(0), m2 = all(0);
  for (int i = 0; i < count; i++) {
    const v8 emitted = (a + rise * node[i]) * weight[i] * (1.0f - loss_of((a + half_rise * node[i]) * node[i]));
    m0 += emitted;
    m1 += emitted * node[i];
    m2 += emitted * (node[i] * node[i]);
  }
  const v8 through = sum->through;
  m0 *= through;
  m1 *= through;
  m2 *= through;
  sum->opacity += m0;
  for (int k = 0; k < 3; k++) sum->colour[k] += from[k] * m0 + (to[k] - from[k]) * m1;
  if (lit) {
    const v8 p1 = place * m0 + width * m1, p2 = place * m1 + width * m2;
    sum->first += p1;
    sum->second += place * p1 + width * p2;
    for (int k = 0; k < 3; k++) sum->colour_first[k] += from[k] * p1 + (to[k] - from[k]) * p2;
  }
  sum->through = through * (1.0f - loss_of(0.5f * (a + b)));
}

/* Beyond this depth nothing is left to see: exp(-20) = 2e-9. */
static const float OPAQUE_DEPTH = 20;

/* A piece of any depth: panels of equal depth. */
static inline void add_deep_piece(struct gathered *sum, bool lit, v8 a, v8 b, const preintegration_piece *piece) {
  const v8 depth = 0.5f * (a + b), seen = at_most(depth, OPAQUE_DEPTH);
  const float panels = ceilf(largest_of(seen));
  v8 begin = all(0), from[3];
  for (int k = 0; k < 3; k++) from[k] = all(piece->colour[0][k]);
  for (float panel = 1; panel <= panels; panel++) {
    /* Where the depth is y: the root of (b - a) w^2 / 2 + a w = y, written without cancellation. */
    const v8 y = seen * (panel / panels);
    v8 end = (2.0f * y) / at_least(a + root(at_least(a * a + 2.0f * (b - a) * y, 0)), 1e-30f);
    for (int i = 0; i < 8; i++) end[i] = end[i] < 1 && !(panel == panels && depth[i] <= OPAQUE_DEPTH) ? end[i] : 1;
    const v8 part = end - begin;
    v8 to[3];
    for (int k = 0; k < 3; k++) to[k] = piece->colour[0][k] + (piece->colour[1][k] - piece->colour[0][k]) * end;
    /* Rounding may push a panel a little beyond the depth that the rules hold for. */
    add_panel(sum, lit, at_most((a + (b - a) * begin) * part, 2), at_most((a + (b - a) * end) * part, 2),
              piece->place + piece->width * begin, piece->width * part, from, to, false);
    begin = end;
    for (int k = 0; k < 3; k++) from[k] = to[k];
  }
  for (int i = 0; i < 8; i++)
    if (depth[i] > OPAQUE_DEPTH) sum->through[i] = 0;
}

/* From one node to the next; length: of the element, in length units. */
static inline struct gathered gather_element(const preintegration_piece *pieces, size_t count, bool lit, v8 length) {
  struct gathered sum = {.through = all(1)};
  for (size_t i = 0; i < count; i++) {
    const preintegration_piece *piece = &pieces[i];
    const v8 a = piece->extinction[0] * piece->width * length, b = piece->extinction[1] * piece->width * length;
    const float depth = largest_of(0.5f * (a + b));
    if (depth > 1) {
      add_deep_piece(&sum, lit, a, b, piece);
      continue;
    }
    v8 from[3], to[3];
    for (int k = 0; k < 3; k++) {
      from[k] = all(piece->colour[0][k]);
      to[k] = all(piece->colour[1][k]);
    }
    add_panel(&sum, lit, a, b, all(piece->place), all(piece->width), from, to, depth <= SHALLOW);
  }
  return sum;
}

/* front reaches over `nodes` nodes, and back begins there. */
static inline void compose(struct gathered *out, const struct gathered *front, float nodes, const struct gathered *back,
                           bool lit) {
  const v8 through = front->through;
  struct gathered made;
  made.through = through * back->through;
  made.opacity = front->opacity + through * back->opacity;
  for (int k = 0; k < 3; k++) made.colour[k] = front->colour[k] + through * back->colour[k];
  if (lit) {
    const v8 moved = back->first + nodes * back->opacity;
    made.first = front->first + through * moved;
    made.second = front->second + through * (back->second + nodes * (back->first + moved));
    for (int k = 0; k < 3; k++)
      made.colour_first[k] = front->colour_first[k] + through * (back->colour_first[k] + nodes * back->colour[k]);
  }
  *out = made;
}

/* Eight entries of four floats. */
static inline void store_entries(float *out, v8 a, v8 b, v8 c, v8 d, unsigned count) {
  const v8 ab_low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const v8 ab_high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const v8 cd_low = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const v8 cd_high = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  const v8 row[4] = {__builtin_shufflevector(ab_low, cd_low, 0, 1, 8, 9, 2, 3, 10, 11),
                     __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 2, 3, 10, 11),
                     __builtin_shufflevector(ab_low, cd_low, 4, 5, 12, 13, 6, 7, 14, 15),
                     __builtin_shufflevector(ab_high, cd_high, 4, 5, 12, 13, 6, 7, 14, 15)};
  if (count == 8) {
    memcpy(out, row, sizeof row);
  } else {
    memcpy(out, row, 4 * sizeof(float) * count);
  }
}

/* A segment that starts at node `start` of the job's direction, with `count` of the eight lengths wanted. */
static inline void store_segment(const preintegration_job *job, uint32_t start, uint32_t step, uint32_t first_length,
                                 unsigned count, const struct gathered *sum) {
  const uint32_t n = job->scalar_count, last = n - 1;
  const uint32_t front = job->descending ? last - start : start;
  const uint32_t back = job->descending ? last - start - step : start + step;
  const size_t at = 4 * (((size_t)back * n + front) * job->length_count + first_length);
  const v8 share = 1.0f / sum->opacity;
  v8 colour[3];
  for (int k = 0; k < 3; k++) colour[k] = sum->colour[k] * share;
  const double density = job->depths[start + step] - job->depths[start];
  store_entries(job->ambient + at, colour[0], colour[1], colour[2], all((float)(density / step)), count);
  if (job->front == NULL) return;
  const v8 per_node = share * (1.0f / (float)step);
  v8 to_back[3], to_front[3];
  for (int k = 0; k < 3; k++) {
    to_back[k] = sum->colour_first[k] * per_node;
    to_front[k] = colour[k] - to_back[k];
  }
  const v8 centre = sum->first * per_node;
  const v8 variance = sum->second * per_node * (1.0f / (float)step) - centre * centre;
  store_entries(job->front + at, to_front[0], to_front[1], to_front[2], centre, count);
  store_entries(job->back + at, to_back[0], to_back[1], to_back[2], root(at_least(variance, 0)), count);
}

/* Fills all entries whose back lies `step` nodes beyond their front in the job's direction, but those of infinite
 * length. scratch: [scalar_count] of PREINTEGRATION_SCRATCH floats. */
static inline void fill_step(const preintegration_job *job, uint32_t step, float *scratch) {
  struct gathered *elements = (struct gathered *)(void *)scratch;
  const uint32_t element_count = job->scalar_count - 1, start_count = job->scalar_count - step;
  const uint32_t finite = job->length_count - 1;
  const bool lit = job->front != NULL;
  for (uint32_t length = 0; length < finite; length += 8) {
    const unsigned count = finite - length < 8 ? finite - length : 8;
    const v8 lengths = load(&job->lengths[length]) * (1.0f / (float)step);
    for (uint32_t i = 0; i < element_count; i++)
      elements[i] = gather_element(&job->pieces[job->piece_begin[i]], job->piece_begin[i + 1] - job->piece_begin[i],
                                   lit, lengths);
    for (uint32_t block = 0; block < start_count; block += step) {
      for (uint32_t i = block + step - 1; i-- > block;) compose(&elements[i], &elements[i], 1, &elements[i + 1], lit);
      store_segment(job, block, step, length, count, &elements[block]);
      struct gathered prefix;
      for (uint32_t i = block + 1; i < block + step && i < start_count; i++) {
        const uint32_t reached = i - block - 1; /* nodes that the prefix reaches over so far */
        if (reached == 0)
          prefix = elements[block + step];
        else
          compose(&prefix, &prefix, (float)reached, &elements[i + step - 1], lit);
        struct gathered whole;
        compose(&whole, &elements[i], (float)(block + step - i), &prefix, lit);
        store_segment(job, i, step, length, count, &whole);
      }
    }
  }
}

#endif
