/* SPDX-License-Identifier: BSD-3-Clause
 * What independent programs write (meshio, gmsh, tetgen; make_files.py beside this file runs them) reads as the mesh
 * that they were given. Skipped where none of them is installed. */
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats.h"

/* Checks one file; tet_count "-": as many as the mesher liked. */
static void check_file(const char *path, const char *tet_count, double volume6) {
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  const cellist_result result = cellist_mesh_read(context, path, NULL, &mesh);
  if (result != CELLIST_SUCCESS) fail_msg("%s: %s", path, cellist_context_take_error(context));
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  if (tet_count[0] != '-' && a->tet_count != strtoul(tet_count, NULL, 10)) fail_msg("%s: %zu tets", path, a->tet_count);
  if (fabs(mesh_volume6(mesh) - volume6) > 1e-9) fail_msg("%s: volume %.12g", path, mesh_volume6(mesh) / 6);
  if (facts->inverted_count > 0) fail_msg("%s: %zu tets are inverted", path, facts->inverted_count);
  if (facts->folded_face_count > 0) fail_msg("%s: %zu faces are folded", path, facts->folded_face_count);
  for (size_t f = 0; f < a->field_count; f++)
    for (size_t i = 0; i < a->point_count && strcmp(a->fields[f].name, "s") == 0; i++)
      if (fabs(a->fields[f].values[i] - a->positions[3 * i] - 10 * a->positions[3 * i + 1]) > 1e-6)
        fail_msg("%s: point %u has %g", path, a->point_origin[i], a->fields[f].values[i]);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(files_of_meshio_gmsh_and_tetgen_read_as_they_were_meant)
{
  char folder[64], command[4096], list[128];
  snprintf(folder, sizeof folder, "independent_%ld", (long)getpid());
  assert_int_equal(mkdir(folder, 0777), 0);
  const char *source = __FILE__;
  snprintf(command, sizeof command, "/usr/bin/python3 '%.*s/make_files.py' %s 2>&1",
           (int)(strrchr(source, '/') - source), source, folder);
  const int status = system(command);
  snprintf(list, sizeof list, "%s/list.txt", folder);
  FILE *file = status == 0 ? fopen(list, "r") : NULL;
  size_t count = 0;
  char name[128], tet_count[32];
  double volume6 = 0;
  while (file != NULL && fscanf(file, "%127s %31s %lf", name, tet_count, &volume6) == 3) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    check_file(path, tet_count, volume6);
    count++;
  }
  if (file != NULL) fclose(file);
  snprintf(command, sizeof command, "rm -r %s", folder);
  assert_int_equal(system(command), 0);
  if (count == 0) SKIP("none of python3-meshio, gmsh and tetgen is installed");
  printf("%zu files\n", count);
}
