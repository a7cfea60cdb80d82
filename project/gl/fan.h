/* SPDX-License-Identifier: BSD-3-Clause
 * Fans [Shirley, Tuchman; C 2]: a tet's picture as one to four triangles around its thick vertex. Private. */
#ifndef CELLIST_GL_FAN_H
#define CELLIST_GL_FAN_H

#include "footprint.h"

enum { GL_FAN_TRIANGLES = 4 }; /* at most, of a cell */

/* Corner of a fan's triangle. What is interpolated is linear in the picture: in perspective everything is divided by
 * its own depth. */
typedef struct gl_fan_corner {
  float x, y;      /* in the picture, -1..1 */
  float record;    /* of its cell */
  float front[2];  /* scalar / depth and 1 / depth where the ray enters; parallel: scalar and depth */
  float back[2];   /* where it leaves */
  float thickness; /* 1 / front depth - 1 / back depth; parallel: back depth - front depth: 0 at silhouettes */
} gl_fan_corner;

/* The fan of a tet none of whose corners is wild. sides: bit k is set if the face opposite to corner k is a back face,
 * bit 4 + k if it is a front face, neither if it is seen edge-on; exact, and at least one of each. scalars: of the
 * corners. Writes three corners a triangle and returns their number. */
int gl_fan_of_tet(const gl_picture *picture, const double *const corners[4], const float scalars[4], unsigned sides,
                  float record, gl_fan_corner out[3 * GL_FAN_TRIANGLES]);

#endif
