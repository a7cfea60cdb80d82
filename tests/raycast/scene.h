/* SPDX-License-Identifier: BSD-3-Clause
 * A mesh with a scalar, a view and what the reference caster makes of them, for tests. */
#ifndef CELLIST_TESTS_RAYCAST_SCENE_H
#define CELLIST_TESTS_RAYCAST_SCENE_H

#include <cellist/raycast.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

typedef struct cast_scene {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_raycaster *caster;
} cast_scene;

/* values: one per point or per tet, in the order given. The caster keeps the scalar's address: a scene stays where it
 * was made. */
static inline void scene_create(cast_scene *scene, unsigned workers, size_t point_count, const double *positions,
                                size_t tet_count, const uint32_t *tets, cellist_association association,
                                const double *values) {
  *scene = (cast_scene){.context = harness_context(workers)};
  const cellist_field field = {"s", association, 1, values};
  const cellist_mesh_desc desc = {point_count, positions, tet_count, tets, NULL, 1, &field};
  assert_success(scene->context, cellist_mesh_create(scene->context, &desc, &scene->mesh));
  assert_success(scene->context, cellist_scalar_select(scene->context, scene->mesh, NULL, &scene->scalar));
  assert_success(scene->context,
                 cellist_raycaster_create(scene->context, scene->mesh, &scene->scalar, NULL, &scene->caster));
}

static inline void scene_destroy(cast_scene *scene) {
  cellist_raycaster_destroy(scene->caster);
  cellist_scalar_release(scene->context, &scene->scalar);
  cellist_mesh_destroy(scene->mesh);
  harness_context_destroy(scene->context);
}

typedef struct cast_picture {
  cellist_frame frame;
  double *rgba, *transmittance, *z, *z_back;
  uint32_t *cells, *segments;
  cellist_raycast_stats stats;
} cast_picture;

static inline cast_picture scene_draw_with(const cast_scene *scene, cellist_raycaster *caster,
                                           cellist_precision precision, const cellist_view *view, uint32_t width,
                                           uint32_t height, const cellist_transfer *transfer,
                                           const cellist_optics *optics) {
  cast_picture picture = {0};
  const size_t count = (size_t)width * height;
  assert_success(scene->context, cellist_frame_from_view(scene->context, view, width, height, &picture.frame));
  picture.rgba = malloc(4 * count * sizeof(double));
  picture.transmittance = malloc(count * sizeof(double));
  picture.z = malloc(count * sizeof(double));
  picture.z_back = malloc(count * sizeof(double));
  picture.cells = malloc(count * sizeof(uint32_t));
  picture.segments = malloc(count * sizeof(uint32_t));
  const cellist_raycast_output output = {picture.rgba,  picture.transmittance, picture.z, picture.z_back,
                                         picture.cells, picture.segments,      NULL};
  cellist_raycast_desc desc = {.precision = precision};
  if (optics != NULL) desc.optics = *optics;
  assert_success(scene->context,
                 cellist_raycaster_render(caster, &picture.frame, transfer, &desc, &output, &picture.stats));
  return picture;
}

static inline cast_picture scene_draw(const cast_scene *scene, const cellist_view *view, uint32_t width,
                                      uint32_t height, const cellist_transfer *transfer, const cellist_optics *optics) {
  return scene_draw_with(scene, scene->caster, CELLIST_PRECISION_REFERENCE, view, width, height, transfer, optics);
}

static inline void picture_release(cast_picture *picture) {
  free(picture->rgba);
  free(picture->transmittance);
  free(picture->z);
  free(picture->z_back);
  free(picture->cells);
  free(picture->segments);
}

/* Six tets to each of n^3 unit cubes (Kuhn); points and tets are the caller's to free. */
typedef struct kuhn_grid {
  size_t point_count, tet_count;
  double *points;
  uint32_t *tets;
} kuhn_grid;

static inline kuhn_grid kuhn_grid_create(uint32_t n) {
  static const uint8_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  kuhn_grid grid = {(size_t)(n + 1) * (n + 1) * (n + 1), (size_t)6 * n * n * n, NULL, NULL};
  grid.points = malloc(3 * grid.point_count * sizeof(double));
  grid.tets = malloc(4 * grid.tet_count * sizeof(uint32_t));
  const uint32_t step[3] = {1, n + 1, (n + 1) * (n + 1)};
  for (uint32_t i = 0; i < grid.point_count; i++)
    for (uint32_t k = 0; k < 3; k++) grid.points[3 * i + k] = i / step[k] % (n + 1);
  for (uint32_t t = 0; t < grid.tet_count; t++) {
    const uint32_t cube = t / 6;
    uint32_t at = cube % n * step[0] + cube / n % n * step[1] + cube / n / n * step[2];
    for (uint32_t c = 0; c < 4; c++) {
      grid.tets[4 * t + c] = at;
      if (c < 3) at += step[path[t % 6][c]];
    }
  }
  return grid;
}

static inline void kuhn_grid_release(kuhn_grid *grid) {
  free(grid->points);
  free(grid->tets);
}

static inline cellist_view random_view(random_state *random, const double centre[3], double distance) {
  cellist_view view = {.fovy_degrees = 30, .up = {0.1, 0.2, 1}};
  for (int k = 0; k < 3; k++) {
    view.target[k] = centre[k];
    view.eye[k] = centre[k] + distance * random_between(random, -1, 1);
  }
  if (random_below(random, 2)) view.parallel_height = 0.6 * distance;
  return view;
}

#endif
