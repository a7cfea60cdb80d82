/* SPDX-License-Identifier: BSD-3-Clause
 * The image's inside, shared by the files of this folder only. */
#ifndef CELLIST_IMAGE_PRIVATE_H
#define CELLIST_IMAGE_PRIVATE_H

#include <cellist/image.h>

typedef struct image_channel {
  char *name;
  float *plane; /* in the image's planes */
} image_channel;

typedef struct image_attribute {
  char *name, *value;
} image_attribute;

struct cellist_image {
  cellist_context *context;
  uint32_t width, height;
  size_t channel_count;
  image_channel *channels;
  float *planes; /* of all channels, one block: so that large ones lie in huge pages */
  size_t attribute_count;
  image_attribute *attributes;
};

/* Bytes that grow; from the context's allocator. */
typedef struct byte_buffer {
  cellist_context *context;
  uint8_t *bytes;
  size_t size, capacity;
} byte_buffer;

/* Makes room for at least size bytes; false (and OUT_OF_MEMORY recorded) if there is none. */
bool byte_buffer_reserve(byte_buffer *buffer, size_t size);

/* Writes all bytes to path, whole or not at all: beside its name first, then renamed; "-" is standard output. */
cellist_result file_write_whole(cellist_context *context, const char *path, const uint8_t *bytes, size_t size);

/* Reads a whole file into an empty buffer; "-" is standard input. */
cellist_result file_read_whole(cellist_context *context, const char *path, byte_buffer *buffer);

cellist_result exr_encode(const cellist_image *image, byte_buffer *buffer);
cellist_result exr_decode(cellist_context *context, const char *path, const byte_buffer *buffer, cellist_image **image);
cellist_result png_encode(const cellist_image *image, const double background[3], byte_buffer *buffer);
cellist_result png_decode(cellist_context *context, const char *path, const byte_buffer *buffer, cellist_image **image);

#endif
