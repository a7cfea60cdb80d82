/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes made of parts that share no points, and wheels: cells that lie on each other in a circle. */
#ifndef CELLIST_TESTS_SORT_PILE_H
#define CELLIST_TESTS_SORT_PILE_H

#include "scene.h"

/* Points and tets that grow. */
struct pile {
  size_t point_count, tet_count;
  double points[3 * 4096];
  uint32_t tets[4 * 4096];
};

static inline void pile_add_mesh(struct pile *pile, const cellist_mesh *mesh, double scale, const double shift[3]) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  for (size_t i = 0; i < 4 * a->tet_count; i++)
    pile->tets[4 * pile->tet_count + i] = (uint32_t)(a->tets[i] + pile->point_count);
  for (size_t i = 0; i < 3 * a->point_count; i++)
    pile->points[3 * pile->point_count + i] = scale * a->positions[i] + shift[i % 3];
  pile->tet_count += a->tet_count;
  pile->point_count += a->point_count;
}

static inline cellist_mesh *pile_mesh(cellist_context *context, const struct pile *pile) {
  const cellist_mesh_desc desc = {
      .point_count = pile->point_count, .positions = pile->points, .tet_count = pile->tet_count, .tets = pile->tets};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  return mesh;
}

enum { WHEEL_LIMIT = 300 };

/* Stick i leads from angle i to angle i + 1.3 (in n-ths of a turn) and down, so that the start of stick i + 1 lies
 * above its end: seen from above, all lie on each other in a circle. A tet below and one above are no part of it. */
static inline cellist_mesh *make_wheel(cellist_context *context, uint32_t n) {
  struct pile *pile = calloc(1, sizeof *pile);
  const double step = 2 * acos(-1) / n, thickness = 0.02 * step;
  for (uint32_t i = 0; i < n; i++) {
    const double a = i * step, b = (i + 1.3) * step;
    const double corners[4][3] = {{(1 - thickness) * cos(a), (1 - thickness) * sin(a), step},
                                  {(1 + thickness) * cos(a), (1 + thickness) * sin(a), step},
                                  {cos(b), sin(b), -step - thickness},
                                  {cos(b), sin(b), -step + thickness}};
    memcpy(&pile->points[12 * (size_t)i], corners, sizeof corners);
  }
  for (uint32_t side = 0; side < 2; side++) {
    const double z = side == 0 ? -8 : 8;
    const double corners[4][3] = {{-4, -4, z}, {4, -4, z}, {0, 4, z}, {0, 0, z + 1}};
    memcpy(&pile->points[12 * (size_t)(n + side)], corners, sizeof corners);
  }
  pile->tet_count = n + 2;
  pile->point_count = 4 * pile->tet_count;
  for (uint32_t i = 0; i < pile->point_count; i++) pile->tets[i] = i;
  cellist_mesh *mesh = pile_mesh(context, pile);
  free(pile);
  return mesh;
}

/* Sorts a wheel from above, from an eye and in parallel: one group of exactly its cells, the tet below before it and
 * the one above after it. */
static inline void wheel_check(cellist_context *context, const cellist_mesh *mesh, const cellist_sorter_desc *desc) {
  const uint32_t *origin = cellist_mesh_get_arrays(mesh)->tet_origin, n = (uint32_t)desc->tet_count - 2;
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, desc, &sorter));
  for (int parallel = 0; parallel < 2; parallel++) {
    const cellist_viewpoint view = {{0, 0, parallel ? -1 : 100}, parallel};
    uint32_t order[WHEEL_LIMIT + 2];
    cellist_sort_stats stats;
    assert_success(context, cellist_sorter_sort(sorter, &view, order, &stats));
    const cellist_group *groups = NULL;
    size_t group_count = 0;
    cellist_sorter_groups(sorter, &groups, &group_count);
    assert_int_equal(group_count, 1);
    assert_int_equal(groups[0].begin, 1);
    assert_int_equal(groups[0].count, n);
    assert_int_equal(origin[order[0]], n);
    assert_int_equal(origin[order[n + 1]], n + 1);
    assert_true(stats.group_count == 1 && stats.largest_group == n && stats.cells_in_groups == n && stats.exact);
    const oracle_count count = oracle_check(desc, &view, order, groups, group_count, 20, 1);
    assert_int_equal(count.inversions, 0);
  }
  cellist_sorter_destroy(sorter);
}

#endif
