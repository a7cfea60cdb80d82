/* SPDX-License-Identifier: BSD-3-Clause
 * PLOT3D: every variant of a small grid, and the real ones against the VTU files made of them by other hands. */
#include <math.h>
#include <unistd.h>

#include "formats.h"

struct variant {
  bool big_endian, has_records, is_multi, is_double, has_iblank, is_mirrored;
};

static void add_record(struct bytes *file, const struct variant *v, const struct bytes *content) {
  if (v->has_records) bytes_number(file, content->size, 4, v->big_endian);
  bytes_add(file, content->data, content->size);
  if (v->has_records) bytes_number(file, content->size, 4, v->big_endian);
}

/* Unit cubes: 3 x 2 x 2 points, and 2 x 2 x 3 more at x = 10 if there are several blocks. */
static const size_t SIZES[2][3] = {{3, 2, 2}, {2, 2, 3}};

static struct bytes make_file(const struct variant *v, bool is_solution) {
  struct bytes file = {0}, record = {0};
  const size_t block_count = v->is_multi ? 2 : 1, real = v->is_double ? 8 : 4;
  bytes_number(&record, block_count, 4, v->big_endian);
  if (v->is_multi) add_record(&file, v, &record);
  record.size = 0;
  for (size_t b = 0; b < block_count; b++)
    for (int k = 0; k < 3; k++) bytes_number(&record, SIZES[b][k], 4, v->big_endian);
  add_record(&file, v, &record);
  for (size_t b = 0; b < block_count; b++) {
    const size_t *n = SIZES[b], count = n[0] * n[1] * n[2];
    record.size = 0;
    for (int i = 0; i < 4 && is_solution; i++) bytes_float(&record, i, real, v->big_endian);
    for (size_t k = 0; k < (is_solution ? 5 : 3); k++)
      for (size_t i = 0; i < count; i++) {
        const double at[3] = {(double)(i % n[0]) + 10 * (double)b, (double)(i / n[0] % n[1]),
                              (double)(i / n[0] / n[1]) * (v->is_mirrored ? -1 : 1)};
        bytes_float(&record, is_solution ? 100 * (double)k + at[0] : at[k], real, v->big_endian);
      }
    for (size_t i = 0; i < count && v->has_iblank && !is_solution; i++)
      bytes_number(&record, b == 0 && i == 0 ? 0 : 1, 4, v->big_endian);
    add_record(&file, v, &record);
  }
  bytes_free(&record);
  if (is_solution) bytes_number(&file, 0, 8, false); /* trailing zeros */
  return file;
}

static void write_file(const char *path, struct bytes *bytes) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes->data, 1, bytes->size, file), bytes->size);
  assert_int_equal(fclose(file), 0);
  bytes_free(bytes);
}

static void check_variant(const cellist_mesh *mesh, const struct variant *v) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  assert_int_equal(a->point_count, v->is_multi ? 24 : 12);
  assert_int_equal(facts->file_cell_count, v->is_multi ? 4 : 2);
  assert_int_equal(facts->hidden_cell_count, v->has_iblank);
  assert_int_equal(facts->inverted_count, 0);
  assert_true(mesh_volume6(mesh) == 6 * ((v->is_multi ? 4 : 2) - v->has_iblank));
  assert_int_equal(a->field_count, 3);
  assert_string_equal(a->fields[0].name, "Density");
  assert_string_equal(a->fields[1].name, "Momentum");
  assert_string_equal(a->fields[2].name, "StagnationEnergy");
  for (size_t i = 0; i < a->point_count; i++) {
    assert_true(a->fields[0].values[i] == a->positions[3 * i]);
    assert_true(a->fields[1].values[3 * i + 1] == 200 + a->positions[3 * i]);
    assert_true(a->fields[2].values[i] == 400 + a->positions[3 * i]);
  }
}

TEST(every_variant_is_told_by_its_size)
{
  char grid[64], solution[64];
  snprintf(grid, sizeof grid, "plot3d_%ldxyz.bin", (long)getpid());
  snprintf(solution, sizeof solution, "plot3d_%ldq.bin", (long)getpid());
  for (unsigned bits = 0; bits < 64; bits++) {
    const struct variant v = {(bits & 1) != 0, (bits & 2) != 0,  (bits & 4) != 0,
                              (bits & 8) != 0, (bits & 16) != 0, (bits & 32) != 0};
    struct bytes bytes = make_file(&v, false);
    write_file(grid, &bytes);
    bytes = make_file(&v, true);
    write_file(solution, &bytes);
    cellist_context *context = harness_context(1);
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_mesh_read(context, grid, NULL, &mesh));
    check_variant(mesh, &v);
    cellist_mesh_destroy(mesh);
    const cellist_mesh_read_desc desc = {.solution = grid};
    assert_failure(context, cellist_mesh_read(context, grid, &desc, &mesh), CELLIST_ERROR_FORMAT,
                   "is no PLOT3D solution");
    harness_context_destroy(context);
  }
  remove(grid);
  remove(solution);
}

static cellist_result read_path(cellist_context *context, void *user) {
  cellist_mesh *mesh = NULL;
  const cellist_result result = cellist_mesh_read(context, user, NULL, &mesh);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  char grid[64], solution[64];
  const struct variant v = {.is_multi = true, .has_iblank = true};
  snprintf(grid, sizeof grid, "plot3d_a%ld.xyz", (long)getpid());
  snprintf(solution, sizeof solution, "plot3d_a%ld.q", (long)getpid());
  struct bytes bytes = make_file(&v, false);
  write_file(grid, &bytes);
  bytes = make_file(&v, true);
  write_file(solution, &bytes);
  check_allocation_failures(read_path, grid);
  remove(grid);
  remove(solution);
}

static int compare_points(const void *a, const void *b) {
  const double *p = a, *q = b;
  for (int k = 0; k < 4; k++)
    if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
  return 0;
}

/* x y z value of every point, sorted; free() it. */
static double *sorted_points(const cellist_mesh *mesh, const char *field_name) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  double *points = calloc(a->point_count, 4 * sizeof *points);
  assert_non_null(points);
  for (size_t f = 0; f < a->field_count; f++)
    for (size_t i = 0; i < a->point_count && strcmp(a->fields[f].name, field_name) == 0; i++)
      points[4 * i + 3] = a->fields[f].values[i];
  for (size_t i = 0; i < a->point_count; i++) memcpy(&points[4 * i], &a->positions[3 * i], 3 * sizeof *points);
  qsort(points, a->point_count, 4 * sizeof *points, compare_points);
  return points;
}

static cellist_mesh *read_real(cellist_context *context, const char *name, bool merge) {
  cellist_mesh *mesh = NULL;
  const cellist_mesh_read_desc desc = {.merge = merge};
  assert_success(context, cellist_mesh_read(context, shared_data(name), &desc, &mesh));
  return mesh;
}

TEST(post_with_its_seam_merged_is_the_mesh_of_post_vtu)
{
  cellist_context *context = harness_context(2);
  cellist_mesh *ours = read_real(context, "plot3d/postxyz.bin", true), *other = read_real(context, "post.vtu", false);
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(ours), *b = cellist_mesh_get_arrays(other);
  assert_int_equal(a->point_count, 108300);
  assert_int_equal(b->point_count, 108300);
  assert_int_equal(a->tet_count, 616050);
  assert_int_equal(cellist_mesh_get_facts(ours)->merged_point_count, 1444);
  assert_int_equal(cellist_mesh_get_facts(ours)->boundary_face_count, 22200);
  assert_int_equal(cellist_mesh_get_facts(ours)->flat_count, 0);
  double *p = sorted_points(ours, "StagnationEnergy"), *q = sorted_points(other, "StagnationEnergy");
  assert_memory_equal(p, q, 4 * a->point_count * sizeof *p);
  free(p);
  free(q);
  const double x = mesh_volume6(ours), y = mesh_volume6(other);
  if (fabs(x - y) > 1e-9 * y) fail_msg("volume %.12g instead of %.12g", x / 6, y / 6);
  cellist_mesh_destroy(ours);
  cellist_mesh_destroy(other);
  harness_context_destroy(context);
}

TEST(bluntfin_has_the_points_and_the_volume_of_bluntfin_vtu)
{
  cellist_context *context = harness_context(2);
  cellist_mesh *ours = read_real(context, "plot3d/bluntfinxyz.bin", true);
  cellist_mesh *other = read_real(context, "bluntfin.vtu", false);
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(ours), *b = cellist_mesh_get_arrays(other);
  assert_int_equal(a->point_count, b->point_count);
  assert_int_equal(cellist_mesh_get_facts(ours)->merged_point_count, 39);
  /* The same boundary quadrilaterals: two triangles each, but for those that collapse at the line. */
  assert_int_equal(cellist_mesh_get_facts(ours)->boundary_face_count,
                   cellist_mesh_get_facts(other)->boundary_face_count);
  double *p = sorted_points(ours, "Density"), *q = sorted_points(other, "density");
  for (size_t i = 0; i < a->point_count; i++) assert_memory_equal(&p[4 * i], &q[4 * i], 3 * sizeof *p);
  free(p);
  free(q);
  const double x = mesh_volume6(ours), y = mesh_volume6(other);
  if (fabs(x - y) > 1e-9 * y) fail_msg("volume %.12g instead of %.12g", x / 6, y / 6);
  cellist_mesh_destroy(ours);
  cellist_mesh_destroy(other);
  harness_context_destroy(context);
}
