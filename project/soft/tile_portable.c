/* SPDX-License-Identifier: BSD-3-Clause
 * The kernel in plain C. */
#define LANES_PORTABLE
#include "bounds.h"
#include "tile.h"

bool soft_tile_portable(const soft_scene *scene, soft_worker *worker, size_t tile) {
  return draw_tile(scene, worker, tile);
}

void soft_bounds_portable(const uint32_t *tets, const float (*places)[4], size_t begin, size_t end, uint32_t width,
                          uint32_t height, soft_rect *rects) {
  bound_tets(tets, places, begin, end, width, height, rects);
}
