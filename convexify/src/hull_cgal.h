/* SPDX-License-Identifier: BSD-3-Clause
 * Convex hull of points, by CGAL, behind plain C. Private to convexify. */
#ifndef CELLIST_HULL_CGAL_H
#define CELLIST_HULL_CGAL_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hull_result { HULL_DONE, HULL_FLAT, HULL_NO_MEMORY, HULL_FAILED } hull_result;

/* The hull's triangles, counter-clockwise seen from outside, with exact decisions; 2 point_count of them at most.
 * positions: [3 point_count], distinct. triangles: [6 point_count], the caller's. FLAT: all points lie in a plane. */
hull_result hull_compute(size_t point_count, const double *positions, uint32_t *triangles, size_t *triangle_count);

#ifdef __cplusplus
}
#endif
#endif
