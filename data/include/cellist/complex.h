/* SPDX-License-Identifier: BSD-3-Clause
 * Complex: a mesh made convex. Its cells are the mesh's tets and imaginary cells, convex and never drawn, that fill
 * what lies between the mesh and its convex hull (or a box): with them every cell's neighbours are known in every
 * direction, which is what a visibility sort needs.
 *
 * Two neighbouring tets of the mesh meet in a face that only the mesh's own neighbours array knows; every other
 * contact of two cells, and every piece of the outer surface, is a facet here. Decisions about facets are exact
 * because a plane is stored by what spans it, not by coefficients. */
#ifndef CELLIST_COMPLEX_H
#define CELLIST_COMPLEX_H

#include <cellist/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cellist_complex cellist_complex;

/* Everything a complex holds. All pointers belong to the complex. */
typedef struct cellist_complex_arrays {
  size_t tet_count;  /* cells 0..tet_count-1 are the mesh's tets, in the mesh's order */
  size_t cell_count; /* tet_count and the imaginary cells, which follow */

  /* What planes are made of: the mesh's points, in the mesh's order, then added ones (corners of a box, a mesher's). */
  size_t point_count;
  const double *points; /* [3 point_count] x y z, in the mesh's frame */
  size_t offset_count;
  const double *offsets; /* [offset_count] where axis-aligned planes stand */

  /* A plane is {p0, p1, p2}, three point ids, and its positive side is where cellist_orient3d(p0, p1, p2, x) > 0;
   * or {CELLIST_NONE, axis, i}, axis 0..2, and its positive side is where x[axis] > offsets[i]. */
  size_t plane_count;
  const uint32_t *planes; /* [3 plane_count] */

  /* A facet is a convex polygon in a plane, with one cell on either side. Two cells meet in one facet a plane. */
  size_t facet_count;
  const uint32_t *facet_planes; /* [facet_count] */
  const uint32_t *facet_cells;  /* [2 facet_count] the cell on the plane's positive side, then the one on its negative;
                                   CELLIST_NONE: nothing, the facet is part of the outer surface */
  const uint32_t *facet_starts; /* [facet_count + 1] where a facet's corners begin in facet_vertices */
  const uint32_t *facet_vertices; /* [facet_starts[facet_count]] vertex ids, counter-clockwise seen from the plane's
                                     positive side; at least 3 a facet, some may lie on straight edges. The imaginary
                                     cells' facets match edge by edge */
  /* How far from convex imaginary cells may be; 0 and 0: they are convex, exactly. At an edge a cell may be reflex by
   * flat_angle (radians), and no point of a cell lies farther than flat_distance beyond the plane of one of its facets.
   * So a ray may meet a cell again that it has left, or see two cells in the wrong order, over no more than this
   * depth, perpendicular to that plane. Two cells may then meet in more than one facet, and facets are as far from
   * convex as their cells make them. */
  double flat_angle, flat_distance;

  size_t vertex_count;
  const double *vertices; /* [3 vertex_count] x y z, rounded: for drawing and overlap, not for exact decisions */
} cellist_complex_arrays;

/* Makes a complex of a copy of these arrays.
 * Arrays: see cellist_complex_arrays; nothing is kept. *complex is the caller's, for cellist_complex_destroy.
 * Errors: INVALID_ARGUMENT (NULL, an id out of range), OUT_OF_MEMORY.
 * Threads: one call per context at a time. The complex may be read by any number of threads.
 * Cost: linear. */
CELLIST_API cellist_result cellist_complex_create(cellist_context *context, const cellist_complex_arrays *arrays,
                                                  cellist_complex **complex);

/* Frees the complex; NULL is legal. The context that made it must still exist. */
CELLIST_API void cellist_complex_destroy(cellist_complex *complex);

/* The arrays; they live as long as the complex. Threads: any. */
CELLIST_API const cellist_complex_arrays *cellist_complex_get_arrays(const cellist_complex *complex);

/* Whether the complex is what it promises for this mesh: the mesh's counts and points; vertices on their facets' planes
 * and facets convex, to rounding (if the complex has no tolerance); the surface of every imaginary cell closed, each of
 * its edges used once in either direction; every cell's vertices on its own side of its facets' planes, to rounding and
 * flat_distance; the mesh's boundary faces covered by the tets' facets, to rounding, except those of flat tets; and
 * exactly: planes are spanned by points that are not on a line, a tet's facet lies in the plane of one of its faces, on
 * the right side of it. (That imaginary cells are convex exactly needs exact vertices: convexify checks it.)
 * Arrays: none.
 * Errors: false, with the reason as the context's error message; also when there is no memory for the check.
 * Threads: one call per context at a time. Cost: linear in facets and their corners, sorting apart. */
CELLIST_API bool cellist_complex_is_valid(cellist_context *context, const cellist_complex *complex,
                                          const cellist_mesh *mesh);

#ifdef __cplusplus
}
#endif
#endif
