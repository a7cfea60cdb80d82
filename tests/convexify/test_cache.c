/* SPDX-License-Identifier: BSD-3-Clause
 * The cache file: bit-exact, and rebuilt whenever a byte, the mesh or an option differs. */
#define _POSIX_C_SOURCE 200809L
#include <cellist/convexify.h>
#include <stdio.h>
#include <unistd.h>

#include "harness.h"
#include "shapes.h"

static const shape STAIRS = {.size = {3, 3, 2}, .cubes = "#####.#..##.#....."};

static char *scratch_file(char name[64]) {
  strcpy(name, "/tmp/cellist_cache_XXXXXX");
  const int handle = mkstemp(name);
  assert_true(handle >= 0);
  close(handle);
  return name;
}

static bool build(cellist_context *context, const cellist_mesh *mesh, const cellist_convexify_desc *desc,
                  const char *path, cellist_complex **complex) {
  cellist_convexify_stats stats;
  cellist_complex *made = NULL;
  assert_success(context, cellist_convexify_cached(context, mesh, desc, path, &made, &stats));
  if (!cellist_complex_is_valid(context, made, mesh)) fail_msg("%s", cellist_context_take_error(context));
  assert_true(stats.volume_error <= 1e-12 && stats.imaginary_cells > 0 && stats.cuts > 0);
  if (complex != NULL)
    *complex = made;
  else
    cellist_complex_destroy(made);
  return stats.cached;
}

static void assert_same(const cellist_complex *x, const cellist_complex *y) {
  const cellist_complex_arrays *a = cellist_complex_get_arrays(x), *b = cellist_complex_get_arrays(y);
  assert_int_equal(a->cell_count, b->cell_count);
  assert_int_equal(a->facet_count, b->facet_count);
  assert_int_equal(a->vertex_count, b->vertex_count);
  assert_int_equal(a->plane_count, b->plane_count);
  assert_memory_equal(a->points, b->points, 24 * a->point_count);
  assert_memory_equal(a->planes, b->planes, 12 * a->plane_count);
  assert_memory_equal(a->facet_planes, b->facet_planes, 4 * a->facet_count);
  assert_memory_equal(a->facet_cells, b->facet_cells, 8 * a->facet_count);
  assert_memory_equal(a->facet_starts, b->facet_starts, 4 * (a->facet_count + 1));
  assert_memory_equal(a->facet_vertices, b->facet_vertices, 4 * (size_t)a->facet_starts[a->facet_count]);
  assert_memory_equal(a->vertices, b->vertices, 24 * a->vertex_count);
}

TEST(what_is_read_is_what_was_written)
{
  char path[64];
  scratch_file(path);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, shape_mesh(context, &STAIRS, &mesh));
  for (int exterior = 0; exterior < 4; exterior++) {
    const cellist_convexify_desc desc = {.exterior = (cellist_exterior)exterior, .seed = 3, .keep_unmerged = true};
    if (exterior == CELLIST_EXTERIOR_DELAUNAY) continue; /* makes no cuts, which build asks for */
    cellist_complex *made = NULL, *read = NULL;
    assert_false(build(context, mesh, &desc, path, &made));
    assert_true(build(context, mesh, &desc, path, &read));
    assert_same(made, read);
    cellist_complex_destroy(made);
    cellist_complex_destroy(read);
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
  remove(path);
}

TEST(stale_files_are_replaced)
{
  char path[64];
  scratch_file(path);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL, *other = NULL;
  shape moved = STAIRS;
  moved.offset[1] = 0x1p-40;
  assert_success(context, shape_mesh(context, &STAIRS, &mesh));
  assert_success(context, shape_mesh(context, &moved, &other));
  const cellist_convexify_desc one = {.seed = 1}, two = {.seed = 2};
  assert_false(build(context, mesh, &one, path, NULL));
  assert_false(build(context, mesh, &two, path, NULL));
  assert_true(build(context, mesh, &two, path, NULL));
  assert_false(build(context, other, &two, path, NULL));
  assert_false(build(context, mesh, &two, path, NULL));
  cellist_mesh_destroy(mesh);
  cellist_mesh_destroy(other);
  harness_context_destroy(context);
  remove(path);
}

TEST(any_damaged_byte_is_noticed)
{
  char path[64];
  scratch_file(path);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, shape_mesh(context, &STAIRS, &mesh));
  assert_false(build(context, mesh, NULL, path, NULL));
  FILE *file = fopen(path, "rb");
  fseek(file, 0, SEEK_END);
  const long size = ftell(file);
  fclose(file);
  random_state random = {5};
  for (int i = 0; i < 60; i++) {
    const long at = i < 30 ? 8 * i : (long)random_below(&random, (uint64_t)size);
    if (i % 10 == 9) {
      assert_int_equal(truncate(path, at), 0);
    } else {
      file = fopen(path, "r+b");
      fseek(file, at, SEEK_SET);
      const int byte = fgetc(file);
      fseek(file, at, SEEK_SET);
      fputc(byte ^ (1 << i % 8), file);
      fclose(file);
    }
    assert_false(build(context, mesh, NULL, path, NULL));
    assert_true(build(context, mesh, NULL, path, NULL));
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
  remove(path);
}

TEST(a_place_that_cannot_be_written_is_an_error)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, shape_mesh(context, &STAIRS, &mesh));
  cellist_complex *complex = NULL;
  assert_failure(context, cellist_convexify_cached(context, mesh, NULL, "/nonexistent/a.cells", &complex, NULL),
                 CELLIST_ERROR_IO, "/nonexistent/a.cells");
  assert_null(complex);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

struct request {
  const char *path;
};

static cellist_result build_and_read(cellist_context *context, void *user) {
  const struct request *request = user;
  cellist_mesh *mesh = NULL;
  cellist_complex *complex = NULL;
  cellist_result result = shape_mesh(context, &STAIRS, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_convexify_cached(context, mesh, NULL, request->path, &complex, NULL);
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(failed_allocations_while_reading_are_reported)
{
  char path[64];
  struct request request = {scratch_file(path)};
  cellist_context *context = harness_context(1);
  assert_success(context, build_and_read(context, &request));
  harness_context_destroy(context);
  check_allocation_failures(build_and_read, &request);
  remove(path);
}
