/* SPDX-License-Identifier: BSD-3-Clause
 * Projector: every optical model, unlit and lit, against the reference caster; both kernels, several views. */
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

enum { SIZE = 48, VIEWS = 3 };

static const char *const CHANNELS[] = {"R", "G", "B", "A", "Z", "ZBack"};

typedef struct scene {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_soft *soft[2]; /* portable, best */
  cellist_raycaster *caster;
  cellist_transfer transfer;
  cellist_sorter *sorter;
  uint32_t *order;
  size_t order_count;
} scene;

static void scene_open(scene *made) {
  *made = (scene){.context = harness_context(2)};
  cellist_context *context = made->context;
  const cellist_generate_desc generate = {.size = 2000, .perturb = 0.3};
  assert_success(context, cellist_generate(context, "grid", &generate, &made->mesh));
  assert_success(context, cellist_scalar_select(context, made->mesh, NULL, &made->scalar));
  const cellist_transfer_desc desc = {
      .range = {made->scalar.minimum, made->scalar.maximum}, .unit_distance = 0.05, .opacity_scale = 2};
  assert_success(context, cellist_transfer_load(context, &desc, &made->transfer));
  for (int i = 0; i < 2; i++) {
    const cellist_soft_desc soft_desc = {.portable = i == 0};
    assert_success(context, cellist_soft_create(context, made->mesh, &made->scalar, &soft_desc, &made->soft[i]));
  }
  assert_success(context, cellist_raycaster_create(context, made->mesh, &made->scalar, NULL, &made->caster));
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  const cellist_sorter_desc sorter = {.point_count = arrays->point_count,
                                      .points = arrays->positions,
                                      .tet_count = arrays->tet_count,
                                      .tets = arrays->tets,
                                      .neighbours = arrays->neighbours};
  assert_success(context, cellist_sorter_create(context, &sorter, &made->sorter));
  made->order_count = arrays->tet_count;
  made->order = malloc(made->order_count * sizeof *made->order);
}

static void scene_close(scene *made) {
  free(made->order);
  cellist_sorter_destroy(made->sorter);
  cellist_raycaster_destroy(made->caster);
  for (int i = 0; i < 2; i++) cellist_soft_destroy(made->soft[i]);
  cellist_transfer_release(made->context, &made->transfer);
  cellist_scalar_release(made->context, &made->scalar);
  cellist_mesh_destroy(made->mesh);
  harness_context_destroy(made->context);
}

/* From outside, from inside, in parallel; sorts. */
static cellist_frame look(scene *made, int number) {
  const double *bounds = cellist_mesh_get_arrays(made->mesh)->bounds;
  cellist_view view = cellist_view_orbit(bounds, 30.96, 34.45);
  if (number == 1) {
    for (int k = 0; k < 3; k++) {
      view.target[k] = bounds[3 + k];
      view.eye[k] = bounds[k] + (0.4123 + 0.0311 * k) * (bounds[3 + k] - bounds[k]);
    }
    view.fovy_degrees = 100;
  }
  if (number == 2) view.parallel_height = 1.6 * (bounds[3] - bounds[0]);
  cellist_frame frame;
  assert_success(made->context, cellist_frame_from_view(made->context, &view, SIZE, SIZE, &frame));
  cellist_viewpoint viewpoint = {.parallel = frame.parallel};
  memcpy(viewpoint.position, frame.parallel ? frame.forward : frame.eye, sizeof viewpoint.position);
  assert_success(made->context, cellist_sorter_sort(made->sorter, &viewpoint, made->order, NULL));
  return frame;
}

static cellist_image *blank(scene *made) {
  cellist_image *image = NULL;
  assert_success(made->context, cellist_image_create(made->context, SIZE, SIZE, CHANNELS, 6, &image));
  return image;
}

static void check_depths(const cellist_image *image, const cellist_image *truth) {
  const float *alpha = cellist_image_channel(truth, "A");
  for (int c = 4; c < 6; c++) {
    const float *z = cellist_image_channel(image, CHANNELS[c]), *right = cellist_image_channel(truth, CHANNELS[c]);
    size_t wrong = 0;
    for (size_t i = 0; i < (size_t)SIZE * SIZE; i++)
      wrong += alpha[i] > 0.01f && !(fabsf(z[i] - right[i]) <= 0.02f * right[i] + 1e-3f);
    assert_true(wrong <= 2); /* a first contribution of 1e-12 may be seen by one and not by the other */
  }
}

/* The largest rmse and difference over views and kernels. */
static cellist_image_error worst_error(scene *made, const cellist_optics *optics) {
  cellist_image_error worst = {0};
  for (int number = 0; number < VIEWS; number++) {
    const cellist_frame frame = look(made, number);
    cellist_image *truth = blank(made);
    const cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_REFERENCE, .optics = *optics};
    const cellist_raycast_output output = {.image = truth};
    assert_success(made->context,
                   cellist_raycaster_render(made->caster, &frame, &made->transfer, &desc, &output, NULL));
    for (int kernel = 0; kernel < 2; kernel++) {
      cellist_image *image = blank(made);
      const cellist_soft_settings settings = {
          .optics = *optics, .order = made->order, .order_count = made->order_count};
      assert_success(made->context,
                     cellist_soft_render(made->soft[kernel], &frame, &made->transfer, &settings, image, NULL));
      cellist_image_error error;
      assert_success(made->context, cellist_image_compare(made->context, image, truth, &error, NULL));
      assert_true(error.covered_pixels > SIZE * SIZE / 12);
      worst.rmse = fmax(worst.rmse, error.rmse);
      worst.max_abs = fmax(worst.max_abs, error.max_abs);
      if (optics->model != CELLIST_MODEL_EMISSION) check_depths(image, truth);
      cellist_image_destroy(image);
    }
    cellist_image_destroy(truth);
  }
  printf("rmse %.2g, max %.2g\n", worst.rmse, worst.max_abs);
  return worst;
}

static void check(const cellist_optics *optics, double rmse, double most) {
  scene made;
  scene_open(&made);
  const cellist_image_error worst = worst_error(&made, optics);
  if (!(worst.rmse <= rmse && worst.max_abs <= most)) fail_msg("rmse %g, max %g", worst.rmse, worst.max_abs);
  scene_close(&made);
}

/* Gradients of the generated field are some units per unit length. */
static cellist_light light_of(bool cell_gradients, double specular) {
  return (cellist_light){.enabled = true,
                         .direction = {0.3, -0.8, 0.5},
                         .ambient = 0.3,
                         .diffuse = 0.6,
                         .specular = specular,
                         .shininess = 12,
                         .gradient_unit = 2,
                         .cell_gradients = cell_gradients};
}

TEST(emission_matches_the_reference)
{
  const cellist_optics optics = {.model = CELLIST_MODEL_EMISSION};
  check(&optics, 1e-5, 2e-4); /* emission adds up to tens */
}
TEST(maximum_intensity_matches_the_reference)
{
  const cellist_optics optics = {.model = CELLIST_MODEL_MAXIMUM};
  check(&optics, 1e-6, 1e-5);
}

/* Three peaks of half-width 1e-8 of the scalar's range. */
static void scene_open_narrow(scene *made) {
  scene_open(made);
  cellist_transfer_release(made->context, &made->transfer);
  const double low = made->scalar.minimum, range = made->scalar.maximum - low, width = 1e-8;
  made->transfer.knots = cellist_allocate(made->context, 9, sizeof *made->transfer.knots);
  assert_non_null(made->transfer.knots);
  for (size_t i = 0; i < 9; i++) {
    const double at = 0.3 + 0.2 * (double)(i / 3) + width * ((double)(i % 3) - 1);
    made->transfer.knots[i] = (cellist_transfer_knot){
        low + at * range, i % 3 == 1 ? 0.5 / width : 0, {i / 3 == 0, i / 3 == 1, 0.5 * (double)(i % 3)}};
  }
  made->transfer.knot_count = 9;
}

TEST(peaks_too_narrow_for_floats_match_the_reference)
{
  const struct {
    cellist_optics optics;
    double rmse, most;
  } looks[] = {{{.sample_count = 1}, 1e-6, 1e-5},
               {{.model = CELLIST_MODEL_ABSORPTION}, 1e-6, 1e-5},
               {{.model = CELLIST_MODEL_EMISSION}, 1e-6, 1e-4},
               {{.model = CELLIST_MODEL_MAXIMUM}, 1e-6, 1e-5},
               {{.light = light_of(true, 0.3)}, 1e-6, 1e-5},
               {{.light = light_of(false, 0.3), .sample_count = 4}, 1e-5, 1e-4}};
  scene made;
  scene_open_narrow(&made);
  for (size_t i = 0; i < sizeof looks / sizeof looks[0]; i++) {
    const cellist_image_error worst = worst_error(&made, &looks[i].optics);
    if (!(worst.rmse <= looks[i].rmse && worst.max_abs <= looks[i].most))
      fail_msg("look %zu: rmse %g, max %g", i, worst.rmse, worst.max_abs);
  }
  scene_close(&made);
}

static const cellist_isosurface ISOS[] = {{0.62, 0.5}, {0.35, 1}, {0.5, 0.25}};

TEST(isosurfaces_match_the_reference)
{
  const cellist_optics optics = {.model = CELLIST_MODEL_ISOSURFACES, .iso_count = 3, .isos = ISOS};
  check(&optics, 1e-6, 1e-5);
}
TEST(isosurfaces_lit_by_cells_match_the_reference)
{
  const cellist_optics optics = {
      .model = CELLIST_MODEL_ISOSURFACES, .iso_count = 3, .isos = ISOS, .light = light_of(true, 0.3)};
  check(&optics, 1e-6, 1e-5);
}
TEST(isosurfaces_lit_by_points_match_the_reference)
{
  const cellist_optics optics = {
      .model = CELLIST_MODEL_ISOSURFACES, .iso_count = 3, .isos = ISOS, .light = light_of(false, 0.3)};
  check(&optics, 1e-5, 1e-4);
}

TEST(light_by_cells_is_exact)
{
  const cellist_optics optics = {.light = light_of(true, 0.4)};
  check(&optics, 1e-5, 1e-4);
  const cellist_optics emission = {.model = CELLIST_MODEL_EMISSION, .light = light_of(true, 0.4)};
  check(&emission, 2e-5, 5e-4);
}

/* More samples come nearer; four are well within what is asked of a picture, 2e-3, on cells this coarse. */
TEST(light_by_points_converges_with_samples)
{
  scene made;
  scene_open(&made);
  double last = 1;
  for (uint32_t samples = 1; samples <= 4; samples *= 2) {
    const cellist_optics optics = {.light = light_of(false, 0.4), .sample_count = samples};
    const double rmse = worst_error(&made, &optics).rmse;
    assert_true(rmse < 0.7 * last);
    last = rmse;
  }
  if (!(last < 1e-3)) fail_msg("rmse %g", last);
  scene_close(&made);
}

/* Ten surfaces through a thousand cells: were one missed or met twice where cells meet, a pixel would stand out. */
TEST(isosurfaces_have_no_holes_between_cells)
{
  cellist_isosurface isos[10];
  for (int i = 0; i < 10; i++) isos[i] = (cellist_isosurface){0.1 + 0.083 * i, 0.3};
  const cellist_optics optics = {.model = CELLIST_MODEL_ISOSURFACES, .iso_count = 10, .isos = isos};
  scene made;
  scene_open(&made);
  size_t outliers = 0;
  for (int number = 0; number < VIEWS; number++) {
    const cellist_frame frame = look(&made, number);
    cellist_image *truth = blank(&made), *image = blank(&made);
    const cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_REFERENCE, .optics = optics};
    const cellist_raycast_output output = {.image = truth};
    const cellist_soft_settings settings = {.optics = optics, .order = made.order, .order_count = made.order_count};
    assert_success(made.context, cellist_raycaster_render(made.caster, &frame, &made.transfer, &desc, &output, NULL));
    assert_success(made.context, cellist_soft_render(made.soft[1], &frame, &made.transfer, &settings, image, NULL));
    for (size_t i = 0; i < (size_t)SIZE * SIZE; i++)
      outliers += fabsf(cellist_image_channel(truth, "A")[i] - cellist_image_channel(image, "A")[i]) > 0.01f;
    cellist_image_destroy(truth);
    cellist_image_destroy(image);
  }
  assert_int_equal(outliers, 0);
  scene_close(&made);
}

static cellist_result draw_lit(cellist_context *context, void *user) {
  const cellist_optics *optics = user;
  static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, values[4] = {0, 1, 2, 4};
  static const uint32_t tet[4] = {0, 1, 2, 3}, order[1] = {0};
  const cellist_field field = {"s", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {4, points, 1, tet, NULL, 1, &field};
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar = {0};
  cellist_soft *soft = NULL;
  cellist_image *image = NULL;
  cellist_result result = cellist_mesh_create(context, &desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, mesh, NULL, &scalar);
  if (result == CELLIST_SUCCESS) result = cellist_soft_create(context, mesh, &scalar, NULL, &soft);
  if (result == CELLIST_SUCCESS) result = cellist_image_create(context, 8, 8, CHANNELS, 6, &image);
  const cellist_view view = {.eye = {0.2, 0.2, 5}, .target = {0.2, 0.2, 0}, .up = {0, 1, 0}, .parallel_height = 0.5};
  cellist_frame frame;
  if (result == CELLIST_SUCCESS) result = cellist_frame_from_view(context, &view, 8, 8, &frame);
  /* With a narrow gap, which has tables of its own. */
  const double middle = 0.5 * scalar.minimum + 0.5 * scalar.maximum;
  cellist_transfer_knot knots[] = {{middle, 0.5, {1, 0.5, 0.25}}, {middle + 1e-9, 0.7, {1, 0.5, 0.25}}};
  const cellist_transfer transfer = {2, knots};
  const cellist_soft_settings settings = {.optics = *optics, .order = order, .order_count = 1};
  if (result == CELLIST_SUCCESS) result = cellist_soft_render(soft, &frame, &transfer, &settings, image, NULL);
  cellist_image_destroy(image);
  cellist_soft_destroy(soft);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(failed_allocations_of_light_and_surfaces_leak_nothing)
{
  cellist_optics optics = {.light = light_of(false, 0.3)};
  check_allocation_failures(draw_lit, &optics);
  optics.model = CELLIST_MODEL_ISOSURFACES;
  optics.iso_count = 3;
  optics.isos = ISOS;
  check_allocation_failures(draw_lit, &optics);
}
