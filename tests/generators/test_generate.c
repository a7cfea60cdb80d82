/* SPDX-License-Identifier: BSD-3-Clause
 * Generators: sound meshes of the promised size, the same bits every time. */
#include <cellist/generate.h>
#include <cellist/predicates.h>
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
                 "parts is 1000, not in 5..64");
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
