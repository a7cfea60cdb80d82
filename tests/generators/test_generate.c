/* SPDX-License-Identifier: BSD-3-Clause
 * Generators: sound meshes of the promised size, the same bits every time. */
#include <cellist/generate.h>
#include <cellist/predicates.h>
#include <cellist/validate.h>
#include <math.h>
#include <string.h>

#include "harness.h"

static cellist_mesh *generate(cellist_context *context, const char *name, cellist_generate_desc desc) {
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_generate(context, name, &desc, &mesh));
  return mesh;
}

static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t count) {
  const unsigned char *byte = bytes;
  for (size_t i = 0; i < count; i++) hash = (hash ^ byte[i]) * 0x100000001b3u;
  return hash;
}

/* Of everything a user can see of the mesh. */
static uint64_t hash_mesh(const cellist_mesh *mesh) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  uint64_t hash = hash_bytes(0xcbf29ce484222325u, a->positions, 3 * a->point_count * sizeof(double));
  hash = hash_bytes(hash, a->tets, 4 * a->tet_count * sizeof(uint32_t));
  hash = hash_bytes(hash, a->tet_origin, a->tet_count * sizeof(uint32_t));
  return hash_bytes(hash, a->fields[0].values, a->point_count * sizeof(double));
}

static void assert_size(const cellist_mesh *mesh, size_t size, double tolerance, const char *name) {
  const double count = (double)cellist_mesh_get_arrays(mesh)->tet_count;
  if (fabs(count - (double)size) > tolerance * (double)size) fail_msg("%s: %g tets instead of %zu", name, count, size);
}

TEST(grid_and_ball_have_the_wanted_size)
{
  static const char *const names[] = {"grid", "ball"};
  cellist_context *context = harness_context(1);
  for (int i = 0; i < 2; i++)
    for (size_t size = 100; size < 400000; size = size * 7 / 4) {
      cellist_mesh *mesh = generate(context, names[i], (cellist_generate_desc){.size = size, .seed = size});
      assert_size(mesh, size, 0.1, names[i]);
      cellist_mesh_destroy(mesh);
    }
  harness_context_destroy(context);
}

/* Signs from cellist_orient3d, independent of how the ball was made: no point lies beyond a boundary face. */
TEST(a_ball_fills_its_hull)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = generate(context, "ball", (cellist_generate_desc){.size = 3000, .seed = 5});
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  assert_int_equal(cellist_mesh_get_facts(mesh)->unused_point_count, 0);
  for (size_t f = 0; f < 4 * a->tet_count; f++) {
    if (a->neighbours[f] != CELLIST_NONE) continue;
    const double *p[3];
    for (int c = 0; c < 3; c++) p[c] = &a->positions[3 * (size_t)a->tets[f / 4 * 4 + CELLIST_TET_FACE[f % 4][c]]];
    for (size_t i = 0; i < a->point_count; i++)
      assert_true(cellist_orient3d(p[0], p[1], p[2], &a->positions[3 * i]) <= 0);
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(a_perturbed_grid_keeps_its_box_and_volume)
{
  cellist_context *context = harness_context(1);
  for (int step = 0; step <= 5; step++) {
    cellist_mesh *mesh =
        generate(context, "grid", (cellist_generate_desc){.size = 3000, .seed = 7, .perturb = 0.1 * step});
    const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
    const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
    assert_int_equal(facts->inverted_count + facts->flat_count + facts->folded_face_count, 0);
    double volume = 0;
    for (size_t t = 0; t < a->tet_count; t++) {
      const double *p[4];
      for (int c = 0; c < 4; c++) p[c] = &a->positions[3 * (size_t)a->tets[4 * t + (size_t)c]];
      double e[3][3];
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) e[i][k] = p[i + 1][k] - p[0][k];
      volume += (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                 e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
                6;
    }
    const double *b = a->bounds;
    const double box = (b[3] - b[0]) * (b[4] - b[1]) * (b[5] - b[2]);
    assert_true(fabs(volume - box) < 1e-12 * box);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

TEST(a_seed_gives_the_same_bits_for_any_number_of_workers)
{
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    uint64_t hash[3];
    for (unsigned run = 0; run < 3; run++) {
      cellist_context *context = harness_context(run == 1 ? 3 : 1);
      cellist_mesh *mesh = generate(context, cellist_generator_name(i),
                                    (cellist_generate_desc){.seed = run == 2 ? 12 : 11, .perturb = 0.2});
      hash[run] = hash_mesh(mesh);
      cellist_mesh_destroy(mesh);
      harness_context_destroy(context);
    }
    if (hash[0] != hash[1]) fail_msg("%s differs from run to run", cellist_generator_name(i));
    if (strcmp(cellist_generator_name(i), "ball") == 0) assert_true(hash[0] != hash[2]);
  }
}

static cellist_result generate_small(cellist_context *context, void *user) {
  const cellist_generate_desc desc = {.size = 60};
  cellist_mesh *mesh = NULL;
  const cellist_result result = cellist_generate(context, user, &desc, &mesh);
  if (result == CELLIST_SUCCESS) cellist_mesh_destroy(mesh);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++)
    check_allocation_failures(generate_small, (void *)cellist_generator_name(i));
}

TEST(wrong_names_and_ranges_are_named)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_failure(context, cellist_generate(context, "armadillo", NULL, &mesh), CELLIST_ERROR_NOT_FOUND,
                 "no generator 'armadillo'; there are: gears, grid");
  cellist_generate_desc desc = {.perturb = NAN};
  assert_failure(context, cellist_generate(context, "grid", &desc, &mesh), CELLIST_ERROR_INVALID_ARGUMENT, "perturb");
  desc = (cellist_generate_desc){.size = (size_t)1 << 40};
  assert_failure(context, cellist_generate(context, "ball", &desc, &mesh), CELLIST_ERROR_INVALID_ARGUMENT, "cells");
  desc = (cellist_generate_desc){.parts = 1000};
  assert_failure(context, cellist_generate(context, "gears", &desc, &mesh), CELLIST_ERROR_INVALID_ARGUMENT,
                 "parts is 1000, not in 5..32");
  assert_null(mesh);
  assert_null(cellist_generator_name(1000));
  harness_context_destroy(context);
}

TEST(sines_are_right)
{
  /* Through what is public: a ring's points lie on the circles that they should, in a mesh made of sines. */
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = generate(context, "gears", (cellist_generate_desc){0});
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  double nearest = HUGE_VAL, farthest = 0;
  for (size_t i = 0; i < a->point_count; i++) {
    const double radius = hypot(a->positions[3 * i], a->positions[3 * i + 1]);
    nearest = fmin(nearest, radius);
    if (a->positions[3 * i] < 0) farthest = fmax(farthest, radius);
  }
  assert_true(fabs(nearest - 0.55) < 1e-15 && fabs(farthest - 1) < 1e-15);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

static cellist_report generate_and_validate(cellist_context *context, const char *name, cellist_generate_desc desc) {
  cellist_mesh *mesh = generate(context, name, desc);
  cellist_report report;
  assert_success(context, cellist_validate(context, mesh, NULL, &report));
  assert_int_equal(cellist_mesh_get_facts(mesh)->unused_point_count, report.findings[CELLIST_FINDING_UNUSED].count);
  cellist_mesh_destroy(mesh);
  return report;
}

/* Kinds of findings, as bits. */
static unsigned kinds_of(const cellist_report *report) {
  unsigned kinds = 0;
  for (int kind = 0; kind < CELLIST_FINDING_COUNT; kind++) kinds |= (report->findings[kind].count > 0) << kind;
  return kinds;
}

static unsigned allowed_kinds(const char *name) {
  if (strcmp(name, "flaws") == 0) return (1u << CELLIST_FINDING_COUNT) - 1;
  /* Delaunay triangulations of random points have some slivers. */
  if (strcmp(name, "slivers") == 0 || strcmp(name, "ball") == 0) return 1u << CELLIST_FINDING_NEEDLE;
  return 0;
}

TEST(all_but_flaws_are_sound_at_any_size)
{
  static const size_t sizes[] = {0, 1, 500, 12000, 40000};
  cellist_context *context = harness_context(2);
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++)
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
      const char *name = cellist_generator_name(i);
      const cellist_report report =
          generate_and_validate(context, name, (cellist_generate_desc){.size = sizes[k], .seed = 3, .perturb = 0.3});
      if (kinds_of(&report) & ~allowed_kinds(name))
        fail_msg("%s of size %zu has findings %x", name, sizes[k], kinds_of(&report));
      if (strcmp(name, "flaws") != 0 && report.nonmanifold_edge_count + report.nonmanifold_vertex_count > 0)
        fail_msg("%s of size %zu is no manifold", name, sizes[k]);
    }
  harness_context_destroy(context);
}

TEST(flaws_has_every_finding_and_slivers_are_needles)
{
  cellist_context *context = harness_context(1);
  cellist_report report = generate_and_validate(context, "flaws", (cellist_generate_desc){0});
  assert_int_equal(kinds_of(&report), allowed_kinds("flaws"));
  static const cellist_finding_kind single[] = {CELLIST_FINDING_INVERTED,  CELLIST_FINDING_FLAT,
                                                CELLIST_FINDING_NEEDLE,    CELLIST_FINDING_INFINITE,
                                                CELLIST_FINDING_COLLAPSED, CELLIST_FINDING_NAN_SCALAR};
  for (size_t i = 0; i < sizeof single / sizeof single[0]; i++) assert_int_equal(report.findings[single[i]].count, 1);
  assert_int_equal(report.findings[CELLIST_FINDING_COLLAPSED].ids[0],
                   9); /* ids of what was given, not of what is left */
  assert_int_equal(report.findings[CELLIST_FINDING_INFINITE].ids[0], 10);
  assert_int_equal(report.findings[CELLIST_FINDING_NAN_SCALAR].ids[0], 11);
  report = generate_and_validate(context, "slivers", (cellist_generate_desc){0});
  assert_int_equal(kinds_of(&report), allowed_kinds("slivers"));
  harness_context_destroy(context);
}

TEST(every_number_of_parts_gives_a_sound_mesh)
{
  static const struct {
    const char *name;
    uint32_t parts;
    size_t components, cavities;
  } cases[] = {
      {"gears", 5, 2, 0},        {"gears", 32, 2, 0},         {"heat-sink", 2, 1, 0},   {"heat-sink", 60, 1, 0},
      {"staircase", 2, 1, 0},    {"staircase", 40, 1, 0},     {"shells", 1, 1, 0},      {"shells", 5, 5, 4},
      {"swiss-cheese", 1, 1, 1}, {"swiss-cheese", 5, 1, 125}, {"plates", 2, 2, 0},      {"plates", 500, 500, 0},
      {"cyclic", 3, 3, 0},       {"cyclic", 300, 300, 0},     {"two-spheres", 0, 2, 0}, {"torus", 0, 1, 0}};
  cellist_context *context = harness_context(2);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const cellist_report report = generate_and_validate(
        context, cases[i].name, (cellist_generate_desc){.size = 3000 * (i < 12), .parts = cases[i].parts});
    if (kinds_of(&report) != 0 || report.component_count != cases[i].components ||
        report.cavity_count != cases[i].cavities)
      fail_msg("%s of %u parts: findings %x, %zu components, %zu cavities", cases[i].name, cases[i].parts,
               kinds_of(&report), report.component_count, report.cavity_count);
  }
  harness_context_destroy(context);
}

TEST(sizes_are_about_what_was_asked_for)
{
  cellist_context *context = harness_context(1);
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    const char *name = cellist_generator_name(i);
    if (strcmp(name, "flaws") == 0) continue;
    for (size_t size = 30000; size <= 120000; size *= 2) {
      cellist_mesh *mesh = generate(context, name, (cellist_generate_desc){.size = size});
      const bool is_coarse = strcmp(name, "shells") == 0; /* whole cubes thick */
      assert_size(mesh, size, is_coarse ? 0.8 : 0.3, name);
      cellist_mesh_destroy(mesh);
    }
  }
  harness_context_destroy(context);
}

/* Where the middle lines of two sticks cross in the wheel's plane, which is higher? 1, -1, or 0 if they do not cross.
 */
static int over(double a[2][3], double b[2][3]) {
  const double u[2] = {a[1][0] - a[0][0], a[1][1] - a[0][1]}, v[2] = {b[1][0] - b[0][0], b[1][1] - b[0][1]};
  const double w[2] = {b[0][0] - a[0][0], b[0][1] - a[0][1]}, area = u[0] * v[1] - u[1] * v[0];
  const double s = (w[0] * v[1] - w[1] * v[0]) / area, t = (w[0] * u[1] - w[1] * u[0]) / area;
  if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1)) return 0;
  return a[0][2] + s * (a[1][2] - a[0][2]) > b[0][2] + t * (b[1][2] - b[0][2]) ? 1 : -1;
}

TEST(each_tet_of_a_wheel_lies_over_the_next)
{
  cellist_context *context = harness_context(1);
  for (uint32_t parts = 3; parts <= 300; parts += parts < 64 ? 1 : 59) {
    cellist_mesh *mesh = generate(context, "cyclic", (cellist_generate_desc){.parts = parts});
    const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
    assert_int_equal(a->tet_count, parts);
    double line[300][2][3];
    memset(line, 0, sizeof line);
    for (size_t i = 0; i < a->point_count; i++) /* a stick's first two points are its low end */
      for (size_t k = 0; k < 3; k++)
        line[a->point_origin[i] / 4][a->point_origin[i] / 2 % 2][k] += 0.5 * a->positions[3 * i + k];
    for (uint32_t i = 0; i < parts; i++) assert_int_equal(over(line[i], line[(i + 1) % parts]), 1);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

/* Boundary triangles that are not on the box around the mesh, which for these is where hull and boundary coincide. */
TEST(known_exteriors)
{
  cellist_context *context = harness_context(1);
  cellist_report report = generate_and_validate(context, "l-shape", (cellist_generate_desc){0});
  assert_int_equal(report.reflex_edge_count, 4); /* the inner edge, in four */
  report = generate_and_validate(context, "two-spheres", (cellist_generate_desc){.size = 40000});
  assert_int_equal(report.boundary_face_count, 2 * 20 * 31 * 31);
  assert_int_equal(report.reflex_edge_count, 0); /* each ball is convex */
  cellist_mesh *mesh = generate(context, "gears", (cellist_generate_desc){0});
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  size_t inside = 0;
  for (size_t f = 0; f < 4 * a->tet_count; f++) {
    if (a->neighbours[f] != CELLIST_NONE) continue;
    bool on_lid = true;
    for (int c = 0; c < 3; c++) {
      const double z = a->positions[3 * (size_t)a->tets[f / 4 * 4 + CELLIST_TET_FACE[f % 4][c]] + 2];
      on_lid &= z == a->bounds[2] || z == a->bounds[5];
    }
    inside += !on_lid;
  }
  assert_int_equal(inside, 2880); /* but for the tips on the hull's side: the exterior's facets */
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
