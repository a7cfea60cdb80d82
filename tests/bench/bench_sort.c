/* SPDX-License-Identifier: BSD-3-Clause
 * Sort benchmark: bench_sort [TETS [MESH...]] prints CSV: the sorter and its peers on a ball and a grid of TETS cells
 * (1,000,000), on all other samples and on the shared data, or on the MESHes named alone, over 12 views.
 * "cellist" is the sorter without a complex, "cellist_complex" with a Delaunay exterior. Times of one thread are its
 * processor time, medians; views "clock" compares one thread with two by the clock, in turns, by the fastest of each
 * view, since others use the processors too. Ratios are to the centroid sort of the same views, which takes turns with
 * each method (clock: to one thread). Inversions are those that rays find in the first three views. */
#include <cellist/sort_peers.h>
#include <cellist/sort_verify.h>

#include "../../sort/sorter.h"
#include "sorting.h"

enum { VIEWS = 12, REPEATS = 3, CLOCK_REPEATS = 12, CHECKED_VIEWS = 3, RAYS = 1000 };

static void fail(cellist_context *context) { bench_fail(context, "bench_sort"); }

/* General: perspective from all around; axis: parallel along the six axis directions. */
static cellist_viewpoint make_view(const double bounds[6], unsigned i, bool axis) {
  cellist_viewpoint view = bench_view(bounds, i, VIEWS);
  view.parallel = axis;
  for (unsigned k = 0; k < 3 && axis; k++) view.position[k] = k != i % 3 ? 0 : i % 6 < 3 ? 1 : -1;
  return view;
}

struct subject {
  const char *mesh_name;
  const double *bounds;
  size_t tet_count;
  cellist_verifier *verifier;
  cellist_sorter *sorter;
  cellist_peer *peer;
  cellist_peer *centroid; /* what all are compared with */
  uint32_t *order, *centroid_order;
};

static cellist_result sort_once(const struct subject *subject, const cellist_viewpoint *view,
                                cellist_sort_stats *stats) {
  return subject->peer != NULL ? cellist_peer_sort(subject->peer, view, subject->order)
                               : cellist_sorter_sort(subject->sorter, view, subject->order, stats);
}

static void print_row(const struct subject *subject, const char *method, const char *views, unsigned threads,
                      double time, double ratio, const cellist_sort_stats *stats, const cellist_verification *found) {
  printf("%s,%zu,%s,%s,%u,%.4f,%.2f,%.3f,%zu,%zu,%zu,%zu,%zu\n", subject->mesh_name, subject->tet_count, method, views,
         threads, 1e3 * time, 1e9 * time / (double)subject->tet_count, ratio, stats->gap_candidate_count,
         stats->gap_arc_count, stats->exact_sign_count, found->pairs, found->inversions);
  fflush(stdout);
}

/* One thread's processor time a view. */
static void bench_method(cellist_context *context, const struct subject *subject, const char *method, bool axis) {
  double times[VIEWS * REPEATS], centroid_times[VIEWS * REPEATS];
  size_t count = 0;
  cellist_sort_stats stats = {0};
  cellist_verification all = {0}, found;
  for (unsigned i = 0; i < VIEWS; i++) {
    const cellist_viewpoint view = make_view(subject->bounds, i, axis);
    for (int r = 0; r < REPEATS; r++) {
      const double begin = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
      if (cellist_peer_sort(subject->centroid, &view, subject->centroid_order) != CELLIST_SUCCESS) fail(context);
      const double middle = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
      if (sort_once(subject, &view, &stats) != CELLIST_SUCCESS) fail(context);
      times[count] = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - middle;
      centroid_times[count++] = middle - begin;
    }
    if (i >= CHECKED_VIEWS) continue;
    const cellist_group *groups = NULL;
    size_t group_count = 0;
    if (subject->sorter != NULL) cellist_sorter_groups(subject->sorter, &groups, &group_count);
    if (cellist_verifier_check(subject->verifier, &view, subject->order, groups, group_count, RAYS, i, &found) !=
        CELLIST_SUCCESS)
      fail(context);
    all.pairs += found.pairs;
    all.inversions += found.inversions;
  }
  const double time = bench_median(times, count), centroid = bench_median(centroid_times, count);
  print_row(subject, method, axis ? "axis" : "general", 1, time, time / centroid, &stats, &all);
}

/* One thread and two, in turns, so that what else the machine does meets both. */
static void bench_threads(cellist_context *context, cellist_context *two, const cellist_sorter_desc *desc,
                          struct subject subject) {
  cellist_sorter *sorters[2] = {NULL, NULL};
  double best[2][VIEWS], sums[2] = {0, 0};
  cellist_sort_stats stats = {0};
  if (cellist_sorter_create(context, desc, &sorters[0]) != CELLIST_SUCCESS) fail(context);
  if (cellist_sorter_create(two, desc, &sorters[1]) != CELLIST_SUCCESS) fail(two);
  for (unsigned i = 0; i < VIEWS; i++) {
    const cellist_viewpoint view = make_view(subject.bounds, i, false);
    best[0][i] = best[1][i] = HUGE_VAL;
    for (int r = 0; r < 2 * CLOCK_REPEATS; r++) {
      subject.sorter = sorters[r % 2];
      const double begin = bench_seconds(CLOCK_MONOTONIC);
      if (sort_once(&subject, &view, &stats) != CELLIST_SUCCESS) fail(r % 2 ? two : context);
      best[r % 2][i] = fmin(best[r % 2][i], bench_seconds(CLOCK_MONOTONIC) - begin);
    }
    for (int t = 0; t < 2; t++) sums[t] += best[t][i] / VIEWS;
  }
  for (unsigned t = 0; t < 2; t++) {
    print_row(&subject, "cellist", "clock", t + 1, sums[t], sums[t] / sums[0], &stats, &(cellist_verification){0});
    cellist_sorter_destroy(sorters[t]);
  }
}

static void bench_complex(cellist_context *context, const cellist_mesh *mesh, cellist_sorter_desc desc,
                          struct subject subject) {
  cellist_complex *complex = NULL;
  const cellist_convexify_desc exterior = {.exterior = CELLIST_EXTERIOR_DELAUNAY};
  if (cellist_convexify(context, mesh, &exterior, &complex, NULL) != CELLIST_SUCCESS) {
    fprintf(stderr, "bench_sort: %s: %s\n", subject.mesh_name, cellist_context_take_error(context));
    return;
  }
  const cellist_sorter_complex arrays = sorter_complex_of(complex);
  desc.complex = &arrays;
  if (cellist_sorter_create(context, &desc, &subject.sorter) != CELLIST_SUCCESS) fail(context);
  bench_method(context, &subject, "cellist_complex", false);
  cellist_sorter_destroy(subject.sorter);
  cellist_complex_destroy(complex);
}

static void bench_mesh(cellist_context *context, cellist_context *two, const char *name, const cellist_mesh *mesh) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  struct subject subject = {.mesh_name = name,
                            .bounds = a->bounds,
                            .tet_count = a->tet_count,
                            .order = calloc(a->tet_count + 1, sizeof(uint32_t)),
                            .centroid_order = calloc(a->tet_count + 1, sizeof(uint32_t))};
  if (subject.order == NULL || subject.centroid_order == NULL) exit(1);
  if (cellist_peer_create(context, &desc, "centroid", &subject.centroid) != CELLIST_SUCCESS) fail(context);
  if (cellist_verifier_create(context, &desc, &subject.verifier) != CELLIST_SUCCESS) fail(context);
  for (size_t i = 0; cellist_peer_name(i) != NULL; i++) {
    if (cellist_peer_create(context, &desc, cellist_peer_name(i), &subject.peer) != CELLIST_SUCCESS) fail(context);
    bench_method(context, &subject, cellist_peer_name(i), false);
    cellist_peer_destroy(subject.peer);
    subject.peer = NULL;
  }
  if (cellist_sorter_create(context, &desc, &subject.sorter) != CELLIST_SUCCESS) fail(context);
  bench_method(context, &subject, "cellist", false);
  bench_method(context, &subject, "cellist", true);
  const bool has_gaps = !subject.sorter->convex;
  cellist_sorter_destroy(subject.sorter);
  subject.sorter = NULL;
  if (has_gaps) bench_complex(context, mesh, desc, subject);
  bench_threads(context, two, &desc, subject);
  cellist_verifier_destroy(subject.verifier);
  cellist_peer_destroy(subject.centroid);
  free(subject.order);
  free(subject.centroid_order);
}

static void bench_named(cellist_context *context, cellist_context *two, const char *name, size_t size) {
  cellist_mesh *mesh = NULL;
  if (bench_open(context, name, size, &mesh) != CELLIST_SUCCESS) {
    fprintf(stderr, "bench_sort: %s\n", cellist_context_take_error(context));
    return;
  }
  bench_mesh(context, two, name, mesh);
  cellist_mesh_destroy(mesh);
}

/* What 57 bytes a tet cost at this machine's streaming rate (a copy reads, allocates and writes each byte). */
static void print_limit(void) {
  const size_t size = (size_t)128 << 20;
  char *from = malloc(size), *to = malloc(size);
  if (from == NULL || to == NULL) return;
  double best = 1e9;
  for (int i = 0; i < 5; i++) {
    memset(from, i, size);
    const double begin = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
    memcpy(to, from, size);
    const double time = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - begin;
    if (i > 0 && time < best) best = time;
  }
  printf("limit,0,57 bytes a tet,general,1,0,%.2f,0,0,0,0,%d\n", 57 * best / (2 * (double)size) * 1e9, to[size / 2]);
  free(from);
  free(to);
}

int main(int argc, char **argv) {
  const size_t size = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000000;
  const cellist_context_desc one_worker = {.worker_count = 1}, two_workers = {.worker_count = 2};
  cellist_context *context = NULL, *two = NULL;
  if (cellist_context_create(&one_worker, &context) != CELLIST_SUCCESS) return 1;
  if (cellist_context_create(&two_workers, &two) != CELLIST_SUCCESS) return 1;
  printf("mesh,tets,method,views,threads,ms,ns_per_tet,ratio,gap_candidates,gap_arcs,exact_signs,pairs,inversions\n");
  print_limit();
  for (int i = 2; i < argc; i++) bench_named(context, two, argv[i], size);
  static const char *const files[] = {"spx",      "octopus_low",  "sci_torso", "bunny_in", "impeller", "gears_t",
                                      "torus_vt", "disk_out_ref", "fire",      "bluntfin", "bucky",    "post"};
  for (size_t i = 0; argc <= 2 && cellist_generator_name(i) != NULL; i++) {
    const char *name = cellist_generator_name(i);
    const bool is_large = strcmp(name, "ball") == 0 || strcmp(name, "grid") == 0;
    if (strcmp(name, "flaws") != 0) bench_named(context, two, name, is_large ? size : 20000);
  }
  for (size_t i = 0; argc <= 2 && i < sizeof files / sizeof files[0]; i++) bench_named(context, two, files[i], 0);
  cellist_context_destroy(two);
  cellist_context_destroy(context);
  return 0;
}
