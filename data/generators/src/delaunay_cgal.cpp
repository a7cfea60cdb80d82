/* SPDX-License-Identifier: BSD-3-Clause
 * Delaunay triangulation by CGAL (Delaunay_triangulation_3), points inserted along a space-filling curve.
 *
 * CGAL breaks ties of cospherical points by the points' lexicographic order, so the triangulation depends on the points
 * alone. It keeps its own structure in memory from the C++ allocator: the context's hears only of the result. */
#include "delaunay_cgal.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <new>
#include <utility>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_3<uint32_t, Kernel>;
using Structure = CGAL::Triangulation_data_structure_3<Vertex, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, Structure>;

cellist_result triangulate(cellist_context *context, size_t point_count, const double *positions, uint32_t **tets,
                           size_t *tet_count) {
  std::vector<std::pair<Kernel::Point_3, uint32_t>> points;
  points.reserve(point_count);
  for (size_t i = 0; i < point_count; i++) {
    const double *p = &positions[3 * i];
    points.emplace_back(Kernel::Point_3(p[0], p[1], p[2]), static_cast<uint32_t>(i));
  }
  const Triangulation triangulation(points.begin(), points.end());
  const size_t count = triangulation.number_of_finite_cells();
  uint32_t *made = static_cast<uint32_t *>(cellist_allocate(context, count, 4 * sizeof *made));
  if (made == nullptr) return CELLIST_ERROR_OUT_OF_MEMORY;
  uint32_t *next = made;
  for (auto cell = triangulation.finite_cells_begin(); cell != triangulation.finite_cells_end(); ++cell)
    for (int k = 0; k < 4; k++) *next++ = cell->vertex(k)->info();
  *tets = made;
  *tet_count = count;
  return CELLIST_SUCCESS;
}

} // namespace

extern "C" cellist_result delaunay_cgal(cellist_context *context, size_t point_count, const double *positions,
                                        uint32_t **tets, size_t *tet_count) {
  try {
    return triangulate(context, point_count, positions, tets, tet_count);
  } catch (const std::bad_alloc &) {
    return cellist_fail(context, CELLIST_ERROR_OUT_OF_MEMORY, "no memory for the triangulation of %zu points",
                        point_count);
  } catch (const std::exception &error) {
    return cellist_fail(context, CELLIST_ERROR_INTERNAL, "CGAL cannot triangulate %zu points: %s", point_count,
                        error.what());
  } catch (...) {
    return cellist_fail(context, CELLIST_ERROR_INTERNAL, "CGAL cannot triangulate %zu points", point_count);
  }
}
