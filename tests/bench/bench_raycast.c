/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of the fast caster: bench_raycast [-r REPEATS] [-t TRANSFER] [-e] [NAME...], names of shared meshes
 * (post.vtu) or balls (ball:1000000). View and optics are those of cli.md (--orbit 30.96,34.45, --unit diagonal/50).
 * Prints CSV, one line a measurement:
 *   walk, exact   one worker, 512x512, processor time without vertices and entries, ns a cell step; for each layout
 *                 and kernel, and for two ways without compact cells, on the same entries: plain80 (four planes and
 *                 four neighbours in float, 80 bytes, four-plane exit tests; its scalar comes from a gradient of 16
 * more bytes) and double (the same in double, with the reference's exact integrals); walk: a transfer function without
 * extinction, so that only cells are passed entries       one worker, processor time of vertices, bins and entries;
 * share: of the whole frame frame         two workers, 512x512 and 1024x1024, wall time of a whole frame error with -e:
 * rmse over covered pixels and the time of the reference Every figure is the least of REPEATS runs: they measure the
 * code and not the machine's other guests. */
#define _POSIX_C_SOURCE 200809L
#include <cellist/generate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../../project/optics/reference_integral.h"
#include "../../project/raycast/fast.h"

static int repeats = 5;
static const char *transfer_name = "ramp";
static const char *const LAYOUTS[FAST_LAYOUT_COUNT] = {"ranked", "tet32", "tet20", "tet16"};

static double seconds(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* A mesh with everything that a measurement needs. */
struct scene {
  const char *name;
  cellist_context *context;
  cellist_mesh *mesh;
  const cellist_mesh_arrays *arrays;
  cellist_scalar scalar;
  cellist_transfer transfer;
  cellist_transfer clear; /* no extinction */
};

static void print(const struct scene *scene, const char *measure, const char *layout, const char *kernel,
                  const char *value_name, double value, const char *other_name, double other) {
  printf("%s,%zu,%s,%s,%s,%s,%s,%.4g,%s,%.7g\n", scene->name, scene->arrays->tet_count, transfer_name, measure, layout,
         kernel, value_name, value, other_name, other);
  fflush(stdout);
}

/* ---- Walks without compact cells -------------------------------------------------------------------- */

/* Planes n . p = d, outward; the neighbour behind each. 80 bytes in float. */
struct plain_cell {
  float plane[4][4];
  uint32_t neighbour[4];
};

struct double_cell {
  double plane[4][4];
  uint32_t neighbour[4];
};

/* The baselines, run over the entries that the fast caster found. */
struct baseline {
  const struct scene *scene;
  const cellist_frame *frame;
  struct plain_cell *plain;
  struct double_cell *exact;
  double (*gradient)[4]; /* [tets] s = g . p + g[3] */
  float (*gradient_float)[4];
  fast_transfer table; /* world lengths, scalars scaled to 0..1 */
  bool is_double, has_light;
  uint64_t step_count;
  double checksum, seconds;
};

static void cross(double out[3], const double a[3], const double b[3]) {
  for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void fill_cell(struct baseline *base, size_t tet) {
  const cellist_mesh_arrays *mesh = base->scene->arrays;
  const uint32_t *v = &mesh->tets[4 * tet];
  double *g = base->gradient[tet];
  memset(g, 0, 4 * sizeof *g);
  for (int k = 0; k < 4; k++) {
    const double *p[3];
    double u[3], w[3], normal[3], to_corner[3];
    for (int c = 0; c < 3; c++) p[c] = &mesh->positions[3 * (size_t)v[CELLIST_TET_FACE[k][c]]];
    for (int c = 0; c < 3; c++) {
      u[c] = p[1][c] - p[0][c];
      w[c] = p[2][c] - p[0][c];
      to_corner[c] = mesh->positions[3 * (size_t)v[k] + (size_t)c] - p[0][c];
    }
    cross(normal, u, w);
    const double height = dot(normal, to_corner), offset = dot(normal, p[0]);
    const double s = base->scene->scalar.association == CELLIST_ON_POINTS ? base->scene->scalar.values[v[k]]
                                                                          : base->scene->scalar.values[tet];
    for (int c = 0; c < 4; c++) {
      base->exact[tet].plane[k][c] = c < 3 ? normal[c] : offset;
      base->plain[tet].plane[k][c] = (float)(c < 3 ? normal[c] : offset);
      if (height != 0) g[c] += s * (c < 3 ? normal[c] : -offset) / height;
    }
    base->exact[tet].neighbour[k] = base->plain[tet].neighbour[k] = mesh->neighbours[4 * tet + (size_t)k];
  }
  for (int c = 0; c < 4; c++) base->gradient_float[tet][c] = (float)g[c];
}

static void add_double(const struct baseline *base, double from, double to, double length, double light[4]) {
  reference_pieces pieces;
  reference_piece piece;
  reference_pieces_begin(&pieces, &base->scene->transfer, from, to);
  while (reference_pieces_next(&pieces, &piece)) {
    double front, back;
    const double part = piece.share * length;
    const double depth = reference_piece_weights(piece.extinction[0] * part, piece.extinction[1] * part, &front, &back);
    for (int k = 0; k < 3; k++) light[k] += light[3] * (front * piece.colour[0][k] + back * piece.colour[1][k]);
    light[3] *= exp(-depth);
  }
}

static void walk_double(struct baseline *base, uint32_t tet, double z, const double origin[3],
                        const double direction[3], double stretch, double light[4]) {
  uint32_t prior = CELLIST_NONE;
  for (size_t step = 0; step < base->scene->arrays->tet_count && light[3] > FAST_OPAQUE; step++) {
    const struct double_cell *cell = &base->exact[tet];
    double exit_z = INFINITY;
    uint32_t next = CELLIST_NONE;
    for (int k = 0; k < 4; k++) {
      const double along = dot(cell->plane[k], direction);
      if (along <= 0 || (cell->neighbour[k] == prior && prior != CELLIST_NONE)) continue;
      const double at = (cell->plane[k][3] - dot(cell->plane[k], origin)) / along;
      if (at < exit_z) {
        exit_z = at;
        next = cell->neighbour[k];
      }
    }
    base->step_count++;
    if (base->has_light && exit_z > z && isfinite(exit_z)) {
      const double *g = base->gradient[tet];
      const double along = dot(g, direction), start = dot(g, origin) + g[3];
      add_double(base, start + z * along, start + exit_z * along, (exit_z - z) * stretch, light);
    }
    z = fmax(z, exit_z);
    if (next == CELLIST_NONE) return;
    prior = tet;
    tet = next;
  }
}

static void walk_plain(struct baseline *base, uint32_t tet, float z, const float origin[3], const float direction[3],
                       float stretch, fast_light *light) {
  uint32_t prior = CELLIST_NONE, interval = 0, pieces = 0;
  for (size_t step = 0; step < base->scene->arrays->tet_count && light->transmittance > FAST_OPAQUE; step++) {
    const struct plain_cell *cell = &base->plain[tet];
    float exit_z = INFINITY;
    uint32_t next = CELLIST_NONE;
    for (int k = 0; k < 4; k++) {
      const float *n = cell->plane[k];
      const float along = n[0] * direction[0] + n[1] * direction[1] + n[2] * direction[2];
      const float at = (n[3] - n[0] * origin[0] - n[1] * origin[1] - n[2] * origin[2]) / along;
      if (along > 0 && (cell->neighbour[k] != prior || prior == CELLIST_NONE) && at < exit_z) {
        exit_z = at;
        next = cell->neighbour[k];
      }
    }
    base->step_count++;
    if (base->has_light && exit_z > z && isfinite(exit_z)) {
      const float *g = base->gradient_float[tet];
      const float along = g[0] * direction[0] + g[1] * direction[1] + g[2] * direction[2];
      const float start = g[0] * origin[0] + g[1] * origin[1] + g[2] * origin[2] + g[3];
      const float from = fast_scalar(&base->table, start + z * along);
      const float to = fast_scalar(&base->table, start + exit_z * along);
      const fast_interval *in = &base->table.intervals[interval];
      if (!(from >= in->low && from <= in->high)) interval = fast_find_interval(&base->table, from);
      if (isfinite(from) && isfinite(to))
        interval = fast_add_segment(&base->table, interval, from, to, (exit_z - z) * stretch, light, &pieces, NULL);
    }
    z = fmaxf(z, exit_z);
    if (next == CELLIST_NONE) return;
    prior = tet;
    tet = next;
  }
}

static void walk_entries(void *user, const fast_scene *fast, const fast_tile *tile) {
  struct baseline *base = user;
  const double begin = seconds(CLOCK_PROCESS_CPUTIME_ID);
  for (uint32_t i = 0; i < FAST_TILE_PIXELS; i++) {
    const uint32_t at = fast_tile_pixel(i);
    if (tile->first[at] == CELLIST_NONE) continue;
    double origin[3], direction[3], light[4] = {0, 0, 0, 1};
    cellist_frame_ray(base->frame, tile->left + at % FAST_TILE + 0.5, tile->top + at / FAST_TILE + 0.5, origin,
                      direction);
    const double stretch = sqrt(dot(direction, direction));
    float o[3], d[3];
    for (int k = 0; k < 3; k++) {
      o[k] = (float)origin[k];
      d[k] = (float)direction[k];
    }
    fast_light light_float = {{0}, 1, 0};
    for (uint32_t e = tile->first[at]; e != CELLIST_NONE; e = tile->entries[e].next) {
      const double z = fast->unit * tile->entries[e].z;
      if (base->is_double)
        walk_double(base, tile->entries[e].face >> 2, z, origin, direction, stretch, light);
      else
        walk_plain(base, tile->entries[e].face >> 2, (float)z, o, d, (float)stretch, &light_float);
    }
    base->checksum += light[3] + light_float.transmittance;
  }
  base->seconds += seconds(CLOCK_PROCESS_CPUTIME_ID) - begin;
}

/* ---- Measurements ----------------------------------------------------------------------------------- */

/* Least processor time of a frame on one worker. */
static double frame_seconds(fast_caster *caster, const cellist_frame *frame, const cellist_transfer *transfer,
                            const fast_draw_desc *desc, clockid_t clock, fast_stats *stats) {
  double least = INFINITY;
  for (int i = 0; i < repeats; i++) {
    const double begin = seconds(clock);
    if (fast_caster_draw(caster, frame, transfer, desc, NULL, NULL, stats) != CELLIST_SUCCESS) exit(1);
    least = fmin(least, seconds(clock) - begin);
  }
  return least;
}

static void measure_layouts(const struct scene *scene, const cellist_frame *frame) {
  static const char *const KERNELS[] = {"best", "portable"};
  for (int layout = 0; layout < FAST_LAYOUT_COUNT; layout++) {
    fast_caster *caster = NULL;
    if (fast_caster_create(scene->context, scene->arrays, &scene->scalar, (fast_layout)layout, &caster) !=
        CELLIST_SUCCESS)
      exit(1);
    const double tets = (double)scene->arrays->tet_count;
    print(scene, "memory", LAYOUTS[layout], "-", "bytes_per_tet", (double)fast_caster_cell_bytes(caster) / tets,
          "with_vertices", (double)(fast_caster_cell_bytes(caster) + fast_caster_vertex_bytes(caster)) / tets);
    fast_stats stats;
    const fast_draw_desc entries_only = {.skips_walk = true};
    const double entries =
        frame_seconds(caster, frame, &scene->transfer, &entries_only, CLOCK_PROCESS_CPUTIME_ID, &stats);
    for (int kernel = 0; kernel < 2; kernel++) {
      const fast_draw_desc desc = {.kernel = (fast_kernel)kernel};
      const double walk = frame_seconds(caster, frame, &scene->clear, &desc, CLOCK_PROCESS_CPUTIME_ID, &stats);
      print(scene, "walk", LAYOUTS[layout], KERNELS[kernel], "ns_per_step",
            (walk - entries) * 1e9 / (double)stats.step_count, "steps", (double)stats.step_count);
      const double exact = frame_seconds(caster, frame, &scene->transfer, &desc, CLOCK_PROCESS_CPUTIME_ID, &stats);
      print(scene, "exact", LAYOUTS[layout], KERNELS[kernel], "ns_per_step",
            (exact - entries) * 1e9 / (double)stats.step_count, "steps", (double)stats.step_count);
      if (layout == FAST_RANKED && kernel == FAST_KERNEL_BEST)
        print(scene, "entries", LAYOUTS[layout], KERNELS[kernel], "ms", 1e3 * entries, "share", entries / exact);
    }
    fast_caster_destroy(caster);
  }
}

static void measure_baselines(const struct scene *scene, const cellist_frame *frame) {
  const size_t count = scene->arrays->tet_count;
  struct baseline base = {.scene = scene, .frame = frame};
  base.plain = malloc(count * sizeof *base.plain);
  base.exact = malloc(count * sizeof *base.exact);
  base.gradient = malloc(count * sizeof *base.gradient);
  base.gradient_float = malloc(count * sizeof *base.gradient_float);
  fast_caster *caster = NULL;
  if (base.plain == NULL || base.exact == NULL || base.gradient == NULL || base.gradient_float == NULL ||
      fast_caster_create(scene->context, scene->arrays, &scene->scalar, FAST_RANKED, &caster) != CELLIST_SUCCESS ||
      fast_transfer_create(scene->context, &scene->transfer, scene->scalar.minimum, scene->scalar.maximum, 1, true,
                           &base.table) != CELLIST_SUCCESS)
    exit(1);
  for (size_t tet = 0; tet < count; tet++) fill_cell(&base, tet);
  print(scene, "memory", "plain80", "-", "bytes_per_tet", (double)sizeof *base.plain, "with_gradients",
        (double)(sizeof *base.plain + sizeof *base.gradient_float));
  for (int variant = 0; variant < 4; variant++) {
    base.is_double = variant >= 2;
    base.has_light = variant & 1;
    double least = INFINITY;
    for (int i = 0; i < (base.is_double ? 2 : repeats); i++) {
      base.seconds = 0;
      base.step_count = 0;
      fast_stats stats;
      const fast_draw_desc desc = {.skips_walk = true};
      if (fast_caster_draw(caster, frame, &scene->transfer, &desc, walk_entries, &base, &stats) != CELLIST_SUCCESS)
        exit(1);
      least = fmin(least, base.seconds);
    }
    print(scene, base.has_light ? "exact" : "walk", base.is_double ? "double" : "plain80", "portable", "ns_per_step",
          least * 1e9 / (double)base.step_count, "steps", (double)base.step_count);
  }
  fast_transfer_release(scene->context, &base.table);
  fast_caster_destroy(caster);
  free(base.plain);
  free(base.exact);
  free(base.gradient);
  free(base.gradient_float);
}

static void measure_frames(struct scene *scene, const cellist_view *view, bool wants_error) {
  cellist_context *context = NULL;
  const cellist_context_desc two = {.worker_count = 2};
  if (cellist_context_create(&two, &context) != CELLIST_SUCCESS) exit(1);
  cellist_raycaster *caster = NULL;
  if (cellist_raycaster_create(context, scene->mesh, &scene->scalar, NULL, &caster) != CELLIST_SUCCESS) exit(1);
  for (uint32_t size = 512; size <= 1024; size *= 2) {
    const size_t count = (size_t)size * size;
    cellist_frame frame;
    double *rgba[2] = {malloc(4 * count * sizeof(double)), malloc(4 * count * sizeof(double))};
    double least[2] = {INFINITY, INFINITY};
    cellist_raycast_stats stats;
    if (cellist_frame_from_view(context, view, size, size, &frame) != CELLIST_SUCCESS) exit(1);
    for (int precision = 0; precision < (wants_error && size == 512 ? 2 : 1); precision++) {
      const cellist_raycast_desc desc = {.precision = (cellist_precision)precision};
      const cellist_raycast_output output = {.rgba = rgba[precision]};
      for (int i = 0; i < (precision == CELLIST_PRECISION_FAST ? repeats : 1); i++) {
        const double begin = seconds(CLOCK_MONOTONIC);
        if (cellist_raycaster_render(caster, &frame, &scene->transfer, &desc, &output, &stats) != CELLIST_SUCCESS)
          exit(1);
        least[precision] = fmin(least[precision], seconds(CLOCK_MONOTONIC) - begin);
      }
      if (precision == CELLIST_PRECISION_FAST) {
        print(scene, size == 512 ? "frame512" : "frame1024", LAYOUTS[FAST_RANKED], "best", "ms", 1e3 * least[0],
              "retries", (double)stats.retry_count);
        continue;
      }
      double sum = 0;
      size_t covered = 0;
      for (size_t i = 0; i < count; i++) {
        covered += rgba[0][4 * i + 3] > 0 || rgba[1][4 * i + 3] > 0;
        for (size_t k = 4 * i; k < 4 * i + 4; k++) sum += (rgba[0][k] - rgba[1][k]) * (rgba[0][k] - rgba[1][k]);
      }
      print(scene, "error", LAYOUTS[FAST_RANKED], "best", "rmse", sqrt(sum / (4 * (double)covered)), "reference_ms",
            1e3 * least[1]);
    }
    free(rgba[0]);
    free(rgba[1]);
  }
  cellist_raycaster_destroy(caster);
  cellist_context_destroy(context);
}

static cellist_result load(cellist_context *context, const char *name, cellist_mesh **mesh) {
  if (strncmp(name, "ball:", 5) == 0) {
    const cellist_generate_desc desc = {.size = strtoull(name + 5, NULL, 10)};
    return cellist_generate(context, "ball", &desc, mesh);
  }
  char path[1024];
  snprintf(path, sizeof path, "%s/data/%s", CELLIST_SHARED_DIR, name);
  return cellist_mesh_read(context, path, NULL, mesh);
}

static int measure(cellist_context *context, const char *name, bool wants_error) {
  struct scene scene = {.name = name, .context = context};
  cellist_result result = load(context, name, &scene.mesh);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, scene.mesh, NULL, &scene.scalar);
  if (result == CELLIST_SUCCESS) {
    scene.arrays = cellist_mesh_get_arrays(scene.mesh);
    double diagonal = 0;
    for (int k = 0; k < 3; k++) diagonal = hypot(diagonal, scene.arrays->bounds[3 + k] - scene.arrays->bounds[k]);
    const cellist_transfer_desc desc = {
        .source = transfer_name, .range = {scene.scalar.minimum, scene.scalar.maximum}, .unit_distance = diagonal / 50};
    result = cellist_transfer_load(context, &desc, &scene.transfer);
  }
  cellist_transfer_knot knot = {0};
  scene.clear = (cellist_transfer){1, &knot};
  cellist_frame frame;
  cellist_view view;
  if (result == CELLIST_SUCCESS) {
    view = cellist_view_orbit(scene.arrays->bounds, 30.96, 34.45);
    result = cellist_frame_from_view(context, &view, 512, 512, &frame);
  }
  if (result == CELLIST_SUCCESS) {
    measure_layouts(&scene, &frame);
    measure_baselines(&scene, &frame);
    measure_frames(&scene, &view, wants_error);
  } else {
    fprintf(stderr, "%s: %s\n", name, cellist_context_take_error(context));
  }
  cellist_transfer_release(context, &scene.transfer);
  cellist_scalar_release(context, &scene.scalar);
  cellist_mesh_destroy(scene.mesh);
  return result != CELLIST_SUCCESS;
}

int main(int argc, char **argv) {
  static const char *const STANDARD[] = {"bluntfin.vtu", "post.vtu", "ball:1000000"};
  bool wants_error = false;
  int first = 1;
  for (; first < argc && argv[first][0] == '-'; first++) {
    if (strcmp(argv[first], "-e") == 0) wants_error = true;
    if (strcmp(argv[first], "-r") == 0 && first + 1 < argc) repeats = atoi(argv[++first]);
    if (strcmp(argv[first], "-t") == 0 && first + 1 < argc) transfer_name = argv[++first];
  }
  const int count = first < argc ? argc - first : (int)(sizeof STANDARD / sizeof *STANDARD);
  const char *const *names = first < argc ? (const char *const *)argv + first : STANDARD;
  cellist_context *context = NULL;
  const cellist_context_desc one = {.worker_count = 1};
  if (cellist_context_create(&one, &context) != CELLIST_SUCCESS) return 1;
  printf("mesh,tets,transfer,measure,layout,kernel,unit,value,other_unit,other\n");
  int failures = 0;
  for (int i = 0; i < count; i++) failures += measure(context, names[i], wants_error);
  cellist_context_destroy(context);
  return failures > 0;
}
