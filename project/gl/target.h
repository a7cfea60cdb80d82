/* SPDX-License-Identifier: BSD-3-Clause
 * The framebuffer that cells are blended into, and the way from it into an image. Private. */
#ifndef CELLIST_GL_TARGET_H
#define CELLIST_GL_TARGET_H

#include <cellist/gl.h>

#include <surface/layer.h>
#include "api.h"
#include "intervals.h"

typedef struct gl_target {
  GLuint framebuffer, colour, depth; /* depth holds -front, back; 0 if it is not wanted */
  uint32_t width, height;
  cellist_framebuffer format;
  bool with_depth;
  float *pixels; /* [4 width height] read back; NULL until then */
} gl_target;

/* Makes the target current, of this size and format, empty, with blending from far to near, or (maximum) of the
 * largest. What fits is kept from the last frame. Fails with UNSUPPORTED (too large for this OpenGL) or GRAPHICS. */
cellist_result gl_target_begin(cellist_context *context, const gl_api *api, gl_target *target, uint32_t width,
                               uint32_t height, cellist_framebuffer format, bool with_depth, bool maximum);

/* Makes a target that was begun current again, as it is. */
void gl_target_use(const gl_api *api, const gl_target *target, bool maximum);

/* Copies what was drawn into the image's channels of the names R G B A, Z, ZBack; with a transfer function, the colours
 * of the scaled scalars that stand in red where alpha is not 0. unit: of depths. The layer is put behind it. Fails with
 * OUT_OF_MEMORY.
 */
cellist_result gl_target_read(cellist_context *context, const gl_api *api, gl_target *target,
                              const cellist_transfer *transfer, gl_scale scale, double unit, const surface_layer *layer,
                              cellist_image *image);

/* api: NULL releases memory alone. */
void gl_target_release(cellist_context *context, const gl_api *api, gl_target *target);

#endif
