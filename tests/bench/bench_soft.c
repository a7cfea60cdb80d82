/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of the renderers without OpenGL: bench_soft [-tTHREADS] [MESH...], names of shared meshes (post.vtu; all of
 * them by default) or samples (sample:ball:1000000). Prints CSV, a line per mesh, size and renderer: sort_seconds and
 * draw_seconds are medians of frames seen from different places, half a degree apart (so that each is sorted),
 * processor_seconds is the least of a frame's processor time in all threads, order included, and processor_ns that over
 * fragments. chosen says which renderer the pipeline picks by itself. tests/bench/bench_vtk.py prints the same columns
 * for VTK. */
#define _POSIX_C_SOURCE 200809L
#include <cellist/pipeline.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 5 };

static const char *const SHARED[] = {"spx.vtu",   "can.vtu",          "gears_t.vtu",  "torus_vt.vtu",
                                     "fire.vtu",  "disk_out_ref.vtu", "impeller.vtu", "sci_torso.vtu",
                                     "bucky.vtu", "bluntfin.vtu",     "post.vtu",     "sample:ball:1000000"};

static double processor_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *values) {
  qsort(values, ROUNDS, sizeof *values, compare);
  return values[ROUNDS / 2];
}

typedef struct times {
  double sort[ROUNDS], draw[ROUNDS], processor;
  cellist_pipeline_stats stats;
} times;

static cellist_result measure(cellist_context *context, const cellist_mesh *mesh, cellist_renderer renderer,
                              uint32_t size, int rounds, times *made) {
  /* A thousand frames: that one frame decides the choice, not what is made once. */
  const cellist_pipeline_desc desc = {.mesh = mesh,
                                      .optics = {.unit_diagonal_fraction = 50},
                                      .renderer = renderer,
                                      .width = size,
                                      .height = size,
                                      .frames = 1000};
  cellist_pipeline *pipeline = NULL;
  cellist_result result = cellist_pipeline_create(context, &desc, &pipeline);
  made->processor = HUGE_VAL;
  for (int i = 0; i < rounds && result == CELLIST_SUCCESS; i++) {
    const cellist_view view = cellist_view_orbit(cellist_mesh_get_arrays(mesh)->bounds, 30.96 + 0.5 * i, 34.45);
    cellist_image *image = NULL;
    const double begin = processor_seconds();
    result = cellist_pipeline_draw(pipeline, &view, size, size, &image, &made->stats);
    made->processor = fmin(made->processor, processor_seconds() - begin);
    made->sort[i] = made->stats.sort_seconds;
    made->draw[i] = made->stats.draw_seconds;
    cellist_image_destroy(image);
  }
  cellist_pipeline_destroy(pipeline);
  return result;
}

static cellist_result bench(cellist_context *context, const char *name, uint32_t size, int counts[2]) {
  char path[1024];
  const bool is_sample = strncmp(name, "sample:", 7) == 0;
  snprintf(path, sizeof path, "%s%s%s", is_sample ? "" : CELLIST_SHARED_DIR, is_sample ? "" : "/data/", name);
  cellist_mesh *mesh = NULL;
  cellist_result result = cellist_pipeline_load(context, path, NULL, &mesh);
  times each[2], chosen;
  static const cellist_renderer renderers[2] = {CELLIST_RENDERER_SOFT, CELLIST_RENDERER_CAST};
  if (result == CELLIST_SUCCESS) result = measure(context, mesh, CELLIST_RENDERER_AUTO, size, 1, &chosen);
  for (int i = 0; i < 2 && result == CELLIST_SUCCESS; i++)
    result = measure(context, mesh, renderers[i], size, ROUNDS, &each[i]);
  if (result != CELLIST_SUCCESS) fprintf(stderr, "%s: %s\n", name, cellist_context_take_error(context));
  double total[2] = {0};
  for (int i = 0; i < 2 && result == CELLIST_SUCCESS; i++) {
    const double sort = median(each[i].sort), draw = median(each[i].draw);
    total[i] = each[i].processor;
    printf("%s,%u,%u,%s,%zu,%llu,%.5f,%.5f,%.5f,%.2f,%s\n", name, size, cellist_context_worker_count(context),
           each[i].stats.renderer, cellist_mesh_get_arrays(mesh)->tet_count,
           (unsigned long long)each[i].stats.fragments, sort, draw, each[i].processor,
           1e9 * each[i].processor / (double)each[i].stats.fragments, chosen.stats.renderer);
    fflush(stdout);
  }
  if (result == CELLIST_SUCCESS) {
    const bool soft_is_faster = total[0] < total[1], takes_soft = strcmp(chosen.stats.renderer, "soft") == 0;
    counts[soft_is_faster == takes_soft]++;
  }
  cellist_mesh_destroy(mesh);
  return result;
}

int main(int argc, char **argv) {
  cellist_context_desc desc = {.worker_count = 2};
  int first = 1;
  if (argc > 1 && strncmp(argv[1], "-t", 2) == 0) desc.worker_count = (unsigned)atoi(argv[first++] + 2);
  cellist_context *context = NULL;
  if (cellist_context_create(&desc, &context) != CELLIST_SUCCESS) return 1;
  printf("mesh,size,threads,renderer,tets,fragments,sort_seconds,draw_seconds,processor_seconds,processor_ns,chosen\n");
  int status = 0, counts[2] = {0};
  const int count = argc > first ? argc - first : (int)(sizeof SHARED / sizeof SHARED[0]);
  for (int i = 0; i < count; i++)
    for (uint32_t size = 512; size <= 1024; size += 512)
      if (bench(context, argc > first ? argv[first + i] : SHARED[i], size, counts) != CELLIST_SUCCESS) status = 1;
  fprintf(stderr, "the choice was the faster one %d times of %d\n", counts[1], counts[0] + counts[1]);
  cellist_context_destroy(context);
  return status;
}
