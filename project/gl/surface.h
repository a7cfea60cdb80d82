/* SPDX-License-Identifier: BSD-3-Clause
 * The opaque surface of a picture, drawn with a depth buffer before the cells, which then end where it stands.
 * Private. */
#ifndef CELLIST_GL_SURFACE_H
#define CELLIST_GL_SURFACE_H

#include <cellist/surface.h>
#include <surface/layer.h>

#include "api.h"
#include "limits.h"

/* What is kept from frame to frame. */
typedef struct gl_surface {
  bool sent; /* the buffers hold the surface with this checksum */
  uint64_t checksum;
  double middle[3], unit;         /* points in the buffer are (p - middle) / unit */
  GLuint buffers[4], textures[4]; /* points, normals, colours, triangles */
  GLuint framebuffer, colour, depth;
  GLuint programs[2]; /* perspective, parallel */
  uint32_t width, height;
} gl_surface;

/* Whether this OpenGL's buffers hold such a surface. */
bool gl_surface_fits(const gl_api *api, const cellist_surface *surface);

/* Draws the surface within the frame's limits, which are in limits->texture, and replaces them by limits that end at
 * the surface; reads what was drawn into the layer, which is the caller's. length_unit: that of the limits. vertices:
 * an array without attributes. The framebuffer, the program and the textures of the units from first_unit to first_unit
 * + 4 are others afterwards. Fails with GRAPHICS or OUT_OF_MEMORY. Cost: linear in triangles and pixels; an unchanged
 * surface is not sent again.
 */
cellist_result gl_surface_draw(cellist_context *context, const gl_api *api, const cellist_surface *surface,
                               const cellist_frame *frame, double length_unit, const cellist_light *light,
                               GLuint vertices, unsigned first_unit, gl_limits *limits, gl_surface *kept,
                               surface_layer *layer);
void gl_surface_release(const gl_api *api, gl_surface *kept);

#endif
