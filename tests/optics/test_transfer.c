/* SPDX-License-Identifier: BSD-3-Clause
 * Transfer functions: knots, conventions, colour spaces and files. */
#include <cellist/transfer.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "harness.h"

static const char *temporary(const char *text) {
  static char path[64];
  snprintf(path, sizeof path, "transfer-%ld.json", (long)getpid());
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
  return path;
}

static cellist_transfer load(cellist_context *context, const cellist_transfer_desc *desc) {
  cellist_transfer transfer = {0};
  assert_success(context, cellist_transfer_load(context, desc, &transfer));
  assert_true(transfer.knot_count >= 1);
  for (size_t i = 1; i < transfer.knot_count; i++) {
    assert_true(transfer.knots[i].value >= transfer.knots[i - 1].value);
    if (i > 1) assert_true(transfer.knots[i].value > transfer.knots[i - 2].value);
  }
  return transfer;
}

TEST(ramp_has_five_knots_stretched_to_the_range)
{
  cellist_context *context = harness_context(1);
  const cellist_transfer_desc desc = {.range = {-2, 6}, .unit_distance = 0.5};
  cellist_transfer transfer = load(context, &desc);
  assert_int_equal(transfer.knot_count, 5);
  double colour[3];
  for (int i = 0; i <= 64; i++) {
    const double t = i / 64.0;
    const double extinction = cellist_transfer_evaluate(&transfer, -2 + 8 * t, colour);
    assert_true(fabs(extinction - 0.4 * t / 0.5) < 1e-15);
    assert_true(fabs(colour[0] - fmin(1, fmax(0, 4 * t - 2))) < 1e-14);
    assert_true(fabs(colour[1] - fmin(1, fmin(4 * t, 4 - 4 * t))) < 1e-14);
    assert_true(fabs(colour[2] - fmin(1, fmax(0, 2 - 4 * t))) < 1e-14);
  }
  assert_true(cellist_transfer_evaluate(&transfer, 100, colour) == 0.8);
  cellist_transfer_release(context, &transfer);
  harness_context_destroy(context);
}

TEST(every_built_in_loads_and_is_named_once)
{
  cellist_context *context = harness_context(1);
  for (size_t i = 0; cellist_transfer_name(i) != NULL; i++) {
    for (size_t j = 0; j < i; j++) assert_string_not_equal(cellist_transfer_name(i), cellist_transfer_name(j));
    const cellist_transfer_desc desc = {.source = cellist_transfer_name(i), .range = {0, 1}, .unit_distance = 1};
    cellist_transfer transfer = load(context, &desc);
    for (size_t k = 0; k < transfer.knot_count; k++)
      for (int c = 0; c < 3; c++)
        assert_true(transfer.knots[k].colour[c] >= 0 && transfer.knots[k].colour[c] <= 1 + 1e-12);
    cellist_transfer_release(context, &transfer);
  }
  harness_context_destroy(context);
}

TEST(built_ins_are_those_of_the_files)
{
  cellist_context *context = harness_context(1);
  static const char *const names[] = {"ramp", "dense", "spikes"};
  for (int i = 0; i < 3; i++) {
    char relative[64];
    snprintf(relative, sizeof relative, "../tf/%s.json", names[i]);
    cellist_transfer_desc desc = {.source = names[i], .range = {3, 7}, .unit_distance = 0.25, .opacity_scale = 2};
    cellist_transfer built_in = load(context, &desc);
    desc.source = shared_data(relative);
    cellist_transfer file = load(context, &desc);
    assert_int_equal(built_in.knot_count, file.knot_count);
    assert_memory_equal(built_in.knots, file.knots, file.knot_count * sizeof *file.knots);
    cellist_transfer_release(context, &built_in);
    cellist_transfer_release(context, &file);
  }
  harness_context_destroy(context);
}

TEST(image_convention_is_the_logarithm_of_transparency)
{
  cellist_context *context = harness_context(1);
  const cellist_transfer_desc desc = {
      .source = "dense", .range = {0, 1}, .unit_distance = 2, .convention = CELLIST_OPACITY_IMAGE};
  cellist_transfer transfer = load(context, &desc);
  double colour[3];
  const double largest = -log(0.05) / 2;
  for (int i = 0; i <= 1000; i++) {
    const double t = i / 1000.0, opacity = t < 0.2 ? 1.5 * t : 0.3 + (t - 0.2) / 0.8 * 0.65;
    const double extinction = cellist_transfer_evaluate(&transfer, t, colour);
    assert_true(fabs(extinction + log(1 - opacity) / 2) < largest / 1024);
  }
  cellist_transfer_release(context, &transfer);
  harness_context_destroy(context);
}

TEST(sharpness_makes_steps_and_midpoints_move_them)
{
  cellist_context *context = harness_context(1);
  const cellist_transfer_desc desc = {
      .source = temporary("{\"RGBPoints\": [0,1,1,1, 10,1,1,1], \"Points\": [0,0.2,0.25,1, 10,0.8,0.5,0]}"),
      .range = {0, 10},
      .unit_distance = 1};
  cellist_transfer transfer = load(context, &desc);
  double colour[3];
  assert_true(cellist_transfer_evaluate(&transfer, 2.5, colour) == 0.2); /* the first holds at the value */
  assert_true(cellist_transfer_evaluate(&transfer, 2.4, colour) == 0.2);
  assert_true(cellist_transfer_evaluate(&transfer, 2.5000001, colour) == 0.8);
  cellist_transfer_release(context, &transfer);
  remove(desc.source);
  harness_context_destroy(context);
}

TEST(srgb_colours_become_linear)
{
  cellist_context *context = harness_context(1);
  cellist_transfer_desc desc = {
      .source = temporary("[{\"RGBPoints\": [0,0.5,0.5,0.5, 1,1,1,1]}]"), .range = {0, 1}, .unit_distance = 1};
  double colour[3];
  cellist_transfer transfer = load(context, &desc);
  cellist_transfer_evaluate(&transfer, 0, colour);
  assert_true(colour[0] == 0.5);
  cellist_transfer_release(context, &transfer);
  desc.srgb_colours = true;
  transfer = load(context, &desc);
  for (int i = 0; i <= 100; i++) {
    const double srgb = 0.5 + 0.005 * i;
    cellist_transfer_evaluate(&transfer, 0.01 * i, colour);
    assert_true(fabs(colour[1] - pow((srgb + 0.055) / 1.055, 2.4)) < 1.0 / 1024);
  }
  cellist_transfer_release(context, &transfer);
  remove(desc.source);
  harness_context_destroy(context);
}

/* vtkColorTransferFunction's own answers halfway between blue and red, in sRGB bytes (its regression test). */
TEST(colour_spaces_agree_with_vtk)
{
  static const struct {
    const char *space;
    double rgb[3], tolerance;
  } cases[] = {{"RGB", {127.5, 0, 127.5}, 0.01},
               {"HSV", {255, 0, 255}, 0.01},
               {"Lab", {202, 0, 136}, 1.5},
               {"Step", {255, 0, 0}, 0.01},
               {"Diverging", {255, 255, 255}, 0.01}};
  cellist_context *context = harness_context(1);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char text[256];
    snprintf(text, sizeof text, "{\"ColorSpace\": \"%s\", \"RGBPoints\": [0,0,0,1, 1,1,0,0]}", cases[i].space);
    const cellist_transfer_desc desc = {.source = temporary(text), .range = {0, 1}, .unit_distance = 1};
    cellist_transfer transfer = load(context, &desc);
    double colour[3];
    cellist_transfer_evaluate(&transfer, 0.5, colour);
    for (int k = 0; k < 3; k++)
      if (!(fabs(255 * colour[k] - cases[i].rgb[k]) <= cases[i].tolerance))
        fail_msg("%s: component %d is %g, not %g", cases[i].space, k, 255 * colour[k], cases[i].rgb[k]);
    cellist_transfer_release(context, &transfer);
    remove(desc.source);
  }
  harness_context_destroy(context);
}

TEST(cool_warm_is_moreland_s_map)
{
  cellist_context *context = harness_context(1);
  const cellist_transfer_desc desc = {.source = "cool-warm", .range = {0, 1}, .unit_distance = 1};
  cellist_transfer transfer = load(context, &desc);
  /* Moreland 2009, table 1: sRGB bytes at 0, 1/4, 1/2, 3/4, 1. */
  static const double published[5][3] = {
      {59, 76, 192}, {141, 176, 254}, {221, 221, 221}, {244, 154, 123}, {180, 4, 38}};
  for (int i = 0; i < 5; i++) {
    double colour[3];
    cellist_transfer_evaluate(&transfer, 0.25 * i, colour);
    for (int k = 0; k < 3; k++) {
      const double srgb = colour[k] <= 0.0031308 ? 12.92 * colour[k] : 1.055 * pow(colour[k], 1 / 2.4) - 0.055;
      if (!(fabs(255 * srgb - published[i][k]) <= 2))
        fail_msg("at %g: %g, not %g", 0.25 * i, 255 * srgb, published[i][k]);
    }
  }
  cellist_transfer_release(context, &transfer);
  harness_context_destroy(context);
}

TEST(extreme_ranges_keep_ascending_finite_knots)
{
  static const double ranges[][2] = {{0, 0}, {1e9, 1e9 + 1e-3}, {-1e-30, 1e-30}, {-1.7e308, 1.7e308}, {5, 5}};
  cellist_context *context = harness_context(1);
  for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
    const cellist_transfer_desc desc = {.source = "spikes", .range = {ranges[i][0], ranges[i][1]}, .unit_distance = 1};
    cellist_transfer transfer = load(context, &desc);
    for (size_t k = 0; k < transfer.knot_count; k++) assert_true(isfinite(transfer.knots[k].value));
    assert_true(transfer.knots[0].value == ranges[i][0]);
    assert_true(transfer.knots[transfer.knot_count - 1].value == ranges[i][1]);
    cellist_transfer_release(context, &transfer);
  }
  harness_context_destroy(context);
}

TEST(files_that_are_no_transfer_function_are_named)
{
  static const struct {
    const char *text, *message;
  } cases[] = {{"{ not JSON", "line 1: not JSON"},
               {"{\n\"RGBPoints\": [0,\n", "line 3: not JSON"},
               {"", "not JSON"},
               {"3", "not JSON"},
               {"[]", "not a ParaView preset"},
               {"{}", "without \"RGBPoints\""},
               {"{\"RGBPoints\": [0,1,1]}", "groups of four"},
               {"{\"RGBPoints\": [0,1,1,\"x\"]}", "entry 3 of \"RGBPoints\" is not a number"},
               {"{\"RGBPoints\": [1,1,1,1, 0,1,1,1]}", "does not ascend at entry 4"},
               {"{\"RGBPoints\": [0,1,1,-1]}", "negative"},
               {"{\"RGBPoints\": [0,1,1,1], \"Points\": [0,2,0.5,0]}", "not within 0..1"},
               {"{\"RGBPoints\": [0,1,1,1], \"ColorSpace\": \"Nonsense\"}", "'Nonsense' is not one of"}};
  cellist_context *context = harness_context(1);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const cellist_transfer_desc desc = {.source = temporary(cases[i].text), .range = {0, 1}, .unit_distance = 1};
    cellist_transfer transfer = {0};
    const cellist_result result = cellist_transfer_load(context, &desc, &transfer);
    assert_true(result == CELLIST_ERROR_FORMAT || result == CELLIST_ERROR_UNSUPPORTED);
    const char *message = cellist_context_take_error(context);
    if (strstr(message, cases[i].message) == NULL || strstr(message, desc.source) == NULL)
      fail_msg("'%s' does not say '%s'", message, cases[i].message);
    remove(desc.source);
  }
  const cellist_transfer_desc desc = {.source = "nonsense", .range = {0, 1}, .unit_distance = 1};
  cellist_transfer transfer = {0};
  assert_failure(context, cellist_transfer_load(context, &desc, &transfer), CELLIST_ERROR_NOT_FOUND,
                 "'nonsense' is neither a built-in transfer function nor a file");
  harness_context_destroy(context);
}

static cellist_result load_and_release(cellist_context *context, void *user) {
  cellist_transfer transfer = {0};
  const cellist_result result = cellist_transfer_load(context, user, &transfer);
  cellist_transfer_release(context, &transfer);
  return result;
}

TEST(failed_allocations_leak_nothing)
{
  cellist_transfer_desc desc = {.source = "cool-warm", .range = {0, 1}, .unit_distance = 1};
  check_allocation_failures(load_and_release, &desc);
  desc.source = temporary("{\"RGBPoints\": [0,0,0,1, 1,1,0,0], \"Points\": [0,0.2,0.25,0.5, 1,0.8,0.5,0]}");
  check_allocation_failures(load_and_release, &desc);
  remove(desc.source);
}
