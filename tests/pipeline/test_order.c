/* SPDX-License-Identifier: BSD-3-Clause
 * Order: which exterior a mesh gets, where it is kept, and when a picture needs no sort. */
#define _XOPEN_SOURCE 700
#include <cellist/compare.h>
#include <cellist/pipeline.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "harness.h"

static bool left_out(const cellist_pipeline_stats *stats, const char *what) {
  for (size_t i = 0; i < stats->left_out_count; i++)
    if (strcmp(stats->left_out[i].what, what) == 0) return true;
  return false;
}

TEST(an_eye_that_stays_needs_no_sort)
{
  cellist_context *context = harness_context(2);
  const cellist_pipeline_desc desc = {.source = "sample:gears:2000",
                                      .optics = {.transfer = "viridis", .unit_diagonal_fraction = 20},
                                      .renderer = CELLIST_RENDERER_SOFT};
  cellist_pipeline *pipeline = NULL, *fresh = NULL;
  assert_success(context, cellist_pipeline_create(context, &desc, &pipeline));
  const double *bounds = cellist_mesh_get_arrays(cellist_pipeline_mesh(pipeline))->bounds;
  cellist_view view = cellist_view_orbit(bounds, 20, 30);
  cellist_image *image = NULL, *other = NULL;
  cellist_pipeline_stats stats;
  assert_success(context, cellist_pipeline_draw(pipeline, &view, 40, 30, &image, &stats));
  assert_true(stats.sort_seconds > 0 && !left_out(&stats, "sort (same eye)"));
  assert_string_equal(stats.order, "exact");
  cellist_image_destroy(image);

  /* The head turns, the lens zooms, the picture grows: the picture is what another pipeline draws. */
  for (int k = 0; k < 3; k++) view.target[k] += 0.02 * (bounds[3 + k] - bounds[k]);
  view.fovy_degrees *= 0.6;
  assert_success(context, cellist_pipeline_draw(pipeline, &view, 64, 48, &image, &stats));
  assert_true(stats.sort_seconds == 0 && left_out(&stats, "sort (same eye)"));
  assert_string_equal(stats.order, "exact");
  assert_success(context, cellist_pipeline_create(context, &desc, &fresh));
  assert_success(context, cellist_pipeline_draw(fresh, &view, 64, 48, &other, NULL));
  cellist_image_error error;
  assert_success(context, cellist_image_compare(context, image, other, &error, NULL));
  assert_true(error.covered_pixels > 100 && error.max_abs == 0);
  cellist_image_destroy(image);
  cellist_image_destroy(other);

  view.eye[0] += 0.01 * (bounds[3] - bounds[0]);
  assert_success(context, cellist_pipeline_draw(pipeline, &view, 40, 30, &image, &stats));
  assert_true(stats.sort_seconds > 0 && !left_out(&stats, "sort (same eye)"));
  cellist_image_destroy(image);
  cellist_pipeline_forget_order(pipeline);
  assert_success(context, cellist_pipeline_draw(pipeline, &view, 40, 30, &image, &stats));
  assert_true(stats.sort_seconds > 0);
  cellist_image_destroy(image);
  cellist_pipeline_destroy(pipeline);
  cellist_pipeline_destroy(fresh);
  harness_context_destroy(context);
}

static cellist_order_facts facts_of(cellist_context *context, const cellist_mesh *mesh,
                                    const cellist_order_desc *desc) {
  cellist_order *order = NULL;
  assert_success(context, cellist_order_create(context, mesh, desc, &order));
  const cellist_order_facts facts = *cellist_order_get_facts(order);
  cellist_order_destroy(order);
  return facts;
}

static void remove_directory(const char *directory) {
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", directory);
  assert_int_equal(system(command), 0);
}

TEST(the_choice_is_kept_with_its_reason)
{
  char directory[] = "/tmp/cellist_order_XXXXXX";
  assert_non_null(mkdtemp(directory));
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_pipeline_load(context, "sample:gears:1500", NULL, &mesh));
  const cellist_order_desc desc = {.cache_directory = directory};
  const cellist_order_facts made = facts_of(context, mesh, &desc), kept = facts_of(context, mesh, &desc),
                            alone = facts_of(context, mesh, NULL);
  assert_false(made.cached);
  assert_true(kept.cached);
  assert_false(alone.cached);
  assert_string_equal(made.exterior, kept.exterior);
  assert_string_equal(made.reason, kept.reason);
  assert_string_equal(made.reason, alone.reason);
  assert_int_equal(made.imaginary_cells, kept.imaginary_cells);
  assert_true(strstr(made.reason, made.exterior) != NULL);
  remove_directory(directory);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(one_picture_makes_no_exterior_but_takes_one_that_is_kept)
{
  char directory[] = "/tmp/cellist_order_XXXXXX";
  assert_non_null(mkdtemp(directory));
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_pipeline_load(context, "sample:gears:1500", NULL, &mesh));
  const cellist_order_desc one = {.cache_directory = directory, .pictures = 1}, many = {.cache_directory = directory},
                           told = {.pictures = 1, .exterior = CELLIST_ORDER_HULL};
  cellist_order_facts facts = facts_of(context, mesh, &one);
  assert_string_equal(facts.exterior, "none");
  assert_non_null(strstr(facts.reason, "1 picture would not pay"));
  facts = facts_of(context, mesh, &many);
  assert_true(facts.imaginary_cells > 0 && !facts.cached); /* the first one kept nothing */
  facts = facts_of(context, mesh, &one);
  assert_true(facts.imaginary_cells > 0 && facts.cached);
  assert_string_equal(facts_of(context, mesh, &told).exterior, "hull");
  remove_directory(directory);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(a_convex_mesh_gets_no_exterior)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_pipeline_load(context, "sample:grid:500", NULL, &mesh));
  const cellist_order_desc desc = {.exterior = CELLIST_ORDER_HULL};
  const cellist_order_facts facts = facts_of(context, mesh, &desc);
  assert_true(facts.convex && facts.imaginary_cells == 0);
  assert_string_equal(facts.exterior, "none");
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

static cellist_result order_in(cellist_context *context, void *user) {
  const cellist_order_desc desc = {.exterior = CELLIST_ORDER_HULL};
  cellist_order *order = NULL;
  const cellist_result result = cellist_order_create(context, user, &desc, &order);
  cellist_order_destroy(order);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_pipeline_load(context, "sample:l-shape:60", NULL, &mesh));
  check_allocation_failures(order_in, mesh);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
