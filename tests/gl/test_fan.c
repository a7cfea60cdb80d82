/* SPDX-License-Identifier: BSD-3-Clause
 * Fans: pictures of single cells against the closed form, and of a mesh against the reference. OpenGL moves corners, so
 * a pixel whose centre lies within 1/128 pixel of an edge is excused, and counted. */
#include <cellist/generate.h>
#include <cellist/raycast.h>
#include <cellist/sort.h>
#include <stdio.h>

#include "random_cells.h"

static cellist_transfer_knot KNOTS[] = {{-0.4, 0.0, {0, 0, 1}},
                                        {0.1, 0.9, {0, 1, 1}},
                                        {0.3, 0.2, {1, 0.5, 0}},
                                        {0.7, 2.5, {1, 1, 0}},
                                        {1.2, 0.4, {1, 0, 0}}};
static const cellist_transfer TRANSFER = {5, KNOTS};
static const double EXCUSED = 1.0 / 128;

/* A corner in pixels; false if it has no place in the picture. */
static bool project(const cellist_frame *frame, const long double corner[3], double at[2]) {
  double v[3] = {0, 0, 0};
  for (int k = 0; k < 3; k++) {
    const double d = (double)(corner[k] - (long double)frame->eye[k]);
    v[0] += d * frame->right[k];
    v[1] += d * frame->up[k];
    v[2] += d * frame->forward[k];
  }
  const double w = frame->parallel ? 1 : v[2];
  if (!(w > 0)) return false;
  at[0] = 0.5 * frame->width * (1 + v[0] / w / frame->half_width);
  at[1] = 0.5 * frame->height * (1 - v[1] / w / frame->half_height);
  return true;
}

static double distance_to(const double a[2], const double b[2], double x, double y) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], length = dx * dx + dy * dy;
  const double t = length > 0 ? fmax(0, fmin(1, ((x - a[0]) * dx + (y - a[1]) * dy) / length)) : 0;
  return hypot(a[0] + t * dx - x, a[1] + t * dy - y);
}

struct tally {
  size_t compared, covered, silhouette, inner, inner_wrong, fans;
  double worst, inner_worst, worst_outside;
};

/* Whether the pixel lies near an edge of the silhouette (between a front face and another one), or near any edge. */
static void near_edges(const oracle_cell *cell, const cellist_frame *frame, double x, double y, bool near[2]) {
  double at[4][2];
  bool is_front[4];
  near[0] = near[1] = false;
  for (int k = 0; k < 4; k++) {
    long double normal[3], offset, eye[3];
    if (!project(frame, cell->corner[k], at[k])) return;
    oracle_plane(cell, k, normal, &offset);
    for (int i = 0; i < 3; i++) eye[i] = frame->parallel ? -frame->forward[i] : frame->eye[i];
    is_front[k] = oracle_dot(normal, eye) > (frame->parallel ? 0 : offset);
  }
  for (int a = 0; a < 4; a++)
    for (int b = a + 1; b < 4; b++) {
      if (distance_to(at[a], at[b], x, y) > EXCUSED) continue;
      int faces[2], count = 0; /* the two that hold the edge */
      for (int k = 0; k < 4; k++)
        if (k != a && k != b) faces[count++] = k;
      near[1] = true;
      if (is_front[faces[0]] != is_front[faces[1]]) near[0] = true;
    }
}

static void compare_cell(stage *made, uint32_t tet, const cellist_frame *frame, struct tally *tally) {
  const cellist_gl_settings settings = {.method = CELLIST_GL_FAN};
  cellist_gl_stats stats;
  assert_success(made->context, cellist_gl_render(made->gl, frame, &TRANSFER, &tet, 1, &settings, made->image, &stats));
  tally->fans += stats.cell_count - stats.left_count;
  const oracle_cell cell = stage_cell(made, tet);
  for (uint32_t y = 0; y < frame->height; y++)
    for (uint32_t x = 0; x < frame->width; x++) {
      const oracle_pixel truth = oracle_trace(&cell, frame, &TRANSFER, x + 0.5, y + 0.5);
      double error = 0;
      for (int c = 0; c < 4; c++) {
        const double got = cellist_image_channel(made->image, STAGE_CHANNELS[c])[(size_t)y * frame->width + x];
        assert_true(isfinite(got));
        error = fmax(error, fabs(got - (double)truth.rgba[c]));
      }
      tally->compared++;
      tally->covered += truth.front < truth.back;
      bool near[2];
      near_edges(&cell, frame, x + 0.5, y + 0.5, near);
      tally->silhouette += near[0];
      if (near[0]) continue;
      if (!(truth.front < truth.back)) tally->worst_outside = fmax(tally->worst_outside, error);
      tally->inner += near[1];
      tally->inner_wrong += near[1] && error > 1e-4;
      double *worst = near[1] ? &tally->inner_worst : &tally->worst;
      *worst = fmax(*worst, error);
    }
}

static void random_cells(bool sliver, bool parallel) {
  random_state random = {sliver ? 73 : 72};
  double *points = malloc(CELLS * 12 * sizeof *points), *values = malloc(CELLS * 4 * sizeof *values);
  make_cells(&random, sliver, 0, points, values);
  cellist_context *context = harness_context(1);
  stage made;
  assert_success(context, stage_open(context, CELLIST_GL_OSMESA, CELLS, points, values, SIZE, &made));
  struct tally tally = {0};
  for (uint32_t tet = 0; tet < CELLS; tet++) {
    const cellist_frame frame = random_frame(&random, context, cellist_mesh_get_arrays(made.mesh), tet, parallel);
    compare_cell(&made, tet, &frame, &tally);
  }
  printf("%zu pixels, %zu covered, %zu fans; %zu near a silhouette; %zu near an inner edge, %zu of these wrong, %.2g\n",
         tally.compared, tally.covered, tally.fans, tally.silhouette, tally.inner, tally.inner_wrong,
         tally.inner_worst);
  printf("elsewhere %.2g\n", tally.worst);
  stage_close(&made);
  harness_context_destroy(context);
  free(points);
  free(values);
  assert_true(tally.covered > tally.compared / 100 && tally.fans > CELLS / 4);
  assert_true(tally.silhouette + tally.inner < tally.compared / 50);
  if (!(tally.worst <= 1e-4)) fail_msg("worst error %g", tally.worst);
  /* rounding at the near plane */
  if (!(tally.worst_outside <= 1e-6)) fail_msg("error %g outside the footprint", tally.worst_outside);
}

TEST(random_cells_in_perspective)
{ random_cells(false, false); }
TEST(random_cells_in_parallel)
{ random_cells(false, true); }
TEST(slivers_in_perspective)
{ random_cells(true, false); }
TEST(slivers_in_parallel)
{ random_cells(true, true); }

/* A mesh of many cells, from outside, with the near plane through it, from inside and in parallel; beside faces. */
TEST(meshes_come_close_to_the_reference)
{
  enum { PIXELS = 64 };
  cellist_context *context = harness_context(2);
  const cellist_generate_desc generate = {.size = 3000, .perturb = 0.3};
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar;
  cellist_gl *gl = NULL;
  cellist_image *image = NULL;
  cellist_raycaster *caster = NULL;
  assert_success(context, cellist_generate(context, "grid", &generate, &mesh));
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scalar));
  assert_success(context, cellist_image_create(context, PIXELS, PIXELS, STAGE_CHANNELS, 6, &image));
  assert_success(context, cellist_gl_create(context, NULL, &gl));
  assert_success(context, cellist_gl_upload(gl, mesh, &scalar));
  assert_success(context, cellist_raycaster_create(context, mesh, &scalar, NULL, &caster));
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  uint32_t *order = malloc(arrays->tet_count * sizeof *order);
  double *truth = malloc(4 * PIXELS * PIXELS * sizeof *truth);
  const double size = arrays->bounds[3] - arrays->bounds[0];
  for (int view = 0; view < 4; view++) {
    double eye[3], target[3];
    for (int k = 0; k < 3; k++) {
      const double side = arrays->bounds[3 + k] - arrays->bounds[k];
      target[k] = arrays->bounds[k] + (view == 2 ? 0.9 : 0.5) * side;
      eye[k] = view == 2 ? arrays->bounds[k] + (0.31 + 0.03 * k) * side
                         : arrays->bounds[k] + (double[3]){1.9, -0.7, 1.3}[k] * size;
    }
    const cellist_frame frame =
        stage_frame(context, eye, target, view == 3 ? 1.4 * size : 0, view == 1 ? 1.9 * size : 0, PIXELS);
    cellist_viewpoint viewpoint = {.parallel = frame.parallel};
    memcpy(viewpoint.position, frame.parallel ? frame.forward : frame.eye, sizeof viewpoint.position);
    assert_success(context, cellist_sorter_sort(sorter, &viewpoint, order, NULL));
    const cellist_raycast_desc cast = {.precision = CELLIST_PRECISION_REFERENCE};
    const cellist_raycast_output output = {.rgba = truth};
    assert_success(context, cellist_raycaster_render(caster, &frame, &TRANSFER, &cast, &output, NULL));
    double rmse[2] = {0, 0}, most[2] = {0, 0};
    for (int method = 0; method < 2; method++) {
      const cellist_gl_settings settings = {.method = (cellist_gl_method)method};
      cellist_gl_stats stats;
      assert_success(context,
                     cellist_gl_render(gl, &frame, &TRANSFER, order, arrays->tet_count, &settings, image, &stats));
      if (!(method == 0 ? stats.left_count == 0 : stats.left_count < stats.cell_count))
        fail_msg("view %d, method %d: %zu of %zu cells were no fans", view, method, (size_t)stats.left_count,
                 (size_t)stats.cell_count);
      for (size_t i = 0; i < PIXELS * PIXELS; i++)
        for (size_t c = 0; c < 4; c++) {
          const double error = fabs(cellist_image_channel(image, STAGE_CHANNELS[c])[i] - truth[4 * i + c]);
          rmse[method] += error * error / (4.0 * PIXELS * PIXELS);
          most[method] = fmax(most[method], error);
        }
    }
    printf("view %d: faces rmse %.2g, max %.2g; fan rmse %.2g, max %.2g\n", view, sqrt(rmse[0]), most[0], sqrt(rmse[1]),
           most[1]);
    if (!(most[0] <= 2e-5)) fail_msg("faces: view %d, %g", view, most[0]);
    if (!(sqrt(rmse[1]) <= 2e-4)) fail_msg("fan: view %d, rmse %g", view, sqrt(rmse[1]));
  }
  free(truth);
  free(order);
  cellist_sorter_destroy(sorter);
  cellist_raycaster_destroy(caster);
  cellist_gl_destroy(gl);
  cellist_image_destroy(image);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
