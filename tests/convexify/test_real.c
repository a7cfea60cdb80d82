/* SPDX-License-Identifier: BSD-3-Clause
 * Real meshes and generated ones: every complex must be valid, exactly convex, of the right volume and free of gaps
 * along rays; the same again for the same seed on any number of workers. */
#include <cellist/convexify.h>
#include <cellist/generate.h>
#include <string.h>

#include "check_faults.h"
#include "harness.h"

static void check_mesh(cellist_context *context, const cellist_mesh *mesh, cellist_exterior exterior, uint64_t seeds,
                       size_t most, int rays) {
  size_t fit = 0;
  for (uint64_t seed = 1; seed <= seeds; seed++) {
    const cellist_convexify_desc desc = {.exterior = exterior, .seed = seed};
    cellist_complex *complex = NULL;
    cellist_convexify_stats stats;
    assert_success(context, cellist_convexify(context, mesh, &desc, &complex, &stats));
    if (!cellist_complex_is_valid(context, complex, mesh)) fail_msg("%s", cellist_context_take_error(context));
    assert_true(stats.volume_error <= 1e-12);
    assert_int_equal(stats.convexity_violations, 0);
    fit += stats.imaginary_cells <= most;
    check_faults(complex, mesh, rays, seed);
    cellist_complex_destroy(complex);
  }
  assert_true(2 * fit >= seeds); /* the median */
}

static void check_shared(const char *name, cellist_exterior exterior, uint64_t seeds, size_t most, int rays) {
  const char *path = shared_data(name);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  check_mesh(context, mesh, exterior, seeds, most, rays);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* Three seeds of the hull, the median of whose cells must be at most this, and one of each other exterior. All seeds of
 * all: bench_convexify -matrix. */
static void check_everywhere(const char *name, size_t cells, int rays) {
  check_shared(name, CELLIST_EXTERIOR_HULL, 3, cells, rays);
  for (int exterior = 1; exterior < 4; exterior++) check_shared(name, (cellist_exterior)exterior, 1, SIZE_MAX, rays);
}

TEST(spx)
{ check_everywhere("spx.vtu", 800, 40); }
TEST(bluntfin)
{ check_everywhere("bluntfin.vtu", 15, 4); }
TEST(post)
{ check_everywhere("post.vtu", 1, 4); }
TEST(octopus)
{ check_everywhere("octopus_low.vtu", 1000, 40); }
TEST(torus_with_flat_tets)
{ check_everywhere("torus_vt.vtu", 400, 40); }
TEST(disk_out_ref)
{ check_everywhere("disk_out_ref.vtu", 103, 20); }
TEST(sci_torso)
{ check_everywhere("sci_torso.vtu", 2600, 10); }
TEST(bunny)
{ check_everywhere("bunny_in.vtu", 6600, 10); }
TEST(impeller)
{ check_everywhere("impeller.vtu", 10500, 5); }
TEST(gears_that_mesh)
{ check_everywhere("gears_t.vtu", 8300, 5); }
TEST(bucky_is_convex)
{ check_shared("bucky.vtu", CELLIST_EXTERIOR_HULL, 1, 0, 2); }

static void check_refused(const char *name, const char *verdict) {
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, shared_data(name), NULL, &mesh));
  for (int exterior = 0; exterior < 4; exterior++) {
    const cellist_convexify_desc desc = {.exterior = (cellist_exterior)exterior};
    cellist_complex *complex = NULL;
    assert_failure(context, cellist_convexify(context, mesh, &desc, &complex, NULL), CELLIST_ERROR_GEOMETRY, verdict);
    assert_null(complex);
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(crushed_cans_are_refused_by_name)
{
  check_refused("can.vtu", "cells ");
  check_refused("can_hex.vtu", "cell");
}

static bool cancel_while_waiting(void *user, const char *stage, double fraction) {
  struct {
    double last;
    int same;
  } *seen = user;
  if (strcmp(stage, "convexifying") != 0) return true;
  seen->same = fraction == seen->last ? seen->same + 1 : 0;
  seen->last = fraction;
  return seen->same < 3;
}

/* TetGen takes seconds for this surface, in which nothing gets done that a fraction could tell. */
TEST(tetgen_can_be_cancelled_while_it_works)
{
  struct {
    double last;
    int same;
  } seen = {-1, 0};
  const cellist_context_desc watched = {.progress = cancel_while_waiting, .progress_user = &seen};
  cellist_context *context = NULL;
  cellist_mesh *mesh = NULL;
  const char *path = shared_data("gears_t.vtu");
  assert_int_equal(cellist_context_create(&watched, &context), CELLIST_SUCCESS);
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  const cellist_convexify_desc desc = {.exterior = CELLIST_EXTERIOR_DELAUNAY};
  cellist_complex *complex = NULL;
  assert_failure(context, cellist_convexify(context, mesh, &desc, &complex, NULL), CELLIST_ERROR_CANCELLED,
                 "cancelled");
  assert_null(complex);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
}

static void check_sample(const char *name, size_t size, uint32_t parts, size_t most) {
  cellist_context *context = harness_context(1);
  const cellist_generate_desc desc = {.size = size, .parts = parts};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_generate(context, name, &desc, &mesh));
  check_mesh(context, mesh, CELLIST_EXTERIOR_HULL, 3, most, 4);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(samples_take_few_cells)
{
  check_sample("l-shape", 0, 0, 1);
  check_sample("heat-sink", 0, 0, 7);
  check_sample("heat-sink", 0, 3, 2);
  check_sample("gears", 7000, 0, 950);
  check_sample("ball", 500, 0, 0);
  check_sample("grid", 500, 0, 0);
}

static void check_generated(cellist_exterior exterior, uint64_t seeds, size_t size) {
  cellist_context *context = harness_context(1);
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    const char *name = cellist_generator_name(i);
    const cellist_generate_desc desc = {.size = size};
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_generate(context, name, &desc, &mesh));
    if (strcmp(name, "flaws") != 0) check_mesh(context, mesh, exterior, seeds, SIZE_MAX, 8);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

TEST(generated_meshes)
{ check_generated(CELLIST_EXTERIOR_HULL, 3, 350); }
TEST(generated_meshes_in_a_box)
{ check_generated(CELLIST_EXTERIOR_BOX, 1, 300); }
TEST(generated_meshes_by_a_grid)
{ check_generated(CELLIST_EXTERIOR_GRID, 1, 300); }
TEST(generated_meshes_by_tetgen)
{ check_generated(CELLIST_EXTERIOR_DELAUNAY, 1, 300); }

/* The edges of these balls follow great circles but for rounding: planes through two of them resolve neither. */
TEST(edges_that_are_nearly_in_a_plane_are_not_taken_for_resolved)
{
  cellist_context *context = harness_context(1);
  const cellist_generate_desc balls = {.size = 2500};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_generate(context, "two-spheres", &balls, &mesh));
  check_mesh(context, mesh, CELLIST_EXTERIOR_HULL, 3, 1000, 4);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* One candidate makes many needless cells, and joining them again brings facets back to cells that they once left. */
TEST(cells_part_and_join_again)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_generate(context, "torus", NULL, &mesh));
  size_t merges = 0;
  for (uint64_t seed = 1; seed <= 8; seed++) {
    const cellist_convexify_desc desc = {.candidates = 1, .seed = seed};
    cellist_complex *complex = NULL;
    cellist_convexify_stats stats;
    assert_success(context, cellist_convexify(context, mesh, &desc, &complex, &stats));
    assert_true(stats.volume_error <= 1e-12);
    merges += stats.merges;
    cellist_complex_destroy(complex);
  }
  assert_true(merges > 0);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

static void assert_same(const cellist_complex *x, const cellist_complex *y) {
  const cellist_complex_arrays *a = cellist_complex_get_arrays(x), *b = cellist_complex_get_arrays(y);
  assert_int_equal(a->facet_count, b->facet_count);
  assert_int_equal(a->vertex_count, b->vertex_count);
  assert_int_equal(a->plane_count, b->plane_count);
  assert_memory_equal(a->planes, b->planes, 3 * a->plane_count * sizeof *a->planes);
  assert_memory_equal(a->facet_planes, b->facet_planes, a->facet_count * sizeof *a->facet_planes);
  assert_memory_equal(a->facet_cells, b->facet_cells, 2 * a->facet_count * sizeof *a->facet_cells);
  assert_memory_equal(a->facet_vertices, b->facet_vertices,
                      a->facet_starts[a->facet_count] * sizeof *a->facet_vertices);
  assert_memory_equal(a->vertices, b->vertices, 3 * a->vertex_count * sizeof *a->vertices);
}

/* Balls with symmetries have flat sides of many corners, which a hull may split in any way. */
TEST(results_repeat_on_any_number_of_workers)
{
  static const char *const names[] = {"gears", "two-spheres"};
  for (int name = 0; name < 2; name++)
    for (int exterior = 0; exterior < 4; exterior++) {
      cellist_complex *complex[3];
      cellist_mesh *mesh[3];
      cellist_context *context[3];
      cellist_convexify_stats stats[3];
      for (int i = 0; i < 3; i++) {
        const cellist_generate_desc generate = {.size = 800};
        const cellist_convexify_desc desc = {.exterior = (cellist_exterior)exterior, .seed = 7};
        context[i] = harness_context(i == 0 ? 1 : 3);
        assert_success(context[i], cellist_generate(context[i], names[name], &generate, &mesh[i]));
        assert_success(context[i], cellist_convexify(context[i], mesh[i], &desc, &complex[i], &stats[i]));
      }
      for (int i = 1; i < 3; i++) {
        assert_same(complex[0], complex[i]);
        assert_memory_equal(&stats[0].volume_error, &stats[i].volume_error, sizeof(double));
      }
      for (int i = 0; i < 3; i++) {
        cellist_complex_destroy(complex[i]);
        cellist_mesh_destroy(mesh[i]);
        harness_context_destroy(context[i]);
      }
    }
}
