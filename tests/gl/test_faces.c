/* SPDX-License-Identifier: BSD-3-Clause
 * Renderer `faces`: pictures of single cells against the closed form, from everywhere; no pixel
 * is excused at a silhouette. */
#include <stdio.h>

#include "random_cells.h"

static cellist_transfer_knot KNOTS[] = {{-0.4, 0.0, {0, 0, 1}},
                                        {0.1, 0.9, {0, 1, 1}},
                                        {0.3, 0.2, {1, 0.5, 0}},
                                        {0.7, 2.5, {1, 1, 0}},
                                        {1.2, 0.4, {1, 0, 0}}};
static const cellist_transfer TRANSFER = {5, KNOTS};

static const double CORNERS[12] = {0, 0, 0, 1, 0, 0, 0.2, 1.1, 0, 0.3, 0.3, 0.9};
static const double CENTRE[3] = {0.375, 0.35, 0.225};

struct tally {
  size_t compared, covered;
  double worst, worst_depth;
};

/* Draws one cell and compares every pixel. */
static void compare_cell(stage *made, uint32_t tet, const cellist_frame *frame, const cellist_transfer *transfer,
                         struct tally *tally) {
  assert_success(made->context, cellist_gl_render(made->gl, frame, transfer, &tet, 1, NULL, made->image, NULL));
  const oracle_cell cell = stage_cell(made, tet);
  const float *planes[6];
  for (int c = 0; c < 6; c++) planes[c] = cellist_image_channel(made->image, STAGE_CHANNELS[c]);
  for (uint32_t y = 0; y < frame->height; y++)
    for (uint32_t x = 0; x < frame->width; x++) {
      const size_t at = (size_t)y * frame->width + x;
      const oracle_pixel truth = oracle_trace(&cell, frame, transfer, x + 0.5, y + 0.5);
      double error = 0;
      for (int c = 0; c < 4; c++) {
        assert_true(isfinite(planes[c][at]));
        error = fmax(error, fabs(planes[c][at] - (double)truth.rgba[c]));
      }
      tally->compared++;
      tally->covered += truth.front < truth.back;
      tally->worst = fmax(tally->worst, error);
      if (truth.rgba[3] > 1e-3L)
        tally->worst_depth = fmax(tally->worst_depth, fabs(planes[5][at] - (double)truth.back) / (double)truth.back);
    }
}

static void random_cells(bool sliver, bool parallel, double offset, double limit) {
  random_state random = {sliver ? 71 : 70};
  double *points = malloc(CELLS * 12 * sizeof *points), *values = malloc(CELLS * 4 * sizeof *values);
  make_cells(&random, sliver, offset, points, values);
  cellist_context *context = harness_context(1);
  stage made;
  assert_success(context, stage_open(context, CELLIST_GL_OSMESA, CELLS, points, values, SIZE, &made));
  struct tally tally = {0};
  for (uint32_t tet = 0; tet < CELLS; tet++) {
    const cellist_frame frame = random_frame(&random, context, cellist_mesh_get_arrays(made.mesh), tet, parallel);
    compare_cell(&made, tet, &frame, &TRANSFER, &tally);
  }
  printf("%zu pixels, %zu covered, worst error %.2g\n", tally.compared, tally.covered, tally.worst);
  stage_close(&made);
  harness_context_destroy(context);
  free(points);
  free(values);
  assert_true(tally.covered > tally.compared / 100);
  if (!(tally.worst <= limit)) fail_msg("worst error %g", tally.worst);
}

TEST(random_cells_in_perspective)
{ random_cells(false, false, 0, 1e-4); }
TEST(random_cells_in_parallel)
{ random_cells(false, true, 0, 1e-4); }
TEST(slivers_in_perspective)
{ random_cells(true, false, 0, 1e-4); }
TEST(slivers_in_parallel)
{ random_cells(true, true, 0, 1e-4); }
TEST(cells_ten_million_units_from_the_origin)
{ random_cells(false, false, 1e7, 1e-4); }

/* A single tet of constant scalar, to the tighter limit: from outside, from inside, cut by the near plane. */
TEST(a_uniform_cell_matches_the_closed_form)
{
  static cellist_transfer_knot knot[] = {{0, 0.75, {0.2, 0.5, 0.9}}};
  const cellist_transfer transfer = {1, knot};
  const double values[4] = {0, 0, 0, 0};
  const double eyes[3][3] = {{3, -2, 1.5}, {0.4, 0.3, 0.2}, {1.5, -1, 0.8}};
  const double toward[3] = {0.9, 0.1, 0.1};
  cellist_context *context = harness_context(1);
  stage made;
  assert_success(context, stage_open(context, CELLIST_GL_OSMESA, 1, CORNERS, values, 64, &made));
  for (int parallel = 0; parallel < 2; parallel++)
    for (int i = 0; i < 3; i++) {
      const cellist_frame frame =
          stage_frame(context, eyes[i], i == 1 ? toward : CENTRE, parallel ? 1.5 : 0, i == 2 ? 1.9 : 0, 64);
      struct tally tally = {0};
      compare_cell(&made, 0, &frame, &transfer, &tally);
      assert_true(tally.covered > 50);
      if (!(tally.worst <= 1e-5)) fail_msg("eye %d: worst error %g", i, tally.worst);
      if (!(tally.worst_depth <= 1e-4)) fail_msg("eye %d: worst depth %g", i, tally.worst_depth);
    }
  stage_close(&made);
  harness_context_destroy(context);
}

/* Depths from thin to opaque, extinction rising and falling, in one interval of the transfer function, in two and
 * in four. */
TEST(all_optical_depths_match_the_closed_form)
{
  const double values[4] = {0, 1, 0.3, 0.8};
  const double eyes[2][3] = {{3, -2, 1.5}, {-2, 3, 0.5}};
  cellist_context *context = harness_context(1);
  stage made;
  assert_success(context, stage_open(context, CELLIST_GL_OSMESA, 1, CORNERS, values, 48, &made));
  for (int step = -6; step <= 6; step++) {
    const double strength = pow(4, step);
    cellist_transfer_knot knots[] = {{0, 0.01 * strength, {1, 0, 0.2}}, {1, strength, {0, 0.5, 1}}};
    cellist_transfer_knot bent[] = {{0, 0.6 * strength, {1, 0, 0.2}}, {0.5, 0, {0, 1, 0}}, {1, strength, {0, 0.5, 1}}};
    cellist_transfer_knot zigzag[] = {{0, 0, {1, 0, 0.2}},
                                      {0.25, strength, {0, 0, 1}},
                                      {0.5, 0.1 * strength, {1, 1, 0}},
                                      {0.75, 0.9 * strength, {0, 1, 0}},
                                      {1, 0.3 * strength, {0, 0.5, 1}}};
    const cellist_transfer transfers[] = {{2, knots}, {3, bent}, {5, zigzag}};
    for (int i = 0; i < 6; i++) {
      const cellist_transfer transfer = transfers[i / 2];
      const cellist_frame frame = stage_frame(context, eyes[i % 2], CENTRE, 0, 0, 48);
      struct tally tally = {0};
      compare_cell(&made, 0, &frame, &transfer, &tally);
      assert_true(tally.covered > 30);
      if (!(tally.worst <= 1e-5)) fail_msg("extinction %g, picture %d: worst error %g", strength, i, tally.worst);
    }
  }
  cellist_transfer_knot knots[] = {{0, 1e12, {1, 0, 0.2}}, {1, 1e12, {1, 0, 0.2}}}; /* a wall: its front is all */
  const cellist_transfer wall = {2, knots};
  const cellist_frame frame = stage_frame(context, eyes[0], CENTRE, 0, 0, 48);
  const uint32_t order = 0;
  assert_success(context, cellist_gl_render(made.gl, &frame, &wall, &order, 1, NULL, made.image, NULL));
  assert_true(fabs(cellist_image_channel(made.image, "R")[24 * 48 + 24] - 1) < 1e-6);
  assert_true(fabs(cellist_image_channel(made.image, "A")[24 * 48 + 24] - 1) < 1e-6);
  stage_close(&made);
  harness_context_destroy(context);
}
