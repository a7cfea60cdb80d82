/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of the convexifier: bench_convexify [NAME...] with names of shared meshes (spx.vtu) or generators
 * (gears, gears:20000 for a size, gears:20000:7 for parts too), or spheres:TRIANGLES, two of them. Prints CSV: one line
 * per mesh, exterior and seed; seconds are of the processor. Options first: -hull -box -grid -delaunay, -sSEEDS,
 * -kCANDIDATES, -paper, -unmerged, -cRAYS: counts faults too, along so many lines (tests/convexify/faults.h).
 * -matrix: every concave shared mesh and every generator, in every exterior, with 3 seeds and 20 lines. The exit status
 * is 1 if any line is at fault. */
#define _XOPEN_SOURCE 700
#include <cellist/convexify.h>
#include <cellist/generate.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "../convexify/faults.h"

/* Of this process and of the ended ones that it started: TetGen runs in one. */
static double seconds(void) {
  struct timespec t;
  struct rusage children;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  getrusage(RUSAGE_CHILDREN, &children);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec + (double)(children.ru_utime.tv_sec + children.ru_stime.tv_sec) +
         1e-6 * (double)(children.ru_utime.tv_usec + children.ru_stime.tv_usec);
}

/* Two spheres of about size triangles each, a radius apart: tets from the centres to the surface. Rounded coordinates
 * make every edge of theirs a little convex or reflex, so the space between them takes the most cuts a facet. */
static cellist_mesh *two_spheres(cellist_context *context, size_t size) {
  const uint32_t rings = (uint32_t)fmax(3, sqrt((double)size / 4)), around = 2 * rings;
  const size_t points_each = 3 + (size_t)(rings - 1) * around, tets_each = 2 * (size_t)around * (rings - 1);
  double *points = malloc(2 * points_each * 3 * sizeof *points);
  uint32_t *tets = malloc(2 * tets_each * 4 * sizeof *tets);
  size_t tet = 0;
  for (uint32_t s = 0; s < 2; s++) {
    const uint32_t base = s * (uint32_t)points_each;
    double *p = &points[3 * (size_t)base];
    const double centre[3] = {3.0 * s, 0.3 * s, 0.1 * s};
    for (uint32_t i = 0; i < points_each; i++) {
      const double z = i == 0 ? 0 : i == 1 ? -1 : i == 2 ? 1 : -cos(M_PI * ((i - 3) / around + 1) / rings);
      const double r = i < 3 ? 0 : sqrt(1 - z * z),
                   angle = 2 * M_PI * (i < 3 ? 0 : (i - 3) % around + 0.25 * s) / around;
      const double at[3] = {r * cos(angle), r * sin(angle), z};
      for (int k = 0; k < 3; k++) p[3 * i + (uint32_t)k] = (float)(centre[k] + at[k]);
    }
    for (uint32_t ring = 0; ring < rings; ring++)
      for (uint32_t a = 0; a < around; a++) {
        const uint32_t b = (a + 1) % around, low = base + 3 + (ring - 1) * around, high = base + 3 + ring * around;
        const uint32_t lower[4] = {base, ring > 0 ? low + a : base + 1, ring > 0 ? low + b : base + 1, high + b};
        const uint32_t upper[4] = {base, ring > 0 ? low + a : base + 1, high + b, high + a};
        if (ring > 0) {
          memcpy(&tets[4 * tet++], lower, sizeof lower);
          if (ring == rings - 1) tets[4 * tet - 1] = base + 2;
        }
        if (ring < rings - 1) memcpy(&tets[4 * tet++], upper, sizeof upper);
      }
  }
  const cellist_mesh_desc desc = {.point_count = 2 * points_each, .positions = points, .tet_count = tet, .tets = tets};
  cellist_mesh *mesh = NULL;
  cellist_mesh_create(context, &desc, &mesh);
  free(points);
  free(tets);
  return mesh;
}

static cellist_mesh *load(cellist_context *context, const char *name) {
  cellist_mesh *mesh = NULL;
  if (strstr(name, ".vt") != NULL) {
    char path[1024];
    snprintf(path, sizeof path, "%s/data/%s", CELLIST_SHARED_DIR, name);
    cellist_mesh_read(context, path, NULL, &mesh);
    return mesh;
  }
  char generator[64];
  cellist_generate_desc desc = {0};
  snprintf(generator, sizeof generator, "%s", name);
  char *size = strchr(generator, ':');
  if (size != NULL) {
    *size++ = '\0';
    desc.size = strtoull(size, &size, 10);
    if (*size == ':') desc.parts = (uint32_t)strtoul(size + 1, NULL, 10);
  }
  if (strcmp(generator, "spheres") == 0) return two_spheres(context, desc.size);
  cellist_generate(context, generator, &desc, &mesh);
  return mesh;
}

static const char *const EXTERIORS[] = {"hull", "box", "grid", "delaunay"};
/* What a volume may be off by, of the hull. */
static const double VOLUME_LIMIT = 1e-12;

/* One line. False: something is wrong. */
static bool run(cellist_context *context, const char *name, const cellist_mesh *mesh,
                const cellist_convexify_desc *desc, int rays) {
  cellist_convexify_stats s;
  cellist_complex *complex = NULL;
  const double begin = seconds();
  const cellist_result result = cellist_convexify(context, mesh, desc, &complex, &s);
  const double end = seconds();
  const char *wanted = EXTERIORS[desc->exterior];
  const int seed = (int)desc->seed;
  if (result != CELLIST_SUCCESS) {
    printf("%s,%s,,%d,,,,,,,%.3f,,,,,,,%s: %s\n", name, wanted, seed, end - begin, cellist_result_string(result),
           cellist_context_take_error(context));
    return false;
  }
  const bool valid = cellist_complex_is_valid(context, complex, mesh);
  const ray_faults faults = count_ray_faults(complex, mesh, rays, desc->seed);
  const size_t facet_faults = rays > 0 ? count_facet_faults(complex, mesh) : 0;
  printf("%s,%s,%s,%d,%zu,%zu,%zu,%zu,%zu,%zu,%.3f,%.2g,%zu,%zu,%zu,%zu,%.1g,%s\n", name, wanted, EXTERIORS[s.exterior],
         seed, s.exterior_facets, s.imaginary_cells, s.facets, s.planes, s.cuts, s.merges, end - begin, s.volume_error,
         s.convexity_violations, facet_faults, faults.gaps, faults.overlaps, faults.largest,
         valid ? "yes" : cellist_context_take_error(context));
  fflush(stdout);
  cellist_complex_destroy(complex);
  return valid && s.volume_error <= VOLUME_LIMIT && s.convexity_violations == 0 && facet_faults == 0 &&
         faults.gaps + faults.overlaps == 0;
}

int main(int argc, char **argv) {
  static const char *const standard[] = {"spx.vtu", "bluntfin.vtu", "post.vtu", "disk_out_ref.vtu", "bucky.vtu"};
  enum { MOST = 64 };
  const char *matrix[MOST] = {"spx.vtu",       "bluntfin.vtu",     "post.vtu",        "impeller.vtu", "gears_t.vtu",
                              "sci_torso.vtu", "disk_out_ref.vtu", "octopus_low.vtu", "bunny_in.vtu", "torus_vt.vtu"};
  int seeds = 1, candidates = 0, only = -1, score = 0, first = 1, merge = 1, rays = 0;
  bool all = false;
  for (; first < argc && argv[first][0] == '-'; first++) {
    if (strncmp(argv[first], "-s", 2) == 0) seeds = atoi(argv[first] + 2);
    if (strncmp(argv[first], "-k", 2) == 0) candidates = atoi(argv[first] + 2);
    if (strncmp(argv[first], "-c", 2) == 0) rays = atoi(argv[first] + 2);
    if (strcmp(argv[first], "-paper") == 0) score = 1;
    if (strcmp(argv[first], "-unmerged") == 0) merge = 0;
    if (strcmp(argv[first], "-matrix") == 0) all = true;
    for (int e = 0; e < 4; e++)
      if (strcmp(argv[first] + 1, EXTERIORS[e]) == 0) only = e;
  }
  int count = first < argc ? argc - first : (int)(sizeof standard / sizeof *standard);
  const char *const *names = first < argc ? (const char *const *)argv + first : standard;
  if (all) {
    seeds = 3;
    rays = 20;
  }
  if (all && first == argc) {
    names = matrix;
    for (count = 0; matrix[count] != NULL;) count++;
    for (size_t i = 0; cellist_generator_name(i) != NULL && count < MOST; i++)
      if (strcmp(cellist_generator_name(i), "flaws") != 0) matrix[count++] = cellist_generator_name(i);
  }
  cellist_context *context = NULL;
  if (cellist_context_create(NULL, &context) != CELLIST_SUCCESS) return 1;
  bool sound = true;
  printf(
      "mesh,exterior,made,seed,exterior_facets,cells,facets,planes,cuts,merges,seconds,volume_error,"
      "convexity_violations,facet_violations,gaps,overlaps,largest_gap,valid\n");
  for (int i = 0; i < count; i++) {
    cellist_mesh *mesh = load(context, names[i]);
    if (mesh == NULL) {
      fprintf(stderr, "%s: %s\n", names[i], cellist_context_take_error(context));
      sound = false;
      continue;
    }
    for (int e = only < 0 ? 0 : only; e <= (only < 0 ? 3 : only); e++)
      for (int seed = 1; seed <= seeds; seed++) {
        const cellist_convexify_desc desc = {.exterior = (cellist_exterior)e,
                                             .candidates = (uint32_t)candidates,
                                             .score = (cellist_score)score,
                                             .keep_unmerged = !merge,
                                             .seed = (uint64_t)seed};
        sound &= run(context, names[i], mesh, &desc, rays);
      }
    cellist_mesh_destroy(mesh);
  }
  cellist_context_destroy(context);
  return sound ? 0 : 1;
}
