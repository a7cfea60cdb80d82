/* SPDX-License-Identifier: BSD-3-Clause
 * Choice of a renderer: what it depends on, and that it is said. */
#include <cellist/pipeline.h>
#include <string.h>

#include "harness.h"

/* The renderer that AUTO takes, and its reason. */
static const char *chosen(const char *source, cellist_pipeline_desc desc, char reason[96]) {
  cellist_context *context = harness_context(1);
  cellist_pipeline *pipeline = NULL;
  cellist_image *image = NULL;
  cellist_pipeline_stats stats;
  desc.source = source;
  assert_success(context, cellist_pipeline_create(context, &desc, &pipeline));
  assert_success(context, cellist_pipeline_draw(pipeline, NULL, 32, 32, &image, &stats));
  strncpy(reason, stats.renderer_reason, 95);
  reason[95] = '\0';
  const char *renderer = stats.renderer;
  cellist_image_destroy(image);
  cellist_pipeline_destroy(pipeline);
  harness_context_destroy(context);
  return renderer;
}

TEST(the_choice_follows_the_work_that_is_to_be_done)
{
  char reason[96];
  const cellist_pipeline_desc coarse = {.width = 2048, .height = 2048, .frames = 1000};
  assert_string_equal(chosen("sample:grid:500", coarse, reason), "soft");
  assert_non_null(strstr(reason, "counted work"));
  const cellist_pipeline_desc fine = {.width = 64, .height = 64, .frames = 1000};
  assert_string_equal(chosen("sample:grid:50000", fine, reason), "cast");
  /* The same mesh where few cells can show something. */
  cellist_transfer_knot knots[] = {{0, 0, {1, 1, 1}}, {0.83, 0, {1, 1, 1}}, {0.84, 5, {1, 0, 0}}};
  const cellist_transfer window = {sizeof knots / sizeof knots[0], knots};
  const cellist_pipeline_desc sparse = {.width = 512, .height = 512, .frames = 1, .optics = {.function = &window}};
  assert_string_equal(chosen("sample:grid:200000", sparse, reason), "soft");
  const cellist_pipeline_desc dense = {.width = 512, .height = 512, .frames = 1};
  assert_string_equal(chosen("sample:grid:200000", dense, reason), "cast");
}

TEST(what_only_one_renderer_does_goes_to_it)
{
  char reason[96];
  const cellist_pipeline_desc maximum = {.optics = {.model = {.model = CELLIST_MODEL_MAXIMUM}}};
  assert_string_equal(chosen("sample:grid:50000", maximum, reason), "soft");
  const cellist_pipeline_desc precise = {.precision = CELLIST_PRECISION_REFERENCE};
  assert_string_equal(chosen("sample:grid:500", precise, reason), "cast");
  const cellist_pipeline_desc asked = {.renderer = CELLIST_RENDERER_SOFT};
  assert_string_equal(chosen("sample:grid:500", asked, reason), "soft");
  assert_string_equal(reason, "asked for");
}
