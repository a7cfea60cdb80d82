/* SPDX-License-Identifier: BSD-3-Clause
 * Image: named float planes of one size, and the files they go to and come from. */
#ifndef CELLIST_IMAGE_H
#define CELLIST_IMAGE_H

#include <cellist/context.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Row 0 is the top row; plane[y * width + x]. Pictures have R G B A, colour premultiplied by A and linear. */
typedef struct cellist_image cellist_image;

/* Makes an image of zeroes. channels: channel_count distinct names ("R", "Z", "error.A"), copied.
 * Errors: INVALID_ARGUMENT (no pixels, no name, the same name twice), OUT_OF_MEMORY. */
CELLIST_API cellist_result cellist_image_create(cellist_context *context, uint32_t width, uint32_t height,
                                                const char *const *channels, size_t channel_count,
                                                cellist_image **image);
CELLIST_API void cellist_image_destroy(cellist_image *image);

CELLIST_API uint32_t cellist_image_width(const cellist_image *image);
CELLIST_API uint32_t cellist_image_height(const cellist_image *image);
CELLIST_API size_t cellist_image_channel_count(const cellist_image *image);
CELLIST_API const char *cellist_image_channel_name(const cellist_image *image, size_t index);

/* The plane of that name, width * height floats that belong to the image; NULL if there is none. */
CELLIST_API float *cellist_image_channel(const cellist_image *image, const char *name);

/* A text that EXR files carry along (camera, settings); a second one of that name replaces the first.
 * Errors: INVALID_ARGUMENT, OUT_OF_MEMORY. */
CELLIST_API cellist_result cellist_image_set_attribute(cellist_image *image, const char *name, const char *value);
/* NULL if there is none. */
CELLIST_API const char *cellist_image_attribute(const cellist_image *image, const char *name);

/* Writes to a name that ends in .exr (every channel as 32-bit float, ZIP-compressed, attributes) or .png (R G B A,
 * sRGB, 8 bit, not premultiplied; over the opaque background if that is not NULL: 3 linear values). The file is
 * written whole or not at all: first beside its name, then renamed. "-" writes EXR to standard output.
 * Errors: INVALID_ARGUMENT (another ending, R G B A missing for png), IO, OUT_OF_MEMORY. */
CELLIST_API cellist_result cellist_image_write(cellist_context *context, const cellist_image *image, const char *path,
                                               const double background[3]);

/* Reads what write made, and other programs' EXR (scan lines and tiles, half, float and uint, single part) and PNG
 * (any bit depth; decoded from sRGB to linear, premultiplied), told apart by content.
 * Errors: IO, FORMAT, UNSUPPORTED, OUT_OF_MEMORY. */
CELLIST_API cellist_result cellist_image_read(cellist_context *context, const char *path, cellist_image **image);

#ifdef __cplusplus
}
#endif
#endif
