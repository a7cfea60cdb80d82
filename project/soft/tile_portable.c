/* SPDX-License-Identifier: BSD-3-Clause
 * The kernel in plain C. */
#define LANES_PORTABLE
#include "tile.h"

bool soft_tile_portable(const soft_scene *scene, soft_worker *worker, size_t tile) {
  return draw_tile(scene, worker, tile);
}
