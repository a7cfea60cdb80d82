/* SPDX-License-Identifier: BSD-3-Clause
 * Where things touch: boundary faces that cover hull sides in part are subtracted from them exactly, and boundary faces
 * that touch each other in part are refused by the ids of their cells. */
#include <cellist/convexify.h>
#include <stdio.h>

#include "check_faults.h"
#include "shapes.h"

/* ---- Hull sides ---------------------------------------------------------------------------------------------- */

static void corners_of_plane(const cellist_complex_arrays *a, size_t facet, const double *p[3]) {
  for (int k = 0; k < 3; k++) p[k] = &a->points[3 * (size_t)a->planes[3 * a->facet_planes[facet] + (uint32_t)k]];
}

static bool same_plane(const double *const p[3], const double *const q[3]) {
  for (int k = 0; k < 3; k++)
    if (cellist_orient3d(p[0], p[1], p[2], q[k]) != 0) return false;
  return true;
}

/* The axis along which a plane is seen best, so that areas seen along it are compared. */
static int widest_axis(const double *const p[3]) {
  double most = 0;
  int axis = 0;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double n = fabs((p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]));
    if (n <= most) continue;
    most = n;
    axis = k;
  }
  return axis;
}

static double seen_area(const double *const *corners, size_t count, int axis) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  double sum = 0;
  for (size_t i = 1; i + 1 < count; i++)
    sum += (corners[i][x] - corners[0][x]) * (corners[i + 1][y] - corners[0][y]) -
           (corners[i][y] - corners[0][y]) * (corners[i + 1][x] - corners[0][x]);
  return fabs(sum) / 2;
}

/* The area of the hull of these points, by wrapping it. */
static double hull_area(const double *const *points, size_t count, int axis) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const double **hull = malloc((count + 1) * sizeof *hull);
  size_t corners = 0, at = 0;
  for (size_t i = 1; i < count; i++)
    if (points[i][x] < points[at][x] || (points[i][x] == points[at][x] && points[i][y] < points[at][y])) at = i;
  const size_t first = at;
  do {
    hull[corners++] = points[at];
    size_t next = at == 0 ? 1 : 0;
    for (size_t i = 0; i < count; i++) {
      const double *o = points[at], *p = points[next], *q = points[i];
      const double turn = (p[x] - o[x]) * (q[y] - o[y]) - (p[y] - o[y]) * (q[x] - o[x]);
      const double near = hypot(p[x] - o[x], p[y] - o[y]), far = hypot(q[x] - o[x], q[y] - o[y]);
      if (i != at && (turn < 0 || (turn == 0 && far > near))) next = i;
    }
    at = next;
  } while (at != first && corners <= count);
  const double area = seen_area(hull, corners, axis);
  free(hull);
  return area;
}

/* On every side of the hull: what lies on it covers it once, the tets' facets there are the boundary's faces there.
 * Coordinates are small multiples of a power of two, so all areas of input triangles are exact. Returns how many sides
 * are covered by boundary faces in part. */
static size_t check_hull_sides(const cellist_complex *complex, const cellist_mesh *mesh) {
  const cellist_complex_arrays *a = cellist_complex_get_arrays(complex);
  const cellist_mesh_arrays *m = cellist_mesh_get_arrays(mesh);
  uint8_t *done = calloc(a->facet_count + 1, 1);
  const double **corners = malloc((m->point_count + a->vertex_count + 1) * sizeof *corners);
  size_t partial = 0;
  for (size_t f = 0; f < a->facet_count; f++) {
    if (done[f] || (a->facet_cells[2 * f] != CELLIST_NONE && a->facet_cells[2 * f + 1] != CELLIST_NONE)) continue;
    const double *plane[3];
    corners_of_plane(a, f, plane);
    const int axis = widest_axis(plane);
    double of_tets = 0, of_all = 0, of_faces = 0;
    for (size_t g = f; g < a->facet_count; g++) {
      const uint32_t *cells = &a->facet_cells[2 * g], begin = a->facet_starts[g], end = a->facet_starts[g + 1];
      const double *own[3];
      corners_of_plane(a, g, own);
      if ((cells[0] != CELLIST_NONE && cells[1] != CELLIST_NONE) || !same_plane(plane, own)) continue;
      done[g] = 1;
      for (uint32_t v = begin; v < end; v++) corners[v - begin] = &a->vertices[3 * (size_t)a->facet_vertices[v]];
      const double area = seen_area(corners, end - begin, axis);
      of_all += area;
      if (cells[0] < a->tet_count || cells[1] < a->tet_count) of_tets += area;
    }
    for (size_t t = 0; t < m->tet_count; t++)
      for (size_t k = 0; k < 4; k++) {
        const double *face[3];
        for (int c = 0; c < 3; c++) face[c] = &m->positions[3 * (size_t)m->tets[4 * t + CELLIST_TET_FACE[k][c]]];
        if (m->neighbours[4 * t + k] == CELLIST_NONE && same_plane(plane, face)) of_faces += seen_area(face, 3, axis);
      }
    size_t count = 0;
    for (size_t i = 0; i < m->point_count; i++)
      if (cellist_orient3d(plane[0], plane[1], plane[2], &m->positions[3 * i]) == 0)
        corners[count++] = &m->positions[3 * i];
    const double whole = hull_area(corners, count, axis);
    if (of_tets != of_faces) fail_msg("facets of tets on a hull side cover %.17g, not %.17g", of_tets, of_faces);
    if (!(fabs(of_all - whole) <= 1e-12 * whole)) fail_msg("a hull side of %.17g is covered by %.17g", whole, of_all);
    partial += of_faces > 0 && of_faces < whole;
  }
  free(corners);
  free(done);
  return partial;
}

/* With cubes in a lattice, points that belong to no cube would count: there are none, as every cube has its own. */
static size_t check_shape(cellist_context *context, shape s, cellist_exterior exterior) {
  cellist_mesh *mesh = NULL;
  s.unmerged = true;
  assert_success(context, shape_mesh(context, &s, &mesh));
  const cellist_convexify_desc desc = {.exterior = exterior, .seed = 1};
  cellist_complex *complex = NULL;
  assert_success(context, cellist_convexify(context, mesh, &desc, &complex, NULL));
  if (!cellist_complex_is_valid(context, complex, mesh)) fail_msg("%s", cellist_context_take_error(context));
  const size_t partial = check_hull_sides(complex, mesh);
  check_faults(complex, mesh, 10, 1);
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  return partial;
}

TEST(boundary_faces_are_subtracted_from_hull_sides_exactly)
{
  static const cellist_exterior exteriors[] = {CELLIST_EXTERIOR_HULL, CELLIST_EXTERIOR_GRID, CELLIST_EXTERIOR_DELAUNAY};
  cellist_context *context = harness_context(1);
  for (int e = 0; e < 3; e++)
    for (int sheared = 0; sheared < 2; sheared++) {
      const double shear = sheared ? 0.125 : 0;
      const shape l = {.size = {2, 2, 1}, .cubes = "###.", .shear = shear};
      assert_true(check_shape(context, l, exteriors[e]) >= 2); /* below and above */
      const shape spires = {
          .size = {5, 5, 2}, .cubes = "##########################...#.....#.#.....#.#...#", .shear = shear};
      assert_true(check_shape(context, spires, exteriors[e]) >= 1);
    }
  size_t partial = 0;
  for (uint64_t seed = 1; seed <= 12; seed++) {
    random_state random = {seed};
    char cubes[36];
    for (int i = 0; i < 36; i++) cubes[i] = random_below(&random, 100) < 60 ? '#' : '.';
    cubes[0] = '#';
    const shape s = {.size = {4, 3, 3}, .cubes = cubes, .shear = seed % 2 == 0 ? 0.25 : 0};
    partial += check_shape(context, s, exteriors[seed % 3]);
  }
  assert_true(partial > 12);
  harness_context_destroy(context);
}

/* ---- Contacts that are refused ------------------------------------------------------------------------------- */

/* Two boxes, each with points of its own; cell ids from 100 and from 200. */
static cellist_result two_boxes(cellist_context *context, const double bounds[2][6], cellist_mesh **mesh) {
  static const int path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  double points[48];
  uint32_t tets[48], origin[12];
  for (uint32_t b = 0; b < 2; b++) {
    for (uint32_t i = 0; i < 8; i++)
      for (uint32_t k = 0; k < 3; k++) points[3 * (8 * b + i) + k] = bounds[b][(i >> k & 1) * 3 + k];
    for (uint32_t t = 0; t < 6; t++) {
      uint32_t corner = 0, *tet = &tets[4 * (6 * b + t)];
      tet[0] = 8 * b;
      for (int k = 0; k < 3; k++) tet[1 + k] = 8 * b + (corner |= 1u << path[t][k]);
      origin[6 * b + t] = 100 * (b + 1) + t;
    }
  }
  const cellist_mesh_desc desc = {
      .point_count = 16, .positions = points, .tet_count = 12, .tets = tets, .tet_origin = origin};
  return cellist_mesh_create(context, &desc, mesh);
}

/* Takes the mesh. */
static void check_refused(cellist_context *context, cellist_mesh *mesh) {
  for (int exterior = 0; exterior < 4; exterior++) {
    const cellist_convexify_desc desc = {.exterior = (cellist_exterior)exterior};
    cellist_complex *complex = NULL;
    assert_int_equal(cellist_convexify(context, mesh, &desc, &complex, NULL), CELLIST_ERROR_GEOMETRY);
    assert_null(complex);
    const char *message = cellist_context_take_error(context);
    unsigned a = 0, b = 0;
    if (sscanf(message, "boundary faces of cells %u and %u cross, or touch", &a, &b) != 2 || a / 100 + b / 100 != 3)
      fail_msg("not of one cell of each box: %s", message);
  }
  cellist_mesh_destroy(mesh);
}

TEST(partial_contacts_are_refused_by_the_ids_of_both_cells)
{
  static const double contacts[][2][6] = {
      {{0, 0, 0, 2, 2, 1}, {0, 0, 1, 1, 1, 2}}, /* a T-junction: the smaller box in a corner of the larger one's side */
      {{0, 0, 0, 2, 2, 1}, {1, 1, 1, 3, 3, 2}}, /* sides that overlap in part */
      {{0, 0, 0, 4, 4, 1}, {1, 1, 1, 2, 2, 2}}, /* a side inside another one */
      {{0, 0, 0, 2, 1, 1}, {1, 1, 1, 3, 2, 2}}, /* edges that overlap in part */
      {{0, 0, 0, 4, 1, 1}, {1, 1, 1, 2, 2, 2}}, /* an edge inside another one */
      {{0, 0, 0, 2, 2, 1}, {1, 2, 0, 2, 4, 1}}, /* half a side against half a side, corners in common */
      {{0, 0, 0, 2, 2, 2}, {2, 1, 1, 4, 3, 3}}, /* corners inside sides */
      {{0, 0, 0, 1, 2, 2}, {1, 2, 1, 3, 3, 3}}, /* a corner inside an edge */
  };
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  for (size_t i = 0; i < sizeof contacts / sizeof *contacts; i++) {
    assert_success(context, two_boxes(context, contacts[i], &mesh));
    check_refused(context, mesh);
  }
  harness_context_destroy(context);
}

/* The tip of one tet inside a face, inside an edge of another one, or not. */
TEST(tips_that_touch_a_face_or_an_edge_are_refused)
{
  static const double tips[][3] = {{1, 1, 0}, {2, 0, 0}, {1, 1, 0x1p-30}};
  static const uint32_t tets[] = {0, 1, 2, 3, 4, 5, 6, 7}, origin[] = {100, 200};
  cellist_context *context = harness_context(1);
  for (int i = 0; i < 3; i++) {
    double points[24] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, -4, 0, 0, 0, 0, -1, 5, 3, -1, 5, 0, 3, 5};
    memcpy(&points[12], tips[i], sizeof tips[i]);
    const cellist_mesh_desc desc = {
        .point_count = 8, .positions = points, .tet_count = 2, .tets = tets, .tet_origin = origin};
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_mesh_create(context, &desc, &mesh));
    if (i < 2) {
      check_refused(context, mesh);
      continue;
    }
    cellist_complex *complex = NULL;
    assert_success(context, cellist_convexify(context, mesh, NULL, &complex, NULL));
    if (!cellist_complex_is_valid(context, complex, mesh)) fail_msg("%s", cellist_context_take_error(context));
    check_faults(complex, mesh, 20, 1);
    cellist_complex_destroy(complex);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

/* What touches in whole faces, whole edges and corners needs no refusal. */
TEST(whole_contacts_are_filled)
{
  static const double contacts[][2][6] = {
      {{0, 0, 0, 2, 2, 1}, {0, 0, 1, 2, 2, 3}}, /* a side */
      {{0, 0, 0, 2, 1, 1}, {0, 1, 1, 2, 3, 2}}, /* an edge */
      {{0, 0, 0, 1, 1, 1}, {1, 1, 1, 3, 2, 4}}, /* a corner */
      {{0, 0, 0, 1, 1, 1}, {2, 0, 0, 3, 1, 1}}, /* nothing */
  };
  cellist_context *context = harness_context(1);
  for (size_t i = 0; i < sizeof contacts / sizeof *contacts; i++)
    for (int exterior = 0; exterior < 4; exterior++) {
      cellist_mesh *mesh = NULL;
      assert_success(context, two_boxes(context, contacts[i], &mesh));
      const cellist_convexify_desc desc = {.exterior = (cellist_exterior)exterior};
      cellist_complex *complex = NULL;
      assert_success(context, cellist_convexify(context, mesh, &desc, &complex, NULL));
      if (!cellist_complex_is_valid(context, complex, mesh)) fail_msg("%s", cellist_context_take_error(context));
      check_faults(complex, mesh, 20, i);
      cellist_complex_destroy(complex);
      cellist_mesh_destroy(mesh);
    }
  harness_context_destroy(context);
}
