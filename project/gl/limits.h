/* SPDX-License-Identifier: BSD-3-Clause
 * Which part of each pixel's ray is seen, as a texture that the fragment programs of cells read. Private. */
#ifndef CELLIST_GL_LIMITS_H
#define CELLIST_GL_LIMITS_H

#include <cellist/view.h>
#include <surface/layer.h>

#include "api.h"

typedef struct gl_limits {
  GLuint texture; /* 0: none made yet */
  GLuint behind;  /* the same once more, for a surface to be drawn into (surface.c) */
  uint32_t width, height;
} gl_limits;

/* Works out the limits of every pixel, in double precision, and leaves them in the texture, bound to GL_TEXTURE_2D of
 * the active unit: red the near one, green the far one (a clip plane or the layer), both as 1 / depth (parallel:
 * depth), in the unit of lengths. twice: the second texture as well. Fails with OUT_OF_MEMORY. Cost: linear in pixels
 * times clip planes; 8 bytes a pixel are sent. */
cellist_result gl_limits_make(cellist_context *context, const gl_api *api, const cellist_frame *frame, double unit,
                              const surface_layer *layer, bool twice, gl_limits *limits);
void gl_limits_release(const gl_api *api, gl_limits *limits);

#endif
