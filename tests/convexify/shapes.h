/* SPDX-License-Identifier: BSD-3-Clause
 * Shapes: meshes of unit cubes, each split into six tets, for tests. */
#ifndef CELLIST_TESTS_SHAPES_H
#define CELLIST_TESTS_SHAPES_H

#include <base/random.h>
#include <cellist/mesh.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct shape {
  int size[3];
  const char *cubes; /* size[0] * size[1] * size[2], x fastest; '#' is solid */
  double scale, offset[3];
  bool unmerged; /* every cube has points of its own */
  double jitter; /* points move by up to this along each axis */
  double shear;  /* each coordinate grows by this times the next one: a power of two keeps planes exact */
  uint64_t seed;
} shape;

static inline cellist_result shape_mesh(cellist_context *context, const shape *s, cellist_mesh **mesh) {
  static const int path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const int nx = s->size[0], ny = s->size[1], nz = s->size[2];
  const size_t cubes = (size_t)(nx * ny * nz);
  const size_t grid_points = (size_t)((nx + 1) * (ny + 1) * (nz + 1));
  double *points = malloc((s->unmerged ? 8 * cubes : grid_points) * 3 * sizeof *points);
  uint32_t *tets = malloc(cubes * 24 * sizeof *tets);
  size_t tet_count = 0, point_count = s->unmerged ? 0 : grid_points;
  const double scale = s->scale != 0 ? s->scale : 1;
  random_state random = {s->seed};
  for (size_t i = 0; i < grid_points && !s->unmerged; i++) {
    const int at[3] = {(int)i % (nx + 1), (int)i / (nx + 1) % (ny + 1), (int)i / (nx + 1) / (ny + 1)};
    for (int k = 0; k < 3; k++)
      points[3 * i + (size_t)k] =
          s->offset[k] + scale * (at[k] + s->shear * at[(k + 1) % 3] + random_between(&random, -s->jitter, s->jitter));
  }
  for (size_t c = 0; c < cubes; c++) {
    if (s->cubes[c] != '#') continue;
    const int at[3] = {(int)c % nx, (int)c / nx % ny, (int)c / nx / ny};
    uint32_t corner[8];
    for (uint32_t i = 0; i < 8; i++) {
      const int p[3] = {at[0] + (int)(i & 1), at[1] + (int)(i >> 1 & 1), at[2] + (int)(i >> 2 & 1)};
      corner[i] = (uint32_t)(p[0] + (nx + 1) * (p[1] + (ny + 1) * p[2]));
      if (!s->unmerged) continue;
      for (int k = 0; k < 3; k++) points[3 * point_count + (size_t)k] = s->offset[k] + scale * p[k];
      corner[i] = (uint32_t)point_count++;
    }
    for (int t = 0; t < 6; t++) {
      uint32_t i = 0;
      tets[4 * tet_count] = corner[0];
      for (int k = 0; k < 3; k++) tets[4 * tet_count + 1 + (size_t)k] = corner[i |= 1u << path[t][k]];
      tet_count++;
    }
  }
  const cellist_mesh_desc desc = {
      .point_count = point_count, .positions = points, .tet_count = tet_count, .tets = tets};
  const cellist_result result = cellist_mesh_create(context, &desc, mesh);
  free(points);
  free(tets);
  return result;
}

#endif
