/* SPDX-License-Identifier: BSD-3-Clause
 * Hull and box: what closes the exterior outside ([C] section 6.1, step 3, and its figure 3), as triangles. */
#include <cellist/predicates.h>

#include "hull_cgal.h"
#include "work.h"

static void add_face(work *w, uint32_t a, uint32_t b, uint32_t c) {
  const hull_face face = {{a, b, c}, exact_add_plane(w, a, b, c)};
  if (face.plane == CELLIST_NONE) work_stop(w, CELLIST_ERROR_INTERNAL, "convexify: the hull has a side of no area");
  list_push(w, &w->hull, face);
}

/* CGAL's order of triangles, and of a triangle's corners, changes from call to call. */
static void put_in_order(uint32_t *triangles, size_t count) {
  for (size_t t = 0; t < count; t++) {
    uint32_t *v = &triangles[3 * t];
    while (v[0] > v[1] || v[0] > v[2]) {
      const uint32_t first = v[0];
      v[0] = v[1];
      v[1] = v[2];
      v[2] = first;
    }
  }
  qsort(triangles, count, 3 * sizeof *triangles, work_compare3);
}

void hull_gather(work *w) {
  const size_t count = w->vertices.count;
  double_list *positions = &w->box_scratch;
  positions->count = 0;
  work_reserve(w, positions, 3 * count, sizeof(double));
  for (size_t v = 0; v < count; v++) memcpy(&positions->items[3 * v], exact_point(w, (uint32_t)v), 3 * sizeof(double));
  work_reserve(w, &w->ids, 6 * count, sizeof *w->ids.items);
  size_t triangle_count = 0;
  const hull_result done = hull_compute(count, positions->items, w->ids.items, &triangle_count);
  if (done == HULL_NO_MEMORY) work_stop(w, CELLIST_ERROR_OUT_OF_MEMORY, "convexify: no memory for the convex hull");
  if (done != HULL_DONE) work_stop(w, CELLIST_ERROR_INTERNAL, "convexify: CGAL's convex hull failed");
  put_in_order(w->ids.items, triangle_count);
  for (size_t t = 0; t < triangle_count; t++) {
    const uint32_t *v = &w->ids.items[3 * t];
    add_face(w, v[0], v[1], v[2]);
  }
}

void box_gather(work *w) {
  /* A margin keeps the box clear of the mesh, so that no side coincides with a boundary face. 1/64 to 1/32 of the
   * largest extent: near enough to add little to sort, far enough to be no sliver. */
  const double step = ldexp(1, w->shift - ADDED_BITS), margin = ldexp(1, w->shift - 5);
  uint32_t corner[8];
  for (uint32_t i = 0; i < 8; i++) {
    double p[3];
    for (int k = 0; k < 3; k++)
      p[k] = i >> k & 1 ? ceil((w->mesh->bounds[3 + k] + margin) / step) * step
                        : floor((w->mesh->bounds[k] - margin) / step) * step;
    for (int k = 0; k < 3; k++) list_push(w, &w->added_points, p[k]);
    corner[i] = exact_add_point(w, p, (uint32_t)(w->mesh->point_count + w->added_points.count / 3 - 1));
  }
  static const uint8_t side[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (int s = 0; s < 6; s++) {
    add_face(w, corner[side[s][0]], corner[side[s][1]], corner[side[s][2]]);
    add_face(w, corner[side[s][0]], corner[side[s][2]], corner[side[s][3]]);
  }
}
