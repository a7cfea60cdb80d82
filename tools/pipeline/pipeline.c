/* SPDX-License-Identifier: BSD-3-Clause
 * Pipeline: read, order, project. What it picks by itself it decides here, from counts and never by the clock, so that
 * results repeat. */
#include <cellist/version.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline.h"

double pipeline_diagonal(const cellist_pipeline *pipeline) {
  const double *b = cellist_mesh_get_arrays(pipeline->mesh)->bounds;
  return hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2]);
}

/* What was repaired, and what no repair can make right, so that no picture hides it. */
static void warn_of_flaws(cellist_pipeline *pipeline, const char *source) {
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(pipeline->mesh);
  const struct {
    size_t count;
    const char *what;
  } flaws[] = {{facts->infinite_cell_count, "cells with a NaN or infinite corner were left out"},
               {facts->collapsed_cell_count, "cells that use a point twice were left out"},
               {facts->inverted_cell_count, "inverted cells were re-oriented"},
               {facts->folded_face_count, "faces have both cells on one side: no picture is right there"},
               {facts->overfull_face_count, "faces have more than two cells: no picture is right there"},
               {pipeline->scalar.nan_cell_count, "cells have no finite scalar and are not drawn"}};
  if (cellist_mesh_get_arrays(pipeline->mesh)->tet_count == 0)
    cellist_log(pipeline->context, CELLIST_LOG_WARNING, "%s: there are no cells with a volume to draw", source);
  for (size_t i = 0; i < sizeof flaws / sizeof flaws[0]; i++)
    if (flaws[i].count > 0)
      cellist_log(pipeline->context, CELLIST_LOG_WARNING, "%s: %zu %s", source, flaws[i].count, flaws[i].what);
}

static void warn_of_method(const cellist_pipeline *pipeline) {
  if (pipeline->renderer != CELLIST_RENDERER_FACES && pipeline_is_inexact(pipeline))
    cellist_log(pipeline->context, CELLIST_LOG_WARNING,
                "this renderer integrates exactly; psi and tables are for the renderer 'faces'");
  if ((pipeline->renderer == CELLIST_RENDERER_FACES || pipeline->renderer == CELLIST_RENDERER_FAN) &&
      pipeline_is_narrow(pipeline))
    cellist_log(pipeline->context, CELLIST_LOG_WARNING,
                "the transfer function has peaks too narrow for scalars in single precision, as this renderer keeps "
                "them; 'soft' and 'cast' draw them right");
}

static cellist_result make_renderer(cellist_pipeline *pipeline) {
  switch (pipeline->renderer) {
    case CELLIST_RENDERER_FACES:
    case CELLIST_RENDERER_FAN: return pipeline_make_gl(pipeline);
    case CELLIST_RENDERER_SOFT: return pipeline_make_soft(pipeline);
    default: return pipeline_make_cast(pipeline);
  }
}

static cellist_result draw_frame(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                 cellist_pipeline_stats *stats) {
  switch (pipeline->renderer) {
    case CELLIST_RENDERER_FACES:
    case CELLIST_RENDERER_FAN: return pipeline_draw_gl(pipeline, frame, image, stats);
    case CELLIST_RENDERER_SOFT: return pipeline_draw_soft(pipeline, frame, image, stats);
    default: return pipeline_draw_cast(pipeline, frame, image, stats);
  }
}

cellist_result cellist_pipeline_create(cellist_context *context, const cellist_pipeline_desc *desc,
                                       cellist_pipeline **pipeline) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (desc == NULL || pipeline == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_pipeline_create: desc or pipeline is NULL");
  cellist_pipeline *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->desc = *desc;
  const double begin = clock_seconds();
  created->mesh = desc->mesh;
  cellist_result result = CELLIST_SUCCESS;
  if (desc->mesh == NULL) {
    result = cellist_pipeline_load(context, desc->source, &desc->read, &created->loaded);
    created->mesh = created->loaded;
  }
  if (result == CELLIST_SUCCESS)
    result = cellist_scalar_select(context, created->mesh, desc->optics.scalar, &created->scalar);
  created->load_seconds = clock_seconds() - begin;
  if (result == CELLIST_SUCCESS) warn_of_flaws(created, desc->source != NULL ? desc->source : "mesh");
  const double loaded = clock_seconds();
  if (result == CELLIST_SUCCESS) result = pipeline_load_transfer(created);
  if (result == CELLIST_SUCCESS) result = pipeline_keep_model(created);
  if (result == CELLIST_SUCCESS) result = pipeline_make_surface(created);
  if (result == CELLIST_SUCCESS) result = pipeline_look(created);
  if (result == CELLIST_SUCCESS) result = pipeline_choose(created);
  if (result == CELLIST_SUCCESS) result = pipeline_plan(created);
  if (result == CELLIST_SUCCESS) warn_of_method(created);
  if (result == CELLIST_SUCCESS) result = make_renderer(created);
  created->prepare_seconds = clock_seconds() - loaded;
  if (created->sorted != NULL) created->prepare_seconds -= cellist_order_get_facts(created->sorted)->seconds;
  if (result == CELLIST_SUCCESS)
    *pipeline = created;
  else
    cellist_pipeline_destroy(created);
  return result;
}

void cellist_pipeline_destroy(cellist_pipeline *pipeline) {
  if (pipeline == NULL) return;
  cellist_context *context = pipeline->context;
#ifdef CELLIST_HAS_GL
  cellist_gl_destroy(pipeline->gl);
#endif
  cellist_deallocate(context, pipeline->order);
  cellist_deallocate(context, pipeline->groups);
  cellist_deallocate(context, pipeline->visible);
  cellist_deallocate(context, pipeline->isos);
  cellist_soft_destroy(pipeline->soft);
  cellist_order_destroy(pipeline->sorted);
  cellist_surface_destroy(pipeline->surface);
  cellist_peer_destroy(pipeline->peer);
  cellist_raycaster_destroy(pipeline->caster);
  cellist_transfer_release(context, &pipeline->transfer);
  cellist_scalar_release(context, &pipeline->part_scalar);
  cellist_mesh_destroy(pipeline->part);
  cellist_scalar_release(context, &pipeline->scalar);
  cellist_mesh_destroy(pipeline->loaded);
  cellist_deallocate(context, pipeline);
}

const cellist_mesh *cellist_pipeline_mesh(const cellist_pipeline *pipeline) { return pipeline->mesh; }
const cellist_scalar *cellist_pipeline_scalar(const cellist_pipeline *pipeline) { return &pipeline->scalar; }

/* What a picture was made with, for whoever finds the file. */
static cellist_result describe(const cellist_pipeline *pipeline, const cellist_frame *frame,
                               const cellist_pipeline_stats *stats, cellist_image *image) {
  char camera[512], optics[512], method[256];
  const cellist_frame *f = frame;
  snprintf(camera, sizeof camera,
           "%s eye %.17g %.17g %.17g forward %.17g %.17g %.17g up %.17g %.17g %.17g half height %.17g near %.17g",
           f->parallel ? "parallel" : "perspective", f->eye[0], f->eye[1], f->eye[2], f->forward[0], f->forward[1],
           f->forward[2], f->up[0], f->up[1], f->up[2], f->half_height, f->near_distance);
  snprintf(optics, sizeof optics, "scalar %s range %.17g %.17g unit distance %.17g opacity convention %s knots %zu",
           pipeline->scalar.name, pipeline->transfer.knots[0].value,
           pipeline->transfer.knots[pipeline->transfer.knot_count - 1].value, pipeline->unit_distance,
           stats->convention, pipeline->transfer.knot_count);
  snprintf(method, sizeof method, "renderer %s integration %s context %s framebuffer %s order %s", stats->renderer,
           stats->method, stats->backend, stats->pixels, stats->order);
  cellist_result result = cellist_image_set_attribute(image, "owner", "cellist " CELLIST_VERSION_STRING);
  if (result == CELLIST_SUCCESS) result = cellist_image_set_attribute(image, "cellist camera", camera);
  if (result == CELLIST_SUCCESS) result = cellist_image_set_attribute(image, "cellist optics", optics);
  if (result == CELLIST_SUCCESS) result = cellist_image_set_attribute(image, "cellist method", method);
  return result == CELLIST_SUCCESS ? pipeline_describe_cuts(pipeline, frame, image) : result;
}

cellist_result cellist_pipeline_draw(cellist_pipeline *pipeline, const cellist_view *view, uint32_t width,
                                     uint32_t height, cellist_image **image, cellist_pipeline_stats *stats) {
  if (pipeline == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_context *context = pipeline->context;
  if (image == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_pipeline_draw: image is NULL");
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->mesh);
  const cellist_view usual = cellist_view_orbit(arrays->bounds, CELLIST_VIEW_AZIMUTH, CELLIST_VIEW_ELEVATION);
  cellist_frame frame;
  cellist_result result = cellist_frame_from_view(context, view != NULL ? view : &usual, width, height, &frame);
  if (result != CELLIST_SUCCESS) return result;

  static const char *const channels[] = {"R", "G", "B", "A", "Z", "ZBack", "transmittance.Y", "cells.Y", "segments.Y"};
  cellist_image *created = NULL;
  cellist_pipeline_stats made = {.pixels = "32f",
                                 .renderer_reason = pipeline->reason,
                                 .budget = pipeline->budget,
                                 .load_seconds = pipeline->load_seconds,
                                 .prepare_seconds = pipeline->prepare_seconds,
                                 .transfer_knots = pipeline->transfer.knot_count,
                                 .unit_distance = pipeline->unit_distance};
  made.convention = pipeline->desc.optics.convention == CELLIST_OPACITY_IMAGE ? "image" : "unstructured";
  result = cellist_image_create(context, width, height, channels, pipeline->renderer == CELLIST_RENDERER_CAST ? 9 : 6,
                                &created);
  if (result == CELLIST_SUCCESS) result = draw_frame(pipeline, &frame, created, &made);
  if (result == CELLIST_SUCCESS) pipeline_note_plan(pipeline, &made);
  if (result == CELLIST_SUCCESS) result = describe(pipeline, &frame, &made, created);
  if (result != CELLIST_SUCCESS) {
    cellist_image_destroy(created);
    return result;
  }
  *image = created;
  if (stats != NULL) *stats = made;
  return CELLIST_SUCCESS;
}
