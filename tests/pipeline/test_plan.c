/* SPDX-License-Identifier: BSD-3-Clause
 * Plan: what is left out changes no pixel. Random scenes, drawn with the plan and without it. */
#include <cellist/pipeline.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "harness.h"

enum { SCENES = 200, WIDTH = 24, HEIGHT = 18 };

/* A transfer function that is 0 over some of its range. */
static void write_transfer(random_state *random, const char *path, bool one_colour) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  const unsigned count = 2 + random_below(random, 6);
  fprintf(file, "[{\"Name\": \"random\", \"ColorSpace\": \"RGB\", \"Points\": [");
  for (unsigned i = 0; i < count; i++)
    fprintf(file, "%s%.3f, %.3f, 0.5, 0", i > 0 ? ", " : "", i / (count - 1.0),
            random_below(random, 5) < 3 ? 0 : random_between(random, 0.05, 0.9));
  fprintf(file, "], \"RGBPoints\": [");
  double rgb[3] = {0.8, 0.5, 0.2};
  for (unsigned i = 0; i < count; i++) {
    for (int k = 0; k < 3 && !one_colour; k++) rgb[k] = random_between(random, 0, 1);
    fprintf(file, "%s%.3f, %.3f, %.3f, %.3f", i > 0 ? ", " : "", i / (count - 1.0), rgb[0], rgb[1], rgb[2]);
  }
  fprintf(file, "]}]");
  assert_int_equal(fclose(file), 0);
}

struct tally {
  size_t unseen, unsorted, differing;
  double worst;
};

static double difference(const cellist_image *a, const cellist_image *b) {
  static const char *const channels[] = {"R", "G", "B", "A"};
  double worst = 0;
  for (int c = 0; c < 4; c++) {
    const float *x = cellist_image_channel(a, channels[c]), *y = cellist_image_channel(b, channels[c]);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) worst = fmax(worst, fabs((double)x[i] - (double)y[i]));
  }
  return worst;
}

static void draw_both(cellist_context *context, cellist_pipeline_desc *desc, const double orbit[2],
                      struct tally *tally) {
  cellist_image *image[2] = {NULL, NULL};
  cellist_pipeline_stats stats[2];
  for (int plain = 0; plain < 2; plain++) {
    cellist_pipeline *pipeline = NULL;
    desc->no_plan = plain == 1;
    cellist_result result = cellist_pipeline_create(context, desc, &pipeline);
    if (result == CELLIST_SUCCESS) {
      const double *bounds = cellist_mesh_get_arrays(cellist_pipeline_mesh(pipeline))->bounds;
      const cellist_view view = cellist_view_orbit(bounds, orbit[0], orbit[1]);
      result = cellist_pipeline_draw(pipeline, &view, WIDTH, HEIGHT, &image[plain], &stats[plain]);
    }
    cellist_pipeline_destroy(pipeline);
    assert_success(context, result);
  }
  bool unseen = false, unsorted = false;
  for (size_t i = 0; i < stats[0].left_out_count; i++) {
    unseen |= strcmp(stats[0].left_out[i].what, "invisible cells") == 0;
    unsorted |= strcmp(stats[0].left_out[i].what, "sort") == 0 && desc->renderer != CELLIST_RENDERER_CAST;
    assert_true(strlen(stats[0].left_out[i].why) > 0);
  }
  tally->unseen += unseen;
  tally->unsorted += unsorted;
  assert_true(stats[0].visible_cells <= stats[1].visible_cells && (unseen || stats[0].visible_cells > 0));
  const double error = difference(image[0], image[1]);
  tally->worst = fmax(tally->worst, error);
  if (error > 1e-4) {
    tally->differing++;
    print_error("%s, renderer %d, model %d: %g\n", desc->source, (int)desc->renderer, (int)desc->optics.model.model,
                error);
  }
  cellist_image_destroy(image[0]);
  cellist_image_destroy(image[1]);
}

TEST(random_scenes_look_the_same_without_a_plan)
{
  static const char *const sources[] = {"sample:ball:300",     "sample:gears",    "sample:torus",
                                        "sample:swiss-cheese", "sample:grid:384", "sample:two-spheres:500",
                                        "sample:cyclic",       "sample:l-shape"};
  static const cellist_renderer renderers[] = {CELLIST_RENDERER_CAST, CELLIST_RENDERER_SOFT, CELLIST_RENDERER_FACES};
  cellist_context *context = harness_context(2);
  random_state random = {20};
  struct tally tally = {0};
  char path[64];
  snprintf(path, sizeof path, "/tmp/cellist-plan-%ld.json", (long)getpid());
  for (int i = 0; i < SCENES; i++) {
    cellist_isosurface isos[2] = {{random_between(&random, 0, 1), 1}, {random_between(&random, 0, 1), 0.5}};
    cellist_pipeline_desc desc = {.source = sources[random_below(&random, 8)],
                                  .renderer = renderers[random_below(&random, 3)],
                                  .optics = {.transfer = path, .unit_diagonal_fraction = 10}};
    /* Exteriors are chosen by sorting, which takes a while: in one scene of four. */
    if (random_below(&random, 4) > 0) desc.order.exterior = CELLIST_ORDER_NONE;
    desc.precision = random_below(&random, 2) ? CELLIST_PRECISION_FAST : CELLIST_PRECISION_REFERENCE;
    /* Every model through the caster and OpenGL; what soft draws through soft. */
    const unsigned model_count = desc.renderer == CELLIST_RENDERER_SOFT ? 2 : 5;
    desc.optics.model.model = random_below(&random, 3) ? CELLIST_MODEL_EMISSION_ABSORPTION
                                                       : (cellist_model)random_below(&random, model_count);
    if (desc.optics.model.model == CELLIST_MODEL_ISOSURFACES) {
      desc.optics.model.isos = isos;
      desc.optics.model.iso_count = 1 + random_below(&random, 2);
    }
    if (desc.renderer == CELLIST_RENDERER_CAST && random_below(&random, 3) == 0)
      desc.optics.model.light = (cellist_light){.enabled = true, .ambient = 0.4, .diffuse = 0.6};
    write_transfer(&random, path, random_below(&random, 4) == 0);
    const double orbit[2] = {random_between(&random, 0, 360), random_between(&random, -80, 80)};
    draw_both(context, &desc, orbit, &tally);
  }
  unlink(path);
  print_message("seed 20: %zu scenes without invisible cells, %zu without sort, largest difference %g\n", tally.unseen,
                tally.unsorted, tally.worst);
  assert_true(tally.unseen > SCENES / 4 && tally.unsorted > 5);
  assert_int_equal(tally.differing, 0);
  harness_context_destroy(context);
}
