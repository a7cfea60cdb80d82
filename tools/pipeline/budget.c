/* SPDX-License-Identifier: BSD-3-Clause
 * Budget: the cheapest way to draw that is close enough, or the closest that is fast enough, by the constants of
 * costs.c. */
#include "costs.h"
#include "pipeline.h"

/* Whether a setting draws what the optics ask for, as the one that was measured. */
static bool draws(const draw_cost *cost, const cellist_pipeline *pipeline) {
  const cellist_optics *optics = &pipeline->desc.optics.model;
  const bool is_usual = optics->model == CELLIST_MODEL_EMISSION_ABSORPTION || optics->model == CELLIST_MODEL_ABSORPTION;
  const bool is_lit = optics->light.enabled && optics->model != CELLIST_MODEL_ABSORPTION;
#ifndef CELLIST_HAS_GL
  if (cost->renderer == CELLIST_RENDERER_FACES) return false;
#endif
  if (cost->samples > 1 && optics->light.cell_gradients) return false;
  if (cost->samples > 0 && optics->sample_count > 0 && cost->samples != optics->sample_count) return false;
  return cost->is_lit == is_lit && (is_usual || cost->draws_every_model) &&
         (cost->draws_narrow_peaks || !pipeline_is_narrow(pipeline));
}

/* One gradient a cell is lit as exactly as no light is drawn. */
static double error_of(const draw_cost *cost, const cellist_pipeline *pipeline) {
  return pipeline->desc.optics.model.light.cell_gradients ? draw_cost_of(cost->renderer, cost->precision)->error
                                                          : cost->error;
}

cellist_result pipeline_choose_budget(cellist_pipeline *pipeline, const draw_counts *counts) {
  cellist_pipeline_desc *desc = &pipeline->desc;
  const unsigned threads = cellist_context_worker_count(pipeline->context);
  const draw_cost *best = NULL, *closest = NULL, *fastest = NULL;
  double best_time = 0, fastest_time = 0;
  size_t count;
  const draw_cost *costs = draw_costs(&count);
  for (const draw_cost *cost = costs; cost < costs + count; cost++) {
    if (!draws(cost, pipeline)) continue;
    const double time = draw_cost_seconds(cost, counts, threads), error = error_of(cost, pipeline);
    if (closest == NULL || error < error_of(closest, pipeline)) closest = cost;
    if (fastest == NULL || time < fastest_time) {
      fastest = cost;
      fastest_time = time;
    }
    if (desc->error > 0 ? error > desc->error : time > desc->seconds) continue;
    if (best != NULL && (desc->error > 0 ? time >= best_time : error >= error_of(best, pipeline))) continue;
    best = cost;
    best_time = time;
  }
  if (best == NULL && desc->error > 0)
    return cellist_fail(pipeline->context, CELLIST_ERROR_UNSUPPORTED,
                        "no setting is closer than %g (%s); an error of %g was asked for", error_of(closest, pipeline),
                        closest->name, desc->error);
  if (best == NULL) {
    best = fastest;
    cellist_log(pipeline->context, CELLIST_LOG_WARNING,
                "even the fastest setting (%s) is expected to take %.2g s a frame", best->name, fastest_time);
  }
  pipeline->renderer = best->renderer;
  pipeline->budget = (cellist_budget){best->name, error_of(best, pipeline), draw_cost_seconds(best, counts, threads)};
  desc->precision = best->precision;
  desc->framebuffer = CELLIST_FRAMEBUFFER_32F;
  desc->optics.model.integration = CELLIST_INTEGRATION_EXACT;
  if (best->samples > 0) desc->optics.model.sample_count = best->samples;
  return CELLIST_SUCCESS;
}
