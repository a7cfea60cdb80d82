/* SPDX-License-Identifier: BSD-3-Clause
 * Do two triangles cover each other for an eye, and which is nearer? Exact. Private to sort/. */
#ifndef CELLIST_SORT_OVERLAP_H
#define CELLIST_SORT_OVERLAP_H

#include <math.h>
#include <string.h>

#include "../view.h"
#include "boundary.h"

/* What pair tests look at. Triangles are three ids into positions. */
typedef struct sort_scene {
  sort_eye eye;
  const double *positions; /* [3 vertices] */
  /* [2 vertices] where each vertex lies in a picture that turns like the eye sees it, or NULL. Only ever a filter. */
  const double *picture;
  double picture_error; /* of each coordinate of the picture */
  /* Triangles may lie anywhere around the eye: half-lines, not lines, are compared. Not so if a plane through the eye
   * has all triangles on one side of it. */
  bool around_eye;
} sort_scene;

/* A boundary face of a pair: corners counter-clockwise seen from outside its cell. */
typedef struct sort_face {
  const uint32_t *corners;
  const sort_face_plane *plane;
} sort_face;

/* What is known of a pair of which the leaving face is nearer. Heights are the entering face's above the leaving face's
 * plane, in units of that plane's normal: along a ray that leaves through it they grow. */
typedef struct sort_cover {
  double hidden;          /* given: pairs of which the entering face lies higher need no arc and are not looked at */
  double lowest, highest; /* bounds of the entering face's heights */
  bool is_behind;         /* no ray that meets both meets the entering face first */
  uint32_t crossing; /* bit k: the entering face's edge from corner k to the next may cross the leaving face, as the eye
                        sees them. Two faces that share an edge and both overlap the leaving face agree about it. */
} sort_cover;

/* Does a ray from the eye leave a cell through face `leaving` and enter another one through `entering` after that, or
 * in the same point? The eye lies strictly behind `leaving` and strictly before `entering`. Rays through edges alone do
 * not count. cover: NULL, or filled if so; false if it says that the pair needs no arc.
 * Errors: none. Threads: any. Cost: some 50 ns, some 10 us where exact arithmetic must decide it all. */
bool sort_leaves_before(const sort_scene *scene, sort_face leaving, sort_face entering, sort_cover *cover);

#endif
