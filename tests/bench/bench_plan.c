/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark: what leaving out invisible cells saves. A transfer function that is 0 but for a window of the scalar's
 * range, from the whole range to a hundredth of it; frames with the plan and without it in the same run.
 *
 * visible is the part of the cells, fragments the part of the segments that the plan leaves. expected = fixed + 1.3
 * visible (all - fixed), where all is the frame of the whole range without a plan, and fixed the planned frame of what
 * a ten-thousandth of the range shows, at its end with fewer cells: the picture, the context, hardly a cell. bench_plan
 * [-s SIZE] [-r REPEATS] [MESH...]      default: all shared meshes but can, 512, 5 */
#include <cellist/pipeline.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct setting {
  const char *name;
  cellist_renderer renderer;
};

static const struct setting SETTINGS[] = {{"cast", CELLIST_RENDERER_CAST},
                                          {"soft", CELLIST_RENDERER_SOFT},
                                          {"faces", CELLIST_RENDERER_FACES},
                                          {"auto", CELLIST_RENDERER_AUTO}};

struct run {
  cellist_context *context;
  const cellist_mesh *mesh;
  unsigned size, repeats;
};

/* Extinction only for scalars within the window, given as parts of the range: 0.01 apart from a box. */
static cellist_transfer window_transfer(const cellist_scalar *scalar, double low, double high, double extinction,
                                        cellist_transfer_knot knots[6]) {
  const double at[6] = {0, low, low, high, high, 1};
  for (int i = 0; i < 6; i++)
    knots[i] = (cellist_transfer_knot){scalar->minimum + at[i] * (scalar->maximum - scalar->minimum),
                                       i == 2 || i == 3 ? extinction : 0,
                                       {at[i], 0.5, 1 - at[i]}};
  return (cellist_transfer){6, knots};
}

/* The least seconds of sorting and drawing over the repeats; negative if it fails. */
static double frame_seconds(const struct run *run, cellist_renderer renderer, const cellist_transfer *transfer,
                            bool no_plan, cellist_pipeline_stats *stats) {
  const cellist_pipeline_desc desc = {
      .mesh = run->mesh, .frames = 1000, .renderer = renderer, .no_plan = no_plan, .optics = {.function = transfer}};
  cellist_pipeline *pipeline = NULL;
  double least = HUGE_VAL;
  cellist_result result = cellist_pipeline_create(run->context, &desc, &pipeline);
  for (unsigned i = 0; i < run->repeats && result == CELLIST_SUCCESS; i++) {
    cellist_image *image = NULL;
    result = cellist_pipeline_draw(pipeline, NULL, run->size, run->size, &image, stats);
    cellist_image_destroy(image);
    least = fmin(least, stats->sort_seconds + stats->draw_seconds);
  }
  cellist_pipeline_destroy(pipeline);
  if (result == CELLIST_SUCCESS) return least;
  fprintf(stderr, "%s\n", cellist_context_take_error(run->context));
  return -1;
}

static void bench_mesh(const struct run *run, const char *name) {
  cellist_scalar scalar;
  if (cellist_scalar_select(run->context, run->mesh, NULL, &scalar) != CELLIST_SUCCESS) return;
  const double *b = cellist_mesh_get_arrays(run->mesh)->bounds;
  const double extinction = 20 / hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2]);
  const size_t tets = cellist_mesh_get_arrays(run->mesh)->tet_count;
  cellist_transfer_knot knots[6];
  for (size_t s = 0; s < sizeof SETTINGS / sizeof SETTINGS[0]; s++) {
    cellist_pipeline_stats stats = {0};
    double fixed = 0;
    size_t fewest = SIZE_MAX;
    for (int end = 0; end < 2; end++) {
      const cellist_transfer sliver = window_transfer(&scalar, end ? 1 - 1e-4 : 0, end ? 1 : 1e-4, extinction, knots);
      const double seconds = frame_seconds(run, SETTINGS[s].renderer, &sliver, false, &stats);
      if (stats.visible_cells == 0 || stats.visible_cells >= fewest) continue;
      fewest = stats.visible_cells;
      fixed = seconds;
    }
    double all_fragments = 1, all = 0; /* of the widest window, without a plan */
    static const double widths[] = {1, 0.5, 0.2, 0.1, 0.05, 0.01};
    for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++) {
      const cellist_transfer window =
          window_transfer(&scalar, 0.5 - widths[w] / 2, 0.5 + widths[w] / 2, extinction, knots);
      const double full = frame_seconds(run, SETTINGS[s].renderer, &window, true, &stats);
      if (w == 0) {
        all_fragments = (double)stats.fragments;
        all = full;
      }
      const double planned = frame_seconds(run, SETTINGS[s].renderer, &window, false, &stats);
      const double visible = (double)stats.visible_cells / (double)tets;
      const double fragments = (double)stats.fragments / all_fragments;
      const double expected = fixed + 1.3 * visible * fmax(all - fixed, 0);
      printf("%s,%s,%u,%zu,%g,%.4f,%.4f,%.5f,%.5f,%.5f,%.5f,%.2f\n", name, SETTINGS[s].name, run->size, tets, widths[w],
             visible, fragments, fixed, full, planned, expected, planned / expected);
      fflush(stdout);
    }
  }
  cellist_scalar_release(run->context, &scalar);
}

int main(int argc, char **argv) {
  struct run run = {.size = 512, .repeats = 5};
  for (int option; (option = getopt(argc, argv, "s:r:")) != -1;) {
    if (option == 's') run.size = (unsigned)strtoul(optarg, NULL, 10);
    if (option == 'r') run.repeats = (unsigned)strtoul(optarg, NULL, 10);
  }
  if (cellist_context_create(NULL, &run.context) != CELLIST_SUCCESS) return 1;
  static const char *const usual[] = {"spx", "bluntfin", "post", "sci_torso", "impeller", "disk_out_ref", "fire"};
  const size_t count = optind < argc ? (size_t)(argc - optind) : sizeof usual / sizeof usual[0];
  printf(
      "mesh,renderer,size,tets,window,visible,fragments,fixed_s,full_s,planned_s,expected_s,planned_over_expected\n");
  for (size_t i = 0; i < count; i++) {
    char path[1024];
    const char *name = optind < argc ? argv[optind + (int)i] : usual[i];
    snprintf(path, sizeof path, "%s/data/%s.vtu", CELLIST_SHARED_DIR, name);
    cellist_mesh *mesh = NULL;
    if (cellist_pipeline_load(run.context, optind < argc ? name : path, NULL, &mesh) != CELLIST_SUCCESS) {
      fprintf(stderr, "%s\n", cellist_context_take_error(run.context));
      continue;
    }
    run.mesh = mesh;
    bench_mesh(&run, name);
    cellist_mesh_destroy(mesh);
  }
  cellist_context_destroy(run.context);
  return 0;
}
