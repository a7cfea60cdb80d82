/* SPDX-License-Identifier: BSD-3-Clause
 * Projector: pictures of single cells against the closed form, with both kernels; no pixel is excused. */
#include <cellist/soft.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../gl/single_cell.h"
#include "harness.h"

static cellist_transfer_knot KNOTS[] = {{-0.4, 0.0, {0, 0, 1}},
                                        {0.1, 0.9, {0, 1, 1}},
                                        {0.3, 0.2, {1, 0.5, 0}},
                                        {0.7, 2.5, {1, 1, 0}},
                                        {1.2, 0.4, {1, 0, 0}}};
static const cellist_transfer TRANSFER = {5, KNOTS};
static const char *const CHANNELS[] = {"R", "G", "B", "A", "Z", "ZBack"};

enum { CELLS = 2000, SIZE = 16 };

/* Tets that share nothing, and a projector for them. */
typedef struct stage {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_soft *soft[2]; /* portable, best */
  cellist_image *image[2];
} stage;

static void stage_open(stage *made, size_t tet_count, const double *points, const double *values, uint32_t size) {
  *made = (stage){.context = harness_context(1)};
  uint32_t *tets = malloc(4 * tet_count * sizeof *tets);
  for (uint32_t i = 0; i < 4 * tet_count; i++) tets[i] = i;
  const cellist_field field = {"value", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {4 * tet_count, points, tet_count, tets, NULL, 1, &field};
  assert_success(made->context, cellist_mesh_create(made->context, &desc, &made->mesh));
  free(tets);
  assert_success(made->context, cellist_scalar_select(made->context, made->mesh, NULL, &made->scalar));
  for (int i = 0; i < 2; i++) {
    assert_success(made->context, cellist_image_create(made->context, size, size, CHANNELS, 6, &made->image[i]));
    const cellist_soft_desc soft_desc = {.portable = i == 0};
    assert_success(made->context,
                   cellist_soft_create(made->context, made->mesh, &made->scalar, &soft_desc, &made->soft[i]));
  }
}

static void stage_close(stage *made) {
  for (int i = 0; i < 2; i++) {
    cellist_soft_destroy(made->soft[i]);
    cellist_image_destroy(made->image[i]);
  }
  cellist_scalar_release(made->context, &made->scalar);
  cellist_mesh_destroy(made->mesh);
  harness_context_destroy(made->context);
}

static oracle_cell stage_cell(const stage *made, uint32_t tet) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  oracle_cell cell;
  for (size_t k = 0; k < 4; k++) {
    const size_t point = arrays->tets[4 * (size_t)tet + k];
    for (size_t i = 0; i < 3; i++) cell.corner[k][i] = arrays->positions[3 * point + i];
    cell.scalar[k] = made->scalar.values[point];
  }
  return cell;
}

static cellist_frame frame_of(cellist_context *context, const double eye[3], const double target[3],
                              double parallel_height, double near_distance, uint32_t size) {
  cellist_view view = {
      .up = {0.1, 0.2, 0.97}, .fovy_degrees = 50, .parallel_height = parallel_height, .near_distance = near_distance};
  memcpy(view.eye, eye, sizeof view.eye);
  memcpy(view.target, target, sizeof view.target);
  cellist_frame frame;
  assert_success(context, cellist_frame_from_view(context, &view, size, size, &frame));
  return frame;
}

struct tally {
  size_t compared, covered;
  double worst, worst_depth;
};

/* Draws one cell with both kernels and compares every pixel. */
static void compare_cell(stage *made, uint32_t tet, const cellist_frame *frame, const cellist_transfer *transfer,
                         struct tally *tally) {
  const oracle_cell cell = stage_cell(made, tet);
  const cellist_soft_settings settings = {.order = &tet, .order_count = 1};
  for (int kernel = 0; kernel < 2; kernel++)
    assert_success(made->context,
                   cellist_soft_render(made->soft[kernel], frame, transfer, &settings, made->image[kernel], NULL));
  const size_t pixel_count = (size_t)frame->width * frame->height;
  for (size_t at = 0; at < pixel_count; at++) {
    const oracle_pixel truth =
        oracle_trace(&cell, frame, transfer, (double)(at % frame->width) + 0.5, (double)(at / frame->width) + 0.5);
    tally->compared++;
    tally->covered += truth.front < truth.back;
    for (int kernel = 0; kernel < 2; kernel++) {
      for (int c = 0; c < 4; c++) {
        const float value = cellist_image_channel(made->image[kernel], CHANNELS[c])[at];
        assert_true(isfinite(value));
        tally->worst = fmax(tally->worst, fabs(value - (double)truth.rgba[c]));
      }
      const double back = cellist_image_channel(made->image[kernel], "ZBack")[at];
      if (truth.rgba[3] > 1e-3L)
        tally->worst_depth = fmax(tally->worst_depth, fabs(back - (double)truth.back) / (double)truth.back);
    }
  }
}

static void random_point(random_state *random, double scale, double point[3]) {
  for (int k = 0; k < 3; k++) point[k] = random_between(random, -scale, scale);
}

/* Any tet; or a sliver: a plate, a needle, a wedge whose thickness is 1e-5 to 0.1. */
static void make_cell(random_state *random, bool sliver, double points[12]) {
  for (int k = 0; k < 4; k++) random_point(random, 1, &points[3 * k]);
  if (!sliver) return;
  const double thin = pow(10, random_between(random, -5, -1));
  const uint64_t kind = random_below(random, 3);
  for (int k = 0; k < 3; k++) {
    const double a = points[k], b = points[3 + k], c = points[6 + k];
    if (kind == 0) points[9 + k] = (a + b + c) / 3 + thin * points[9 + k];
    if (kind == 1) {
      points[6 + k] = 0.7 * a + 0.3 * b + thin * c;
      points[9 + k] = 0.2 * a + 0.8 * b + thin * points[9 + k];
    }
    if (kind == 2) points[9 + k] = c + thin * points[9 + k];
  }
}

/* A camera for a tet: one in four inside it (perspective), one in four with the near plane through it. */
static cellist_frame random_frame(random_state *random, const stage *made, uint32_t tet, bool parallel) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  const double *corner[4];
  double eye[3], target[3];
  for (size_t k = 0; k < 4; k++) corner[k] = &arrays->positions[3 * (size_t)arrays->tets[4 * (size_t)tet + k]];
  for (int k = 0; k < 3; k++) target[k] = 0.25 * (corner[0][k] + corner[1][k] + corner[2][k] + corner[3][k]);
  const uint64_t where = random_below(random, 4);
  random_point(random, 1, eye);
  const double norm = sqrt(eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]);
  const double distance = random_between(random, 0.8, 6);
  for (int k = 0; k < 3; k++) eye[k] = target[k] + eye[k] / norm * distance;
  if (where == 0 && !parallel) {
    double weights[4], sum = 0;
    for (int k = 0; k < 4; k++) sum += weights[k] = random_between(random, 0.02, 1);
    for (int i = 0; i < 3; i++) {
      eye[i] = 0;
      for (int k = 0; k < 4; k++) eye[i] += weights[k] / sum * corner[k][i];
      target[i] = corner[0][i];
    }
  }
  const double height = parallel ? random_between(random, 0.5, 3) : 0;
  const double near_distance = where == 1 ? distance * random_between(random, 0.8, 1.1) : 0;
  return frame_of(made->context, eye, target, height, near_distance, SIZE);
}

static void random_cells(bool sliver, bool parallel, double offset) {
  random_state random = {sliver ? 71 : 70};
  double *points = malloc(CELLS * 12 * sizeof *points), *values = malloc(CELLS * 4 * sizeof *values);
  for (size_t i = 0; i < CELLS; i++) {
    make_cell(&random, sliver, &points[12 * i]);
    for (size_t k = 0; k < 12; k++) points[12 * i + k] += offset;
    for (size_t k = 0; k < 4; k++) values[4 * i + k] = random_between(&random, -0.6, 1.4);
  }
  stage made;
  stage_open(&made, CELLS, points, values, SIZE);
  struct tally tally = {0};
  for (uint32_t tet = 0; tet < CELLS; tet++) {
    const cellist_frame frame = random_frame(&random, &made, tet, parallel);
    compare_cell(&made, tet, &frame, &TRANSFER, &tally);
  }
  printf("%zu pixels, %zu covered, worst error %.2g\n", tally.compared, tally.covered, tally.worst);
  stage_close(&made);
  free(points);
  free(values);
  assert_true(tally.covered > tally.compared / 100);
  if (!(tally.worst <= 1e-4)) fail_msg("worst error %g", tally.worst);
}

TEST(random_cells_in_perspective)
{ random_cells(false, false, 0); }
TEST(random_cells_in_parallel)
{ random_cells(false, true, 0); }
TEST(slivers_in_perspective)
{ random_cells(true, false, 0); }
TEST(slivers_in_parallel)
{ random_cells(true, true, 0); }
TEST(cells_ten_million_units_from_the_origin)
{ random_cells(false, false, 1e7); }

static const double CORNERS[12] = {0, 0, 0, 1, 0, 0, 0.2, 1.1, 0, 0.3, 0.3, 0.9};
static const double CENTRE[3] = {0.375, 0.35, 0.225};

/* A single tet of constant scalar, to the tighter limit: from outside, from inside, cut by the near plane. */
TEST(a_uniform_cell_matches_the_closed_form)
{
  static cellist_transfer_knot knot[] = {{0, 0.75, {0.2, 0.5, 0.9}}};
  const cellist_transfer transfer = {1, knot};
  const double values[4] = {0, 0, 0, 0};
  const double eyes[3][3] = {{3, -2, 1.5}, {0.4, 0.3, 0.2}, {1.5, -1, 0.8}};
  const double toward[3] = {0.9, 0.1, 0.1};
  stage made;
  stage_open(&made, 1, CORNERS, values, 64);
  for (int parallel = 0; parallel < 2; parallel++)
    for (int i = 0; i < 3; i++) {
      const cellist_frame frame =
          frame_of(made.context, eyes[i], i == 1 ? toward : CENTRE, parallel ? 1.5 : 0, i == 2 ? 1.9 : 0, 64);
      struct tally tally = {0};
      compare_cell(&made, 0, &frame, &transfer, &tally);
      assert_true(tally.covered > 50);
      if (!(tally.worst <= 1e-5)) fail_msg("eye %d: worst error %g", i, tally.worst);
      if (!(tally.worst_depth <= 1e-4)) fail_msg("eye %d: worst depth %g", i, tally.worst_depth);
    }
  stage_close(&made);
}

/* Depths from thin to opaque, extinction rising and falling. */
TEST(all_optical_depths_match_the_closed_form)
{
  const double values[4] = {0, 1, 0.3, 0.8};
  const double eyes[2][3] = {{3, -2, 1.5}, {-2, 3, 0.5}};
  stage made;
  stage_open(&made, 1, CORNERS, values, 48);
  for (int step = -6; step <= 6; step++) {
    const double strength = pow(4, step);
    cellist_transfer_knot knots[] = {{0, 0.01 * strength, {1, 0, 0.2}}, {1, strength, {0, 0.5, 1}}};
    const cellist_transfer transfer = {2, knots};
    for (int i = 0; i < 2; i++) {
      const cellist_frame frame = frame_of(made.context, eyes[i], CENTRE, 0, 0, 48);
      struct tally tally = {0};
      compare_cell(&made, 0, &frame, &transfer, &tally);
      assert_true(tally.covered > 30);
      if (!(tally.worst <= 3e-5)) fail_msg("extinction %g, eye %d: worst error %g", strength, i, tally.worst);
    }
  }
  stage_close(&made);
}
