/* SPDX-License-Identifier: BSD-3-Clause
 * Projector: pictures of meshes against the reference caster; groups, workers, what is not drawn, what is refused. */
#include <cellist/compare.h>
#include <cellist/generate.h>
#include <cellist/raycast.h>
#include <cellist/soft.h>
#include <cellist/sort.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

static const char *const CHANNELS[] = {"R", "G", "B", "A", "Z", "ZBack"};
enum { SIZE = 96 };

typedef struct stage {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_soft *soft;
  cellist_transfer transfer;
  uint32_t *order;
  size_t order_count;
} stage;

static void stage_open(stage *made, unsigned workers, bool portable, double opacity_scale) {
  *made = (stage){.context = harness_context(workers)};
  cellist_context *context = made->context;
  const cellist_generate_desc generate = {.size = 3000, .perturb = 0.3};
  assert_success(context, cellist_generate(context, "grid", &generate, &made->mesh));
  assert_success(context, cellist_scalar_select(context, made->mesh, NULL, &made->scalar));
  const cellist_transfer_desc desc = {.source = "ramp",
                                      .range = {made->scalar.minimum, made->scalar.maximum},
                                      .unit_distance = 0.05,
                                      .opacity_scale = opacity_scale};
  assert_success(context, cellist_transfer_load(context, &desc, &made->transfer));
  const cellist_soft_desc soft_desc = {.portable = portable};
  assert_success(context, cellist_soft_create(context, made->mesh, &made->scalar, &soft_desc, &made->soft));
  made->order_count = cellist_mesh_get_arrays(made->mesh)->tet_count;
  made->order = malloc(made->order_count * sizeof *made->order);
}

static void stage_close(stage *made) {
  free(made->order);
  cellist_soft_destroy(made->soft);
  cellist_transfer_release(made->context, &made->transfer);
  cellist_scalar_release(made->context, &made->scalar);
  cellist_mesh_destroy(made->mesh);
  harness_context_destroy(made->context);
}

/* The view and the order that belongs to it; the grid's boundary is flat, so its order is exact. */
static cellist_frame stage_look(stage *made, const cellist_view *view) {
  cellist_frame frame;
  assert_success(made->context, cellist_frame_from_view(made->context, view, SIZE, SIZE, &frame));
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  cellist_sorter *sorter = NULL;
  cellist_sort_stats stats;
  assert_success(made->context, cellist_sorter_create(made->context, &desc, &sorter));
  cellist_viewpoint viewpoint = {.parallel = frame.parallel};
  memcpy(viewpoint.position, frame.parallel ? frame.forward : frame.eye, sizeof viewpoint.position);
  assert_success(made->context, cellist_sorter_sort(sorter, &viewpoint, made->order, &stats));
  assert_true(stats.exact && stats.group_count == 0);
  cellist_sorter_destroy(sorter);
  return frame;
}

static cellist_image *blank(cellist_context *context) {
  cellist_image *image = NULL;
  assert_success(context, cellist_image_create(context, SIZE, SIZE, CHANNELS, 6, &image));
  return image;
}

static cellist_image *project(stage *made, const cellist_frame *frame, const cellist_soft_settings *settings) {
  cellist_image *image = blank(made->context);
  assert_success(made->context, cellist_soft_render(made->soft, frame, &made->transfer, settings, image, NULL));
  return image;
}

static cellist_image *truth(stage *made, const cellist_frame *frame, cellist_model model) {
  cellist_image *image = blank(made->context);
  cellist_raycaster *caster = NULL;
  const cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_REFERENCE, .optics = {.model = model}};
  const cellist_raycast_output output = {.image = image};
  assert_success(made->context, cellist_raycaster_create(made->context, made->mesh, &made->scalar, NULL, &caster));
  assert_success(made->context, cellist_raycaster_render(caster, frame, &made->transfer, &desc, &output, NULL));
  cellist_raycaster_destroy(caster);
  return image;
}

/* Outside, inside, with the near plane through the mesh, in parallel. */
static cellist_view view_number(const stage *made, int number) {
  const double *bounds = cellist_mesh_get_arrays(made->mesh)->bounds;
  cellist_view view = cellist_view_orbit(bounds, 30.96, 34.45);
  const double distance = sqrt(pow(view.eye[0] - view.target[0], 2) + pow(view.eye[1] - view.target[1], 2) +
                               pow(view.eye[2] - view.target[2], 2));
  if (number == 1)
    for (int k = 0; k < 3; k++) {
      view.target[k] = bounds[3 + k];
      view.eye[k] = bounds[k] + (0.4123 + 0.0311 * k) * (bounds[3 + k] - bounds[k]);
    }
  if (number == 1) view.fovy_degrees = 100;
  if (number == 2) view.near_distance = distance;
  if (number == 3) view.parallel_height = 0.4 * distance;
  if (number == 4) {
    view.parallel_height = 0.4 * distance;
    view.near_distance = distance;
  }
  return view;
}

static void compare_with_truth(bool portable, double opacity_scale, double rmse, double largest) {
  stage made;
  stage_open(&made, 2, portable, opacity_scale);
  for (int number = 0; number < 5; number++) {
    const cellist_view view = view_number(&made, number);
    const cellist_frame frame = stage_look(&made, &view);
    const cellist_soft_settings settings = {.order = made.order, .order_count = made.order_count};
    cellist_image *image = project(&made, &frame, &settings);
    cellist_image *reference = truth(&made, &frame, CELLIST_MODEL_EMISSION_ABSORPTION);
    cellist_image_error error;
    assert_success(made.context, cellist_image_compare(made.context, image, reference, &error, NULL));
    printf("view %d: rmse %.2g, max %.2g over %zu pixels\n", number, error.rmse, error.max_abs, error.covered_pixels);
    assert_true(error.covered_pixels > SIZE * SIZE / 8);
    if (!(error.rmse <= rmse && error.max_abs <= largest)) fail_msg("view %d: rmse %g", number, error.rmse);
    const float *z[2] = {cellist_image_channel(image, "Z"), cellist_image_channel(reference, "Z")};
    const float *alpha = cellist_image_channel(reference, "A");
    for (size_t i = 0; i < SIZE * SIZE; i++)
      if (alpha[i] > 0.01f) assert_true(fabsf(z[0][i] - z[1][i]) <= 0.05f * fabsf(z[1][i]) + 1e-3f);
    cellist_image_destroy(image);
    cellist_image_destroy(reference);
  }
  stage_close(&made);
}

TEST(meshes_agree_with_the_reference)
{ compare_with_truth(false, 1, 1e-5, 1e-4); }
TEST(meshes_agree_with_the_reference_without_avx2)
{ compare_with_truth(true, 1, 1e-5, 1e-4); }
TEST(opaque_meshes_agree_with_the_reference)
{ compare_with_truth(false, 30, 1e-4, 1e-3); }

TEST(absorption_only_is_black)
{
  stage made;
  stage_open(&made, 1, false, 1);
  const cellist_view view = view_number(&made, 0);
  const cellist_frame frame = stage_look(&made, &view);
  const cellist_soft_settings settings = {
      .optics = {.model = CELLIST_MODEL_ABSORPTION}, .order = made.order, .order_count = made.order_count};
  cellist_image *image = project(&made, &frame, &settings), *reference = truth(&made, &frame, CELLIST_MODEL_ABSORPTION);
  cellist_image_error error;
  assert_success(made.context, cellist_image_compare(made.context, image, reference, &error, NULL));
  assert_true(error.covered_pixels > SIZE * SIZE / 8 && error.max_abs < 1e-4);
  cellist_image_destroy(image);
  cellist_image_destroy(reference);
  stage_close(&made);
}

/* All cells in one group, or half of them, in any order: the picture of the right order. */
TEST(groups_are_composited_by_depth)
{
  for (int portable = 0; portable < 2; portable++) {
    stage made;
    stage_open(&made, 2, portable, 5);
    const cellist_view view = view_number(&made, 0);
    const cellist_frame frame = stage_look(&made, &view);
    cellist_soft_settings settings = {.order = made.order, .order_count = made.order_count};
    cellist_image *right = project(&made, &frame, &settings);
    random_state random = {11};
    const cellist_soft_group groups[2] = {{100, 900}, {1500, made.order_count - 1700}};
    for (int g = 0; g < 2; g++)
      for (size_t i = groups[g].count - 1; i > 0; i--) {
        const size_t a = groups[g].begin + i, b = groups[g].begin + (size_t)random_below(&random, i + 1);
        const uint32_t swapped = made.order[a];
        made.order[a] = made.order[b];
        made.order[b] = swapped;
      }
    cellist_image *wrong = project(&made, &frame, &settings);
    settings.groups = groups;
    settings.group_count = 2;
    cellist_image *grouped = project(&made, &frame, &settings);
    cellist_image_error without, with;
    assert_success(made.context, cellist_image_compare(made.context, wrong, right, &without, NULL));
    assert_success(made.context, cellist_image_compare(made.context, grouped, right, &with, NULL));
    assert_true(without.max_abs > 1e-2 && with.max_abs < 1e-5);
    cellist_image_destroy(right);
    cellist_image_destroy(wrong);
    cellist_image_destroy(grouped);
    stage_close(&made);
  }
}

TEST(bits_do_not_depend_on_workers)
{
  float *first = NULL;
  for (unsigned workers = 1; workers <= 3; workers++) {
    stage made;
    stage_open(&made, workers, false, 2);
    const cellist_view view = view_number(&made, 1);
    const cellist_frame frame = stage_look(&made, &view);
    const cellist_soft_group group = {500, 700};
    const cellist_soft_settings settings = {
        .order = made.order, .order_count = made.order_count, .groups = &group, .group_count = 1};
    cellist_image *image = project(&made, &frame, &settings);
    if (first == NULL) first = calloc(6 * SIZE * SIZE, sizeof *first);
    for (size_t c = 0; c < 6; c++) {
      const float *plane = cellist_image_channel(image, CHANNELS[c]);
      if (workers == 1) memcpy(first + c * SIZE * SIZE, plane, SIZE * SIZE * sizeof *plane);
      assert_memory_equal(first + c * SIZE * SIZE, plane, SIZE * SIZE * sizeof *plane);
    }
    cellist_image_destroy(image);
    stage_close(&made);
  }
  free(first);
}

TEST(channels_that_are_wanted_do_not_change_each_other)
{
  for (int number = 0; number < 4; number++) {
    stage made;
    stage_open(&made, 2, number == 1, number == 2 ? 1e-3 : 2); /* thin: pixels gather opacity */
    const cellist_view view = view_number(&made, number);
    const cellist_frame frame = stage_look(&made, &view);
    const cellist_soft_settings settings = {.order = made.order, .order_count = made.order_count};
    cellist_image *whole = project(&made, &frame, &settings);
    for (size_t k = 0; k < 6; k++) {
      cellist_image *one = NULL;
      assert_success(made.context, cellist_image_create(made.context, SIZE, SIZE, CHANNELS + k, 1, &one));
      assert_success(made.context, cellist_soft_render(made.soft, &frame, &made.transfer, &settings, one, NULL));
      assert_memory_equal(cellist_image_channel(whole, CHANNELS[k]), cellist_image_channel(one, CHANNELS[k]),
                          (size_t)SIZE * SIZE * sizeof(float));
      cellist_image_destroy(one);
    }
    cellist_image_destroy(whole);
    stage_close(&made);
  }
}

/* Two unit tets, one of them spoilt: by a NaN, by having no volume; on cells. */
static void draw_two(const double *points, cellist_association association, const double *values, bool is_first_drawn,
                     bool is_second_drawn) {
  cellist_context *context = harness_context(1);
  const uint32_t tets[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  const cellist_field field = {"s", association, 1, values};
  const cellist_mesh_desc desc = {8, points, 2, tets, NULL, 1, &field};
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar = {0};
  cellist_soft *soft = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scalar));
  assert_success(context, cellist_soft_create(context, mesh, &scalar, NULL, &soft));
  const cellist_view view = {.eye = {2.3, 0.3, 9}, .target = {2.3, 0.3, 0}, .up = {0, 1, 0}, .parallel_height = 6};
  cellist_frame frame;
  assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frame));
  cellist_transfer_knot knot = {0, 1, {1, 1, 1}};
  const cellist_transfer transfer = {1, &knot};
  /* An imaginary cell stands between the two. */
  const uint32_t order[3] = {0, 77, 1};
  const cellist_soft_settings settings = {.order = order, .order_count = 3};
  cellist_image *image = blank(context);
  assert_success(context, cellist_soft_render(soft, &frame, &transfer, &settings, image, NULL));
  size_t seen[2] = {0, 0};
  for (size_t i = 0; i < SIZE * SIZE; i++) seen[i % SIZE >= SIZE / 2] += cellist_image_channel(image, "A")[i] > 0;
  assert_int_equal(seen[0] > 0, is_first_drawn);
  assert_int_equal(seen[1] > 0, is_second_drawn);
  cellist_image_destroy(image);
  cellist_soft_destroy(soft);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(flat_cells_and_cells_without_a_scalar_are_not_drawn)
{
  double points[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 4, 0, 0, 5, 0, 0, 4, 1, 0, 4, 0, 1};
  const double whole[8] = {0, 1, 2, 3, 4, 5, 6, 7}, spoilt[8] = {0, 1, NAN, 3, 4, 5, 6, 7};
  const double on_cells[2] = {1, 2}, spoilt_cells[2] = {1, INFINITY};
  draw_two(points, CELLIST_ON_POINTS, whole, true, true);
  draw_two(points, CELLIST_ON_POINTS, spoilt, false, true);
  draw_two(points, CELLIST_ON_CELLS, on_cells, true, true);
  draw_two(points, CELLIST_ON_CELLS, spoilt_cells, true, false);
  points[23] = 0;
  draw_two(points, CELLIST_ON_POINTS, whole, true, false);
}

TEST(what_cannot_be_drawn_is_said)
{
  stage made;
  stage_open(&made, 1, false, 1);
  const cellist_view view = view_number(&made, 0);
  const cellist_frame frame = stage_look(&made, &view);
  cellist_image *image = blank(made.context);
  const cellist_soft_settings settings = {.order = made.order, .order_count = made.order_count};
  cellist_soft_settings other = settings;
  other.optics.model = (cellist_model)7;
  assert_failure(made.context, cellist_soft_render(made.soft, &frame, &made.transfer, &other, image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "optical model");
  const cellist_soft_group beyond = {made.order_count - 1, 2};
  other = settings;
  other.groups = &beyond;
  other.group_count = 1;
  assert_failure(made.context, cellist_soft_render(made.soft, &frame, &made.transfer, &other, image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "group 0");
  const cellist_transfer none = {0, NULL};
  assert_failure(made.context, cellist_soft_render(made.soft, &frame, &none, &settings, image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "needs a knot");
  cellist_frame wide = frame;
  wide.width = 7;
  assert_failure(made.context, cellist_soft_render(made.soft, &wide, &made.transfer, &settings, image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "the image is 96x96, the frame 7x96");
  assert_failure(made.context, cellist_soft_render(made.soft, &frame, &made.transfer, NULL, image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "needs settings");
  cellist_image_destroy(image);
  stage_close(&made);
}

/* The unit cube in six tets, one colour: every ray of the view passes a length of 1. */
static cellist_result draw_cube(cellist_context *context, void *user) {
  (void)user;
  static const double points[24] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1};
  static const uint32_t tets[24] = {0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7};
  static const double values[6] = {1, 2, 3, 4, 5, 6};
  const cellist_field field = {"s", CELLIST_ON_CELLS, 1, values};
  const cellist_mesh_desc desc = {8, points, 6, tets, NULL, 1, &field};
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar = {0};
  cellist_soft *soft = NULL;
  cellist_image *image = NULL;
  cellist_result result = cellist_mesh_create(context, &desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, mesh, NULL, &scalar);
  if (result == CELLIST_SUCCESS) result = cellist_soft_create(context, mesh, &scalar, NULL, &soft);
  if (result == CELLIST_SUCCESS) result = cellist_image_create(context, 8, 8, CHANNELS, 6, &image);
  const cellist_view view = {.eye = {0.5, 0.5, 5}, .target = {0.5, 0.5, 0}, .up = {0, 1, 0}, .parallel_height = 0.5};
  cellist_frame frame;
  if (result == CELLIST_SUCCESS) result = cellist_frame_from_view(context, &view, 8, 8, &frame);
  cellist_transfer_knot knot = {0, 0.5, {1, 0.5, 0.25}};
  const cellist_transfer transfer = {1, &knot};
  const uint32_t order[6] = {0, 1, 2, 3, 4, 5};
  const cellist_soft_group group = {0, 6};
  const cellist_soft_settings settings = {.order = order, .order_count = 6, .groups = &group, .group_count = 1};
  if (result == CELLIST_SUCCESS) result = cellist_soft_render(soft, &frame, &transfer, &settings, image, NULL);
  if (result == CELLIST_SUCCESS)
    for (size_t i = 0; i < 64; i++) { /* every ray passes a length of 1 */
      const float alpha = (float)-expm1(-0.5);
      assert_true(fabsf(cellist_image_channel(image, "A")[i] - alpha) < 1e-6f);
      assert_true(fabsf(cellist_image_channel(image, "G")[i] - 0.5f * alpha) < 1e-6f);
      assert_true(fabsf(cellist_image_channel(image, "Z")[i] - 4) < 1e-5f);
      assert_true(fabsf(cellist_image_channel(image, "ZBack")[i] - 5) < 1e-5f);
    }
  cellist_image_destroy(image);
  cellist_soft_destroy(soft);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(a_cube_of_one_colour_is_a_slab)
{
  cellist_context *context = harness_context(1);
  assert_success(context, draw_cube(context, NULL));
  harness_context_destroy(context);
}

TEST(failed_allocations_leak_nothing)
{ check_allocation_failures(draw_cube, NULL); }
