/* SPDX-License-Identifier: BSD-3-Clause
 * Cells that are no tets: they fill the same space, and neighbours cut their shared face alike. */
#include <math.h>
#include <unistd.h>

#include "formats.h"

/* A file of one piece; lists as in the file. */
static const char *make_vtu(const char *points, size_t point_count, size_t cell_count, const char *connectivity,
                            const char *offsets, const char *types, const char *more) {
  static char text[1 << 16];
  snprintf(text, sizeof text,
           "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">"
           "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">%s</DataArray></Points><Cells>"
           "<DataArray type=\"Int64\" Name=\"connectivity\">%s</DataArray>"
           "<DataArray type=\"Int64\" Name=\"offsets\">%s</DataArray>"
           "<DataArray type=\"UInt8\" Name=\"types\">%s</DataArray>%s</Cells></Piece></UnstructuredGrid></VTKFile>",
           point_count, cell_count, points, connectivity, offsets, types, more);
  return text;
}

/* A box of n^3 cubes with the points numbered by a random permutation, each cube a cell of one of VTK's kinds. */
static void check_box(uint64_t seed, int kind) {
  enum { N = 3, POINTS = (N + 1) * (N + 1) * (N + 1) };
  static const int hexahedron[8] = {0, 1, 3, 2, 4, 5, 7, 6};
  static const int wedges[2][6] = {{0, 1, 3, 4, 5, 7}, {0, 3, 2, 4, 7, 6}};
  random_state random = {seed};
  int name[POINTS], at_name[POINTS];
  for (int i = 0; i < POINTS; i++) name[i] = i;
  for (int i = POINTS - 1; i > 0; i--) {
    const int j = (int)random_below(&random, (uint64_t)i + 1), swap = name[i];
    name[i] = name[j];
    name[j] = swap;
  }
  for (int i = 0; i < POINTS; i++) at_name[name[i]] = i;
  struct bytes points = {0}, connectivity = {0}, offsets = {0}, types = {0};
  char number[64];
  for (int i = 0; i < POINTS; i++) {
    const int p = at_name[i];
    snprintf(number, sizeof number, "%d %d %d ", p % (N + 1), p / (N + 1) % (N + 1), p / (N + 1) / (N + 1));
    bytes_text(&points, number);
  }
  int end = 0, cells = 0;
  for (int c = 0; c < N * N * N; c++) {
    const int x = c % N, y = c / N % N, z = c / N / N;
    int corner[8];
    for (int k = 0; k < 8; k++) corner[k] = name[x + (k & 1) + (N + 1) * (y + (k >> 1 & 1) + (N + 1) * (z + (k >> 2)))];
    const int pieces = kind == 13 ? 2 : 1, size = kind == 13 ? 6 : 8;
    for (int piece = 0; piece < pieces; piece++) {
      for (int k = 0; k < size; k++) {
        const int local = kind == 11 ? k : kind == 12 ? hexahedron[k] : wedges[piece][k];
        snprintf(number, sizeof number, "%d ", corner[local]);
        bytes_text(&connectivity, number);
      }
      snprintf(number, sizeof number, "%d ", end += size);
      bytes_text(&offsets, number);
      snprintf(number, sizeof number, "%d ", kind);
      bytes_text(&types, number);
      cells++;
    }
  }
  bytes_add(&points, "", 1), bytes_add(&connectivity, "", 1), bytes_add(&offsets, "", 1), bytes_add(&types, "", 1);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = read_text(context, "box.vtu",
                                 make_vtu((char *)points.data, POINTS, (size_t)cells, (char *)connectivity.data,
                                          (char *)offsets.data, (char *)types.data, ""));
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  assert_int_equal(cellist_mesh_get_arrays(mesh)->tet_count, N * N * N * 6);
  assert_int_equal(facts->boundary_face_count, 12 * N * N); /* no face inside is unmatched */
  assert_int_equal(facts->folded_face_count, 0);
  assert_int_equal(facts->inverted_count, 0);
  assert_int_equal(facts->flat_count, 0);
  assert_true(mesh_volume6(mesh) == 6 * N * N * N);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
  bytes_free(&points);
  bytes_free(&connectivity);
  bytes_free(&offsets);
  bytes_free(&types);
}

TEST(neighbours_cut_their_shared_faces_alike_whatever_the_ids)
{
  for (uint64_t seed = 1; seed <= 20; seed++) {
    check_box(seed, 11);
    check_box(seed, 12);
    check_box(seed, 13);
  }
}

static const char CUBE[] = "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1";

static void check_cell(const char *points, size_t point_count, const char *connectivity, const char *offsets,
                       const char *types, size_t cell_count, const char *more, size_t tet_count, double volume6) {
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh =
      read_text(context, "cell.vtu", make_vtu(points, point_count, cell_count, connectivity, offsets, types, more));
  assert_int_equal(cellist_mesh_get_arrays(mesh)->tet_count, tet_count);
  assert_int_equal(cellist_mesh_get_facts(mesh)->inverted_count, 0);
  assert_int_equal(cellist_mesh_get_facts(mesh)->folded_face_count, 0);
  if (fabs(mesh_volume6(mesh) - volume6) > 1e-12) fail_msg("%g instead of %g", mesh_volume6(mesh), volume6);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(pyramids_wedges_of_both_hands_prisms_and_quadratic_cells_fill_their_space)
{
  check_cell("0 0 0 1 0 0 1 1 0 0 1 0 .5 .5 3", 5, "0 1 2 3 4", "5", "14", 1, "", 2, 6);
  check_cell("0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 0 1 1", 6, "0 1 2 3 4 5", "6", "13", 1, "", 3, 3);
  check_cell("0 0 0 0 1 0 1 0 0 0 0 1 0 1 1 1 0 1", 6, "0 1 2 3 4 5", "6", "13", 1, "", 3, 3);
  check_cell("0 0 0 2 0 0 3 1 0 1 2 0 0 1 0 0 0 1 2 0 1 3 1 1 1 2 1 0 1 1", 10, "0 1 2 3 4 5 6 7 8 9", "10", "15", 1,
             "", 9, 24);
  check_cell("0 0 0 1 0 0 0 1 0 0 0 1 9 9 9 9 9 9 9 9 9 9 9 9 9 9 9 9 9 9", 10, "0 1 2 3 4 5 6 7 8 9", "10", "24", 1,
             "", 1, 1);
}

TEST(a_hexahedron_with_coinciding_corners_loses_only_flat_tets)
{
  check_cell(CUBE, 8, "0 1 2 3 4 4 7 7", "8", "12", 1, "", 3, 3);
  check_cell(CUBE, 8, "0 1 2 3 4 4 4 4", "8", "12", 1, "", 2, 2);
}

/* A cube with one face's list the wrong way round, over a hexahedron on its top. */
TEST(a_polyhedron_agrees_with_the_hexahedron_beside_it)
{
  check_cell("0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 0 0 2 1 0 2 1 1 2 0 1 2", 12,
             "0 1 2 3 4 5 6 7 4 5 6 7 8 9 10 11", "8 16", "42 12", 2,
             "<DataArray type=\"Int64\" Name=\"faces\">6 4 0 1 2 3 4 4 5 6 7 4 0 1 5 4 4 1 2 6 5 4 2 3 7 6 4 3 0 4 7"
             "</DataArray><DataArray type=\"Int64\" Name=\"faceoffsets\">31 -1</DataArray>",
             18, 12);
  cellist_context *context = harness_context(1);
  const char *text =
      make_vtu("0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 0 0 2 1 0 2 1 1 2 0 1 2", 12, 2,
               "0 1 2 3 4 5 6 7 4 5 6 7 8 9 10 11", "8 16", "42 12",
               "<DataArray type=\"Int64\" Name=\"faces\">6 4 0 1 2 3 4 4 5 6 7 4 0 1 5 4 4 1 2 6 5 4 2 3 7 6 4 3 0 4 7"
               "</DataArray><DataArray type=\"Int64\" Name=\"faceoffsets\">31 -1</DataArray>");
  cellist_mesh *mesh = read_text(context, "two.vtu", text);
  assert_int_equal(cellist_mesh_get_facts(mesh)->boundary_face_count, 20); /* ten squares: the shared one matched */
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  size_t of_first = 0;
  for (size_t i = 0; i < a->tet_count; i++) of_first += a->tet_origin[i] == 0;
  assert_int_equal(of_first, 12);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* Two pentagonal prisms share their pentagon; the second one is listed from the other side. */
static const char PRISMS[] =
    "0 0 0 2 0 0 3 1 0 1 2 0 0 1 0 0 0 1 2 0 1 3 1 1 1 2 1 0 1 1 "
    "0 0 2 2 0 2 3 1 2 1 2 2 0 1 2";
static const char PRISM_FACES[] =
    "<DataArray type=\"Int64\" Name=\"faces\">7 5 0 4 3 2 1 5 5 6 7 8 9 4 0 1 6 5 4 1 2 7 6 4 2 3 8 7 4 3 4 9 8 4 4 0 "
    "5 9 "
    "7 5 9 8 7 6 5 5 10 11 12 13 14 4 5 6 11 10 4 6 7 12 11 4 7 8 13 12 4 8 9 14 13 4 9 5 10 14"
    "</DataArray><DataArray type=\"Int64\" Name=\"faceoffsets\">38 76</DataArray>";

static cellist_result read_prisms(cellist_context *context, void *user) {
  const char *text = user;
  cellist_mesh *mesh = NULL;
  const cellist_mesh_read_desc desc = {.merge = true};
  const cellist_result result = cellist_mesh_read_memory(context, "p.vtu", text, strlen(text), &desc, &mesh);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(polyhedra_share_the_middle_of_a_large_face)
{
  const char *text =
      make_vtu(PRISMS, 15, 2, "0 1 2 3 4 5 6 7 8 9 5 6 7 8 9 10 11 12 13 14", "10 20", "42 42", PRISM_FACES);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = read_text(context, "p.vtu", text);
  assert_int_equal(cellist_mesh_get_arrays(mesh)->tet_count, 2 * (5 + 5 + 10));
  assert_int_equal(cellist_mesh_get_arrays(mesh)->point_count, 15 + 2 + 3);
  assert_int_equal(cellist_mesh_get_facts(mesh)->boundary_face_count, 5 + 5 + 20);
  assert_int_equal(cellist_mesh_get_facts(mesh)->unused_point_count, 0);
  if (fabs(mesh_volume6(mesh) - 48) > 1e-12) fail_msg("volume %g", mesh_volume6(mesh));
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
  check_allocation_failures(read_prisms, (void *)text);
}

static void assert_no_polyhedron(const char *points, const char *faces, const char *part) {
  char more[512];
  snprintf(more, sizeof more,
           "<DataArray type=\"Int64\" Name=\"faces\">%s</DataArray><DataArray type=\"Int64\" Name=\"faceoffsets\">99"
           "</DataArray>",
           faces);
  cellist_context *context = harness_context(1);
  assert_unreadable(context, "p.vtu", make_vtu(points, 8, 1, "0 1 2 3", "4", "42", more), CELLIST_ERROR_UNSUPPORTED,
                    part);
  harness_context_destroy(context);
}

TEST(polyhedra_that_cannot_be_are_named)
{
  assert_no_polyhedron(CUBE, "5 4 0 3 2 1 4 4 5 6 7 4 0 1 5 4 4 1 2 6 5 4 2 3 7 6",
                       "cell 0 is a polyhedron that is not closed");
  assert_no_polyhedron(CUBE, "6 4 0 3 2 1 4 4 5 6 7 4 0 1 5 4 4 1 2 6 5 4 2 3 7 6 4 3 0 4", "goes on beyond the end");
  assert_no_polyhedron(CUBE, "6 4 0 3 2 1 4 4 5 6 7 4 0 1 5 4 4 1 2 6 5 4 2 3 7 6 4 3 0 4 8",
                       "a point that is not there");
  /* The top pushed through the bottom. */
  assert_no_polyhedron("0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 -4 0 1 1",
                       "6 4 0 3 2 1 4 4 5 6 7 4 0 1 5 4 4 1 2 6 5 4 2 3 7 6 4 3 0 4 7", "is not convex");
}

TEST(points_within_a_distance_are_joined_to_the_first)
{
  cellist_context *context = harness_context(1);
  const char *text = make_vtu("0 0 0 1 0 0 0 1 0 0 0 1 1.001 0 0 0 1 0.001 -0.001 0 1 1 1 1", 8, 2, "0 1 2 3 4 5 6 7",
                              "4 8", "10 10", "");
  for (int i = 0; i < 3; i++) {
    const cellist_mesh_read_desc desc = {.merge = i > 0, .merge_distance = i > 1 ? 0.0011 : 0};
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_mesh_read_memory(context, "m.vtu", text, strlen(text), &desc, &mesh));
    assert_int_equal(cellist_mesh_get_facts(mesh)->merged_point_count, i > 1 ? 3 : 0);
    assert_int_equal(cellist_mesh_get_facts(mesh)->boundary_face_count, i > 1 ? 6 : 8);
    const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
    bool has_last = false;
    for (size_t p = 0; p < a->point_count; p++) has_last |= a->point_origin[p] == 7;
    assert_true(has_last); /* ids stay the file's */
    cellist_mesh_destroy(mesh);
  }
  const cellist_mesh_read_desc bad = {.merge = true, .merge_distance = 1e-30};
  cellist_mesh *mesh = NULL;
  assert_failure(context, cellist_mesh_read_memory(context, "m.vtu", text, strlen(text), &bad, &mesh),
                 CELLIST_ERROR_INVALID_ARGUMENT, "too small");
  harness_context_destroy(context);
}

TEST(legacy_files_that_are_written_read_back_alike)
{
  cellist_context *context = harness_context(2);
  const char *text = make_vtu(CUBE, 8, 1, "0 1 2 3 4 5 6 7", "8", "12", "");
  cellist_mesh *mesh = read_text(context, "c.vtu", text), *again = NULL;
  const uint32_t tets[] = {0, 1, 2, 3, 1, 2, 3, 4};
  const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, values[] = {0.1, 2, 3, 4, 5, 6, 7, 8, NAN, 10};
  const cellist_field fields[] = {{"a b", CELLIST_ON_POINTS, 2, values}, {"c<\"&", CELLIST_ON_CELLS, 1, values}};
  const cellist_mesh_desc desc = {5, points, 2, tets, NULL, 2, fields};
  cellist_mesh_destroy(mesh);
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  static const char *const endings[] = {"vtk", "vtu"};
  for (int i = 0; i < 2; i++) {
    char path[64];
    snprintf(path, sizeof path, "cells_%p.%s", (void *)mesh, endings[i]);
    assert_success(context, cellist_mesh_write(context, mesh, path, NULL));
    assert_success(context, cellist_mesh_read(context, path, NULL, &again));
    remove(path);
    assert_same_mesh(mesh, again);
    cellist_mesh_destroy(again);
  }
  assert_failure(context, cellist_mesh_write(context, mesh, "no/such/folder/a.vtu", NULL), CELLIST_ERROR_IO,
                 "no/such/folder/a.vtu: cannot be written: No such file");
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

struct written {
  const char *text, *path;
};

static cellist_result read_and_write(cellist_context *context, void *user) {
  const struct written *written = user;
  cellist_mesh *mesh = NULL;
  cellist_result result = cellist_mesh_read_memory(context, "w.vtu", written->text, strlen(written->text), NULL, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_mesh_write(context, mesh, written->path, NULL);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(every_failed_allocation_while_writing_is_reported_and_leaves_no_file)
{
  static const char *const endings[] = {"vtk", "vtu"};
  for (int i = 0; i < 2; i++) {
    char path[64];
    snprintf(path, sizeof path, "written_%ld.%s", (long)getpid(), endings[i]);
    struct written written = {make_vtu(CUBE, 8, 1, "0 1 2 3 4 5 6 7", "8", "12", ""), path};
    check_allocation_failures(read_and_write, &written);
    assert_int_equal(remove(path), 0); /* of the last call, which succeeded */
    char part[96];
    snprintf(part, sizeof part, "%s.%ld.part", path, (long)getpid());
    assert_int_equal(access(part, F_OK), -1);
  }
}
