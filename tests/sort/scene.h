/* SPDX-License-Identifier: BSD-3-Clause
 * Small meshes for the sorter's tests: Kuhn grids with holes, and random views of them. */
#ifndef CELLIST_TESTS_SORT_SCENE_H
#define CELLIST_TESTS_SORT_SCENE_H

#include "oracle.h"

/* A Kuhn grid of n^3 unit cubes; inner points move by up to `move` in each coordinate (0.1 keeps all tets positive);
 * each cube is left out with probability `hole`. */
static inline cellist_mesh *scene_grid(cellist_context *context, uint32_t n, double move, double hole, uint64_t seed) {
  static const uint8_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  random_state random = {seed};
  const uint32_t step[3] = {1, n + 1, (n + 1) * (n + 1)};
  const uint32_t point_count = (n + 1) * (n + 1) * (n + 1);
  double *points = calloc(point_count, 3 * sizeof *points);
  uint32_t *tets = calloc((size_t)6 * n * n * n, 4 * sizeof *tets);
  for (uint32_t i = 0; i < point_count; i++) {
    bool inner = true;
    for (uint32_t k = 0; k < 3; k++) inner &= i / step[k] % (n + 1) % n != 0;
    for (uint32_t k = 0; k < 3; k++)
      points[3 * i + k] = i / step[k] % (n + 1) + (inner ? move * oracle_random(&random) : 0);
  }
  size_t tet_count = 0;
  for (uint32_t cube = 0; cube < n * n * n; cube++) {
    if (random_unit(&random) < hole) continue;
    for (uint32_t t = 0; t < 6; t++) {
      uint32_t at = cube % n * step[0] + cube / n % n * step[1] + cube / n / n * step[2];
      for (uint32_t c = 0; c < 4; c++) {
        tets[4 * tet_count + c] = at;
        if (c < 3) at += step[path[t][c]];
      }
      tet_count++;
    }
  }
  const cellist_mesh_desc desc = {
      .point_count = point_count, .positions = points, .tet_count = tet_count, .tets = tets};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  free(points);
  free(tets);
  return mesh;
}

/* One of many kinds of view of a scene of the given size that starts at the origin: far, near, inside, on a grid
 * point, parallel, parallel along an axis. */
static inline cellist_viewpoint scene_view(unsigned kind, double size, random_state *random) {
  cellist_viewpoint view = {{0, 0, 0}, kind % 6 >= 4};
  static const double reach[6] = {10, 1.2, 0.5, 0.5, 1, 1};
  for (int k = 0; k < 3; k++) {
    view.position[k] = reach[kind % 6] * size * oracle_random(random);
    if (!view.parallel) view.position[k] += 0.5 * size;
  }
  if (kind % 6 == 3) /* on a grid point, or in the middle of an edge or face */
    for (int k = 0; k < 3; k++) view.position[k] = 0.5 * floor(2 * view.position[k]);
  if (kind % 6 == 5) /* along an axis or a diagonal of the grid */
    for (int k = 0; k < 3; k++) view.position[k] = (double)random_below(random, 3) - 1;
  if (view.parallel && view.position[0] == 0 && view.position[1] == 0 && view.position[2] == 0) view.position[2] = 1;
  return view;
}

/* Sorts from one view and returns what brute force finds. */
static inline oracle_count sort_and_check(cellist_context *context, const cellist_mesh *mesh,
                                          const cellist_viewpoint *view, size_t ray_count, cellist_sort_stats *stats) {
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  uint32_t *order = calloc(desc.tet_count + 1, sizeof *order);
  assert_success(context, cellist_sorter_sort(sorter, view, order, stats));
  const cellist_group *groups = NULL;
  size_t group_count = 0;
  cellist_sorter_groups(sorter, &groups, &group_count);
  const oracle_count count = oracle_check(&desc, view, order, groups, group_count, ray_count, 5);
  free(order);
  cellist_sorter_destroy(sorter);
  return count;
}

#endif
