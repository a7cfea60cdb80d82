/* SPDX-License-Identifier: BSD-3-Clause
 * Compare: how far a picture is from a reference. */
#ifndef CELLIST_COMPARE_H
#define CELLIST_COMPARE_H

#include <cellist/image.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Differences of R G B A, linear and premultiplied, over the pixels that either image covers (any of the four is not
 * 0). All are 0 (ssim 1, psnr infinite) if none is covered or nothing differs. */
typedef struct cellist_image_error {
  size_t covered_pixels;
  double rmse;              /* root of the mean square over covered pixels and the four channels */
  double max_abs;           /* largest difference of one channel */
  double psnr;              /* decibels, for a peak of 1 */
  double ssim;              /* mean structural similarity of the luminance, 11x11 Gaussian window of sigma 1.5 (Wang,
                               Bovik, Sheikh, Simoncelli 2004), dynamic range 1 */
  double pixels_over_2_255; /* per cent of the covered pixels where a channel differs by more than 2/255 */
} cellist_image_error;

/* Compares two images of the same size.
 * Arrays: difference may be NULL; otherwise *difference is the caller's: the absolute differences as R G B and their
 *   largest as A.
 * Errors: INVALID_ARGUMENT (NULL, other sizes, no R G B A), FORMAT (a pixel that is not finite, which is named),
 *   OUT_OF_MEMORY. Threads: one call per context at a time. Cost: linear in pixels. */
CELLIST_API cellist_result cellist_image_compare(cellist_context *context, const cellist_image *image,
                                                 const cellist_image *reference, cellist_image_error *error,
                                                 cellist_image **difference);

#ifdef __cplusplus
}
#endif
#endif
