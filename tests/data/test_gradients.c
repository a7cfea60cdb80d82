/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients: exact for linear scalars, the least-squares solution for others, nothing where there is none. */
#include <cellist/gradients.h>
#include <math.h>
#include <stdlib.h>

#include "harness.h"

enum { POINTS = 9, TETS = 12 };

/* A cube with a point inside that two tets a side meet. */
static const uint32_t SIDES[TETS][3] = {{0, 1, 3}, {0, 3, 2}, {4, 7, 5}, {4, 6, 7}, {0, 5, 1}, {0, 4, 5},
                                        {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};

struct cube {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  double *at_points, *of_cells;
};

static void fill_cube(double points[3 * POINTS], uint32_t tets[4 * TETS]) {
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++) points[3 * i + k] = i >> k & 1;
  points[24] = 0.4, points[25] = 0.55, points[26] = 0.45;
  for (int t = 0; t < TETS; t++) {
    for (int c = 0; c < 3; c++) tets[4 * t + c] = SIDES[t][c];
    tets[4 * t + 3] = 8;
  }
}

static cellist_result open_cube(cellist_context *context, cellist_association association, const double *values,
                                struct cube *cube) {
  double points[3 * POINTS];
  uint32_t tets[4 * TETS];
  fill_cube(points, tets);
  *cube = (struct cube){.context = context};
  const cellist_field field = {"s", association, 1, values};
  const cellist_mesh_desc desc = {POINTS, points, TETS, tets, NULL, 1, &field};
  cube->at_points = malloc(3 * POINTS * sizeof(double));
  cube->of_cells = malloc(3 * TETS * sizeof(double));
  cellist_result result = cellist_mesh_create(context, &desc, &cube->mesh);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, cube->mesh, NULL, &cube->scalar);
  if (result == CELLIST_SUCCESS)
    result = cellist_gradients_at_points(context, cube->mesh, &cube->scalar, cube->at_points);
  if (result == CELLIST_SUCCESS)
    result = cellist_gradients_of_cells(context, cube->mesh, &cube->scalar, cube->of_cells);
  return result;
}

static void close_cube(struct cube *cube) {
  free(cube->at_points);
  free(cube->of_cells);
  cellist_scalar_release(cube->context, &cube->scalar);
  cellist_mesh_destroy(cube->mesh);
}

TEST(linear_scalars_have_their_slope_everywhere)
{
  cellist_context *context = harness_context(2);
  static const double slope[3] = {0.7, -1.3, 2.1};
  double points[3 * POINTS], values[POINTS];
  uint32_t tets[4 * TETS];
  fill_cube(points, tets);
  for (int i = 0; i < POINTS; i++)
    values[i] = 5 + slope[0] * points[3 * i] + slope[1] * points[3 * i + 1] + slope[2] * points[3 * i + 2];
  struct cube cube;
  assert_success(context, open_cube(context, CELLIST_ON_POINTS, values, &cube));
  for (int i = 0; i < 3 * POINTS; i++) assert_true(fabs(cube.at_points[i] - slope[i % 3]) < 1e-13);
  for (int i = 0; i < 3 * TETS; i++) assert_true(fabs(cube.of_cells[i] - slope[i % 3]) < 1e-13);
  close_cube(&cube);
  harness_context_destroy(context);
}

/* At the least-squares gradient the residuals along the edges are orthogonal to the edges. */
TEST(gradients_at_points_leave_residuals_orthogonal_to_the_edges)
{
  cellist_context *context = harness_context(1);
  random_state random = {7};
  double values[POINTS];
  for (int i = 0; i < POINTS; i++) values[i] = random_between(&random, -1, 1);
  struct cube cube;
  assert_success(context, open_cube(context, CELLIST_ON_POINTS, values, &cube));
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(cube.mesh);
  for (size_t p = 0; p < POINTS; p++) {
    bool is_neighbour[POINTS] = {false};
    for (size_t t = 0; t < TETS; t++)
      for (size_t c = 0; c < 4; c++)
        if (mesh->tets[4 * t + c] == p)
          for (size_t d = 0; d < 4; d++) is_neighbour[mesh->tets[4 * t + d]] = true;
    double sum[3] = {0};
    for (size_t q = 0; q < POINTS; q++) {
      if (!is_neighbour[q] || q == p) continue;
      double edge[3], residual = cube.scalar.values[q] - cube.scalar.values[p];
      for (size_t k = 0; k < 3; k++) {
        edge[k] = mesh->positions[3 * q + k] - mesh->positions[3 * p + k];
        residual -= cube.at_points[3 * p + k] * edge[k];
      }
      for (int k = 0; k < 3; k++) sum[k] += residual * edge[k];
    }
    for (int k = 0; k < 3; k++) assert_true(fabs(sum[k]) < 1e-13);
  }
  close_cube(&cube);
  harness_context_destroy(context);
}

TEST(nothing_spoils_gradients_but_its_own_cells)
{
  cellist_context *context = harness_context(1);
  double points[3 * POINTS], values[POINTS], on_cells[TETS];
  uint32_t tets[4 * TETS];
  fill_cube(points, tets);
  for (int i = 0; i < POINTS; i++) values[i] = 3 * points[3 * i];
  for (int i = 0; i < TETS; i++) on_cells[i] = i;
  values[0] = NAN;
  struct cube cube;
  assert_success(context, open_cube(context, CELLIST_ON_POINTS, values, &cube));
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(cube.mesh);
  for (size_t i = 0; i < 3 * POINTS; i++) {
    const bool is_lost = isnan(cube.scalar.values[i / 3]);
    assert_true(fabs(cube.at_points[i] - (i % 3 == 0 && !is_lost ? 3 : 0)) < 1e-13);
  }
  for (size_t i = 0; i < 3 * TETS; i++) {
    bool is_lost = false;
    for (size_t c = 0; c < 4; c++) is_lost = is_lost || isnan(cube.scalar.values[mesh->tets[4 * (i / 3) + c]]);
    assert_true(fabs(cube.of_cells[i] - (i % 3 == 0 && !is_lost ? 3 : 0)) < 1e-13);
  }
  close_cube(&cube);
  assert_success(context, open_cube(context, CELLIST_ON_CELLS, on_cells, &cube));
  for (int i = 0; i < 3 * POINTS; i++) assert_true(cube.at_points[i] == 0);
  for (int i = 0; i < 3 * TETS; i++) assert_true(cube.of_cells[i] == 0);
  close_cube(&cube);
  harness_context_destroy(context);
}

static cellist_result open_and_close(cellist_context *context, void *user) {
  struct cube cube;
  const cellist_result result = open_cube(context, CELLIST_ON_POINTS, user, &cube);
  close_cube(&cube);
  return result;
}

TEST(gradients_fail_cleanly_without_memory)
{
  double values[POINTS] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  check_allocation_failures(open_and_close, values);
}

TEST(gradients_refuse_the_scalar_of_another_mesh)
{
  cellist_context *context = harness_context(1);
  double values[POINTS] = {0}, gradients[3 * POINTS];
  struct cube cube;
  assert_success(context, open_cube(context, CELLIST_ON_POINTS, values, &cube));
  cellist_scalar other = cube.scalar;
  other.count--;
  assert_failure(context, cellist_gradients_at_points(context, cube.mesh, &other, gradients),
                 CELLIST_ERROR_INVALID_ARGUMENT, "values");
  assert_failure(context, cellist_gradients_of_cells(context, cube.mesh, &cube.scalar, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "NULL");
  close_cube(&cube);
  harness_context_destroy(context);
}
