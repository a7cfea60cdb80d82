/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of the boundary in floating point, to find which faces may cover each other. Private to sort/. */
#ifndef CELLIST_SORT_PICTURE_H
#define CELLIST_SORT_PICTURE_H

#include "../view.h"
#include "boundary.h"

/* Where a face may lie in a picture: at least its extent there; low > high: nowhere. Depths grow along each
 * ray, and are off by one rounding of a difference at most where depth_error does not say. */
typedef struct sort_box {
  double low[2], high[2], nearest, farthest;
} sort_box;

/* Projects count vertices (listed by id) onto one plane, if one through the eye has them all well on one side of it
 * (always so in a parallel view). picture: 2 vertex_count doubles, and depths: vertex_count, filled for these; *error
 * bounds each coordinate's error, up to a projective map that keeps turns, and *depth_error the depths'. Returns false
 * if the eye is among the vertices. */
bool sort_picture_project(const sort_boundary *boundary, const uint32_t *vertices, size_t count, const sort_eye *eye,
                          double *picture, double *depths, double *error, double *depth_error);

/* The box of a triangle in the picture above. */
sort_box sort_picture_box(const double *picture, const double *depths, double error, double depth_error,
                          const uint32_t corners[3]);

/* The box of a triangle in one of the six pictures on the sides of a cube around the eye, -1..1 each way. */
enum { SORT_CUBE_SIDES = 6 };
sort_box sort_cube_box(const double eye[3], const double *positions, const uint32_t corners[3], int side);

#endif
