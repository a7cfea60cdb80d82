/* SPDX-License-Identifier: BSD-3-Clause
 * A mesh of many cells with a bent scalar, and pictures of it through OpenGL beside the reference caster's. */
#ifndef CELLIST_TESTS_GL_SCENE_H
#define CELLIST_TESTS_GL_SCENE_H

#include <cellist/raycast.h>
#include <cellist/sort.h>

#include "stage.h"

enum { PIXELS = 64, CELLS_A_SIDE = 5 };

static cellist_transfer_knot KNOTS[] = {
    {0.05, 0, {0, 0, 1}}, {0.3, 1.5, {0, 1, 1}}, {0.45, 0.2, {1, 0.2, 0}}, {0.8, 6, {1, 1, 0}}};
static const cellist_transfer TRANSFER = {4, KNOTS};

struct scene {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_gl *gl;
  cellist_raycaster *caster;
  cellist_image *image;
  double *truth;
};

/* A cube of cubes of six tets with moved inner points, and a scalar that bends through it. */
static inline void open_scene(struct scene *scene) {
  static const uint32_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  enum { N = CELLS_A_SIDE, SIDE = N + 1, POINTS = SIDE * SIDE * SIDE, TETS = 6 * N * N * N };
  static double points[3 * POINTS], values[POINTS];
  static uint32_t tets[4 * TETS];
  const uint32_t step[3] = {1, SIDE, SIDE * SIDE};
  random_state random = {5};
  for (uint32_t i = 0; i < POINTS; i++) {
    double *p = &points[3 * i];
    for (int k = 0; k < 3; k++) {
      const uint32_t at = i / step[k] % SIDE;
      p[k] = (at + (at > 0 && at < N ? random_between(&random, -0.1, 0.1) : 0)) / N;
    }
    values[i] = 0.5 + 0.4 * sin(5 * p[0] + 2 * p[1]) * cos(4 * p[2] + p[1]);
  }
  for (uint32_t t = 0; t < TETS; t++) {
    const uint32_t cube = t / 6;
    uint32_t at = cube % N * step[0] + cube / N % N * step[1] + cube / N / N * step[2];
    for (uint32_t c = 0; c < 4; c++) {
      tets[4 * t + c] = at;
      if (c < 3) at += step[path[t % 6][c]];
    }
  }
  *scene = (struct scene){.context = harness_context(2)};
  const cellist_field field = {"bend", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {POINTS, points, TETS, tets, NULL, 1, &field};
  assert_success(scene->context, cellist_mesh_create(scene->context, &desc, &scene->mesh));
  assert_success(scene->context, cellist_scalar_select(scene->context, scene->mesh, NULL, &scene->scalar));
  assert_success(scene->context, cellist_gl_create(scene->context, NULL, &scene->gl));
  assert_success(scene->context, cellist_gl_upload(scene->gl, scene->mesh, &scene->scalar));
  assert_success(scene->context,
                 cellist_raycaster_create(scene->context, scene->mesh, &scene->scalar, NULL, &scene->caster));
  assert_success(scene->context,
                 cellist_image_create(scene->context, PIXELS, PIXELS, STAGE_CHANNELS, 6, &scene->image));
  scene->truth = malloc(4 * PIXELS * PIXELS * sizeof(double));
}

static inline void close_scene(struct scene *scene) {
  free(scene->truth);
  cellist_image_destroy(scene->image);
  cellist_raycaster_destroy(scene->caster);
  cellist_gl_destroy(scene->gl);
  cellist_scalar_release(scene->context, &scene->scalar);
  cellist_mesh_destroy(scene->mesh);
  harness_context_destroy(scene->context);
}

/* The root of the mean square and the greatest difference from the reference; whether anything was seen. */
static inline void compare_with(struct scene *scene, const cellist_frame *frame, const cellist_transfer *transfer,
                                const cellist_gl_settings *settings, double *rmse, double *most) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(scene->mesh);
  const cellist_sorter_desc desc = {arrays->point_count, arrays->positions,  arrays->tet_count,
                                    arrays->tets,        arrays->neighbours, NULL};
  cellist_viewpoint viewpoint = {.parallel = frame->parallel};
  memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
  cellist_sorter *sorter = NULL;
  uint32_t *order = malloc(arrays->tet_count * sizeof *order);
  assert_success(scene->context, cellist_sorter_create(scene->context, &desc, &sorter));
  assert_success(scene->context, cellist_sorter_sort(sorter, &viewpoint, order, NULL));
  assert_success(scene->context,
                 cellist_gl_render(scene->gl, frame, transfer, order, arrays->tet_count, settings, scene->image, NULL));
  const cellist_raycast_desc cast = {.precision = CELLIST_PRECISION_REFERENCE, .optics = settings->optics};
  const cellist_raycast_output output = {.rgba = scene->truth};
  assert_success(scene->context, cellist_raycaster_render(scene->caster, frame, transfer, &cast, &output, NULL));
  double sum = 0, seen = 0;
  *most = 0;
  for (size_t i = 0; i < PIXELS * PIXELS; i++)
    for (size_t c = 0; c < 4; c++) {
      const double difference =
          fabs(cellist_image_channel(scene->image, STAGE_CHANNELS[c])[i] - scene->truth[4 * i + c]);
      assert_true(isfinite(difference));
      sum += difference * difference;
      *most = fmax(*most, difference);
      seen = fmax(seen, scene->truth[4 * i + c]);
    }
  *rmse = sqrt(sum / (4.0 * PIXELS * PIXELS));
  assert_true(seen > 0.1);
  cellist_sorter_destroy(sorter);
  free(order);
}

static inline void compare(struct scene *scene, const cellist_frame *frame, const cellist_gl_settings *settings,
                           double *rmse, double *most) {
  compare_with(scene, frame, &TRANSFER, settings, rmse, most);
}

/* From outside, from inside and in parallel. */
static inline cellist_frame frame_of(struct scene *scene, int which) {
  const double eyes[3][3] = {{2.6, -1.3, 1.9}, {0.47, 0.41, 0.53}, {2, 2.5, 1.4}};
  const double outside[3] = {0.5, 0.5, 0.5}, inside[3] = {1, 0.7, 0.2};
  return stage_frame(scene->context, eyes[which], which == 1 ? inside : outside, which == 2 ? 1.9 : 0, 0, PIXELS);
}

static inline void check_model(const cellist_gl_settings *settings, double limit) {
  struct scene scene;
  open_scene(&scene);
  for (int which = 0; which < 3; which++) {
    const cellist_frame frame = frame_of(&scene, which);
    double rmse, most;
    compare(&scene, &frame, settings, &rmse, &most);
    if (!(most <= limit)) fail_msg("view %d: rmse %g, most %g", which, rmse, most);
  }
  close_scene(&scene);
}

#endif
