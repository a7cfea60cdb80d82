/* SPDX-License-Identifier: BSD-3-Clause
 * Shapes of cubes: concave, in pieces, with holes, cavities and islands, touching themselves. Cell counts are known for
 * the simple ones; for all of them volumes must add up, cells be convex and rays cross them end to end. */
#include <cellist/convexify.h>
#include <cellist/generate.h>

#include "check_faults.h"
#include "harness.h"
#include "shapes.h"

static const shape CUBE = {.size = {2, 2, 2}, .cubes = "########"};
static const shape L = {.size = {2, 2, 1}, .cubes = "###."};
static const shape U = {.size = {3, 2, 1}, .cubes = "####.#"};
static const shape RING = {.size = {3, 3, 1}, .cubes = "####.####"};
static const shape CAVITY = {.size = {3, 3, 3}, .cubes = "#############.#############"};
static const shape APART = {.size = {3, 1, 1}, .cubes = "#.#"};
static const shape AT_EDGE = {.size = {2, 2, 1}, .cubes = "#..#"};
static const shape AT_CORNER = {.size = {2, 2, 2}, .cubes = "#......#"};
static const shape STAIRS = {.size = {3, 3, 1}, .cubes = "#####.#.."};
static const shape TEETH = {.size = {7, 2, 1}, .cubes = "########.#.#.#"};
static const shape FRAME = {.size = {3, 3, 3}, .cubes = "####.#####.#...#.#####.####"};
/* A shell of 5 cubes a side with a cube in its middle: an island in a cavity. */
static const shape ISLAND = {.size = {5, 5, 5},
                             .cubes =
                                 "#########################"
                                 "######...##...##...######"
                                 "######...##.#.##...######"
                                 "######...##...##...######"
                                 "#########################"};
/* The same with the island and a tunnel out, and one with two islands, one cube apart. */
static const shape TUNNEL = {.size = {5, 5, 5},
                             .cubes =
                                 "############.############"
                                 "######...##...##...######"
                                 "######...##.#.##...######"
                                 "######...##...##...######"
                                 "#########################"};
static const shape TWO_ISLANDS = {.size = {7, 3, 5},
                                  .cubes =
                                      "#####################"
                                      "########.....########"
                                      "########.....########"
                                      "########.....########"
                                      "#####################"};
static const shape SPIRES = {.size = {5, 5, 2}, .cubes = "##########################...#.....#.#.....#.#...#"};

static void check(const shape *s, cellist_exterior exterior, size_t cells) {
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, shape_mesh(context, s, &mesh));
  for (uint64_t seed = 1; seed <= 3; seed++) {
    const cellist_convexify_desc desc = {.exterior = exterior, .seed = seed};
    cellist_complex *complex = NULL;
    cellist_convexify_stats stats;
    assert_success(context, cellist_convexify(context, mesh, &desc, &complex, &stats));
    if (!cellist_complex_is_valid(context, complex, mesh)) fail_msg("%s", cellist_context_take_error(context));
    assert_true(stats.volume_error <= 1e-12);
    assert_int_equal(stats.convexity_violations, 0);
    if (cells != SIZE_MAX) assert_int_equal(stats.imaginary_cells, cells);
    check_faults(complex, mesh, 40, seed);
    cellist_complex_destroy(complex);
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(a_convex_mesh_needs_no_cells)
{ check(&CUBE, CELLIST_EXTERIOR_HULL, 0); }
TEST(an_l_needs_one_cell)
{ check(&L, CELLIST_EXTERIOR_HULL, 1); }
TEST(a_u_needs_one_cell)
{ check(&U, CELLIST_EXTERIOR_HULL, 1); }
TEST(a_ring_needs_one_cell)
{ check(&RING, CELLIST_EXTERIOR_HULL, 1); }
TEST(a_cavity_is_one_cell)
{ check(&CAVITY, CELLIST_EXTERIOR_HULL, 1); }
TEST(two_cubes_apart_need_one_cell)
{ check(&APART, CELLIST_EXTERIOR_HULL, 1); }
TEST(cubes_that_share_an_edge_need_two_cells)
{ check(&AT_EDGE, CELLIST_EXTERIOR_HULL, 2); }
TEST(cubes_that_share_a_corner_are_filled)
{ check(&AT_CORNER, CELLIST_EXTERIOR_HULL, SIZE_MAX); }
TEST(stairs_need_two_cells)
{ check(&STAIRS, CELLIST_EXTERIOR_HULL, 2); }
TEST(gaps_between_teeth_are_cells)
{ check(&TEETH, CELLIST_EXTERIOR_HULL, 3); }
TEST(a_frame_of_beams_is_filled)
{ check(&FRAME, CELLIST_EXTERIOR_HULL, 5); }
TEST(an_island_in_a_cavity_is_found)
{ check(&ISLAND, CELLIST_EXTERIOR_HULL, SIZE_MAX); }
TEST(an_island_behind_a_tunnel_is_found)
{ check(&TUNNEL, CELLIST_EXTERIOR_HULL, SIZE_MAX); }
TEST(a_long_cavity_is_one_cell)
{ check(&TWO_ISLANDS, CELLIST_EXTERIOR_HULL, 1); }
TEST(spires_that_touch_a_hull_side_are_filled)
{ check(&SPIRES, CELLIST_EXTERIOR_HULL, SIZE_MAX); }

TEST(a_box_is_filled_around_every_shape)
{
  check(&CUBE, CELLIST_EXTERIOR_BOX, SIZE_MAX);
  check(&U, CELLIST_EXTERIOR_BOX, SIZE_MAX);
  check(&APART, CELLIST_EXTERIOR_BOX, SIZE_MAX);
  check(&AT_EDGE, CELLIST_EXTERIOR_BOX, SIZE_MAX);
  check(&AT_CORNER, CELLIST_EXTERIOR_BOX, SIZE_MAX);
  check(&ISLAND, CELLIST_EXTERIOR_BOX, SIZE_MAX);
}

TEST(a_grid_cuts_first)
{
  check(&CUBE, CELLIST_EXTERIOR_GRID, 0);
  check(&U, CELLIST_EXTERIOR_GRID, SIZE_MAX);
  check(&ISLAND, CELLIST_EXTERIOR_GRID, SIZE_MAX);
  check(&SPIRES, CELLIST_EXTERIOR_GRID, SIZE_MAX);
}

TEST(tetgen_fills_every_shape_or_cutting_does)
{
  check(&CUBE, CELLIST_EXTERIOR_DELAUNAY, 0);
  check(&U, CELLIST_EXTERIOR_DELAUNAY, SIZE_MAX);
  check(&AT_EDGE, CELLIST_EXTERIOR_DELAUNAY, SIZE_MAX);
  check(&AT_CORNER, CELLIST_EXTERIOR_DELAUNAY, SIZE_MAX);
  check(&ISLAND, CELLIST_EXTERIOR_DELAUNAY, SIZE_MAX);
  check(&TUNNEL, CELLIST_EXTERIOR_DELAUNAY, SIZE_MAX);
}

/* Many sticks in a circle, with sides so thin that rounding cannot tell their widest triangle; so thin, too, that
 * cellist_complex_is_valid, which measures in doubles, finds no plane in some. */
TEST(sides_as_thin_as_rounding_are_filled)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  const cellist_generate_desc generate = {.size = 172, .seed = 364795};
  assert_success(context, cellist_generate(context, "cyclic", &generate, &mesh));
  const cellist_convexify_desc desc = {.exterior = CELLIST_EXTERIOR_HULL, .seed = 1};
  cellist_complex *complex = NULL;
  cellist_convexify_stats stats;
  assert_success(context, cellist_convexify(context, mesh, &desc, &complex, &stats));
  assert_true(stats.volume_error <= 1e-12);
  assert_int_equal(stats.convexity_violations, 0);
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* Each cube has points of its own: seams in full contact part cells, but bound no exterior. */
TEST(unmerged_seams_become_facets)
{
  shape u = U;
  u.unmerged = true;
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, shape_mesh(context, &u, &mesh));
  cellist_complex *complex = NULL;
  cellist_convexify_stats stats;
  assert_success(context, cellist_convexify(context, mesh, NULL, &complex, &stats));
  assert_int_equal(stats.imaginary_cells, 1);
  const cellist_complex_arrays *a = cellist_complex_get_arrays(complex);
  size_t seams = 0;
  for (size_t f = 0; f < a->facet_count; f++)
    seams += a->facet_cells[2 * f] < a->tet_count && a->facet_cells[2 * f + 1] < a->tet_count;
  assert_int_equal(seams, 8); /* four contacts of two triangles */
  if (!cellist_complex_is_valid(context, complex, mesh)) fail_msg("%s", cellist_context_take_error(context));
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(far_from_the_origin_and_at_any_scale)
{
  shape s = STAIRS;
  s.scale = 0x1p-10;
  s.offset[0] = 1e7;
  s.offset[2] = -1e7;
  check(&s, CELLIST_EXTERIOR_HULL, SIZE_MAX);
  const double scales[] = {1e-20, 1e20};
  for (int i = 0; i < 2; i++) {
    s = TUNNEL;
    s.scale = scales[i];
    cellist_context *context = harness_context(1);
    cellist_mesh *mesh = NULL;
    assert_success(context, shape_mesh(context, &s, &mesh));
    cellist_complex *complex = NULL;
    cellist_convexify_stats stats;
    assert_success(context, cellist_convexify(context, mesh, NULL, &complex, &stats));
    assert_true(stats.volume_error <= 1e-12 && stats.convexity_violations == 0);
    if (!cellist_complex_is_valid(context, complex, mesh)) fail_msg("%s", cellist_context_take_error(context));
    cellist_complex_destroy(complex);
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
}

/* Random cubes: every kind of contact along edges and at corners. */
TEST(random_cubes_are_filled)
{
  for (uint64_t seed = 1; seed <= 25; seed++) {
    random_state random = {seed};
    char cubes[64];
    for (int i = 0; i < 64; i++) cubes[i] = random_below(&random, 100) < 20 + 2 * seed ? '#' : '.';
    cubes[0] = '#';
    const shape s = {.size = {4, 4, 4}, .cubes = cubes};
    check(&s, (cellist_exterior)(seed % 4), SIZE_MAX);
  }
}

/* The same out of all alignment: nothing is coplanar, every flat side becomes many slightly reflex edges. */
TEST(random_cubes_out_of_line_are_filled)
{
  for (uint64_t seed = 1; seed <= 12; seed++) {
    random_state random = {seed};
    char cubes[27];
    for (int i = 0; i < 27; i++) cubes[i] = random_below(&random, 100) < 20 + 5 * seed ? '#' : '.';
    cubes[0] = '#';
    const shape s = {.size = {3, 3, 3}, .cubes = cubes, .jitter = seed % 2 == 0 ? 0.1 : 1e-9, .seed = seed};
    check(&s, (cellist_exterior)(seed / 2 % 4), SIZE_MAX);
  }
}

/* A complex whose planes are off by rounding alone. */
TEST(planes_that_are_not_those_of_faces_are_not_valid)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  shape l = L;
  l.jitter = 0.1;
  l.seed = 5;
  assert_success(context, shape_mesh(context, &l, &mesh));
  cellist_complex *complex = NULL;
  assert_success(context, cellist_convexify(context, mesh, NULL, &complex, NULL));
  assert_true(cellist_complex_is_valid(context, complex, mesh));
  cellist_complex_arrays a = *cellist_complex_get_arrays(complex);
  double *points = malloc((3 * a.point_count + 3) * sizeof *points);
  uint32_t *planes = malloc(3 * a.plane_count * sizeof *planes);
  memcpy(points, a.points, 3 * a.point_count * sizeof *points);
  a.points = points;
  size_t wrong = 0;
  for (size_t f = 0; f < a.facet_count; f++) {
    if (a.facet_cells[2 * f] >= a.tet_count && a.facet_cells[2 * f + 1] >= a.tet_count) continue;
    memcpy(planes, cellist_complex_get_arrays(complex)->planes, 3 * a.plane_count * sizeof *planes);
    uint32_t *plane = &planes[3 * a.facet_planes[f]];
    for (int k = 0; k < 3; k++) points[3 * a.point_count + (size_t)k] = nextafter(points[3 * plane[0] + (size_t)k], 9);
    plane[0] = (uint32_t)a.point_count;
    cellist_complex_arrays off = a;
    off.planes = planes;
    off.point_count++;
    cellist_complex *moved = NULL;
    assert_success(context, cellist_complex_create(context, &off, &moved));
    if (!cellist_complex_is_valid(context, moved, mesh)) {
      wrong++;
      assert_non_null(strstr(cellist_context_take_error(context), "face of its tet"));
    }
    cellist_complex_destroy(moved);
  }
  assert_true(wrong > a.facet_count / 4); /* a point may move within its plane */
  free(points);
  free(planes);
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(flat_tets_alone_bound_nothing)
{
  static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  static const uint32_t tets[] = {0, 1, 2, 3};
  cellist_context *context = harness_context(1);
  const cellist_mesh_desc desc = {.point_count = 4, .positions = points, .tet_count = 1, .tets = tets};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  cellist_complex *complex = NULL;
  cellist_convexify_stats stats;
  assert_success(context, cellist_convexify(context, mesh, NULL, &complex, &stats));
  assert_int_equal(stats.imaginary_cells, 0);
  assert_true(cellist_complex_is_valid(context, complex, mesh));
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

static cellist_result convexify_tunnel(cellist_context *context, void *user) {
  cellist_mesh *mesh = NULL;
  cellist_complex *complex = NULL;
  cellist_result result = shape_mesh(context, user, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_convexify(context, mesh, NULL, &complex, NULL);
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(flawed_meshes_get_a_verdict_that_names_cells)
{
  /* Two tets that cross; one tet within another. */
  static const double crossing[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4, 1, 1, -1, 5, 1, -1, 1, 5, -1, 1, 1, 3};
  static const double nested[] = {0, 0, 0, 40, 0, 0, 0, 40, 0, 0, 0, 40, 1, 1, 1, 5, 1, 1, 1, 5, 1, 1, 1, 5};
  static const uint32_t tets[] = {0, 1, 2, 3, 4, 5, 6, 7};
  static const uint32_t origin[] = {70, 71};
  cellist_context *context = harness_context(1);
  for (int flaw = 0; flaw < 2; flaw++) {
    const cellist_mesh_desc desc = {.point_count = 8,
                                    .positions = flaw == 0 ? crossing : nested,
                                    .tet_count = 2,
                                    .tets = tets,
                                    .tet_origin = origin};
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_mesh_create(context, &desc, &mesh));
    cellist_complex *complex = NULL;
    assert_failure(context, cellist_convexify(context, mesh, NULL, &complex, NULL), CELLIST_ERROR_GEOMETRY,
                   flaw == 0 ? "cells 7" : "cell 71 lies inside other cells");
    assert_null(complex);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

struct watch {
  long left, calls; /* left: calls until the one that cancels; 0: none does */
  double last;
  bool in_order;
};

static bool watch_progress(void *user, const char *stage, double fraction) {
  struct watch *watch = user;
  if (strcmp(stage, "convexifying") != 0) return true;
  watch->in_order &= fraction >= watch->last && fraction <= 1;
  watch->last = fraction;
  watch->calls++;
  return watch->left == 0 || --watch->left > 0;
}

/* One convexification, cancelled at call left of the progress function; 0: at none. While TetGen works there are as
 * many calls as it takes time: such a call may never come. */
static struct watch convexify_watched(const shape *s, cellist_exterior exterior, long left) {
  struct watch watch = {.left = left, .in_order = true};
  const cellist_context_desc desc = {.progress = watch_progress, .progress_user = &watch};
  cellist_context *context = NULL;
  assert_int_equal(cellist_context_create(&desc, &context), CELLIST_SUCCESS);
  cellist_mesh *mesh = NULL;
  assert_success(context, shape_mesh(context, s, &mesh));
  const cellist_convexify_desc how = {.exterior = exterior};
  cellist_complex *complex = NULL;
  const cellist_result result = cellist_convexify(context, mesh, &how, &complex, NULL);
  if (left == 0 || (exterior == CELLIST_EXTERIOR_DELAUNAY && watch.left > 0)) {
    assert_success(context, result);
  } else {
    assert_failure(context, result, CELLIST_ERROR_CANCELLED, "cancelled");
    assert_null(complex);
  }
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  return watch;
}

TEST(progress_goes_from_nothing_to_all_and_every_step_may_cancel)
{
  for (int exterior = 0; exterior < 4; exterior++) {
    const struct watch whole = convexify_watched(&TUNNEL, (cellist_exterior)exterior, 0);
    assert_true(whole.in_order && whole.last == 1 && whole.calls >= 5);
    for (long call = 1; call <= whole.calls; call++) {
      const long calls = convexify_watched(&TUNNEL, (cellist_exterior)exterior, call).calls;
      assert_true(exterior == CELLIST_EXTERIOR_DELAUNAY ? calls <= call : calls == call);
    }
  }
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  shape s = STAIRS;
  check_allocation_failures(convexify_tunnel, &s);
}
