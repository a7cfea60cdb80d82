/* SPDX-License-Identifier: BSD-3-Clause
 * Cast: pictures by the ray caster, which needs neither an order nor OpenGL. */
#include "pipeline.h"

cellist_result pipeline_make_cast(cellist_pipeline *pipeline) {
  const cellist_raycaster_desc desc = {.tets = pipeline->desc.tets};
  return cellist_raycaster_create(pipeline->context, pipeline->drawn, pipeline->drawn_scalar, &desc, &pipeline->caster);
}

cellist_result pipeline_draw_cast(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                  cellist_pipeline_stats *stats) {
  cellist_raycast_desc desc = {
      .precision = pipeline->desc.precision, .optics = pipeline->desc.optics.model, .surface = pipeline->surface};
  const cellist_raycast_output output = {.image = image};
  cellist_raycast_stats cast;
  const double begin = clock_seconds();
  cellist_result result = cellist_raycaster_render(pipeline->caster, frame, &pipeline->transfer, &desc, &output, &cast);
  if (result == CELLIST_ERROR_UNSUPPORTED && desc.precision == CELLIST_PRECISION_FAST) {
    cellist_context_take_error(pipeline->context);
    desc.precision = CELLIST_PRECISION_REFERENCE; /* draws everything */
    result = cellist_raycaster_render(pipeline->caster, frame, &pipeline->transfer, &desc, &output, &cast);
  }
  if (result != CELLIST_SUCCESS) return result;
  stats->draw_seconds = clock_seconds() - begin;
  stats->renderer = "cast";
  stats->method = "exact";
  stats->precision = desc.precision == CELLIST_PRECISION_FAST ? "fast" : "reference";
  stats->error_bound = cast.error_bound;
  stats->backend = "none";
  stats->order = "none";
  stats->fragments = cast.step_count;
  pipeline_leave_out(stats, "exterior", "the ray caster crosses gaps by its own hierarchy");
  pipeline_leave_out(stats, "sort", "the ray caster needs no order");
  pipeline_leave_out(stats, "tables", "exact for a piecewise linear transfer function");
  if (cast.fold_ray_count > 0)
    cellist_log(pipeline->context, CELLIST_LOG_WARNING,
                "cells overlap along %llu rays: the mesh is flawed there, and the picture arbitrary",
                (unsigned long long)cast.fold_ray_count);
  return CELLIST_SUCCESS;
}
