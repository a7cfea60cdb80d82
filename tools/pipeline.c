/* SPDX-License-Identifier: BSD-3-Clause
 * Pipeline: read, order, project. What it picks by itself it decides here, from counts and never by the clock, so that
 * results repeat. */
#include <cellist/pipeline.h>

#include <cellist/generate.h>
#include <cellist/raycast.h>
#include <cellist/soft.h>
#include <cellist/sort.h>
#include <cellist/validate.h>
#include <cellist/version.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifdef CELLIST_HAS_GL
#include <cellist/gl.h>
#endif

struct cellist_pipeline {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_transfer transfer;
  cellist_pipeline_desc desc; /* its texts are not kept */
  cellist_renderer renderer;  /* never AUTO */
  cellist_isosurface *isos;   /* the pipeline's copy, which desc refers to */
  double unit_distance;
  double load_seconds;
  cellist_raycaster *caster;
  cellist_soft *soft;
  cellist_sorter *sorter;
  uint32_t *order; /* [tet_count] far to near */
#ifdef CELLIST_HAS_GL
  cellist_gl *gl;
#endif
};

static double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static cellist_result generate(cellist_context *context, const char *source, const char *begin, cellist_mesh **mesh) {
  char name[64];
  const char *colon = strchr(begin, ':');
  const size_t length = colon != NULL ? (size_t)(colon - begin) : strlen(begin);
  cellist_generate_desc desc = {0};
  if (colon != NULL) {
    char *end = NULL;
    const double size = strtod(colon + 1, &end);
    if (end == colon + 1 || *end != '\0' || !(size >= 1 && size <= 1e9))
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "%s: the size must lie between 1 and 1e9", source);
    desc.size = (size_t)size;
  }
  snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1), begin);
  return cellist_generate(context, name, &desc, mesh);
}

cellist_result cellist_pipeline_load(cellist_context *context, const char *source, const cellist_mesh_read_desc *desc,
                                     cellist_mesh **mesh) {
  static const char prefix[] = "sample:";
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (source == NULL || mesh == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_pipeline_load: source or mesh is NULL");
  cellist_mesh *loaded = NULL;
  cellist_result result = strncmp(source, prefix, sizeof prefix - 1) == 0
                              ? generate(context, source, source + sizeof prefix - 1, &loaded)
                              : cellist_mesh_read(context, source, desc, &loaded);
  if (result == CELLIST_SUCCESS && desc != NULL && desc->strict) {
    const cellist_validate_desc validate = {.strict = true};
    cellist_report report;
    result = cellist_validate(context, loaded, &validate, &report);
  }
  if (result == CELLIST_SUCCESS)
    *mesh = loaded;
  else
    cellist_mesh_destroy(loaded);
  return result;
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

static double diagonal_of(const cellist_pipeline *pipeline) {
  const double *b = cellist_mesh_get_arrays(pipeline->mesh)->bounds;
  return hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2]);
}

static cellist_result load_transfer(cellist_pipeline *pipeline) {
  const cellist_pipeline_optics *optics = &pipeline->desc.optics;
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->mesh);
  if (optics->unit_distance > 0)
    pipeline->unit_distance = optics->unit_distance;
  else if (optics->unit_diagonal_fraction > 0)
    pipeline->unit_distance = diagonal_of(pipeline) / optics->unit_diagonal_fraction;
  else
    pipeline->unit_distance =
        cellist_unit_distance_auto(arrays->bounds, cellist_mesh_get_facts(pipeline->mesh)->file_cell_count);
  if (!(pipeline->unit_distance > 0)) pipeline->unit_distance = 1; /* no extent: any unit will do */
  /* A constant scalar takes the middle of the transfer function. */
  const double value = pipeline->scalar.minimum;
  const bool is_constant = value == pipeline->scalar.maximum;
  const double margin = is_constant ? (value != 0 ? 0.5 * fabs(value) : 0.5) : 0;
  cellist_transfer_desc desc = {.source = optics->transfer,
                                .range = {value - margin, pipeline->scalar.maximum + margin},
                                .unit_distance = pipeline->unit_distance,
                                .opacity_scale = optics->opacity_scale,
                                .convention = optics->convention,
                                .srgb_colours = optics->srgb_colours};
  if (optics->has_range) memcpy(desc.range, optics->range, sizeof desc.range);
  return cellist_transfer_load(pipeline->context, &desc, &pipeline->transfer);
}

static cellist_result make_sorter(cellist_pipeline *pipeline) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->mesh);
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  const cellist_result result = cellist_sorter_create(pipeline->context, &desc, &pipeline->sorter);
  if (result != CELLIST_SUCCESS) return result;
  pipeline->order = cellist_allocate(pipeline->context, arrays->tet_count, sizeof *pipeline->order);
  return pipeline->order != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

static cellist_result make_faces(cellist_pipeline *pipeline) {
#ifdef CELLIST_HAS_GL
  static const cellist_gl_backend backends[] = {[CELLIST_BACKEND_AUTO] = CELLIST_GL_AUTO,
                                                [CELLIST_BACKEND_OSMESA] = CELLIST_GL_OSMESA,
                                                [CELLIST_BACKEND_EGL] = CELLIST_GL_EGL};
  const cellist_gl_desc desc = {.backend = backends[pipeline->desc.backend]};
  cellist_result result = make_sorter(pipeline);
  if (result == CELLIST_SUCCESS) result = cellist_gl_create(pipeline->context, &desc, &pipeline->gl);
  if (result == CELLIST_SUCCESS) result = cellist_gl_upload(pipeline->gl, pipeline->mesh, &pipeline->scalar);
  return result;
#else
  return cellist_fail(pipeline->context, CELLIST_ERROR_UNSUPPORTED,
                      "this build has no OpenGL; the renderer 'cast' needs none");
#endif
}

static cellist_result make_renderer(cellist_pipeline *pipeline) {
  pipeline->renderer = pipeline->desc.renderer;
  /* The ray caster needs no order and no OpenGL, which in software is slower. */
  if (pipeline->renderer == CELLIST_RENDERER_AUTO) pipeline->renderer = CELLIST_RENDERER_CAST;
  if (pipeline->renderer == CELLIST_RENDERER_FACES) return make_faces(pipeline);
  if (pipeline->renderer == CELLIST_RENDERER_SOFT) {
    const cellist_result result = make_sorter(pipeline);
    if (result != CELLIST_SUCCESS) return result;
    return cellist_soft_create(pipeline->context, pipeline->mesh, &pipeline->scalar, NULL, &pipeline->soft);
  }
  const cellist_raycaster_desc desc = {.tets = pipeline->desc.tets};
  return cellist_raycaster_create(pipeline->context, pipeline->mesh, &pipeline->scalar, &desc, &pipeline->caster);
}

/* Copies the isosurfaces and fills in the light's gradient unit. */
static cellist_result keep_model(cellist_pipeline *pipeline) {
  cellist_optics *model = &pipeline->desc.optics.model;
  if (model->iso_count > 0) {
    pipeline->isos = cellist_allocate(pipeline->context, model->iso_count, sizeof *pipeline->isos);
    if (pipeline->isos == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    memcpy(pipeline->isos, model->isos, model->iso_count * sizeof *pipeline->isos);
    model->isos = pipeline->isos;
  }
  if (model->light.enabled && model->light.gradient_unit == 0) {
    const double length = 0.1 * diagonal_of(pipeline), range = pipeline->scalar.maximum - pipeline->scalar.minimum;
    model->light.gradient_unit = length > 0 && range > 0 ? range / length : 1;
  }
  return CELLIST_SUCCESS;
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
  const double begin = seconds_now();
  cellist_result result = cellist_pipeline_load(context, desc->source, &desc->read, &created->mesh);
  if (result == CELLIST_SUCCESS)
    result = cellist_scalar_select(context, created->mesh, desc->optics.scalar, &created->scalar);
  created->load_seconds = seconds_now() - begin;
  if (result == CELLIST_SUCCESS) warn_of_flaws(created, desc->source);
  if (result == CELLIST_SUCCESS) result = load_transfer(created);
  if (result == CELLIST_SUCCESS) result = keep_model(created);
  if (result == CELLIST_SUCCESS) result = make_renderer(created);
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
  cellist_deallocate(context, pipeline->isos);
  cellist_soft_destroy(pipeline->soft);
  cellist_sorter_destroy(pipeline->sorter);
  cellist_raycaster_destroy(pipeline->caster);
  cellist_transfer_release(context, &pipeline->transfer);
  cellist_scalar_release(context, &pipeline->scalar);
  cellist_mesh_destroy(pipeline->mesh);
  cellist_deallocate(context, pipeline);
}

const cellist_mesh *cellist_pipeline_mesh(const cellist_pipeline *pipeline) { return pipeline->mesh; }
const cellist_scalar *cellist_pipeline_scalar(const cellist_pipeline *pipeline) { return &pipeline->scalar; }

static cellist_result draw_cast(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                cellist_pipeline_stats *stats) {
  cellist_raycast_desc desc = {.precision = pipeline->desc.precision, .optics = pipeline->desc.optics.model};
  const cellist_raycast_output output = {.image = image};
  cellist_raycast_stats cast;
  const double begin = seconds_now();
  cellist_result result = cellist_raycaster_render(pipeline->caster, frame, &pipeline->transfer, &desc, &output, &cast);
  if (result == CELLIST_ERROR_UNSUPPORTED && desc.precision == CELLIST_PRECISION_FAST) {
    cellist_context_take_error(pipeline->context);
    desc.precision = CELLIST_PRECISION_REFERENCE; /* draws everything */
    result = cellist_raycaster_render(pipeline->caster, frame, &pipeline->transfer, &desc, &output, &cast);
  }
  if (result != CELLIST_SUCCESS) return result;
  stats->draw_seconds = seconds_now() - begin;
  stats->renderer = "cast";
  stats->method = "exact";
  stats->precision = desc.precision == CELLIST_PRECISION_FAST ? "fast" : "reference";
  stats->error_bound = cast.error_bound;
  stats->backend = "none";
  stats->order = "none";
  stats->fragments = cast.step_count;
  stats->left_out[0] = "exterior";
  stats->left_out[1] = "sort";
  stats->left_out[2] = "tables";
  if (cast.fold_ray_count > 0)
    cellist_log(pipeline->context, CELLIST_LOG_WARNING,
                "cells overlap along %llu rays: the mesh is flawed there, and the picture arbitrary",
                (unsigned long long)cast.fold_ray_count);
  return CELLIST_SUCCESS;
}

/* Sorts the cells for the frame's eye. */
static cellist_result sort_cells(cellist_pipeline *pipeline, const cellist_frame *frame,
                                 cellist_pipeline_stats *stats) {
  cellist_viewpoint viewpoint = {.parallel = frame->parallel};
  memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
  cellist_sort_stats sorted;
  const double begin = seconds_now();
  const cellist_result result = cellist_sorter_sort(pipeline->sorter, &viewpoint, pipeline->order, &sorted);
  if (result != CELLIST_SUCCESS) return result;
  stats->sort_seconds = seconds_now() - begin;
  stats->order = sorted.exact ? "exact" : "approximate";
  stats->group_count = sorted.group_count;
  stats->cells_in_groups = sorted.cells_in_groups;
  return CELLIST_SUCCESS;
}

static cellist_result draw_soft(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                cellist_pipeline_stats *stats) {
  cellist_result result = sort_cells(pipeline, frame, stats);
  if (result != CELLIST_SUCCESS) return result;
  const cellist_group *sorted = NULL;
  size_t group_count = 0;
  cellist_sorter_groups(pipeline->sorter, &sorted, &group_count);
  cellist_soft_group *groups = cellist_allocate(pipeline->context, group_count, sizeof *groups);
  if (groups == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < group_count; i++) groups[i] = (cellist_soft_group){sorted[i].begin, sorted[i].count};
  const cellist_soft_settings settings = {.optics = pipeline->desc.optics.model,
                                          .order = pipeline->order,
                                          .order_count = cellist_mesh_get_arrays(pipeline->mesh)->tet_count,
                                          .groups = groups,
                                          .group_count = group_count};
  cellist_soft_stats drawn;
  const double begin = seconds_now();
  result = cellist_soft_render(pipeline->soft, frame, &pipeline->transfer, &settings, image, &drawn);
  cellist_deallocate(pipeline->context, groups);
  if (result != CELLIST_SUCCESS) return result;
  stats->draw_seconds = seconds_now() - begin;
  stats->renderer = "soft";
  stats->method = "exact";
  stats->precision = "fast";
  stats->backend = "none";
  stats->fragments = drawn.fragment_count;
  stats->left_out[0] = "exterior";
  stats->left_out[1] = "tables";
  return CELLIST_SUCCESS;
}

#ifdef CELLIST_HAS_GL
static cellist_result draw_faces(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                 cellist_pipeline_stats *stats) {
  cellist_result result = sort_cells(pipeline, frame, stats);
  if (result != CELLIST_SUCCESS) return result;
  /* Inside a group no order of whole cells is right, and they are drawn in one. */
  if (stats->group_count > 0) stats->order = "approximate";
  const cellist_gl_settings settings = {.optics = pipeline->desc.optics.model};
  cellist_gl_stats drawn;
  const double begin = seconds_now();
  result = cellist_gl_render(pipeline->gl, frame, &pipeline->transfer, pipeline->order,
                             cellist_mesh_get_arrays(pipeline->mesh)->tet_count, &settings, image, &drawn);
  if (result != CELLIST_SUCCESS) return result;
  stats->draw_seconds = seconds_now() - begin;
  stats->renderer = "faces";
  stats->method = "exact";
  stats->precision = "fast";
  stats->backend = cellist_gl_backend_name(pipeline->gl);
  stats->fragments = drawn.fragment_count;
  stats->left_out[0] = "exterior";
  stats->left_out[1] = "tables";
  return CELLIST_SUCCESS;
}
#endif

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
  snprintf(method, sizeof method, "renderer %s integration %s context %s order %s", stats->renderer, stats->method,
           stats->backend, stats->order);
  cellist_result result = cellist_image_set_attribute(image, "owner", "cellist " CELLIST_VERSION_STRING);
  if (result == CELLIST_SUCCESS) result = cellist_image_set_attribute(image, "cellist camera", camera);
  if (result == CELLIST_SUCCESS) result = cellist_image_set_attribute(image, "cellist optics", optics);
  if (result == CELLIST_SUCCESS) result = cellist_image_set_attribute(image, "cellist method", method);
  return result;
}

cellist_result cellist_pipeline_draw(cellist_pipeline *pipeline, const cellist_view *view, uint32_t width,
                                     uint32_t height, cellist_image **image, cellist_pipeline_stats *stats) {
  if (pipeline == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_context *context = pipeline->context;
  if (image == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_pipeline_draw: image is NULL");
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->mesh);
  const cellist_view usual = cellist_view_orbit(arrays->bounds, 30.96, 34.45);
  cellist_frame frame;
  cellist_result result = cellist_frame_from_view(context, view != NULL ? view : &usual, width, height, &frame);
  if (result != CELLIST_SUCCESS) return result;

  static const char *const channels[] = {"R", "G", "B", "A", "Z", "ZBack", "transmittance.Y", "cells.Y", "segments.Y"};
  cellist_image *created = NULL;
  cellist_pipeline_stats made = {.load_seconds = pipeline->load_seconds,
                                 .transfer_knots = pipeline->transfer.knot_count,
                                 .unit_distance = pipeline->unit_distance};
  made.convention = pipeline->desc.optics.convention == CELLIST_OPACITY_IMAGE ? "image" : "unstructured";
  result = cellist_image_create(context, width, height, channels, pipeline->renderer == CELLIST_RENDERER_CAST ? 9 : 6,
                                &created);
#ifdef CELLIST_HAS_GL
  if (result == CELLIST_SUCCESS && pipeline->renderer == CELLIST_RENDERER_FACES)
    result = draw_faces(pipeline, &frame, created, &made);
#endif
  if (result == CELLIST_SUCCESS && pipeline->renderer == CELLIST_RENDERER_SOFT)
    result = draw_soft(pipeline, &frame, created, &made);
  if (result == CELLIST_SUCCESS && pipeline->renderer == CELLIST_RENDERER_CAST)
    result = draw_cast(pipeline, &frame, created, &made);
  if (result == CELLIST_SUCCESS) result = describe(pipeline, &frame, &made, created);
  if (result != CELLIST_SUCCESS) {
    cellist_image_destroy(created);
    return result;
  }
  *image = created;
  if (stats != NULL) *stats = made;
  return CELLIST_SUCCESS;
}
