// SPDX-License-Identifier: BSD-3-Clause
// TetGen 1.5 (AGPL) with -pYc: the surface as given, without points of its own on it, up to the hull. TetGen throws
// plain ints and allocates with new; its predicates keep static state that the first call sets, so calls are
// serialised.
#include "delaunay_tetgen.h"

#include <tetgen.h>

#include <mutex>
#include <new>

namespace {
std::mutex tetgen_lock;
}

delaunay_result delaunay_compute(size_t point_count, const double *positions, size_t triangle_count,
                                 const uint32_t *triangles, delaunay_tets *tets) {
  tetgenio *out = nullptr;
  try {
    const std::lock_guard<std::mutex> guard(tetgen_lock);
    tetgenio in;
    in.numberofpoints = static_cast<int>(point_count);
    in.pointlist = new REAL[3 * point_count];
    for (size_t i = 0; i < 3 * point_count; i++) in.pointlist[i] = positions[i];
    in.facetlist = new tetgenio::facet[triangle_count];
    for (size_t t = 0; t < triangle_count; t++) tetgenio::init(&in.facetlist[t]);
    in.numberoffacets = static_cast<int>(triangle_count);
    for (size_t t = 0; t < triangle_count; t++) {
      tetgenio::facet &facet = in.facetlist[t];
      facet.polygonlist = new tetgenio::polygon[1];
      facet.numberofpolygons = 1;
      tetgenio::init(&facet.polygonlist[0]);
      facet.polygonlist[0].vertexlist = new int[3];
      facet.polygonlist[0].numberofvertices = 3;
      for (size_t k = 0; k < 3; k++) facet.polygonlist[0].vertexlist[k] = static_cast<int>(triangles[3 * t + k]);
    }
    out = new tetgenio;
    char switches[] = "pYcQ";
    tetrahedralize(switches, &in, out);
    tets->handle = out;
    tets->point_count = static_cast<size_t>(out->numberofpoints);
    tets->positions = out->pointlist;
    tets->tet_count = static_cast<size_t>(out->numberoftetrahedra);
    tets->tets = out->tetrahedronlist;
    return out->numberofcorners == 4 && tets->tets != nullptr ? DELAUNAY_DONE : DELAUNAY_REFUSED;
  } catch (const std::bad_alloc &) {
    delete out;
    return DELAUNAY_NO_MEMORY;
  } catch (...) {
    delete out;
    return DELAUNAY_REFUSED;
  }
}

void delaunay_release(delaunay_tets *tets) {
  delete static_cast<tetgenio *>(tets->handle);
  *tets = delaunay_tets{};
}
