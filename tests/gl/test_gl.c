/* SPDX-License-Identifier: BSD-3-Clause
 * The renderer as a whole: meshes in order, backends, repetition, what is left out, and failures. */
#include <cellist/sort.h>

#include "stage.h"

static const double CORNERS[12] = {0, 0, 0, 1, 0, 0, 0.2, 1.1, 0, 0.3, 0.3, 0.9};
static const double VALUES[4] = {0.1, 0.9, 0.3, 0.7};
static cellist_transfer_knot RAMP[] = {{0, 0, {0, 0, 1}}, {0.5, 1, {0, 1, 0}}, {1, 3, {1, 0, 0}}};
static const cellist_transfer TRANSFER = {3, RAMP};
static const double EYE[3] = {3, -2, 1.5}, CENTRE[3] = {0.375, 0.35, 0.225};

/* A box of n x n x n cubes of six tets each, its corners at 0 and size; a scalar that grows along x. */
static cellist_mesh *make_box(cellist_context *context, uint32_t n, const double size[3]) {
  static const uint32_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const uint32_t side = n + 1, step[3] = {1, side, side * side}, point_count = side * side * side;
  double *points = malloc(3 * point_count * sizeof *points), *values = malloc(point_count * sizeof *values);
  uint32_t *tets = malloc(24u * n * n * n * sizeof *tets);
  for (uint32_t i = 0; i < point_count; i++) {
    for (int k = 0; k < 3; k++) points[3 * i + (uint32_t)k] = size[k] * (i / step[k] % side) / n;
    values[i] = points[3 * i];
  }
  for (uint32_t t = 0; t < 6 * n * n * n; t++) {
    const uint32_t cube = t / 6;
    uint32_t at = cube % n * step[0] + cube / n % n * step[1] + cube / n / n * step[2];
    for (uint32_t c = 0; c < 4; c++) {
      tets[4 * t + c] = at;
      if (c < 3) at += step[path[t % 6][c]];
    }
  }
  const cellist_field field = {"x", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {point_count, points, 6u * n * n * n, tets, NULL, 1, &field};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  free(points);
  free(values);
  free(tets);
  return mesh;
}

static uint32_t *sort_mesh(cellist_context *context, const cellist_mesh *mesh, const cellist_frame *frame) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_sorter_desc desc = {arrays->point_count, arrays->positions,  arrays->tet_count,
                                    arrays->tets,        arrays->neighbours, NULL};
  cellist_viewpoint viewpoint = {.parallel = frame->parallel};
  memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  uint32_t *order = malloc(arrays->tet_count * sizeof *order);
  assert_success(context, cellist_sorter_sort(sorter, &viewpoint, order, NULL));
  cellist_sorter_destroy(sorter);
  return order;
}

/* Length of the ray inside the box from 0 to size, beyond the near plane; 0 if it misses. */
static double box_length(const cellist_frame *frame, const double size[3], double x, double y) {
  double origin[3], direction[3], front = frame->near_distance, back = HUGE_VAL;
  cellist_frame_ray(frame, x, y, origin, direction);
  for (int k = 0; k < 3; k++) {
    const double a = (0 - origin[k]) / direction[k], b = (size[k] - origin[k]) / direction[k];
    front = fmax(front, fmin(a, b));
    back = fmin(back, fmax(a, b));
  }
  if (!(front < back)) return 0;
  return (back - front) * sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
}

/* Emission and absorption of constant colour through a box: c (1 - exp(-e l)), whatever cells it is made of. */
TEST(a_uniform_slab_matches_the_closed_form)
{
  static cellist_transfer_knot knot[] = {{0, 1.3, {0.9, 0.4, 0.1}}};
  const cellist_transfer transfer = {1, knot};
  const double size[3] = {2, 2, 0.5}, eyes[3][3] = {{0.7, -0.3, 4}, {0.9, 1.1, 0.2}, {2.5, 3, 1.5}};
  const double target[3] = {1.07, 1.03, 0.26};
  enum { PIXELS = 64 };
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = make_box(context, 3, size);
  cellist_scalar scalar;
  cellist_image *image = NULL;
  cellist_gl *gl = NULL;
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scalar));
  assert_success(context, cellist_image_create(context, PIXELS, PIXELS, STAGE_CHANNELS, 6, &image));
  assert_success(context, cellist_gl_create(context, NULL, &gl));
  assert_success(context, cellist_gl_upload(gl, mesh, &scalar));
  for (int i = 0; i < 6; i++) {
    /* from outside, from inside, with the near plane through it; then the same in parallel */
    const cellist_frame frame =
        stage_frame(context, eyes[i % 3], target, i < 3 ? 0 : 2.5, i % 3 == 2 ? 2.6 : 0, PIXELS);
    uint32_t *order = sort_mesh(context, mesh, &frame);
    cellist_gl_stats stats;
    assert_success(context, cellist_gl_render(gl, &frame, &transfer, order, cellist_mesh_get_arrays(mesh)->tet_count,
                                              NULL, image, &stats));
    assert_true(stats.fragment_count > 0 && stats.triangle_count >= stats.cell_count && stats.cell_count > 0);
    size_t compared = 0;
    for (uint32_t y = 0; y < PIXELS; y++)
      for (uint32_t x = 0; x < PIXELS; x++) {
        const double length = box_length(&frame, size, x + 0.5, y + 0.5), alpha = 1 - exp(-1.3 * length);
        bool at_edge = false;
        for (int corner = 0; corner < 8; corner++)
          at_edge = at_edge || (box_length(&frame, size, x + 0.5 + cos(corner * 0.785) / 100,
                                           y + 0.5 + sin(corner * 0.785) / 100) > 0) != (length > 0);
        if (at_edge) continue;
        compared += length > 0;
        for (int c = 0; c < 4; c++) {
          const double truth = alpha * (c < 3 ? knot[0].colour[c] : 1);
          const float got = cellist_image_channel(image, STAGE_CHANNELS[c])[y * PIXELS + x];
          if (!(fabs(got - truth) <= 1e-5)) fail_msg("view %d, pixel %u %u: %g instead of %g", i, x, y, got, truth);
        }
      }
    assert_true(compared > 300);
    free(order);
  }
  cellist_gl_destroy(gl);
  cellist_image_destroy(image);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

enum { BOX_PIXELS = 96, BOX_FLOATS = 6 * BOX_PIXELS * BOX_PIXELS };

/* The six channels of one picture of a box, one after the other. */
static bool draw_box(cellist_gl_backend backend, unsigned workers, float *pixels) {
  const double size[3] = {1, 1, 1}, eye[3] = {2.5, 1.7, 2.2}, target[3] = {0.5, 0.5, 0.5};
  cellist_context *context = harness_context(workers);
  cellist_mesh *mesh = make_box(context, 12, size);
  cellist_scalar scalar;
  cellist_image *image = NULL;
  cellist_gl *gl = NULL;
  const cellist_gl_desc desc = {.backend = backend};
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scalar));
  assert_success(context, cellist_image_create(context, BOX_PIXELS, BOX_PIXELS, STAGE_CHANNELS, 6, &image));
  const bool opened = cellist_gl_create(context, &desc, &gl) == CELLIST_SUCCESS;
  if (opened) {
    const cellist_frame frame = stage_frame(context, eye, target, 0, 0, BOX_PIXELS);
    uint32_t *order = sort_mesh(context, mesh, &frame);
    assert_success(context, cellist_gl_upload(gl, mesh, &scalar));
    assert_success(context, cellist_gl_render(gl, &frame, &TRANSFER, order, cellist_mesh_get_arrays(mesh)->tet_count,
                                              NULL, image, NULL));
    for (size_t c = 0; c < 6; c++)
      memcpy(pixels + c * BOX_PIXELS * BOX_PIXELS, cellist_image_channel(image, STAGE_CHANNELS[c]),
             sizeof(float) * BOX_PIXELS * BOX_PIXELS);
    free(order);
  }
  cellist_gl_destroy(gl);
  cellist_image_destroy(image);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
  return opened;
}

TEST(two_runs_and_any_number_of_workers_give_the_same_bits)
{
  float *first = malloc(BOX_FLOATS * sizeof *first), *again = malloc(BOX_FLOATS * sizeof *again);
  assert_true(draw_box(CELLIST_GL_AUTO, 1, first));
  for (unsigned workers = 1; workers <= 3; workers++) {
    memset(again, 0, BOX_FLOATS * sizeof *again);
    assert_true(draw_box(CELLIST_GL_AUTO, workers, again));
    assert_memory_equal(first, again, BOX_FLOATS * sizeof *first);
  }
  float most = 0;
  for (size_t i = 0; i < BOX_FLOATS / 6; i++) most = fmaxf(most, first[3 * (BOX_FLOATS / 6) + i]);
  assert_true(most > 0.5);
  free(first);
  free(again);
}

TEST(osmesa_and_egl_agree)
{
  float *osmesa = malloc(BOX_FLOATS * sizeof *osmesa), *egl = malloc(BOX_FLOATS * sizeof *egl);
  const bool both = draw_box(CELLIST_GL_OSMESA, 2, osmesa) && draw_box(CELLIST_GL_EGL, 2, egl);
  for (size_t i = 0; both && i < BOX_FLOATS; i++)
    assert_true(osmesa[i] == egl[i] || fabsf(osmesa[i] - egl[i]) <= 1e-5f);
  free(osmesa);
  free(egl);
  if (!both) SKIP("osmesa and egl are not both here");
}

/* What shows nothing is not drawn: a flat cell, a NaN, a transfer function without extinction in the cell's range. */
TEST(cells_that_show_nothing_are_left_out)
{
  double points[48], values[16];
  for (int t = 0; t < 4; t++) {
    memcpy(&points[12 * t], CORNERS, sizeof CORNERS);
    memcpy(&values[4 * t], VALUES, sizeof VALUES);
  }
  points[12 + 11] = 0; /* flat */
  values[8] = NAN;
  for (int k = 12; k < 16; k++) values[k] = -1 - k; /* below the first knot */
  cellist_context *context = harness_context(1);
  stage made;
  assert_success(context, stage_open(context, CELLIST_GL_AUTO, 4, points, values, 16, &made));
  const cellist_frame frame = stage_frame(context, EYE, CENTRE, 0, 0, 16);
  const uint32_t order[] = {3, 1, 0, 2};
  cellist_gl_stats stats;
  assert_success(context, cellist_gl_render(made.gl, &frame, &TRANSFER, order, 4, NULL, made.image, &stats));
  assert_int_equal(stats.cell_count, 1);
  for (size_t i = 0; i < 256; i++) assert_true(isfinite(cellist_image_channel(made.image, "A")[i]));
  assert_success(context, cellist_gl_render(made.gl, &frame, &TRANSFER, NULL, 0, NULL, made.image, &stats));
  assert_int_equal(stats.fragment_count, 0);
  for (size_t i = 0; i < 256; i++) {
    assert_true(cellist_image_channel(made.image, "A")[i] == 0);
    assert_true(cellist_image_channel(made.image, "Z")[i] == INFINITY);
    assert_true(cellist_image_channel(made.image, "ZBack")[i] == 0);
  }
  stage_close(&made);
  harness_context_destroy(context);
}

static cellist_result draw_once(cellist_context *context, void *user) {
  const cellist_gl_backend *backend = user;
  stage made;
  cellist_result result = stage_open(context, *backend, 1, CORNERS, VALUES, 16, &made);
  if (result == CELLIST_SUCCESS) {
    const cellist_frame frame = stage_frame(context, EYE, CENTRE, 0, 0, 16);
    const uint32_t order = 0;
    result = cellist_gl_render(made.gl, &frame, &TRANSFER, &order, 1, NULL, made.image, NULL);
  }
  stage_close(&made);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  cellist_gl_backend backend = CELLIST_GL_AUTO;
  check_allocation_failures(draw_once, &backend);
}

TEST(bad_arguments_are_named)
{
  cellist_context *context = harness_context(1);
  stage made;
  assert_success(context, stage_open(context, CELLIST_GL_AUTO, 1, CORNERS, VALUES, 16, &made));
  const cellist_frame frame = stage_frame(context, EYE, CENTRE, 0, 0, 16);
  const cellist_frame wide = stage_frame(context, EYE, CENTRE, 0, 0, 17);
  const uint32_t order = 0, wrong = 7;
  cellist_transfer_knot backwards[] = {{1, 0, {0, 0, 0}}, {0, 1, {0, 0, 0}}};
  const cellist_transfer disorder = {2, backwards}, none = {0, NULL};
  assert_failure(context, cellist_gl_render(made.gl, &wide, &TRANSFER, &order, 1, NULL, made.image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "the image has 16x16 pixels, the frame 17x17");
  assert_failure(context, cellist_gl_render(made.gl, &frame, &TRANSFER, &wrong, 1, NULL, made.image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "names tet 7");
  assert_failure(context, cellist_gl_render(made.gl, &frame, &disorder, &order, 1, NULL, made.image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "knot 1");
  assert_failure(context, cellist_gl_render(made.gl, &frame, &none, &order, 1, NULL, made.image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "no knots");
  cellist_scalar other = made.scalar;
  other.count = 3;
  assert_failure(context, cellist_gl_upload(made.gl, made.mesh, &other), CELLIST_ERROR_INVALID_ARGUMENT, "3 values");
  assert_success(context, cellist_gl_render(made.gl, &frame, &TRANSFER, &order, 1, NULL, made.image, NULL));
  const cellist_gl_desc desc = {.backend = (cellist_gl_backend)9};
  cellist_gl *gl = NULL;
  assert_failure(context, cellist_gl_create(context, &desc, &gl), CELLIST_ERROR_UNSUPPORTED, "number 9");
  assert_null(gl);
  stage_close(&made);
  harness_context_destroy(context);
}
