/* SPDX-License-Identifier: BSD-3-Clause
 * Soak: random small scenes for as long as one likes, each against the reference caster, its order by rays.
 *
 *   soak [--minutes M | --scenes N] [--seed S] [--first I]
 *
 * A pixel may be off by LIMIT of the picture's largest value. One that is further off is right all the same if the
 * reference takes on its value within SHIFT of a pixel: rays that graze an edge, cut a corner or run in a face see
 * something else there. What is left is a failure, and the command that repeats it is printed. */
#include <cellist/sort.h>
#include <cellist/sort_verify.h>
#include <clock.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "soak_scene.h"

/* Single precision in a few hundred cells of any opacity; smaller: rounding alone would fail; larger: a wrong cell in a
 * faint medium would pass. */
static const double LIMIT = 2e-4;
/* Of faces and soft under light by gradients at points, which they take once a segment unless --samples says more. */
static const double LIT_LIMIT = 0.25;
/* Pictures that are fainter are judged as if they were this bright: A is 1 - transmittance, in single precision. */
static const double FAINT = 0.05;
/* In pixels: some twenty times what rounding moves a corner by. */
static const double SHIFT = 1e-4;

enum { SHIFTS = 8, RAYS = 60, ORDER_EVERY = 4, REASON = 512, PROGRESS_EVERY = 1000 };

static const char *const CHANNELS[] = {"R", "G", "B", "A"};

struct totals {
  uint64_t scenes, failures, refused, pairs, pixels, shifted_pixels;
  double worst;
};

/* The view moved by a part of a pixel. */
static bool shifted(cellist_context *context, const cellist_view *view, const unsigned size[2], int step,
                    cellist_view *moved) {
  cellist_frame frame;
  if (cellist_frame_from_view(context, view, size[0], size[1], &frame) != CELLIST_SUCCESS) return false;
  static const int ways[SHIFTS][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  double distance = 0;
  for (int k = 0; k < 3; k++) distance = hypot(distance, view->target[k] - view->eye[k]);
  const double unit = frame.parallel ? 1 : distance;
  const double x = SHIFT * ways[step][0] * 2 * frame.half_width / size[0] * unit;
  const double y = SHIFT * ways[step][1] * 2 * frame.half_height / size[1] * unit;
  *moved = *view;
  for (int k = 0; k < 3; k++) {
    const double by = x * frame.right[k] + y * frame.up[k];
    moved->target[k] += by;
    if (frame.parallel) moved->eye[k] += by;
  }
  return true;
}

struct pictures {
  cellist_image *drawn, *reference, *moved[SHIFTS];
  size_t moved_count;
};

static void release(struct pictures *pictures) {
  cellist_image_destroy(pictures->drawn);
  cellist_image_destroy(pictures->reference);
  for (size_t i = 0; i < pictures->moved_count; i++) cellist_image_destroy(pictures->moved[i]);
}

static bool is_explained(const struct pictures *pictures, size_t pixel, double tolerance) {
  for (int k = 0; k < 4; k++) {
    double low = (double)cellist_image_channel(pictures->reference, CHANNELS[k])[pixel], high = low;
    for (size_t i = 0; i < pictures->moved_count; i++) {
      const double value = (double)cellist_image_channel(pictures->moved[i], CHANNELS[k])[pixel];
      low = fmin(low, value);
      high = fmax(high, value);
    }
    const double value = (double)cellist_image_channel(pictures->drawn, CHANNELS[k])[pixel];
    if (!(value >= low - tolerance && value <= high + tolerance)) return false;
  }
  return true;
}

/* Fills reason if the picture is not right. */
static cellist_result judge(cellist_pipeline *caster, cellist_context *context, const soak_scene *scene,
                            const cellist_view *view, struct pictures *pictures, struct totals *totals, char *reason) {
  const size_t count = (size_t)scene->size[0] * scene->size[1];
  double peak = 0;
  for (int k = 0; k < 4; k++)
    for (size_t i = 0; i < count; i++) {
      const float d = cellist_image_channel(pictures->drawn, CHANNELS[k])[i];
      const float r = cellist_image_channel(pictures->reference, CHANNELS[k])[i];
      if (!isfinite(d) || !isfinite(r)) {
        snprintf(reason, REASON, "pixel %zu,%zu: %s is %g, the reference %g", i % scene->size[0], i / scene->size[0],
                 CHANNELS[k], (double)d, (double)r);
        return CELLIST_SUCCESS;
      }
      peak = fmax(peak, fabs((double)r));
    }
  totals->pixels += count;
  /* Listed in README's limits: rays that lie in faces but for rounding. */
  const bool is_known = scene->is_along && scene->desc.renderer == CELLIST_RENDERER_FACES;
  if (scene->is_flawed || is_known) return CELLIST_SUCCESS;
  const bool is_sampled = scene->desc.renderer != CELLIST_RENDERER_CAST && scene->desc.optics.model.light.enabled;
  const double tolerance = (is_sampled ? LIT_LIMIT : LIMIT) * (peak > FAINT ? peak : FAINT);
  size_t wrong = 0, first = 0;
  double worst = 0;
  for (size_t i = 0; i < count; i++) {
    double difference = 0;
    for (int k = 0; k < 4; k++)
      difference = fmax(difference, fabs((double)cellist_image_channel(pictures->drawn, CHANNELS[k])[i] -
                                         (double)cellist_image_channel(pictures->reference, CHANNELS[k])[i]));
    if (!(difference > tolerance)) {
      totals->worst = fmax(totals->worst, peak > 0 ? difference / peak : difference);
      continue;
    }
    for (int s = 0; s < SHIFTS && pictures->moved_count <= (size_t)s; s++) {
      cellist_view moved;
      if (!shifted(context, view, scene->size, s, &moved)) break;
      const cellist_result result = cellist_pipeline_draw(caster, &moved, scene->size[0], scene->size[1],
                                                          &pictures->moved[pictures->moved_count], NULL);
      if (result != CELLIST_SUCCESS) return result;
      pictures->moved_count++;
    }
    if (is_explained(pictures, i, tolerance)) {
      totals->shifted_pixels++;
      continue;
    }
    if (difference > worst) worst = difference, first = i;
    wrong++;
  }
  if (wrong == 0) return CELLIST_SUCCESS;
  double d[4], r[4];
  for (int k = 0; k < 4; k++) {
    d[k] = (double)cellist_image_channel(pictures->drawn, CHANNELS[k])[first];
    r[k] = (double)cellist_image_channel(pictures->reference, CHANNELS[k])[first];
  }
  snprintf(reason, REASON, "%zu of %zu pixels are wrong; %zu,%zu is %.6g %.6g %.6g %.6g instead of %.6g %.6g %.6g %.6g",
           wrong, count, first % scene->size[0], first / scene->size[0], d[0], d[1], d[2], d[3], r[0], r[1], r[2],
           r[3]);
  return CELLIST_SUCCESS;
}

static cellist_result check_order(cellist_context *context, const cellist_mesh *mesh, const cellist_view *view,
                                  struct totals *totals, char *reason) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  cellist_viewpoint viewpoint = {.parallel = view->parallel_height > 0};
  for (int k = 0; k < 3; k++)
    viewpoint.position[k] = viewpoint.parallel ? view->target[k] - view->eye[k] : view->eye[k];
  cellist_sorter *sorter = NULL;
  cellist_verifier *verifier = NULL;
  cellist_verification found = {0};
  const cellist_group *groups = NULL;
  size_t group_count = 0;
  uint32_t *order = cellist_allocate(context, arrays->tet_count, sizeof *order);
  cellist_result result = order != NULL ? cellist_sorter_create(context, &desc, &sorter) : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) result = cellist_sorter_sort(sorter, &viewpoint, order, NULL);
  if (result == CELLIST_SUCCESS) cellist_sorter_groups(sorter, &groups, &group_count);
  if (result == CELLIST_SUCCESS) result = cellist_verifier_create(context, &desc, &verifier);
  if (result == CELLIST_SUCCESS)
    result = cellist_verifier_check(verifier, &viewpoint, order, groups, group_count, RAYS, 1, &found);
  totals->pairs += found.pairs;
  if (result == CELLIST_SUCCESS && found.inversions > 0)
    snprintf(reason, REASON, "%zu of %zu pairs along rays are the wrong way round (cellist sort --verify)",
             found.inversions, found.pairs);
  cellist_verifier_destroy(verifier);
  cellist_sorter_destroy(sorter);
  cellist_deallocate(context, order);
  return result;
}

static void run_scene(const soak_scene *scene, bool checks_order, struct totals *totals, char *reason) {
  cellist_context *context = NULL;
  cellist_pipeline *caster = NULL, *pipeline = NULL;
  struct pictures pictures = {0};
  if (cellist_context_create(&(cellist_context_desc){.worker_count = scene->threads}, &context) != CELLIST_SUCCESS)
    abort();
  cellist_pipeline_desc desc = scene->desc;
  desc.renderer = CELLIST_RENDERER_CAST;
  desc.precision = CELLIST_PRECISION_REFERENCE;
  desc.no_plan = true;
  cellist_view view = {0};
  const char *stage = "the reference";
  cellist_result result = cellist_pipeline_create(context, &desc, &caster);
  if (result == CELLIST_SUCCESS) {
    view_options_resolve(&scene->camera, cellist_mesh_get_arrays(cellist_pipeline_mesh(caster))->bounds, &view);
    result = cellist_pipeline_draw(caster, &view, scene->size[0], scene->size[1], &pictures.reference, NULL);
  }
  if (result == CELLIST_SUCCESS) {
    stage = "the renderer";
    result = cellist_pipeline_create(context, &scene->desc, &pipeline);
  }
  if (result == CELLIST_SUCCESS)
    result = cellist_pipeline_draw(pipeline, &view, scene->size[0], scene->size[1], &pictures.drawn, NULL);
  if (result == CELLIST_ERROR_UNSUPPORTED && cellist_context_take_error(context)[0] != '\0') {
    totals->refused++;
    result = CELLIST_SUCCESS;
  } else if (result == CELLIST_SUCCESS) {
    stage = "comparing";
    result = judge(caster, context, scene, &view, &pictures, totals, reason);
  }
  if (result == CELLIST_SUCCESS && checks_order && !scene->is_flawed && reason[0] == '\0') {
    stage = "the order";
    result = check_order(context, cellist_pipeline_mesh(caster), &view, totals, reason);
  }
  if (result != CELLIST_SUCCESS)
    snprintf(reason, REASON, "%s: %s (%s)", stage, cellist_result_string(result), cellist_context_take_error(context));
  release(&pictures);
  cellist_pipeline_destroy(pipeline);
  cellist_pipeline_destroy(caster);
  cellist_context_destroy(context);
}

static void print_progress(const struct totals *totals, double seconds) {
  printf(
      "%llu scenes in %.0f s, %llu failures; largest error %.1e, %llu of %llu pixels explained by a shift of %g "
      "pixels, %llu pairs in order, %llu refused\n",
      (unsigned long long)totals->scenes, seconds, (unsigned long long)totals->failures, totals->worst,
      (unsigned long long)totals->shifted_pixels, (unsigned long long)totals->pixels, SHIFT,
      (unsigned long long)totals->pairs, (unsigned long long)totals->refused);
  fflush(stdout);
}

int main(int argc, char **argv) {
  static const struct option options[] = {{"minutes", required_argument, NULL, 'm'},
                                          {"scenes", required_argument, NULL, 'n'},
                                          {"seed", required_argument, NULL, 's'},
                                          {"first", required_argument, NULL, 'f'},
                                          {0}};
  double minutes = HUGE_VAL;
  uint64_t scenes = UINT64_MAX, seed = 1, first = 0;
  for (int code; (code = getopt_long(argc, argv, "", options, NULL)) != -1;) switch (code) {
      case 'm': minutes = strtod(optarg, NULL); break;
      case 'n': scenes = strtoull(optarg, NULL, 10); break;
      case 's': seed = strtoull(optarg, NULL, 10); break;
      case 'f': first = strtoull(optarg, NULL, 10); break;
      default: fprintf(stderr, "usage: soak [--minutes M | --scenes N] [--seed S] [--first I]\n"); return 2;
    }
  if (isinf(minutes) && scenes == UINT64_MAX) scenes = 10000;
  const double begin = clock_seconds();
  struct totals totals = {0};
  while (totals.scenes < scenes && clock_seconds() - begin < 60 * minutes) {
    const uint64_t index = first + totals.scenes++;
    soak_scene scene;
    char reason[REASON] = "";
    soak_scene_make(seed, index, &scene);
    run_scene(&scene, index % ORDER_EVERY == 0, &totals, reason);
    if (reason[0] != '\0') {
      totals.failures++;
      printf("FAILED scene %llu of seed %llu: %s\n", (unsigned long long)index, (unsigned long long)seed, reason);
      soak_scene_print(&scene);
      fflush(stdout);
    }
    if (totals.scenes % PROGRESS_EVERY == 0) print_progress(&totals, clock_seconds() - begin);
  }
  print_progress(&totals, clock_seconds() - begin);
  return totals.failures > 0;
}
