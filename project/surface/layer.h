/* SPDX-License-Identifier: BSD-3-Clause
 * Layer: what of a surface each pixel of a frame sees, for renderers that draw on the processor. Private to project/.
 */
#ifndef CELLIST_SURFACE_LAYER_H
#define CELLIST_SURFACE_LAYER_H

#include <cellist/optics.h>
#include <cellist/surface.h>
#include <cellist/view.h>
#include <math.h>

/* The light that falls on surfaces in a frame. */
typedef struct surface_light {
  double towards[3], halfway[3]; /* unit vectors; halfway is 0 if the light stands exactly behind the scene */
  double ambient, diffuse, specular, shininess;
} surface_light;

CELLIST_API surface_light surface_light_of(const cellist_light *light, const cellist_frame *frame);

typedef struct surface_layer {
  uint32_t width, height;
  double *depth;  /* [width height] along frame->forward, infinity where nothing is seen; row 0 is the top */
  float *colours; /* [3 width height] linear, lit */
  double margin;  /* see surface_layer_limit: a share of the depth; in parallel views a length */
  bool parallel;
} surface_layer;

/* Casts one ray a pixel within what the frame's near and clip planes leave of it. surface NULL: a layer of {0}.
 * Errors: OUT_OF_MEMORY. Threads: the context's workers share the rows. Cost: logarithmic in triangles, a pixel. */
CELLIST_API cellist_result surface_layer_make(cellist_context *context, const cellist_surface *surface,
                                              const cellist_frame *frame, const cellist_light *light,
                                              surface_layer *layer);
CELLIST_API void surface_layer_release(cellist_context *context, surface_layer *layer);

/* A number that differs for surfaces that differ (but for one pair in 2^64 or so). */
CELLIST_API uint64_t surface_checksum(const cellist_surface *surface);

/* Where a pixel's ray ends: nearer than the surface by more than renderers in single precision may be wrong, so that of
 * a mesh whose own boundary is shown nothing stands before it. */
static inline double surface_layer_limit(const surface_layer *layer, size_t at) {
  return layer->parallel ? layer->depth[at] - layer->margin : layer->depth[at] * (1 - layer->margin);
}

/* Puts the layer's pixel `at` behind what a pixel has gathered (premultiplied). Nothing
 * changes where the layer shows nothing. */
static inline void surface_layer_put_behind(const surface_layer *layer, size_t at, float colour[3], float *alpha,
                                            float *z, float *z_back) {
  if (layer->depth == NULL || !(layer->depth[at] < HUGE_VAL)) return;
  const float through = 1 - *alpha, depth = (float)layer->depth[at];
  for (size_t k = 0; k < 3; k++) colour[k] += through * layer->colours[3 * at + k];
  *alpha = 1;
  if (!(*z <= depth)) *z = depth;
  *z_back = depth;
}

#endif
