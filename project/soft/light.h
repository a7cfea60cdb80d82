/* SPDX-License-Identifier: BSD-3-Clause
 * Light: on cells with one gradient each, and on pieces and surfaces where it is linear in a cell. Included by each
 * kernel; [C] section 8, as cellist/optics.h says it.
 *
 * A piece is lit by the gradient where the scalar lies that gives the piece its colour: the light's centre. That is
 * exact to second order in the piece, and a segment may be cut into up to four parts. */
#ifndef CELLIST_SOFT_LIGHT_H
#define CELLIST_SOFT_LIGHT_H

#include <optics/fast_lanes.h>

#include "cells.h"
#include "scene.h"

/* Each cell's factor of colours and highlight, by its one gradient. */
static inline void light_cells(const soft_model *model, cell_batch *batch) {
  for (int i = 0; i < 4; i++) {
    double towards = 0, half = 0, square = 0;
    for (int k = 0; k < 3; k++) {
      const double g = batch->gradient[k][i];
      towards += g * model->light[k];
      half += g * model->halfway[k];
      square += g * g;
    }
    const double inverse = square > 0 ? 1 / sqrt(square) : 0;
    const double unit = model->model == CELLIST_MODEL_ISOSURFACES ? inverse : model->gradient_factor;
    batch->record[i].share = (float)(model->ambient + model->diffuse * fabs(towards) * unit);
    batch->record[i].shine =
        model->specular > 0 ? (float)(model->specular * pow(fabs(half) * inverse, model->shininess)) : 0;
  }
}

/* The same for eight gradients; normal: they count as unit vectors (isosurfaces). */
static inline void light_gradients8(const soft_model *model, const f8 g[3], bool normal, f8 *share, f8 *shine) {
  f8 towards = f8_all(0), half = f8_all(0), square = f8_all(0);
  for (int k = 0; k < 3; k++) {
    towards = f8_fma(g[k], f8_all((float)model->light[k]), towards);
    half = f8_fma(g[k], f8_all((float)model->halfway[k]), half);
    square = f8_fma(g[k], g[k], square);
  }
  const f8 inverse = f8_div(f8_all(1), f8_max(f8_sqrt(square), f8_all(1e-30f)));
  const f8 facing = normal ? f8_mul(f8_abs(towards), inverse) : f8_abs(towards);
  *share = f8_fma(f8_all((float)model->diffuse), facing, f8_all((float)model->ambient));
  *shine = f8_all(0);
  if (model->specular > 0) {
    const f8 cosine = f8_mul(f8_abs(half), inverse);
    const f8 power = fast_power8(cosine, (float)model->shininess);
    *shine = f8_select(f8_greater(square, f8_all(0)), f8_mul(f8_all((float)model->specular), power), f8_all(0));
  }
}

#endif
