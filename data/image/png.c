/* SPDX-License-Identifier: BSD-3-Clause
 * PNG through libpng, from and to memory: sRGB, 8 bit RGBA (not premultiplied) or RGB over a background.
 *
 * Compositing happens in linear light; the sRGB curve (IEC 61966-2-1) is applied last. */
#include <base/srgb.h>
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <string.h>

#include "image_private.h"

struct png_job {
  cellist_context *context;
  const char *path; /* NULL when writing */
  byte_buffer *buffer;
  size_t read_at;
  bool out_of_memory; /* libpng reports that as any other error */
};

static uint8_t byte_of(double x) {
  if (!(x > 0)) return 0; /* NaN too */
  return x < 1 ? (uint8_t)lround(255 * x) : 255;
}

static png_voidp allocate_for_png(png_structp png, png_alloc_size_t size) {
  struct png_job *job = png_get_mem_ptr(png);
  void *block = cellist_allocate(job->context, size, 1);
  if (block == NULL) job->out_of_memory = true;
  return block;
}

static void deallocate_for_png(png_structp png, png_voidp block) {
  struct png_job *job = png_get_mem_ptr(png);
  cellist_deallocate(job->context, block);
}

static void on_error(png_structp png, png_const_charp message) {
  struct png_job *job = png_get_error_ptr(png);
  cellist_fail(job->context, CELLIST_ERROR_FORMAT, "%s: %s", job->path != NULL ? job->path : "PNG", message);
  png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) { (void)png, (void)message; }

static void write_bytes(png_structp png, png_bytep bytes, size_t size) {
  byte_buffer *buffer = ((struct png_job *)png_get_io_ptr(png))->buffer;
  if (!byte_buffer_reserve(buffer, buffer->size + size)) png_error(png, "out of memory");
  memcpy(buffer->bytes + buffer->size, bytes, size);
  buffer->size += size;
}

static void flush_bytes(png_structp png) { (void)png; }

static void read_bytes(png_structp png, png_bytep bytes, size_t size) {
  struct png_job *job = png_get_io_ptr(png);
  if (size > job->buffer->size - job->read_at) png_error(png, "the file ends too early");
  memcpy(bytes, job->buffer->bytes + job->read_at, size);
  job->read_at += size;
}

static void encode_row(const cellist_image *image, uint32_t y, const double *background, uint8_t *row) {
  static const char *const names[3] = {"R", "G", "B"};
  const float *alpha_plane = cellist_image_channel(image, "A");
  const size_t pixel_size = background != NULL ? 3 : 4;
  for (int k = 0; k < 3; k++) {
    const float *plane = cellist_image_channel(image, names[k]);
    for (size_t x = 0; x < image->width; x++) {
      const size_t at = (size_t)y * image->width + x;
      const double alpha = fmin(1, fmax(0, alpha_plane[at])); /* fmax drops NaN */
      const double colour = plane[at];
      double linear = 0;
      if (background != NULL)
        linear = colour + (1 - alpha) * background[k];
      else if (alpha > 0)
        linear = colour / alpha;
      row[pixel_size * x + (size_t)k] = byte_of(srgb_from_linear(linear));
      if (background == NULL) row[pixel_size * x + 3] = byte_of(alpha);
    }
  }
}

cellist_result png_encode(const cellist_image *image, const double background[3], byte_buffer *buffer) {
  cellist_context *context = image->context;
  if (cellist_image_channel(image, "R") == NULL || cellist_image_channel(image, "G") == NULL ||
      cellist_image_channel(image, "B") == NULL || cellist_image_channel(image, "A") == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a PNG image needs the channels R G B A");
  struct png_job job = {context, NULL, buffer, 0, false};
  uint8_t *row = cellist_allocate(context, image->width, 4);
  png_structp png = row == NULL ? NULL
                                : png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning, &job,
                                                            allocate_for_png, deallocate_for_png);
  png_infop info = png != NULL ? png_create_info_struct(png) : NULL;
  volatile bool ok = false;
  if (info != NULL && setjmp(png_jmpbuf(png)) == 0) {
    png_set_write_fn(png, &job, write_bytes, flush_bytes);
    png_set_user_limits(png, 0x7fffffff, 0x7fffffff);
    png_set_IHDR(png, info, image->width, image->height, 8,
                 background != NULL ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (uint32_t y = 0; y < image->height; y++) {
      encode_row(image, y, background, row);
      png_write_row(png, row);
    }
    png_write_end(png, info);
    ok = true;
  }
  if (png != NULL) png_destroy_write_struct(&png, &info);
  cellist_deallocate(context, row);
  if (ok) return CELLIST_SUCCESS;
  return cellist_fail(context, CELLIST_ERROR_OUT_OF_MEMORY, "out of memory while writing PNG");
}

static void decode_row(const cellist_image *image, uint32_t y, const uint16_t *row) {
  float *plane[4];
  static const char *const names[4] = {"R", "G", "B", "A"};
  for (int k = 0; k < 4; k++) plane[k] = cellist_image_channel(image, names[k]) + (size_t)y * image->width;
  for (size_t x = 0; x < image->width; x++) {
    const double alpha = row[4 * x + 3] / 65535.0;
    for (size_t k = 0; k < 3; k++) plane[k][x] = (float)(alpha * linear_from_srgb(row[4 * x + k] / 65535.0));
    plane[3][x] = (float)alpha;
  }
}

/* Everything becomes 16-bit RGBA in the machine's byte order. */
static void set_transforms(png_structp png) {
  png_set_expand(png);
  png_set_expand_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 0xffff, PNG_FILLER_AFTER);
  const uint16_t one = 1;
  if (*(const uint8_t *)&one == 1) png_set_swap(png);
}

cellist_result png_decode(cellist_context *context, const char *path, const byte_buffer *buffer,
                          cellist_image **image) {
  struct png_job job = {context, path, (byte_buffer *)buffer, 0, false};
  static const char *const names[4] = {"R", "G", "B", "A"};
  uint16_t *volatile pixels = NULL;
  cellist_image *volatile created = NULL;
  volatile cellist_result result = CELLIST_ERROR_FORMAT;
  png_structp png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning, &job, allocate_for_png,
                                             deallocate_for_png);
  png_infop info = png != NULL ? png_create_info_struct(png) : NULL;
  if (info == NULL) {
    result = CELLIST_ERROR_OUT_OF_MEMORY;
  } else if (setjmp(png_jmpbuf(png)) == 0) {
    png_set_read_fn(png, &job, read_bytes);
    png_read_info(png, info);
    const uint32_t width = png_get_image_width(png, info), height = png_get_image_height(png, info);
    set_transforms(png);
    const int passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    if (png_get_rowbytes(png, info) != 8 * (size_t)width) png_error(png, "an unknown pixel layout");
    /* Deflate shrinks at most 1032 times; a bit a pixel at the least. */
    if ((uint64_t)width > 8 * 1032 * (uint64_t)buffer->size / height)
      png_error(png, "more pixels than the file can hold");
    /* Interlaced images are read in several passes over all rows; others row by row. */
    const size_t rows = passes > 1 ? height : 1;
    cellist_image *made = NULL;
    result = cellist_image_create(context, width, height, names, 4, &made);
    created = made;
    if (result == CELLIST_SUCCESS) {
      pixels = cellist_allocate(context, rows * width, 4 * sizeof *pixels);
      if (pixels == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
    }
    if (result == CELLIST_SUCCESS) {
      result = CELLIST_ERROR_FORMAT; /* what a longjmp out of the loop means */
      for (int pass = 0; pass < passes; pass++)
        for (uint32_t y = 0; y < height; y++) {
          uint16_t *row = pixels + (rows > 1 ? (size_t)4 * width * y : 0);
          png_read_row(png, (png_bytep)row, NULL);
          if (pass + 1 == passes) decode_row(made, y, row);
        }
      png_read_end(png, NULL);
      result = CELLIST_SUCCESS;
    }
  }
  png_destroy_read_struct(&png, &info, NULL);
  cellist_deallocate(context, pixels);
  if (result == CELLIST_SUCCESS) {
    *image = created;
    return result;
  }
  cellist_image_destroy(created);
  if (job.out_of_memory) result = CELLIST_ERROR_OUT_OF_MEMORY;
  return cellist_fail(context, result, "%s: not a readable PNG image", path);
}
