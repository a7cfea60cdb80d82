/* SPDX-License-Identifier: BSD-3-Clause
 * A cell's footprint: a convex polygon of the picture that surely covers every pixel on which the cell is seen, and
 * few others. Private. */
#ifndef CELLIST_GL_FOOTPRINT_H
#define CELLIST_GL_FOOTPRINT_H

#include <stdbool.h>
#include <stdint.h>

enum { GL_FOOTPRINT_CORNERS = 4 };

/* Corners further out than this many half pictures are wild: the rasteriser's fixed-point numbers end somewhere. */
#define GL_FAR_OUT 8.0
/* 1 + cosine of the turn at a corner: below, growing would move the corner by more than ten margins. */
#define GL_SHARPEST_TURN 0.02

/* By the bits of a tet's back faces, the number of its footprint's corners and which they are, around it. */
extern const uint8_t GL_FOOTPRINT_RINGS[16][5];

/* Corners of cells are given in pixels from the picture's centre times depth (right, up), and depth; parallel: not
 * times depth. */
typedef struct gl_picture {
  double half_width, half_height; /* in pixels */
  double least_depth;             /* nothing before it is drawn, above 0 */
  double margin;                  /* pixels by which the rasteriser may move a corner */
  bool parallel;
} gl_picture;

/* Whether a corner lies so near, behind the eye or far out that it has no useful place in the picture. */
bool gl_corner_is_wild(const gl_picture *picture, const double corner[3]);

/* The footprint of a tet whose back faces are the bits of back (bit k: opposite to corner k), none of whose corners is
 * wild: three or four points, in pixels from the centre. Returns their number. */
int gl_footprint_of_tet(const gl_picture *picture, const double *const corners[4], unsigned back,
                        double out[GL_FOOTPRINT_CORNERS][2]);

/* The same for a tet with wild corners: the rectangle around what is left of its back faces; 0 if nothing is. */
int gl_footprint_of_wild_tet(const gl_picture *picture, const double *const corners[4], unsigned back,
                             double out[GL_FOOTPRINT_CORNERS][2]);

#endif
