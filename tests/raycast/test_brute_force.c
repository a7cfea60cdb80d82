/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures of real and of generated meshes against brute force, 1e-10 absolute at 64x64, with all three transfer
 * functions that comparisons use. */
#include <cellist/generate.h>
#include <math.h>

#include "brute.h"
#include "harness.h"
#include "scene.h"

enum { SIZE = 64, TRANSFERS = 3 };

static double diagonal_of(const double bounds[6]) {
  return hypot(hypot(bounds[3] - bounds[0], bounds[4] - bounds[1]), bounds[5] - bounds[2]);
}

/* stride: every so many-th pixel is compared. */
static void compare(cellist_context *context, const cellist_mesh *mesh, const cellist_view *view, uint32_t stride) {
  cast_scene scene = {.context = context, .mesh = (cellist_mesh *)mesh};
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scene.scalar));
  assert_success(context, cellist_raycaster_create(context, mesh, &scene.scalar, NULL, &scene.caster));
  static const char *const names[TRANSFERS] = {"ramp", "dense", "spikes"};
  cellist_transfer transfers[TRANSFERS];
  cast_picture pictures[TRANSFERS];
  for (int i = 0; i < TRANSFERS; i++) {
    const cellist_transfer_desc desc = {.source = names[i],
                                        .range = {scene.scalar.minimum, scene.scalar.maximum},
                                        .unit_distance = diagonal_of(cellist_mesh_get_arrays(mesh)->bounds) / 50};
    assert_success(context, cellist_transfer_load(context, &desc, &transfers[i]));
    pictures[i] = scene_draw(&scene, view, SIZE, SIZE, &transfers[i], NULL);
    assert_int_equal(pictures[i].stats.fold_ray_count, 0);
  }
  brute_force brute;
  brute_begin(&brute, mesh, &scene.scalar, &transfers[0]);
  size_t hits = 0;
  double worst[TRANSFERS] = {0};
  for (uint32_t p = 0; p < SIZE * SIZE; p += stride) {
    double origin[3], direction[3];
    cellist_frame_ray(&pictures[0].frame, p % SIZE + 0.5, p / SIZE + 0.5, origin, direction);
    brute_collect(&brute, origin, direction, view->near_distance);
    hits += brute.cell_count > 0;
    for (int i = 0; i < TRANSFERS; i++) {
      real rgba[4];
      brute.transfer = &transfers[i];
      brute_shade(&brute, direction, rgba);
      for (int k = 0; k < 4; k++) {
        const double error = fabs(pictures[i].rgba[4 * p + (uint32_t)k] - (double)rgba[k]);
        worst[i] = fmax(worst[i], error);
        if (!(error <= 1e-10 && error <= pictures[i].stats.error_bound + 1e-14))
          fail_msg("%s, pixel %u, channel %d: %.17g instead of %.17Lg, bound %g", names[i], p, k,
                   pictures[i].rgba[4 * p + (uint32_t)k], rgba[k], pictures[i].stats.error_bound);
      }
    }
  }
  assert_true(hits > SIZE * SIZE / stride / 20);
  brute_end(&brute);
  for (int i = 0; i < TRANSFERS; i++) {
    print_message("%s: largest difference %.2g, bound %.2g\n", names[i], worst[i], pictures[i].stats.error_bound);
    picture_release(&pictures[i]);
    cellist_transfer_release(context, &transfers[i]);
  }
  cellist_raycaster_destroy(scene.caster);
  cellist_scalar_release(context, &scene.scalar);
}

static void compare_file(const char *name, uint32_t stride) {
  const char *path = shared_data(name);
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  const cellist_view view = cellist_view_orbit(cellist_mesh_get_arrays(mesh)->bounds, 30.96, 34.45);
  compare(context, mesh, &view, stride);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(spx_matches_brute_force)
{ compare_file("spx.vtu", 1); }
TEST(impeller_matches_brute_force)
{ compare_file("impeller.vtu", 1); }
TEST(sci_torso_matches_brute_force)
{ compare_file("sci_torso.vtu", 1); }
TEST(gears_t_matches_brute_force)
{ compare_file("gears_t.vtu", 1); }
TEST(torus_vt_matches_brute_force)
{ compare_file("torus_vt.vtu", 1); }
TEST(bluntfin_matches_brute_force)
{ compare_file("bluntfin.vtu", 7); }

TEST(every_generator_but_flaws_matches_brute_force)
{
  random_state random = {1};
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    const char *name = cellist_generator_name(i);
    if (strcmp(name, "flaws") == 0) continue;
    cellist_context *context = harness_context(2);
    cellist_mesh *mesh = NULL;
    const cellist_generate_desc desc = {.size = 1500, .seed = 5};
    assert_success(context, cellist_generate(context, name, &desc, &mesh));
    const double *bounds = cellist_mesh_get_arrays(mesh)->bounds;
    cellist_view view = cellist_view_orbit(bounds, random_between(&random, 0, 360), random_between(&random, -80, 80));
    if (i % 3 == 1) view.parallel_height = 0.8 * diagonal_of(bounds);
    if (i % 3 == 2) view.near_distance = diagonal_of(bounds) * 0.5 / sin(0.2617993877991494);
    compare(context, mesh, &view, 1);
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
}

static void draw_flawed(const char *name) {
  const char *path = shared_data(name);
  cellist_context *context = harness_context(2);
  cast_scene scene = {.context = context};
  assert_success(context, cellist_mesh_read(context, path, NULL, &scene.mesh));
  assert_success(context, cellist_scalar_select(context, scene.mesh, NULL, &scene.scalar));
  assert_success(context, cellist_raycaster_create(context, scene.mesh, &scene.scalar, NULL, &scene.caster));
  cellist_transfer transfer;
  const double *bounds = cellist_mesh_get_arrays(scene.mesh)->bounds;
  const cellist_transfer_desc desc = {.source = "dense",
                                      .range = {scene.scalar.minimum, scene.scalar.maximum},
                                      .unit_distance = diagonal_of(bounds) / 50};
  assert_success(context, cellist_transfer_load(context, &desc, &transfer));
  const cellist_view view = cellist_view_orbit(bounds, 30.96, 34.45);
  cast_picture picture = scene_draw(&scene, &view, 128, 128, &transfer, NULL);
  for (size_t i = 0; i < 4 * 128 * 128; i++) assert_true(picture.rgba[i] >= 0 && picture.rgba[i] <= 1 + 1e-12);
  assert_true(picture.stats.fold_ray_count > 0 && picture.stats.fold_ray_count < picture.stats.ray_count);
  print_message("%s: %d of %d rays met a fold\n", name, (int)picture.stats.fold_ray_count,
                (int)picture.stats.ray_count);
  picture_release(&picture);
  cellist_transfer_release(context, &transfer);
  scene_destroy(&scene);
}

TEST(crushed_can_of_tets_is_finite_and_its_folds_are_counted)
{ draw_flawed("can.vtu"); }
TEST(crushed_can_of_hexahedra_is_finite_and_its_folds_are_counted)
{ draw_flawed("can_hex.vtu"); }
