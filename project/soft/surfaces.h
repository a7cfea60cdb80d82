/* SPDX-License-Identifier: BSD-3-Clause
 * Surfaces: the maximum along rays, and sharp isosurfaces. Included by each kernel.
 *
 * A segment crosses an isosurface where one of its ends is below the value and the other is not. Two cells work out the
 * scalar at their common face each for itself, and rounding could put the value between: a hole, or a surface met
 * twice. So each pixel remembers the scalar at which its ray left the last cell, and a cell that begins there begins
 * with that scalar. */
#ifndef CELLIST_SOFT_SURFACES_H
#define CELLIST_SOFT_SURFACES_H

#include "pieces.h"

/* How near a cell's entry is to the last exit, in scaled scalars and of the depth, if the two are one. Smaller:
 * rounding tears surfaces open; larger: two surfaces of different parts of the mesh may be joined in a pixel. */
#define SURFACES_SAME_SCALAR 1e-4f
#define SURFACES_SAME_DEPTH 1e-4f

/* A pixel's largest scalar so far, as a sum of two floats: the second is 0 unless the transfer function asks for more
 * digits. ends: see add_sharp_segments; NULL: none is sharp. */
static inline void add_maxima(soft_worker *worker, const segment8 *segment, const double *const ends[8],
                              unsigned lanes) {
  float end[2][8], depth[2][8];
  int32_t pixel[8];
  f8_store(end[0], segment->from);
  f8_store(end[1], segment->to);
  f8_store(depth[0], segment->near_depth);
  f8_store(depth[1], segment->far_depth);
  i8_store(pixel, segment->pixel);
  for (int i = 0; i < 8 && lanes >> i != 0; i++)
    for (int k = 0; k < 2; k++) {
      soft_pixel *gathered = &worker->pixels[pixel[i]];
      float *largest = gathered->light;
      const double value = ends != NULL && !isnan(ends[i][0]) ? ends[i][k] : (double)end[k][i];
      if (!(value > (double)largest[0] + (double)largest[1])) continue;
      largest[0] = (float)value;
      largest[1] = (float)(value - (double)largest[0]);
      gathered->z_back = depth[k][i];
      gathered->minus_z = -depth[k][i];
    }
}

/* Lanes as arrays: what few fragments need. */
typedef struct surface_lanes {
  float from[8], to[8], near[8], far[8], light[6][8];
  int32_t pixel[8];
} surface_lanes;

static inline void light_surface(const soft_model *model, const surface_lanes *lanes, int i, float w, float *share,
                                 float *shine) {
  *share = 1;
  *shine = 0;
  if (model->gradients == SOFT_CELL_GRADIENTS) {
    *share = lanes->light[0][i];
    *shine = lanes->light[1][i];
  } else if (model->gradients == SOFT_POINT_GRADIENTS) {
    double towards = 0, half = 0, square = 0;
    for (int k = 0; k < 3; k++) {
      const double g = lanes->light[k][i] + w * (lanes->light[3 + k][i] - lanes->light[k][i]);
      towards += g * model->light[k];
      half += g * model->halfway[k];
      square += g * g;
    }
    const double inverse = square > 0 ? 1 / sqrt(square) : 0;
    *share = (float)(model->ambient + model->diffuse * fabs(towards) * inverse);
    if (model->specular > 0) *shine = (float)(model->specular * pow(fabs(half) * inverse, model->shininess));
  }
}

static inline void add_crossings(const soft_model *model, soft_worker *worker, const surface_lanes *lanes, int i,
                                 float from, float to) {
  soft_pixel *pixel = &worker->pixels[lanes->pixel[i]];
  float *light = pixel->light;
  for (size_t j = 0; j < model->iso_count; j++) {
    const soft_iso *iso = &model->isos[from < to ? j : model->iso_count - 1 - j];
    if ((from < iso->value) == (to < iso->value)) continue;
    const float w = (iso->value - from) / (to - from), depth = lanes->near[i] + w * (lanes->far[i] - lanes->near[i]);
    float share, shine;
    light_surface(model, lanes, i, w, &share, &shine);
    const float seen = light[3] * iso->opacity;
    for (int k = 0; k < 3; k++) light[k] += seen * (iso->colour[k] * share + shine);
    light[3] -= seen;
    if (!(iso->opacity > 0)) continue;
    pixel->minus_z = -depth > pixel->minus_z ? -depth : pixel->minus_z;
    pixel->z_back = depth > pixel->z_back ? depth : pixel->z_back;
  }
}

static void add_isosurfaces(const soft_scene *scene, soft_worker *worker, const segment8 *segment, unsigned used) {
  surface_lanes lanes;
  f8_store(lanes.from, segment->from);
  f8_store(lanes.to, segment->to);
  f8_store(lanes.near, segment->near_depth);
  f8_store(lanes.far, segment->far_depth);
  i8_store(lanes.pixel, segment->pixel);
  const soft_gradients gradients = scene->model.gradients;
  for (int k = 0; k < (gradients == SOFT_NO_LIGHT ? 0 : gradients == SOFT_CELL_GRADIENTS ? 2 : 6); k++)
    f8_store(lanes.light[k], segment->light[k]);
  for (int i = 0; i < 8 && used >> i != 0; i++) {
    float *last = worker->last[lanes.pixel[i]], from = lanes.from[i];
    const bool same = fabsf(from - last[0]) <= SURFACES_SAME_SCALAR &&
                      fabsf(lanes.near[i] - last[1]) <= SURFACES_SAME_DEPTH * fabsf(lanes.near[i]);
    if (same) from = last[0];
    last[0] = lanes.to[i];
    last[1] = lanes.far[i];
    /* What hides all has no light left to add. */
    if (worker->pixels[lanes.pixel[i]].light[3] > 0) add_crossings(&scene->model, worker, &lanes, i, from, lanes.to[i]);
  }
}

#endif
