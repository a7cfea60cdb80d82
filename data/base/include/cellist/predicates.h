/* SPDX-License-Identifier: BSD-3-Clause
 * Exact geometric decisions on doubles as given: a filter with a proved bound, then integers.
 * Any finite coordinates are exact, subnormal and huge ones too; infinities and NaN are not allowed. */
#ifndef CELLIST_PREDICATES_H
#define CELLIST_PREDICATES_H

#include <cellist/context.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sign (-1, 0, 1) of det[b-a, c-a, d-a]: positive if d lies on the side of the plane (a, b, c) from which
 * a, b, c turn counter-clockwise; six times the volume of a positively oriented tet (a, b, c, d).
 * Arrays: 3 doubles each, any frame. Threads: any. Cost: some 5 ns, some 500 ns when nearly coplanar. */
CELLIST_API int cellist_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/* Sign (-1, 0, 1) of det[b-a, c-a, direction]: as above with d at infinity. */
CELLIST_API int cellist_orient3d_direction(const double a[3], const double b[3], const double c[3],
                                           const double direction[3]);

/* Sign (-1, 0, 1) of det[b-a, c-a] in the plane. Arrays: 2 doubles each. */
CELLIST_API int cellist_orient2d(const double a[2], const double b[2], const double c[2]);

#ifdef __cplusplus
}
#endif
#endif
