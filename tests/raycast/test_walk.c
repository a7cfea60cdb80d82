/* SPDX-License-Identifier: BSD-3-Clause
 * The walk on rays that meet vertices, edges and faces exactly, on flat cells, folds, pieces and nested cells. */
#include <math.h>

#include "../../project/raycast/reference_walk.h"
#include "harness.h"
#include "scene.h"

static const walk_limits WHOLE_RAY = {.t = {0, HUGE_VAL}};

typedef struct walk_setup {
  cast_scene scene;
  face_hierarchy hierarchy;
  ray_walker walker;
} walk_setup;

static void setup_create(walk_setup *setup, size_t point_count, const double *points, size_t tet_count,
                         const uint32_t *tets) {
  double *values = calloc(point_count, sizeof *values);
  for (size_t i = 0; i < point_count; i++) values[i] = points[3 * i] + 2 * points[3 * i + 1] + 4 * points[3 * i + 2];
  scene_create(&setup->scene, 1, point_count, points, tet_count, tets, CELLIST_ON_POINTS, values);
  free(values);
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(setup->scene.mesh);
  assert_success(setup->scene.context, hierarchy_build(setup->scene.context, mesh, &setup->hierarchy));
  setup->walker = (ray_walker){
      .context = setup->scene.context, .mesh = mesh, .scalar = &setup->scene.scalar, .hierarchy = &setup->hierarchy};
}

static void setup_destroy(walk_setup *setup) {
  walk_release(&setup->walker);
  hierarchy_release(setup->scene.context, &setup->hierarchy);
  scene_destroy(&setup->scene);
}

/* Shoots the ray; its segments must follow one another, and the scalar must be that of setup_create's linear field.
 * Returns their total extent in t, and whether they are without a gap in *connected. */
static double shoot(walk_setup *setup, const double origin[3], const double direction[3], double near_distance,
                    bool *connected) {
  ray_walker *walker = &setup->walker;
  const walk_limits limits = {.t = {near_distance, HUGE_VAL}};
  assert_true(walk_ray(walker, origin, direction, &limits));
  double total = 0;
  *connected = true;
  for (size_t i = 0; i < walker->segment_count; i++) {
    const walk_segment *segment = &walker->segments[i];
    assert_true(segment->t[1] > segment->t[0] && segment->t[0] >= near_distance);
    for (int end = 0; end < 2; end++) {
      double expected = 0;
      for (int k = 0; k < 3; k++) expected += (1 << k) * (origin[k] + segment->t[end] * direction[k]);
      assert_true(fabs(segment->scalar[end] - expected) < 1e-11);
    }
    if (i > 0) {
      assert_true(segment->t[0] >= walker->segments[i - 1].t[1] - 1e-12);
      *connected = *connected && segment->t[0] <= walker->segments[i - 1].t[1] + 1e-12;
    }
    total += segment->t[1] - segment->t[0];
  }
  return total;
}

/* The extent in t of the ray inside the cube 0..n; *grazes if it lies in the cube's surface. */
static double extent_in_cube(double n, const double origin[3], const double direction[3], double near_distance,
                             bool *grazes) {
  double low = near_distance, high = HUGE_VAL;
  *grazes = false;
  for (int k = 0; k < 3; k++) {
    if (direction[k] == 0) {
      *grazes = *grazes || origin[k] == 0 || origin[k] == n;
      if (origin[k] < 0 || origin[k] > n) return 0;
      continue;
    }
    const double a = (0 - origin[k]) / direction[k], b = (n - origin[k]) / direction[k];
    low = fmax(low, fmin(a, b));
    high = fmin(high, fmax(a, b));
  }
  return fmax(0, high - low);
}

static void check_cube_ray(walk_setup *setup, double n, const double origin[3], const double direction[3],
                           double near_distance) {
  bool connected, grazes;
  const double total = shoot(setup, origin, direction, near_distance, &connected);
  const double expected = extent_in_cube(n, origin, direction, near_distance, &grazes);
  const bool as_expected = fabs(total - expected) < 1e-12 && connected && setup->walker.entry_count <= 1;
  if (!as_expected && !(grazes && total == 0))
    fail_msg("ray from %g %g %g along %g %g %g: %.17g of %.17g", origin[0], origin[1], origin[2], direction[0],
             direction[1], direction[2], total, expected);
}

TEST(rays_through_vertices_along_edges_and_in_faces_of_a_grid)
{
  enum { N = 3 };
  kuhn_grid grid = kuhn_grid_create(N);
  walk_setup setup;
  setup_create(&setup, grid.point_count, grid.points, grid.tet_count, grid.tets);
  random_state random = {1};
  for (int round = 0; round < 20000; round++) {
    /* Through two points of the lattice of halves: vertices, edges, face diagonals, cell diagonals and face interiors
     * all lie on it. The origin is exact, outside, inside or on the far side. */
    double from[3], direction[3], origin[3];
    bool same = true;
    const double back = (double)random_below(&random, 4) - 1;
    for (int k = 0; k < 3; k++) {
      from[k] = 0.5 * (double)random_below(&random, 2 * N + 1);
      direction[k] = 0.5 * (double)random_below(&random, 2 * N + 1) - from[k];
      same = same && direction[k] == 0;
      origin[k] = from[k] - back * direction[k];
    }
    if (!same) check_cube_ray(&setup, N, origin, direction, 0);
  }
  assert_true(setup.walker.retry_count > 10000);
  setup_destroy(&setup);
  kuhn_grid_release(&grid);
}

TEST(an_eye_on_a_vertex_edge_or_face_sees_all_that_lies_ahead)
{
  enum { N = 2 };
  kuhn_grid grid = kuhn_grid_create(N);
  walk_setup setup;
  setup_create(&setup, grid.point_count, grid.points, grid.tet_count, grid.tets);
  random_state random = {2};
  for (int round = 0; round < 5000; round++) {
    double origin[3], direction[3];
    for (int k = 0; k < 3; k++) {
      origin[k] = 0.5 * (double)random_below(&random, 2 * N + 1);
      direction[k] = random_between(&random, -1, 1);
    }
    check_cube_ray(&setup, N, origin, direction, round % 2 ? 0 : 0.25);
  }
  setup_destroy(&setup);
  kuhn_grid_release(&grid);
}

TEST(nearly_degenerate_rays_agree_with_the_exact_ones)
{
  /* A sheared, displaced grid whose coordinates are not dyadic: products round, and the filter must know it. */
  enum { N = 3 };
  kuhn_grid grid = kuhn_grid_create(N);
  for (size_t p = 0; p < grid.point_count; p++) {
    double *x = &grid.points[3 * p];
    x[0] = 0.1 * x[0] + 0.01 * x[1] + 1000.3;
    x[1] = 0.1 * x[1] - 0.02 * x[2] - 7.7;
    x[2] = 0.1 * x[2] + 0.3;
  }
  walk_setup setup;
  setup_create(&setup, grid.point_count, grid.points, grid.tet_count, grid.tets);
  const cellist_mesh_arrays *mesh = setup.walker.mesh;
  random_state random = {3};
  size_t inside = 0;
  for (int round = 0; round < 4000; round++) {
    const size_t inner = random_below(&random, mesh->point_count);
    const double *a = &mesh->positions[3 * random_below(&random, mesh->point_count)], *b = &mesh->positions[3 * inner];
    double direction[3], origin[3], moved[3];
    const uint32_t at = mesh->point_origin[inner], side = N + 1;
    const uint32_t place[3] = {at % side, at / side % side, at / side / side};
    bool is_inside = a != b; /* a ray through it does not run along the surface */
    for (int k = 0; k < 3; k++) is_inside = is_inside && place[k] > 0 && place[k] < N;
    if (!is_inside) continue;
    for (int k = 0; k < 3; k++) {
      direction[k] = b[k] - a[k];
      origin[k] = a[k] - 20 * direction[k];
      moved[k] = origin[k] + 1e-7 * random_between(&random, -1, 1);
    }
    ray_walker *walker = &setup.walker;
    double total[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
      assert_true(walk_ray(walker, i ? moved : origin, direction, &WHOLE_RAY));
      for (size_t s = 0; s < walker->segment_count; s++) {
        total[i] += walker->segments[s].t[1] - walker->segments[s].t[0];
        assert_true(s == 0 || walker->segments[s].t[0] == walker->segments[s - 1].t[1]);
      }
    }
    inside++;
    assert_true(total[0] > 0 && fabs(total[0] - total[1]) < 1e-4);
  }
  assert_true(inside > 300);
  setup_destroy(&setup);
  kuhn_grid_release(&grid);
}

TEST(flat_cells_are_passed_and_contribute_nothing)
{
  /* A square as a flat tet between two pairs of tets; rays across it, exactly in its plane, and along its diagonal. */
  const double points[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 1, 0.5, 0.5, -1};
  const uint32_t tets[] = {0, 1, 2, 4, 0, 2, 3, 4, 0, 1, 3, 5, 1, 2, 3, 5, 0, 1, 2, 3};
  walk_setup setup;
  setup_create(&setup, 6, points, 5, tets);
  const double rays[][6] = {{0.5, 0.5, 3, 0, 0, -1},  {0.25, 0.5, 3, 0, 0, -1}, {0.3, 0.4, 3, 0.1, 0, -1},
                            {-2, 0.5, 0, 1, 0, 0},    {-2, 0.25, 0, 1, 0, 0},   {-1, -1, 0, 1, 1, 0},
                            {-1, 0.5, 0.25, 1, 0, 0}, {0.5, 0.5, -3, 0, 0, 1},  {2, -1, 0, -1, 1, 0}};
  const double expected[] = {2, 1, -1, 1, 1, 1, 0.75, 2, 1};
  for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
    bool connected;
    const double total = shoot(&setup, &rays[i][0], &rays[i][3], 0, &connected);
    assert_true(connected && setup.walker.entry_count == 1);
    if (expected[i] >= 0) assert_true(fabs(total - expected[i]) < 1e-14);
    for (size_t s = 0; s < setup.walker.segment_count; s++)
      assert_true((setup.walker.mesh->tet_flags[setup.walker.segments[s].tet] & CELLIST_TET_FLAT) == 0);
  }
  assert_int_equal(setup.walker.fold_ray_count, 0);
  setup_destroy(&setup);
}

TEST(pieces_holes_and_nested_parts_are_entered_again)
{
  /* Three of the 5^3 cubes' layers: a shell of cubes with a cube floating in its cavity, and gaps between. */
  kuhn_grid grid = kuhn_grid_create(5);
  size_t kept = 0;
  for (uint32_t t = 0; t < grid.tet_count; t++) {
    const uint32_t cube = t / 6, c[3] = {cube % 5, cube / 5 % 5, cube / 25};
    int distance = 0; /* from the centre, in cubes */
    for (int k = 0; k < 3; k++) distance = abs((int)c[k] - 2) > distance ? abs((int)c[k] - 2) : distance;
    if (distance == 1) continue;
    memmove(&grid.tets[4 * kept++], &grid.tets[4 * t], 4 * sizeof(uint32_t));
  }
  walk_setup setup;
  setup_create(&setup, grid.point_count, grid.points, kept, grid.tets);
  random_state random = {4};
  for (int round = 0; round < 4000; round++) {
    double origin[3], direction[3];
    for (int k = 0; k < 3; k++) {
      origin[k] = round % 2 ? random_between(&random, 0, 5) : random_between(&random, -10, 15);
      direction[k] = random_between(&random, 0, 5) - origin[k];
    }
    bool connected, grazes;
    const double outer = extent_in_cube(5, origin, direction, 0, &grazes);
    double shifted[3], core[3];
    for (int k = 0; k < 3; k++) {
      shifted[k] = origin[k] - 1;
      core[k] = origin[k] - 2;
    }
    const double expected =
        outer - extent_in_cube(3, shifted, direction, 0, &grazes) + extent_in_cube(1, core, direction, 0, &grazes);
    assert_true(fabs(shoot(&setup, origin, direction, 0, &connected) - expected) < 1e-11);
  }
  assert_int_equal(setup.walker.fold_ray_count, 0);
  setup_destroy(&setup);
  kuhn_grid_release(&grid);
}

TEST(overlapping_cells_end_and_are_counted)
{
  /* Two grids, one displaced into the other; and a fold: two tets on the same side of a face. */
  kuhn_grid grid = kuhn_grid_create(2);
  double *points = malloc(6 * grid.point_count * sizeof *points);
  uint32_t *tets = malloc(8 * grid.tet_count * sizeof *tets);
  for (size_t i = 0; i < 3 * grid.point_count; i++) {
    points[i] = grid.points[i];
    points[3 * grid.point_count + i] = grid.points[i] + 0.7;
  }
  for (size_t i = 0; i < 4 * grid.tet_count; i++) {
    tets[i] = grid.tets[i];
    tets[4 * grid.tet_count + i] = grid.tets[i] + (uint32_t)grid.point_count;
  }
  walk_setup setup;
  setup_create(&setup, 2 * grid.point_count, points, 2 * grid.tet_count, tets);
  const double through_both[] = {-3, 1, 1}, along[] = {1, 0, 0}, through_one[] = {-3, 0.5, 0.5};
  assert_true(walk_ray(&setup.walker, through_both, along, &WHOLE_RAY));
  assert_int_equal(setup.walker.fold_ray_count, 1);
  double total = 0;
  for (size_t s = 0; s < setup.walker.segment_count; s++) {
    const walk_segment *segment = &setup.walker.segments[s];
    total += segment->t[1] - segment->t[0];
    assert_true(s == 0 || segment->t[0] + segment->t[1] >= segment[-1].t[0] + segment[-1].t[1]);
  }
  assert_true(fabs(total - 4) < 1e-12);
  assert_true(walk_ray(&setup.walker, through_one, along, &WHOLE_RAY));
  assert_int_equal(setup.walker.fold_ray_count, 1);
  setup_destroy(&setup);
  free(points);
  free(tets);
  kuhn_grid_release(&grid);

  const double fold_points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.2, 0.2, 2};
  const uint32_t fold_tets[] = {0, 1, 2, 3, 0, 1, 2, 4};
  setup_create(&setup, 5, fold_points, 2, fold_tets);
  const double below[] = {0.2, 0.2, -1}, up[] = {0, 0, 1};
  assert_true(walk_ray(&setup.walker, below, up, &WHOLE_RAY));
  assert_int_equal(setup.walker.fold_ray_count, 1);
  assert_int_equal(setup.walker.segment_count, 2);
  setup_destroy(&setup);
}

/* Shoots rays through pairs of vertices of a real mesh, a third of them along its edges, and the same rays displaced by
 * a small amount as line.h displaces them by an infinitesimal one. */
static void compare_with_small_shift(const char *name) {
  const char *path = shared_data(name);
  walk_setup setup = {.scene = {.context = harness_context(1)}};
  cellist_context *context = setup.scene.context;
  assert_success(context, cellist_mesh_read(context, path, NULL, &setup.scene.mesh));
  assert_success(context, cellist_scalar_select(context, setup.scene.mesh, NULL, &setup.scene.scalar));
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(setup.scene.mesh);
  assert_success(context, hierarchy_build(context, mesh, &setup.hierarchy));
  setup.walker =
      (ray_walker){.context = context, .mesh = mesh, .scalar = &setup.scene.scalar, .hierarchy = &setup.hierarchy};
  ray_walker *walker = &setup.walker;
  double size = 0;
  for (int k = 0; k < 3; k++) size = fmax(size, mesh->bounds[3 + k] - mesh->bounds[k]);
  random_state random = {7};
  int differing = 0;
  enum { RAYS = 3000 };
  for (int round = 0; round < RAYS; round++) {
    const uint32_t *tet = &mesh->tets[4 * random_below(&random, mesh->tet_count)];
    const size_t a = tet[0], b = round % 3 ? random_below(&random, mesh->point_count) : tet[1];
    double origin[3], direction[3], total[2] = {0, 0};
    if (a == b) continue;
    for (size_t k = 0; k < 3; k++) {
      direction[k] = mesh->positions[3 * b + k] - mesh->positions[3 * a + k];
      origin[k] = mesh->positions[3 * a + k] - (round % 2 ? 0 : 64) * direction[k];
    }
    for (int displaced = 0; displaced < 2; displaced++) {
      assert_true(walk_ray(walker, origin, direction, &WHOLE_RAY));
      for (size_t s = 0; s < walker->segment_count; s++)
        total[displaced] += walker->segments[s].t[1] - walker->segments[s].t[0];
      origin[walker->line.x] += 1e-7 * size;
      origin[walker->line.y] += 1e-11 * size;
    }
    const double length = hypot(hypot(direction[0], direction[1]), direction[2]);
    differing += fabs(total[0] - total[1]) * length > 1e-4 * size;
  }
  assert_int_equal(walker->fold_ray_count, 0);
  assert_true(walker->retry_count > RAYS);
  /* Cells thinner than the small shift may tell the two apart. */
  assert_true(differing <= RAYS / 100);
  setup_destroy(&setup);
}

TEST(rays_through_vertices_and_along_edges_of_spx)
{ compare_with_small_shift("spx.vtu"); }
TEST(rays_through_vertices_and_along_edges_of_torus_vt)
{ compare_with_small_shift("torus_vt.vtu"); }
TEST(rays_through_vertices_and_along_edges_of_gears_t)
{ compare_with_small_shift("gears_t.vtu"); }
