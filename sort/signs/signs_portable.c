/* SPDX-License-Identifier: BSD-3-Clause
 * Signs in plain C: what the other kernels must agree with bit by bit. */
#include "../state.h"
#include "kernel.h"

void sort_signs_portable(const int16_t *planes, const uint16_t *inner, const int16_t eye[4], int32_t doubt,
                         size_t group_count, uint8_t *states, uint8_t *mirrored, uint16_t *undecided) {
  for (size_t group = 0; group < group_count; group++) {
    uint32_t doubtful = 0;
    for (uint32_t tet = 0; tet < 4; tet++) {
      uint32_t state = SORT_READY, mirror = SORT_READY;
      for (uint32_t face = 0; face < 4; face++) {
        const int16_t *plane = &planes[64 * group + 16 * tet + 4 * face];
        const int32_t height = plane[0] * eye[0] + plane[1] * eye[1] + plane[2] * eye[2] + plane[3] * eye[3];
        const uint32_t bit = 4 * tet + face, counts = inner[group] >> bit & 1u;
        const uint32_t outside = height > doubt, inside = height < -doubt;
        state += counts * ((outside << face) + inside * SORT_WAIT);
        mirror += counts * ((inside << face) + outside * SORT_WAIT);
        doubtful |= (counts & ~(outside | inside)) << bit;
      }
      states[4 * group + tet] = (uint8_t)state;
      if (mirrored != NULL) mirrored[4 * group + tet] = (uint8_t)mirror;
    }
    undecided[group] = (uint16_t)doubtful;
  }
}
