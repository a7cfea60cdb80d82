/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark: reading a VTU file as ParaView writes it (appended raw, zlib) and preparing the mesh, on one core.
 *
 * Prints CSV: tets, seconds for reading (file to grid), seconds for preparing (grid to mesh), the peak of what the
 * allocator gave out in bytes a tet, and the bytes a tet that the mesh keeps.
 * Arguments: files; without any, a Kuhn grid of about a million tets that it writes itself. */
#include <cellist/mesh_write.h>
#include <formats/read.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

struct counting {
  size_t live, peak;
};

/* The size stands in front of the block; 64 bytes keep the alignment. */
static void *counting_allocate(void *user, size_t size) {
  struct counting *counting = user;
  char *block = aligned_alloc(64, (size + 127) / 64 * 64);
  if (block == NULL) return NULL;
  *(size_t *)(void *)block = size;
  counting->live += size;
  if (counting->live > counting->peak) counting->peak = counting->live;
  return block + 64;
}

static void counting_deallocate(void *user, void *block) {
  struct counting *counting = user;
  char *start = (char *)block - 64;
  counting->live -= *(size_t *)(void *)start;
  free(start);
}

static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time); /* of the one thread: other programs do not count */
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static int fail(cellist_context *context) {
  fprintf(stderr, "bench_load: %s\n", cellist_context_take_error(context));
  return EXIT_FAILURE;
}

static int measure(const char *path) {
  struct counting counting = {0};
  const cellist_context_desc desc = {.allocator = {counting_allocate, counting_deallocate, &counting},
                                     .worker_count = 1};
  cellist_context *context = NULL;
  if (cellist_context_create(&desc, &context) != CELLIST_SUCCESS) return EXIT_FAILURE;
  for (int run = 0; run < 3; run++) {
    struct source source;
    struct grid grid = {0};
    cellist_mesh *mesh = NULL;
    counting.peak = counting.live;
    const double begin = now();
    if (source_open(context, path, &source) != CELLIST_SUCCESS ||
        read_vtk_xml(context, &source, &grid) != CELLIST_SUCCESS)
      return fail(context);
    const double middle = now();
    if (grid_to_mesh(context, &grid, NULL, &mesh) != CELLIST_SUCCESS) return fail(context);
    const double end = now();
    source_close(context, &source);
    const double tets = (double)cellist_mesh_get_arrays(mesh)->tet_count;
    printf("%s,%.0f,%.3f,%.3f,%.1f,%.1f\n", path, tets, middle - begin, end - middle, (double)counting.peak / tets,
           (double)counting.live / tets);
    cellist_mesh_destroy(mesh);
  }
  cellist_context_destroy(context);
  return EXIT_SUCCESS;
}

/* n^3 cubes of six tets each, its points moved at random, so that zlib has work to do. */
static int write_grid(const char *path, size_t n) {
  static const unsigned char axes[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const size_t step[3] = {1, n + 1, (n + 1) * (n + 1)}, point_count = (n + 1) * (n + 1) * (n + 1);
  double *points = malloc(3 * point_count * sizeof *points), *values = malloc(point_count * sizeof *values);
  uint32_t *tets = malloc(24 * n * n * n * sizeof *tets);
  cellist_context *context = NULL;
  if (points == NULL || values == NULL || tets == NULL || cellist_context_create(NULL, &context) != CELLIST_SUCCESS)
    return EXIT_FAILURE;
  uint32_t state = 1;
  for (size_t i = 0; i < point_count; i++) {
    for (size_t k = 0; k < 3; k++) {
      state = state * 1664525u + 1013904223u;
      points[3 * i + k] = (float)((double)(i / step[k] % (n + 1)) + 0.2 * (state >> 8) / 16777216.0);
    }
    values[i] = (float)(points[3 * i] * points[3 * i + 1]);
  }
  for (size_t cell = 0; cell < n * n * n; cell++)
    for (size_t t = 0; t < 6; t++) {
      size_t at = cell % n + cell / n % n * step[1] + cell / n / n * step[2];
      for (size_t k = 0; k < 4; k++) {
        tets[24 * cell + 4 * t + k] = (uint32_t)at;
        if (k < 3) at += step[axes[t][k]];
      }
    }
  const cellist_field field = {"scalar", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {point_count, points, 6 * n * n * n, tets, NULL, 1, &field};
  cellist_mesh *mesh = NULL;
  int status = EXIT_SUCCESS;
  if (cellist_mesh_create(context, &desc, &mesh) != CELLIST_SUCCESS ||
      cellist_mesh_write(context, mesh, path, NULL) != CELLIST_SUCCESS)
    status = fail(context);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  free(points);
  free(values);
  free(tets);
  return status;
}

int main(int argc, char **argv) {
  printf("file,tets,seconds_read,seconds_prepare,peak_bytes_per_tet,kept_bytes_per_tet\n");
  if (argc == 1) {
    char path[64];
    snprintf(path, sizeof path, "bench_load_%ld.vtu", (long)getpid());
    int status = write_grid(path, 55);
    if (status == EXIT_SUCCESS) status = measure(path);
    remove(path);
    return status;
  }
  for (int i = 1; i < argc; i++)
    if (measure(argv[i]) != EXIT_SUCCESS) return EXIT_FAILURE;
  return EXIT_SUCCESS;
}
