/* SPDX-License-Identifier: BSD-3-Clause
 * Outputs: see outputs.h. */
#include "outputs.h"

pixel_outputs outputs_of(const cellist_raycast_output *output) {
  pixel_outputs outputs = {.arrays = *output};
  const cellist_image *image = output->image;
  if (image == NULL) return outputs;
  static const char *const COLOUR[3] = {"R", "G", "B"};
  for (int k = 0; k < 3; k++) outputs.colour[k] = cellist_image_channel(image, COLOUR[k]);
  outputs.alpha = cellist_image_channel(image, "A");
  outputs.z = cellist_image_channel(image, "Z");
  outputs.z_back = cellist_image_channel(image, "ZBack");
  outputs.transmittance = cellist_image_channel(image, "transmittance.Y");
  outputs.cells = cellist_image_channel(image, "cells.Y");
  outputs.segments = cellist_image_channel(image, "segments.Y");
  return outputs;
}

static void put(float *plane, size_t at, double value) {
  if (plane != NULL) plane[at] = (float)value;
}

void outputs_store(const pixel_outputs *outputs, size_t at, const shade_pixel *pixel, uint32_t cell_count) {
  const cellist_raycast_output *arrays = &outputs->arrays;
  for (int k = 0; k < 3; k++) {
    if (arrays->rgba != NULL) arrays->rgba[4 * at + (size_t)k] = pixel->colour[k];
    put(outputs->colour[k], at, pixel->colour[k]);
  }
  if (arrays->rgba != NULL) arrays->rgba[4 * at + 3] = pixel->alpha;
  if (arrays->transmittance != NULL) arrays->transmittance[at] = pixel->transmittance;
  if (arrays->z != NULL) arrays->z[at] = pixel->z;
  if (arrays->z_back != NULL) arrays->z_back[at] = pixel->z_back;
  if (arrays->cell_count != NULL) arrays->cell_count[at] = cell_count;
  if (arrays->segment_count != NULL) arrays->segment_count[at] = pixel->segment_count;
  put(outputs->alpha, at, pixel->alpha);
  put(outputs->z, at, pixel->z);
  put(outputs->z_back, at, pixel->z_back);
  put(outputs->transmittance, at, pixel->transmittance);
  put(outputs->cells, at, cell_count);
  put(outputs->segments, at, pixel->segment_count);
}
