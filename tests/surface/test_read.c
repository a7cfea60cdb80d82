/* SPDX-License-Identifier: BSD-3-Clause
 * Surface files: STL, OBJ and PLY, in words and bytes, and what is wrong with others. */
#include <stdio.h>
#include <string.h>

#include "shapes.h"

static cellist_result read_text(cellist_context *context, const char *name, const char *text, const double colour[3],
                                cellist_surface **surface) {
  *surface = NULL;
  return cellist_surface_read_memory(context, name, text, strlen(text), colour, surface);
}

/* A build without assimp says so for every file; then there is nothing to test. */
static void needs_reader(cellist_context *context) {
  cellist_surface *surface = NULL;
  if (read_text(context, "a.stl", "x", NULL, &surface) != CELLIST_ERROR_UNSUPPORTED) {
    cellist_context_take_error(context);
    return;
  }
  assert_non_null(strstr(cellist_context_take_error(context), "no assimp"));
  harness_context_destroy(context);
  SKIP("this build reads no surface files");
}

static const char STL[] =
    "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0.5\nvertex 2 0 0.5\nvertex 0 3 0.5\nendloop\nendfacet\n"
    "endsolid one\n";
static const char OBJ[] = "v 0 0 0.5\nv 2 0 0.5\nv 0 3 0.5\nv 2 3 0.5\nvn 0 0 1\nf 1//1 2//1 4//1 3//1\n";
static const char PLY[] =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0.5 255 0 188\n2 0 0.5 255 0 188\n0 3 0.5 255 0 188\n"
    "3 0 1 2\n";

TEST(each_format_gives_its_triangles)
{
  cellist_context *context = harness_context(1);
  needs_reader(context);
  const struct {
    const char *name, *text;
    size_t triangles;
    bool normals;
  } files[] = {{"a.stl", STL, 1, false}, {"b/a.OBJ", OBJ, 2, true}, {"a.b.Ply", PLY, 1, false}};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    for (int coloured = 0; coloured < 2; coloured++) {
      const double blue[3] = {0.1, 0.2, 0.9};
      cellist_surface *surface = NULL;
      assert_success(context, read_text(context, files[i].name, files[i].text, coloured ? blue : NULL, &surface));
      const cellist_surface_arrays *arrays = cellist_surface_get_arrays(surface);
      assert_int_equal(arrays->triangle_count, files[i].triangles);
      assert_int_equal(arrays->normals != NULL, files[i].normals);
      double bounds[6];
      cellist_surface_bounds(surface, bounds);
      const double expected[6] = {0, 0, 0.5, 2, 3, 0.5};
      assert_memory_equal(bounds, expected, sizeof bounds);
      for (size_t p = 0; p < arrays->point_count; p++)
        for (size_t k = 0; k < 3; k++) {
          /* 188 of 255 in sRGB is half the light. */
          const double own = i == 2 ? (const double[3]){1, 0, 0.503}[k] : 0.8;
          assert_true(fabs((double)arrays->colours[3 * p + k] - (coloured ? blue[k] : own)) < 1e-3);
        }
      cellist_surface_destroy(surface);
    }
  harness_context_destroy(context);
}

TEST(binary_stl_is_read)
{
  cellist_context *context = harness_context(1);
  needs_reader(context);
  unsigned char bytes[84 + 50] = {0};
  const float corners[12] = {0, 0, 1, 0, 0, 0, 5, 0, 0, 0, 7, 0};
  bytes[80] = 1;
  memcpy(bytes + 84, corners, sizeof corners);
  cellist_surface *surface = NULL;
  assert_success(context, cellist_surface_read_memory(context, "a.stl", bytes, sizeof bytes, NULL, &surface));
  double bounds[6];
  cellist_surface_bounds(surface, bounds);
  assert_true(bounds[3] == 5 && bounds[4] == 7 && bounds[5] == 0);
  cellist_surface_destroy(surface);
  surface = NULL;
  bytes[80] = 9; /* cut */
  assert_failure(context, cellist_surface_read_memory(context, "a.stl", bytes, sizeof bytes, NULL, &surface),
                 CELLIST_ERROR_FORMAT, "a.stl: ");
  assert_null(surface);
  harness_context_destroy(context);
}

TEST(bad_files_are_refused_with_name_and_reason)
{
  cellist_context *context = harness_context(1);
  needs_reader(context);
  const struct {
    const char *name, *text;
    cellist_result result;
    const char *part;
  } files[] = {
      {"a.txt", STL, CELLIST_ERROR_UNSUPPORTED, "a.txt: surfaces are read from .stl, .obj and .ply"},
      {"stl", STL, CELLIST_ERROR_UNSUPPORTED, "stl: surfaces are read"},
      {"a.stl", "", CELLIST_ERROR_FORMAT, "a.stl: the file is empty"},
      {"a.ply", "not a ply", CELLIST_ERROR_FORMAT, "a.ply: not a PLY file"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", CELLIST_ERROR_FORMAT, "a.obj: "},
      {"a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n", CELLIST_ERROR_FORMAT, "a.obj: "},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", CELLIST_ERROR_FORMAT, "a.obj: "},
      {"n.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", CELLIST_ERROR_GEOMETRY, "n.obj: vertex 1 is not finite"},
      {"n.stl",
       "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 inf "
       "0\nendloop\nendfacet\nendsolid\n",
       CELLIST_ERROR_GEOMETRY, "n.stl: vertex 2 is not finite"}};
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    cellist_surface *surface = NULL;
    assert_failure(context, read_text(context, files[i].name, files[i].text, NULL, &surface), files[i].result,
                   files[i].part);
    assert_null(surface);
  }
  cellist_surface *surface = NULL;
  assert_failure(context, cellist_surface_read(context, "no/such/file.ply", NULL, &surface), CELLIST_ERROR_IO,
                 "no/such/file.ply: No such file");
  harness_context_destroy(context);
}

static cellist_result read_once(cellist_context *context, void *user) {
  (void)user;
  cellist_surface *surface = NULL;
  const cellist_result result = read_text(context, "a.obj", OBJ, NULL, &surface);
  cellist_surface_destroy(surface);
  return result;
}

TEST(every_failed_allocation_of_reading_is_reported)
{
  cellist_context *context = harness_context(1);
  needs_reader(context);
  harness_context_destroy(context);
  check_allocation_failures(read_once, NULL);
}

/* Files that were good until a byte changed, or was cut off: read or refused, never anything else. */
TEST(changed_files_are_read_or_refused)
{
  cellist_context *context = harness_context(1);
  needs_reader(context);
  const char *const names[] = {"a.stl", "a.obj", "a.ply"}, *const texts[] = {STL, OBJ, PLY};
  random_state random = {77};
  size_t good = 0;
  for (int round = 0; round < 1500; round++) {
    char text[512];
    const size_t which = (size_t)round % 3, length = strlen(texts[which]);
    memcpy(text, texts[which], length);
    for (uint64_t change = random_below(&random, 3) + 1; change > 0; change--)
      text[random_below(&random, length)] =
          (char)(random_below(&random, 2) ? '0' + random_below(&random, 10) : random_below(&random, 256));
    cellist_surface *surface = NULL;
    const size_t size = random_below(&random, 4) ? length : random_below(&random, length + 1);
    const cellist_result result = cellist_surface_read_memory(context, names[which], text, size, NULL, &surface);
    assert_true((result == CELLIST_SUCCESS) == (surface != NULL));
    good += result == CELLIST_SUCCESS;
    if (result != CELLIST_SUCCESS) assert_true(strncmp(cellist_context_take_error(context), names[which], 5) == 0);
    cellist_surface_destroy(surface);
  }
  assert_true(good > 100);
  harness_context_destroy(context);
}
