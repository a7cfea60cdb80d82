/* SPDX-License-Identifier: BSD-3-Clause
 * Chain benchmark: bench_chain [VIEWS [MESH...]] prints CSV: how long the exact order of concave meshes takes with each
 * exterior and with none, against a plain topological sort of the tets alone (wrong: it ignores gaps). Processor time
 * of one thread, medians over VIEWS (12) perspective views; counts are means over these. */
#include "../../sort/sorter.h"
#include "sorting.h"

enum { REPEATS = 5, MOST_VIEWS = 200 };

static void fail(cellist_context *context) { bench_fail(context, "bench_chain"); }

/* One sorter's median over all views; prints a row. plain: 0, or what to compare with. */
static double measure(cellist_context *context, const cellist_mesh *mesh, const char *name, const char *exterior,
                      const cellist_complex *complex, unsigned views, double plain) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  cellist_sorter_complex arrays = {0};
  cellist_sorter_desc desc = sorter_desc_of(mesh);
  if (complex != NULL) {
    arrays = sorter_complex_of(complex);
    desc.complex = &arrays;
  }
  cellist_sorter *sorter = NULL;
  if (cellist_sorter_create(context, &desc, &sorter) != CELLIST_SUCCESS) fail(context);
  if (plain == 0) sorter->convex = true; /* gaps are ignored */
  uint32_t *order = malloc((a->tet_count + 1) * sizeof *order);
  static double times[MOST_VIEWS];
  double left = 0, component = 0, candidates = 0, arcs = 0, groups = 0, grouped = 0;
  cellist_sort_stats stats = {0};
  for (unsigned i = 0; i < views; i++) {
    const cellist_viewpoint view = bench_view(a->bounds, i, views);
    times[i] = HUGE_VAL;
    for (int r = 0; r < REPEATS; r++) {
      sorter->is_current = false;
      const double begin = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
      if (cellist_sorter_sort(sorter, &view, order, &stats) != CELLIST_SUCCESS) fail(context);
      times[i] = fmin(times[i], bench_seconds(CLOCK_THREAD_CPUTIME_ID) - begin);
    }
    left += (double)stats.left_cell_count / views;
    component += (double)stats.component_cell_count / views;
    candidates += (double)stats.gap_candidate_count / views;
    arcs += (double)stats.gap_arc_count / views;
    groups += (double)stats.group_count / views;
    grouped += (double)stats.cells_in_groups / views;
  }
  const double time = bench_median(times, views);
  printf("%s,%zu,%s,%zu,%u,%.4f,%.2f,%.3f,%.1f,%.1f,%.1f,%.1f,%.2f,%.1f\n", name, a->tet_count, exterior,
         stats.imaginary_cell_count, views, 1e3 * time, 1e9 * time / (double)a->tet_count, plain > 0 ? time / plain : 1,
         left, component, candidates, arcs, groups, grouped);
  fflush(stdout);
  free(order);
  cellist_sorter_destroy(sorter);
  return time;
}

static void bench_mesh(cellist_context *context, const char *name, const cellist_mesh *mesh, unsigned views) {
  const double plain = measure(context, mesh, name, "ignored", NULL, views, 0);
  measure(context, mesh, name, "none", NULL, views, plain);
  static const struct {
    const char *name;
    cellist_exterior exterior;
  } exteriors[] = {
      {"hull", CELLIST_EXTERIOR_HULL}, {"grid", CELLIST_EXTERIOR_GRID}, {"delaunay", CELLIST_EXTERIOR_DELAUNAY}};
  for (size_t e = 0; e < sizeof exteriors / sizeof exteriors[0]; e++) {
    const cellist_convexify_desc desc = {.exterior = exteriors[e].exterior};
    cellist_complex *complex = NULL;
    if (cellist_convexify(context, mesh, &desc, &complex, NULL) != CELLIST_SUCCESS) {
      fprintf(stderr, "bench_chain: %s, %s: %s\n", name, exteriors[e].name, cellist_context_take_error(context));
      continue;
    }
    measure(context, mesh, name, exteriors[e].name, complex, views, plain);
    cellist_complex_destroy(complex);
  }
}

int main(int argc, char **argv) {
  const unsigned views = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 12;
  static const char *const usual[] = {"spx",      "octopus_low", "sci_torso", "bunny_in",
                                      "impeller", "torus_vt",    "bluntfin"};
  const size_t usual_count = sizeof usual / sizeof usual[0];
  const cellist_context_desc one_worker = {.worker_count = 1};
  cellist_context *context = NULL;
  if (views < 1 || views > MOST_VIEWS || cellist_context_create(&one_worker, &context) != CELLIST_SUCCESS) return 1;
  printf(
      "mesh,tets,exterior,imaginary_cells,views,ms,ns_per_tet,ratio_to_plain,left_cells,component_cells,"
      "gap_candidates,gap_arcs,groups,cells_in_groups\n");
  for (size_t i = 0; argc > 2 ? i + 2 < (size_t)argc : i < usual_count; i++) {
    const char *name = argc > 2 ? argv[i + 2] : usual[i];
    cellist_mesh *mesh = NULL;
    const bool is_sample = strncmp(name, "sample:", 7) == 0;
    if (bench_open(context, is_sample ? name + 7 : name, 20000, &mesh) != CELLIST_SUCCESS) {
      fprintf(stderr, "bench_chain: %s\n", cellist_context_take_error(context));
      continue;
    }
    bench_mesh(context, name, mesh, views);
    cellist_mesh_destroy(mesh);
  }
  cellist_context_destroy(context);
  return 0;
}
