/* SPDX-License-Identifier: BSD-3-Clause
 * Scene: growing arrays of points and tets, grids, knots and views for the cases. */
#include "scene.h"

#include <base/random.h>
#include <math.h>
#include <string.h>

static void *reserve(stability_scene *scene, void *block, size_t count, size_t *capacity, size_t size) {
  if (scene->result != CELLIST_SUCCESS) return NULL;
  if (count < *capacity) return block;
  const size_t wanted = *capacity < 64 ? 64 : 2 * *capacity;
  void *grown = cellist_reallocate(scene->context, block, count, wanted, size);
  if (grown == NULL)
    scene->result = CELLIST_ERROR_OUT_OF_MEMORY;
  else
    *capacity = wanted;
  return grown;
}

uint32_t scene_point(stability_scene *scene, double x, double y, double z, double value) {
  double *points = reserve(scene, scene->points, scene->point_count, &scene->point_capacity, 4 * sizeof *points);
  if (points == NULL) return 0;
  scene->points = points;
  const double point[4] = {x, y, z, value};
  memcpy(&points[4 * scene->point_count], point, sizeof point);
  return (uint32_t)scene->point_count++;
}

void scene_tet(stability_scene *scene, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  uint32_t *tets = reserve(scene, scene->tets, scene->tet_count, &scene->tet_capacity, 4 * sizeof *tets);
  if (tets == NULL) return;
  scene->tets = tets;
  const uint32_t tet[4] = {a, b, c, d};
  memcpy(&tets[4 * scene->tet_count++], tet, sizeof tet);
}

void scene_grid(stability_scene *scene, const uint32_t n[3], double jitter, uint32_t without) {
  static const uint8_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const uint32_t first = (uint32_t)scene->point_count, step[3] = {1, n[0] + 1, (n[0] + 1) * (n[1] + 1)};
  random_state random = {11};
  for (uint32_t k = 0; k <= n[2]; k++)
    for (uint32_t j = 0; j <= n[1]; j++)
      for (uint32_t i = 0; i <= n[0]; i++) {
        const double wave = 0.5 + 0.5 * sin(1.3 * i + 0.7) * cos(1.1 * j - 0.6 * k);
        double p[3] = {i, j, k};
        for (int axis = 0; axis < 3; axis++) p[axis] += random_between(&random, -jitter, jitter);
        scene_point(scene, p[0], p[1], p[2], 0.5 * wave + 0.5 * random_unit(&random));
      }
  for (uint32_t cube = 0; cube < n[0] * n[1] * n[2]; cube++) {
    if (cube == without) continue;
    for (int t = 0; t < 6; t++) {
      uint32_t v[4];
      v[0] = first + cube % n[0] + cube / n[0] % n[1] * step[1] + cube / n[0] / n[1] * step[2];
      for (int c = 0; c < 3; c++) v[c + 1] = v[c] + step[path[t][c]];
      scene_tet(scene, v[0], v[1], v[2], v[3]);
    }
  }
}

void scene_place(stability_scene *scene, const double scale[3], const double offset[3]) {
  for (size_t i = 0; i < scene->point_count; i++)
    for (size_t k = 0; k < 3; k++) scene->points[4 * i + k] = offset[k] + scale[k] * scene->points[4 * i + k];
}

void scene_generate(stability_scene *scene, const char *name, const cellist_generate_desc *desc) {
  if (scene->result == CELLIST_SUCCESS) scene->result = cellist_generate(scene->context, name, desc, &scene->mesh);
}

void scene_knot(stability_scene *scene, double value, double extinction, double r, double g, double b) {
  if (scene->transfer.knot_count < STABILITY_KNOTS)
    scene->knots[scene->transfer.knot_count++] = (cellist_transfer_knot){value, extinction, {r, g, b}};
}

void scene_ramp(stability_scene *scene, double low, double high, double extinction) {
  static const double at[4] = {0.1, 0.35, 0.6, 0.9}, share[4] = {0, 0.6, 0.2, 1};
  static const double colour[4][3] = {{0.1, 0.2, 1}, {0.1, 0.9, 0.6}, {1, 0.9, 0.1}, {1, 0.2, 0.1}};
  for (int i = 0; i < 4; i++)
    scene_knot(scene, low + at[i] * (high - low), share[i] * extinction, colour[i][0], colour[i][1], colour[i][2]);
}

static void bounds_of(const stability_scene *scene, double bounds[6]) {
  if (scene->mesh != NULL) {
    memcpy(bounds, cellist_mesh_get_arrays(scene->mesh)->bounds, 6 * sizeof bounds[0]);
    return;
  }
  for (size_t k = 0; k < 3; k++) {
    bounds[k] = scene->point_count > 0 ? HUGE_VAL : 0;
    bounds[3 + k] = scene->point_count > 0 ? -HUGE_VAL : 0;
    for (size_t i = 0; i < scene->point_count; i++) {
      bounds[k] = fmin(bounds[k], scene->points[4 * i + k]);
      bounds[3 + k] = fmax(bounds[3 + k], scene->points[4 * i + k]);
    }
  }
}

void scene_look(stability_scene *scene, double azimuth, double elevation) {
  if (scene->result != CELLIST_SUCCESS) return;
  double bounds[6];
  bounds_of(scene, bounds);
  scene->view = cellist_view_orbit(bounds, azimuth, elevation);
}

void scene_eye(stability_scene *scene, double x, double y, double z) {
  const double eye[3] = {x, y, z};
  memcpy(scene->view.eye, eye, sizeof eye);
}

void scene_target(stability_scene *scene, double x, double y, double z) {
  const double target[3] = {x, y, z};
  memcpy(scene->view.target, target, sizeof target);
}

cellist_result scene_finish(stability_scene *scene) {
  scene->transfer.knots = scene->knots;
  scene->optics.isos = scene->optics.iso_count > 0 ? scene->isos : NULL;
  if (scene->result != CELLIST_SUCCESS || scene->mesh != NULL) return scene->result;
  const size_t count = scene->on_cells ? scene->tet_count : scene->point_count;
  double *positions = cellist_allocate(scene->context, scene->point_count, 3 * sizeof *positions);
  double *values = cellist_allocate(scene->context, count, sizeof *values);
  if (positions != NULL && values != NULL) {
    for (size_t i = 0; i < scene->point_count; i++)
      memcpy(&positions[3 * i], &scene->points[4 * i], 3 * sizeof *positions);
    for (size_t i = 0; i < count; i++) {
      values[i] = 0;
      for (size_t c = 0; scene->on_cells && c < 4; c++)
        values[i] += 0.25 * scene->points[4 * (size_t)scene->tets[4 * i + c] + 3];
      if (!scene->on_cells) values[i] = scene->points[4 * i + 3];
    }
    const cellist_field field = {"s", scene->on_cells ? CELLIST_ON_CELLS : CELLIST_ON_POINTS, 1, values};
    const cellist_mesh_desc desc = {scene->point_count, positions, scene->tet_count, scene->tets, NULL, 1, &field};
    scene->result = cellist_mesh_create(scene->context, &desc, &scene->mesh);
  } else {
    scene->result = CELLIST_ERROR_OUT_OF_MEMORY;
  }
  cellist_deallocate(scene->context, positions);
  cellist_deallocate(scene->context, values);
  return scene->result;
}

cellist_result stability_build(cellist_context *context, const stability_case *which, stability_scene *scene) {
  *scene =
      (stability_scene){.context = context, .width = 40, .height = 40, .view = {.up = {0, 0, 1}, .fovy_degrees = 30}};
  which->build(scene, which->parameter);
  const cellist_result result = scene_finish(scene);
  if (result != CELLIST_SUCCESS) stability_scene_release(scene);
  return result;
}

void stability_scene_release(stability_scene *scene) {
  cellist_deallocate(scene->context, scene->points);
  cellist_deallocate(scene->context, scene->tets);
  cellist_mesh_destroy(scene->mesh);
  scene->points = NULL;
  scene->tets = NULL;
  scene->mesh = NULL;
}
