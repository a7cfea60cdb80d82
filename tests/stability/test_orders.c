/* SPDX-License-Identifier: BSD-3-Clause
 * Stability, orders and exteriors: every case's cells in order by rays and by certificate, and every case's mesh
 * convexified in each way: a valid complex, or an error that names cells. */
#include <stdio.h>

#include "harness.h"
#include "stability.h"

static size_t sort_case(const stability_case *which) {
  cellist_context *context = harness_context(2);
  stability_scene scene;
  stability_order found;
  assert_success(context, stability_build(context, which, &scene));
  assert_success(context, stability_sort(context, which, &scene, &found));
  printf(
      "%-22s %-8s %zu rays, %zu pairs, %zu inversions, %zu group pairs, %zu overlaps; %zu groups, up to %zu; %.4f s "
      "%s\n",
      which->name, stability_verdict_name(found.verdict), found.rays, found.pairs, found.inversions, found.group_pairs,
      found.overlaps, found.groups, found.largest_group, found.seconds, found.message);
  stability_scene_release(&scene);
  harness_context_destroy(context);
  return found.verdict == STABILITY_FAILS;
}

TEST(every_case_in_order)
{
  size_t failed = 0;
  for (size_t i = 0; stability_case_at(i) != NULL; i++) failed += sort_case(stability_case_at(i));
  if (failed > 0) fail_msg("%zu cases fail", failed);
}

static size_t convexify_case(const stability_case *which, unsigned exterior) {
  cellist_context *context = harness_context(2);
  stability_scene scene;
  stability_exterior found;
  assert_success(context, stability_build(context, which, &scene));
  assert_success(context, stability_convexify(context, &scene, exterior, &found));
  printf("%-22s %-8s %-8s %zu imaginary cells, volume error %.0e, %.3f s %s\n", which->name,
         stability_exterior_name(exterior), stability_verdict_name(found.verdict), found.imaginary_cells,
         found.volume_error, found.seconds, found.message);
  fflush(stdout);
  stability_scene_release(&scene);
  harness_context_destroy(context);
  return found.verdict == STABILITY_FAILS;
}

static void convexify_all(unsigned exterior) {
  size_t failed = 0;
  if (stability_exterior_name(exterior) == NULL) SKIP("this build has no convexifier");
  for (size_t i = 0; stability_case_at(i) != NULL; i++)
    if (stability_case_at(i)->group == STABILITY_SHAPE || stability_case_at(i)->group == STABILITY_FRAME)
      failed += convexify_case(stability_case_at(i), exterior);
  if (failed > 0) fail_msg("%zu cases fail", failed);
}

TEST(extreme_meshes_by_hull)
{ convexify_all(0); }
TEST(extreme_meshes_by_box)
{ convexify_all(1); }
TEST(extreme_meshes_by_grid)
{ convexify_all(2); }
TEST(extreme_meshes_by_delaunay)
{ convexify_all(3); }
