/* SPDX-License-Identifier: BSD-3-Clause
 * Light on cells of one gradient each: two numbers a cell. Private. */
#ifndef CELLIST_GL_LIGHT_H
#define CELLIST_GL_LIGHT_H

#include <cellist/optics.h>
#include <cellist/view.h>

/* A frame's light. */
typedef struct gl_light {
  cellist_light light;
  bool enabled, on_surfaces; /* on_surfaces: the gradient's direction alone counts */
  double towards[3], halfway[3];
} gl_light;

gl_light gl_light_of_frame(const cellist_optics *optics, const cellist_frame *frame);

/* What a colour is multiplied by, and the highlight that is added to it, in a tet with these corners and scalars. */
void gl_light_of_cell(const gl_light *light, const double *const corners[4], const double scalars[4], float out[2]);

#endif
