/* SPDX-License-Identifier: BSD-3-Clause
 * The kernel for AVX2 and FMA, compiled for these alone and reached only where the processor has them. */
#include "tile.h"

bool soft_tile_avx2(const soft_scene *scene, soft_worker *worker, size_t tile) {
  return draw_tile(scene, worker, tile);
}
