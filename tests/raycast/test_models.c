/* SPDX-License-Identifier: BSD-3-Clause
 * Every optical model against brute force on a jittered grid with random scalars, some of them NaN. */
#include <math.h>

#include "brute.h"
#include "harness.h"
#include "scene.h"

enum { SIZE = 20 };

static cellist_transfer_knot KNOTS[] = {{0.1, 0, {0, 0, 1}},
                                        {0.3, 2, {0.2, 1, 0.1}},
                                        {0.3, 0.5, {1, 0, 0}},
                                        {0.55, 0.1, {0.5, 0.5, 0}},
                                        {0.9, 4, {1, 1, 0.25}}};
static const cellist_transfer TRANSFER = {5, KNOTS};

typedef struct model_case {
  kuhn_grid grid;
  cast_scene scene;
  brute_force brute;
  real *gradients;
} model_case;

/* Least squares over distinct edges, by Cramer's rule. */
static real *least_squares(const cellist_mesh_arrays *m, const double *values) {
  const size_t n = m->point_count;
  char *joined = calloc(n * n, 1);
  real *gradients = calloc(3 * n, sizeof *gradients);
  for (size_t t = 0; t < m->tet_count; t++)
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < 4; j++) joined[m->tets[4 * t + (size_t)i] * n + m->tets[4 * t + (size_t)j]] = i != j;
  for (size_t p = 0; p < n; p++) {
    real a[3][3] = {{0}}, b[3] = {0}, determinant = 0;
    for (size_t q = 0; q < n; q++) {
      if (!joined[p * n + q] || q == p || !isfinite(values[q] - values[p])) continue;
      for (size_t i = 0; i < 3; i++) {
        const real d = (real)m->positions[3 * q + i] - m->positions[3 * p + i];
        b[i] += d * ((real)values[q] - values[p]);
        for (size_t j = 0; j < 3; j++) a[i][j] += d * ((real)m->positions[3 * q + j] - m->positions[3 * p + j]);
      }
    }
    for (int i = 0; i < 3; i++)
      determinant += a[0][i] * (a[1][(i + 1) % 3] * a[2][(i + 2) % 3] - a[1][(i + 2) % 3] * a[2][(i + 1) % 3]);
    for (size_t k = 0; k < 3; k++) {
      real with[3][3], top = 0;
      memcpy(with, a, sizeof with);
      for (int i = 0; i < 3; i++) with[i][k] = b[i];
      for (int i = 0; i < 3; i++)
        top += with[0][i] * (with[1][(i + 1) % 3] * with[2][(i + 2) % 3] - with[1][(i + 2) % 3] * with[2][(i + 1) % 3]);
      gradients[3 * p + k] = determinant != 0 ? top / determinant : 0;
    }
  }
  free(joined);
  return gradients;
}

static void case_create(model_case *made, cellist_association association) {
  made->grid = kuhn_grid_create(3);
  random_state random = {9};
  for (size_t i = 0; i < 3 * made->grid.point_count; i++) made->grid.points[i] += random_between(&random, -0.2, 0.2);
  const size_t count = association == CELLIST_ON_POINTS ? made->grid.point_count : made->grid.tet_count;
  double *values = malloc(count * sizeof *values);
  for (size_t i = 0; i < count; i++) values[i] = random_unit(&random);
  values[5] = NAN;
  values[31] = INFINITY;
  scene_create(&made->scene, 2, made->grid.point_count, made->grid.points, made->grid.tet_count, made->grid.tets,
               association, values);
  free(values);
  brute_begin(&made->brute, made->scene.mesh, &made->scene.scalar, &TRANSFER);
  made->gradients =
      association == CELLIST_ON_POINTS ? least_squares(made->brute.mesh, made->scene.scalar.values) : NULL;
  made->brute.gradients = made->gradients;
}

static void case_destroy(model_case *made) {
  brute_end(&made->brute);
  free(made->gradients);
  scene_destroy(&made->scene);
  kuhn_grid_release(&made->grid);
}

static void unit(const double v[3], real out[3]) {
  const real length = sqrtl((real)v[0] * v[0] + (real)v[1] * v[1] + (real)v[2] * v[2]);
  for (int k = 0; k < 3; k++) out[k] = v[k] / length;
}

/* What the picture should be at a pixel. */
typedef void (*expectation)(brute_force *brute, const double origin[3], const double direction[3], double near_distance,
                            real rgba[4]);

static void check(model_case *made, const cellist_optics *optics, expectation expect, double tolerance) {
  const double centre[3] = {1.5, 1.5, 1.5};
  random_state random = {4};
  made->brute.optics = *optics;
  for (int round = 0; round < 4; round++) {
    cellist_view view = random_view(&random, centre, round == 3 ? 1.2 : 7);
    if (round == 2) view.near_distance = 5;
    cast_picture picture = scene_draw(&made->scene, &view, SIZE, SIZE, &TRANSFER, optics);
    double light[3], halfway[3];
    for (int k = 0; k < 3; k++) light[k] = optics->light.direction[k];
    if (light[0] == 0 && light[1] == 0 && light[2] == 0)
      for (int k = 0; k < 3; k++) light[k] = -picture.frame.forward[k];
    unit(light, made->brute.light);
    for (int k = 0; k < 3; k++) halfway[k] = (double)made->brute.light[k] - picture.frame.forward[k];
    unit(halfway, made->brute.halfway);
    double worst = 0;
    for (uint32_t i = 0; i < SIZE * SIZE; i++) {
      double origin[3], direction[3];
      real rgba[4];
      cellist_frame_ray(&picture.frame, i % SIZE + 0.5, i / SIZE + 0.5, origin, direction);
      expect(&made->brute, origin, direction, view.near_distance, rgba);
      for (int k = 0; k < 4; k++) {
        worst = fmax(worst, fabs(picture.rgba[4 * i + (size_t)k] - (double)rgba[k]));
        if (!(fabs(picture.rgba[4 * i + (size_t)k] - (double)rgba[k]) <= tolerance))
          fail_msg("round %d pixel %u channel %d: %.17g instead of %.17Lg", round, i, k,
                   picture.rgba[4 * i + (size_t)k], rgba[k]);
      }
    }
    assert_true(worst <= picture.stats.error_bound);
    picture_release(&picture);
  }
}

static const cellist_light LIGHT = {
    .enabled = true, .direction = {0.3, -1, 0.5}, .ambient = 0.2, .diffuse = 0.8, .gradient_unit = 0.6};

TEST(volume_models_match_brute_force)
{
  model_case made;
  case_create(&made, CELLIST_ON_POINTS);
  for (int model = CELLIST_MODEL_EMISSION_ABSORPTION; model <= CELLIST_MODEL_EMISSION; model++)
    check(&made, &(cellist_optics){.model = (cellist_model)model}, brute_volume, 1e-12);
  case_destroy(&made);
}

TEST(scalars_on_cells_match_brute_force)
{
  model_case made;
  case_create(&made, CELLIST_ON_CELLS);
  for (int model = CELLIST_MODEL_EMISSION_ABSORPTION; model <= CELLIST_MODEL_EMISSION; model++)
    check(&made, &(cellist_optics){.model = (cellist_model)model}, brute_volume, 1e-12);
  case_destroy(&made);
}

TEST(diffuse_light_is_integrated_exactly)
{
  model_case made;
  case_create(&made, CELLIST_ON_POINTS);
  check(&made, &(cellist_optics){.light = LIGHT}, brute_volume, 1e-11);
  check(&made, &(cellist_optics){.model = CELLIST_MODEL_EMISSION, .light = LIGHT}, brute_volume, 1e-11);
  cellist_optics headlight = {.light = LIGHT};
  for (int k = 0; k < 3; k++) headlight.light.direction[k] = 0;
  check(&made, &headlight, brute_volume, 1e-11);
  case_destroy(&made);
}

TEST(highlights_match_brute_force)
{
  model_case made;
  case_create(&made, CELLIST_ON_POINTS);
  cellist_optics optics = {.light = LIGHT};
  optics.light.specular = 0.5;
  optics.light.shininess = 12;
  check(&made, &optics, brute_volume, 1e-10);
  case_destroy(&made);
}

static void expect_isosurfaces(brute_force *brute, const double origin[3], const double direction[3],
                               double near_distance, real rgba[4]) {
  brute_collect(brute, origin, direction, near_distance);
  memset(rgba, 0, 4 * sizeof rgba[0]);
  real transmittance = 1;
  for (size_t i = 0; i < brute->cell_count; i++) {
    const brute_cell *cell = &brute->cells[i];
    real reached = -1; /* isosurfaces of one cell in the order of their places */
    for (;;) {
      real first = 2;
      size_t which = 0;
      for (size_t j = 0; j < brute->optics.iso_count; j++) {
        const real w = (brute->optics.isos[j].value - cell->scalar[0]) / (cell->scalar[1] - cell->scalar[0]);
        if (w >= 0 && w <= 1 && w > reached && w < first) {
          first = w;
          which = j;
        }
      }
      if (first > 1) break;
      reached = first;
      const cellist_isosurface *iso = &brute->optics.isos[which];
      real looked_up[4], facing = 0, square = 0, share = 1;
      brute_look_up(brute->transfer, iso->value, iso->value, looked_up);
      for (int k = 0; k < 3; k++) {
        const real g = (1 - first) * cell->gradient[0][k] + first * cell->gradient[1][k];
        facing += g * brute->light[k];
        square += g * g;
      }
      if (brute->optics.light.enabled)
        share = brute->optics.light.ambient + brute->optics.light.diffuse * fabsl(facing) / sqrtl(square);
      for (int k = 0; k < 3; k++) rgba[k] += transmittance * iso->opacity * looked_up[1 + k] * share;
      transmittance *= 1 - iso->opacity;
    }
  }
  rgba[3] = 1 - transmittance;
}

TEST(isosurfaces_are_sharp_in_order_and_lit)
{
  const cellist_isosurface isos[] = {{0.7, 0.4}, {0.25, 0.5}, {0.5, 0.3}}, opaque[] = {{0.45, 1}};
  model_case made;
  case_create(&made, CELLIST_ON_POINTS);
  cellist_optics optics = {.model = CELLIST_MODEL_ISOSURFACES, .iso_count = 3, .isos = isos};
  check(&made, &optics, expect_isosurfaces, 1e-13);
  optics.light = LIGHT;
  check(&made, &optics, expect_isosurfaces, 1e-11);
  optics.iso_count = 1;
  optics.isos = opaque;
  check(&made, &optics, expect_isosurfaces, 1e-11);
  case_destroy(&made);
}

static void expect_maximum(brute_force *brute, const double origin[3], const double direction[3], double near_distance,
                           real rgba[4]) {
  brute_collect(brute, origin, direction, near_distance);
  memset(rgba, 0, 4 * sizeof rgba[0]);
  real largest = -1, looked_up[4];
  for (size_t i = 0; i < brute->cell_count; i++)
    largest = fmaxl(largest, fmaxl(brute->cells[i].scalar[0], brute->cells[i].scalar[1]));
  if (brute->cell_count == 0) return;
  brute_look_up(brute->transfer, largest, largest, looked_up);
  for (int k = 0; k < 3; k++) rgba[k] = looked_up[1 + k];
  rgba[3] = 1;
}

TEST(maximum_shows_the_colour_of_the_largest_scalar)
{
  model_case made;
  case_create(&made, CELLIST_ON_POINTS);
  check(&made, &(cellist_optics){.model = CELLIST_MODEL_MAXIMUM}, expect_maximum, 1e-13);
  case_destroy(&made);
}

TEST(gradients_of_cells_light_flat_facets)
{
  /* A linear field: gradients of cells and of points are the same everywhere, and so are the pictures. */
  kuhn_grid grid = kuhn_grid_create(2);
  double *values = malloc(grid.point_count * sizeof *values);
  for (size_t p = 0; p < grid.point_count; p++)
    values[p] = 0.1 * grid.points[3 * p] + 0.2 * grid.points[3 * p + 1] + 0.05 * grid.points[3 * p + 2];
  cast_scene scene;
  scene_create(&scene, 1, grid.point_count, grid.points, grid.tet_count, grid.tets, CELLIST_ON_POINTS, values);
  random_state random = {6};
  const cellist_view view = random_view(&random, (const double[3]){1, 1, 1}, 5);
  cellist_optics optics = {.light = LIGHT};
  cast_picture at_points = scene_draw(&scene, &view, SIZE, SIZE, &TRANSFER, &optics);
  optics.light.cell_gradients = true;
  cast_picture in_cells = scene_draw(&scene, &view, SIZE, SIZE, &TRANSFER, &optics);
  optics.light.enabled = false;
  cast_picture unlit = scene_draw(&scene, &view, SIZE, SIZE, &TRANSFER, &optics);
  const real share = LIGHT.ambient + LIGHT.diffuse * fabsl(0.1L * 0.3L - 0.2L + 0.05L * 0.5L) /
                                         sqrtl(0.3L * 0.3L + 1 + 0.5L * 0.5L) / LIGHT.gradient_unit;
  for (size_t i = 0; i < SIZE * SIZE; i++)
    for (size_t k = 0; k < 4; k++) {
      assert_true(fabs(at_points.rgba[4 * i + k] - in_cells.rgba[4 * i + k]) < 1e-13);
      assert_true(fabs(in_cells.rgba[4 * i + k] - unlit.rgba[4 * i + k] * (k < 3 ? (double)share : 1)) < 1e-13);
    }
  picture_release(&at_points);
  picture_release(&in_cells);
  picture_release(&unlit);
  scene_destroy(&scene);
  free(values);
  kuhn_grid_release(&grid);
}
