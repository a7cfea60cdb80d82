/* SPDX-License-Identifier: BSD-3-Clause
 * Sorter: orders of meshes without gaps, against brute force; what it refuses. */
#include "scene.h"

TEST(convex_grids_are_in_exact_order_from_everywhere)
{
  cellist_context *context = harness_context(1);
  for (unsigned kind = 0; kind < 48; kind++) {
    random_state random = {kind};
    cellist_mesh *mesh = scene_grid(context, 4, kind % 2 == 0 ? 0.1 : 0, 0, kind);
    const cellist_viewpoint view = scene_view(kind, 4, &random);
    cellist_sort_stats stats;
    const oracle_count count = sort_and_check(context, mesh, &view, 60, &stats);
    assert_true(stats.exact);
    assert_true(stats.group_count == 0);
    assert_true(count.pairs > 200);
    assert_int_equal(count.inversions, 0);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

TEST(an_empty_mesh_has_an_empty_order)
{
  cellist_context *context = harness_context(1);
  const cellist_sorter_desc desc = {0};
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  const cellist_viewpoint view = {{0, 0, 1}, false};
  cellist_sort_stats stats;
  assert_success(context, cellist_sorter_sort(sorter, &view, NULL, &stats));
  assert_true(stats.exact);
  cellist_sorter_destroy(sorter);
  cellist_sorter_destroy(NULL);
  harness_context_destroy(context);
}

TEST(bad_arrays_and_views_are_named)
{
  cellist_context *context = harness_context(1);
  double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
  uint32_t tets[] = {0, 1, 2, 3, 1, 2, 3, 4};
  uint32_t neighbours[] = {1, CELLIST_NONE, CELLIST_NONE, CELLIST_NONE, CELLIST_NONE, CELLIST_NONE, CELLIST_NONE, 0};
  cellist_sorter_desc desc = {5, points, 2, tets, neighbours, NULL};
  cellist_sorter *sorter = NULL;
  const cellist_result invalid = CELLIST_ERROR_INVALID_ARGUMENT;
  assert_failure(context, cellist_sorter_create(context, NULL, &sorter), invalid, "NULL");
  tets[7] = 9;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), invalid, "tet 1 uses point 9 of 5");
  tets[7] = 4;
  points[12] = NAN;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), CELLIST_ERROR_GEOMETRY, "tet 1 uses point 4");
  points[12] = -1;
  points[13] = -1;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), CELLIST_ERROR_GEOMETRY,
                 "tet 1 has a negative volume");
  points[12] = points[13] = 1;
  neighbours[7] = CELLIST_NONE;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), invalid, "tet 0 has tet 1 as its neighbour");
  neighbours[7] = 0;
  neighbours[6] = 7;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), invalid, "tet 7 of 2");
  neighbours[6] = CELLIST_NONE;
  desc.neighbours = NULL;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), invalid, "NULL");
  desc.neighbours = neighbours;
  /* Tet 1 folded back onto tet 0's side of their face; its corners in an order that makes it positive. */
  points[12] = points[13] = points[14] = 0.1;
  tets[4] = 2;
  tets[5] = 1;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), CELLIST_ERROR_GEOMETRY,
                 "tets 0 and 1 are neighbours on the same side");
  points[12] = points[13] = points[14] = 1;
  tets[4] = 1;
  tets[5] = 2;
  assert_null(sorter);
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  uint32_t order[2];
  cellist_viewpoint view = {{0, INFINITY, 0}, false};
  assert_failure(context, cellist_sorter_sort(sorter, &view, order, NULL), invalid, "a viewpoint at (0, inf, 0)");
  view = (cellist_viewpoint){{0, 0, 0}, true};
  assert_failure(context, cellist_sorter_sort(sorter, &view, order, NULL), invalid, "without a direction");
  view = (cellist_viewpoint){{3, 3, 3}, false};
  assert_success(context, cellist_sorter_sort(sorter, &view, order, NULL));
  assert_true(order[0] == 0 && order[1] == 1);
  view.parallel = true; /* looking away from tet 0's side */
  assert_success(context, cellist_sorter_sort(sorter, &view, order, NULL));
  assert_true(order[0] == 1 && order[1] == 0);
  cellist_sorter_destroy(sorter);
  harness_context_destroy(context);
}

static cellist_result sort_in(cellist_context *context, void *user) {
  const cellist_sorter_desc *desc = user;
  uint32_t order[384];
  cellist_sorter *sorter = NULL;
  cellist_result result = cellist_sorter_create(context, desc, &sorter);
  const cellist_viewpoint view = {{0.4, 9, 3}, false};
  if (result == CELLIST_SUCCESS) result = cellist_sorter_sort(sorter, &view, order, NULL);
  cellist_sorter_destroy(sorter);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 4, 0.1, 0.3, 3);
  cellist_sorter_desc desc = sorter_desc_of(mesh);
  check_allocation_failures(sort_in, &desc);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
