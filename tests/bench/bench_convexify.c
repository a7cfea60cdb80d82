/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of the convexifier: bench_convexify [NAME...] with names of shared meshes (spx.vtu) or generators
 * (gears, gears:20000 for a size, gears:20000:7 for parts too). Prints CSV: one line per mesh, exterior and seed. */
#define _POSIX_C_SOURCE 200809L
#include <cellist/convexify.h>
#include <cellist/generate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
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
  cellist_generate(context, generator, &desc, &mesh);
  return mesh;
}

int main(int argc, char **argv) {
  static const char *const standard[] = {"spx.vtu", "bluntfin.vtu", "post.vtu", "disk_out_ref.vtu", "bucky.vtu"};
  static const char *const exteriors[] = {"hull", "box", "grid", "delaunay"};
  int seeds = 1, candidates = 0, only = -1, score = 0, first = 1, merge = 1;
  for (; first < argc && argv[first][0] == '-'; first++) {
    if (strncmp(argv[first], "-s", 2) == 0) seeds = atoi(argv[first] + 2);
    if (strncmp(argv[first], "-k", 2) == 0) candidates = atoi(argv[first] + 2);
    if (strcmp(argv[first], "-paper") == 0) score = 1;
    if (strcmp(argv[first], "-unmerged") == 0) merge = 0;
    for (int e = 0; e < 4; e++)
      if (strcmp(argv[first] + 1, exteriors[e]) == 0) only = e;
  }
  const int count = first < argc ? argc - first : (int)(sizeof standard / sizeof *standard);
  const char *const *names = first < argc ? (const char *const *)argv + first : standard;
  cellist_context *context = NULL;
  if (cellist_context_create(NULL, &context) != CELLIST_SUCCESS) return 1;
  printf("mesh,exterior,seed,exterior_facets,cells,facets,planes,cuts,merges,seconds,volume_error,violations,valid\n");
  for (int i = 0; i < count; i++) {
    cellist_mesh *mesh = load(context, names[i]);
    if (mesh == NULL) {
      fprintf(stderr, "%s: %s\n", names[i], cellist_context_take_error(context));
      continue;
    }
    for (int e = only < 0 ? 0 : only; e <= (only < 0 ? 3 : only); e++) {
      for (int seed = 1; seed <= seeds; seed++) {
        const cellist_convexify_desc desc = {.exterior = (cellist_exterior)e,
                                             .candidates = (uint32_t)candidates,
                                             .score = (cellist_score)score,
                                             .keep_unmerged = !merge,
                                             .seed = (uint64_t)seed};
        cellist_convexify_stats s;
        cellist_complex *complex = NULL;
        const double begin = seconds();
        const cellist_result result = cellist_convexify(context, mesh, &desc, &complex, &s);
        const double end = seconds();
        if (result != CELLIST_SUCCESS) {
          printf("%s,%s,%d,,,,,,,%.3f,,,%s: %s\n", names[i], exteriors[e], seed, end - begin,
                 cellist_result_string(result), cellist_context_take_error(context));
          continue;
        }
        const bool valid = cellist_complex_is_valid(context, complex, mesh);
        printf("%s,%s,%d,%zu,%zu,%zu,%zu,%zu,%zu,%.3f,%.2g,%zu,%s\n", names[i], exteriors[s.exterior], seed,
               s.exterior_facets, s.imaginary_cells, s.facets, s.planes, s.cuts, s.merges, end - begin, s.volume_error,
               s.convexity_violations, valid ? "yes" : cellist_context_take_error(context));
        fflush(stdout);
        cellist_complex_destroy(complex);
      }
    }
    cellist_mesh_destroy(mesh);
  }
  cellist_context_destroy(context);
  return 0;
}
