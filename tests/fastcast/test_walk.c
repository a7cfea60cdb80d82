/* SPDX-License-Identifier: BSD-3-Clause
 * The fast caster against the reference: views, projections, layouts, kernels, flaws; and that it repeats itself. */
#include <math.h>

#include "../../project/raycast/fast.h"
#include "../raycast/scene.h"

enum { SIZE = 48 };

/* A ramp with a steep side and a bright peak, over scalars 0..1. (With a true step, a cell of almost that very scalar
 * falls on either side by rounding.) */
static cellist_transfer_knot KNOTS[] = {{0, 0, {0, 0, 1}},      {0.3, 0.4, {0, 1, 0.5}}, {0.31, 0.1, {1, 1, 0}},
                                        {0.5, 0.1, {1, 0, 0}},  {0.52, 3, {1, 1, 1}},    {0.54, 0.1, {0.5, 0, 1}},
                                        {0.8, 0.8, {0, 0.2, 0}}};
static const cellist_transfer TRANSFER = {sizeof KNOTS / sizeof *KNOTS, KNOTS};

/* The grid with its points moved about (not on the boundary if keep_boundary), and a smooth scalar in 0..1. */
static void make_scene(cast_scene *scene, unsigned workers, uint32_t n, double shake, bool on_cells, uint64_t seed,
                       const double *replace) {
  random_state random = {seed};
  kuhn_grid grid = kuhn_grid_create(n);
  const size_t count = on_cells ? grid.tet_count : grid.point_count;
  double *values = malloc(count * sizeof *values);
  for (size_t i = 0; i < count; i++) {
    const double *p = &grid.points[3 * (on_cells ? grid.tets[4 * i] : i)];
    values[i] = replace != NULL && random_below(&random, 40) == 0
                    ? *replace
                    : 0.5 + 0.5 * sin(p[0] * 7.0 / n + 0.3) * cos(p[1] * 5.0 / n) * sin(p[2] * 6.0 / n + 1);
  }
  for (size_t i = 0; i < 3 * grid.point_count; i++) grid.points[i] += shake * (random_unit(&random) - 0.5);
  scene_create(scene, workers, grid.point_count, grid.points, grid.tet_count, grid.tets,
               on_cells ? CELLIST_ON_CELLS : CELLIST_ON_POINTS, values);
  free(values);
  kuhn_grid_release(&grid);
}

static cast_picture draw_fast(const cast_scene *scene, cellist_raycaster *caster, const cellist_view *view,
                              const cellist_optics *optics) {
  return scene_draw_with(scene, caster, CELLIST_PRECISION_FAST, view, SIZE, SIZE, &TRANSFER, optics);
}

/* Colour and opacity: rmse below tolerance. A single pixel may be further off, where its ray passes a face that it sees
 * nearly edge-on. Returns the number of pixels with something in them. */
static size_t assert_close(const cast_picture *fast, const cast_picture *reference, double tolerance) {
  size_t covered = 0;
  double sum = 0;
  for (size_t i = 0; i < 4 * (size_t)SIZE * SIZE; i++) {
    const double error = fabs(fast->rgba[i] - reference->rgba[i]);
    if (!(error <= 100 * tolerance))
      fail_msg("pixel %zu,%zu channel %zu: fast %.9g, reference %.9g", i / 4 % SIZE, i / 4 / SIZE, i % 4, fast->rgba[i],
               reference->rgba[i]);
    sum += error * error;
    covered += i % 4 == 3 && reference->rgba[i] > 0;
  }
  const double rmse = sqrt(sum / (4 * (double)(covered > 0 ? covered : 1)));
  if (!(rmse <= tolerance)) fail_msg("rmse %.3g", rmse);
  return covered;
}

static void assert_same(const cast_picture *a, const cast_picture *b) {
  const size_t count = (size_t)SIZE * SIZE;
  assert_memory_equal(a->rgba, b->rgba, 4 * count * sizeof *a->rgba);
  assert_memory_equal(a->z, b->z, count * sizeof *a->z);
  assert_memory_equal(a->z_back, b->z_back, count * sizeof *a->z_back);
  assert_memory_equal(a->cells, b->cells, count * sizeof *a->cells);
  assert_memory_equal(a->segments, b->segments, count * sizeof *a->segments);
  assert_true(a->stats.step_count == b->stats.step_count && a->stats.segment_count == b->stats.segment_count);
}

static size_t compare(const cast_scene *scene, const cellist_view *view, double tolerance) {
  cast_picture fast = draw_fast(scene, scene->caster, view, NULL);
  cast_picture reference = scene_draw(scene, view, SIZE, SIZE, &TRANSFER, NULL);
  const size_t covered = assert_close(&fast, &reference, tolerance);
  picture_release(&fast);
  picture_release(&reference);
  return covered;
}

static cellist_view view_from(random_state *random, double centre, double distance, int projection) {
  const double middle[3] = {centre, centre, centre};
  cellist_view view = random_view(random, middle, distance);
  if (projection == 1) view.parallel_height = 1.5 * centre;
  return view;
}

TEST(views_from_outside_agree_with_the_reference)
{
  random_state random = {3};
  for (int round = 0; round < 6; round++) {
    cast_scene scene;
    make_scene(&scene, 2, 6, 0.4, round & 1, 100 + (uint64_t)round, NULL);
    for (int projection = 0; projection < 2; projection++) {
      const cellist_view view = view_from(&random, 3, 18, projection);
      assert_true(compare(&scene, &view, 3e-5) > 200);
    }
    scene_destroy(&scene);
  }
}

TEST(a_camera_inside_and_a_near_plane_agree_with_the_reference)
{
  random_state random = {4};
  cast_scene scene;
  make_scene(&scene, 2, 6, 0.4, false, 1, NULL);
  for (int round = 0; round < 12; round++) {
    cellist_view view = view_from(&random, 3, random_between(&random, 0.5, 9), round & 1);
    view.fovy_degrees = 80;
    if (round % 3 == 0) view.near_distance = random_between(&random, 0.1, 4);
    assert_true(compare(&scene, &view, 3e-5) > 100);
  }
  scene_destroy(&scene);
}

/* Pixel centres on the grid's points, rays along its edges and inside its faces: every determinant is a tie. */
TEST(rays_through_vertices_along_edges_and_within_faces_agree_with_the_reference)
{
  cast_scene scene;
  make_scene(&scene, 2, 6, 0, false, 1, NULL);
  const double directions[][3] = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, -1}, {1, 1, 1}, {2, 1, 0}};
  for (size_t i = 0; i < sizeof directions / sizeof *directions; i++)
    for (int shift = 0; shift < 2; shift++) {
      cellist_view view = {.parallel_height = 8, .target = {3, 3, 3}};
      for (int k = 0; k < 3; k++) {
        view.eye[k] = 3 + 8 * directions[i][k];
        view.target[k] += shift / 12.0;
        view.eye[k] += shift / 12.0;
      }
      view.up[directions[i][2] != 0 && directions[i][0] == 0 ? 1 : 2] = 1;
      if (directions[i][2] != 0) view.up[0] = 0.5;
      assert_true(compare(&scene, &view, 3e-5) > 300);
      view.parallel_height = 0;
      view.fovy_degrees = 2 * atan(3.5 / 8 / sqrt(3)) * 57.29577951308232;
      assert_true(compare(&scene, &view, 3e-5) > 100);
    }
  scene_destroy(&scene);
}

TEST(an_eye_on_a_vertex_or_in_a_face_agrees_with_the_reference)
{
  cast_scene scene;
  make_scene(&scene, 1, 4, 0, false, 1, NULL);
  const double eyes[][3] = {{2, 2, 2}, {2.5, 2, 2}, {2.25, 2.5, 2}, {0, 0, 0}, {4, 2.25, 2.5}};
  for (size_t i = 0; i < sizeof eyes / sizeof *eyes; i++) {
    cellist_view view = {.fovy_degrees = 90, .up = {0, 0, 1}, .target = {3.5, 1, 1.75}};
    memcpy(view.eye, eyes[i], sizeof view.eye);
    compare(&scene, &view, 3e-5);
  }
  scene_destroy(&scene);
}

TEST(cells_without_a_finite_scalar_are_not_drawn)
{
  const double odd[] = {NAN, INFINITY};
  random_state random = {5};
  for (int round = 0; round < 4; round++) {
    cast_scene scene;
    make_scene(&scene, 1, 6, 0.3, round & 1, 7, &odd[round >> 1]);
    for (int inside = 0; inside < 2; inside++) {
      const cellist_view view = view_from(&random, 3, inside ? 2 : 18, 0);
      assert_true(compare(&scene, &view, 3e-5) > 100);
    }
    scene_destroy(&scene);
  }
}

TEST(depths_and_counts_are_those_of_the_reference)
{
  random_state random = {6};
  cast_scene scene;
  make_scene(&scene, 1, 5, 0.3, false, 2, NULL);
  for (int projection = 0; projection < 2; projection++) {
    const cellist_view view = view_from(&random, 2.5, 15, projection);
    cast_picture fast = draw_fast(&scene, scene.caster, &view, NULL);
    cast_picture reference = scene_draw(&scene, &view, SIZE, SIZE, &TRANSFER, NULL);
    size_t other_cells = 0, other_depths = 0;
    for (size_t i = 0; i < (size_t)SIZE * SIZE; i++) {
      other_cells += fast.cells[i] != reference.cells[i];
      assert_true(isinf(fast.z[i]) == isinf(reference.z[i]));
      if (isinf(fast.z[i])) continue;
      other_depths += fabs(fast.z[i] - reference.z[i]) > 1e-3 || fabs(fast.z_back[i] - reference.z_back[i]) > 1e-3;
      assert_true(fabs(fast.transmittance[i] - (1 - fast.rgba[4 * i + 3])) < 1e-6);
    }
    /* A ray that touches a cell's corner may count it here and not there. */
    assert_true(other_cells < 10 && other_depths < 10);
    assert_int_equal(fast.stats.ray_count, reference.stats.ray_count);
    picture_release(&fast);
    picture_release(&reference);
  }
  scene_destroy(&scene);
}

/* An image alone is stored row by row, arrays pixel by pixel; tiles are empty, cut by the picture's rim, and whole. */
TEST(an_image_holds_what_arrays_hold)
{
  static const char *const channels[] = {"R", "G", "B", "A", "Z", "ZBack", "transmittance.Y", "cells.Y", "segments.Y"};
  enum { WIDTH = 150, HEIGHT = 70, COUNT = WIDTH * HEIGHT };
  random_state random = {7};
  cast_scene scene;
  make_scene(&scene, 2, 5, 0.3, false, 3, NULL);
  const cellist_view view = view_from(&random, 2.5, 40, 0);
  cast_picture arrays =
      scene_draw_with(&scene, scene.caster, CELLIST_PRECISION_FAST, &view, WIDTH, HEIGHT, &TRANSFER, NULL);
  for (size_t left_out = 0; left_out < 2; left_out++) { /* all channels, or the last five alone */
    cellist_image *image = NULL;
    const size_t first = left_out == 0 ? 0 : 4;
    assert_success(scene.context,
                   cellist_image_create(scene.context, WIDTH, HEIGHT, channels + first, 9 - first, &image));
    const cellist_raycast_output output = {.image = image};
    const cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_FAST};
    assert_success(scene.context,
                   cellist_raycaster_render(scene.caster, &arrays.frame, &TRANSFER, &desc, &output, NULL));
    size_t missed = 0;
    for (size_t k = first; k < 9; k++) {
      const float *plane = cellist_image_channel(image, channels[k]);
      for (size_t i = 0; i < COUNT; i++) {
        const double wanted = k < 4    ? arrays.rgba[4 * i + k]
                              : k == 4 ? arrays.z[i]
                              : k == 5 ? arrays.z_back[i]
                              : k == 6 ? arrays.transmittance[i]
                              : k == 7 ? arrays.cells[i]
                                       : arrays.segments[i];
        if (plane[i] != (float)wanted) fail_msg("%s of pixel %zu: %.9g, not %.9g", channels[k], i, plane[i], wanted);
        missed += isinf(plane[i]);
      }
    }
    assert_true(missed > COUNT / 2 && missed < COUNT);
    cellist_image_destroy(image);
  }
  picture_release(&arrays);
  scene_destroy(&scene);
}

TEST(absorption_is_black_and_other_models_are_refused)
{
  random_state random = {8};
  cast_scene scene;
  make_scene(&scene, 1, 4, 0.3, false, 2, NULL);
  const cellist_view view = view_from(&random, 2, 12, 0);
  cellist_optics optics = {.model = CELLIST_MODEL_ABSORPTION};
  cast_picture fast = draw_fast(&scene, scene.caster, &view, &optics);
  cast_picture reference = scene_draw(&scene, &view, SIZE, SIZE, &TRANSFER, &optics);
  assert_true(assert_close(&fast, &reference, 3e-5) > 100);
  const cellist_raycast_output output = {.rgba = fast.rgba};
  cellist_raycast_desc desc = {.optics.model = CELLIST_MODEL_MAXIMUM};
  assert_failure(scene.context, cellist_raycaster_render(scene.caster, &fast.frame, &TRANSFER, &desc, &output, NULL),
                 CELLIST_ERROR_UNSUPPORTED, "precision reference");
  picture_release(&fast);
  picture_release(&reference);
  scene_destroy(&scene);
}

TEST(all_layouts_and_any_number_of_workers_give_the_same_bits)
{
  random_state random = {9};
  cast_scene first;
  make_scene(&first, 1, 7, 0.5, false, 3, NULL);
  const cellist_view views[2] = {view_from(&random, 3.5, 20, 0), view_from(&random, 3.5, 2, 0)};
  for (int v = 0; v < 2; v++) {
    cast_picture expected = draw_fast(&first, first.caster, &views[v], NULL);
    const uint32_t layouts[] = {32, 20, 16};
    for (int i = 0; i < 3; i++) {
      const cellist_raycaster_desc desc = {.tets = layouts[i]};
      cellist_raycaster *caster = NULL;
      assert_success(first.context, cellist_raycaster_create(first.context, first.mesh, &first.scalar, &desc, &caster));
      cast_picture picture = draw_fast(&first, caster, &views[v], NULL);
      assert_same(&picture, &expected);
      picture_release(&picture);
      cellist_raycaster_destroy(caster);
    }
    for (unsigned workers = 2; workers < 5; workers++) {
      cast_scene other;
      make_scene(&other, workers, 7, 0.5, false, 3, NULL);
      cast_picture picture = draw_fast(&other, other.caster, &views[v], NULL);
      assert_same(&picture, &expected);
      picture_release(&picture);
      scene_destroy(&other);
    }
    picture_release(&expected);
  }
  scene_destroy(&first);
}

static void keep_tile(void *user, const fast_scene *scene, const fast_tile *tile) {
  fast_pixel *pixels = user;
  for (uint32_t y = 0; y < tile->height; y++)
    for (uint32_t x = 0; x < tile->width; x++)
      if (tile->first[y * FAST_TILE + x] != CELLIST_NONE)
        pixels[(tile->top + y) * scene->width + tile->left + x] = tile->pixels[y * FAST_TILE + x];
}

/* Plain C and vectors pass the very same cells; colours and depths differ by rounding. (Where the processor has no
 * vectors, both are plain C.) */
TEST(both_kernels_pass_the_same_cells_and_agree_to_rounding)
{
  random_state random = {11};
  for (int round = 0; round < 12; round++) {
    cast_scene scene;
    const double odd = NAN;
    make_scene(&scene, 1, 6, round % 4 == 3 ? 0 : 0.5, round % 3 == 1, 20 + (uint64_t)round,
               round % 3 == 2 ? &odd : NULL);
    fast_caster *caster = NULL;
    assert_success(scene.context, fast_caster_create(scene.context, cellist_mesh_get_arrays(scene.mesh), &scene.scalar,
                                                     (fast_layout)(round % FAST_LAYOUT_COUNT), &caster));
    cellist_view view = view_from(&random, 3, round % 2 ? 3 : 18, round / 4 % 2);
    if (round % 4 == 3)
      view = (cellist_view){.eye = {20, 3, 3}, .target = {3, 3, 3}, .up = {0, 0, 1}, .parallel_height = 8};
    if (view.parallel_height == 0) view.fovy_degrees = 30;
    cellist_frame frame;
    assert_success(scene.context, cellist_frame_from_view(scene.context, &view, SIZE, SIZE, &frame));
    fast_pixel *pixels[2];
    fast_stats stats[2];
    for (int kernel = 0; kernel < 2; kernel++) {
      const fast_draw_desc desc = {.wants_depth = true, .kernel = (fast_kernel)kernel};
      pixels[kernel] = calloc((size_t)SIZE * SIZE, sizeof **pixels);
      assert_success(scene.context,
                     fast_caster_draw(caster, &frame, &TRANSFER, &desc, keep_tile, pixels[kernel], &stats[kernel]));
    }
    assert_true(stats[0].ray_count > 100);
    assert_int_equal(stats[0].ray_count, stats[1].ray_count);
    assert_int_equal(stats[0].retry_count, stats[1].retry_count);
    for (size_t i = 0; i < (size_t)SIZE * SIZE; i++) {
      const fast_pixel *a = &pixels[0][i], *b = &pixels[1][i];
      bool is_retried = false;
      for (size_t r = 0; r < stats[0].retry_count; r++) is_retried = is_retried || stats[0].retries[r] == i;
      if (is_retried) continue;
      for (int k = 0; k < 3; k++) assert_true(fabsf(a->light.colour[k] - b->light.colour[k]) < 1e-4f);
      assert_true(fabsf(a->light.transmittance - b->light.transmittance) < 1e-4f);
      assert_true(a->z == b->z || fabsf(a->z - b->z) < 1e-2f);
      assert_true(a->z_back == b->z_back || fabsf(a->z_back - b->z_back) < 1e-2f);
      if (a->light.transmittance > 1e-4f && view.near_distance == 0 && round % 2 == 0)
        assert_int_equal(a->cell_count, b->cell_count);
    }
    for (int kernel = 0; kernel < 2; kernel++) free(pixels[kernel]);
    fast_caster_destroy(caster);
    scene_destroy(&scene);
  }
}

/* Two grids that overlap: chains that are no longer disjoint in depth. */
TEST(overlapping_cells_end_in_a_finite_picture_and_are_counted)
{
  random_state random = {10};
  kuhn_grid grid = kuhn_grid_create(4);
  double *points = malloc(6 * grid.point_count * sizeof *points),
         *values = calloc(2 * grid.point_count, sizeof *values);
  uint32_t *tets = malloc(8 * grid.tet_count * sizeof *tets);
  for (size_t i = 0; i < 6 * grid.point_count; i++)
    points[i] = grid.points[i % (3 * grid.point_count)] + (i >= 3 * grid.point_count ? 1.3 : 0);
  for (size_t i = 0; i < 8 * grid.tet_count; i++)
    tets[i] = grid.tets[i % (4 * grid.tet_count)] + (uint32_t)(i >= 4 * grid.tet_count ? grid.point_count : 0);
  for (size_t i = 0; i < 2 * grid.point_count; i++) values[i] = random_unit(&random);
  cast_scene scene;
  scene_create(&scene, 1, 2 * grid.point_count, points, 2 * grid.tet_count, tets, CELLIST_ON_POINTS, values);
  const cellist_view view = view_from(&random, 2.5, 18, 0);
  cast_picture fast = draw_fast(&scene, scene.caster, &view, NULL);
  cast_picture reference = scene_draw(&scene, &view, SIZE, SIZE, &TRANSFER, NULL);
  for (size_t i = 0; i < 4 * (size_t)SIZE * SIZE; i++) assert_true(fast.rgba[i] >= -1e-5 && fast.rgba[i] <= 1.00001);
  assert_true(fast.stats.fold_ray_count > 100);
  assert_int_equal(fast.stats.fold_ray_count, reference.stats.fold_ray_count);
  picture_release(&fast);
  picture_release(&reference);
  scene_destroy(&scene);
  free(points);
  free(values);
  free(tets);
  kuhn_grid_release(&grid);
}

static cellist_result draw_small(cellist_context *context, void *user) {
  (void)user;
  const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, values[] = {0, 0.2, 0.7, 1};
  const uint32_t tets[] = {0, 1, 2, 3};
  const cellist_field field = {"s", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {4, points, 1, tets, NULL, 1, &field};
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar = {0};
  cellist_raycaster *caster = NULL;
  cellist_result result = cellist_mesh_create(context, &desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, mesh, NULL, &scalar);
  if (result == CELLIST_SUCCESS) result = cellist_raycaster_create(context, mesh, &scalar, NULL, &caster);
  if (result == CELLIST_SUCCESS) {
    const cellist_view view = cellist_view_orbit(cellist_mesh_get_arrays(mesh)->bounds, 30, 20);
    double rgba[4 * 40 * 40];
    const cellist_raycast_output output = {.rgba = rgba};
    cellist_frame frame;
    result = cellist_frame_from_view(context, &view, 40, 40, &frame);
    if (result == CELLIST_SUCCESS) result = cellist_raycaster_render(caster, &frame, &TRANSFER, NULL, &output, NULL);
  }
  cellist_raycaster_destroy(caster);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{ check_allocation_failures(draw_small, NULL); }

TEST(a_mesh_without_cells_gives_an_empty_picture)
{
  cast_scene scene;
  const double point[3] = {0};
  const double value = 0;
  scene_create(&scene, 1, 1, point, 0, NULL, CELLIST_ON_POINTS, &value);
  const cellist_view view = {.eye = {1, 1, 1}, .up = {0, 0, 1}, .fovy_degrees = 30};
  cast_picture picture = draw_fast(&scene, scene.caster, &view, NULL);
  for (size_t i = 0; i < 4 * (size_t)SIZE * SIZE; i++) assert_true(picture.rgba[i] == 0);
  assert_int_equal(picture.stats.ray_count, 0);
  picture_release(&picture);
  scene_destroy(&scene);
}
