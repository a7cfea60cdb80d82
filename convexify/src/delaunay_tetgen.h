/* SPDX-License-Identifier: BSD-3-Clause
 * Constrained Delaunay tetrahedralisation of a surface's convex hull, by TetGen, behind plain C. Private to convexify.
 */
#ifndef CELLIST_DELAUNAY_TETGEN_H
#define CELLIST_DELAUNAY_TETGEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum delaunay_result {
  DELAUNAY_DONE,
  DELAUNAY_NO_MEMORY,
  DELAUNAY_REFUSED,
  DELAUNAY_CANCELLED
} delaunay_result;

/* Called every DELAUNAY_PATIENCE milliseconds while TetGen works; false ends it: CANCELLED. Must return. */
enum { DELAUNAY_PATIENCE = 100 };
typedef bool (*delaunay_waiting)(void *user);

typedef struct delaunay_tets {
  void *handle;
  size_t point_count;      /* the given points first, then TetGen's own */
  const double *positions; /* [3 point_count] */
  size_t tet_count;
  const int *tets; /* [4 tet_count], either orientation */
} delaunay_tets;

/* Fills the hull of the points with tets that hold every triangle as a face.
 * positions: [3 point_count], distinct; triangles: [3 triangle_count]. What tets point to stays until
 * delaunay_release. REFUSED: TetGen does not take the surface. */
delaunay_result delaunay_compute(size_t point_count, const double *positions, size_t triangle_count,
                                 const uint32_t *triangles, delaunay_waiting waiting, void *user, delaunay_tets *tets);
void delaunay_release(delaunay_tets *tets);

#ifdef __cplusplus
}
#endif
#endif
