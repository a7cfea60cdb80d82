/* SPDX-License-Identifier: BSD-3-Clause
 * Validation against brute force on grids with random holes, single flaws by hand, and real meshes. */
#include <cellist/predicates.h>
#include <cellist/validate.h>
#include <math.h>
#include <src/triangle_pair.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

static const double PI = 3.14159265358979323846;

static cellist_report validate(cellist_context *context, const cellist_mesh *mesh) {
  cellist_report report;
  assert_success(context, cellist_validate(context, mesh, NULL, &report));
  return report;
}

static cellist_report validate_arrays(cellist_context *context, cellist_mesh_desc desc) {
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  const cellist_report report = validate(context, mesh);
  cellist_mesh_destroy(mesh);
  return report;
}

/* Fails the case unless exactly these kinds (bits) were found. */
static void assert_kinds(const cellist_report *report, unsigned expected) {
  for (int kind = 0; kind < CELLIST_FINDING_COUNT; kind++)
    if ((report->findings[kind].count > 0) != (expected >> kind & 1))
      fail_msg("'%s' is %zu", cellist_finding_name(kind), report->findings[kind].count);
}

#define KIND(name) (1u << CELLIST_FINDING_##name)

/* ---- A grid of cubes, six tets each, that loses tets at random -------------------------------------- */

enum { SIDE = 4, POINTS = (SIDE + 1) * (SIDE + 1) * (SIDE + 1), TETS = 6 * SIDE * SIDE * SIDE };

struct holed_grid {
  double positions[3 * POINTS];
  uint32_t all[4 * TETS], tets[4 * TETS];
  bool is_there[TETS];
  size_t tet_count;
};

static void grid_create(struct holed_grid *grid, random_state *random, double perturb, unsigned percent_missing) {
  static const uint8_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  static const uint32_t step[3] = {1, SIDE + 1, (SIDE + 1) * (SIDE + 1)};
  for (uint32_t i = 0; i < POINTS; i++)
    for (uint32_t k = 0; k < 3; k++) {
      const uint32_t at = i / step[k] % (SIDE + 1);
      const double move = at == 0 || at == SIDE ? 0 : perturb * random_between(random, -1, 1);
      grid->positions[3 * i + k] = at + move;
    }
  grid->tet_count = 0;
  for (uint32_t t = 0; t < TETS; t++) {
    const uint32_t cube = t / 6;
    uint32_t at = cube % SIDE * step[0] + cube / SIDE % SIDE * step[1] + cube / SIDE / SIDE * step[2];
    for (uint32_t c = 0; c < 4; c++) {
      grid->all[4 * t + c] = at;
      if (c < 3) at += step[path[t % 6][c]];
    }
    if (path[t % 6][1] != (path[t % 6][0] + 1) % 3) { /* an odd path: turn the tet */
      const uint32_t old = grid->all[4 * t + 1];
      grid->all[4 * t + 1] = grid->all[4 * t + 2];
      grid->all[4 * t + 2] = old;
    }
    grid->is_there[t] = random_below(random, 100) >= percent_missing;
    if (grid->is_there[t]) memcpy(&grid->tets[4 * grid->tet_count++], &grid->all[4 * t], 4 * sizeof *grid->all);
  }
}

static int shared_points(const uint32_t *a, const uint32_t *b) {
  int shared = 0;
  for (int i = 0; i < 16; i++) shared += a[i / 4] == b[i % 4];
  return shared;
}

static size_t find(size_t *parent, size_t i) {
  while (parent[i] != i) i = parent[i];
  return i;
}

/* Parts of the grid, and holes in it that no path of missing tets leads out of. */
static void count_parts(const struct holed_grid *grid, size_t *parts, size_t *holes) {
  size_t parent[TETS + 1]; /* the last one is outside */
  for (size_t i = 0; i <= TETS; i++) parent[i] = i;
  for (size_t a = 0; a < TETS; a++) {
    int faces = 0;
    for (size_t b = 0; b < TETS; b++) {
      if (shared_points(&grid->all[4 * a], &grid->all[4 * b]) != 3) continue;
      faces++;
      if (grid->is_there[a] == grid->is_there[b]) parent[find(parent, a)] = find(parent, b);
    }
    if (faces < 4 && !grid->is_there[a]) parent[find(parent, a)] = find(parent, TETS);
  }
  *parts = *holes = 0;
  for (size_t i = 0; i < TETS; i++) {
    *parts += grid->is_there[i] && parent[i] == i;
    *holes += !grid->is_there[i] && parent[i] == i && find(parent, TETS) != i;
  }
}

/* All around an edge: the angles that tets fill, from which the gaps follow. */
static void judge_edge(const struct holed_grid *grid, uint32_t a, uint32_t b, size_t *gap_count, size_t *reflex_count) {
  const double *p = &grid->positions[3 * a], *q = &grid->positions[3 * b];
  double axis[3], u[3] = {0}, v[3];
  for (int k = 0; k < 3; k++) axis[k] = q[k] - p[k];
  const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  const int least =
      fabs(axis[0]) < fabs(axis[1]) ? (fabs(axis[0]) < fabs(axis[2]) ? 0 : 2) : (fabs(axis[1]) < fabs(axis[2]) ? 1 : 2);
  u[least] = 1;
  for (int k = 0; k < 3; k++) u[k] -= axis[least] * axis[k] / (length * length);
  for (int k = 0; k < 3; k++) v[k] = (axis[(k + 1) % 3] * u[(k + 2) % 3] - axis[(k + 2) % 3] * u[(k + 1) % 3]) / length;
  double begin[64], end[64]; /* of tets, end - begin < 180 degrees */
  size_t count = 0;
  for (size_t t = 0; t < grid->tet_count; t++) {
    const uint32_t *tet = &grid->tets[4 * t];
    double angle[2];
    int others = 0;
    for (int c = 0; c < 4; c++) {
      if (tet[c] == a || tet[c] == b) continue;
      double x = 0, y = 0;
      for (int k = 0; k < 3; k++) {
        x += u[k] * (grid->positions[3 * tet[c] + (uint32_t)k] - p[k]);
        y += v[k] * (grid->positions[3 * tet[c] + (uint32_t)k] - p[k]);
      }
      if (others < 2) angle[others] = atan2(y, x);
      others++;
    }
    if (others != 2) continue;
    const double turn = fmod(angle[1] - angle[0] + 2 * PI, 2 * PI);
    begin[count] = turn < PI ? angle[0] : angle[1];
    end[count] = begin[count] + (turn < PI ? turn : 2 * PI - turn);
    count++;
  }
  *gap_count = *reflex_count = 0;
  for (size_t i = 0; i < count; i++) { /* from the end of each tet to the next beginning */
    double next = 2 * PI;
    for (size_t j = 0; j < count; j++) {
      double gap = fmod(begin[j] - end[i] + 4 * PI, 2 * PI);
      if (gap > 2 * PI - 1e-9) gap = 0;
      next = fmin(next, gap);
    }
    *gap_count += next > 1e-9;
    *reflex_count += next > 1e-9 && next < PI - 1e-9;
  }
}

/* Fans of boundary faces at a point, joined where they share an edge there. faces: [3 count]. */
static size_t count_fans(const uint32_t *faces, size_t count, uint32_t point) {
  size_t parent[256], own[256], own_count = 0, fans = 0;
  for (size_t f = 0; f < count; f++)
    if (faces[3 * f] == point || faces[3 * f + 1] == point || faces[3 * f + 2] == point) own[own_count++] = f;
  for (size_t i = 0; i < own_count; i++) parent[i] = i;
  for (size_t i = 0; i < own_count; i++)
    for (size_t j = 0; j < i; j++) {
      int shared = 0;
      for (int m = 0; m < 9; m++) shared += faces[3 * own[i] + (size_t)m / 3] == faces[3 * own[j] + (size_t)m % 3];
      if (shared >= 2) parent[find(parent, i)] = find(parent, j);
    }
  for (size_t i = 0; i < own_count; i++) fans += parent[i] == i;
  return fans;
}

TEST(grids_with_holes_match_brute_force)
{
  random_state random = {91};
  static const unsigned missing[] = {0, 2, 10, 30, 60, 90};
  size_t holes_seen = 0, edges_seen = 0, vertices_seen = 0;
  for (int round = 0; round < 18; round++) {
    struct holed_grid grid;
    grid_create(&grid, &random, 0.12, missing[round % 6]);
    cellist_context *context = harness_context(1);
    const cellist_report report = validate_arrays(
        context,
        (cellist_mesh_desc){
            .point_count = POINTS, .positions = grid.positions, .tet_count = grid.tet_count, .tets = grid.tets});
    harness_context_destroy(context);
    assert_int_equal(report.flaw_count, 0);

    size_t parts, holes;
    count_parts(&grid, &parts, &holes);
    assert_int_equal(report.component_count, parts);
    assert_int_equal(report.cavity_count, holes);

    static uint32_t faces[12 * TETS];
    size_t face_count = 0;
    for (size_t t = 0; t < grid.tet_count; t++)
      for (int k = 0; k < 4; k++) {
        uint32_t face[4];
        for (int c = 0; c < 3; c++) face[c] = grid.tets[4 * t + CELLIST_TET_FACE[k][c]];
        face[3] = face[0];
        int users = 0;
        for (size_t other = 0; other < grid.tet_count; other++)
          users += shared_points(face, &grid.tets[4 * other]) == 4;
        if (users == 1) memcpy(&faces[3 * face_count++], face, 3 * sizeof *face);
      }
    assert_int_equal(report.boundary_face_count, face_count);

    size_t bad_edges = 0, reflex = 0, bad_vertices = 0;
    for (uint32_t a = 0; a < POINTS; a++) {
      for (uint32_t b = a + 1; b < POINTS; b++) {
        size_t gaps, reflex_here;
        judge_edge(&grid, a, b, &gaps, &reflex_here);
        bad_edges += gaps > 1;
        reflex += reflex_here;
      }
      bad_vertices += count_fans(faces, face_count, a) > 1;
    }
    assert_int_equal(report.nonmanifold_edge_count, bad_edges);
    assert_int_equal(report.nonmanifold_vertex_count, bad_vertices);
    assert_int_equal(report.reflex_edge_count, reflex);
    assert_int_equal(report.is_convex, missing[round % 6] == 0);
    holes_seen += holes;
    edges_seen += bad_edges;
    vertices_seen += bad_vertices;
  }
  assert_true(holes_seen > 10 && edges_seen > 10 && vertices_seen > 10);
}

/* ---- Contacts against all pairs --------------------------------------------------------------------- */

TEST(contacts_of_a_soup_match_all_pairs)
{
  enum { COUNT = 150 };
  random_state random = {17};
  for (int round = 0; round < 6; round++) {
    double positions[12 * COUNT];
    uint32_t tets[4 * COUNT];
    const bool is_coarse = round % 2 == 0; /* corners on a small grid: contacts of all kinds */
    for (size_t t = 0; t < COUNT; t++) {
      double centre[3];
      for (int k = 0; k < 3; k++) centre[k] = random_between(&random, 0, 8);
      for (size_t c = 0; c < 4; c++) {
        tets[4 * t + c] = (uint32_t)(4 * t + c);
        for (size_t k = 0; k < 3; k++) {
          const double x = centre[k] + random_between(&random, -1.5, 1.5);
          positions[12 * t + 3 * c + k] = is_coarse ? floor(x) : x;
        }
      }
    }
    cellist_context *context = harness_context(1);
    const cellist_mesh_desc desc = {
        .point_count = (size_t)4 * COUNT, .positions = positions, .tet_count = COUNT, .tets = tets};
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_mesh_create(context, &desc, &mesh));
    const cellist_report report = validate(context, mesh);
    const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
    static pair_triangle triangle[4 * COUNT];
    bool touches[4 * COUNT] = {false}, crosses[4 * COUNT] = {false};
    for (size_t f = 0; f < (size_t)4 * COUNT; f++)
      for (int c = 0; c < 3; c++) {
        const uint32_t point = a->tets[f / 4 * 4 + CELLIST_TET_FACE[f % 4][c]];
        triangle[f].corner[c] = &a->positions[3 * (size_t)point];
        triangle[f].id[c] = point;
        for (uint32_t other = 0; other < point; other++) /* a point is the first in its place */
          if (memcmp(&a->positions[3 * (size_t)other], triangle[f].corner[c], 3 * sizeof(double)) == 0) {
            triangle[f].id[c] = other;
            break;
          }
      }
    for (size_t f = 0; f < (size_t)4 * COUNT; f++)
      for (size_t g = 0; g < f; g++) {
        const pair_contact contact = pair_classify(&triangle[f], &triangle[g]);
        const int flat = (a->tet_flags[f / 4] & CELLIST_TET_FLAT) + (a->tet_flags[g / 4] & CELLIST_TET_FLAT);
        if (flat == 2 * CELLIST_TET_FLAT || (flat > 0 && contact != PAIR_CROSS)) continue;
        if (contact == PAIR_CROSS) crosses[f] = crosses[g] = true;
        if (contact != PAIR_APART) touches[f] = touches[g] = true;
      }
    size_t crossing = 0, touching = 0;
    for (size_t f = 0; f < (size_t)4 * COUNT; f++) {
      crossing += crosses[f];
      touching += touches[f] && !crosses[f];
    }
    assert_int_equal(report.crossing_face_count, crossing);
    assert_int_equal(report.touching_face_count, touching);
    assert_true(crossing > 50 && (!is_coarse || touching > 20));
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
}

/* ---- Flaws one by one -------------------------------------------------------------------------------- */

TEST(each_flaw_is_told_by_the_ids_of_the_file)
{
  cellist_context *context = harness_context(1);
  /* A unit tet, a point over and one under its base, and an eighth of it against the base. */
  const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.25, 0.25, 2, 0, 0, -1, 0.5, 0.5, 0, 0, 0, -2, 9, 9, 9};
  const uint32_t origin[] = {70, 60, 50};
  cellist_mesh_desc desc = {.point_count = 9, .positions = points, .tet_origin = origin};

  const uint32_t inverted[] = {0, 1, 2, 3, 0, 1, 2, 5};
  desc.tets = inverted;
  desc.tet_count = 2;
  cellist_report report = validate_arrays(context, desc);
  assert_kinds(&report, KIND(INVERTED) | KIND(UNUSED));
  assert_int_equal(report.inverted_cell_count, 1);
  assert_int_equal(report.findings[CELLIST_FINDING_INVERTED].ids[0], 60);
  assert_int_equal(report.findings[CELLIST_FINDING_UNUSED].count, 4);
  assert_int_equal(report.findings[CELLIST_FINDING_UNUSED].ids[0], 4);
  assert_int_equal(report.findings[CELLIST_FINDING_UNUSED].ids[3], 8);

  const uint32_t folded[] = {0, 1, 2, 3, 0, 1, 2, 4};
  desc.tets = folded;
  report = validate_arrays(context, desc);
  assert_kinds(&report, KIND(FOLDED) | KIND(CROSSING) | KIND(UNUSED));
  assert_int_equal(report.folded_face_count, 1);
  assert_int_equal(report.findings[CELLIST_FINDING_FOLDED].count, 2);
  assert_int_equal(report.findings[CELLIST_FINDING_FOLDED].ids[0], 60);
  assert_int_equal(report.findings[CELLIST_FINDING_FOLDED].ids[1], 70);

  const uint32_t twice[] = {0, 1, 2, 3, 2, 3, 0, 1};
  desc.tets = twice;
  report = validate_arrays(context, desc);
  assert_kinds(&report, KIND(DUPLICATE) | KIND(UNUSED));
  assert_int_equal(report.findings[CELLIST_FINDING_DUPLICATE].count, 2);

  const uint32_t flat[] = {0, 1, 6, 2, 0, 1, 6, 2};
  desc.tets = flat;
  desc.tet_count = 1;
  report = validate_arrays(context, desc);
  assert_kinds(&report, KIND(FLAT) | KIND(UNUSED));
  desc.tet_count = 2;
  report = validate_arrays(context, desc);
  assert_true(report.findings[CELLIST_FINDING_DUPLICATE].count == 2 && report.degenerate_cell_count == 2);

  const uint32_t three[] = {0, 1, 2, 3, 0, 2, 1, 5, 0, 2, 1, 7};
  desc.tets = three;
  desc.tet_count = 3;
  report = validate_arrays(context, desc);
  assert_kinds(&report, KIND(OVERFULL) | KIND(TOUCHING) | KIND(CROSSING) | KIND(UNUSED));
  assert_int_equal(report.findings[CELLIST_FINDING_OVERFULL].count, 3);
  assert_int_equal(report.overfull_face_count, 1);

  /* Two tets under halves of the base: node 6 hangs on the edge 1 2. */
  const uint32_t hanging[] = {0, 1, 2, 3, 0, 6, 1, 5, 0, 2, 6, 5};
  desc.tets = hanging;
  report = validate_arrays(context, desc);
  assert_kinds(&report, KIND(HANGING) | KIND(TOUCHING) | KIND(UNUSED));
  assert_int_equal(report.findings[CELLIST_FINDING_HANGING].count, 3);
  assert_true(report.crossing_face_count == 0 && !report.is_convex);
  harness_context_destroy(context);
}

TEST(seams_and_values_that_are_no_numbers_are_found)
{
  cellist_context *context = harness_context(1);
  const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -0.0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1};
  const uint32_t tets[] = {0, 1, 2, 3, 4, 6, 5, 7};
  const double values[] = {0, 1, 2, INFINITY, 4, 5, 6, 7}, cells[] = {1, 2};
  const cellist_field fields[] = {{"p", CELLIST_ON_POINTS, 1, values}, {"c", CELLIST_ON_CELLS, 1, cells}};
  const cellist_report report = validate_arrays(context, (cellist_mesh_desc){8, points, 2, tets, NULL, 2, fields});
  assert_kinds(&report, KIND(SEAM) | KIND(COINCIDENT) | KIND(NAN_SCALAR));
  assert_true(report.flaw_count == 0 && report.warning_count == 3);
  assert_int_equal(report.findings[CELLIST_FINDING_SEAM].count, 2);
  assert_int_equal(report.findings[CELLIST_FINDING_COINCIDENT].count, 3);
  assert_int_equal(report.findings[CELLIST_FINDING_COINCIDENT].ids[0], 4);
  assert_int_equal(report.findings[CELLIST_FINDING_NAN_SCALAR].count, 1);
  assert_int_equal(report.findings[CELLIST_FINDING_NAN_SCALAR].ids[0], 0);
  harness_context_destroy(context);
}

/* A dihedral angle by its definition, in extended precision. */
static long double dihedral(const double *p[4], int a, int b) {
  int others[2], count = 0;
  for (int c = 0; c < 4; c++)
    if (c != a && c != b) others[count++] = c;
  long double axis[3], leg[2][3], square = 0;
  for (int k = 0; k < 3; k++) {
    axis[k] = (long double)p[b][k] - p[a][k];
    square += axis[k] * axis[k];
  }
  for (int i = 0; i < 2; i++) {
    long double along = 0;
    for (int k = 0; k < 3; k++) along += ((long double)p[others[i]][k] - p[a][k]) * axis[k];
    for (int k = 0; k < 3; k++) leg[i][k] = (long double)p[others[i]][k] - p[a][k] - along / square * axis[k];
  }
  long double dot = 0, cross = 0;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const long double c = leg[0][i] * leg[1][j] - leg[0][j] * leg[1][i];
    dot += leg[0][k] * leg[1][k];
    cross += c * c;
  }
  return atan2l(sqrtl(cross), dot) * 180 / 3.14159265358979323846264L;
}

TEST(needles_have_a_dihedral_angle_under_a_tenth_of_a_degree)
{
  random_state random = {23};
  cellist_context *context = harness_context(1);
  size_t needles = 0;
  enum { ROUNDS = 3000 };
  for (int round = 0; round < ROUNDS; round++) {
    double points[12];
    for (int i = 0; i < 12; i++) points[i] = random_between(&random, -1, 1);
    const double squash = pow(10, random_between(&random, -5, 0));
    for (int i = 0; i < 4; i++) points[3 * i + 2] *= squash;
    const uint32_t tet[] = {0, 1, 2, 3};
    const double *p[4] = {points, points + 3, points + 6, points + 9};
    long double least = 180;
    for (int a = 0; a < 4; a++)
      for (int b = a + 1; b < 4; b++) least = fminl(least, dihedral(p, a, b));
    if (fabsl(least - 0.1L) < 1e-8L) continue;
    const cellist_report report = validate_arrays(
        context, (cellist_mesh_desc){.point_count = 4, .positions = points, .tet_count = 1, .tets = tet});
    assert_int_equal(report.findings[CELLIST_FINDING_NEEDLE].count, least < 0.1L);
    needles += least < 0.1L;
  }
  assert_true(needles > ROUNDS / 10 && needles < ROUNDS / 2);
  harness_context_destroy(context);
}

/* ---- The call itself --------------------------------------------------------------------------------- */

static cellist_result validate_holed(cellist_context *context, void *user) {
  struct holed_grid *grid = user;
  const cellist_mesh_desc desc = {
      .point_count = POINTS, .positions = grid->positions, .tet_count = grid->tet_count, .tets = grid->tets};
  cellist_mesh *mesh = NULL;
  cellist_result result = cellist_mesh_create(context, &desc, &mesh);
  if (result != CELLIST_SUCCESS) return result;
  cellist_report report;
  result = cellist_validate(context, mesh, NULL, &report);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  random_state random = {3};
  struct holed_grid grid;
  grid_create(&grid, &random, 0, 50);
  memcpy(&grid.tets[4 * (grid.tet_count - 1)], grid.tets, 4 * sizeof *grid.tets); /* a copy: something to collect */
  check_allocation_failures(validate_holed, &grid);
}

TEST(strict_refuses_flaws_but_not_warnings)
{
  cellist_context *context = harness_context(1);
  const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0};
  const uint32_t tets[] = {0, 1, 2, 3, 0, 1, 2, 4};
  cellist_mesh_desc desc = {.point_count = 5, .positions = points, .tet_count = 1, .tets = tets};
  const cellist_validate_desc strict = {.strict = true};
  cellist_report report;
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh)); /* a point unused: a note */
  assert_success(context, cellist_validate(context, mesh, &strict, &report));
  cellist_mesh_destroy(mesh);
  desc.tet_count = 2; /* a flat cell more */
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  assert_failure(context, cellist_validate(context, mesh, &strict, &report), CELLIST_ERROR_GEOMETRY,
                 "1 cells have no volume and are not drawn: 1");
  assert_int_equal(report.findings[CELLIST_FINDING_FLAT].count, 1);
  cellist_mesh_destroy(mesh);
  assert_failure(context, cellist_validate(context, NULL, NULL, &report), CELLIST_ERROR_INVALID_ARGUMENT, "NULL");
  assert_null(cellist_finding_name(CELLIST_FINDING_COUNT));
  harness_context_destroy(context);
}

TEST(a_mesh_without_cells_is_sound)
{
  cellist_context *context = harness_context(1);
  const cellist_report report = validate_arrays(context, (cellist_mesh_desc){0});
  assert_kinds(&report, 0);
  assert_true(report.component_count == 0 && !report.is_convex);
  harness_context_destroy(context);
}

/* ---- Real meshes ------------------------------------------------------------------------------------- */

static cellist_report validate_file(const char *name, unsigned workers) {
  const char *path = shared_data(name);
  cellist_context *context = harness_context(workers);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  const cellist_report report = validate(context, mesh);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
  return report;
}

TEST(sound_meshes_are_sound)
{
  static const struct {
    const char *name;
    size_t components, cavities, nonmanifold_edges;
    bool is_convex;
  } meshes[] = {
      {"spx.vtu", 1, 0, 0, false},      {"bluntfin.vtu", 1, 0, 0, false}, {"post.vtu", 1, 0, 0, false},
      {"impeller.vtu", 1, 0, 0, false}, {"gears_t.vtu", 6, 0, 0, false},  {"disk_out_ref.vtu", 1, 0, 0, false},
      {"fire.vtu", 1, 0, 0, false},     {"bunny_in.vtu", 1, 0, 0, false}, {"octopus_low.vtu", 1, 0, 0, false},
      {"bucky.vtu", 1, 0, 0, true},     {"sci_torso.vtu", 1, 1, 3, false}};
  for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++) {
    const cellist_report report = validate_file(meshes[i].name, 1);
    const bool ok = report.flaw_count == 0 && report.component_count == meshes[i].components &&
                    report.cavity_count == meshes[i].cavities && report.is_convex == meshes[i].is_convex &&
                    report.nonmanifold_edge_count == meshes[i].nonmanifold_edges;
    if (!ok) fail_msg("%s is not what it should be", meshes[i].name);
  }
}

TEST(a_torus_has_its_flat_cells)
{
  const cellist_report report = validate_file("torus_vt.vtu", 1);
  assert_kinds(&report, KIND(FLAT) | KIND(NEEDLE));
  assert_int_equal(report.degenerate_cell_count, 30);
}

/* 683 faces are crossing or folded by `tetgen -d` (1.5) on the boundary too: 591 and those of the folds. */
TEST(a_crushed_can_is_found_folded_and_crossing)
{
  const cellist_report report = validate_file("can.vtu", 1);
  assert_int_equal(report.folded_face_count, 161);
  assert_int_equal(report.crossing_face_count, 591);
  assert_int_equal(report.inverted_cell_count, 0);
  const cellist_report again = validate_file("can.vtu", 3);
  assert_memory_equal(&report, &again, sizeof report);
  const cellist_report hexahedra = validate_file("can_hex.vtu", 1);
  assert_int_equal(hexahedra.folded_face_count, 161);
  assert_true(hexahedra.inverted_cell_count > 0);
}
