/* SPDX-License-Identifier: BSD-3-Clause
 * Real and generated meshes: exact from outside, inside and in parallel views, by rays and by certificate. */
#include "judge.h"

static void judge(cellist_context *context, const cellist_mesh *mesh, judge_desc how) {
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  judge_sorter(context, &desc, cellist_mesh_get_arrays(mesh)->bounds, how);
}

static const judge_desc acyclic = {.view_count = 6, .ray_count = 500};
static const judge_desc maybe_cyclic = {.view_count = 6, .ray_count = 500, .groups_allowed = true};

TEST(bucky_is_in_exact_order_from_20_views)
{ judge_file("bucky.vtu", judge, (judge_desc){.view_count = 20, .ray_count = 1000}); }

TEST(a_perturbed_grid_is_in_exact_order_from_20_views)
{
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = scene_grid(context, 16, 0.1, 0, 2);
  judge(context, mesh, (judge_desc){.view_count = 20, .ray_count = 1000});
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(spx_is_in_exact_order)
{ judge_file("spx.vtu", judge, acyclic); }
TEST(octopus_is_in_exact_order)
{ judge_file("octopus_low.vtu", judge, acyclic); }
TEST(sci_torso_is_in_exact_order)
{ judge_file("sci_torso.vtu", judge, acyclic); }
TEST(bunny_is_in_exact_order)
{ judge_file("bunny_in.vtu", judge, acyclic); }
TEST(impeller_is_in_exact_order)
{ judge_file("impeller.vtu", judge, acyclic); }
TEST(torus_is_in_exact_order)
{ judge_file("torus_vt.vtu", judge, maybe_cyclic); }
TEST(gears_are_in_exact_order_outside_groups)
{ judge_file("gears_t.vtu", judge, maybe_cyclic); }

TEST(generated_meshes_are_in_exact_order_outside_groups)
{ judge_samples(3000, judge, (judge_desc){.view_count = 12, .ray_count = 200, .groups_allowed = true}); }
