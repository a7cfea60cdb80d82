/* SPDX-License-Identifier: BSD-3-Clause
 * Random tets, slivers, and cameras for them: what every renderer must draw right. */
#ifndef CELLIST_TESTS_RANDOM_CELLS_H
#define CELLIST_TESTS_RANDOM_CELLS_H

#include "stage.h"

static inline void random_point(random_state *random, double scale, double point[3]) {
  for (int k = 0; k < 3; k++) point[k] = random_between(random, -scale, scale);
}

enum { CELLS = 2000, SIZE = 16 };

/* Any tet; or a sliver: a plate, a needle, a wedge whose thickness is 1e-5 to 0.1. */
static inline void make_cell(random_state *random, bool sliver, double points[12]) {
  for (int k = 0; k < 4; k++) random_point(random, 1, &points[3 * k]);
  if (!sliver) return;
  const double thin = pow(10, random_between(random, -5, -1));
  const uint64_t kind = random_below(random, 3);
  for (int k = 0; k < 3; k++) {
    const double a = points[k], b = points[3 + k], c = points[6 + k];
    if (kind == 0) points[9 + k] = (a + b + c) / 3 + thin * points[9 + k];
    if (kind == 1) {
      points[6 + k] = 0.7 * a + 0.3 * b + thin * c;
      points[9 + k] = 0.2 * a + 0.8 * b + thin * points[9 + k];
    }
    if (kind == 2) points[9 + k] = c + thin * points[9 + k];
  }
}

/* CELLS of them, moved by an offset, with scalars: [12 * CELLS] and [4 * CELLS]. */
static inline void make_cells(random_state *random, bool sliver, double offset, double *points, double *values) {
  for (size_t i = 0; i < CELLS; i++) {
    make_cell(random, sliver, &points[12 * i]);
    for (size_t k = 0; k < 12; k++) points[12 * i + k] += offset;
    for (size_t k = 0; k < 4; k++) values[4 * i + k] = random_between(random, -0.6, 1.4);
  }
}

/* A camera for a tet: one in four inside it (perspective), one in four with the near plane through it. */
static inline cellist_frame random_frame(random_state *random, cellist_context *context,
                                         const cellist_mesh_arrays *arrays, uint32_t tet, bool parallel) {
  const double *corner[4];
  double eye[3], target[3];
  for (size_t k = 0; k < 4; k++) corner[k] = &arrays->positions[3 * (size_t)arrays->tets[4 * (size_t)tet + k]];
  for (int k = 0; k < 3; k++) target[k] = 0.25 * (corner[0][k] + corner[1][k] + corner[2][k] + corner[3][k]);
  const uint64_t where = random_below(random, 4);
  random_point(random, 1, eye);
  const double norm = sqrt(eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]);
  const double distance = random_between(random, 0.8, 6);
  for (int k = 0; k < 3; k++) eye[k] = target[k] + eye[k] / norm * distance;
  if (where == 0 && !parallel) {
    double weights[4], sum = 0;
    for (int k = 0; k < 4; k++) sum += weights[k] = random_between(random, 0.02, 1);
    for (int i = 0; i < 3; i++) {
      eye[i] = 0;
      for (int k = 0; k < 4; k++) eye[i] += weights[k] / sum * corner[k][i];
      target[i] = corner[0][i];
    }
  }
  const double height = parallel ? random_between(random, 0.5, 3) : 0;
  const double near_distance = where == 1 ? distance * random_between(random, 0.8, 1.1) : 0;
  return stage_frame(context, eye, target, height, near_distance, SIZE);
}

#endif
