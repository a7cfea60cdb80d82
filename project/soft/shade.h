/* SPDX-License-Identifier: BSD-3-Clause
 * Shade: eight fragments at a time, from where the ray enters and leaves a cell to colour. Included by each kernel;
 * the optics are those of optics/fast_optics.h and fast_optics_avx2.h.
 *
 * With w = place + end, t = 1/w (parallel: t = -w) and the reference ray at depth d:
 *   length = (w_near - w_far) t_near t_far |r|,   s(t) = s + (t - d) slope + t (slope_x x + slope_y y),
 *   t - d = - end t d:
 * no difference of large numbers is taken. Blending goes fragment by fragment, since two of eight may be of one pixel.
 */
#ifndef CELLIST_SOFT_SHADE_H
#define CELLIST_SOFT_SHADE_H

#include "lanes.h"
#include "scene.h"

#if defined(__AVX2__) && !defined(LANES_PORTABLE)
#include <optics/fast_optics_avx2.h>
#endif

/* Eight fragments. */
typedef struct segment8 {
  f8 from, to, length, near_depth, far_depth;
} segment8;

/* What eight fragments add: premultiplied colour, alpha, and where in the segment light begins and ends to change. */
typedef struct gain8 {
  f8 colour[3], alpha, begin, end;
} gain8;

static inline f8 scalar_at(f8 end, f8 t, f8 across, const f8 record[8]) {
  const f8 along = f8_mul(f8_mul(f8_mul(end, t), record[4]), record[1]);
  const f8 s = f8_add(f8_sub(record[0], along), f8_mul(t, across));
  return f8_min(f8_max(s, record[6]), record[7]);
}

static inline segment8 segments_of(const soft_scene *scene, const soft_fragments *fragments, size_t first,
                                   uint32_t left, uint32_t top, int32_t pixel[8]) {
  const float *row[8];
  for (size_t i = 0; i < 8; i++) row[i] = &fragments->records[fragments->cell[first + i]].s;
  f8 record[8];
  f8_transpose(row, record);
  const i8 where = i8_load(fragments->where + first);
  i8_store(pixel, i8_and(where, i8_all(0xffff)));
  const f8 x = i8_to_float(i8_and(i8_shift_right(where, 16), i8_all(0xff))), y = i8_to_float(i8_shift_right(where, 24));
  const f8 across = f8_add(f8_mul(record[2], x), f8_mul(record[3], y));
  const f8 near_end = f8_load(fragments->near_end + first), far_end = f8_load(fragments->far_end + first);
  const f8 near_place = f8_add(record[5], near_end), far_place = f8_add(record[5], far_end);
  segment8 made;
  f8 near_t = f8_all(1), far_t = f8_all(1);
  made.length = f8_sub(near_end, far_end);
  if (scene->parallel) {
    made.near_depth = f8_sub(f8_all(0), near_place);
    made.far_depth = f8_sub(f8_all(0), far_place);
  } else {
    made.near_depth = near_t = f8_div(f8_all(1), near_place);
    made.far_depth = far_t = f8_div(f8_all(1), far_place);
    const f8 column = i8_to_float(i8_and(where, i8_all(SOFT_TILE - 1)));
    const f8 line = i8_to_float(i8_and(i8_shift_right(where, 5), i8_all(SOFT_TILE - 1)));
    const f8 u = f8_add(f8_all((float)(scene->across + scene->across_step * left)),
                        f8_mul(f8_all((float)scene->across_step), column));
    const f8 v = f8_add(f8_all((float)(scene->upward + scene->upward_step * top)),
                        f8_mul(f8_all((float)scene->upward_step), line));
    const f8 stretch = f8_sqrt(f8_add(f8_add(f8_mul(u, u), f8_mul(v, v)), f8_all(1)));
    made.length = f8_mul(f8_mul(made.length, f8_mul(near_t, far_t)), stretch);
  }
  made.from = scalar_at(near_end, near_t, across, record);
  made.to = scalar_at(far_end, far_t, across, record);
  return made;
}

#if defined(__AVX2__) && !defined(LANES_PORTABLE)

typedef fast_interval8 shade_memory; /* intervals of the last eight, near which the next ones are likely */

static inline void shade_begin_tile(const soft_scene *scene, shade_memory *memory) {
  memory->index = _mm256_setzero_si256();
  fast_load_intervals8(scene->transfer, memory);
}

static inline gain8 shade_eight(const soft_scene *scene, const segment8 *segment, shade_memory *memory) {
  const __m256 from = segment->from;
  const __m256 outside =
      _mm256_or_ps(_mm256_cmp_ps(from, memory->low, _CMP_LE_OQ), _mm256_cmp_ps(from, memory->high, _CMP_GT_OQ));
  if (fast_any(outside)) fast_seek_intervals8(scene->transfer, from, outside, memory);
  fast_light8 light = {{_mm256_setzero_ps(), _mm256_setzero_ps(), _mm256_setzero_ps()}, _mm256_set1_ps(1)};
  __m256i pieces = _mm256_setzero_si256();
  __m256 seen[2] = {_mm256_set1_ps(2), _mm256_set1_ps(-1)};
  const __m256 all = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
  const bool wants_depth = scene->z != NULL || scene->z_back != NULL;
  fast_add_segment8(scene->transfer, memory, from, segment->to, segment->length, all, &light, &pieces,
                    wants_depth ? seen : NULL);
  return (gain8){{light.colour[0], light.colour[1], light.colour[2]},
                 _mm256_sub_ps(_mm256_set1_ps(1), light.transmittance),
                 seen[0],
                 seen[1]};
}

#else

typedef uint32_t shade_memory;

static inline void shade_begin_tile(const soft_scene *scene, shade_memory *memory) {
  (void)scene;
  *memory = 0;
}

static inline gain8 shade_eight(const soft_scene *scene, const segment8 *segment, shade_memory *memory) {
  float from[8], to[8], length[8], gain[6][8];
  f8_store(from, segment->from);
  f8_store(to, segment->to);
  f8_store(length, segment->length);
  for (int i = 0; i < 8; i++) {
    fast_light light = {{0, 0, 0}, 1};
    float seen[2] = {2, -1};
    uint32_t pieces = 0;
    const uint32_t interval = fast_find_interval(scene->transfer, from[i]);
    *memory = fast_add_segment(scene->transfer, interval, from[i], to[i], length[i], &light, &pieces, seen);
    for (int k = 0; k < 3; k++) gain[k][i] = light.colour[k];
    gain[3][i] = 1 - light.transmittance;
    gain[4][i] = seen[0];
    gain[5][i] = seen[1];
  }
  return (gain8){
      {f8_load(gain[0]), f8_load(gain[1]), f8_load(gain[2])}, f8_load(gain[3]), f8_load(gain[4]), f8_load(gain[5])};
}

#endif

static inline void blend_depths(soft_worker *worker, const segment8 *segment, const gain8 *gain, const int32_t pixel[8],
                                int count) {
  float begin[8], end[8], alpha[8];
  const f8 extent = f8_sub(segment->far_depth, segment->near_depth);
  f8_store(begin, f8_add(segment->near_depth, f8_mul(gain->begin, extent)));
  f8_store(end, f8_add(segment->near_depth, f8_mul(gain->end, extent)));
  f8_store(alpha, gain->alpha);
  for (int i = 0; i < count; i++) {
    if (!(alpha[i] > 0)) continue;
    worker->z[pixel[i]] = fminf(worker->z[pixel[i]], begin[i]);
    worker->z_back[pixel[i]] = fmaxf(worker->z_back[pixel[i]], end[i]);
  }
}

/* Shades what waits and empties the list. */
static void shade_fragments(const soft_scene *scene, soft_worker *worker, uint32_t left, uint32_t top) {
  soft_fragments *fragments = &worker->fragments;
  const size_t count = fragments->count;
  if (count == 0) return;
  worker->fragment_count += count;
  for (size_t i = count; i % 8 != 0; i++) { /* fill up the last eight; the room is reserved */
    fragments->near_end[i] = fragments->near_end[count - 1];
    fragments->far_end[i] = fragments->far_end[count - 1];
    fragments->where[i] = fragments->where[count - 1];
    fragments->cell[i] = fragments->cell[count - 1];
  }
  shade_memory memory;
  shade_begin_tile(scene, &memory);
  for (size_t first = 0; first < count; first += 8) {
    int32_t pixel[8];
    float row[8][4];
    const int used = count - first < 8 ? (int)(count - first) : 8;
    const segment8 segment = segments_of(scene, fragments, first, left, top, pixel);
    const gain8 gain = shade_eight(scene, &segment, &memory);
    f8_to_rows(gain.colour[0], gain.colour[1], gain.colour[2], f8_sub(f8_all(0), gain.alpha), row);
    if (scene->z != NULL || scene->z_back != NULL) blend_depths(worker, &segment, &gain, pixel, used);
    for (int i = 0; i < used; i++) {
      float *to = worker->pixels[pixel[i]];
      f4_store(to, f4_add_scaled(f4_load(to), f4_load(row[i]), to[3]));
    }
  }
  fragments->count = fragments->record_count = 0;
}

#endif
