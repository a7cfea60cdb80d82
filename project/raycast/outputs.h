/* SPDX-License-Identifier: BSD-3-Clause
 * Outputs: where a pixel's values go, the same for both precisions. Private to the ray caster. */
#ifndef CELLIST_RAYCAST_OUTPUTS_H
#define CELLIST_RAYCAST_OUTPUTS_H

#include <cellist/raycast.h>

#include "reference_shade.h"

/* The caller's arrays, and the image's planes; NULL: the image has no such channel. */
typedef struct pixel_outputs {
  cellist_raycast_output arrays;
  float *colour[3], *alpha, *z, *z_back, *transmittance, *cells, *segments;
} pixel_outputs;

pixel_outputs outputs_of(const cellist_raycast_output *output);

/* at: y * width + x. Threads: any, for different pixels. */
void outputs_store(const pixel_outputs *outputs, size_t at, const shade_pixel *pixel, uint32_t cell_count);

#endif
