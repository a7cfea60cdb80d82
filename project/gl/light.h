/* SPDX-License-Identifier: BSD-3-Clause
 * Light on cells: two numbers a cell of one gradient, twelve a cell of gradients at its corners. Private. */
#ifndef CELLIST_GL_LIGHT_H
#define CELLIST_GL_LIGHT_H

#include <cellist/optics.h>
#include <cellist/view.h>

enum { GL_LIGHT_FLOATS = 12 }; /* three texels a cell: x, y, z as a field each, see cell.glsl */

/* A frame's light. */
typedef struct gl_light {
  cellist_light light;
  bool enabled, on_surfaces; /* on_surfaces: the gradient's direction alone counts */
  double towards[3], halfway[3];
  const double *gradients; /* [3 points] or NULL: one gradient a cell */
} gl_light;

gl_light gl_light_of_frame(const cellist_optics *optics, const cellist_frame *frame);

/* What a colour is multiplied by, and the highlight that is added to it, in a tet with these corners and scalars. */
void gl_light_of_cell(const gl_light *light, const double *const corners[4], const double scalars[4], float out[2]);

/* The gradients at these points in the light's unit. */
void gl_light_of_points(const gl_light *light, const uint32_t points[4], double out[4][3]);

#endif
