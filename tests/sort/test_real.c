/* SPDX-License-Identifier: BSD-3-Clause
 * Real and generated meshes: exact from outside, inside and in parallel views, by rays and by certificate. */
#include <cellist/generate.h>
#include <cellist/sort_verify.h>

#include "scene.h"

/* Sorts from view_count views and casts rays in each; fails the case on an inversion. */
static void check_mesh(cellist_context *context, const cellist_mesh *mesh, unsigned view_count, size_t ray_count,
                       bool groups_allowed) {
  const double *bounds = cellist_mesh_get_arrays(mesh)->bounds;
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_sorter *sorter = NULL;
  cellist_verifier *verifier = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  assert_success(context, cellist_verifier_create(context, &desc, &verifier));
  uint32_t *order = calloc(desc.tet_count + 1, sizeof *order);
  for (unsigned i = 0; i < view_count; i++) {
    random_state random = {i};
    cellist_viewpoint view = scene_view(i, 1, &random);
    for (int k = 0; k < 3 && !view.parallel; k++)
      view.position[k] = bounds[k] + view.position[k] * (bounds[3 + k] - bounds[k]);
    cellist_sort_stats stats;
    assert_success(context, cellist_sorter_sort(sorter, &view, order, &stats));
    const cellist_group *groups = NULL;
    size_t group_count = 0;
    cellist_sorter_groups(sorter, &groups, &group_count);
    cellist_verification found;
    cellist_certificate certificate;
    assert_success(context, cellist_verifier_check(verifier, &view, order, groups, group_count, ray_count, i, &found));
    assert_success(context, cellist_order_certify(context, &desc, &view, order, groups, group_count, &certificate));
    assert_true(found.pairs > ray_count / 2);
    assert_int_equal(found.inversions, 0);
    assert_int_equal(certificate.violations, 0);
    if (!groups_allowed) assert_int_equal(group_count, 0);
  }
  free(order);
  cellist_verifier_destroy(verifier);
  cellist_sorter_destroy(sorter);
}

static void check_file(const char *name, bool groups_allowed) {
  const char *path = shared_data(name);
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  check_mesh(context, mesh, 6, 500, groups_allowed);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(bucky_is_in_exact_order_from_20_views)
{
  const char *path = shared_data("bucky.vtu");
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  check_mesh(context, mesh, 20, 1000, false);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(a_perturbed_grid_is_in_exact_order_from_20_views)
{
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = scene_grid(context, 16, 0.1, 0, 2);
  check_mesh(context, mesh, 20, 1000, false);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(spx_is_in_exact_order)
{ check_file("spx.vtu", false); }
TEST(octopus_is_in_exact_order)
{ check_file("octopus_low.vtu", false); }
TEST(sci_torso_is_in_exact_order)
{ check_file("sci_torso.vtu", false); }
TEST(bunny_is_in_exact_order)
{ check_file("bunny_in.vtu", false); }
TEST(impeller_is_in_exact_order)
{ check_file("impeller.vtu", false); }
TEST(torus_is_in_exact_order)
{ check_file("torus_vt.vtu", true); }
TEST(gears_are_in_exact_order_outside_groups)
{ check_file("gears_t.vtu", true); }

TEST(generated_meshes_are_in_exact_order_outside_groups)
{
  cellist_context *context = harness_context(2);
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    const char *name = cellist_generator_name(i);
    if (strcmp(name, "flaws") == 0) continue; /* folded and overlapping cells on purpose */
    const cellist_generate_desc desc = {.size = 3000, .seed = 1};
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_generate(context, name, &desc, &mesh));
    print_message("%s\n", name);
    check_mesh(context, mesh, 12, 200, true);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}
