/* SPDX-License-Identifier: BSD-3-Clause
 * Choose: which renderer a scene gets that asks for none, by counted work and committed constants, never by the clock.
 *
 * OpenGL is asked only where a context was asked for: to know whether it is more than software one must be made. Where
 * it is software, soft and cast are several times faster than faces.
 *
 * Both work by fragments (a cell on a pixel), which are estimated from the tets' shadows. soft also works by cell, and
 * sorts where the optics need an order; cast by pixel, and by entry. */
#include <stdio.h>

#include "pipeline.h"

/* Nanoseconds of processor time, fitted to tests/bench/bench_soft over the shared meshes at 512 and 1024 pixels on one
 * thread of an AMD EPYC that other work kept busy (milliseconds, soft / cast):
 *
 *            spx    torus_vt  gears_t  disk_out_ref  impeller  sci_torso  bluntfin  post
 *   512      29/55  20/21     44/43    55/46         40/45     54/39      168/80    195/100
 *   1024     157/195  66/99   141/160  187/182       113/123   171/214    339/289   485/283
 *
 * A sort's boundary face costs what plan.c says; the exterior that sorts a concave mesh fast is made once, at some 20
 * us a boundary face (spx, bluntfin, post), and shared by the pictures to come. Other values change speed, never a
 * picture. */
static const double SOFT_FRAGMENT = 9, SOFT_CELL = 250, SOFT_PIXEL = 15, SORT_CELL = 25, SORT_FACE = 900;
static const double EXTERIOR_FACE = 20000;
static const double CAST_FRAGMENT = 9.5, CAST_CELL = 12, CAST_PIXEL = 40, CAST_FACE = 100;

/* The picture that is counted for if none is named. */
enum { USUAL_SIZE = 512 };

/* Of the usual view; 0 if the mesh has no extent to look at. */
static double count_fragments(const cellist_pipeline *pipeline, uint32_t width, uint32_t height) {
  const cellist_view view = cellist_view_orbit(cellist_mesh_get_arrays(pipeline->mesh)->bounds, 30.96, 34.45);
  cellist_frame frame;
  if (cellist_frame_from_view(pipeline->context, &view, width, height, &frame) == CELLIST_SUCCESS)
    return cellist_pipeline_estimate_fragments(pipeline->mesh, &frame);
  cellist_context_take_error(pipeline->context);
  return 0;
}

static bool fast_cast_draws(const cellist_pipeline *pipeline) {
  const cellist_optics *optics = &pipeline->desc.optics.model;
  return (optics->model == CELLIST_MODEL_EMISSION_ABSORPTION || optics->model == CELLIST_MODEL_ABSORPTION) &&
         (!optics->light.enabled || optics->model == CELLIST_MODEL_ABSORPTION) && !pipeline_is_narrow(pipeline);
}

cellist_renderer pipeline_choose(cellist_pipeline *pipeline) {
  const cellist_pipeline_desc *desc = &pipeline->desc;
  if (desc->renderer != CELLIST_RENDERER_AUTO) {
    snprintf(pipeline->reason, sizeof pipeline->reason, "asked for");
    return desc->renderer;
  }
  /* What only one of them is asked for or can do. */
#ifdef CELLIST_HAS_GL
  if (pipeline_is_inexact(pipeline)) {
    snprintf(pipeline->reason, sizeof pipeline->reason, "psi and tables are OpenGL's");
    return CELLIST_RENDERER_FACES;
  }
#endif
  if (desc->backend != CELLIST_BACKEND_AUTO && !pipeline_is_narrow(pipeline) && pipeline_has_gpu(pipeline)) {
    snprintf(pipeline->reason, sizeof pipeline->reason, "this OpenGL is more than software");
    return CELLIST_RENDERER_FACES;
  }
  if (desc->precision == CELLIST_PRECISION_REFERENCE || desc->tets != 0) {
    snprintf(pipeline->reason, sizeof pipeline->reason, "options of the ray caster were given");
    return CELLIST_RENDERER_CAST;
  }
  if (!fast_cast_draws(pipeline)) {
    snprintf(pipeline->reason, sizeof pipeline->reason, "the ray caster draws this only in double precision");
    return CELLIST_RENDERER_SOFT;
  }
  const uint32_t width = desc->width > 0 ? desc->width : USUAL_SIZE;
  const uint32_t height = desc->height > 0 ? desc->height : USUAL_SIZE;
  const double pixels = (double)width * height, fragments = count_fragments(pipeline, width, height);
  const double cells = (double)cellist_mesh_get_arrays(pipeline->mesh)->tet_count;
  const double faces = (double)cellist_mesh_get_facts(pipeline->mesh)->boundary_face_count;
  const double frames = desc->frames > 0 ? desc->frames : 1;
  const bool sorts = desc->optics.model.model == CELLIST_MODEL_EMISSION_ABSORPTION;
  const double soft = SOFT_FRAGMENT * fragments + SOFT_CELL * cells + SOFT_PIXEL * pixels +
                      (sorts ? SORT_CELL * cells + (SORT_FACE + EXTERIOR_FACE / frames) * faces : 0);
  const double cast = CAST_FRAGMENT * fragments + CAST_CELL * cells + CAST_PIXEL * pixels + CAST_FACE * faces;
  snprintf(pipeline->reason, sizeof pipeline->reason,
           "counted work, ms a picture: soft %.3g, cast %.3g; %.0f picture%s", 1e-6 * soft, 1e-6 * cast, frames,
           frames > 1 ? "s" : "");
  return soft < cast ? CELLIST_RENDERER_SOFT : CELLIST_RENDERER_CAST;
}
