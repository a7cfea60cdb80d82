/* SPDX-License-Identifier: BSD-3-Clause
 * The Delaunay triangulation of points, by CGAL, behind plain C. Private to the generators. */
#ifndef CELLIST_DELAUNAY_CGAL_H
#define CELLIST_DELAUNAY_CGAL_H

#include "builder.h"

#ifdef __cplusplus
extern "C" {
#endif

/* positions: [3 point_count], finite. *tets: [4 *tet_count] positively oriented, from the context's allocator, the
 * caller's; in no particular order. Fails with OUT_OF_MEMORY or INTERNAL. */
cellist_result delaunay_cgal(cellist_context *context, size_t point_count, const double *positions, uint32_t **tets,
                             size_t *tet_count);

#ifdef __cplusplus
}
#endif
#endif
