/* SPDX-License-Identifier: BSD-3-Clause
 * Mesh: orientation, adjacency, order and the way back to the user's ids. */
#include <cellist/mesh.h>
#include <cellist/predicates.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

/* Points 0..4: a tet and a fifth point that mirrors point 3 in the plane of 0, 1, 2. */
static const double POINTS[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1};

static cellist_mesh *make(cellist_context *context, size_t tet_count, const uint32_t *tets) {
  const cellist_mesh_desc desc = {.point_count = 5, .positions = POINTS, .tet_count = tet_count, .tets = tets};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  return mesh;
}

TEST(two_tets_of_either_orientation_are_neighbours)
{
  const uint32_t tets[] = {0, 1, 2, 3, 0, 1, 2, 4}; /* the second is inverted */
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = make(context, 2, tets);
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  assert_int_equal(facts->inverted_count, 1);
  assert_int_equal(facts->boundary_face_count, 6);
  assert_int_equal(facts->folded_face_count, 0);
  int links = 0;
  for (size_t i = 0; i < 2; i++)
    for (size_t k = 0; k < 4; k++) links += arrays->neighbours[4 * i + k] == 1 - i;
  assert_int_equal(links, 2);
  assert_int_equal(arrays->tet_flags[arrays->tet_origin[0] == 1 ? 0 : 1], CELLIST_TET_INVERTED);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(folds_and_faces_of_three_tets_stay_boundary)
{
  cellist_context *context = harness_context(1);
  const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.2, 0.2, 2, 0, 0, -1};
  const uint32_t tets[] = {0, 1, 2, 3, 0, 1, 2, 4, 0, 1, 2, 5};
  cellist_mesh_desc desc = {.point_count = 6, .positions = points, .tet_count = 2, .tets = tets};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  assert_int_equal(cellist_mesh_get_facts(mesh)->folded_face_count, 1);
  assert_int_equal(cellist_mesh_get_facts(mesh)->boundary_face_count, 8);
  cellist_mesh_destroy(mesh);
  desc.tet_count = 3;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  assert_int_equal(cellist_mesh_get_facts(mesh)->overfull_face_count, 1);
  assert_int_equal(cellist_mesh_get_facts(mesh)->boundary_face_count, 12);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(flat_tet_between_two_sound_ones_links_both)
{
  /* A square 0 1 2 3 in the plane z = 0 as a flat tet, one tet above and one below each of two of its faces. */
  const double points[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 1, 0.5, 0.5, -1};
  const uint32_t flat[2][4] = {{0, 1, 2, 3}, {1, 0, 2, 3}};
  cellist_context *context = harness_context(1);
  for (int turn = 0; turn < 2; turn++) {
    uint32_t tets[20] = {0, 1, 2, 4, 0, 2, 3, 4, 0, 1, 3, 5, 1, 2, 3, 5};
    memcpy(&tets[16], flat[turn], sizeof flat[turn]);
    const cellist_mesh_desc desc = {.point_count = 6, .positions = points, .tet_count = 5, .tets = tets};
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_mesh_create(context, &desc, &mesh));
    const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
    assert_int_equal(facts->flat_count, 1);
    assert_int_equal(facts->folded_face_count, 0);
    assert_int_equal(facts->boundary_face_count, 8);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

/* A Kuhn grid of n^3 cubes, every other tet given inverted, with fields that say where each point and tet came from. */
struct grid {
  size_t point_count, tet_count;
  double *points, *point_values, *tet_values;
  uint32_t *tets;
};

static struct grid make_grid(uint32_t n) {
  static const uint8_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  struct grid grid = {(size_t)(n + 1) * (n + 1) * (n + 1), (size_t)6 * n * n * n, NULL, NULL, NULL, NULL};
  grid.points = calloc(grid.point_count, 3 * sizeof(double));
  grid.point_values = calloc(grid.point_count, sizeof(double));
  grid.tet_values = calloc(grid.tet_count, 2 * sizeof(double));
  grid.tets = calloc(grid.tet_count, 4 * sizeof(uint32_t));
  const uint32_t step[3] = {1, n + 1, (n + 1) * (n + 1)};
  for (uint32_t i = 0; i < grid.point_count; i++) {
    for (int k = 0; k < 3; k++) grid.points[3 * i + (uint32_t)k] = i / step[k] % (n + 1);
    grid.point_values[i] = i;
  }
  for (uint32_t t = 0; t < grid.tet_count; t++) {
    const uint32_t cube = t / 6, x = cube % n, y = cube / n % n, z = cube / n / n;
    uint32_t at = x * step[0] + y * step[1] + z * step[2];
    for (uint32_t c = 0; c < 4; c++) {
      grid.tets[4 * t + c] = at;
      if (c < 3) at += step[path[t % 6][c]];
    }
    grid.tet_values[2 * t] = t;
    grid.tet_values[2 * t + 1] = -2.0 * t;
  }
  return grid;
}

static cellist_result create_grid_mesh(cellist_context *context, void *user) {
  struct grid *grid = user;
  const cellist_field fields[2] = {{"where", CELLIST_ON_POINTS, 1, grid->point_values},
                                   {"which", CELLIST_ON_CELLS, 2, grid->tet_values}};
  const cellist_mesh_desc desc = {grid->point_count, grid->points, grid->tet_count, grid->tets, NULL, 2, fields};
  cellist_mesh *mesh = NULL;
  cellist_result result = cellist_mesh_create(context, &desc, &mesh);
  if (result != CELLIST_SUCCESS) return result;
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  for (size_t i = 0; i < a->point_count; i++) {
    assert_true(a->fields[0].values[i] == a->point_origin[i]);
    assert_memory_equal(&a->positions[3 * i], &grid->points[3 * a->point_origin[i]], 3 * sizeof(double));
  }
  for (size_t t = 0; t < a->tet_count; t++) {
    const uint32_t origin = a->tet_origin[t];
    assert_true(a->fields[1].values[2 * t] == origin && a->fields[1].values[2 * t + 1] == -2.0 * origin);
    for (size_t k = 0; k < 4; k++) {
      const uint32_t point = a->point_origin[a->tets[4 * t + k]];
      const uint32_t *v = &grid->tets[4 * (size_t)origin];
      assert_true(point == v[0] || point == v[1] || point == v[2] || point == v[3]);
      const uint32_t other = a->neighbours[4 * t + k];
      if (other == CELLIST_NONE) continue;
      int back = 0; /* the neighbour links back, and exactly three points are shared */
      int shared = 0;
      for (size_t j = 0; j < 4; j++) {
        back += a->neighbours[4 * (size_t)other + j] == t;
        for (size_t c = 0; c < 4; c++) shared += c != k && a->tets[4 * (size_t)other + j] == a->tets[4 * t + c];
      }
      assert_int_equal(back, 1);
      assert_int_equal(shared, 3);
    }
    const double *p = a->positions;
    const uint32_t *v = &a->tets[4 * t];
    assert_int_equal(cellist_orient3d(&p[3 * v[0]], &p[3 * v[1]], &p[3 * v[2]], &p[3 * v[3]]), 1);
  }
  const size_t n = (size_t)llround(cbrt((double)grid->tet_count / 6));
  assert_int_equal(cellist_mesh_get_facts(mesh)->boundary_face_count, 12 * n * n);
  assert_int_equal(cellist_mesh_get_facts(mesh)->inverted_count, grid->tet_count / 2);
  cellist_scalar scalar;
  result = cellist_scalar_select(context, mesh, "which:1", &scalar);
  if (result == CELLIST_SUCCESS) {
    assert_true(scalar.minimum == -2.0 * (double)(grid->tet_count - 1) && scalar.maximum == 0);
    cellist_scalar_release(context, &scalar);
  }
  cellist_mesh_destroy(mesh);
  return result;
}

static void release_grid(struct grid *grid) {
  free(grid->points);
  free(grid->point_values);
  free(grid->tet_values);
  free(grid->tets);
}

TEST(a_grid_keeps_its_fields_and_links_all_its_faces)
{
  for (unsigned workers = 1; workers <= 3; workers++) {
    struct grid grid = make_grid(9);
    cellist_context *context = harness_context(workers);
    assert_success(context, create_grid_mesh(context, &grid));
    harness_context_destroy(context);
    release_grid(&grid);
  }
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  struct grid grid = make_grid(2);
  check_allocation_failures(create_grid_mesh, &grid);
  release_grid(&grid);
}

TEST(bad_ids_and_coordinates_are_named)
{
  cellist_context *context = harness_context(1);
  double points[15];
  memcpy(points, POINTS, sizeof points);
  uint32_t tets[] = {0, 1, 2, 3, 0, 1, 2, 7};
  const uint32_t origin[] = {40, 41};
  const cellist_mesh_desc desc = {
      .point_count = 5, .positions = points, .tet_count = 2, .tets = tets, .tet_origin = origin};
  cellist_mesh *mesh = NULL;
  assert_failure(context, cellist_mesh_create(context, &desc, &mesh), CELLIST_ERROR_INVALID_ARGUMENT,
                 "cell 41 uses point 7");
  tets[7] = 1;
  assert_failure(context, cellist_mesh_create(context, &desc, &mesh), CELLIST_ERROR_INVALID_ARGUMENT,
                 "cell 41 uses a point twice");
  tets[7] = 4;
  points[9] = NAN;
  assert_failure(context, cellist_mesh_create(context, &desc, &mesh), CELLIST_ERROR_GEOMETRY,
                 "cell 40 uses point 3 at (nan");
  assert_null(mesh);
  harness_context_destroy(context);
}

TEST(repair_leaves_out_cells_that_cannot_be)
{
  cellist_context *context = harness_context(1);
  double points[15];
  memcpy(points, POINTS, sizeof points);
  points[14] = INFINITY;
  const uint32_t tets[] = {0, 1, 2, 4, 0, 1, 2, 3, 1, 1, 2, 3, 2, 2, 2, 3};
  const uint32_t origin[] = {40, 41, 42, 42};
  const double values[] = {1, 2, 3, 4};
  const cellist_field field = {"v", CELLIST_ON_CELLS, 1, values};
  const cellist_mesh_desc desc = {5, points, 4, tets, origin, 1, &field};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create_repaired(context, &desc, &mesh));
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  assert_true(arrays->tet_count == 1 && arrays->tet_origin[0] == 41 && arrays->fields[0].values[0] == 2);
  assert_true(facts->infinite_cell_count == 1 && facts->infinite_cells[0] == 40);
  assert_true(facts->collapsed_cell_count == 1 && facts->collapsed_cells[0] == 42);
  assert_true(facts->unused_point_count == 1 && arrays->bounds[5] == 1);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(a_mesh_without_cells_is_a_mesh)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = make(context, 0, NULL);
  assert_int_equal(cellist_mesh_get_arrays(mesh)->tet_count, 0);
  assert_int_equal(cellist_mesh_get_facts(mesh)->unused_point_count, 5);
  cellist_scalar scalar;
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scalar));
  assert_string_equal(scalar.name, "none");
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(scalars_are_chosen_by_name_component_and_magnitude)
{
  cellist_context *context = harness_context(1);
  const uint32_t tets[] = {0, 1, 2, 3, 0, 1, 2, 4};
  const double velocity[] = {3, 4, 0, 0, 0, 0, 0, 0, NAN, 0, 0, 0, 1, 1, 1};
  const double pressure[] = {7, 9};
  const cellist_field fields[] = {{"pressure", CELLIST_ON_CELLS, 1, pressure},
                                  {"velocity", CELLIST_ON_POINTS, 3, velocity}};
  const cellist_mesh_desc desc = {5, POINTS, 2, tets, NULL, 2, fields};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  cellist_scalar scalar;
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scalar));
  assert_string_equal(scalar.name, "velocity");
  assert_true(scalar.maximum == 5 && scalar.nan_cell_count == 2);
  cellist_scalar_release(context, &scalar);
  assert_success(context, cellist_scalar_select(context, mesh, "velocity:1", &scalar));
  assert_true(scalar.maximum == 4 && scalar.nan_cell_count == 0);
  cellist_scalar_release(context, &scalar);
  assert_success(context, cellist_scalar_select(context, mesh, "pressure", &scalar));
  assert_true(scalar.minimum == 7 && scalar.maximum == 9 && scalar.association == CELLIST_ON_CELLS);
  cellist_scalar_release(context, &scalar);
  assert_failure(context, cellist_scalar_select(context, mesh, "density", &scalar), CELLIST_ERROR_NOT_FOUND,
                 "no scalar 'density'; there are: pressure (cells, 1 component), velocity (points, 3 components)");
  assert_failure(context, cellist_scalar_select(context, mesh, "velocity:3", &scalar), CELLIST_ERROR_NOT_FOUND,
                 "components 0 to 2");
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
