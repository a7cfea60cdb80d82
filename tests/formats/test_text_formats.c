/* SPDX-License-Identifier: BSD-3-Clause
 * Legacy VTK, TetGen, Gmsh, MEDIT and OFF from files made by hand. All hold the same two tets, of 1/6 and 1/3. */
#include <unistd.h>

#include "formats.h"

/* Points 0 0 0, 1 0 0, 0 1 0, 0 0 1, 1 1 1; tets 0 1 2 3 and 1 2 3 4; value 10 id, where there is one. */
static void check_two_tets(const cellist_mesh *mesh, uint32_t first_cell, const char *field_name) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  assert_int_equal(a->point_count, 5);
  assert_int_equal(a->tet_count, 2);
  assert_true(mesh_volume6(mesh) == 3);
  assert_int_equal(cellist_mesh_get_facts(mesh)->skipped_cell_count, first_cell);
  for (uint32_t t = 0; t < 2; t++) {
    const uint32_t cell = a->tet_origin[t] - first_cell;
    assert_true(cell < 2 && a->tet_origin[1 - t] != a->tet_origin[t]);
    for (int k = 0; k < 4; k++) {
      const uint32_t id = a->point_origin[a->tets[4 * t + (uint32_t)k]];
      assert_true(id >= cell && id <= cell + 3);
    }
  }
  if (field_name == NULL) {
    assert_int_equal(a->field_count, 0);
    return;
  }
  assert_true(a->field_count > 0);
  assert_string_equal(a->fields[0].name, field_name);
  for (size_t i = 0; i < 5; i++) assert_true(a->fields[0].values[i] == 10.0 * a->point_origin[i]);
}

static void check_text(const char *name, const char *text, uint32_t first_cell, const char *field_name) {
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = read_text(context, name, text);
  check_two_tets(mesh, first_cell, field_name);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

static cellist_result read_any(cellist_context *context, void *user) {
  cellist_mesh *mesh = NULL;
  const struct bytes *bytes = user;
  const cellist_result result = cellist_mesh_read_memory(context, "any", bytes->data, bytes->size, NULL, &mesh);
  cellist_mesh_destroy(mesh);
  return result;
}

static const char VTK_TEXT[] =
    "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0\n0 1 0 0 0 1 1 1 "
    "1\n\nCELLS 3 14\n3 0 1 2\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 3\n5\n10\n10\nPOINT_DATA 5\nSCALARS s int 1\n"
    "LOOKUP_TABLE default\n0 10 20 30 40\nVECTORS v double\n1 2 3 4 5 6 7 8 9 1 2 3 4 5 6\nMETADATA\nINFORMATION 0\n\n"
    "CELL_DATA 3\nFIELD FieldData 1\na%20b 2 3 int\n1 2 3 4 5 6\n";

TEST(legacy_text_reads)
{
  check_text("a.vtk", VTK_TEXT, 1, "s");
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = read_text(context, "a.vtk", VTK_TEXT);
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  assert_int_equal(a->field_count, 3);
  assert_string_equal(a->fields[2].name, "a b");
  for (size_t i = 0; i < 2; i++) assert_true(a->fields[2].values[2 * i + 1] == 2 * (a->tet_origin[i] + 1));
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

static void add_floats(struct bytes *bytes, const double *values, size_t count, size_t size) {
  for (size_t i = 0; i < count; i++) bytes_float(bytes, values[i], size, true);
}

static void add_integers(struct bytes *bytes, const int *values, size_t count, size_t size) {
  for (size_t i = 0; i < count; i++) bytes_number(bytes, (uint64_t)values[i], size, true);
}

static const double POINTS[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, VALUES[] = {0, 10, 20, 30, 40};

/* Version 4 or 5, big-endian as ever. */
static struct bytes make_binary_vtk(bool is_5) {
  static const int old_cells[] = {4, 0, 1, 2, 3, 4, 1, 2, 3, 4}, offsets[] = {0, 4, 8}, types[] = {10, 10};
  static const int connectivity[] = {0, 1, 2, 3, 1, 2, 3, 4};
  struct bytes file = {0};
  bytes_text(&file, is_5 ? "# vtk DataFile Version 5.1\n" : "# vtk DataFile Version 4.2\n");
  bytes_text(&file, "t\nBINARY\nDATASET UNSTRUCTURED_GRID\nFIELD F 2\nTIME 1 1 double\n");
  add_floats(&file, VALUES, 1, 8);
  bytes_text(&file, "\nnames 1 2 string\n");
  bytes_add(&file,
            "\xC1"
            "a\xC2"
            "bc",
            5);
  bytes_text(&file, "\nPOINTS 5 double\n");
  add_floats(&file, POINTS, 15, 8);
  bytes_text(&file, is_5 ? "\nCELLS 3 8\nOFFSETS vtktypeint64\n" : "\nCELLS 2 10\n");
  add_integers(&file, is_5 ? offsets : old_cells, is_5 ? 3 : 10, is_5 ? 8 : 4);
  if (is_5) {
    bytes_text(&file, "\nCONNECTIVITY vtktypeint64\n");
    add_integers(&file, connectivity, 8, 8);
  }
  bytes_text(&file, "\nCELL_TYPES 2\n");
  add_integers(&file, types, 2, 4);
  bytes_text(&file, "\nPOINT_DATA 5\nSCALARS s float\nLOOKUP_TABLE t\n");
  add_floats(&file, VALUES, 5, 4);
  bytes_text(&file, "\nLOOKUP_TABLE t 2\n");
  bytes_add(&file, "12345678", 8);
  bytes_text(&file, "\n");
  return file;
}

TEST(legacy_binary_reads_in_both_layouts)
{
  for (int is_5 = 0; is_5 < 2; is_5++) {
    struct bytes file = make_binary_vtk(is_5 != 0);
    cellist_context *context = harness_context(1);
    cellist_mesh *mesh = read_bytes(context, "b.vtk", &file);
    check_two_tets(mesh, 0, "s");
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
    check_allocation_failures(read_any, &file);
    bytes_free(&file);
  }
}

TEST(legacy_structured_grid_of_either_hand)
{
  for (int hand = -1; hand <= 1; hand += 2) {
    char text[512];
    snprintf(
        text, sizeof text,
        "# vtk DataFile Version 2.0\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 8 float\n0 0 0 1 0 "
        "0 0 1 0 1 1 0 0 0 %d 1 0 %d 0 1 %d 1 1 %d\n",
        hand, hand, hand, hand);
    cellist_context *context = harness_context(1);
    cellist_mesh *mesh = read_text(context, "s.vtk", text);
    assert_int_equal(cellist_mesh_get_arrays(mesh)->tet_count, 6);
    assert_int_equal(cellist_mesh_get_facts(mesh)->inverted_count, 0);
    assert_true(mesh_volume6(mesh) == 6);
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
}

static const char GMSH_2[] =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"a\"\n$EndPhysicalNames\n$Nodes\n5\n7 0 0 0\n2 1 0 "
    "0\n3 0 1 0\n4 0 0 1\n900 1 1 1\n$EndNodes\n$Elements\n3\n1 2 2 1 1 7 2 3\n2 4 2 1 1 7 2 3 4\n3 4 2 1 1 2 3 4 "
    "900\n$EndElements\n$NodeData\n1\n\"t\"\n1\n0.0\n3\n0\n1\n5\n7 0\n2 10\n3 20\n4 30\n900 40\n$EndNodeData\n";
static const char GMSH_4[] =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n2 5 1 5\n2 1 1 "
    "1\n1\n0 0 0 .5 .5\n3 1 0 4\n2\n3\n4\n5\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n2 3 1 3\n2 1 2 1\n1 1 2 "
    "3\n3 1 4 2\n2 1 2 3 4\n3 2 3 4 5\n$EndElements\n";

TEST(gmsh_text_of_both_versions_reads)
{
  check_text("two.msh", GMSH_2, 1, "t");
  check_text("four.msh", GMSH_4, 1, NULL);
}

static void add_native(struct bytes *bytes, const int64_t *values, size_t count, size_t size, bool big_endian) {
  for (size_t i = 0; i < count; i++) bytes_number(bytes, (uint64_t)values[i], size, big_endian);
}
#define ADD(size, ...) \
  add_native(&file, (const int64_t[]){__VA_ARGS__}, sizeof((const int64_t[]){__VA_ARGS__}) / 8, size, big_endian)

static struct bytes make_binary_gmsh(bool is_4, bool big_endian) {
  struct bytes file = {0};
  bytes_text(&file, is_4 ? "$MeshFormat\n4.1 1 8\n" : "$MeshFormat\n2.2 1 8\n");
  ADD(4, 1);
  bytes_text(&file, is_4 ? "\n$EndMeshFormat\n$Nodes\n" : "\n$EndMeshFormat\n$Nodes\n5\n");
  if (is_4) {
    ADD(8, 1, 5, 1, 5);
    ADD(4, 3, 1, 0);
    ADD(8, 5, 1, 2, 3, 4, 5);
  }
  for (int i = 0; i < 5; i++) {
    if (!is_4) ADD(4, i + 1);
    for (int k = 0; k < 3; k++) bytes_float(&file, POINTS[3 * i + k], 8, big_endian);
  }
  bytes_text(&file, is_4 ? "\n$EndNodes\n$Elements\n" : "\n$EndNodes\n$Elements\n3\n");
  if (is_4) {
    ADD(8, 2, 3, 1, 3);
    ADD(4, 2, 1, 2);
    ADD(8, 1, 1, 1, 2, 3);
    ADD(4, 3, 1, 4);
    ADD(8, 2, 2, 1, 2, 3, 4, 3, 2, 3, 4, 5);
  } else {
    ADD(4, 2, 1, 2, 1, 1, 1, 1, 2, 3);
    ADD(4, 4, 2, 2, 2, 1, 1, 1, 2, 3, 4, 3, 1, 1, 2, 3, 4, 5);
  }
  bytes_text(&file, "\n$EndElements\n$NodeData\n1\n\"t\"\n1\n0\n3\n0\n1\n5\n");
  for (int i = 0; i < 5; i++) {
    ADD(4, i + 1);
    bytes_float(&file, VALUES[i], 8, big_endian);
  }
  bytes_text(&file, "\n$EndNodeData\n");
  return file;
}

TEST(gmsh_binary_of_both_versions_and_byte_orders_reads)
{
  for (int bits = 0; bits < 4; bits++) {
    struct bytes file = make_binary_gmsh((bits & 1) != 0, (bits & 2) != 0);
    cellist_context *context = harness_context(1);
    cellist_mesh *mesh = read_bytes(context, "b.msh", &file);
    check_two_tets(mesh, 1, "t");
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
    check_allocation_failures(read_any, &file);
    bytes_free(&file);
  }
}

static const char MEDIT[] =
    "MeshVersionFormatted 2\n# made by hand\nDimension\n3\nVertices\n5\n0 0 0 0\n1 0 0 10\n0 1 0 20\n0 0 1 30\n1 1 1 "
    "40\nTriangles 1\n1 2 3 4\nCorners 2\n1\n2\nTetrahedra\n1\n1 2 3 4 0\nTetrahedra 1\n2 3 4 5 0\nEnd\n";

TEST(medit_reads)
{
  check_text("m.mesh", MEDIT, 1, "ref");
  struct bytes file = {0};
  bytes_text(&file, MEDIT);
  check_allocation_failures(read_any, &file);
  bytes_free(&file);
}

TEST(off_reads_with_and_without_its_word_sizes_and_scalars)
{
  static const char scalars[] = "OFF\n5 2 0\n0 0 0 0\n1 0 0 1e1\n0 1 0 20\n0 0 1 30\n1 1 1 40\n0 1 2 3\n1 2 3 4\n";
  check_text("s.off", scalars, 0, "scalar");
  check_text("bare", "5 2\n0 0 0 0\n1 0 0 10\n0 1 0 20\n0 0 1 30\n1 1 1 40.0\n4 0 1 2 3\n4 1 2 3 4\n", 0, "scalar");
  check_text("p.off", "5 2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n0 1 2 3\n1 2 3 4", 0, NULL);
  struct bytes file = {0};
  bytes_text(&file, scalars);
  check_allocation_failures(read_any, &file);
  bytes_free(&file);
}

static void write_text(const char *stem, const char *ending, const char *text, char path[64]) {
  snprintf(path, 64, "%s_%ld%s", stem, (long)getpid(), ending);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
}

static cellist_result read_path(cellist_context *context, void *user) {
  cellist_mesh *mesh = NULL;
  const cellist_result result = cellist_mesh_read(context, user, NULL, &mesh);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(tetgen_reads_from_any_of_its_files)
{
  char node[64], ele[64], face[64];
  for (int first = 0; first < 2; first++) {
    char text[256];
    snprintf(text, sizeof text,
             "# n\n5 3 1 1\n%d 0 0 0 0 1\n%d 1 0 0 10 1\n%d 0 1 0 20 1\n%d 0 0 1 30 0\n%d 1 1 1 40 0\n", first,
             first + 1, first + 2, first + 3, first + 4);
    write_text("tetgen", ".node", text, node);
    snprintf(text, sizeof text, "2 4 1\n%d %d %d %d %d 5\n%d %d %d %d %d 6 # last\n", first, first, first + 1,
             first + 2, first + 3, first + 1, first + 1, first + 2, first + 3, first + 4);
    write_text("tetgen", ".ele", text, ele);
    write_text("tetgen", ".face", "1 1\n0 0 1 2 -1\n", face);
    const char *const paths[] = {node, ele, face};
    for (int i = 0; i < 3; i++) {
      cellist_context *context = harness_context(1);
      cellist_mesh *mesh = NULL;
      assert_success(context, cellist_mesh_read(context, paths[i], NULL, &mesh));
      const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
      assert_int_equal(cellist_mesh_get_facts(mesh)->skipped_cell_count, 1);
      assert_string_equal(a->fields[1].name, "region");
      assert_true(a->fields[1].values[0] == 5.0 + a->tet_origin[0]);
      for (size_t p = 0; p < 5; p++) assert_true(a->fields[0].values[p] == 10.0 * a->point_origin[p]);
      assert_true(mesh_volume6(mesh) == 3);
      cellist_mesh_destroy(mesh);
      harness_context_destroy(context);
    }
  }
  check_allocation_failures(read_path, ele);
  remove(node);
  remove(face);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_failure(context, cellist_mesh_read(context, ele, NULL, &mesh), CELLIST_ERROR_IO, ".node file");
  harness_context_destroy(context);
  remove(ele);
}

/* Every prefix of a text fails cleanly or reads. */
static void check_prefixes(const char *name, const char *text) {
  cellist_context *context = harness_context(1);
  for (size_t size = 1; size < strlen(text); size++) {
    char *exact = malloc(size);
    memcpy(exact, text, size);
    cellist_mesh *mesh = NULL;
    const cellist_result result = cellist_mesh_read_memory(context, name, exact, size, NULL, &mesh);
    const char *message = cellist_context_take_error(context);
    if (result == CELLIST_SUCCESS)
      cellist_mesh_destroy(mesh);
    else
      assert_int_equal(strncmp(message, name, strlen(name)), 0);
    free(exact);
  }
  harness_context_destroy(context);
}

TEST(cut_text_files_are_errors_that_name_the_file)
{
  check_prefixes("cut.vtk", VTK_TEXT);
  check_prefixes("cut.msh", GMSH_2);
  check_prefixes("cut.msh", GMSH_4);
  check_prefixes("cut.mesh", MEDIT);
}

TEST(lies_are_named_with_their_line)
{
  cellist_context *context = harness_context(1);
  const cellist_result format = CELLIST_ERROR_FORMAT;
  assert_unreadable(context, "a.off", "OFF\n4000000000 1\n0 0 0\n", format, "a.off: line 2: ");
  assert_unreadable(context, "a.off", "OFF\n4 1\n0 0 0\n1 0 0\n0 1 x\n0 0 1\n0 1 2 3\n", format,
                    "a.off: line 5: number 2 of point 2");
  assert_unreadable(context, "a.off", "OFF\n4 1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 2 4\n", format,
                    "a.off: cell 0 uses point 4, but there are only 4 points");
  assert_unreadable(context, "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices -1\n", format, "line 3");
  assert_unreadable(context, "a.mesh", "MeshVersionFormatted 2\nDimension 2\n", format, "not three-dimensional");
  assert_unreadable(context, "a.msh", "$MeshFormat\n4.0 0 8\n$EndMeshFormat\n", CELLIST_ERROR_UNSUPPORTED, "4.0");
  assert_unreadable(context, "a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n99999999\n", format,
                    "counts more");
  assert_unreadable(context, "a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n",
                    CELLIST_ERROR_UNSUPPORTED, "POLYDATA");
  assert_unreadable(
      context, "a.vtk",
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4611686018427387904 float\n", format,
      "line 5: POINTS");
  assert_unreadable(context, "a.txt", "hello, world\n", format, "a.txt: is no mesh file that Cellist knows");
  assert_unreadable(context, "a.txt", "", format, "a.txt: is empty");
  harness_context_destroy(context);
}

TEST(numbers_are_read_exactly_whatever_their_length)
{
  static const char *const words[] = {
      "0.1", "-2.5e-3", "1e22", "1e23", "123456789012345678", "4.9e-324", "1.7976931348623157e308",
      ".5",  "3.",      "+7",   "1D2",  "0.30000000000000004"};
  static const double values[] = {0.1, -2.5e-3, 1e22, 1e23, 123456789012345678.0, 4.9e-324, 1.7976931348623157e308,
                                  .5,  3.,      7,    100,  0.30000000000000004};
  cellist_context *context = harness_context(1);
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
    char text[256];
    snprintf(text, sizeof text, "OFF\n4 1\n0 0 0 %s\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 1 2 3\n", words[i]);
    cellist_mesh *mesh = read_text(context, "n.off", text);
    const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
    for (size_t p = 0; p < 4; p++)
      if (a->point_origin[p] == 0 && a->fields[0].values[p] != values[i]) fail_msg("%s", words[i]);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}
