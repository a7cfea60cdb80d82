/* SPDX-License-Identifier: BSD-3-Clause
 * Budget: the cheapest way to draw that is close enough, or the closest that is fast enough, by the constants of
 * costs.c. */
#include "costs.h"

/* Whether a setting draws what the optics ask for, as the one that was measured. */
static bool draws(const draw_cost *cost, const cellist_optics *optics) {
  const bool is_usual = optics->model == CELLIST_MODEL_EMISSION_ABSORPTION || optics->model == CELLIST_MODEL_ABSORPTION;
#ifndef CELLIST_HAS_GL
  if (cost->renderer == CELLIST_RENDERER_FACES) return false;
#endif
  return cost->is_lit == optics->light.enabled && (is_usual || cost->draws_every_model);
}

bool cellist_pipeline_budget(const cellist_mesh *mesh, const cellist_frame *frame, double error, double seconds,
                             unsigned threads, cellist_pipeline_desc *desc, cellist_budget *budget) {
  const draw_counts counts = draw_counts_of(mesh, frame, NULL);
  const draw_cost *best = NULL, *closest = NULL, *fastest = NULL;
  double best_time = 0, fastest_time = 0;
  size_t count;
  const draw_cost *costs = draw_costs(&count);
  for (const draw_cost *cost = costs; cost < costs + count; cost++) {
    if (!draws(cost, &desc->optics.model)) continue;
    const double time = draw_cost_seconds(cost, &counts, threads);
    if (closest == NULL || cost->error < closest->error) closest = cost;
    if (fastest == NULL || time < fastest_time) {
      fastest = cost;
      fastest_time = time;
    }
    if (error > 0 ? cost->error > error : time > seconds) continue;
    if (best != NULL && (error > 0 ? time >= best_time : cost->error >= best->error)) continue;
    best = cost;
    best_time = time;
  }
  const bool is_met = best != NULL;
  if (!is_met) best = error > 0 ? closest : fastest;
  desc->renderer = best->renderer;
  desc->precision = best->precision;
  desc->framebuffer = CELLIST_FRAMEBUFFER_32F;
  desc->optics.model.integration = CELLIST_INTEGRATION_EXACT;
  *budget = (cellist_budget){best->name, best->error, draw_cost_seconds(best, &counts, threads)};
  return is_met;
}
