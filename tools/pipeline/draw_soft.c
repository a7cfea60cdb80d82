/* SPDX-License-Identifier: BSD-3-Clause
 * Soft: pictures by the projector that needs no OpenGL. */
#include "pipeline.h"

cellist_result pipeline_make_soft(cellist_pipeline *pipeline) {
  const cellist_result result = pipeline_make_order(pipeline);
  if (result != CELLIST_SUCCESS) return result;
  return cellist_soft_create(pipeline->context, pipeline->drawn, pipeline->drawn_scalar, NULL, &pipeline->soft);
}

cellist_result pipeline_draw_soft(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                  cellist_pipeline_stats *stats) {
  cellist_result result = pipeline_sort(pipeline, frame, stats);
  if (result != CELLIST_SUCCESS) return result;
  cellist_soft_group *groups = cellist_allocate(pipeline->context, pipeline->group_count, sizeof *groups);
  if (groups == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < pipeline->group_count; i++)
    groups[i] = (cellist_soft_group){pipeline->groups[i].begin, pipeline->groups[i].count};
  const cellist_soft_settings settings = {.optics = pipeline->desc.optics.model,
                                          .surface = pipeline->surface,
                                          .order = pipeline->order,
                                          .order_count = pipeline->order_count,
                                          .groups = groups,
                                          .group_count = pipeline->group_count};
  cellist_soft_stats drawn;
  const double begin = clock_seconds();
  result = cellist_soft_render(pipeline->soft, frame, &pipeline->transfer, &settings, image, &drawn);
  cellist_deallocate(pipeline->context, groups);
  if (result != CELLIST_SUCCESS) return result;
  stats->draw_seconds = clock_seconds() - begin;
  stats->renderer = "soft";
  stats->method = "exact";
  stats->precision = "fast";
  stats->backend = "none";
  stats->fragments = drawn.fragment_count;
  pipeline_leave_out(stats, "tables", "exact for a piecewise linear transfer function");
  return CELLIST_SUCCESS;
}
