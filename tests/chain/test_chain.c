/* SPDX-License-Identifier: BSD-3-Clause
 * Chain: sorting with a convexified complex, of every exterior, against brute force. */
#include "../sort/pile.h"
#include "chain.h"

TEST(grids_with_holes_are_in_exact_order_with_every_exterior)
{
  cellist_context *context = harness_context(1);
  size_t apart = 0;
  for (unsigned kind = 0; kind < 60; kind++) {
    random_state random = {kind};
    cellist_mesh *mesh = scene_grid(context, 4, kind % 2 == 0 ? 0.1 : 0, 0.1 + 0.2 * (kind % 5), kind);
    const cellist_viewpoint view = scene_view(kind, 4, &random);
    for (int exterior = 0; exterior < EXTERIORS; exterior++) {
      chain *made = chain_create(context, mesh, exterior);
      uint32_t *order = calloc(made->desc.tet_count + 1, sizeof *order);
      cellist_sort_stats stats;
      assert_success(context, cellist_sorter_sort(made->sorter, &view, order, &stats));
      assert_true(stats.exact && stats.imaginary_cell_count > 0);
      assert_int_equal(stats.group_count, 0); /* a grid's cells can be ordered from everywhere, holes or not */
      const oracle_count count = oracle_check(&made->desc, &view, order, NULL, 0, 60, 5);
      assert_int_equal(count.inversions, 0);
      assert_true(count.pairs > 0);
      apart += stats.component_cell_count > 0;
      free(order);
      chain_destroy(made);
    }
    cellist_mesh_destroy(mesh);
  }
  assert_true(apart > 20); /* so that the stages after the first were tried */
  harness_context_destroy(context);
}

/* With every exterior. */
static void judge(cellist_context *context, const cellist_mesh *mesh, judge_desc how) {
  for (int exterior = 0; exterior < EXTERIORS; exterior++) {
    chain *made = chain_create(context, mesh, exterior);
    judge_sorter(context, &made->desc, cellist_mesh_get_arrays(mesh)->bounds, how);
    chain_destroy(made);
  }
}

static const judge_desc acyclic = {.view_count = 6, .ray_count = 300};
static const judge_desc maybe_cyclic = {.view_count = 6, .ray_count = 300, .groups_allowed = true};

TEST(spx_is_in_exact_order)
{ judge_file("spx.vtu", judge, acyclic); }
TEST(octopus_is_in_exact_order)
{ judge_file("octopus_low.vtu", judge, acyclic); }
TEST(torus_is_in_exact_order)
{ judge_file("torus_vt.vtu", judge, maybe_cyclic); }
TEST(sci_torso_is_in_exact_order)
{ judge_file("sci_torso.vtu", judge, acyclic); }
TEST(bunny_is_in_exact_order)
{ judge_file("bunny_in.vtu", judge, acyclic); }

TEST(generated_meshes_are_in_exact_order_outside_groups)
{ judge_samples(500, judge, (judge_desc){.view_count = 6, .ray_count = 100, .groups_allowed = true}); }

/* Imaginary cells around a wheel are in its component and come apart from it: what is left is the wheel and no more. */
TEST(a_wheel_is_one_group_of_exactly_its_cells_with_every_exterior)
{
  static const uint32_t sizes[] = {3, 4, 5, 6, 7, 8, 13, 21, 40, 64, 120, 300};
  cellist_context *context = harness_context(1);
  for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
    cellist_mesh *mesh = make_wheel(context, sizes[s]);
    for (int exterior = 0; exterior < EXTERIORS; exterior++) {
      chain *made = chain_create(context, mesh, exterior);
      print_message("%u tets, exterior %d: %zu cells\n", sizes[s], exterior, made->arrays.cell_count);
      assert_true(made->arrays.cell_count > made->desc.tet_count);
      wheel_check(context, mesh, &made->desc);
      chain_destroy(made);
    }
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}
