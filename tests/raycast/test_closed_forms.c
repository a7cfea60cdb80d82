/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures by the reference caster against closed forms, 1e-12 absolute on premultiplied colour and opacity. */
#include <math.h>

#include "harness.h"
#include "oracle.h"
#include "scene.h"

/* A convex body: a ray's chord through it is known from its planes. */
struct body {
  size_t plane_count;
  real normal[64][3], offset[64];
};

static void add_plane(struct body *body, const double *a, const double *b, const double *c, const real inside[3]) {
  real u[3], v[3], *n = body->normal[body->plane_count];
  for (int k = 0; k < 3; k++) {
    u[k] = (real)b[k] - a[k];
    v[k] = (real)c[k] - a[k];
  }
  for (int k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
  real offset = n[0] * a[0] + n[1] * a[1] + n[2] * a[2];
  if (n[0] * inside[0] + n[1] * inside[1] + n[2] * inside[2] > offset) {
    for (int k = 0; k < 3; k++) n[k] = -n[k];
    offset = -offset;
  }
  body->offset[body->plane_count++] = offset;
}

/* Returns the number of rays that met the body. Compares with a scalar field s = slope . p + base inside the body, a
 * linear transfer function over 0..1 and colour from c0 to c1: the whole chord is one piece. */
static size_t compare(const cast_scene *scene, const struct body *body, const cellist_view *view, const double slope[3],
                      double base, const cellist_transfer *transfer, uint32_t size) {
  cast_picture picture = scene_draw(scene, view, size, size, transfer, NULL);
  size_t hits = 0;
  for (uint32_t i = 0; i < size * size; i++) {
    double origin[3], direction[3];
    cellist_frame_ray(&picture.frame, i % size + 0.5, i / size + 0.5, origin, direction);
    real chord[2] = {view->near_distance, HUGE_VALL}, expected[4] = {0};
    const int hit =
        oracle_chord(body->plane_count, (const real(*)[3])body->normal, body->offset, origin, direction, chord);
    if (hit) {
      hits++;
      real ends[2], extinction[2], length = 0, front, back;
      for (int k = 0; k < 3; k++) length += (real)direction[k] * direction[k];
      length = sqrtl(length) * (chord[1] - chord[0]);
      const cellist_transfer_knot *low = &transfer->knots[0], *high = &transfer->knots[transfer->knot_count - 1];
      for (int end = 0; end < 2; end++) {
        ends[end] = base;
        for (int k = 0; k < 3; k++) ends[end] += slope[k] * (origin[k] + chord[end] * direction[k]);
        extinction[end] = low->extinction + (high->extinction - (real)low->extinction) * ends[end];
      }
      oracle_weights(extinction[0] * length, extinction[1] * length, &front, &back);
      expected[3] = -expm1l(-(extinction[0] + extinction[1]) / 2 * length);
      for (int k = 0; k < 3; k++)
        expected[k] = front * (low->colour[k] + (high->colour[k] - (real)low->colour[k]) * ends[0]) +
                      back * (low->colour[k] + (high->colour[k] - (real)low->colour[k]) * ends[1]);
    }
    for (int k = 0; k < 4; k++)
      if (!(fabsl(picture.rgba[4 * i + (size_t)k] - expected[k]) <= fminl(1e-12L, picture.stats.error_bound)))
        fail_msg("pixel %u channel %d: %.17g instead of %.17Lg", i, k, picture.rgba[4 * i + (size_t)k], expected[k]);
    assert_true(fabs(picture.transmittance[i] - (double)(1 - expected[3])) <= 1e-12);
    if (hit && chord[1] - chord[0] > 1e-9L) {
      assert_true(fabs(picture.z[i] - (double)chord[0]) < 1e-10 * (1 + fabs(picture.z[i])));
      assert_true(fabs(picture.z_back[i] - (double)chord[1]) < 1e-10 * (1 + fabs(picture.z_back[i])));
      assert_true(picture.cells[i] > 0 && picture.segments[i] > 0);
    }
    if (!hit && picture.cells[i] == 0) assert_true(isinf(picture.z[i]) && picture.z_back[i] == 0);
  }
  assert_int_equal(picture.stats.fold_ray_count, 0);
  assert_true(picture.stats.error_bound < 1e-10);
  picture_release(&picture);
  return hits;
}

static struct body cube_body(double size) {
  struct body body = {.plane_count = 6};
  for (int k = 0; k < 3; k++) {
    body.normal[2 * k][k] = 1;
    body.offset[2 * k] = size;
    body.normal[2 * k + 1][k] = -1;
  }
  return body;
}

static cellist_transfer_knot LINEAR[2][2] = {{{0, 0.1, {1, 0.25, 0}}, {1, 1.7, {0, 0.5, 1}}},
                                             {{0, 1.7, {1, 0.25, 0}}, {1, 0, {0, 0.5, 1}}}};

TEST(a_slab_of_linear_extinction_growing_falling_and_constant)
{
  kuhn_grid grid = kuhn_grid_create(4);
  const struct body body = cube_body(4);
  const double slopes[][3] = {{0, 0, 0}, {0.2, 0, 0}, {-0.05, 0.1, -0.1}, {1e-13, 1e-12, -1e-13}};
  random_state random = {1};
  size_t hits = 0;
  for (size_t i = 0; i < 4; i++) {
    double *values = malloc(grid.point_count * sizeof *values);
    for (size_t p = 0; p < grid.point_count; p++) {
      values[p] = 0.5;
      for (size_t k = 0; k < 3; k++) values[p] += slopes[i][k] * (grid.points[3 * p + k] - 2);
    }
    cast_scene scene;
    scene_create(&scene, 1, grid.point_count, grid.points, grid.tet_count, grid.tets, CELLIST_ON_POINTS, values);
    const double centre[3] = {2, 2, 2}, *g = slopes[i];
    for (int round = 0; round < 12; round++) {
      cellist_view view = random_view(&random, centre, round % 4 == 3 ? 1.5 : 12); /* every fourth from inside */
      if (round % 3 == 2) view.near_distance = 1;
      const cellist_transfer transfer = {2, LINEAR[round % 2]};
      hits += compare(&scene, &body, &view, g, 0.5 - 2 * (g[0] + g[1] + g[2]), &transfer, 24);
    }
    scene_destroy(&scene);
    free(values);
  }
  kuhn_grid_release(&grid);
  assert_true(hits > 10000);
}

/* Cameras outside and inside, every third near plane through the tet. */
static void draw_tets(uint64_t seed, int count, double flatness) {
  random_state random = {seed};
  size_t hits = 0;
  for (int round = 0; round < count; round++) {
    double points[12];
    const double values[4] = {0.5, 0.5, 0.5, 0.5}, flat[3] = {0, 0, 0};
    const uint32_t tet[4] = {0, 1, 2, 3};
    for (int i = 0; i < 12; i++) points[i] = random_between(&random, -1, 1);
    for (int k = 0; k < 3; k++) /* the fourth point, close to the plane of the others */
      points[9 + k] = (1 - flatness) * (points[k] + points[3 + k] + points[6 + k]) / 3 + flatness * points[9 + k];
    struct body body = {0};
    real inside[3];
    for (int k = 0; k < 3; k++) inside[k] = ((real)points[k] + points[3 + k] + points[6 + k] + points[9 + k]) / 4;
    for (int f = 0; f < 4; f++)
      add_plane(&body, &points[3 * CELLIST_TET_FACE[f][0]], &points[3 * CELLIST_TET_FACE[f][1]],
                &points[3 * CELLIST_TET_FACE[f][2]], inside);
    cast_scene scene;
    scene_create(&scene, 1, 4, points, 1, tet, CELLIST_ON_POINTS, values);
    const double target[3] = {(double)inside[0], (double)inside[1], (double)inside[2]};
    const double distance = round % 5 == 4 ? 0.1 : 6;
    cellist_view view = random_view(&random, target, distance);
    view.fovy_degrees = distance < 1 ? 60 : 14;
    if (view.parallel_height > 0) view.parallel_height = 1.5;
    if (round % 3 == 2)
      for (int k = 0; k < 3; k++) view.near_distance = hypot(view.near_distance, view.eye[k] - target[k]);
    const cellist_transfer transfer = {2, LINEAR[0]};
    hits += compare(&scene, &body, &view, flat, 0.5, &transfer, 8);
    scene_destroy(&scene);
  }
  assert_true(hits > 5 * (size_t)count);
}

TEST(single_tets)
{ draw_tets(2, 2000, 1); }
TEST(slivers)
{ draw_tets(4, 2000, 1e-3); }

TEST(convex_polyhedra_of_constant_density)
{
  /* An icosahedron's affine images, twenty tets around their centre. */
  const double g = 1.6180339887498949;
  const double corner[12][3] = {{0, 1, g},  {0, -1, g},  {0, 1, -g}, {0, -1, -g}, {1, g, 0},  {-1, g, 0},
                                {1, -g, 0}, {-1, -g, 0}, {g, 0, 1},  {-g, 0, 1},  {g, 0, -1}, {-g, 0, -1}};
  random_state random = {3};
  size_t hits = 0;
  for (int round = 0; round < 40; round++) {
    double map[3][3], points[39] = {0}, values[13];
    for (int i = 0; i < 9; i++) map[i / 3][i % 3] = random_between(&random, -1, 1);
    for (int p = 0; p < 12; p++)
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) points[3 * p + i] += map[i][k] * corner[p][k];
    for (int p = 0; p < 13; p++) values[p] = 0.25;
    uint32_t tets[80];
    size_t tet_count = 0;
    struct body body = {0};
    const real inside[3] = {0, 0, 0};
    for (uint32_t a = 0; a < 12; a++)
      for (uint32_t b = a + 1; b < 12; b++)
        for (uint32_t c = b + 1; c < 12; c++) {
          double ab = 0, bc = 0, ca = 0; /* squared edge lengths are 4 on the icosahedron */
          for (int k = 0; k < 3; k++) {
            ab += pow(corner[a][k] - corner[b][k], 2);
            bc += pow(corner[b][k] - corner[c][k], 2);
            ca += pow(corner[c][k] - corner[a][k], 2);
          }
          if (ab > 4.1 || bc > 4.1 || ca > 4.1) continue;
          const uint32_t tet[4] = {12, a, b, c};
          memcpy(&tets[4 * tet_count++], tet, sizeof tet);
          add_plane(&body, &points[3 * a], &points[3 * b], &points[3 * c], inside);
        }
    assert_int_equal(tet_count, 20);
    cast_scene scene;
    scene_create(&scene, 1, 13, points, 20, tets, CELLIST_ON_POINTS, values);
    const double target[3] = {0, 0, 0}, flat[3] = {0, 0, 0};
    const cellist_view view = random_view(&random, target, 8);
    const cellist_transfer transfer = {2, LINEAR[1]};
    hits += compare(&scene, &body, &view, flat, 0.25, &transfer, 24);
    scene_destroy(&scene);
  }
  assert_true(hits > 4000);
}
