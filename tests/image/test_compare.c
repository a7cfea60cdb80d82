/* SPDX-License-Identifier: BSD-3-Clause
 * Compare: figures against what the definition gives. */
#include <cellist/compare.h>
#include <math.h>
#include <stdlib.h>

#include "harness.h"

static const char *const CHANNELS[] = {"R", "G", "B", "A"};

static cellist_image *make(cellist_context *context, uint32_t width, uint32_t height, uint64_t seed) {
  cellist_image *image = NULL;
  assert_success(context, cellist_image_create(context, width, height, CHANNELS, 4, &image));
  random_state random = {seed};
  for (int k = 0; k < 4 && seed != 0; k++)
    for (uint32_t i = 0; i < width * height; i++)
      cellist_image_channel(image, CHANNELS[k])[i] = (float)random_unit(&random);
  return image;
}

TEST(equal_images_have_no_error)
{
  cellist_context *context = harness_context(1);
  cellist_image *image = make(context, 30, 20, 1);
  cellist_image_error error;
  assert_success(context, cellist_image_compare(context, image, image, &error, NULL));
  assert_true(error.covered_pixels == 600 && error.rmse == 0 && error.max_abs == 0 && isinf(error.psnr));
  assert_true(fabs(error.ssim - 1) < 1e-12 && error.pixels_over_2_255 == 0);
  cellist_image_destroy(image);
  harness_context_destroy(context);
}

TEST(one_pixel_off_gives_the_figures_of_the_definition)
{
  cellist_context *context = harness_context(1);
  cellist_image *image = make(context, 10, 10, 0), *reference = make(context, 10, 10, 0), *difference = NULL;
  /* Four covered pixels, one of them off by 0.5 in green. */
  for (int i = 0; i < 4; i++)
    cellist_image_channel(image, "A")[11 * i] = cellist_image_channel(reference, "A")[11 * i] = 0.25f;
  cellist_image_channel(image, "G")[22] = 0.5f;
  cellist_image_error error;
  assert_success(context, cellist_image_compare(context, image, reference, &error, &difference));
  assert_int_equal(error.covered_pixels, 4);
  assert_true(fabs(error.rmse - sqrt(0.25 / 16)) < 1e-15 && error.max_abs == 0.5);
  assert_true(error.pixels_over_2_255 == 25 && fabs(error.psnr + 20 * log10(error.rmse)) < 1e-12);
  assert_true(error.ssim < 1);
  assert_true(cellist_image_channel(difference, "G")[22] == 0.5f && cellist_image_channel(difference, "A")[22] == 0.5f);
  assert_true(cellist_image_channel(difference, "A")[0] == 0);
  cellist_image_destroy(image);
  cellist_image_destroy(reference);
  cellist_image_destroy(difference);
  harness_context_destroy(context);
}

/* The structural similarity written down directly: every window in full, in two dimensions. */
static double direct_ssim(const float *x, const float *y, int size) {
  double sum = 0;
  for (int cy = 0; cy < size; cy++)
    for (int cx = 0; cx < size; cx++) {
      double w = 0, mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
      for (int dy = -5; dy <= 5; dy++)
        for (int dx = -5; dx <= 5; dx++) {
          int px = abs(cx + dx), py = abs(cy + dy);
          if (px >= size) px = 2 * size - 2 - px;
          if (py >= size) py = 2 * size - 2 - py;
          const double weight = exp(-(dx * dx + dy * dy) / 4.5), a = x[py * size + px], b = y[py * size + px];
          w += weight, mx += weight * a, my += weight * b;
          xx += weight * a * a, yy += weight * b * b, xy += weight * a * b;
        }
      mx /= w, my /= w;
      const double vx = xx / w - mx * mx, vy = yy / w - my * my, cov = xy / w - mx * my;
      sum += (2 * mx * my + 1e-4) * (2 * cov + 9e-4) / ((mx * mx + my * my + 1e-4) * (vx + vy + 9e-4));
    }
  return sum / (size * size);
}

TEST(ssim_is_that_of_the_definition)
{
  cellist_context *context = harness_context(1);
  enum { SIZE = 24 };
  cellist_image *image = make(context, SIZE, SIZE, 3), *reference = make(context, SIZE, SIZE, 4);
  for (int k = 0; k < 3; k++) /* grey, so that the luminance is the channel */
    for (int i = 0; i < SIZE * SIZE; i++) {
      float *to = cellist_image_channel(reference, CHANNELS[k]);
      cellist_image_channel(image, CHANNELS[k])[i] = cellist_image_channel(image, "A")[i];
      to[i] = 0.7f * cellist_image_channel(image, "A")[i] + 0.3f * cellist_image_channel(reference, "A")[i];
    }
  cellist_image_error error;
  assert_success(context, cellist_image_compare(context, image, reference, &error, NULL));
  const double expected = direct_ssim(cellist_image_channel(image, "R"), cellist_image_channel(reference, "R"), SIZE);
  assert_true(fabs(error.ssim - expected) < 1e-9);
  cellist_image_destroy(image);
  cellist_image_destroy(reference);
  harness_context_destroy(context);
}

TEST(other_sizes_and_pixels_that_are_not_finite_are_refused)
{
  cellist_context *context = harness_context(1);
  cellist_image *small = make(context, 5, 5, 1), *large = make(context, 6, 5, 1);
  cellist_image_error error;
  assert_failure(context, cellist_image_compare(context, small, large, &error, NULL), CELLIST_ERROR_INVALID_ARGUMENT,
                 "5x5 pixels, a reference of 6x5");
  cellist_image_channel(small, "B")[7] = NAN;
  assert_failure(context, cellist_image_compare(context, small, small, &error, NULL), CELLIST_ERROR_FORMAT,
                 "channel B of pixel (2, 1) is nan");
  cellist_image_destroy(small);
  cellist_image_destroy(large);
  harness_context_destroy(context);
}

static cellist_result compare_and_release(cellist_context *context, void *user) {
  (void)user;
  cellist_image *image = NULL, *difference = NULL;
  cellist_image_error error;
  cellist_result result = cellist_image_create(context, 9, 9, CHANNELS, 4, &image);
  if (result == CELLIST_SUCCESS) result = cellist_image_compare(context, image, image, &error, &difference);
  cellist_image_destroy(image);
  cellist_image_destroy(difference);
  return result;
}

TEST(failed_allocations_leak_nothing)
{ check_allocation_failures(compare_and_release, NULL); }
