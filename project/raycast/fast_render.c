/* SPDX-License-Identifier: BSD-3-Clause
 * Fast render: the public call's `fast` precision. Rays that rounding lost (stats->retry_count) are cast by
 * `reference`, one by one: they are few, and whatever made them hard is decided exactly there. */
#include <string.h>

#include "fast.h"
#include "outputs.h"

static fast_layout layout_of(uint32_t tets) {
  return tets == 32 ? FAST_TET32 : tets == 20 ? FAST_TET20 : tets == 16 ? FAST_TET16 : FAST_RANKED;
}

/* Where a picture goes, and what stands behind it. */
struct picture {
  pixel_outputs outputs;
  surface_layer layer; /* {0}: nothing */
};

static void put_layer_behind(const surface_layer *layer, size_t at, shade_pixel *pixel) {
  if (layer->depth == NULL || !(layer->depth[at] < INFINITY)) return;
  for (size_t k = 0; k < 3; k++) pixel->colour[k] += pixel->transmittance * (double)layer->colours[3 * at + k];
  pixel->transmittance = 0;
  pixel->alpha = 1;
  pixel->z = fmin(pixel->z, layer->depth[at]);
  pixel->z_back = layer->depth[at];
}

/* A pixel's values as floats, in the order of picture->planes. */
enum { PLANES = 9 };

static const float NOTHING[PLANES] = {0, 0, 0, 0, INFINITY, 0, 1, 0, 0};

static void values_of(const fast_scene *scene, const fast_pixel *pixel, float value[PLANES]) {
  const fast_light *light = &pixel->light;
  const bool is_seen = pixel->z_back >= pixel->z;
  value[0] = light->colour[0];
  value[1] = light->colour[1];
  value[2] = light->colour[2];
  value[3] = light->alpha < 1 ? light->alpha : 1;
  value[4] = is_seen ? (float)(scene->unit * pixel->z + scene->depth_offset) : INFINITY;
  value[5] = is_seen ? (float)(scene->unit * pixel->z_back + scene->depth_offset) : 0;
  value[6] = light->transmittance > 0 ? light->transmittance : 0;
  value[7] = (float)pixel->cell_count;
  value[8] = (float)pixel->piece_count;
}

/* To an image alone, with nothing behind what is drawn. */
static void store_planes(const struct picture *picture, const fast_scene *scene, const fast_tile *tile) {
  const pixel_outputs *outputs = &picture->outputs;
  float *const planes[PLANES] = {outputs->colour[0],     outputs->colour[1], outputs->colour[2],
                                 outputs->alpha,         outputs->z,         outputs->z_back,
                                 outputs->transmittance, outputs->cells,     outputs->segments};
  float value[PLANES][FAST_TILE]; /* of a row; of all rows where the tile is empty */
  for (uint32_t y = 0; y < tile->height; y++) {
    const size_t row = (size_t)(tile->top + y) * scene->width + tile->left;
    for (uint32_t x = 0; x < tile->width && (y == 0 || tile->entry_count > 0); x++) {
      const uint32_t at = y * FAST_TILE + x;
      float found[PLANES];
      if (tile->first[at] != CELLIST_NONE) values_of(scene, &tile->pixels[at], found);
      const float *from = tile->first[at] != CELLIST_NONE ? found : NOTHING;
      for (int k = 0; k < PLANES; k++) value[k][x] = from[k];
    }
    for (int k = 0; k < PLANES; k++)
      if (planes[k] != NULL) memcpy(planes[k] + row, value[k], tile->width * sizeof *planes[k]);
  }
}

static void store_all(const struct picture *picture, const fast_scene *scene, const fast_tile *tile) {
  for (uint32_t y = 0; y < tile->height; y++)
    for (uint32_t x = 0; x < tile->width; x++) {
      const uint32_t at = y * FAST_TILE + x;
      shade_pixel stored = {.transmittance = 1, .z = INFINITY};
      uint32_t cell_count = 0;
      if (tile->first[at] != CELLIST_NONE) {
        const fast_pixel *pixel = &tile->pixels[at];
        for (int k = 0; k < 3; k++) stored.colour[k] = pixel->light.colour[k];
        stored.transmittance = fmax(pixel->light.transmittance, 0);
        stored.alpha = fmin(pixel->light.alpha, 1);
        if (pixel->z_back >= pixel->z) {
          stored.z = scene->unit * pixel->z + scene->depth_offset;
          stored.z_back = scene->unit * pixel->z_back + scene->depth_offset;
        }
        stored.segment_count = pixel->piece_count;
        cell_count = pixel->cell_count;
      }
      const size_t pixel_at = (size_t)(tile->top + y) * scene->width + tile->left + x;
      put_layer_behind(&picture->layer, pixel_at, &stored);
      outputs_store(&picture->outputs, pixel_at, &stored, cell_count);
    }
}

static void store_tile(void *user, const fast_scene *scene, const fast_tile *tile) {
  const struct picture *picture = user;
  const cellist_raycast_output *arrays = &picture->outputs.arrays;
  const bool has_arrays = arrays->rgba != NULL || arrays->transmittance != NULL || arrays->z != NULL ||
                          arrays->z_back != NULL || arrays->cell_count != NULL || arrays->segment_count != NULL;
  if (has_arrays || picture->layer.depth != NULL)
    store_all(picture, scene, tile);
  else
    store_planes(picture, scene, tile);
}

/* With the surface cast. */
static cellist_result draw_picture(cellist_raycaster *caster, const cellist_frame *frame,
                                   const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                   const cellist_raycast_output *output, struct picture *picture,
                                   cellist_raycast_stats *stats) {
  const pixel_outputs *outputs = &picture->outputs;
  const fast_draw_desc draw_desc = {
      .absorption_only = desc->optics.model == CELLIST_MODEL_ABSORPTION,
      .wants_depth = output->z != NULL || output->z_back != NULL || outputs->z != NULL || outputs->z_back != NULL,
      .layer = picture->layer.depth != NULL ? &picture->layer : NULL};
  fast_stats found;
  const cellist_result result =
      fast_caster_draw(caster->fast, frame, transfer, &draw_desc, store_tile, picture, &found);
  if (result != CELLIST_SUCCESS) return result;
  *stats = (cellist_raycast_stats){.error_bound = INFINITY,
                                   .ray_count = found.ray_count,
                                   .entry_count = found.entry_count,
                                   .step_count = found.step_count,
                                   .segment_count = found.piece_count,
                                   .retry_count = found.retry_count,
                                   .fold_ray_count = found.fold_ray_count};
  if (found.retry_count == 0) return CELLIST_SUCCESS;
  return raycaster_recast_pixels(caster, frame, transfer, desc, output, found.retries, found.retry_count);
}

cellist_result raycaster_render_fast(cellist_raycaster *caster, const cellist_frame *frame,
                                     const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                     const cellist_raycast_output *output, cellist_raycast_stats *stats) {
  cellist_context *context = caster->context;
  const cellist_optics *optics = &desc->optics;
  if (optics->model != CELLIST_MODEL_EMISSION_ABSORPTION && optics->model != CELLIST_MODEL_ABSORPTION)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED,
                        "precision fast draws emission and absorption, or absorption; take precision reference");
  if (optics->light.enabled)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED,
                        "precision fast draws without light; take precision reference");
  if (cellist_transfer_is_narrow(transfer, caster->scalar->minimum, caster->scalar->maximum))
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED,
                        "peaks of the transfer function are too narrow for precision fast; take precision reference");
  if ((uint64_t)frame->width * frame->height > UINT32_MAX)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "an image of %ux%u is too large for precision fast",
                        frame->width, frame->height);
  if (caster->fast == NULL) {
    const cellist_result result = fast_caster_create(context, cellist_mesh_get_arrays(caster->mesh), caster->scalar,
                                                     layout_of(caster->desc.tets), &caster->fast);
    if (result != CELLIST_SUCCESS) return result;
  }
  struct picture picture = {.outputs = outputs_of(output)};
  cellist_result result = surface_layer_make(context, desc->surface, frame, &optics->light, &picture.layer);
  if (result == CELLIST_SUCCESS) result = draw_picture(caster, frame, transfer, desc, output, &picture, stats);
  surface_layer_release(context, &picture.layer);
  return result;
}
