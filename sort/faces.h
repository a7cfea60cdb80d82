/* SPDX-License-Identifier: BSD-3-Clause
 * Faces and the two cells at each. Private to sort/. */
#ifndef CELLIST_SORT_FACES_H
#define CELLIST_SORT_FACES_H

#include <cellist/sort.h>

/* The corner of tet `other` that is not on the face of `tet` opposite to its corner k; 4 if they do not share that
 * face's three points. */
static inline uint32_t sort_opposite_corner(const cellist_sorter_desc *mesh, uint32_t tet, uint32_t k, uint32_t other) {
  const uint32_t *v = &mesh->tets[4 * (size_t)tet], *w = &mesh->tets[4 * (size_t)other];
  uint32_t opposite = 4, shared = 0;
  for (uint32_t j = 0; j < 4; j++) {
    bool on_face = false;
    for (uint32_t i = 0; i < 4; i++) on_face |= i != k && v[i] == w[j];
    if (on_face)
      shared++;
    else
      opposite = j;
  }
  return shared == 3 ? opposite : 4;
}

#endif
