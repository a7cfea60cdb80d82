/* SPDX-License-Identifier: BSD-3-Clause
 * Pieces: from segments in cells to parts within one interval of the transfer function each, and from these to light.
 * Included by each kernel.
 *
 * Pieces are packed: a segment without a knot is one of them, and one that crosses a knot makes no other wait. On each
 * pixel they stay in the order of their segments. */
#ifndef CELLIST_SOFT_PIECES_H
#define CELLIST_SOFT_PIECES_H

#include <optics/fast_lanes.h>

#include "scene.h"

/* Eight fragments. */
typedef struct segment8 {
  f8 from, to, length, near_depth, far_depth;
  i8 pixel, cell;
} segment8;

/* Adds eight pieces to what their pixels have gathered. rows: colour and minus the opacity of each. */
static inline void blend_rows(soft_worker *worker, float rows[8][4], const int32_t *pixel, int count) {
  for (int i = 0; i < count; i++) {
    float *to = worker->pixels[pixel[i]];
    f4_store(to, f4_add_scaled(f4_load(to), f4_load(rows[i]), to[3]));
  }
}

static inline void blend_depths(soft_worker *worker, const soft_pieces *pieces, size_t first, f8 gained, int count) {
  float gain[8];
  f8_store(gain, gained);
  for (int i = 0; i < count; i++) {
    if (!(gain[i] > 0)) continue;
    const int32_t pixel = pieces->pixel[first + (size_t)i];
    const float begin = pieces->depth[0][first + (size_t)i], end = pieces->depth[1][first + (size_t)i];
    worker->z[pixel] = begin < worker->z[pixel] ? begin : worker->z[pixel];
    worker->z_back[pixel] = end > worker->z_back[pixel] ? end : worker->z_back[pixel];
  }
}

static inline void shade_eight(const soft_scene *scene, soft_worker *worker, size_t first, int count) {
  soft_pieces *pieces = worker->pieces;
  const f8 from = f8_load(pieces->from + first), to = f8_load(pieces->to + first);
  const f8 length = f8_load(pieces->length + first);
  const fast_band8 band = fast_band8_at(scene->transfer, i8_load(pieces->interval + first));
  const fast_gain8 gain = fast_gain8_of(scene->transfer, &band, from, to, length);
  float rows[8][4];
  f8_to_rows(gain.colour[0], gain.colour[1], gain.colour[2], f8_sub(f8_all(0), gain.alpha), rows);
  blend_rows(worker, rows, pieces->pixel + first, count);
  if (scene->wants_depth) blend_depths(worker, pieces, first, gain.alpha, count);
}

/* Shades all pieces, or all but the last few that do not fill a vector. */
static void shade_pieces(const soft_scene *scene, soft_worker *worker, bool all) {
  soft_pieces *pieces = worker->pieces;
  size_t first = 0;
  for (; first + 8 <= pieces->count; first += 8) shade_eight(scene, worker, first, 8);
  const size_t left = pieces->count - first;
  if (all && left > 0) {
    for (size_t i = pieces->count; i < first + 8; i++) { /* what fills up the vector must be numbers */
      pieces->from[i] = pieces->to[i] = pieces->length[i] = 0;
      pieces->interval[i] = 0;
    }
    shade_eight(scene, worker, first, (int)left);
  }
  pieces->count = all ? 0 : left;
  for (size_t i = 0; i < pieces->count; i++) {
    pieces->from[i] = pieces->from[first + i];
    pieces->to[i] = pieces->to[first + i];
    pieces->length[i] = pieces->length[first + i];
    pieces->interval[i] = pieces->interval[first + i];
    pieces->pixel[i] = pieces->pixel[first + i];
    pieces->depth[0][i] = pieces->depth[0][first + i];
    pieces->depth[1][i] = pieces->depth[1][first + i];
  }
}

/* Appends a piece for each lane of the mask: between two shares, begin and end, of its segment. */
static inline void append_pieces(const soft_scene *scene, soft_worker *worker, const segment8 *segment, f8 from, f8 to,
                                 f8 begin, f8 end, i8 interval, unsigned lanes) {
  soft_pieces *pieces = worker->pieces;
  if (pieces->count + 8 > SOFT_PIECES) shade_pieces(scene, worker, false);
  const size_t at = pieces->count;
  const i8 packing = lanes_packing(lanes);
  f8_store_packed(pieces->from + at, from, packing);
  f8_store_packed(pieces->to + at, to, packing);
  f8_store_packed(pieces->length + at, f8_mul(segment->length, f8_sub(end, begin)), packing);
  i8_store_packed(pieces->interval + at, interval, packing);
  i8_store_packed(pieces->pixel + at, segment->pixel, packing);
  if (scene->wants_depth) {
    const f8 extent = f8_sub(segment->far_depth, segment->near_depth);
    f8_store_packed(pieces->depth[0] + at, f8_fma(begin, extent, segment->near_depth), packing);
    f8_store_packed(pieces->depth[1] + at, f8_fma(end, extent, segment->near_depth), packing);
  }
  pieces->count = at + (size_t)__builtin_popcount(lanes);
}

/* Cuts the segments of the mask where they cross knots, near pieces first. */
static void cut_segments(const soft_scene *scene, soft_worker *worker, const segment8 *segment, unsigned lanes) {
  const f8 zero = f8_all(0), one = f8_all(1), to = segment->to;
  const f8 rise = f8_sub(to, segment->from), inverse = f8_div(one, rise);
  i8 interval = fast_find8(scene->transfer, segment->from);
  f8 from = segment->from, begin = zero;
  for (;;) {
    f8 low, high;
    fast_span8(scene->transfer, interval, &low, &high);
    const m8 above = f8_greater(to, high), below = f8_greater(low, to);
    const unsigned beyond = m8_bits(m8_or(above, below)) & lanes;
    const f8 stop = f8_select(above, high, f8_select(below, low, to));
    /* A share of the rise from the segment's own front: no errors add up. */
    const f8 share = f8_min(f8_max(f8_mul(f8_sub(stop, segment->from), inverse), begin), one);
    const f8 end = f8_select(m8_or(above, below), share, one);
    append_pieces(scene, worker, segment, from, stop, begin, end, interval, lanes);
    if (beyond == 0) return;
    lanes = beyond;
    interval = i8_sub(i8_add(interval, m8_ones(above)), m8_ones(below));
    from = stop;
    begin = end;
  }
}

/* Whether two lanes are of the same pixel: then the pieces of one must not come between those of the other. */
static inline bool pixels_repeat(i8 pixel) {
  i8 turned = pixel;
  unsigned same = 0;
  for (int i = 0; i < 4; i++) {
    turned = i8_rotate(turned);
    same |= m8_bits(i8_equal(turned, pixel));
  }
  return same != 0;
}

static inline void add_segments(const soft_scene *scene, soft_worker *worker, const segment8 *segment, unsigned lanes) {
  const f8 middle = f8_mul(f8_all(0.5f), f8_add(segment->from, segment->to));
  const i8 interval = fast_find8(scene->transfer, middle);
  f8 low, high;
  fast_span8(scene->transfer, interval, &low, &high);
  const m8 crosses =
      m8_or(f8_greater(low, f8_min(segment->from, segment->to)), f8_greater(f8_max(segment->from, segment->to), high));
  if ((m8_bits(crosses) & lanes) == 0) {
    append_pieces(scene, worker, segment, segment->from, segment->to, f8_all(0), f8_all(1), interval, lanes);
  } else if (lanes != 255 || pixels_repeat(segment->pixel)) {
    for (unsigned i = 0; i < 8; i++)
      if (lanes >> i & 1) cut_segments(scene, worker, segment, 1u << i);
  } else {
    cut_segments(scene, worker, segment, lanes);
  }
}

#endif
