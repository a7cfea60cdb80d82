/* SPDX-License-Identifier: BSD-3-Clause
 * GL: pictures by OpenGL, where it was built in. */
#include <string.h>

#include "pipeline.h"

#ifdef CELLIST_HAS_GL

static cellist_result open_gl(cellist_pipeline *pipeline) {
  static const cellist_gl_backend backends[] = {[CELLIST_BACKEND_AUTO] = CELLIST_GL_AUTO,
                                                [CELLIST_BACKEND_OSMESA] = CELLIST_GL_OSMESA,
                                                [CELLIST_BACKEND_EGL] = CELLIST_GL_EGL,
                                                [CELLIST_BACKEND_GLFW] = CELLIST_GL_GLFW};
  const cellist_gl_desc desc = {.backend = backends[pipeline->desc.backend]};
  return pipeline->gl != NULL ? CELLIST_SUCCESS : cellist_gl_create(pipeline->context, &desc, &pipeline->gl);
}

bool pipeline_has_gpu(cellist_pipeline *pipeline) {
  static const char *const software[] = {"llvmpipe", "softpipe", "swrast", "SWR", "Software"};
  if (open_gl(pipeline) != CELLIST_SUCCESS) {
    cellist_context_take_error(pipeline->context);
    return false;
  }
  bool is_software = false;
  for (size_t i = 0; i < sizeof software / sizeof software[0]; i++)
    is_software = is_software || strstr(cellist_gl_device_name(pipeline->gl), software[i]) != NULL;
  if (!is_software) return true;
  cellist_gl_destroy(pipeline->gl);
  pipeline->gl = NULL;
  return false;
}

cellist_result pipeline_make_gl(cellist_pipeline *pipeline) {
  cellist_result result = pipeline_make_order(pipeline);
  if (result == CELLIST_SUCCESS) result = open_gl(pipeline);
  if (result == CELLIST_SUCCESS) result = cellist_gl_upload(pipeline->gl, pipeline->drawn, pipeline->drawn_scalar);
  return result;
}

cellist_result pipeline_draw_gl(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                cellist_pipeline_stats *stats) {
  cellist_result result = pipeline_sort(pipeline, frame, stats);
  if (result != CELLIST_SUCCESS) return result;
  const size_t group_count = pipeline->group_count;
  cellist_gl_group *groups = cellist_allocate(pipeline->context, group_count, sizeof *groups);
  if (groups == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < group_count; i++)
    groups[i] = (cellist_gl_group){pipeline->groups[i].begin, pipeline->groups[i].count};
  static const char *const names[] = {"32f", "16f", "8"};
  const bool maximum = pipeline->desc.optics.model.model == CELLIST_MODEL_MAXIMUM;
  const cellist_framebuffer framebuffer = maximum ? CELLIST_FRAMEBUFFER_32F : pipeline->desc.framebuffer;
  const bool fan = pipeline->renderer == CELLIST_RENDERER_FAN;
  const cellist_gl_settings settings = {.optics = pipeline->desc.optics.model,
                                        .surface = pipeline->surface,
                                        .framebuffer = framebuffer,
                                        .groups = groups,
                                        .group_count = group_count,
                                        .method = fan ? CELLIST_GL_FAN : CELLIST_GL_FACES};
  cellist_gl_stats drawn;
  const double begin = clock_seconds();
  result = cellist_gl_render(pipeline->gl, frame, &pipeline->transfer, pipeline->order, pipeline->order_count,
                             &settings, image, &drawn);
  cellist_deallocate(pipeline->context, groups);
  if (result != CELLIST_SUCCESS) return result;
  stats->draw_seconds = clock_seconds() - begin;
  stats->renderer = fan ? "fan" : "faces";
  stats->method = pipeline_name_method(pipeline);
  stats->precision = "fast";
  stats->backend = cellist_gl_backend_name(pipeline->gl);
  stats->pixels = names[framebuffer];
  stats->fragments = drawn.fragment_count;
  if (!pipeline_is_inexact(pipeline))
    pipeline_leave_out(stats, "tables", "exact for a piecewise linear transfer function");
  else if (settings.optics.integration == CELLIST_INTEGRATION_PSI)
    pipeline_leave_out(stats, "tables", "psi has one table for every transfer function");
  return CELLIST_SUCCESS;
}

#else

bool pipeline_has_gpu(cellist_pipeline *pipeline) {
  (void)pipeline;
  return false;
}

cellist_result pipeline_make_gl(cellist_pipeline *pipeline) {
  return cellist_fail(pipeline->context, CELLIST_ERROR_UNSUPPORTED,
                      "this build has no OpenGL; the renderers 'cast' and 'soft' need none");
}

/* Never called: no such renderer was made. */
cellist_result pipeline_draw_gl(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                cellist_pipeline_stats *stats) {
  (void)frame, (void)image, (void)stats;
  return pipeline_make_gl(pipeline);
}

#endif
