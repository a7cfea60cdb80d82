/* SPDX-License-Identifier: BSD-3-Clause
 * Soak: random small scenes for as long as one likes, each against the reference caster (soak_judge.c), every fourth
 * one's order by rays, every eighth one again with another number of threads, bit by bit.
 *
 *   soak [--minutes M | --scenes N] [--seed S] [--first I]
 *
 * A failure prints the command that repeats it; a scene that takes longer than PATIENCE is one. */
#include <cellist/sort.h>
#include <cellist/sort_verify.h>
#include <clock.h>
#include <getopt.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "soak_judge.h"

/* Seconds: a hundred times what the slowest scene takes on an idle machine. */
enum { RAYS = 60, ORDER_EVERY = 4, THREADS_EVERY = 8, PROGRESS_EVERY = 1000, PATIENCE = 600 };

static cellist_result check_order(cellist_context *context, const cellist_mesh *mesh, const cellist_view *view,
                                  soak_totals *totals, char *reason) {
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
    snprintf(reason, SOAK_REASON, "%zu of %zu pairs along rays are the wrong way round (cellist sort --verify)",
             found.inversions, found.pairs);
  cellist_verifier_destroy(verifier);
  cellist_sorter_destroy(sorter);
  cellist_deallocate(context, order);
  return result;
}

static cellist_result draw_with(cellist_context *context, const soak_scene *scene, const cellist_view *view,
                                cellist_image **image) {
  cellist_pipeline *pipeline = NULL;
  cellist_result result = cellist_pipeline_create(context, &scene->desc, &pipeline);
  if (result == CELLIST_SUCCESS)
    result = cellist_pipeline_draw(pipeline, view, scene->size[0], scene->size[1], image, NULL);
  cellist_pipeline_destroy(pipeline);
  return result;
}

/* The same picture with another number of threads. */
static cellist_result check_threads(const soak_scene *scene, const cellist_view *view, const cellist_image *drawn,
                                    soak_totals *totals, char *reason) {
  cellist_context *context = NULL;
  cellist_image *again = NULL;
  if (cellist_context_create(&(cellist_context_desc){.worker_count = scene->threads == 1 ? 3 : 1}, &context) !=
      CELLIST_SUCCESS)
    abort();
  const cellist_result result = draw_with(context, scene, view, &again);
  if (result == CELLIST_SUCCESS) soak_judge_same(scene, drawn, again, reason);
  totals->repeated++;
  cellist_image_destroy(again);
  cellist_context_destroy(context);
  return result;
}

/* The convexifier may refuse a mesh if it says why. Renderers draw every scene. */
static bool is_refusal(const soak_scene *scene, cellist_result result, const char *message) {
  const bool convexifies = scene->desc.order.exterior >= CELLIST_ORDER_HULL;
  return convexifies && (result == CELLIST_ERROR_UNSUPPORTED || result == CELLIST_ERROR_GEOMETRY) && message[0] != '\0';
}

static void run_scene(const soak_scene *scene, uint64_t index, soak_totals *totals, char *reason) {
  cellist_context *context = NULL;
  cellist_pipeline *caster = NULL;
  cellist_image *drawn = NULL, *reference = NULL;
  if (cellist_context_create(&(cellist_context_desc){.worker_count = scene->threads}, &context) != CELLIST_SUCCESS)
    abort();
  cellist_pipeline_desc desc = scene->desc;
  desc.renderer = CELLIST_RENDERER_CAST;
  desc.precision = CELLIST_PRECISION_REFERENCE;
  desc.no_plan = true;
  cellist_view view = {0};
  const char *stage = "the reference", *message = "";
  cellist_result result = cellist_pipeline_create(context, &desc, &caster);
  if (result == CELLIST_SUCCESS) {
    view_options_resolve(&scene->camera, cellist_mesh_get_arrays(cellist_pipeline_mesh(caster))->bounds, &view);
    result = cellist_pipeline_draw(caster, &view, scene->size[0], scene->size[1], &reference, NULL);
  }
  if (result == CELLIST_SUCCESS) {
    stage = "the renderer";
    result = draw_with(context, scene, &view, &drawn);
    if (result != CELLIST_SUCCESS) message = cellist_context_take_error(context);
    if (is_refusal(scene, result, message)) {
      totals->refused++;
      result = CELLIST_SUCCESS;
    }
  }
  if (result == CELLIST_SUCCESS && drawn != NULL) {
    stage = "comparing";
    result = soak_judge(context, caster, scene, &view, drawn, reference, totals, reason);
  }
  if (result == CELLIST_SUCCESS && drawn != NULL && index % THREADS_EVERY == 1 && reason[0] == '\0') {
    stage = "another number of threads";
    result = check_threads(scene, &view, drawn, totals, reason);
  }
  if (result == CELLIST_SUCCESS && index % ORDER_EVERY == 0 && !scene->is_flawed && reason[0] == '\0') {
    stage = "the order";
    result = check_order(context, cellist_pipeline_mesh(caster), &view, totals, reason);
  }
  if (result != CELLIST_SUCCESS)
    snprintf(reason, SOAK_REASON, "%s: %s (%s)", stage, cellist_result_string(result),
             message[0] != '\0' ? message : cellist_context_take_error(context));
  cellist_image_destroy(drawn);
  cellist_image_destroy(reference);
  cellist_pipeline_destroy(caster);
  cellist_context_destroy(context);
}

/* What hangs_handler says. */
static char hangs_text[128];

static void hangs_handler(int signal) {
  (void)signal;
  if (write(STDOUT_FILENO, hangs_text, strlen(hangs_text)) < 0) _exit(2);
  _exit(1);
}

static void watch(uint64_t seed, uint64_t index) {
  snprintf(hangs_text, sizeof hangs_text, "HANGS: soak --seed %llu --first %llu --scenes 1\n", (unsigned long long)seed,
           (unsigned long long)index);
  alarm(PATIENCE);
}

/* Interrupted, it ends after the scene that it is at, and says what it found. */
static volatile sig_atomic_t is_interrupted;

static void interrupt_handler(int signal) {
  (void)signal;
  is_interrupted = 1;
}

static void print_progress(const soak_totals *totals, double seconds) {
  printf(
      "%llu scenes in %.0f s, %llu failures; %llu of %llu pixels explained by a small shift, %llu pairs in order, "
      "%llu repeated with other threads, %llu exteriors refused\n",
      (unsigned long long)totals->scenes, seconds, (unsigned long long)totals->failures,
      (unsigned long long)totals->shifted_pixels, (unsigned long long)totals->pixels, (unsigned long long)totals->pairs,
      (unsigned long long)totals->repeated, (unsigned long long)totals->refused);
  fflush(stdout);
}

static void print_kinds(const soak_totals *totals) {
  printf("largest errors, in parts of a picture's largest value:\n");
  for (size_t i = 0; i < totals->kind_count; i++) {
    const soak_kind *kind = &totals->kinds[i];
    printf("  %-22s %6llu scenes  %.1e of %.1e", kind->name, (unsigned long long)kind->scenes, kind->worst,
           kind->limit);
    if (kind->most_strays > 0) printf(", up to %.2g of the pixels more", kind->most_strays);
    printf("\n");
  }
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
  signal(SIGALRM, hangs_handler);
  signal(SIGINT, interrupt_handler);
  const double begin = clock_seconds();
  soak_totals totals = {0};
  while (!is_interrupted && totals.scenes < scenes && clock_seconds() - begin < 60 * minutes) {
    const uint64_t index = first + totals.scenes++;
    soak_scene scene;
    char reason[SOAK_REASON] = "";
    soak_scene_make(seed, index, &scene);
    watch(seed, index);
    run_scene(&scene, index, &totals, reason);
    if (reason[0] != '\0') {
      totals.failures++;
      printf("FAILED scene %llu of seed %llu: %s\n", (unsigned long long)index, (unsigned long long)seed, reason);
      soak_scene_print(&scene);
      fflush(stdout);
    }
    if (totals.scenes % PROGRESS_EVERY == 0) print_progress(&totals, clock_seconds() - begin);
  }
  print_progress(&totals, clock_seconds() - begin);
  print_kinds(&totals);
  return totals.failures > 0;
}
