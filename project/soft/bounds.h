/* SPDX-License-Identifier: BSD-3-Clause
 * Bounds: the pixels that tets may cover, eight tets at a time in the mesh's own order, where points are near in
 * memory. Included by each kernel. */
#ifndef CELLIST_SOFT_BOUNDS_H
#define CELLIST_SOFT_BOUNDS_H

#include <optics/lanes.h>

#include "scene.h"

/* Places are rounded to floats (1/256 pixel in the largest image): rectangles are this much larger. */
#define BOUNDS_MARGIN 0.015625f

/* The integer below; what lies outside of low..high is cut off. */
static inline i8 bounds_floor(f8 a, float low, float high) {
  const f8 cut = f8_max(f8_min(f8_add(a, f8_all(BOUNDS_MARGIN)), f8_all(high)), f8_all(low));
  const i8 whole = f8_truncate(cut);
  return i8_sub(whole, m8_ones(f8_greater(i8_to_float(whole), cut)));
}

static inline void bound_tets(const uint32_t *tets, const float (*places)[4], size_t begin, size_t end, uint32_t width,
                              uint32_t height, soft_rect *rects) {
  static const soft_rect nothing = {1, 1, 0, 0};
  const i8 zero = i8_all(0);
  for (size_t first = begin; first < end; first += 8) {
    const size_t count = end - first < 8 ? end - first : 8;
    float row[8][4];
    f8 most[4];
    for (size_t i = 0; i < 8; i++) {
      const uint32_t *tet = &tets[4 * (first + (i < count ? i : 0))];
      const f4 a = f4_max(f4_load(places[tet[0]]), f4_load(places[tet[1]]));
      f4_store(row[i], f4_max(a, f4_max(f4_load(places[tet[2]]), f4_load(places[tet[3]]))));
    }
    f8_from_rows(row, most);
    const i8 x1 = bounds_floor(most[0], -1, (float)width - 0.5f), y1 = bounds_floor(most[1], -1, (float)height - 0.5f);
    const i8 x0 = i8_sub(zero, bounds_floor(most[2], -(float)width, 0.5f));
    const i8 y0 = i8_sub(zero, bounds_floor(most[3], -(float)height, 0.5f));
    int32_t corner[4][8];
    i8_store(corner[0], x0);
    i8_store(corner[1], y0);
    i8_store(corner[2], x1);
    i8_store(corner[3], y1);
    for (size_t i = 0; i < count; i++)
      rects[first + i] = corner[0][i] <= corner[2][i] && corner[1][i] <= corner[3][i]
                             ? (soft_rect){(uint16_t)corner[0][i], (uint16_t)corner[1][i], (uint16_t)corner[2][i],
                                           (uint16_t)corner[3][i]}
                             : nothing;
  }
}

#endif
