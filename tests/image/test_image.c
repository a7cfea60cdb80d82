/* SPDX-License-Identifier: BSD-3-Clause
 * Images: what is written comes back; what is broken is refused. */
#include <cellist/image.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "harness.h"

static const char *const CHANNELS[] = {"R", "G", "B", "A", "Z", "error.A"};
enum { WIDTH = 37, HEIGHT = 41, PIXELS = WIDTH * HEIGHT };

static const char *temporary(const char *ending) {
  static char path[128];
  snprintf(path, sizeof path, "image-%ld%s", (long)getpid(), ending);
  return path;
}

/* Random premultiplied colours; the planes Z and error.A hold what a float can hold. */
static cellist_result make(cellist_context *context, cellist_image **image) {
  const cellist_result result = cellist_image_create(context, WIDTH, HEIGHT, CHANNELS, 6, image);
  if (result != CELLIST_SUCCESS) return result;
  random_state random = {7};
  float *plane[6];
  for (int k = 0; k < 6; k++) plane[k] = cellist_image_channel(*image, CHANNELS[k]);
  for (size_t i = 0; i < PIXELS; i++) {
    plane[3][i] = (float)random_unit(&random);
    for (int k = 0; k < 3; k++) plane[k][i] = plane[3][i] * (float)random_unit(&random);
    const uint32_t bits = (uint32_t)random_bits(&random);
    memcpy(&plane[4][i], &bits, 4);
    plane[5][i] = i % 3 == 0 ? INFINITY : i % 3 == 1 ? NAN : -0.0f;
  }
  return CELLIST_SUCCESS;
}

static cellist_result exr_round_trip(cellist_context *context, void *user) {
  (void)user;
  cellist_image *image = NULL, *back = NULL;
  cellist_result result = make(context, &image);
  if (result == CELLIST_SUCCESS) result = cellist_image_set_attribute(image, "camera", "somewhere");
  if (result == CELLIST_SUCCESS) result = cellist_image_set_attribute(image, "camera", "eye 1 2 3");
  if (result == CELLIST_SUCCESS) result = cellist_image_write(context, image, temporary(".exr"), NULL);
  if (result == CELLIST_SUCCESS) result = cellist_image_read(context, temporary(".exr"), &back);
  if (result == CELLIST_SUCCESS) {
    assert_int_equal(cellist_image_width(back), WIDTH);
    assert_int_equal(cellist_image_height(back), HEIGHT);
    assert_int_equal(cellist_image_channel_count(back), 6);
    for (int k = 0; k < 6; k++)
      assert_memory_equal(cellist_image_channel(back, CHANNELS[k]), cellist_image_channel(image, CHANNELS[k]),
                          PIXELS * sizeof(float));
    assert_string_equal(cellist_image_attribute(back, "camera"), "eye 1 2 3");
    assert_null(cellist_image_attribute(back, "nothing"));
  }
  cellist_image_destroy(image);
  cellist_image_destroy(back);
  remove(temporary(".exr"));
  return result;
}

TEST(exr_keeps_every_bit)
{
  cellist_context *context = harness_context(1);
  assert_success(context, exr_round_trip(context, NULL));
  harness_context_destroy(context);
}

static cellist_result png_round_trip(cellist_context *context, void *user) {
  (void)user;
  cellist_image *image = NULL, *back = NULL;
  cellist_result result = make(context, &image);
  if (result == CELLIST_SUCCESS) result = cellist_image_write(context, image, temporary(".png"), NULL);
  if (result == CELLIST_SUCCESS) result = cellist_image_read(context, temporary(".png"), &back);
  if (result == CELLIST_SUCCESS)
    for (int k = 0; k < 4; k++)
      for (size_t i = 0; i < PIXELS; i++) {
        const float a = cellist_image_channel(image, CHANNELS[k])[i], b = cellist_image_channel(back, CHANNELS[k])[i];
        assert_true(fabsf(a - b) < 0.008f); /* half a step of 8 bits, at sRGB's steepest, and that of alpha */
      }
  cellist_image_destroy(image);
  cellist_image_destroy(back);
  remove(temporary(".png"));
  return result;
}

TEST(png_keeps_colours_to_eight_bits)
{
  cellist_context *context = harness_context(1);
  assert_success(context, png_round_trip(context, NULL));
  harness_context_destroy(context);
}

TEST(png_is_composited_in_linear_light)
{
  cellist_context *context = harness_context(1);
  cellist_image *image = NULL, *back = NULL;
  assert_success(context, cellist_image_create(context, 1, 1, CHANNELS, 4, &image));
  cellist_image_channel(image, "R")[0] = 0.25f;
  cellist_image_channel(image, "A")[0] = 0.5f;
  const double background[3] = {1, 0.5, 0};
  assert_success(context, cellist_image_write(context, image, temporary(".png"), background));
  assert_success(context, cellist_image_read(context, temporary(".png"), &back));
  assert_true(fabsf(cellist_image_channel(back, "R")[0] - 0.75f) < 0.005f);
  assert_true(fabsf(cellist_image_channel(back, "G")[0] - 0.25f) < 0.005f);
  assert_true(cellist_image_channel(back, "B")[0] == 0 && cellist_image_channel(back, "A")[0] == 1);
  remove(temporary(".png"));
  cellist_image_destroy(image);
  cellist_image_destroy(back);
  harness_context_destroy(context);
}

TEST(failed_allocations_leak_nothing)
{
  check_allocation_failures(exr_round_trip, NULL);
  check_allocation_failures(png_round_trip, NULL);
}

TEST(a_file_that_cannot_be_written_is_named_and_leaves_nothing)
{
  cellist_context *context = harness_context(1);
  cellist_image *image = NULL;
  assert_success(context, make(context, &image));
  assert_failure(context, cellist_image_write(context, image, "no/such/folder/a.exr", NULL), CELLIST_ERROR_IO,
                 "no/such/folder/a.exr: cannot be written: No such file");
  assert_failure(context, cellist_image_write(context, image, "a.bmp", NULL), CELLIST_ERROR_INVALID_ARGUMENT,
                 "must end in .exr or .png");
  cellist_image_destroy(image);
  harness_context_destroy(context);
}

static void damage_and_read(cellist_context *context, const char *path) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  static uint8_t bytes[1 << 20];
  const size_t size = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  random_state random = {9};
  for (int round = 0; round < 400; round++) {
    static uint8_t damaged[1 << 20];
    memcpy(damaged, bytes, size);
    size_t length = size;
    if (round % 2 == 0) length = (size_t)random_below(&random, size);
    for (int i = 0; i < round % 8; i++)
      damaged[random_below(&random, size)] ^= (uint8_t)(1 + random_below(&random, 255));
    file = fopen(path, "wb");
    fwrite(damaged, 1, length, file);
    fclose(file);
    cellist_image *image = NULL;
    const cellist_result result = cellist_image_read(context, path, &image);
    if (result != CELLIST_SUCCESS) {
      assert_null(image);
      assert_non_null(strstr(cellist_context_take_error(context), path));
    }
    cellist_image_destroy(image);
  }
  remove(path);
}

TEST(damaged_files_are_refused_or_read_but_never_crash)
{
  cellist_context *context = harness_context(1);
  static const char *const endings[] = {".exr", ".png"};
  for (int i = 0; i < 2; i++) {
    cellist_image *image = NULL;
    assert_success(context, make(context, &image));
    assert_success(context, cellist_image_write(context, image, temporary(endings[i]), NULL));
    cellist_image_destroy(image);
    damage_and_read(context, temporary(endings[i]));
  }
  harness_context_destroy(context);
}

TEST(names_must_be_distinct)
{
  cellist_context *context = harness_context(1);
  const char *const twice[] = {"R", "R"};
  cellist_image *image = NULL;
  assert_failure(context, cellist_image_create(context, 2, 2, twice, 2, &image), CELLIST_ERROR_INVALID_ARGUMENT,
                 "two channels are named R");
  assert_failure(context, cellist_image_create(context, 0, 2, twice, 1, &image), CELLIST_ERROR_INVALID_ARGUMENT,
                 "needs pixels");
  harness_context_destroy(context);
}
