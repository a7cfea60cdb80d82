/* SPDX-License-Identifier: BSD-3-Clause
 * cellist compare: how far an image is from a reference. */
#include <cellist/compare.h>
#include <cellist/image.h>
#include <stdio.h>

#include "command.h"
#include "options.h"
#include "terminal.h"

static int report(const cellist_image_error *error, const cellist_image *image, bool json) {
  const unsigned width = cellist_image_width(image), height = cellist_image_height(image);
  if (json)
    return terminal_print_json(json_pack(
        "{s:I, s:I, s:I, s:f, s:f, s:o, s:f, s:f}", "width", (json_int_t)width, "height", (json_int_t)height,
        "covered_pixels", (json_int_t)error->covered_pixels, "rmse", error->rmse, "max_abs", error->max_abs, "psnr",
        terminal_number(error->psnr), "ssim", error->ssim, "pixels_over_2_255", error->pixels_over_2_255));
  printf("%ux%u pixels, %zu covered\n", width, height, error->covered_pixels);
  printf("rmse %.3e, max %.3e, psnr %.2f dB, ssim %.6f, %.3f %% of pixels off by more than 2/255\n", error->rmse,
         error->max_abs, error->psnr, error->ssim, error->pixels_over_2_255);
  return terminal_finish();
}

int command_compare(int argc, char **argv) {
  const char *difference = NULL;
  bool json = false;
  const option_spec table[] = {
      {"o", "IMAGE", "write the absolute difference as .exr or .png", OPTION_TEXT, &difference},
      {"json", "", "print the figures as one JSON object", OPTION_FLAG, &json},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  static const char *const examples[] = {"cellist compare mine.exr reference.exr",
                                         "cellist compare mine.png reference.exr -o difference.png", NULL};
  const command_usage usage = {
      "compare",
      "IMAGE REFERENCE",
      "Measures an image (.exr, .png) against a reference, in linear premultiplied RGBA over the pixels that either\n"
      "covers.",
      2,
      2,
      examples,
      {table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);

  cellist_context *context = terminal_context(0);
  if (context == NULL) return 1;
  cellist_image *image = NULL, *reference = NULL, *absolute = NULL;
  cellist_image_error error = {0};
  cellist_result result = cellist_image_read(context, argv[1], &image);
  if (result == CELLIST_SUCCESS) result = cellist_image_read(context, argv[2], &reference);
  if (result == CELLIST_SUCCESS)
    result = cellist_image_compare(context, image, reference, &error, difference != NULL ? &absolute : NULL);
  if (result == CELLIST_SUCCESS && difference != NULL)
    result = cellist_image_write(context, absolute, difference, NULL);
  const int status = result == CELLIST_SUCCESS ? report(&error, image, json) : terminal_failure(context, result);
  cellist_image_destroy(absolute);
  cellist_image_destroy(reference);
  cellist_image_destroy(image);
  cellist_context_destroy(context);
  return status;
}
