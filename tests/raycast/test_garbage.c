/* SPDX-License-Identifier: BSD-3-Clause
 * Random tets on a tiny integer grid: overlapping, flat, folded, faces of three, points shared at random. Whatever the
 * mesh, a ray must pass each tet that it meets exactly once. */
#include <math.h>

#include "../../project/raycast/reference_walk.h"
#include "brute.h"
#include "harness.h"
#include "scene.h"

enum { POINTS = 14 };

static const walk_limits WHOLE_RAY = {.t = {0, HUGE_VAL}};

typedef struct garbage {
  cast_scene scene;
  face_hierarchy hierarchy;
  ray_walker walker;
} garbage;

static void garbage_create(garbage *made, random_state *random) {
  double points[3 * POINTS], values[POINTS];
  uint32_t tets[4 * 40];
  const size_t tet_count = 1 + random_below(random, 40);
  const uint64_t grid = 2 + random_below(random, 4);
  for (int i = 0; i < 3 * POINTS; i++) points[i] = (double)random_below(random, grid);
  for (int i = 0; i < POINTS; i++) values[i] = (double)random_below(random, 4);
  for (size_t t = 0; t < tet_count; t++)
    for (uint32_t c = 0; c < 4;) {
      /* Half of the tets share a face with the one before. */
      uint32_t *v = &tets[4 * t];
      v[c] = t > 0 && c < 3 && t % 2 ? v[(int)c - 4] : (uint32_t)random_below(random, POINTS);
      bool is_new = true;
      for (uint32_t k = 0; k < c; k++) is_new = is_new && v[k] != v[c];
      c += is_new;
    }
  scene_create(&made->scene, 1, POINTS, points, tet_count, tets, CELLIST_ON_POINTS, values);
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(made->scene.mesh);
  assert_success(made->scene.context, hierarchy_build(made->scene.context, mesh, &made->hierarchy));
  made->walker = (ray_walker){
      .context = made->scene.context, .mesh = mesh, .scalar = &made->scene.scalar, .hierarchy = &made->hierarchy};
}

static void garbage_destroy(garbage *made) {
  walk_release(&made->walker);
  hierarchy_release(made->scene.context, &made->hierarchy);
  scene_destroy(&made->scene);
}

/* Segments in order of depth, each tet at most once, everything finite. */
static void check_order(garbage *made, const double origin[3], const double direction[3]) {
  ray_walker *walker = &made->walker;
  const uint64_t steps = walker->step_count;
  bool passed[40] = {false};
  assert_true(walk_ray(walker, origin, direction, &WHOLE_RAY));
  assert_true(walker->step_count - steps <= walker->mesh->tet_count);
  for (size_t s = 0; s < walker->segment_count; s++) {
    const walk_segment *segment = &walker->segments[s];
    assert_true(isfinite(segment->t[0]) && segment->t[1] > segment->t[0] && isfinite(segment->t[1]));
    for (int end = 0; end < 2; end++) assert_true(segment->scalar[end] >= -1e-12 && segment->scalar[end] <= 3 + 1e-12);
    assert_true(s == 0 || segment->t[0] + segment->t[1] >= segment[-1].t[0] + segment[-1].t[1]);
    assert_false(passed[segment->tet]);
    passed[segment->tet] = true;
  }
}

TEST(rays_on_the_grid_pass_each_tet_at_most_once)
{
  random_state random = {11};
  for (int round = 0; round < 400; round++) {
    garbage made;
    garbage_create(&made, &random);
    for (int ray = 0; ray < 100; ray++) {
      double origin[3], direction[3] = {0, 0, 0};
      while (direction[0] == 0 && direction[1] == 0 && direction[2] == 0)
        for (int k = 0; k < 3; k++) direction[k] = (double)random_below(&random, 5) - 2;
      for (int k = 0; k < 3; k++) origin[k] = (double)random_below(&random, 6) - 6 * direction[k];
      check_order(&made, origin, direction);
    }
    garbage_destroy(&made);
  }
}

TEST(general_rays_pass_every_tet_that_they_meet)
{
  random_state random = {12};
  size_t cells = 0;
  for (int round = 0; round < 300; round++) {
    garbage made;
    garbage_create(&made, &random);
    cellist_transfer_knot knot = {0, 1, {1, 1, 1}};
    brute_force brute;
    brute_begin(&brute, made.scene.mesh, &made.scene.scalar, &(cellist_transfer){1, &knot});
    for (int ray = 0; ray < 40; ray++) {
      double origin[3], direction[3], total = 0;
      real expected = 0;
      for (int k = 0; k < 3; k++) {
        origin[k] = random_between(&random, -3, 8);
        direction[k] = random_between(&random, 0, 4) - origin[k];
      }
      check_order(&made, origin, direction);
      for (size_t s = 0; s < made.walker.segment_count; s++)
        total += made.walker.segments[s].t[1] - made.walker.segments[s].t[0];
      brute_collect(&brute, origin, direction, 0);
      for (size_t s = 0; s < brute.cell_count; s++) expected += brute.cells[s].t[1] - brute.cells[s].t[0];
      cells += brute.cell_count;
      assert_true(fabsl(total - expected) < 1e-11L);
      assert_int_equal(made.walker.segment_count, brute.cell_count);
    }
    brute_end(&brute);
    garbage_destroy(&made);
  }
  assert_true(cells > 20000);
}
