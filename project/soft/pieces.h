/* SPDX-License-Identifier: BSD-3-Clause
 * Pieces: from segments in cells to parts within one interval of the transfer function each, and from these to light.
 * Included by each kernel.
 *
 * Pieces are packed: a segment without a knot is one of them, and one that crosses a knot makes no other wait. On each
 * pixel they stay in the order of their segments. */
#ifndef CELLIST_SOFT_PIECES_H
#define CELLIST_SOFT_PIECES_H

#include "light.h"

/* Eight fragments. */
typedef struct segment8 {
  f8 from, to, length, near_depth, far_depth;
  i8 pixel;
  /* Light: share and shine of the cell, or the gradient's parts where the ray enters and where it leaves. */
  f8 light[6];
} segment8;

/* What pieces carry of it: the same, and for gradients at points also where the piece begins and ends, 0..1. */
static inline int attribute_count(const soft_scene *scene) {
  return scene->model.gradients == SOFT_NO_LIGHT ? 0 : scene->model.gradients == SOFT_CELL_GRADIENTS ? 2 : 8;
}

/* Adds eight pieces to what their pixels have gathered. light: colour and minus the opacity of each; in thin scenes the
 * opacity itself. depth: minus where it begins, and where it ends. */
static inline void blend_pieces(const soft_scene *scene, soft_worker *worker, const f8 light[4], const f8 depth[2],
                                const int32_t *pixel, int count) {
  f8 rows[8];
  f8_to_rows(light, depth, rows);
  soft_pixel *pixels = worker->pixels;
  if (scene->is_thin)
    for (int i = 0; i < count; i++) {
      float *to = pixels[pixel[i]].light;
      f8_store(to, f8_gather(f8_load(to), rows[i], 1 - to[3]));
    }
  else
    for (int i = 0; i < count; i++) {
      float *to = pixels[pixel[i]].light;
      f8_store(to, f8_gather(f8_load(to), rows[i], to[3]));
    }
}

/* Multiplies what pieces shine with by the light that falls on them, and adds highlights. */
static inline void light_eight(const soft_scene *scene, const soft_pieces *pieces, size_t first, fast_gain8 *gain) {
  f8 share = f8_load(pieces->attribute[0] + first), shine = f8_load(pieces->attribute[1] + first);
  if (scene->model.gradients == SOFT_POINT_GRADIENTS) {
    const f8 begin = f8_load(pieces->attribute[6] + first), end = f8_load(pieces->attribute[7] + first);
    const f8 at = f8_fma(gain->place, f8_sub(begin, end), end);
    f8 gradient[3];
    for (int k = 0; k < 3; k++) {
      const f8 near = f8_load(pieces->attribute[k] + first), far = f8_load(pieces->attribute[3 + k] + first);
      gradient[k] = f8_fma(at, f8_sub(far, near), near);
    }
    light_gradients8(&scene->model, gradient, false, &share, &shine);
  }
  for (int k = 0; k < 3; k++) gain->colour[k] = f8_fma(gain->alpha, shine, f8_mul(gain->colour[k], share));
}

static inline void shade_eight(const soft_scene *scene, soft_worker *worker, size_t first, int count) {
  soft_pieces *pieces = worker->pieces;
  const f8 from = f8_load(pieces->from + first), to = f8_load(pieces->to + first);
  const f8 length = f8_load(pieces->length + first);
  const fast_band8 band = fast_band8_at(scene->transfer, i8_load(pieces->interval + first));
  const bool is_emission = scene->model.model == CELLIST_MODEL_EMISSION;
  fast_gain8 gain;
  if (is_emission)
    fast_emission8_of(&band, from, to, length, &gain);
  else
    fast_gain8_of(scene->transfer, &band, from, to, length, &gain);
  if (scene->model.gradients != SOFT_NO_LIGHT) light_eight(scene, pieces, first, &gain);
  const f8 alpha = is_emission ? f8_all(0) : scene->is_thin ? gain.alpha : f8_sub(f8_all(0), gain.alpha);
  const f8 light[4] = {gain.colour[0], gain.colour[1], gain.colour[2], alpha};
  const f8 zero = f8_all(0), minus_begin = f8_sub(zero, f8_load(pieces->depth[0] + first));
  const m8 gains = f8_greater(gain.alpha, zero);
  const f8 depth[2] = {f8_select(gains, minus_begin, f8_all(-HUGE_VALF)),
                       f8_select(gains, f8_load(pieces->depth[1] + first), zero)};
  blend_pieces(scene, worker, light, depth, pieces->pixel + first, count);
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
    for (int k = 0; k < attribute_count(scene); k++) pieces->attribute[k][i] = pieces->attribute[k][first + i];
  }
}

/* Appends a piece for each lane of the mask: between two shares, begin and end, of its segment; length: its share. */
static inline void append_pieces(const soft_scene *scene, soft_worker *worker, const segment8 *segment, f8 from, f8 to,
                                 f8 length, f8 begin, f8 end, i8 interval, unsigned lanes) {
  soft_pieces *pieces = worker->pieces;
  if (pieces->count + 8 > SOFT_PIECES) shade_pieces(scene, worker, false);
  const size_t at = pieces->count;
  const i8 packing = lanes_packing(lanes);
  f8_store_packed(pieces->from + at, from, packing);
  f8_store_packed(pieces->to + at, to, packing);
  f8_store_packed(pieces->length + at, f8_mul(segment->length, length), packing);
  i8_store_packed(pieces->interval + at, interval, packing);
  i8_store_packed(pieces->pixel + at, segment->pixel, packing);
  const f8 extent = f8_sub(segment->far_depth, segment->near_depth);
  f8_store_packed(pieces->depth[0] + at, f8_fma(begin, extent, segment->near_depth), packing);
  f8_store_packed(pieces->depth[1] + at, f8_fma(end, extent, segment->near_depth), packing);
  if (scene->model.gradients != SOFT_NO_LIGHT) {
    const bool at_points = scene->model.gradients == SOFT_POINT_GRADIENTS;
    for (int k = 0; k < (at_points ? 6 : 2); k++)
      f8_store_packed(pieces->attribute[k] + at, segment->light[k], packing);
    if (at_points) {
      f8_store_packed(pieces->attribute[6] + at, begin, packing);
      f8_store_packed(pieces->attribute[7] + at, end, packing);
    }
  }
  pieces->count = at + (size_t)__builtin_popcount(lanes);
}

/* Cuts the segments of the mask, between two shares, where they cross knots, near pieces first. */
static void cut_part(const soft_scene *scene, soft_worker *worker, const segment8 *segment, float first, float last,
                     unsigned lanes) {
  const f8 one = f8_all(1), rise = f8_sub(segment->to, segment->from), inverse = f8_div(one, rise);
  const f8 finish = f8_all(last), to = last < 1 ? f8_fma(finish, rise, segment->from) : segment->to;
  f8 from = f8_fma(f8_all(first), rise, segment->from), begin = f8_all(first);
  i8 interval = fast_find8(scene->transfer, from);
  for (;;) {
    f8 low, high;
    fast_span8(scene->transfer, interval, &low, &high);
    const m8 above = f8_greater(to, high), below = f8_greater(low, to);
    const unsigned beyond = m8_bits(m8_or(above, below)) & lanes;
    const f8 stop = f8_select(above, high, f8_select(below, low, to));
    /* A share of the rise from the segment's own front: no errors add up. */
    const f8 share = f8_min(f8_max(f8_mul(f8_sub(stop, segment->from), inverse), begin), finish);
    const f8 end = f8_select(m8_or(above, below), share, finish);
    append_pieces(scene, worker, segment, from, stop, f8_sub(end, begin), begin, end, interval, lanes);
    if (beyond == 0) return;
    lanes = beyond;
    interval = i8_sub(i8_add(interval, m8_ones(above)), m8_ones(below));
    from = stop;
    begin = end;
  }
}

/* The same for whole segments, in as many parts as the light wants. */
static void cut_segments(const soft_scene *scene, soft_worker *worker, const segment8 *segment, unsigned lanes) {
  const uint32_t count = scene->model.gradients == SOFT_POINT_GRADIENTS ? scene->model.samples : 1;
  for (uint32_t i = 0; i < count; i++)
    cut_part(scene, worker, segment, (float)i / (float)count, (float)(i + 1) / (float)count, lanes);
}

/* Cuts one segment, or a part of it, whose scalar goes from ends[0] to ends[1], in double precision: see sharp.h. */
static void cut_sharp_part(const soft_scene *scene, soft_worker *worker, const segment8 *segment, const double ends[2],
                           double first, double last, unsigned lane) {
  const soft_sharp *sharp = &scene->sharp;
  const double rise = ends[1] - ends[0], to = last < 1 ? ends[0] + last * rise : ends[1];
  double from = ends[0] + first * rise, begin = first;
  for (size_t k = soft_sharp_find(sharp, from);;) {
    const double low = sharp->bounds[k], high = sharp->bounds[k + 1], width = high - low;
    const double stop = to > high ? high : to < low ? low : to;
    const double share = rise != 0 ? (stop - from) / rise : last - first;
    const double end = stop == to ? last : (stop - ends[0]) / rise;
    if (share > 0) {
      const bool is_outer = !(width < HUGE_VAL); /* constant */
      const float near = is_outer ? 0 : (float)((from - low) / width),
                  far = is_outer ? 0 : (float)((stop - low) / width);
      append_pieces(scene, worker, segment, f8_all(near), f8_all(far), f8_all((float)share), f8_all((float)begin),
                    f8_all((float)end), i8_all((int32_t)(sharp->first + k)), lane);
    }
    if (stop == to) return;
    k = to > high ? k + 1 : k - 1;
    from = stop;
    begin = end;
  }
}

static void cut_sharp_segment(const soft_scene *scene, soft_worker *worker, const segment8 *segment,
                              const double ends[2], unsigned lane) {
  const uint32_t count = scene->model.gradients == SOFT_POINT_GRADIENTS ? scene->model.samples : 1;
  for (uint32_t i = 0; i < count; i++)
    cut_sharp_part(scene, worker, segment, ends, (double)i / count, (double)(i + 1) / count, lane);
}

/* Segments of which some may be sharp, one by one. ends: of each, NaN where it is not. */
static void add_sharp_segments(const soft_scene *scene, soft_worker *worker, const segment8 *segment,
                               const double *const ends[8], unsigned lanes) {
  for (unsigned i = 0; i < 8; i++) {
    if (!(lanes >> i & 1)) continue;
    if (isnan(ends[i][0]))
      cut_segments(scene, worker, segment, 1u << i);
    else
      cut_sharp_segment(scene, worker, segment, ends[i], 1u << i);
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
  const bool in_parts = scene->model.gradients == SOFT_POINT_GRADIENTS && scene->model.samples > 1;
  if ((m8_bits(crosses) & lanes) == 0 && !in_parts) {
    append_pieces(scene, worker, segment, segment->from, segment->to, f8_all(1), f8_all(0), f8_all(1), interval, lanes);
  } else if (lanes != 255 || pixels_repeat(segment->pixel)) {
    for (unsigned i = 0; i < 8; i++)
      if (lanes >> i & 1) cut_segments(scene, worker, segment, 1u << i);
  } else {
    cut_segments(scene, worker, segment, lanes);
  }
}

#endif
