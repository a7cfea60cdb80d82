/* SPDX-License-Identifier: BSD-3-Clause
 * The real meshes of the shared data folder: what is known of them from elsewhere, and writing them back. */
#include <math.h>
#include <unistd.h>

#include "formats.h"

static const struct {
  const char *file;
  size_t points, tets, boundary, folded, flat;
} REAL[] = {{"spx.vtu", 2896, 12936, 2760, 0, 0},
            {"bluntfin.vtu", 40921, 187318, 13438, 0, 0},
            {"post.vtu", 108300, 616050, 22200, 0, 0},
            {"impeller.vtu", 15248, 67044, 15996, 0, 0},
            {"sci_torso.vtu", 12207, 71381, 4386, 0, 0},
            {"gears_t.vtu", 9620, 34343, 15734, 0, 0},
            {"disk_out_ref.vtu", 8499, 44832, 3976, 0, 0},
            {"fire.vtu", 12323, 62772, 7092, 0, 0},
            {"bunny_in.vtu", 5433, 22874, 6966, 0, 0},
            {"octopus_low.vtu", 452, 1140, 898, 0, 0},
            {"torus_vt.vtu", 1800, 9216, 1800, 0, 30},
            {"bucky.vtu", 32768, 148955, 11532, 0, 0},
            {"can.vtu", 6724, 28800, 7360 + 2 * 161, 161, 0}};

TEST(every_shared_mesh_has_the_counts_that_its_readme_names)
{
  for (size_t i = 0; i < sizeof REAL / sizeof *REAL; i++) {
    cellist_context *context = harness_context(2);
    cellist_mesh *mesh = NULL;
    assert_success(context, cellist_mesh_read(context, shared_data(REAL[i].file), NULL, &mesh));
    const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
    const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
    assert_int_equal(arrays->point_count, REAL[i].points);
    assert_int_equal(arrays->tet_count, REAL[i].tets);
    assert_int_equal(facts->boundary_face_count, REAL[i].boundary);
    assert_int_equal(facts->folded_face_count, REAL[i].folded);
    assert_int_equal(facts->flat_count, REAL[i].flat);
    assert_int_equal(arrays->field_count, 1);
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
}

TEST(the_crushed_can_of_hexahedra_shows_its_inverted_cells)
{
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, shared_data("can_hex.vtu"), NULL, &mesh));
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  assert_int_equal(facts->file_cell_count, 4800);
  assert_int_equal(arrays->tet_count, 6 * 4800);
  assert_true(facts->inverted_cell_count > 0 && facts->inverted_cell_count <= facts->inverted_count);
  uint8_t *is_inverted = calloc(4800, 1);
  size_t cells = 0;
  for (size_t i = 0; i < arrays->tet_count; i++)
    if (arrays->tet_flags[i] & CELLIST_TET_INVERTED && !is_inverted[arrays->tet_origin[i]]++) cells++;
  assert_int_equal(cells, facts->inverted_cell_count);
  free(is_inverted);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(what_is_written_reads_back_alike)
{
  static const char *const names[] = {"spx.vtu", "torus_vt.vtu", "disk_out_ref.vtu"};
  for (size_t i = 0; i < 3; i++) {
    char path[64];
    snprintf(path, sizeof path, "written_%ld.vtu", (long)getpid());
    cellist_context *context = harness_context(2);
    cellist_mesh *mesh = NULL, *again = NULL;
    assert_success(context, cellist_mesh_read(context, shared_data(names[i]), NULL, &mesh));
    assert_success(context, cellist_mesh_write(context, mesh, path, NULL));
    assert_success(context, cellist_mesh_read(context, path, NULL, &again));
    remove(path);
    assert_same_mesh(mesh, again);
    cellist_mesh_destroy(again);
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
}
