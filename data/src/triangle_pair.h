/* SPDX-License-Identifier: BSD-3-Clause
 * Triangle pair: how two triangles in space meet, exactly. Private to data/. */
#ifndef CELLIST_TRIANGLE_PAIR_H
#define CELLIST_TRIANGLE_PAIR_H

#include <stdint.h>

/* In the order of gravity. */
typedef enum pair_contact {
  PAIR_APART, /* nothing in common but the points or the edge that they share by id */
  PAIR_TOUCH, /* common points, but none inside both */
  PAIR_MATCH, /* the same three ids, seen from opposite sides */
  PAIR_FACE,  /* in one plane, seen from opposite sides, with an area in common */
  PAIR_CROSS  /* points inside both: they run through each other, or lie on each other seen from the same side */
} pair_contact;

/* A triangle that is seen counter-clockwise. Equal ids mean equal corners; different ids may lie in one place. */
typedef struct pair_triangle {
  uint32_t id[3];
  const double *corner[3];
} pair_triangle;

/* Triangles without area are PAIR_APART from all. */
pair_contact pair_classify(const pair_triangle *a, const pair_triangle *b);

#endif
