/* SPDX-License-Identifier: BSD-3-Clause
 * Reflex edges that count as flat: fewer cells, and an error that the complex states and that no ray exceeds. */
#define _POSIX_C_SOURCE 200809L
#include <cellist/convexify.h>
#include <cellist/generate.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "harness.h"

static cellist_mesh *sample(cellist_context *context, const char *name, size_t size) {
  const cellist_generate_desc desc = {.size = size};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_generate(context, name, &desc, &mesh));
  return mesh;
}

static cellist_mesh *shared(cellist_context *context, const char *name) {
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, shared_data(name), NULL, &mesh));
  return mesh;
}

/* How far x is inside of a facet's plane, seen from its cell on that side. */
static double depth(const cellist_complex_arrays *a, size_t facet, int side, const double x[3]) {
  const uint32_t *id = &a->planes[3 * a->facet_planes[facet]];
  const double towards = side == 0 ? 1 : -1;
  if (id[0] == CELLIST_NONE) return towards * (x[id[1]] - a->offsets[id[2]]);
  const double *p = &a->points[3 * id[0]], *q = &a->points[3 * id[1]], *r = &a->points[3 * id[2]];
  double n[3], size = 0, value = 0;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    n[k] = (q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i]);
    size += n[k] * n[k];
    value += n[k] * (x[k] - p[k]);
  }
  return towards * value / sqrt(size);
}

static double tet_depth(const cellist_mesh_arrays *m, size_t tet, const double x[3]) {
  double least = HUGE_VAL;
  for (int f = 0; f < 4; f++) {
    const uint8_t *corner = CELLIST_TET_FACE[f];
    const double *p[3];
    for (int c = 0; c < 3; c++) p[c] = &m->positions[3 * m->tets[4 * tet + corner[c]]];
    double n[3], size = 0, value = 0;
    for (int k = 0; k < 3; k++) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      n[k] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
      size += n[k] * n[k];
      value += n[k] * (x[k] - p[0][k]);
    }
    if (size > 0) least = fmin(least, -value / sqrt(size));
  }
  return least;
}

/* Along random lines through the hull: every point lies in some cell, grown by flat_distance, and never within the
 * facets' planes of two. Also that flat_distance is reached, and not exceeded, by the cells' corners. */
static void check_points(const cellist_complex *complex, const cellist_mesh *mesh, uint64_t seed) {
  const cellist_complex_arrays *a = cellist_complex_get_arrays(complex);
  const cellist_mesh_arrays *m = cellist_mesh_get_arrays(mesh);
  random_state random = {seed};
  double extent = 0;
  for (int k = 0; k < 3; k++) extent = fmax(extent, m->bounds[3 + k] - m->bounds[k]);
  const double rounding = 1e-12 * extent;
  double *inside = malloc(a->cell_count * sizeof *inside);
  enum { LINES = 12, STEPS = 15 };
  for (int line = 0; line < LINES; line++) {
    const double *from = &m->positions[3 * random_below(&random, m->point_count)];
    const double *to = &m->positions[3 * random_below(&random, m->point_count)];
    for (int step = 0; step < STEPS; step++) {
      const double t = random_unit(&random);
      double x[3];
      for (int k = 0; k < 3; k++) x[k] = from[k] + t * (to[k] - from[k]);
      for (size_t c = 0; c < a->cell_count; c++) inside[c] = c < a->tet_count ? tet_depth(m, c, x) : HUGE_VAL;
      for (size_t f = 0; f < a->facet_count; f++)
        for (int side = 0; side < 2; side++) {
          const uint32_t cell = a->facet_cells[2 * f + (size_t)side];
          if (cell == CELLIST_NONE || cell < a->tet_count) continue;
          inside[cell] = fmin(inside[cell], depth(a, f, side, x));
        }
      int sure = 0, possible = 0;
      for (size_t c = 0; c < a->cell_count; c++) {
        sure += inside[c] > rounding;
        possible += inside[c] >= -rounding - (c < a->tet_count ? 0 : a->flat_distance);
      }
      if (sure > 1 || possible < 1)
        fail_msg("line %d of seed %llu: a point in %d cells, near %d", line, (unsigned long long)seed, sure, possible);
    }
  }
  double most = 0;
  for (size_t c = a->tet_count; c < a->cell_count; c++)
    for (size_t f = 0; f < a->facet_count; f++)
      for (int side = 0; side < 2; side++) {
        if (a->facet_cells[2 * f + (size_t)side] != c) continue;
        for (size_t g = 0; g < a->facet_count; g++)
          for (uint32_t v = a->facet_starts[g];
               v < a->facet_starts[g + 1] && (a->facet_cells[2 * g] == c || a->facet_cells[2 * g + 1] == c); v++)
            most = fmax(most, -depth(a, f, side, &a->vertices[3 * a->facet_vertices[v]]));
      }
  if (!(fabs(most - a->flat_distance) <= rounding))
    fail_msg("corners stand %.17g beyond facets, not %.17g", most, a->flat_distance);
  free(inside);
}

static size_t check_flat(cellist_context *context, const cellist_mesh *mesh, cellist_exterior exterior,
                         double degrees) {
  const cellist_convexify_desc desc = {.exterior = exterior, .seed = 1, .flat_degrees = degrees};
  cellist_complex *complex = NULL;
  cellist_convexify_stats stats;
  assert_success(context, cellist_convexify(context, mesh, &desc, &complex, &stats));
  if (!cellist_complex_is_valid(context, complex, mesh)) fail_msg("%s", cellist_context_take_error(context));
  const cellist_complex_arrays *a = cellist_complex_get_arrays(complex);
  assert_true(stats.volume_error <= 1e-12);
  assert_int_equal(stats.convexity_violations, 0);
  assert_true(stats.flat_angle <= degrees && stats.flat_distance == a->flat_distance);
  assert_true((stats.flat_edges > 0) == (stats.flat_angle > 0));
  const double *bounds = cellist_mesh_get_arrays(mesh)->bounds;
  double diagonal = 0;
  for (int k = 0; k < 3; k++) diagonal += (bounds[3 + k] - bounds[k]) * (bounds[3 + k] - bounds[k]);
  assert_true(a->flat_distance <= sin(degrees * 0.017453292519943296) * sqrt(diagonal) * 1.1); /* a box is larger */
  check_points(complex, mesh, 1);
  cellist_complex_destroy(complex);
  return stats.imaginary_cells;
}

TEST(a_hole_that_is_flat_but_for_rounding_is_one_cell)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = sample(context, "tapered-cylinder", 3000);
  assert_true(check_flat(context, mesh, CELLIST_EXTERIOR_HULL, 0) > 50);
  assert_int_equal(check_flat(context, mesh, CELLIST_EXTERIOR_HULL, 1e-4), 1);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(disk_out_ref_has_no_cells_but_its_hole_and_slivers_at_its_hull)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = shared(context, "disk_out_ref.vtu");
  assert_int_equal(check_flat(context, mesh, CELLIST_EXTERIOR_HULL, 1e-6), 9);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(angles_do_not_add_up_around_balls_and_along_saddles)
{
  static const char *const names[] = {"two-spheres", "torus", "gears", "swiss-cheese"};
  cellist_context *context = harness_context(1);
  for (int i = 0; i < 4; i++) {
    cellist_mesh *mesh = sample(context, names[i], 400);
    const size_t exact = check_flat(context, mesh, CELLIST_EXTERIOR_HULL, 0);
    check_flat(context, mesh, CELLIST_EXTERIOR_HULL, 1);
    assert_true(check_flat(context, mesh, CELLIST_EXTERIOR_HULL, 10) <= exact);
    check_flat(context, mesh, CELLIST_EXTERIOR_HULL, 40);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

TEST(every_exterior_keeps_the_bound)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = shared(context, "octopus_low.vtu");
  for (int exterior = 0; exterior < 4; exterior++) check_flat(context, mesh, (cellist_exterior)exterior, 3);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(a_complex_that_understates_its_tolerance_is_not_valid)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = sample(context, "two-spheres", 400);
  const cellist_convexify_desc desc = {.flat_degrees = 20};
  cellist_complex *complex = NULL, *liar = NULL;
  assert_success(context, cellist_convexify(context, mesh, &desc, &complex, NULL));
  assert_true(cellist_complex_is_valid(context, complex, mesh));
  cellist_complex_arrays arrays = *cellist_complex_get_arrays(complex);
  assert_true(arrays.flat_distance > 0.01);
  arrays.flat_distance *= 0.5;
  assert_success(context, cellist_complex_create(context, &arrays, &liar));
  assert_false(cellist_complex_is_valid(context, liar, mesh));
  assert_non_null(strstr(cellist_context_take_error(context), "not convex"));
  arrays.flat_distance = NAN;
  cellist_complex *none = NULL;
  assert_failure(context, cellist_complex_create(context, &arrays, &none), CELLIST_ERROR_INVALID_ARGUMENT, "tolerance");
  cellist_complex_destroy(liar);
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(the_file_keeps_the_tolerance_and_is_keyed_by_it)
{
  char path[64] = "/tmp/cellist_flat_XXXXXX";
  const int handle = mkstemp(path);
  assert_true(handle >= 0);
  close(handle);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = sample(context, "two-spheres", 400);
  static const double degrees[] = {20, 20, 0, 5};
  cellist_convexify_stats stats[4];
  for (int i = 0; i < 4; i++) {
    const cellist_convexify_desc desc = {.flat_degrees = degrees[i]};
    cellist_complex *complex = NULL;
    assert_success(context, cellist_convexify_cached(context, mesh, &desc, path, &complex, &stats[i]));
    assert_int_equal(stats[i].cached, i == 1);
    assert_true(cellist_complex_get_arrays(complex)->flat_distance == stats[i].flat_distance);
    cellist_complex_destroy(complex);
  }
  assert_true(stats[0].flat_distance == stats[1].flat_distance && stats[0].flat_angle == stats[1].flat_angle);
  assert_int_equal(stats[0].flat_edges, stats[1].flat_edges);
  assert_true(stats[0].flat_distance > 0 && stats[2].flat_distance == 0);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
  remove(path);
}

TEST(angles_out_of_range_are_refused)
{
  static const double wrong[] = {-1, 90, NAN, HUGE_VAL};
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = sample(context, "l-shape", 100);
  for (int i = 0; i < 4; i++) {
    const cellist_convexify_desc desc = {.flat_degrees = wrong[i]};
    cellist_complex *complex = NULL;
    assert_failure(context, cellist_convexify(context, mesh, &desc, &complex, NULL), CELLIST_ERROR_INVALID_ARGUMENT,
                   "degrees");
    assert_null(complex);
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
