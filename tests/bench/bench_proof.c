/* SPDX-License-Identifier: BSD-3-Clause
 * Proof: bench_proof [MESH...] sorts every mesh of the shared data (but can and can_hex, which overlap themselves) and
 * every sample (but flaws) with no exterior and with each one, from 100 views (perspective from far and near, inside
 * the bounds, on a lattice, parallel, parallel along axes and diagonals), and checks each order by 200 rays and by its
 * certificate. Prints CSV; a row with unsorted, inversions or violations other than 0 is a bug. */
#include <cellist/sort_verify.h>

#include <base/random.h>

#include "sorting.h"

enum { VIEWS = 100, RAYS = 200 };

static cellist_viewpoint make_view(const double bounds[6], unsigned i) {
  static const double reach[6] = {10, 1.2, 0.5, 0.5, 1, 1};
  random_state random = {i};
  cellist_viewpoint view = {{0, 0, 0}, i % 6 >= 4};
  for (int k = 0; k < 3; k++) {
    double at = reach[i % 6] * random_between(&random, -1, 1) + (view.parallel ? 0 : 0.5);
    if (i % 6 == 3) at = floor(8 * at) / 8;
    if (i % 6 == 5) at = (double)random_below(&random, 3) - 1;
    view.position[k] = view.parallel ? at : bounds[k] + at * (bounds[3 + k] - bounds[k]);
  }
  if (view.parallel && view.position[0] == 0 && view.position[1] == 0 && view.position[2] == 0) view.position[2] = 1;
  return view;
}

static void prove(cellist_context *context, const cellist_mesh *mesh, const char *name, const char *exterior,
                  const cellist_complex *complex) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  cellist_sorter_complex arrays = {0};
  cellist_sorter_desc desc = sorter_desc_of(mesh);
  if (complex != NULL) {
    arrays = sorter_complex_of(complex);
    desc.complex = &arrays;
  }
  cellist_sorter *sorter = NULL;
  cellist_verifier *verifier = NULL;
  uint32_t *order = malloc((a->tet_count + 1) * sizeof *order);
  uint8_t *seen = malloc(a->tet_count + 1);
  if (order == NULL || seen == NULL || cellist_sorter_create(context, &desc, &sorter) != CELLIST_SUCCESS ||
      cellist_verifier_create(context, &desc, &verifier) != CELLIST_SUCCESS)
    bench_fail(context, name);
  size_t rays = 0, pairs = 0, group_pairs = 0, inversions = 0, violations = 0, unsorted = 0, overlaps = 0, groups = 0,
         grouped = 0, largest = 0;
  for (unsigned i = 0; i < VIEWS; i++) {
    const cellist_viewpoint view = make_view(a->bounds, i);
    cellist_sort_stats stats;
    cellist_verification found;
    cellist_certificate certificate;
    const cellist_group *list = NULL;
    size_t count = 0;
    if (cellist_sorter_sort(sorter, &view, order, &stats) != CELLIST_SUCCESS) bench_fail(context, name);
    cellist_sorter_groups(sorter, &list, &count);
    if (cellist_verifier_check(verifier, &view, order, list, count, RAYS, i, &found) != CELLIST_SUCCESS ||
        cellist_order_certify(context, &desc, &view, order, list, count, &certificate) != CELLIST_SUCCESS)
      bench_fail(context, name);
    memset(seen, 0, a->tet_count);
    for (size_t t = 0; t < a->tet_count; t++) seen[order[t]] = 1;
    for (size_t t = 0; t < a->tet_count; t++) unsorted += seen[t] == 0;
    rays += found.ray_count;
    pairs += found.pairs;
    group_pairs += found.group_pairs;
    inversions += found.inversions;
    overlaps += found.overlaps;
    violations += certificate.violations;
    groups += stats.group_count;
    grouped += stats.cells_in_groups;
    if (stats.largest_group > largest) largest = stats.largest_group;
  }
  printf("%s,%zu,%s,%zu,%d,%zu,%zu,%zu,%zu,%zu,%zu,%zu,%zu,%.1f,%zu\n", name, a->tet_count, exterior,
         complex != NULL ? arrays.cell_count - a->tet_count : 0, VIEWS, rays, pairs, unsorted, inversions, violations,
         overlaps, group_pairs, groups, (double)grouped / VIEWS, largest);
  fflush(stdout);
  free(order);
  free(seen);
  cellist_sorter_destroy(sorter);
  cellist_verifier_destroy(verifier);
}

static void prove_all(cellist_context *context, const cellist_mesh *mesh, const char *name) {
  static const char *const names[] = {"hull", "box", "grid", "delaunay"};
  prove(context, mesh, name, "none", NULL);
  for (int e = 0; e < 4; e++) {
    const cellist_convexify_desc desc = {.exterior = (cellist_exterior)e, .seed = 1};
    cellist_complex *complex = NULL;
    cellist_convexify_stats stats;
    if (e == CELLIST_EXTERIOR_BOX) continue; /* the hull's, with a larger frame */
    if (cellist_convexify(context, mesh, &desc, &complex, &stats) != CELLIST_SUCCESS) {
      fprintf(stderr, "bench_proof: %s, %s: %s\n", name, names[e], cellist_context_take_error(context));
      continue;
    }
    if ((int)stats.exterior == e) prove(context, mesh, name, names[e], complex);
    cellist_complex_destroy(complex);
  }
}

int main(int argc, char **argv) {
  static const char *const files[] = {"spx",      "octopus_low", "torus_vt", "bunny_in", "disk_out_ref", "fire",
                                      "impeller", "sci_torso",   "gears_t",  "bucky",    "bluntfin",     "post"};
  const cellist_context_desc one_worker = {.worker_count = 1};
  cellist_context *context = NULL;
  if (cellist_context_create(&one_worker, &context) != CELLIST_SUCCESS) return 1;
  printf(
      "mesh,tets,exterior,imaginary_cells,views,rays,pairs,unsorted,inversions,violations,overlaps,group_pairs,groups,"
      "cells_in_groups_a_view,largest_group\n");
  for (size_t i = 0;; i++) {
    const size_t file_count = sizeof files / sizeof files[0];
    const char *name = argc > 1          ? (i + 1 < (size_t)argc ? argv[i + 1] : NULL)
                       : i >= file_count ? cellist_generator_name(i - file_count)
                                         : files[i];
    if (name == NULL) break;
    if (strcmp(name, "flaws") == 0) continue;
    cellist_mesh *mesh = NULL;
    if (bench_open(context, name, 5000, &mesh) != CELLIST_SUCCESS) bench_fail(context, name);
    prove_all(context, mesh, name);
    cellist_mesh_destroy(mesh);
  }
  cellist_context_destroy(context);
  return 0;
}
