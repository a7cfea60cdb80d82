/* SPDX-License-Identifier: BSD-3-Clause
 * Choose: which renderer a scene gets that asks for none, by counted work and committed constants, never by the clock.
 *
 * OpenGL is asked only where a context was asked for: to know whether it is more than software one must be made. Where
 * it is software, soft and cast are several times faster than faces.
 *
 * What drawing costs costs.c says; soft also sorts where the optics need an order. Only cells that can show something
 * count: few of them are soft's, whose pixels cost less than the caster's. */
#include <math.h>
#include <stdio.h>

#include "costs.h"
#include "pipeline.h"

/* Nanoseconds (bench_sort, spx to post): a cell, and a boundary face without an exterior and with one, which is made
 * once and shared by the pictures to come; a part of the mesh gets none. Other values change speed, never a picture. */
static const double SORT_CELL = 8, GAP_FACE = 700, SORT_FACE = 20;

/* What is counted for if it is not named: pixels along a side, pictures. */
enum { USUAL_SIZE = 512, MANY = 1000 };

/* Of what can show something in the pictures to come; nothing if the mesh has no extent to look at. */
static draw_counts count_work(const cellist_pipeline *pipeline) {
  const cellist_pipeline_desc *desc = &pipeline->desc;
  const cellist_view usual =
      cellist_view_orbit(cellist_mesh_get_arrays(pipeline->mesh)->bounds, CELLIST_VIEW_AZIMUTH, CELLIST_VIEW_ELEVATION);
  cellist_frame frame;
  if (cellist_frame_from_view(pipeline->context, desc->view != NULL ? desc->view : &usual,
                              desc->width > 0 ? desc->width : USUAL_SIZE, desc->height > 0 ? desc->height : USUAL_SIZE,
                              &frame) == CELLIST_SUCCESS)
    return draw_counts_of(pipeline->mesh, &frame, pipeline->visible);
  cellist_context_take_error(pipeline->context);
  return (draw_counts){0};
}

static bool fast_cast_draws(const cellist_pipeline *pipeline) {
  const cellist_optics *optics = &pipeline->desc.optics.model;
  return (optics->model == CELLIST_MODEL_EMISSION_ABSORPTION || optics->model == CELLIST_MODEL_ABSORPTION) &&
         (!optics->light.enabled || optics->model == CELLIST_MODEL_ABSORPTION) && !pipeline_is_narrow(pipeline);
}

/* soft or cast. */
static void choose_by_work(cellist_pipeline *pipeline, const draw_counts *counts) {
  const cellist_pipeline_desc *desc = &pipeline->desc;
  const bool is_part = pipeline->kept_count < cellist_mesh_get_arrays(pipeline->mesh)->tet_count;
  const double frames = desc->frames > 0 ? desc->frames : MANY;
  const bool sorts = desc->optics.model.model == CELLIST_MODEL_EMISSION_ABSORPTION;
  const double face = is_part ? GAP_FACE : fmin(GAP_FACE, SORT_FACE + EXTERIOR_FACE_COST / frames);
  const double order = sorts ? SORT_CELL * counts->tets + face * counts->boundary_faces : 0;
  const draw_cost *soft_cost = draw_cost_of(CELLIST_RENDERER_SOFT, CELLIST_PRECISION_FAST);
  const draw_cost *cast_cost = draw_cost_of(CELLIST_RENDERER_CAST, CELLIST_PRECISION_FAST);
  const double soft = 1e9 * draw_cost_seconds(soft_cost, counts, 1) + order;
  const double cast = 1e9 * draw_cost_seconds(cast_cost, counts, 1);
  snprintf(pipeline->reason, sizeof pipeline->reason,
           "counted work, ms a picture: soft %.3g, cast %.3g; %.0f picture%s", 1e-6 * soft, 1e-6 * cast, frames,
           frames > 1 ? "s" : "");
  pipeline->renderer = soft < cast ? CELLIST_RENDERER_SOFT : CELLIST_RENDERER_CAST;
}

/* What only one of them is asked for or can do; NULL if there is nothing like that. */
static const char *find_reason(cellist_pipeline *pipeline, cellist_renderer *renderer) {
  const cellist_pipeline_desc *desc = &pipeline->desc;
  *renderer = CELLIST_RENDERER_FACES;
#ifdef CELLIST_HAS_GL
  if (pipeline_is_inexact(pipeline)) return "psi and tables are OpenGL's";
#endif
  if (desc->backend != CELLIST_BACKEND_AUTO && !pipeline_is_narrow(pipeline) && pipeline_has_gpu(pipeline))
    return "this OpenGL is more than software";
  *renderer = CELLIST_RENDERER_CAST;
  if (desc->precision == CELLIST_PRECISION_REFERENCE || desc->tets != 0) return "options of the ray caster were given";
  *renderer = CELLIST_RENDERER_SOFT;
  if (!fast_cast_draws(pipeline)) return "the ray caster draws this only in double precision";
  return NULL;
}

cellist_result pipeline_choose(cellist_pipeline *pipeline) {
  const cellist_pipeline_desc *desc = &pipeline->desc;
  pipeline->renderer = desc->renderer;
  const char *reason = "asked for";
  if (desc->renderer == CELLIST_RENDERER_AUTO) {
    const bool has_budget = desc->error > 0 || desc->seconds > 0;
    reason = has_budget ? desc->error > 0 ? "cheapest for the error asked for" : "closest in the time asked for"
                        : find_reason(pipeline, &pipeline->renderer);
    if (reason == NULL || has_budget) {
      const draw_counts counts = count_work(pipeline);
      const cellist_result result = has_budget ? pipeline_choose_budget(pipeline, &counts) : CELLIST_SUCCESS;
      if (result != CELLIST_SUCCESS) return result;
      if (!has_budget) choose_by_work(pipeline, &counts);
    }
  }
  if (reason != NULL) snprintf(pipeline->reason, sizeof pipeline->reason, "%s", reason);
  return CELLIST_SUCCESS;
}
