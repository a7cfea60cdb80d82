/* SPDX-License-Identifier: BSD-3-Clause
 * The public render: outputs, arguments, workers, progress, allocation failures. */
#include <cellist/image.h>
#include <math.h>

#include "harness.h"
#include "scene.h"

static cellist_transfer_knot KNOTS[] = {{0, 0, {0, 0, 1}}, {0.5, 0.3, {0.2, 1, 0.1}}, {1, 2, {1, 0.5, 0}}};
static const cellist_transfer TRANSFER = {3, KNOTS};

/* A jittered grid with a smooth scalar in 0..1. */
static void grid_scene(cast_scene *scene, unsigned workers) {
  kuhn_grid grid = kuhn_grid_create(4);
  random_state random = {1};
  double *values = malloc(grid.point_count * sizeof *values);
  for (size_t i = 0; i < 3 * grid.point_count; i++) grid.points[i] += random_between(&random, -0.2, 0.2);
  for (size_t p = 0; p < grid.point_count; p++)
    values[p] = 0.5 + 0.5 * sin(grid.points[3 * p] + grid.points[3 * p + 2]);
  scene_create(scene, workers, grid.point_count, grid.points, grid.tet_count, grid.tets, CELLIST_ON_POINTS, values);
  free(values);
  kuhn_grid_release(&grid);
}

static const cellist_view VIEW = {.eye = {9, 7, 8}, .target = {2, 2, 2}, .up = {0, 0, 1}, .fovy_degrees = 35};

TEST(pictures_do_not_depend_on_the_number_of_workers)
{
  enum { WIDTH = 75, HEIGHT = 50 };
  cast_picture first = {0};
  for (unsigned workers = 1; workers <= 4; workers++) {
    cast_scene scene;
    grid_scene(&scene, workers);
    cast_picture picture = scene_draw(&scene, &VIEW, WIDTH, HEIGHT, &TRANSFER, NULL);
    if (workers == 1) {
      first = picture;
    } else {
      assert_memory_equal(picture.rgba, first.rgba, 4 * WIDTH * HEIGHT * sizeof(double));
      assert_memory_equal(picture.z, first.z, WIDTH * HEIGHT * sizeof(double));
      assert_memory_equal(picture.cells, first.cells, WIDTH * HEIGHT * sizeof(uint32_t));
      assert_memory_equal(&picture.stats, &first.stats, sizeof first.stats);
      picture_release(&picture);
    }
    scene_destroy(&scene);
  }
  assert_true(first.stats.ray_count > 500 && first.stats.error_bound > 0 && first.stats.error_bound < 1e-10);
  picture_release(&first);
}

TEST(images_are_filled_by_channel_name)
{
  enum { SIZE = 20 };
  static const char *const names[] = {"R",       "G",          "B", "A", "Z", "ZBack", "transmittance.Y",
                                      "cells.Y", "segments.Y", "X"};
  cast_scene scene;
  grid_scene(&scene, 2);
  cellist_frame frame;
  assert_success(scene.context, cellist_frame_from_view(scene.context, &VIEW, SIZE, SIZE, &frame));
  cast_picture picture = scene_draw(&scene, &VIEW, SIZE, SIZE, &TRANSFER, NULL);
  cellist_image *image = NULL;
  assert_success(scene.context, cellist_image_create(scene.context, SIZE, SIZE, names, 10, &image));
  const cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_REFERENCE};
  const cellist_raycast_output output = {.image = image};
  assert_success(scene.context, cellist_raycaster_render(scene.caster, &frame, &TRANSFER, &desc, &output, NULL));
  uint64_t cells = 0;
  for (size_t i = 0; i < SIZE * SIZE; i++) {
    for (size_t k = 0; k < 4; k++)
      assert_true(cellist_image_channel(image, names[k])[i] == (float)picture.rgba[4 * i + k]);
    assert_true(cellist_image_channel(image, "Z")[i] == (float)picture.z[i]);
    assert_true(cellist_image_channel(image, "ZBack")[i] == (float)picture.z_back[i]);
    assert_true(cellist_image_channel(image, "transmittance.Y")[i] == (float)picture.transmittance[i]);
    assert_true(cellist_image_channel(image, "cells.Y")[i] == (float)picture.cells[i]);
    assert_true(cellist_image_channel(image, "segments.Y")[i] == (float)picture.segments[i]);
    assert_true(cellist_image_channel(image, "X")[i] == 0);
    assert_true(fabs(picture.transmittance[i] + picture.rgba[4 * i + 3] - 1) < 1e-15);
    assert_true(isinf(picture.z[i]) ? picture.z_back[i] == 0 : picture.z[i] < picture.z_back[i]);
    cells += picture.cells[i];
  }
  assert_int_equal(cells, picture.stats.step_count);
  cellist_image_destroy(image);
  picture_release(&picture);
  scene_destroy(&scene);
}

static cellist_result create_and_draw(cellist_context *context, void *user) {
  const cellist_mesh_desc *desc = user;
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar = {0};
  cellist_raycaster *caster = NULL;
  cellist_frame frame;
  double rgba[4 * 40 * 40];
  const cellist_raycast_output output = {.rgba = rgba};
  const cellist_isosurface iso = {0.5, 1};
  cellist_raycast_desc how = {.precision = CELLIST_PRECISION_REFERENCE};
  how.optics.light = (cellist_light){.enabled = true, .ambient = 0.3, .diffuse = 0.7, .gradient_unit = 1};
  cellist_result result = cellist_mesh_create(context, desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, mesh, NULL, &scalar);
  if (result == CELLIST_SUCCESS) result = cellist_raycaster_create(context, mesh, &scalar, NULL, &caster);
  if (result == CELLIST_SUCCESS) result = cellist_frame_from_view(context, &VIEW, 40, 40, &frame);
  if (result == CELLIST_SUCCESS) result = cellist_raycaster_render(caster, &frame, &TRANSFER, &how, &output, NULL);
  how.optics.light.cell_gradients = true;
  how.optics.model = CELLIST_MODEL_ISOSURFACES;
  how.optics.iso_count = 1;
  how.optics.isos = &iso;
  if (result == CELLIST_SUCCESS) result = cellist_raycaster_render(caster, &frame, &TRANSFER, &how, &output, NULL);
  cellist_raycaster_destroy(caster);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  kuhn_grid grid = kuhn_grid_create(2);
  double *values = malloc(grid.point_count * sizeof *values);
  for (size_t p = 0; p < grid.point_count; p++) values[p] = (double)(p % 5) / 4;
  const cellist_field field = {"s", CELLIST_ON_POINTS, 1, values};
  cellist_mesh_desc desc = {grid.point_count, grid.points, grid.tet_count, grid.tets, NULL, 1, &field};
  check_allocation_failures(create_and_draw, &desc);
  free(values);
  kuhn_grid_release(&grid);
}

TEST(bad_arguments_are_named)
{
  cast_scene scene;
  grid_scene(&scene, 1);
  cellist_context *context = scene.context;
  cellist_frame frame;
  assert_success(context, cellist_frame_from_view(context, &VIEW, 8, 8, &frame));
  double rgba[4 * 64];
  const cellist_raycast_output output = {.rgba = rgba};
  cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_REFERENCE};
  const cellist_result bad = CELLIST_ERROR_INVALID_ARGUMENT;
  assert_failure(context, cellist_raycaster_render(scene.caster, &frame, &TRANSFER, &desc, NULL, NULL), bad, "frame");
  const cellist_transfer none = {0, NULL};
  assert_failure(context, cellist_raycaster_render(scene.caster, &frame, &none, &desc, &output, NULL), bad, "knot");
  cellist_transfer_knot knots[] = {{1, 0, {0, 0, 0}}, {0, 0, {0, 0, 0}}};
  const cellist_transfer wrong = {2, knots};
  assert_failure(context, cellist_raycaster_render(scene.caster, &frame, &wrong, &desc, &output, NULL), bad,
                 "knot 1 of the transfer function is out of order");
  knots[0] = (cellist_transfer_knot){-1, -1, {0, 0, 0}};
  assert_failure(context, cellist_raycaster_render(scene.caster, &frame, &wrong, &desc, &output, NULL), bad, "knot 0");
  desc.optics.model = CELLIST_MODEL_ISOSURFACES;
  const cellist_isosurface iso = {0, 1.5};
  desc.optics.iso_count = 1;
  assert_failure(context, cellist_raycaster_render(scene.caster, &frame, &TRANSFER, &desc, &output, NULL), bad, "NULL");
  desc.optics.isos = &iso;
  assert_failure(context, cellist_raycaster_render(scene.caster, &frame, &TRANSFER, &desc, &output, NULL), bad,
                 "opacity 1.5");
  desc.optics = (cellist_optics){.light = {.enabled = true}};
  assert_failure(context, cellist_raycaster_render(scene.caster, &frame, &TRANSFER, &desc, &output, NULL), bad,
                 "unit of gradients");
  static const char *const names[] = {"R"};
  cellist_image *image = NULL;
  assert_success(context, cellist_image_create(context, 9, 8, names, 1, &image));
  desc.optics = (cellist_optics){0};
  const cellist_raycast_output other = {.image = image};
  assert_failure(context, cellist_raycaster_render(scene.caster, &frame, &TRANSFER, &desc, &other, NULL), bad,
                 "the image is 9x8, the frame 8x8");
  cellist_image_destroy(image);
  cellist_raycaster *caster = NULL;
  assert_failure(context, cellist_raycaster_create(context, scene.mesh, NULL, NULL, &caster), bad, "scalar");
  assert_failure(
      context,
      cellist_raycaster_create(context, scene.mesh, &scene.scalar, &(cellist_raycaster_desc){.tets = 7}, &caster), bad,
      "7 bytes");
  cellist_scalar shorter = scene.scalar;
  shorter.count--;
  assert_failure(context, cellist_raycaster_create(context, scene.mesh, &shorter, NULL, &caster), bad,
                 "the mesh needs");
  assert_null(caster);
  cellist_raycaster_destroy(NULL);
  scene_destroy(&scene);
}

static bool count_and_stop(void *user, const char *stage, double fraction) {
  int *left = user;
  assert_string_equal(stage, "casting");
  assert_true(fraction >= 0 && fraction <= 1);
  return (*left)-- > 0;
}

TEST(progress_is_reported_and_cancels)
{
  for (int allowed = 0; allowed < 60; allowed += 11) {
    int left = allowed;
    cellist_context *context = NULL;
    /* The mesh is made without progress; the caster draws with a context that counts. */
    cast_scene scene;
    grid_scene(&scene, 1);
    const cellist_context_desc counting = {.progress = count_and_stop, .progress_user = &left, .worker_count = 2};
    assert_int_equal(cellist_context_create(&counting, &context), CELLIST_SUCCESS);
    cellist_raycaster *caster = NULL;
    assert_success(context, cellist_raycaster_create(context, scene.mesh, &scene.scalar, NULL, &caster));
    cellist_frame frame;
    assert_success(context, cellist_frame_from_view(context, &VIEW, 100, 100, &frame));
    const cellist_raycast_desc how = {.precision = CELLIST_PRECISION_REFERENCE};
    double *rgba = malloc(4 * 100 * 100 * sizeof *rgba);
    const cellist_raycast_output output = {.rgba = rgba};
    const cellist_result result = cellist_raycaster_render(caster, &frame, &TRANSFER, &how, &output, NULL);
    assert_int_equal(result, left < 0 ? CELLIST_ERROR_CANCELLED : CELLIST_SUCCESS);
    free(rgba);
    cellist_raycaster_destroy(caster);
    cellist_context_destroy(context);
    scene_destroy(&scene);
  }
}

TEST(a_mesh_without_cells_gives_an_empty_picture)
{
  cast_scene scene;
  const double point[] = {0, 0, 0}, value[] = {1};
  scene_create(&scene, 1, 1, point, 0, NULL, CELLIST_ON_POINTS, value);
  cast_picture picture = scene_draw(&scene, &VIEW, 5, 4, &TRANSFER, NULL);
  for (size_t i = 0; i < 80; i++) assert_true(picture.rgba[i] == 0);
  assert_true(picture.stats.ray_count == 0 && picture.stats.error_bound == 0 && isinf(picture.z[7]));
  picture_release(&picture);
  scene_destroy(&scene);
}
