/* SPDX-License-Identifier: BSD-3-Clause
 * The eye, and on which side of a plane it lies. Private to sort/. */
#ifndef CELLIST_SORT_VIEW_H
#define CELLIST_SORT_VIEW_H

#include <cellist/predicates.h>
#include <cellist/sort.h>

/* A view's eye as a homogeneous point: a parallel view's eye lies at infinity, opposite to where it looks. */
typedef struct sort_eye {
  double at[3]; /* the eye, or the direction towards it */
  bool parallel;
} sort_eye;

static inline sort_eye sort_eye_of(const cellist_viewpoint *viewpoint) {
  sort_eye eye = {{0, 0, 0}, viewpoint->parallel};
  for (int k = 0; k < 3; k++) eye.at[k] = viewpoint->parallel ? -viewpoint->position[k] : viewpoint->position[k];
  return eye;
}

/* 1: seen from the eye, a, b, c turn counter-clockwise; -1: clockwise; 0: the eye lies in their plane. Exact. */
static inline int sort_eye_side(const sort_eye *eye, const double *a, const double *b, const double *c) {
  return eye->parallel ? cellist_orient3d_direction(a, b, c, eye->at) : cellist_orient3d(a, b, c, eye->at);
}

/* The corners of the face opposite to corner k, counter-clockwise seen from outside a positive tet. */
static const uint8_t SORT_TET_FACE[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

#endif
