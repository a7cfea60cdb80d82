/* SPDX-License-Identifier: BSD-3-Clause
 * Sort: the cells of a tetrahedral mesh in exact visibility order, from far to near.
 *
 * The order depends on the eye's position alone (or on the direction of a parallel view): turning the head, zooming
 * and resizing the picture keep it. It holds for every half-line that starts at the eye, behind the camera too.
 * This module needs nothing but cellist::base; it takes plain arrays. */
#ifndef CELLIST_SORT_H
#define CELLIST_SORT_H

#include <cellist/context.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cellist_sorter cellist_sorter;

/* The mesh made convex: its cells and imaginary cells that fill the rest of its convex hull, as cellist_complex_arrays
 * has them. Sorting with a complex is exact, as without, and for most concave meshes cheaper. */
typedef struct cellist_sorter_complex {
  size_t cell_count;    /* the tets, then the imaginary cells, all of them convex */
  size_t point_count;   /* the mesh's points, bit for bit, then others that planes need */
  const double *points; /* [3 point_count] */
  size_t offset_count;
  const double *offsets; /* [offset_count] where planes across an axis stand */
  /* A plane is {p0, p1, p2}, three point ids, and its positive side is where cellist_orient3d(p0, p1, p2, x) > 0; or
   * {CELLIST_NONE, axis, i}, axis 0..2, and its positive side is where x[axis] > offsets[i]. */
  size_t plane_count;
  const uint32_t *planes; /* [3 plane_count] */
  /* A facet is where two cells meet in a plane. Two tets that are neighbours need none; every other contact of two
   * cells does, and every face of a tet on the outer surface. Flat tets on the mesh's boundary may be left out. */
  size_t facet_count;
  const uint32_t *facet_planes; /* [facet_count] */
  const uint32_t *facet_cells;  /* [2 facet_count] the cell on the plane's positive side, then the one on its negative;
                                   CELLIST_NONE: nothing */
} cellist_sorter_complex;

/* What a sorter sorts. Every array is the caller's and is borrowed: it must stay as it is while the sorter lives.
 * {0} is valid: no cells. Cells in Hilbert order are sorted two to three times faster than cells in disorder. */
typedef struct cellist_sorter_desc {
  size_t point_count;
  const double *points; /* [3 point_count] x y z, finite where a tet uses them */
  size_t tet_count;     /* below 2^30 */
  const uint32_t *tets; /* [4 tet_count] point ids, det[v1-v0, v2-v0, v3-v0] >= 0 */
  /* [4 tet_count] the tet across the face opposite to corner k, or CELLIST_NONE. Tets are each other's neighbours or
   * neither is the other's, and lie on the two sides of the face that they share. */
  const uint32_t *neighbours;
  /* NULL: cells with a gap between them are put in order by where their faces overlap. A convex mesh needs none. The
   * struct is read by cellist_sorter_create, its arrays are borrowed. */
  const cellist_sorter_complex *complex;
} cellist_sorter_desc;

/* Where a view looks from. */
typedef struct cellist_viewpoint {
  double position[3]; /* the eye, in the points' frame; parallel: the direction in which the view looks, not 0 */
  bool parallel;
} cellist_viewpoint;

/* What a sort found. */
typedef struct cellist_sort_stats {
  bool exact;           /* the order is right for every ray outside groups; false only where a caller asked for less */
  size_t group_count;   /* sets of cells that lie in front of each other in a circle */
  size_t largest_group; /* cells */
  size_t cells_in_groups;
  size_t exact_sign_count;     /* faces so nearly in line with the eye that floating point could not decide */
  size_t sorted_tet_count;     /* all of the mesh's, or those that a subset needs */
  size_t imaginary_cell_count; /* sorted with the tets, and not in the order */
  size_t link_count;           /* facets of imaginary cells with more than four neighbours */
  size_t left_cell_count;      /* tets that no topological sort could put in order: cycles and what lies in front */
  size_t component_cell_count; /* tets in cycles with imaginary cells, which gap arcs took apart */
  size_t gap_candidate_count;  /* pairs of boundary faces that were looked at */
  size_t gap_arc_count;        /* pairs of boundary faces that put one cell in front of another one */
} cellist_sort_stats;

/* A group of the order: order[begin] to order[begin + count - 1] lie in front of each other in a circle, so that no
 * order of whole cells is right for every ray; before and after them the order is right. */
typedef struct cellist_group {
  size_t begin, count;
} cellist_group;

/* Makes a sorter.
 * Arrays: see cellist_sorter_desc; borrowed. *sorter is the caller's, for cellist_sorter_destroy.
 * Errors: INVALID_ARGUMENT (an array is NULL, a point id or neighbour out of range, neighbours that do not know each
 *   other, a complex of another mesh), GEOMETRY (a coordinate that is not finite, a tet of negative volume, neighbours
 * on the same side of their face), UNSUPPORTED (2^30 tets or more), OUT_OF_MEMORY; the message names the tet. Threads:
 * one call per context at a time; the context must outlive the sorter. Cost: linear. */
CELLIST_API cellist_result cellist_sorter_create(cellist_context *context, const cellist_sorter_desc *desc,
                                                 cellist_sorter **sorter);

/* Makes a sorter of some tets alone. To put these in order it suffices to sort the cells that meet a convex region
 * which holds them: the smallest box around them. Arrays: as above; wanted [tet_count]: not 0 for the tets that orders
 * are to hold, read during the call only. Orders have cellist_sorter_order_size entries, by the ids of the whole mesh,
 * and are right for every ray as ever. Errors, threads, cost: as above; a sort then costs what the tets in the box and
 * all imaginary cells cost. */
CELLIST_API cellist_result cellist_sorter_create_subset(cellist_context *context, const cellist_sorter_desc *desc,
                                                        const uint8_t *wanted, cellist_sorter **sorter);

/* How many entries an order has: tet_count, or the number of wanted tets. Threads: any. */
CELLIST_API size_t cellist_sorter_order_size(const cellist_sorter *sorter);

/* Frees the sorter; NULL is legal. */
CELLIST_API void cellist_sorter_destroy(cellist_sorter *sorter);

/* Whether the mesh fills its convex hull, so that faces alone order its cells. Threads: any. Cost: constant. */
CELLIST_API bool cellist_sorter_is_convex(const cellist_sorter *sorter);

/* Writes the order of all tets for one view: of two cells on one ray the farther one comes first, unless both
 * are in one group. A face whose plane holds the eye puts neither of its cells first: no ray crosses it.
 * Arrays: order has cellist_sorter_order_size entries and is the caller's; stats may be NULL.
 * Errors: INVALID_ARGUMENT (NULL, a position that is not finite, a direction of length 0), OUT_OF_MEMORY.
 * Threads: one call per sorter at a time, using the context's workers; the same order for any number of workers.
 * Cost: see the module's README. A sort allocates nothing, unless a view has more than 32 gap arcs a boundary face;
 * then it makes room for four times as many, which is kept. */
CELLIST_API cellist_result cellist_sorter_sort(cellist_sorter *sorter, const cellist_viewpoint *viewpoint,
                                               uint32_t *order, cellist_sort_stats *stats);

/* Whether the last sort's order holds for this viewpoint: it was made for the same eye, or the same direction.
 * Errors: false too if there was no successful sort. Threads: as cellist_sorter_sort. Cost: constant. */
CELLIST_API bool cellist_sorter_is_current(const cellist_sorter *sorter, const cellist_viewpoint *viewpoint);

/* Makes cellist_sorter_is_current false until the next sort. */
CELLIST_API void cellist_sorter_forget(cellist_sorter *sorter);

/* The groups of the last sort, ascending by begin.
 * Arrays: *groups has *count entries and belongs to the sorter until its next sort.
 * Errors: none. Threads: as cellist_sorter_sort. Cost: constant. */
CELLIST_API void cellist_sorter_groups(const cellist_sorter *sorter, const cellist_group **groups, size_t *count);

/* Which of two tets is in front, for any two tets and any view: inside a group, what the order cannot tell.
 * Returns 1: a is in front of b wherever a ray meets both; -1: b of a; 0: no ray from the eye passes through both,
 * or (cells that cut each other) each is in front of the other on some ray.
 * Arrays: a and b are below tet_count.
 * Errors: none. Threads: any number, on one sorter too. Cost: some microseconds. */
CELLIST_API int cellist_sorter_compare(const cellist_sorter *sorter, const cellist_viewpoint *viewpoint, uint32_t a,
                                       uint32_t b);

/* All pairs of some tets at once, such as a group's: matrix[i * count + j] is cellist_sorter_compare of cells[i] and
 * cells[j]. On any one ray the members that it meets are in a total order, which these pairs tell.
 * Arrays: cells [count] below tet_count; matrix [count * count] filled, the caller's.
 * Errors: INVALID_ARGUMENT (NULL, an id out of range), OUT_OF_MEMORY.
 * Threads: one call per context at a time. Cost: some microseconds for each pair whose boxes overlap as the eye sees
 *   them, some nanoseconds for each other one; all pairs count as overlapping where the eye is among the cells. */
CELLIST_API cellist_result cellist_sorter_compare_all(const cellist_sorter *sorter, const cellist_viewpoint *viewpoint,
                                                      const uint32_t *cells, size_t count, int8_t *matrix);

#ifdef __cplusplus
}
#endif
#endif
