// SPDX-License-Identifier: BSD-3-Clause
// Convex hull by CGAL's quickhull with exact predicates (package Convex_hull_3, GPL). How a flat side is split into
// triangles, and which of its inner points they use, is left open here; hull.c does not rely on it.
#include "hull_cgal.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <new>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

bool less(const double *a, const double *b) { return std::lexicographical_compare(a, a + 3, b, b + 3); }

} // namespace

hull_result hull_compute(size_t point_count, const double *positions, uint32_t *triangles, size_t *triangle_count) {
  try {
    std::vector<Point> points;
    std::vector<uint32_t> order(point_count);
    points.reserve(point_count);
    for (size_t i = 0; i < point_count; i++) {
      points.emplace_back(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
      order[i] = static_cast<uint32_t>(i);
    }
    const auto by_position = [&](uint32_t a, uint32_t b) { return less(positions + 3 * a, positions + 3 * b); };
    std::sort(order.begin(), order.end(), by_position);
    CGAL::Surface_mesh<Point> hull;
    CGAL::convex_hull_3(points.begin(), points.end(), hull);
    if (hull.number_of_vertices() < 4) return HULL_FLAT;
    std::vector<uint32_t> id(hull.number_of_vertices());
    for (const auto v : hull.vertices()) {
      const double p[3] = {hull.point(v).x(), hull.point(v).y(), hull.point(v).z()};
      const auto found = std::lower_bound(order.begin(), order.end(), p,
                                          [&](uint32_t a, const double *q) { return less(positions + 3 * a, q); });
      if (found == order.end()) return HULL_FAILED;
      id[v] = *found;
    }
    if (hull.number_of_faces() > 2 * point_count) return HULL_FAILED;
    *triangle_count = 0;
    for (const auto f : hull.faces()) {
      size_t corner = 0;
      for (const auto v : hull.vertices_around_face(hull.halfedge(f))) {
        if (corner == 3) return HULL_FAILED;
        triangles[3 * *triangle_count + corner++] = id[v];
      }
      ++*triangle_count;
    }
    return HULL_DONE;
  } catch (const std::bad_alloc &) {
    return HULL_NO_MEMORY;
  } catch (...) {
    return HULL_FAILED;
  }
}
