/* SPDX-License-Identifier: BSD-3-Clause
 * What generating and validating costs: CSV on standard output, seconds on one worker.
 * check: without the boundary's contacts; contacts: these alone. */
#include <cellist/generate.h>
#include <cellist/validate.h>
#include <stdio.h>
#include <time.h>

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The fastest of a few validations. */
static double fastest(cellist_context *context, const cellist_mesh *mesh, bool ignore_contacts,
                      cellist_report *report) {
  enum { REPEAT = 5 };
  const cellist_validate_desc desc = {.ignore_contacts = ignore_contacts};
  double best = 1e9;
  for (int i = 0; i < REPEAT; i++) {
    const double start = seconds();
    if (cellist_validate(context, mesh, &desc, report) != CELLIST_SUCCESS) return -1;
    const double taken = seconds() - start;
    best = taken < best ? taken : best;
  }
  return best;
}

int main(void) {
  static const struct {
    const char *name;
    size_t size;
  } meshes[] = {{"ball", 1000000},  {"grid", 1000000},  {"gears", 1000000},           {"two-spheres", 100000},
                {"torus", 1000000}, {"plates", 130000}, {"tapered-cylinder", 300000}, {"swiss-cheese", 400000}};
  const cellist_context_desc desc = {.worker_count = 1};
  cellist_context *context = NULL;
  if (cellist_context_create(&desc, &context) != CELLIST_SUCCESS) return 1;
  printf("mesh,tets,boundary_faces,generate_s,check_s,check_ns_per_tet,contacts_s,contacts_us_per_face\n");
  for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++) {
    const cellist_generate_desc generate = {.size = meshes[i].size};
    cellist_mesh *mesh = NULL;
    const double start = seconds();
    if (cellist_generate(context, meshes[i].name, &generate, &mesh) != CELLIST_SUCCESS) {
      fprintf(stderr, "%s\n", cellist_context_take_error(context));
      return 1;
    }
    const double generated = seconds() - start;
    cellist_report report;
    const double check = fastest(context, mesh, true, &report), all = fastest(context, mesh, false, &report);
    const double tets = (double)cellist_mesh_get_arrays(mesh)->tet_count, faces = (double)report.boundary_face_count;
    printf("%s,%.0f,%.0f,%.2f,%.3f,%.0f,%.3f,%.2f\n", meshes[i].name, tets, faces, generated, check, check / tets * 1e9,
           all - check, (all - check) / faces * 1e6);
    cellist_mesh_destroy(mesh);
  }
  cellist_context_destroy(context);
  return 0;
}
