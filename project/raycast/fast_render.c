/* SPDX-License-Identifier: BSD-3-Clause
 * Fast render: the public call's `fast` precision. Rays that rounding lost (stats->retry_count) are cast by
 * `reference`, one by one: they are few, and whatever made them hard is decided exactly there. */
#include "fast.h"
#include "outputs.h"

static fast_layout layout_of(uint32_t tets) {
  return tets == 32 ? FAST_TET32 : tets == 20 ? FAST_TET20 : tets == 16 ? FAST_TET16 : FAST_RANKED;
}

static void store_tile(void *user, const fast_scene *scene, const fast_tile *tile) {
  const pixel_outputs *outputs = user;
  for (uint32_t y = 0; y < tile->height; y++)
    for (uint32_t x = 0; x < tile->width; x++) {
      const uint32_t at = y * FAST_TILE + x;
      shade_pixel stored = {.transmittance = 1, .z = INFINITY};
      uint32_t cell_count = 0;
      if (tile->first[at] != CELLIST_NONE) {
        const fast_pixel *pixel = &tile->pixels[at];
        for (int k = 0; k < 3; k++) stored.colour[k] = pixel->light.colour[k];
        stored.transmittance = fmax(pixel->light.transmittance, 0);
        stored.alpha = 1 - stored.transmittance;
        if (pixel->z_back >= pixel->z) {
          stored.z = scene->unit * pixel->z + scene->depth_offset;
          stored.z_back = scene->unit * pixel->z_back + scene->depth_offset;
        }
        stored.segment_count = pixel->piece_count;
        cell_count = pixel->cell_count;
      }
      outputs_store(outputs, (size_t)(tile->top + y) * scene->width + tile->left + x, &stored, cell_count);
    }
}

cellist_result raycaster_render_fast(cellist_raycaster *caster, const cellist_frame *frame,
                                     const cellist_transfer *transfer, const cellist_optics *optics,
                                     const cellist_raycast_output *output, cellist_raycast_stats *stats) {
  cellist_context *context = caster->context;
  if (optics->model != CELLIST_MODEL_EMISSION_ABSORPTION && optics->model != CELLIST_MODEL_ABSORPTION)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED,
                        "precision fast draws emission and absorption, or absorption; take precision reference");
  if (optics->light.enabled)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED,
                        "precision fast draws without light; take precision reference");
  if ((uint64_t)frame->width * frame->height > UINT32_MAX)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "an image of %ux%u is too large for precision fast",
                        frame->width, frame->height);
  if (caster->fast == NULL) {
    const cellist_result result = fast_caster_create(context, cellist_mesh_get_arrays(caster->mesh), caster->scalar,
                                                     layout_of(caster->desc.tets), &caster->fast);
    if (result != CELLIST_SUCCESS) return result;
  }
  pixel_outputs outputs = outputs_of(output);
  const fast_draw_desc desc = {
      .absorption_only = optics->model == CELLIST_MODEL_ABSORPTION,
      .wants_depth = output->z != NULL || output->z_back != NULL || outputs.z != NULL || outputs.z_back != NULL};
  fast_stats found;
  cellist_result result = fast_caster_draw(caster->fast, frame, transfer, &desc, store_tile, &outputs, &found);
  if (result != CELLIST_SUCCESS) return result;
  *stats = (cellist_raycast_stats){.error_bound = INFINITY,
                                   .ray_count = found.ray_count,
                                   .entry_count = found.entry_count,
                                   .step_count = found.step_count,
                                   .segment_count = found.piece_count,
                                   .retry_count = found.retry_count,
                                   .fold_ray_count = found.fold_ray_count};
  if (found.retry_count == 0) return CELLIST_SUCCESS;
  return raycaster_recast_pixels(caster, frame, transfer, optics, output, found.retries, found.retry_count);
}
