/* SPDX-License-Identifier: BSD-3-Clause
 * Locate: whether a closed surface contains a shell, by the parity of its facets on a half-line from one of the shell's
 * vertices. The half-line's direction is (1024, i, j) for random i, j, so that grids do not meet it edge-on; if it
 * passes through an edge nevertheless (an exact zero), another one is drawn. */
#include "work.h"

/* Draws before the shell's next vertex is tried, and vertices before giving up; with random directions one draw is
 * nearly always enough. */
enum { DRAWS = 8, VERTICES = 64 };

/* Facets ahead of the vertex: parity, or -1 if the half-line is not in general position. */
static int parity_along(work *w, const int shear[2], const uint32_t *members, size_t count, uint32_t vertex) {
  int parity = 0;
  for (size_t i = 0; i < count; i++) {
    const uint32_t facet = members[i] / 2, plane = w->facets.items[facet].plane;
    int inside = 0;
    for (EACH_USE(w, u, facet)) {
      const uint32_t *v = w->edges.items[w->uses.items[u].edge].v;
      if (v[0] == vertex || v[1] == vertex) return -1;
      const int a = exact_sheared_compare(w, shear, v[0], vertex), b = exact_sheared_compare(w, shear, v[1], vertex);
      if ((a > 0) == (b > 0)) continue;
      const int turn = exact_sheared_turn(w, shear, v[0], v[1], vertex);
      if (turn == 0) return -1;
      inside ^= (turn > 0) == (b > 0);
    }
    if (!inside) continue;
    const int along = exact_plane_along(w, shear, plane), side = exact_side(w, vertex, plane);
    if (along == 0 || side == 0) return -1;
    parity ^= along * side < 0;
  }
  return parity;
}

bool surface_contains(work *w, const uint32_t *members, size_t count, uint32_t shell_member) {
  int tries = 0;
  for (EACH_USE(w, u, shell_member / 2)) {
    const uint32_t vertex = w->edges.items[w->uses.items[u].edge].v[0];
    for (int draw = 0; draw < DRAWS && tries < DRAWS * VERTICES; draw++, tries++) {
      const int shear[2] = {1 + (int)random_below(&w->random, 1021), 1 + (int)random_below(&w->random, 1021)};
      const int parity = parity_along(w, shear, members, count, vertex);
      if (parity >= 0) return parity == 1;
    }
  }
  work_stop(w, CELLIST_ERROR_GEOMETRY, "convexify: no half-line tells which part of the exterior holds a shell");
}
