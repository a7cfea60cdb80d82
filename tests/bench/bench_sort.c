/* SPDX-License-Identifier: BSD-3-Clause
 * Sort benchmark: bench_sort [TETS] prints CSV: the sorter and its peers on a ball and a grid of TETS cells (1,000,000)
 * and on the shared data, over 12 views. Times of one thread are its processor time, so that a busy machine disturbs
 * them less; times of two threads are by the clock. Ratios are to the centroid sort of the same mesh and views. */
#include <cellist/generate.h>
#include <cellist/sort.h>
#include <cellist/sort_peers.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { VIEWS = 12, REPEATS = 3 };

static double seconds(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare_doubles(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void fail(cellist_context *context) {
  fprintf(stderr, "bench_sort: %s\n", cellist_context_take_error(context));
  exit(1);
}

/* General: perspective from all around; axis: parallel along the six axis directions. */
static cellist_viewpoint make_view(const double bounds[6], unsigned i, bool axis) {
  cellist_viewpoint view = {{0, 0, 0}, axis};
  const double z = (2 * i + 1.0) / VIEWS - 1, turn = 2.399963 * i, ring = sqrt(1 - z * z);
  const double direction[3] = {ring * cos(turn), ring * sin(turn), z};
  double half_diagonal = 0;
  for (int k = 0; k < 3; k++) half_diagonal += 0.25 * pow(bounds[3 + k] - bounds[k], 2);
  for (int k = 0; k < 3; k++)
    view.position[k] = 0.5 * (bounds[k] + bounds[3 + k]) + 3.86 * sqrt(half_diagonal) * direction[k];
  if (axis)
    for (unsigned k = 0; k < 3; k++) view.position[k] = k != i % 3 ? 0 : i % 6 < 3 ? 1 : -1;
  return view;
}

struct subject {
  const char *mesh_name;
  const double *bounds;
  size_t tet_count;
  cellist_sorter *sorter;
  cellist_peer *peer;
  uint32_t *order;
};

/* Median seconds a view. */
static double measure(cellist_context *context, const struct subject *subject, bool axis, clockid_t clock,
                      cellist_sort_stats *stats) {
  double times[VIEWS * REPEATS];
  size_t count = 0;
  for (unsigned i = 0; i < VIEWS; i++) {
    const cellist_viewpoint view = make_view(subject->bounds, i, axis);
    for (int r = 0; r < REPEATS; r++) {
      const double begin = seconds(clock);
      const cellist_result result = subject->peer != NULL
                                        ? cellist_peer_sort(subject->peer, &view, subject->order)
                                        : cellist_sorter_sort(subject->sorter, &view, subject->order, stats);
      times[count++] = seconds(clock) - begin;
      if (result != CELLIST_SUCCESS) fail(context);
    }
  }
  qsort(times, count, sizeof *times, compare_doubles);
  return times[count / 2];
}

static void print_row(const struct subject *subject, const char *method, const char *views, unsigned threads,
                      double time, double centroid, const cellist_sort_stats *stats) {
  printf("%s,%zu,%s,%s,%u,%.4f,%.2f,%.3f,%zu,%zu,%zu\n", subject->mesh_name, subject->tet_count, method, views, threads,
         1e3 * time, 1e9 * time / (double)subject->tet_count, time / centroid, stats->gap_candidate_count,
         stats->gap_arc_count, stats->exact_sign_count);
  fflush(stdout);
}

static void bench_mesh(cellist_context *context, cellist_context *two, const char *name, const cellist_mesh *mesh) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  const cellist_sorter_desc desc = {.point_count = a->point_count,
                                    .points = a->positions,
                                    .tet_count = a->tet_count,
                                    .tets = a->tets,
                                    .neighbours = a->neighbours};
  struct subject subject = {name, a->bounds, a->tet_count, NULL, NULL, malloc((a->tet_count + 1) * sizeof(uint32_t))};
  cellist_sort_stats stats = {0};
  double centroid = 0;
  if (subject.order == NULL) return;
  for (size_t i = 0; cellist_peer_name(i) != NULL; i++) {
    if (cellist_peer_create(context, &desc, cellist_peer_name(i), &subject.peer) != CELLIST_SUCCESS) fail(context);
    const double time = measure(context, &subject, false, CLOCK_THREAD_CPUTIME_ID, &stats);
    if (i == 0) centroid = time;
    print_row(&subject, cellist_peer_name(i), "general", 1, time, centroid, &stats);
    cellist_peer_destroy(subject.peer);
    subject.peer = NULL;
  }
  if (cellist_sorter_create(context, &desc, &subject.sorter) != CELLIST_SUCCESS) fail(context);
  double time = measure(context, &subject, false, CLOCK_THREAD_CPUTIME_ID, &stats);
  print_row(&subject, "cellist", "general", 1, time, centroid, &stats);
  time = measure(context, &subject, true, CLOCK_THREAD_CPUTIME_ID, &stats);
  print_row(&subject, "cellist", "axis", 1, time, centroid, &stats);
  time = measure(context, &subject, false, CLOCK_MONOTONIC, &stats);
  print_row(&subject, "cellist", "general_clock", 1, time, centroid, &stats);
  cellist_sorter_destroy(subject.sorter);
  if (cellist_sorter_create(two, &desc, &subject.sorter) != CELLIST_SUCCESS) fail(two);
  time = measure(two, &subject, false, CLOCK_MONOTONIC, &stats);
  print_row(&subject, "cellist", "general_clock", 2, time, centroid, &stats);
  cellist_sorter_destroy(subject.sorter);
  free(subject.order);
}

/* What 57 bytes a tet cost at this machine's streaming rate (a copy reads, allocates and writes each byte). */
static void print_limit(void) {
  const size_t size = (size_t)128 << 20;
  char *from = malloc(size), *to = malloc(size);
  if (from == NULL || to == NULL) return;
  double best = 1e9;
  for (int i = 0; i < 5; i++) {
    memset(from, i, size);
    const double begin = seconds(CLOCK_THREAD_CPUTIME_ID);
    memcpy(to, from, size);
    const double time = seconds(CLOCK_THREAD_CPUTIME_ID) - begin;
    if (i > 0 && time < best) best = time;
  }
  printf("limit,0,57 bytes a tet,general,1,0,%.2f,0,0,0,%d\n", 57 * best / (2 * (double)size) * 1e9, to[size / 2]);
  free(from);
  free(to);
}

int main(int argc, char **argv) {
  const size_t size = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000000;
  const cellist_context_desc one_worker = {.worker_count = 1}, two_workers = {.worker_count = 2};
  cellist_context *context = NULL, *two = NULL;
  if (cellist_context_create(&one_worker, &context) != CELLIST_SUCCESS) return 1;
  if (cellist_context_create(&two_workers, &two) != CELLIST_SUCCESS) return 1;
  printf("mesh,tets,method,views,threads,ms,ns_per_tet,ratio_to_centroid,gap_candidates,gap_arcs,exact_signs\n");
  print_limit();
  static const char *const samples[] = {"ball", "grid"};
  for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++) {
    const cellist_generate_desc desc = {.size = size};
    cellist_mesh *mesh = NULL;
    if (cellist_generate(context, samples[i], &desc, &mesh) != CELLIST_SUCCESS) fail(context);
    bench_mesh(context, two, samples[i], mesh);
    cellist_mesh_destroy(mesh);
  }
  static const char *const files[] = {"spx",      "octopus_low",  "sci_torso", "bunny_in", "impeller", "gears_t",
                                      "torus_vt", "disk_out_ref", "fire",      "bluntfin", "bucky",    "post"};
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    char path[512];
    cellist_mesh *mesh = NULL;
    snprintf(path, sizeof path, "%s/data/%s.vtu", CELLIST_SHARED_DIR, files[i]);
    if (cellist_mesh_read(context, path, NULL, &mesh) != CELLIST_SUCCESS) {
      fprintf(stderr, "bench_sort: %s\n", cellist_context_take_error(context));
      continue;
    }
    bench_mesh(context, two, files[i], mesh);
    cellist_mesh_destroy(mesh);
  }
  cellist_context_destroy(two);
  cellist_context_destroy(context);
  return 0;
}
