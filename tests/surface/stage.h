/* SPDX-License-Identifier: BSD-3-Clause
 * One mesh, drawn by every renderer, for tests of what limits rays: clip planes and surfaces. */
#ifndef CELLIST_TESTS_SURFACE_STAGE_H
#define CELLIST_TESTS_SURFACE_STAGE_H

#include <cellist/generate.h>
#include <cellist/gl.h>
#include <cellist/raycast.h>
#include <cellist/soft.h>
#include <cellist/sort.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

/* BY_FAN is beyond the exact ones, which RENDERER_COUNT counts. */
enum { BY_REFERENCE, BY_FAST, BY_SOFT, BY_SOFT_PORTABLE, BY_FACES, RENDERER_COUNT, BY_FAN = RENDERER_COUNT };
static const char *const RENDERER_NAMES[] = {"reference", "fast", "soft", "soft portable", "faces", "fan"};
static const char *const CHANNELS[] = {"R", "G", "B", "A", "Z", "ZBack"};
enum { CHANNEL_COUNT = 6 };

typedef struct stage {
  cellist_context *context;
  cellist_mesh *mesh;
  const cellist_mesh_arrays *arrays;
  cellist_scalar scalar;
  cellist_transfer transfer;
  cellist_raycaster *caster;
  cellist_soft *soft[2]; /* vectorised, portable */
  cellist_gl *gl;
  cellist_sorter *sorter;
  uint32_t *order;
} stage;

/* Takes the mesh. transfer: the caller's knots, or NULL for ramp over the scalar's range with this unit distance. */
static inline void stage_open(stage *made, cellist_context *context, cellist_mesh *mesh,
                              const cellist_transfer *transfer, double unit_distance) {
  *made = (stage){.context = context, .mesh = mesh, .arrays = cellist_mesh_get_arrays(mesh)};
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &made->scalar));
  if (transfer != NULL) {
    made->transfer.knot_count = transfer->knot_count;
    made->transfer.knots = cellist_allocate(context, transfer->knot_count, sizeof *transfer->knots);
    memcpy(made->transfer.knots, transfer->knots, transfer->knot_count * sizeof *transfer->knots);
  } else {
    const cellist_transfer_desc desc = {.range = {made->scalar.minimum, made->scalar.maximum},
                                        .unit_distance = unit_distance};
    assert_success(context, cellist_transfer_load(context, &desc, &made->transfer));
  }
  assert_success(context, cellist_raycaster_create(context, mesh, &made->scalar, NULL, &made->caster));
  for (int i = 0; i < 2; i++) {
    const cellist_soft_desc desc = {.portable = i == 1};
    assert_success(context, cellist_soft_create(context, mesh, &made->scalar, &desc, &made->soft[i]));
  }
  assert_success(context, cellist_gl_create(context, NULL, &made->gl));
  assert_success(context, cellist_gl_upload(made->gl, mesh, &made->scalar));
  const cellist_sorter_desc desc = {.point_count = made->arrays->point_count,
                                    .points = made->arrays->positions,
                                    .tet_count = made->arrays->tet_count,
                                    .tets = made->arrays->tets,
                                    .neighbours = made->arrays->neighbours};
  assert_success(context, cellist_sorter_create(context, &desc, &made->sorter));
  made->order = malloc(made->arrays->tet_count * sizeof *made->order + 1);
}

static inline void stage_close(stage *made) {
  free(made->order);
  cellist_sorter_destroy(made->sorter);
  cellist_gl_destroy(made->gl);
  for (int i = 0; i < 2; i++) cellist_soft_destroy(made->soft[i]);
  cellist_raycaster_destroy(made->caster);
  cellist_transfer_release(made->context, &made->transfer);
  cellist_scalar_release(made->context, &made->scalar);
  cellist_mesh_destroy(made->mesh);
}

/* Draws the frame with one renderer; NULL if it does not draw this. The image is the caller's. surface may be NULL. */
static inline cellist_image *stage_draw_with(stage *made, int renderer, const cellist_frame *frame,
                                             const cellist_optics *optics, const cellist_surface *surface) {
  cellist_context *context = made->context;
  static const cellist_optics plain = {0};
  if (optics == NULL) optics = &plain;
  cellist_image *image = NULL;
  assert_success(context, cellist_image_create(context, frame->width, frame->height, CHANNELS, CHANNEL_COUNT, &image));
  cellist_result result = CELLIST_SUCCESS;
  if (renderer == BY_REFERENCE || renderer == BY_FAST) {
    const cellist_raycast_desc desc = {
        .precision = renderer == BY_FAST ? CELLIST_PRECISION_FAST : CELLIST_PRECISION_REFERENCE,
        .optics = *optics,
        .surface = surface};
    const cellist_raycast_output output = {.image = image};
    result = cellist_raycaster_render(made->caster, frame, &made->transfer, &desc, &output, NULL);
  } else {
    const size_t count = made->arrays->tet_count;
    cellist_viewpoint viewpoint = {.parallel = frame->parallel};
    memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
    assert_success(context, cellist_sorter_sort(made->sorter, &viewpoint, made->order, NULL));
    const cellist_group *sorted = NULL;
    size_t group_count = 0;
    cellist_sorter_groups(made->sorter, &sorted, &group_count);
    cellist_soft_group *groups = malloc((group_count + 1) * sizeof *groups);
    cellist_gl_group *gl_groups = malloc((group_count + 1) * sizeof *gl_groups);
    for (size_t i = 0; i < group_count; i++) {
      groups[i] = (cellist_soft_group){sorted[i].begin, sorted[i].count};
      gl_groups[i] = (cellist_gl_group){sorted[i].begin, sorted[i].count};
    }
    const cellist_gl_settings gl_settings = {.optics = *optics,
                                             .groups = gl_groups,
                                             .group_count = group_count,
                                             .surface = surface,
                                             .method = renderer == BY_FAN ? CELLIST_GL_FAN : CELLIST_GL_FACES};
    const cellist_soft_settings settings = {.optics = *optics,
                                            .order = made->order,
                                            .order_count = count,
                                            .groups = groups,
                                            .group_count = group_count,
                                            .surface = surface};
    if (renderer == BY_FACES || renderer == BY_FAN)
      result = cellist_gl_render(made->gl, frame, &made->transfer, made->order, count, &gl_settings, image, NULL);
    else
      result = cellist_soft_render(made->soft[renderer - BY_SOFT], frame, &made->transfer, &settings, image, NULL);
    free(groups);
    free(gl_groups);
  }
  if (result == CELLIST_ERROR_UNSUPPORTED) {
    cellist_context_take_error(context);
    cellist_image_destroy(image);
    return NULL;
  }
  assert_success(context, result);
  return image;
}

static inline cellist_image *stage_draw(stage *made, int renderer, const cellist_frame *frame,
                                        const cellist_optics *optics) {
  return stage_draw_with(made, renderer, frame, optics, NULL);
}

/* A mesh of n^3 cubes, six tets each, over low..high; scalar base + slope . p. */
static inline cellist_mesh *stage_box(cellist_context *context, uint32_t n, const double low[3], const double high[3],
                                      double base, const double slope[3]) {
  static const uint8_t corner_of[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                          {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  const size_t side = n + 1, point_count = side * side * side;
  double *points = malloc(3 * point_count * sizeof *points), *values = malloc(point_count * sizeof *values);
  uint32_t *tets = malloc(24 * (size_t)n * n * n * sizeof *tets), *tet = tets;
  for (size_t i = 0; i < point_count; i++) {
    const size_t at[3] = {i % side, i / side % side, i / side / side};
    values[i] = base;
    for (int k = 0; k < 3; k++) {
      points[3 * i + (size_t)k] = low[k] + (high[k] - low[k]) * (double)at[k] / n;
      values[i] += slope[k] * points[3 * i + (size_t)k];
    }
  }
  for (size_t cube = 0; cube < (size_t)n * n * n; cube++) {
    const size_t x = cube % n, y = cube / n % n, z = cube / n / n;
    for (int t = 0; t < 6; t++)
      for (int c = 0; c < 4; c++) {
        const unsigned bits = corner_of[t][c];
        *tet++ = (uint32_t)(x + (bits & 1) + side * (y + (bits >> 1 & 1) + side * (z + (bits >> 2))));
      }
  }
  const cellist_field field = {"linear", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {point_count, points, 6 * (size_t)n * n * n, tets, NULL, 1, &field};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  free(points);
  free(values);
  free(tets);
  return mesh;
}

/* A camera that sees most of a mesh of this centre and half diagonal: from outside, every fourth from inside, every
 * other in parallel. */
static inline cellist_view stage_random_view(random_state *random, const double centre[3], double radius, int round) {
  cellist_view view = {.fovy_degrees = 40, .up = {0.1, 0.2, 1}};
  double way[3], length = 0;
  do {
    for (int k = 0; k < 3; k++) way[k] = random_between(random, -1, 1);
    length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
  } while (!(length > 0.1 && length < 1));
  const double distance = (round % 4 == 3 ? 0.2 : 2.6) * radius;
  for (int k = 0; k < 3; k++) {
    view.target[k] = centre[k] + random_between(random, -0.1, 0.1) * radius;
    view.eye[k] = centre[k] + distance * way[k] / length;
  }
  if (round % 2 == 1) view.parallel_height = 1.7 * radius;
  return view;
}

static inline float stage_value(const cellist_image *image, size_t channel, size_t pixel) {
  return cellist_image_channel(image, CHANNELS[channel])[pixel];
}

#endif
