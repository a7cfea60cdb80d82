/* SPDX-License-Identifier: BSD-3-Clause
 * What the sorter's benchmarks share: clocks, views, meshes by name and their arrays as the sorter takes them. */
#ifndef CELLIST_BENCH_SORTING_H
#define CELLIST_BENCH_SORTING_H

#include <cellist/generate.h>
#include <cellist/mesh.h>
#include <cellist/sort.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../chain/complex.h"
#include "../sort/desc.h"

static inline double bench_seconds(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline int bench_compare(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Sorts the times. */
static inline double bench_median(double *times, size_t count) {
  qsort(times, count, sizeof *times, bench_compare);
  return times[count / 2];
}

/* Says what went wrong and ends the program. */
static inline void bench_fail(cellist_context *context, const char *what) {
  fprintf(stderr, "%s: %s\n", what, cellist_context_take_error(context));
  exit(1);
}

/* View i of n perspective ones from all around, from where the mesh fills a picture of 30 degrees. */
static inline cellist_viewpoint bench_view(const double bounds[6], unsigned i, unsigned n) {
  cellist_viewpoint view = {{0, 0, 0}, false};
  const double z = (2 * i + 1.0) / n - 1, turn = 2.399963 * i, ring = sqrt(1 - z * z);
  const double direction[3] = {ring * cos(turn), ring * sin(turn), z};
  double half_diagonal = 0;
  for (int k = 0; k < 3; k++) half_diagonal += 0.25 * pow(bounds[3 + k] - bounds[k], 2);
  for (int k = 0; k < 3; k++)
    view.position[k] = 0.5 * (bounds[k] + bounds[3 + k]) + 3.86 * sqrt(half_diagonal) * direction[k];
  return view;
}

static inline bool bench_is_sample(const char *name) {
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++)
    if (strcmp(cellist_generator_name(i), name) == 0) return true;
  return false;
}

/* A sample of so many tets, or a mesh of the shared data. */
static inline cellist_result bench_open(cellist_context *context, const char *name, size_t size, cellist_mesh **mesh) {
  const cellist_generate_desc desc = {.size = size, .seed = 1};
  if (bench_is_sample(name)) return cellist_generate(context, name, &desc, mesh);
  char path[512];
  snprintf(path, sizeof path, "%s/data/%s.vtu", CELLIST_SHARED_DIR, name);
  return cellist_mesh_read(context, path, NULL, mesh);
}

#endif
