/* SPDX-License-Identifier: BSD-3-Clause
 * Draw: a case by one renderer beside the reference caster, pixel by pixel. The reference's doubles are taken as they
 * are; pictures are floats. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../clock.h"
#include "stability.h"

/* The reference's picture in doubles. */
struct reference {
  double *rgba; /* [4 pixels] */
  cellist_raycast_stats stats;
  double peak, seconds;
};

static cellist_result draw_reference(cellist_context *context, const stability_scene *scene,
                                     struct reference *reference) {
  cellist_scalar scalar = {0};
  cellist_raycaster *caster = NULL;
  cellist_frame frame;
  const size_t count = (size_t)scene->width * scene->height;
  const double begin = clock_seconds();
  cellist_result result = cellist_frame_from_view(context, &scene->view, scene->width, scene->height, &frame);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, scene->mesh, NULL, &scalar);
  if (result == CELLIST_SUCCESS) result = cellist_raycaster_create(context, scene->mesh, &scalar, NULL, &caster);
  if (result == CELLIST_SUCCESS) {
    reference->rgba = cellist_allocate(context, count, 4 * sizeof *reference->rgba);
    if (reference->rgba == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  }
  const cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_REFERENCE, .optics = scene->optics};
  const cellist_raycast_output output = {.rgba = reference->rgba};
  if (result == CELLIST_SUCCESS)
    result = cellist_raycaster_render(caster, &frame, &scene->transfer, &desc, &output, &reference->stats);
  cellist_raycaster_destroy(caster);
  cellist_scalar_release(context, &scalar);
  reference->seconds = clock_seconds() - begin;
  for (size_t i = 0; result == CELLIST_SUCCESS && i < 4 * count; i++)
    reference->peak = fmax(reference->peak, fabs(reference->rgba[i]));
  return result;
}

static cellist_result draw_picture(cellist_context *context, const stability_scene *scene, stability_renderer renderer,
                                   cellist_image **image) {
  static const cellist_renderer renderers[] = {[STABILITY_CAST] = CELLIST_RENDERER_CAST,
                                               [STABILITY_SOFT] = CELLIST_RENDERER_SOFT,
                                               [STABILITY_FACES] = CELLIST_RENDERER_FACES,
                                               [STABILITY_FAN] = CELLIST_RENDERER_FAN};
  const cellist_pipeline_desc desc = {.mesh = scene->mesh,
                                      .optics = {.function = &scene->transfer, .model = scene->optics},
                                      .renderer = renderers[renderer]};
  cellist_pipeline *pipeline = NULL;
  cellist_result result = cellist_pipeline_create(context, &desc, &pipeline);
  if (result == CELLIST_SUCCESS)
    result = cellist_pipeline_draw(pipeline, &scene->view, scene->width, scene->height, image, NULL);
  cellist_pipeline_destroy(pipeline);
  return result;
}

/* Sets the message to the first thing that is wrong with the picture by itself. */
static void check_finite(const stability_scene *scene, const cellist_image *image, char *message, size_t size) {
  static const char *const names[] = {"R", "G", "B", "A", "Z", "ZBack"};
  const size_t count = (size_t)scene->width * scene->height;
  for (size_t k = 0; k < 6; k++) {
    const float *plane = cellist_image_channel(image, names[k]);
    for (size_t i = 0; plane != NULL && i < count; i++) {
      const bool is_wrong = k < 4 ? !isfinite(plane[i]) : isnan(plane[i]);
      const bool is_outside = k == 3 && !(plane[i] >= -1e-6F && plane[i] <= 1 + 1e-6F);
      if (!is_wrong && !is_outside) continue;
      snprintf(message, size, "pixel %zu,%zu: %s is %g", i % scene->width, i / scene->width, names[k],
               (double)plane[i]);
      return;
    }
  }
}

static void compare(const stability_scene *scene, const struct reference *reference, const cellist_image *image,
                    double limit, stability_picture *found) {
  static const char *const names[] = {"R", "G", "B", "A"};
  const size_t count = (size_t)scene->width * scene->height;
  const float *planes[4];
  for (int k = 0; k < 4; k++) planes[k] = cellist_image_channel(image, names[k]);
  const double unit = reference->peak > 0 ? reference->peak : 1;
  double squares = 0, worst = -1;
  size_t worst_at = 0;
  for (size_t i = 0; i < count; i++) {
    double difference = 0;
    bool is_covered = false;
    for (size_t k = 0; k < 4; k++) {
      const double expected = reference->rgba[4 * i + k], d = fabs((double)planes[k][i] - expected) / unit;
      is_covered = is_covered || expected != 0 || planes[k][i] != 0;
      squares += d * d;
      difference = fmax(difference, d);
    }
    found->covered += is_covered;
    found->over += difference > limit;
    if (difference > worst) worst = difference, worst_at = i;
  }
  found->max = fmax(worst, 0);
  found->rmse = found->covered > 0 ? sqrt(squares / (4 * (double)found->covered)) : 0;
  if (found->max <= limit) return;
  const double *e = &reference->rgba[4 * worst_at];
  snprintf(found->message, sizeof found->message,
           "%zu pixels are more than %.1e off; pixel %zu,%zu is %.7g %.7g %.7g %.7g instead of %.7g %.7g %.7g %.7g",
           found->over, limit, worst_at % scene->width, worst_at / scene->width, (double)planes[0][worst_at],
           (double)planes[1][worst_at], (double)planes[2][worst_at], (double)planes[3][worst_at], e[0], e[1], e[2],
           e[3]);
}

static void judge(const stability_case *which, const stability_scene *scene, const struct reference *reference,
                  const cellist_image *image, stability_renderer renderer, stability_picture *found) {
  double limit = which->limit > 0 ? which->limit : STABILITY_LIMIT;
  if (renderer == STABILITY_FAN) limit = fmax(limit, STABILITY_FAN_LIMIT);
  for (size_t i = 0; i < 4 * (size_t)scene->width * scene->height; i++)
    if (!isfinite(reference->rgba[i])) {
      snprintf(found->message, sizeof found->message, "the reference itself is not finite at pixel %zu", i / 4);
      found->verdict = STABILITY_FAILS;
      return;
    }
  check_finite(scene, image, found->message, sizeof found->message);
  if (found->message[0] != '\0') {
    found->verdict = STABILITY_FAILS; /* no case may list this as known */
    return;
  }
  compare(scene, reference, image, limit, found);
  bool passes = found->over <= which->strays;
  if (which->expectation == STABILITY_PICTURE && reference->peak == 0) {
    passes = false;
    snprintf(found->message, sizeof found->message, "the reference shows nothing: the case exercises nothing");
  }
  if (which->expectation == STABILITY_FINITE) {
    passes = reference->stats.fold_ray_count > 0;
    snprintf(found->message, sizeof found->message, "%s", passes ? "" : "the overlap went unnoticed");
  }
  if (which->expectation == STABILITY_EMPTY) {
    passes = found->max <= limit && reference->peak == 0; /* flat cells may be a rounding thick */
    if (!passes) snprintf(found->message, sizeof found->message, "something is drawn where nothing is");
  }
  if (passes) {
    found->verdict = STABILITY_PASSES;
    found->message[0] = '\0';
    return;
  }
  found->verdict = which->fails[renderer] != NULL ? STABILITY_KNOWN : STABILITY_FAILS;
}

cellist_result stability_draw(cellist_context *context, const stability_case *which, const stability_scene *scene,
                              stability_renderer renderer, stability_picture *found) {
  *found = (stability_picture){0};
  struct reference reference = {0};
  cellist_result result = draw_reference(context, scene, &reference);
  found->reference_seconds = reference.seconds;
  found->bound = reference.stats.error_bound;
  found->peak = reference.peak;
  if (result == CELLIST_SUCCESS) {
    cellist_image *image = NULL;
    const double begin = clock_seconds();
    const cellist_result drawn = draw_picture(context, scene, renderer, &image);
    found->seconds = clock_seconds() - begin;
    if (drawn == CELLIST_SUCCESS) {
      judge(which, scene, &reference, image, renderer, found);
    } else {
      const char *message = cellist_context_take_error(context);
      snprintf(found->message, sizeof found->message, "%s", message);
      found->verdict = drawn == CELLIST_ERROR_UNSUPPORTED && message[0] != '\0' ? STABILITY_REFUSED : STABILITY_FAILS;
      if (drawn == CELLIST_ERROR_OUT_OF_MEMORY) result = drawn;
    }
    cellist_image_destroy(image);
  }
  cellist_deallocate(context, reference.rgba);
  return result;
}
