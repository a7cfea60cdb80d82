/* SPDX-License-Identifier: BSD-3-Clause
 * Shapes: cells and meshes that are thin, flat, wrong or missing, seen from outside at no special angle. */
#include <math.h>

#include "scene.h"

static const uint32_t CUBES[3] = {3, 3, 3};

/* A grid pressed flat: dihedral angles of about `thickness`. */
void build_flat_cells(stability_scene *scene, double thickness) {
  scene_grid(scene, CUBES, 0.15, CELLIST_NONE);
  scene_place(scene, (const double[3]){1, 1, thickness}, (const double[3]){0, 0, 0});
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 0.5 / thickness);
}

/* A tet cut in four around one point. */
static void split_tet(stability_scene *scene, double x, double y, double z) {
  const uint32_t a = scene_point(scene, 0, 0, 0, 0.15), b = scene_point(scene, 3, 0, 0, 0.3);
  const uint32_t c = scene_point(scene, 0, 3, 0, 0.5), d = scene_point(scene, 0, 0, 3, 0.2);
  const uint32_t p = scene_point(scene, x, y, z, 0.95);
  scene_tet(scene, p, b, c, d);
  scene_tet(scene, a, p, c, d);
  scene_tet(scene, a, b, p, d);
  scene_tet(scene, a, b, c, p);
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 2);
}

void build_cap(stability_scene *scene, double height) { split_tet(scene, 1, 1.25, height); }
void build_wedge(stability_scene *scene, double distance) { split_tet(scene, 1.25, distance, distance); }
void build_needle(stability_scene *scene, double distance) { split_tet(scene, distance, distance, distance); }

/* Flat tets on every square of the face z = 0, which turn its diagonals, as a mesher leaves them. */
void build_zero_volume(stability_scene *scene, double unused) {
  (void)unused;
  scene_grid(scene, CUBES, 0, CELLIST_NONE);
  for (uint32_t j = 0; j < CUBES[1]; j++)
    for (uint32_t i = 0; i < CUBES[0]; i++) {
      const uint32_t v = i + j * (CUBES[0] + 1);
      scene_tet(scene, v, v + 1, v + CUBES[0] + 2, v + CUBES[0] + 1);
    }
  scene_look(scene, 31, -34);
  scene_ramp(scene, 0, 1, 1);
}

void build_inverted(stability_scene *scene, double unused) {
  (void)unused;
  scene_grid(scene, CUBES, 0.2, CELLIST_NONE);
  for (size_t t = 0; t < scene->tet_count; t += 3) {
    const uint32_t v = scene->tets[4 * t];
    scene->tets[4 * t] = scene->tets[4 * t + 3];
    scene->tets[4 * t + 3] = v;
  }
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
}

void build_duplicate_cells(stability_scene *scene, double unused) {
  (void)unused;
  scene_grid(scene, CUBES, 0.2, CELLIST_NONE);
  for (size_t t = 0; t < 30; t += 5) {
    const uint32_t *v = &scene->tets[4 * t], w[4] = {v[0], v[1], v[2], v[3]};
    scene_tet(scene, w[0], w[1], w[2], w[3]);
  }
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
}

/* Two halves with points of their own on both sides of the seam. */
void build_seam(stability_scene *scene, double gap) {
  const uint32_t half[3] = {2, 3, 3};
  scene_grid(scene, half, 0, CELLIST_NONE);
  const size_t count = scene->point_count;
  scene_grid(scene, half, 0, CELLIST_NONE);
  for (size_t i = count; i < scene->point_count; i++) scene->points[4 * i] += 2 + gap;
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
}

/* The upper half pressed through the lower one. */
void build_crushed(stability_scene *scene, double unused) {
  (void)unused;
  scene_grid(scene, (const uint32_t[3]){3, 3, 4}, 0.1, CELLIST_NONE);
  for (size_t i = 0; i < scene->point_count; i++)
    if (scene->points[4 * i + 2] > 2) scene->points[4 * i + 2] = 3.3 - scene->points[4 * i + 2];
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
}

void build_flaws(stability_scene *scene, double unused) {
  (void)unused;
  scene_generate(scene, "flaws", NULL);
  scene_look(scene, 31, 34);
  scene_ramp(scene, -1, 1, 1);
}

void build_one_cell(stability_scene *scene, double unused) {
  (void)unused;
  const uint32_t a = scene_point(scene, 0, 0, 0, 0), b = scene_point(scene, 3, 0, 0, 0.5);
  const uint32_t c = scene_point(scene, 0, 3, 0, 1), d = scene_point(scene, 0, 0, 3, 0.2);
  scene_tet(scene, a, b, c, d);
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
}

void build_no_cell(stability_scene *scene, double unused) {
  (void)unused;
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
}

/* Every point in one plane, so that every cell is flat. */
void build_flat_hull(stability_scene *scene, double unused) {
  (void)unused;
  scene_grid(scene, CUBES, 0.2, CELLIST_NONE);
  scene_place(scene, (const double[3]){1, 1, 0}, (const double[3]){0, 0, 0});
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
}

/* Seen along the axis, each stick lies over the next, all around. */
void build_wheel(stability_scene *scene, double sticks) {
  scene_generate(scene, "cyclic", &(cellist_generate_desc){.size = 1, .parts = (uint32_t)sticks});
  scene_look(scene, 31, 89);
  scene_ramp(scene, -1, 1, 4 * sticks);
}

/* ---- Frames: where the mesh lies and how large it is -------------------------------------------------- */

void build_offset(stability_scene *scene, double offset) {
  scene_grid(scene, CUBES, 0.2, CELLIST_NONE);
  scene_place(scene, (const double[3]){1, 1, 1}, (const double[3]){offset, -0.7 * offset, 0.3 * offset});
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
}

void build_scale(stability_scene *scene, double scale) {
  scene_grid(scene, CUBES, 0.2, CELLIST_NONE);
  scene_place(scene, (const double[3]){scale, scale, scale}, (const double[3]){0, 0, 0});
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1 / scale);
}

/* Cubes drawn out along x, a short piece of them seen from the side. */
void build_aspect_across(stability_scene *scene, double aspect) {
  scene_grid(scene, CUBES, 0.15, CELLIST_NONE);
  scene_place(scene, (const double[3]){aspect, 1, 1}, (const double[3]){0, 0, 0});
  scene_eye(scene, aspect, -8, 4);
  scene_target(scene, aspect, 1.5, 1.5);
  scene->view.parallel_height = 4.5;
  scene_ramp(scene, 0, 1, 1);
}

/* The same, seen along x. */
void build_aspect_along(stability_scene *scene, double aspect) {
  scene_grid(scene, CUBES, 0.15, CELLIST_NONE);
  scene_place(scene, (const double[3]){aspect, 1, 1}, (const double[3]){0, 0, 0});
  scene_eye(scene, -0.5 * aspect, 1.7, 1.6);
  scene_target(scene, aspect, 1.5, 1.4);
  scene->view.fovy_degrees = 2 * atan(4.5 / aspect) / 0.017453292519943295;
  scene_ramp(scene, 0, 1, 1 / aspect);
}
