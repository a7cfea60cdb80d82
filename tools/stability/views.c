/* SPDX-License-Identifier: BSD-3-Clause
 * Views: harmless meshes seen from where eyes and rays meet points, edges and faces exactly. The cubes' corners are
 * whole numbers, so that such meetings are exact in doubles. */
#include <math.h>

#include "scene.h"

static const uint32_t CUBES[3] = {4, 4, 4};
static const double DEGREE = 0.017453292519943295;

static void whole_grid(stability_scene *scene) {
  scene_grid(scene, CUBES, 0, CELLIST_NONE);
  scene_ramp(scene, 0, 1, 1);
  scene->view.fovy_degrees = 70;
}

void build_eye_on_vertex(stability_scene *scene, double unused) {
  (void)unused;
  whole_grid(scene);
  scene_eye(scene, 2, 2, 2);
  scene_target(scene, 3.3, 2.9, 2.4);
}

void build_eye_on_edge(stability_scene *scene, double unused) {
  (void)unused;
  whole_grid(scene);
  scene_eye(scene, 2, 2, 2.4);
  scene_target(scene, 3.3, 2.9, 2.1);
}

/* x: which of the planes x = 0..4. The plane itself projects onto a line that no pixel's centre lies on. */
void build_eye_in_face_plane(stability_scene *scene, double x) {
  whole_grid(scene);
  scene_eye(scene, x, -3, 1.7);
  scene_target(scene, x + 0.3, 2, 2.2);
}

/* distance: to the plane x = 2, through which the eye looks; below 0: away from which it looks. */
void build_eye_near_face(stability_scene *scene, double distance) {
  whole_grid(scene);
  scene_eye(scene, 2 + fabs(distance), 1.3, 2.6);
  scene_target(scene, distance > 0 ? 0 : 4, 1.45, 2.5);
}

void build_eye_in_cell(stability_scene *scene, double unused) {
  (void)unused;
  whole_grid(scene);
  scene_eye(scene, 2.3, 2.2, 2.6);
  scene_target(scene, 0.1, 1.2, 2.1);
}

void build_eye_in_cavity(stability_scene *scene, double unused) {
  (void)unused;
  scene_grid(scene, (const uint32_t[3]){3, 3, 3}, 0.1, 13);
  scene_ramp(scene, 0, 1, 1);
  scene_eye(scene, 1.5, 1.5, 1.5);
  scene_target(scene, 3, 2, 1.8);
  scene->view.fovy_degrees = 100;
}

void build_eye_far(stability_scene *scene, double distance) {
  whole_grid(scene);
  scene_look(scene, 31, 34);
  for (int k = 0; k < 3; k++)
    scene->view.eye[k] = scene->view.target[k] + distance / 13 * (scene->view.eye[k] - scene->view.target[k]);
  scene->view.fovy_degrees = 2 * atan(3.6 / distance) / DEGREE;
}

/* Parallel, along y: the faces across x, z and their diagonal hold the direction. */
static void look_along_y(stability_scene *scene, double columns, double x, double height) {
  whole_grid(scene);
  scene_eye(scene, x, -5, 2);
  scene_target(scene, x, 2, 2);
  scene->width = scene->height = (uint32_t)columns;
  scene->view.parallel_height = height;
}

/* No ray lies in a face. */
void build_along_faces(stability_scene *scene, double columns) { look_along_y(scene, columns, 2.03, 4.3); }

/* The same, with the middle column of pixels in the plane x = 2 and the middle row in z = 2. */
void build_rays_in_faces(stability_scene *scene, double columns) { look_along_y(scene, columns, 2, columns / 8); }

void build_narrow(stability_scene *scene, double degrees) { build_eye_far(scene, 3.6 / tan(0.5 * degrees * DEGREE)); }

void build_wide(stability_scene *scene, double degrees) {
  whole_grid(scene);
  scene_eye(scene, 2.1, 2.2, 2.3);
  scene_target(scene, 3.3, 2.9, 2.4);
  scene->view.fovy_degrees = degrees;
}

/* depth: in parts of the distance to the middle. */
void build_near_plane(stability_scene *scene, double depth) {
  scene_grid(scene, CUBES, 0.2, CELLIST_NONE);
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
  double square = 0;
  for (int k = 0; k < 3; k++) square += pow(scene->view.eye[k] - scene->view.target[k], 2);
  scene->view.near_distance = depth * sqrt(square);
}

void build_near_parallel(stability_scene *scene, double depth) {
  build_near_plane(scene, depth);
  scene->view.parallel_height = 7;
}

void build_image_size(stability_scene *scene, double width) {
  scene_grid(scene, CUBES, 0.2, CELLIST_NONE);
  scene_look(scene, 31, 34);
  scene_ramp(scene, 0, 1, 1);
  scene->width = (uint32_t)width;
  scene->height = 1;
  if (width > 1) { /* the mesh as wide as the image; parallel, for no view is that flat */
    scene->view.parallel_height = 8 / width;
  }
}

void build_tall_image(stability_scene *scene, double height) {
  build_image_size(scene, height);
  scene->width = 1;
  scene->height = (uint32_t)height;
  scene->view.parallel_height = 8;
}
