/* SPDX-License-Identifier: BSD-3-Clause
 * Stiff optics and flawed meshes: finite, within the bound, and the flaws counted. */
#include <math.h>

#include "brute.h"
#include "harness.h"
#include "scene.h"

enum { SIZE = 16 };

static void stiff_scene(cast_scene *scene, double position_scale, double scalar_scale) {
  kuhn_grid grid = kuhn_grid_create(2);
  random_state random = {1};
  double *values = malloc(grid.point_count * sizeof *values);
  for (size_t i = 0; i < 3 * grid.point_count; i++)
    grid.points[i] = position_scale * (grid.points[i] + random_between(&random, -0.2, 0.2));
  for (size_t p = 0; p < grid.point_count; p++) values[p] = scalar_scale * random_unit(&random);
  scene_create(scene, 1, grid.point_count, grid.points, grid.tet_count, grid.tets, CELLIST_ON_POINTS, values);
  free(values);
  kuhn_grid_release(&grid);
}

static cellist_view stiff_view(double scale) {
  return (cellist_view){
      .eye = {5 * scale, 4 * scale, 3 * scale}, .target = {scale, scale, scale}, .up = {0, 0, 1}, .fovy_degrees = 35};
}

/* The picture against brute force; the difference may not exceed the bound, and the bound not `limit`. */
static void check_against_brute_force(const cellist_transfer *transfer, double limit) {
  cast_scene scene;
  stiff_scene(&scene, 1, 1);
  brute_force brute;
  brute_begin(&brute, scene.mesh, &scene.scalar, transfer);
  const cellist_view view = stiff_view(1);
  cast_picture picture = scene_draw(&scene, &view, SIZE, SIZE, transfer, NULL);
  assert_true(picture.stats.error_bound <= limit);
  for (uint32_t i = 0; i < SIZE * SIZE; i++) {
    double origin[3], direction[3];
    real rgba[4];
    cellist_frame_ray(&picture.frame, i % SIZE + 0.5, i / SIZE + 0.5, origin, direction);
    brute_volume(&brute, origin, direction, 0, rgba);
    for (int k = 0; k < 4; k++)
      if (!(fabs(picture.rgba[4 * i + (size_t)k] - (double)rgba[k]) <= picture.stats.error_bound + 1e-13))
        fail_msg("pixel %u channel %d: %.17g instead of %.17Lg, bound %g", i, k, picture.rgba[4 * i + (size_t)k],
                 rgba[k], picture.stats.error_bound);
  }
  picture_release(&picture);
  brute_end(&brute);
  scene_destroy(&scene);
}

TEST(extinction_from_1e_minus_12_to_1e9)
{
  for (int exponent = -12; exponent <= 9; exponent += 3) {
    const double e = pow(10, exponent);
    cellist_transfer_knot knots[] = {{0.1, 0, {1, 0, 0}}, {0.5, e, {0, 1, 0}}, {0.9, 0.25 * e, {0, 0, 1}}};
    check_against_brute_force(&(cellist_transfer){3, knots}, exponent <= 3 ? 1e-9 : 1e-3);
  }
}

TEST(steps_spikes_and_equal_knots)
{
  cellist_transfer_knot step[] = {{0.5, 0, {1, 0, 0}}, {0.5, 40, {0, 1, 0}}};
  check_against_brute_force(&(cellist_transfer){2, step}, 1e-10);
  cellist_transfer_knot box[] = {
      {0.3, 0, {1, 0, 0}}, {0.3, 20, {1, 1, 0}}, {0.3, 5, {0, 1, 0}}, {0.6, 5, {0, 1, 1}}, {0.6, 0, {0, 0, 1}}};
  check_against_brute_force(&(cellist_transfer){5, box}, 1e-10);
  cellist_transfer_knot spike[] = {
      {0.49999, 0, {1, 0, 0}}, {0.5, 1e5, {0, 1, 0}}, {0.50001, 0, {0, 0, 1}}, {0.7, 1e-9, {1, 1, 1}}};
  check_against_brute_force(&(cellist_transfer){4, spike}, 1e-6);
  cellist_transfer_knot single[] = {{0.5, 3, {0.5, 0.25, 1}}};
  check_against_brute_force(&(cellist_transfer){1, single}, 1e-11);
}

TEST(ranges_of_1e_minus_30_and_1e30_change_no_bit)
{
  /* Powers of two near 1e-30, 1e30 and beyond the range of single precision: every quotient stays the same. */
  const double factors[] = {0x1p-100, 0x1p100, 0x1p-400, 0x1p400};
  cellist_transfer_knot knots[] = {
      {0.2, 0.1, {1, 0, 0}}, {0.5, 3, {0, 1, 0}}, {0.5, 1, {0, 1, 0}}, {0.8, 0, {0, 0, 1}}};
  cast_scene plain;
  stiff_scene(&plain, 1, 1);
  cellist_view view = stiff_view(1);
  cast_picture expected = scene_draw(&plain, &view, SIZE, SIZE, &(cellist_transfer){4, knots}, NULL);
  scene_destroy(&plain);
  for (int i = 0; i < 8; i++) {
    const double positions = i < 4 ? 1 : factors[i - 4], scalars = i < 4 ? factors[i] : 1;
    cellist_transfer_knot scaled[4];
    for (int k = 0; k < 4; k++) {
      scaled[k] = knots[k];
      scaled[k].value *= scalars;
      scaled[k].extinction /= positions;
    }
    cast_scene scene;
    stiff_scene(&scene, positions, scalars);
    view = stiff_view(positions);
    cast_picture picture = scene_draw(&scene, &view, SIZE, SIZE, &(cellist_transfer){4, scaled}, NULL);
    for (size_t p = 0; p < 4 * SIZE * SIZE; p++) assert_true(fabs(picture.rgba[p] - expected.rgba[p]) < 1e-14);
    picture_release(&picture);
    scene_destroy(&scene);
  }
  picture_release(&expected);
}

TEST(crushed_meshes_end_with_finite_pictures_and_count_folds)
{
  /* A grid whose upper half is pressed through the lower one, layer by layer: tets are turned over, cells overlap. */
  for (int round = 0; round < 4; round++) {
    kuhn_grid grid = kuhn_grid_create(4);
    random_state random = {(uint64_t)round};
    double *values = malloc(grid.point_count * sizeof *values);
    for (size_t p = 0; p < grid.point_count; p++) {
      double *x = &grid.points[3 * p];
      if (round % 2 == 0 && x[2] >= 2) x[2] = 3.3 - x[2];
      for (int k = 0; k < 3 && round > 0; k++) x[k] += random_between(&random, -1.5, 1.5);
      values[p] = random_unit(&random);
    }
    cast_scene scene;
    scene_create(&scene, 2, grid.point_count, grid.points, grid.tet_count, grid.tets, CELLIST_ON_POINTS, values);
    cellist_transfer_knot knots[] = {{0.1, 0, {1, 0, 0}}, {0.5, 3, {0, 1, 0}}, {0.9, 0.25, {0, 0, 1}}};
    const cellist_view view = {.eye = {9, 7, 8}, .target = {2, 2, 2}, .up = {0, 0, 1}, .fovy_degrees = 35};
    cast_picture picture = scene_draw(&scene, &view, 40, 40, &(cellist_transfer){3, knots}, NULL);
    for (size_t p = 0; p < 4 * 40 * 40; p++) assert_true(picture.rgba[p] >= 0 && picture.rgba[p] <= 1 + 1e-12);
    assert_true(picture.stats.fold_ray_count > 100 && picture.stats.fold_ray_count <= picture.stats.ray_count);
    picture_release(&picture);
    scene_destroy(&scene);
    free(values);
    kuhn_grid_release(&grid);
  }
}
