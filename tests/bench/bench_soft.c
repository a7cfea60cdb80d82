/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of the projector: bench_soft [-tTHREADS] MESH... with names of shared meshes (post.vtu). Prints CSV: one
 * line per mesh and size; seconds are medians of five, sort and draw apart. */
#define _POSIX_C_SOURCE 200809L
#include <cellist/soft.h>
#include <cellist/sort.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 7 };

/* Processor time of all threads: what a busy machine leaves comparable. */
static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *values) {
  qsort(values, ROUNDS, sizeof *values, compare);
  return values[0];
}

static cellist_result measure(cellist_context *context, const char *name, uint32_t size) {
  static const char *const channels[] = {"R", "G", "B", "A"};
  char path[1024];
  snprintf(path, sizeof path, "%s/data/%s", CELLIST_SHARED_DIR, name);
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar = {0};
  cellist_transfer transfer = {0};
  cellist_soft *soft = NULL;
  cellist_sorter *sorter = NULL;
  cellist_image *image = NULL;
  cellist_frame frame;
  uint32_t *order = NULL;
  cellist_result result = cellist_mesh_read(context, path, NULL, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, mesh, NULL, &scalar);
  if (result == CELLIST_SUCCESS) {
    const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
    const double *b = arrays->bounds;
    const cellist_transfer_desc desc = {.range = {scalar.minimum, scalar.maximum},
                                        .unit_distance = hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2]) / 50};
    const cellist_view view = cellist_view_orbit(b, 30.96, 34.45);
    const cellist_sorter_desc sorted = {arrays->point_count, arrays->positions,  arrays->tet_count,
                                        arrays->tets,        arrays->neighbours, NULL};
    order = malloc(arrays->tet_count * sizeof *order);
    result = order != NULL ? cellist_transfer_load(context, &desc, &transfer) : CELLIST_ERROR_OUT_OF_MEMORY;
    if (result == CELLIST_SUCCESS) result = cellist_frame_from_view(context, &view, size, size, &frame);
    if (result == CELLIST_SUCCESS) result = cellist_sorter_create(context, &sorted, &sorter);
  }
  if (result == CELLIST_SUCCESS) result = cellist_soft_create(context, mesh, &scalar, NULL, &soft);
  if (result == CELLIST_SUCCESS) result = cellist_image_create(context, size, size, channels, 4, &image);
  double sort[ROUNDS] = {0}, draw[ROUNDS] = {0};
  cellist_soft_stats stats = {0};
  for (int i = 0; i < ROUNDS && result == CELLIST_SUCCESS; i++) {
    const double begin = seconds();
    cellist_viewpoint viewpoint = {.parallel = false};
    memcpy(viewpoint.position, frame.eye, sizeof viewpoint.position);
    result = cellist_sorter_sort(sorter, &viewpoint, order, NULL);
    sort[i] = seconds() - begin;
    const cellist_soft_settings settings = {.order = order, .order_count = cellist_mesh_get_arrays(mesh)->tet_count};
    if (result == CELLIST_SUCCESS) result = cellist_soft_render(soft, &frame, &transfer, &settings, image, &stats);
    draw[i] = seconds() - begin - sort[i];
  }
  if (result == CELLIST_SUCCESS) {
    const double sort_seconds = median(sort), draw_seconds = median(draw);
    printf("%s,%u,%u,%zu,%llu,%llu,%llu,%.5f,%.5f,%.2f\n", name, size, cellist_context_worker_count(context),
           cellist_mesh_get_arrays(mesh)->tet_count, (unsigned long long)stats.cell_count,
           (unsigned long long)stats.fragment_count, (unsigned long long)stats.careful_count, sort_seconds,
           draw_seconds, 1e9 * draw_seconds / (double)stats.fragment_count);
  } else {
    fprintf(stderr, "%s: %s\n", name, cellist_context_take_error(context));
  }
  cellist_image_destroy(image);
  cellist_soft_destroy(soft);
  cellist_sorter_destroy(sorter);
  cellist_transfer_release(context, &transfer);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  free(order);
  return result;
}

int main(int argc, char **argv) {
  cellist_context_desc desc = {.worker_count = 2};
  int first = 1;
  if (argc > 1 && strncmp(argv[1], "-t", 2) == 0) desc.worker_count = (unsigned)atoi(argv[first++] + 2);
  cellist_context *context = NULL;
  if (cellist_context_create(&desc, &context) != CELLIST_SUCCESS) return 1;
  printf("mesh,size,threads,tets,cells,fragments,careful,sort_seconds,draw_seconds,draw_ns_per_fragment\n");
  int status = 0;
  for (int i = first; i < argc; i++)
    for (uint32_t size = 512; size <= 1024; size += 512)
      if (measure(context, argv[i], size) != CELLIST_SUCCESS) status = 1;
  cellist_context_destroy(context);
  return status;
}
