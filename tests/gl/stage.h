/* SPDX-License-Identifier: BSD-3-Clause
 * What tests of the OpenGL renderer set up: tets that share nothing, a scalar on them, an image, a renderer. */
#ifndef CELLIST_TESTS_STAGE_H
#define CELLIST_TESTS_STAGE_H

#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "single_cell.h"

static const char *const STAGE_CHANNELS[] = {"R", "G", "B", "A", "Z", "ZBack"};

typedef struct stage {
  cellist_context *context;
  cellist_gl *gl;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_image *image;
} stage;

/* points: 12 numbers a tet; values: 4 a tet. Close the stage also after a failure. */
static inline cellist_result stage_open(cellist_context *context, cellist_gl_backend backend, size_t tet_count,
                                        const double *points, const double *values, uint32_t size, stage *made) {
  *made = (stage){.context = context};
  uint32_t *tets = malloc(4 * tet_count * sizeof *tets);
  for (uint32_t i = 0; i < 4 * tet_count; i++) tets[i] = i;
  const cellist_field field = {"value", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {4 * tet_count, points, tet_count, tets, NULL, 1, &field};
  const cellist_gl_desc gl_desc = {.backend = backend};
  cellist_result result = cellist_mesh_create(context, &desc, &made->mesh);
  free(tets);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, made->mesh, NULL, &made->scalar);
  if (result == CELLIST_SUCCESS) result = cellist_image_create(context, size, size, STAGE_CHANNELS, 6, &made->image);
  if (result == CELLIST_SUCCESS) result = cellist_gl_create(context, &gl_desc, &made->gl);
  if (result == CELLIST_SUCCESS) result = cellist_gl_upload(made->gl, made->mesh, &made->scalar);
  return result;
}

static inline void stage_close(stage *made) {
  cellist_gl_destroy(made->gl);
  cellist_image_destroy(made->image);
  cellist_scalar_release(made->context, &made->scalar);
  cellist_mesh_destroy(made->mesh);
}

static inline oracle_cell stage_cell(const stage *made, uint32_t tet) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  oracle_cell cell;
  for (size_t k = 0; k < 4; k++) {
    const size_t point = arrays->tets[4 * (size_t)tet + k];
    for (size_t i = 0; i < 3; i++) cell.corner[k][i] = arrays->positions[3 * point + i];
    cell.scalar[k] = made->scalar.values[point];
  }
  return cell;
}

static inline cellist_frame stage_frame(cellist_context *context, const double eye[3], const double target[3],
                                        double parallel_height, double near_distance, uint32_t size) {
  cellist_view view = {
      .up = {0.1, 0.2, 0.97}, .fovy_degrees = 50, .parallel_height = parallel_height, .near_distance = near_distance};
  memcpy(view.eye, eye, sizeof view.eye);
  memcpy(view.target, target, sizeof view.target);
  cellist_frame frame;
  assert_success(context, cellist_frame_from_view(context, &view, size, size, &frame));
  return frame;
}

#endif
