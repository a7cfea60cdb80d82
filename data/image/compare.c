/* SPDX-License-Identifier: BSD-3-Clause
 * Compare: rmse, largest difference, psnr, ssim and the share of visible differences. */
#include <cellist/compare.h>
#include <math.h>

static const char *const CHANNELS[4] = {"R", "G", "B", "A"};
static const double VISIBLE = 2.0 / 255;
/* The window and constants of Wang et al. 2004: radius 5, sigma 1.5, K1 = 0.01, K2 = 0.03. */
enum { RADIUS = 5 };
static const double SIGMA = 1.5, STABILISER_MEAN = 1e-4, STABILISER_VARIANCE = 9e-4;

struct planes {
  const float *of[4];
};

static cellist_result find_planes(cellist_context *context, const cellist_image *image, struct planes *planes) {
  for (int k = 0; k < 4; k++) {
    planes->of[k] = cellist_image_channel(image, CHANNELS[k]);
    if (planes->of[k] == NULL)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "an image without channel %s cannot be compared",
                          CHANNELS[k]);
  }
  const size_t width = cellist_image_width(image), count = width * cellist_image_height(image);
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 4; k++)
      if (!isfinite(planes->of[k][i]))
        return cellist_fail(context, CELLIST_ERROR_FORMAT, "channel %s of pixel (%zu, %zu) is %g", CHANNELS[k],
                            i % width, i / width, (double)planes->of[k][i]);
  return CELLIST_SUCCESS;
}

static bool is_covered(const struct planes *a, const struct planes *b, size_t i) {
  for (int k = 0; k < 4; k++)
    if (a->of[k][i] != 0 || b->of[k][i] != 0) return true;
  return false;
}

static double luminance(const struct planes *planes, size_t i) {
  return 0.2126 * planes->of[0][i] + 0.7152 * planes->of[1][i] + 0.0722 * planes->of[2][i];
}

/* Five smoothed planes: the two luminances, their squares and their product. */
enum { MOMENT_COUNT = 5 };

static void moments_at(const struct planes *a, const struct planes *b, size_t i, double moment[MOMENT_COUNT]) {
  const double x = luminance(a, i), y = luminance(b, i);
  moment[0] = x;
  moment[1] = y;
  moment[2] = x * x;
  moment[3] = y * y;
  moment[4] = x * y;
}

static double similarity(const double m[MOMENT_COUNT]) {
  const double variance_x = m[2] - m[0] * m[0], variance_y = m[3] - m[1] * m[1], covariance = m[4] - m[0] * m[1];
  return (2 * m[0] * m[1] + STABILISER_MEAN) * (2 * covariance + STABILISER_VARIANCE) /
         ((m[0] * m[0] + m[1] * m[1] + STABILISER_MEAN) * (variance_x + variance_y + STABILISER_VARIANCE));
}

static size_t mirror(int64_t i, size_t size) {
  const int64_t last = (int64_t)size - 1;
  if (last == 0) return 0;
  while (i < 0 || i > last) i = i < 0 ? -i : 2 * last - i;
  return (size_t)i;
}

static cellist_result mean_similarity(cellist_context *context, const struct planes *a, const struct planes *b,
                                      size_t width, size_t height, double *ssim) {
  double weight[2 * RADIUS + 1], weight_sum = 0;
  for (int i = -RADIUS; i <= RADIUS; i++) weight_sum += weight[i + RADIUS] = exp(-i * i / (2 * SIGMA * SIGMA));
  for (int i = 0; i <= 2 * RADIUS; i++) weight[i] /= weight_sum;
  /* Smoothed along rows for the rows around the current one: a ring of 2 RADIUS + 1 rows. */
  const size_t ring = 2 * RADIUS + 1;
  double *rows = cellist_allocate(context, ring * width, MOMENT_COUNT * sizeof *rows);
  if (rows == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  double sum = 0;
  size_t covered = 0;
  for (int64_t y = -RADIUS; y < (int64_t)height + RADIUS; y++) {
    double *row = rows + (size_t)((y + RADIUS) % (int64_t)ring) * width * MOMENT_COUNT;
    for (size_t x = 0; x < width; x++) {
      double *smoothed = row + MOMENT_COUNT * x;
      for (int m = 0; m < MOMENT_COUNT; m++) smoothed[m] = 0;
      for (int i = -RADIUS; i <= RADIUS; i++) {
        double moment[MOMENT_COUNT];
        moments_at(a, b, mirror(y, height) * width + mirror((int64_t)x + i, width), moment);
        for (int m = 0; m < MOMENT_COUNT; m++) smoothed[m] += weight[i + RADIUS] * moment[m];
      }
    }
    const int64_t centre = y - RADIUS; /* all rows around this one are there now */
    if (centre < 0) continue;
    for (size_t x = 0; x < width; x++) {
      if (!is_covered(a, b, (size_t)centre * width + x)) continue;
      double moment[MOMENT_COUNT] = {0};
      for (int i = -RADIUS; i <= RADIUS; i++) {
        const double *from = rows + ((size_t)((centre + i + RADIUS) % (int64_t)ring) * width + x) * MOMENT_COUNT;
        for (int m = 0; m < MOMENT_COUNT; m++) moment[m] += weight[i + RADIUS] * from[m];
      }
      sum += similarity(moment);
      covered++;
    }
  }
  cellist_deallocate(context, rows);
  *ssim = covered > 0 ? sum / (double)covered : 1;
  return CELLIST_SUCCESS;
}

static void measure(const struct planes *a, const struct planes *b, size_t count, cellist_image_error *error) {
  double squares = 0;
  size_t visible = 0;
  *error = (cellist_image_error){0};
  for (size_t i = 0; i < count; i++) {
    if (!is_covered(a, b, i)) continue;
    error->covered_pixels++;
    double largest = 0;
    for (int k = 0; k < 4; k++) {
      const double difference = fabs((double)a->of[k][i] - b->of[k][i]);
      squares += difference * difference;
      largest = fmax(largest, difference);
    }
    error->max_abs = fmax(error->max_abs, largest);
    visible += largest > VISIBLE;
  }
  if (error->covered_pixels > 0) {
    error->rmse = sqrt(squares / (4.0 * (double)error->covered_pixels));
    error->pixels_over_2_255 = 100.0 * (double)visible / (double)error->covered_pixels;
  }
  error->psnr = -20 * log10(error->rmse);
}

static cellist_result make_difference(cellist_context *context, const cellist_image *image, const struct planes *a,
                                      const struct planes *b, cellist_image **difference) {
  const uint32_t width = cellist_image_width(image), height = cellist_image_height(image);
  const cellist_result result = cellist_image_create(context, width, height, CHANNELS, 4, difference);
  if (result != CELLIST_SUCCESS) return result;
  float *plane[4];
  for (int k = 0; k < 4; k++) plane[k] = cellist_image_channel(*difference, CHANNELS[k]);
  for (size_t i = 0; i < (size_t)width * height; i++) {
    float largest = fabsf(a->of[3][i] - b->of[3][i]);
    for (int k = 0; k < 3; k++) {
      plane[k][i] = fabsf(a->of[k][i] - b->of[k][i]);
      largest = fmaxf(largest, plane[k][i]);
    }
    plane[3][i] = largest;
  }
  return CELLIST_SUCCESS;
}

cellist_result cellist_image_compare(cellist_context *context, const cellist_image *image,
                                     const cellist_image *reference, cellist_image_error *error,
                                     cellist_image **difference) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (image == NULL || reference == NULL || error == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_image_compare: an argument is NULL");
  const uint32_t width = cellist_image_width(image), height = cellist_image_height(image);
  if (width != cellist_image_width(reference) || height != cellist_image_height(reference))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "an image of %ux%u pixels, a reference of %ux%u",
                        width, height, cellist_image_width(reference), cellist_image_height(reference));
  struct planes a, b;
  cellist_image_error measured;
  cellist_result result = find_planes(context, image, &a);
  if (result == CELLIST_SUCCESS) result = find_planes(context, reference, &b);
  if (result != CELLIST_SUCCESS) return result;
  measure(&a, &b, (size_t)width * height, &measured);
  result = mean_similarity(context, &a, &b, width, height, &measured.ssim);
  if (result == CELLIST_SUCCESS && difference != NULL) result = make_difference(context, image, &a, &b, difference);
  if (result == CELLIST_SUCCESS) *error = measured;
  return result;
}
