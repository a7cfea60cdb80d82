/* SPDX-License-Identifier: BSD-3-Clause
 * The kernel for AVX2 and FMA, compiled for these alone and reached only where the processor has them. */
#include "bounds.h"
#include "tile.h"

bool soft_tile_avx2(const soft_scene *scene, soft_worker *worker, size_t tile) {
  return draw_tile(scene, worker, tile);
}

void soft_bounds_avx2(const uint32_t *tets, const float (*places)[4], size_t begin, size_t end, uint32_t width,
                      uint32_t height, soft_rect *rects) {
  bound_tets(tets, places, begin, end, width, height, rects);
}
