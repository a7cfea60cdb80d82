/* SPDX-License-Identifier: BSD-3-Clause
 * Chain: sorting with a convexified complex, of every exterior, against brute force. */
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

static void check_file(const char *name, bool groups_allowed) {
  const char *path = shared_data(name);
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  for (int exterior = 0; exterior < EXTERIORS; exterior++) chain_check(context, mesh, exterior, 6, 300, groups_allowed);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(spx_is_in_exact_order)
{ check_file("spx.vtu", false); }
TEST(octopus_is_in_exact_order)
{ check_file("octopus_low.vtu", false); }
TEST(torus_is_in_exact_order)
{ check_file("torus_vt.vtu", true); }
TEST(sci_torso_is_in_exact_order)
{ check_file("sci_torso.vtu", false); }
TEST(bunny_is_in_exact_order)
{ check_file("bunny_in.vtu", false); }

TEST(generated_meshes_are_in_exact_order_outside_groups)
{
  cellist_context *context = harness_context(2);
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    const char *name = cellist_generator_name(i);
    if (strcmp(name, "flaws") == 0) continue; /* folded and overlapping cells on purpose */
    const cellist_generate_desc desc = {.size = 500, .seed = 1};
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_generate(context, name, &desc, &mesh));
    print_message("%s\n", name);
    for (int exterior = 0; exterior < EXTERIORS; exterior++) chain_check(context, mesh, exterior, 6, 100, true);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}
