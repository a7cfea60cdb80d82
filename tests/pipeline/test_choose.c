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

/* What an error that is asked for makes of a scene. */
static cellist_budget budget_for(cellist_pipeline_desc desc, const cellist_view *view) {
  cellist_context *context = harness_context(1);
  cellist_pipeline *pipeline = NULL;
  cellist_image *image = NULL;
  cellist_pipeline_stats stats;
  desc.source = "sample:grid:5000";
  desc.view = view;
  assert_success(context, cellist_pipeline_create(context, &desc, &pipeline));
  assert_success(context, cellist_pipeline_draw(pipeline, view, 32, 32, &image, &stats));
  cellist_image_destroy(image);
  cellist_pipeline_destroy(pipeline);
  harness_context_destroy(context);
  return stats.budget;
}

TEST(a_budget_knows_what_the_scene_asks_for)
{
  cellist_pipeline_desc desc = {.width = 32, .height = 32, .error = 1e-4};
  assert_string_equal(budget_for(desc, NULL).name, "cast fast");
  /* Narrow peaks are soft's, of the fast ones. */
  cellist_transfer_knot knots[] = {
      {0, 0, {1, 1, 1}}, {0.5, 0, {1, 1, 1}}, {0.500001, 5, {1, 0, 0}}, {0.500002, 0, {1, 1, 1}}};
  const cellist_transfer peak = {sizeof knots / sizeof knots[0], knots};
  desc.optics.function = &peak;
  assert_string_equal(budget_for(desc, NULL).name, "soft");
  desc.optics.function = NULL;
  /* Samples of light are taken until they do, unless their number is given; one gradient a cell needs none. */
  desc.optics.model.light =
      (cellist_light){.enabled = true, .ambient = 0.3, .diffuse = 0.7, .specular = 0.2, .shininess = 20};
  desc.error = 1.0;
  assert_string_equal(budget_for(desc, NULL).name, "lit soft");
  desc.optics.model.sample_count = 4;
  assert_string_equal(budget_for(desc, NULL).name, "lit soft, 4 samples");
  desc.optics.model.sample_count = 0;
  desc.optics.model.light.cell_gradients = true;
  desc.error = 1e-6;
  assert_string_equal(budget_for(desc, NULL).name, "lit soft");
}

TEST(a_budget_counts_what_the_view_shows)
{
  const cellist_pipeline_desc desc = {.width = 512, .height = 512, .error = 1e-4};
  const cellist_view away = {.eye = {5, 5, 5}, .target = {9, 9, 9}, .up = {0, 0, 1}, .fovy_degrees = 30};
  assert_true(budget_for(desc, &away).seconds < 0.7 * budget_for(desc, NULL).seconds);
  assert_null(budget_for((cellist_pipeline_desc){.width = 32}, NULL).name);
}

TEST(an_error_out_of_reach_is_refused)
{
  cellist_context *context = harness_context(1);
  cellist_pipeline *pipeline = NULL;
  const cellist_pipeline_desc desc = {.source = "sample:grid:500", .error = 1e-15};
  assert_int_equal(cellist_pipeline_create(context, &desc, &pipeline), CELLIST_ERROR_UNSUPPORTED);
  assert_non_null(strstr(cellist_context_take_error(context), "no setting is closer"));
  harness_context_destroy(context);
}
