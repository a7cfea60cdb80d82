/* SPDX-License-Identifier: BSD-3-Clause
 * Stiff: scenes whose optics or scalars are hard, on harmless cells. Rays come from outside, at no special angle. */
#include <math.h>

#include "scene.h"

static const uint32_t CUBES[3] = {3, 3, 3};
static const double JITTER = 0.2;

static void harmless(stability_scene *scene) {
  scene_grid(scene, CUBES, JITTER, CELLIST_NONE);
  scene_look(scene, 31, 34);
}

/* An optical depth of up to `depth` a unit cube. */
void build_depth(stability_scene *scene, double depth) {
  harmless(scene);
  scene_ramp(scene, 0, 1, depth);
}

void build_step(stability_scene *scene, double extinction) {
  harmless(scene);
  scene_knot(scene, 0.3, 0, 0.2, 0.3, 1);
  scene_knot(scene, 0.5, 0, 0.2, 0.3, 1);
  scene_knot(scene, 0.5, extinction, 1, 0.4, 0.1);
}

/* Peaks of optical depth around 1 for a slope of 1 a unit length, whatever their width. */
void build_spike(stability_scene *scene, double half_width) {
  harmless(scene);
  const double peak = 1 / half_width;
  for (int i = 0; i < 3; i++) {
    const double at = 0.3 + 0.2 * i;
    scene_knot(scene, at - half_width, 0, 1, 1, 1);
    scene_knot(scene, at, peak, i == 0, i == 1, i == 2);
    scene_knot(scene, at + half_width, 0, 1, 1, 1);
  }
}

void build_comb(stability_scene *scene, double unused) {
  (void)unused;
  harmless(scene);
  for (int i = 0; i < STABILITY_KNOTS; i++)
    scene_knot(scene, (i + 0.5) / STABILITY_KNOTS, i % 2 == 0 ? 0 : 20, i % 3 == 0, i % 3 == 1, i % 3 == 2);
}

void build_close_surfaces(stability_scene *scene, double apart) {
  harmless(scene);
  scene_knot(scene, 0.5, 1, 1, 0.3, 0.1);
  scene_knot(scene, 0.5 + apart, 1, 0.1, 0.4, 1);
  scene->optics.model = CELLIST_MODEL_ISOSURFACES;
  scene->optics.iso_count = 2;
  scene->isos[0] = (cellist_isosurface){0.5, 1};
  scene->isos[1] = (cellist_isosurface){0.5 + apart, 1};
}

/* A region, up to the mesh's boundary, holds the value of a surface; sign: what is outside lies below (-1) or above. */
void build_plateau(stability_scene *scene, double sign) {
  harmless(scene);
  for (size_t i = 0; i < scene->point_count; i++) {
    const double value = scene->points[4 * i + 3];
    scene->points[4 * i + 3] = 0.3 + sign * fmax(0, value - 0.45);
  }
  scene_knot(scene, 0.3, 1, 1, 0.3, 0.1);
  scene_knot(scene, 0.45, 1, 0.1, 0.4, 1);
  scene->optics.model = CELLIST_MODEL_ISOSURFACES;
  scene->optics.iso_count = 2;
  scene->isos[0] = (cellist_isosurface){0.3, 0.6};
  scene->isos[1] = (cellist_isosurface){0.45, 1};
}

void build_scalar_scale(stability_scene *scene, double scale) {
  harmless(scene);
  for (size_t i = 0; i < scene->point_count; i++) scene->points[4 * i + 3] *= scale;
  scene_ramp(scene, 0, scale, 1);
}

/* A range of 1e-3 far from 0. */
void build_scalar_offset(stability_scene *scene, double offset) {
  static const double RANGE = 1e-3;
  harmless(scene);
  for (size_t i = 0; i < scene->point_count; i++) scene->points[4 * i + 3] = offset + RANGE * scene->points[4 * i + 3];
  scene_ramp(scene, offset, offset + RANGE, 1);
}

void build_cell_step(stability_scene *scene, double unused) {
  (void)unused;
  build_step(scene, 30);
  scene->on_cells = true;
}

void build_constant_scalar(stability_scene *scene, double unused) {
  (void)unused;
  build_depth(scene, 1);
  for (size_t i = 0; i < scene->point_count; i++) scene->points[4 * i + 3] = 0.6; /* on a knot */
}

void build_nan_scalar(stability_scene *scene, double unused) {
  (void)unused;
  build_depth(scene, 1);
  if (scene->point_count > 30) scene->points[4 * 21 + 3] = NAN, scene->points[4 * 30 + 3] = INFINITY;
}

void build_hdr(stability_scene *scene, double brightest) {
  harmless(scene);
  scene_knot(scene, 0.1, 0, brightest, 1, 1 / brightest);
  scene_knot(scene, 0.5, 1, 1 / brightest, brightest, 1);
  scene_knot(scene, 0.9, 0.1, 1, 1 / brightest, brightest);
}

/* Gradients along x, a little noise, light almost across them; a negative sine: by gradients at points. */
void build_grazing_light(stability_scene *scene, double sine) {
  harmless(scene);
  for (size_t i = 0; i < scene->point_count; i++)
    scene->points[4 * i + 3] = 0.3 * scene->points[4 * i] + 0.01 * scene->points[4 * i + 3];
  scene_ramp(scene, 0, 1, 1);
  scene->optics.light = (cellist_light){.enabled = true,
                                        .direction = {fabs(sine), 0.8, 0.6},
                                        .ambient = 0.3,
                                        .diffuse = 0.7,
                                        .specular = 0.2,
                                        .shininess = 20,
                                        .gradient_unit = 0.3,
                                        .cell_gradients = sine > 0};
}

/* An opaque plane that the eye sees at that angle, lit from the eye. */
void build_grazing_surface(stability_scene *scene, double sine) {
  harmless(scene);
  for (size_t i = 0; i < scene->point_count; i++) scene->points[4 * i + 3] = scene->points[4 * i] / 3;
  scene_ramp(scene, 0, 1, 1);
  scene->optics.model = CELLIST_MODEL_ISOSURFACES;
  scene->optics.iso_count = 1;
  scene->isos[0] = (cellist_isosurface){0.45, 1};
  scene->optics.light = (cellist_light){.enabled = true,
                                        .ambient = 0.2,
                                        .diffuse = 0.8,
                                        .specular = 0.2,
                                        .shininess = 20,
                                        .gradient_unit = 1,
                                        .cell_gradients = true};
  scene_target(scene, 0.45 * 3, 1.5, 1.5);
  scene_eye(scene, 0.45 * 3 + 8 * sine, -6.5, 1.7);
  scene->view.parallel_height = 6 * sine; /* the surface fills half of it */
}

void build_model(stability_scene *scene, double model) {
  build_depth(scene, 1e3);
  scene->optics.model = (cellist_model)model;
}
