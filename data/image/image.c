/* SPDX-License-Identifier: BSD-3-Clause
 * Image: planes, attributes, and which file format a name or a content means. */
#include "image_private.h"

#include <string.h>

enum { PLANE_GRAIN = 16 }; /* floats of a cache line, on which each plane begins */

static char *copy_text(cellist_context *context, const char *text) {
  const size_t size = strlen(text) + 1;
  char *copy = cellist_allocate(context, size, 1);
  if (copy != NULL) memcpy(copy, text, size);
  return copy;
}

static cellist_result check_channels(cellist_context *context, const char *const *channels, size_t channel_count) {
  for (size_t i = 0; i < channel_count; i++) {
    if (channels[i] == NULL || channels[i][0] == '\0')
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "channel %zu has no name", i);
    for (size_t j = 0; j < i; j++)
      if (strcmp(channels[i], channels[j]) == 0)
        return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "two channels are named %s", channels[i]);
  }
  return CELLIST_SUCCESS;
}

cellist_result cellist_image_create(cellist_context *context, uint32_t width, uint32_t height,
                                    const char *const *channels, size_t channel_count, cellist_image **image) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (image == NULL || channels == NULL || width == 0 || height == 0 || channel_count == 0)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "an image needs pixels and channels");
  if ((size_t)width * height > SIZE_MAX / (2 * sizeof(float)))
    return cellist_fail(context, CELLIST_ERROR_OUT_OF_MEMORY, "no memory holds %ux%u pixels", width, height);
  cellist_result result = check_channels(context, channels, channel_count);
  if (result != CELLIST_SUCCESS) return result;
  cellist_image *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->width = width;
  created->height = height;
  created->channels = cellist_allocate_zeroed(context, channel_count, sizeof *created->channels);
  const size_t plane_size = ((size_t)width * height + PLANE_GRAIN - 1) / PLANE_GRAIN * PLANE_GRAIN;
  created->planes = cellist_allocate_zeroed(context, channel_count, plane_size * sizeof *created->planes);
  bool ok = created->channels != NULL && created->planes != NULL;
  for (size_t i = 0; i < channel_count && ok; i++) {
    image_channel *channel = &created->channels[created->channel_count++];
    channel->name = copy_text(context, channels[i]);
    channel->plane = created->planes + i * plane_size;
    ok = channel->name != NULL;
  }
  if (!ok) {
    cellist_image_destroy(created);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  *image = created;
  return CELLIST_SUCCESS;
}

void cellist_image_destroy(cellist_image *image) {
  if (image == NULL) return;
  cellist_context *context = image->context;
  for (size_t i = 0; i < image->channel_count; i++) cellist_deallocate(context, image->channels[i].name);
  for (size_t i = 0; i < image->attribute_count; i++) {
    cellist_deallocate(context, image->attributes[i].name);
    cellist_deallocate(context, image->attributes[i].value);
  }
  cellist_deallocate(context, image->channels);
  cellist_deallocate(context, image->planes);
  cellist_deallocate(context, image->attributes);
  cellist_deallocate(context, image);
}

uint32_t cellist_image_width(const cellist_image *image) { return image->width; }
uint32_t cellist_image_height(const cellist_image *image) { return image->height; }
size_t cellist_image_channel_count(const cellist_image *image) { return image->channel_count; }

const char *cellist_image_channel_name(const cellist_image *image, size_t index) {
  return index < image->channel_count ? image->channels[index].name : NULL;
}

float *cellist_image_channel(const cellist_image *image, const char *name) {
  for (size_t i = 0; i < image->channel_count; i++)
    if (strcmp(image->channels[i].name, name) == 0) return image->channels[i].plane;
  return NULL;
}

cellist_result cellist_image_set_attribute(cellist_image *image, const char *name, const char *value) {
  if (image == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_context *context = image->context;
  if (name == NULL || name[0] == '\0' || value == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "an image's attribute needs a name and a value");
  char *copy = copy_text(context, value);
  if (copy == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < image->attribute_count; i++) {
    if (strcmp(image->attributes[i].name, name) != 0) continue;
    cellist_deallocate(context, image->attributes[i].value);
    image->attributes[i].value = copy;
    return CELLIST_SUCCESS;
  }
  char *name_copy = copy_text(context, name);
  image_attribute *grown = name_copy == NULL ? NULL
                                             : cellist_reallocate(context, image->attributes, image->attribute_count,
                                                                  image->attribute_count + 1, sizeof *grown);
  if (grown == NULL) {
    cellist_deallocate(context, name_copy);
    cellist_deallocate(context, copy);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  grown[image->attribute_count++] = (image_attribute){name_copy, copy};
  image->attributes = grown;
  return CELLIST_SUCCESS;
}

const char *cellist_image_attribute(const cellist_image *image, const char *name) {
  for (size_t i = 0; i < image->attribute_count; i++)
    if (strcmp(image->attributes[i].name, name) == 0) return image->attributes[i].value;
  return NULL;
}

static bool ends_in(const char *path, const char *ending) {
  const size_t length = strlen(path), tail = strlen(ending);
  return length >= tail && strcmp(path + length - tail, ending) == 0;
}

cellist_result cellist_image_write(cellist_context *context, const cellist_image *image, const char *path,
                                   const double background[3]) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (image == NULL || path == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_image_write: image or path is NULL");
  byte_buffer buffer = {.context = context};
  cellist_result result;
  if (strcmp(path, "-") == 0 || ends_in(path, ".exr"))
    result = exr_encode(image, &buffer);
  else if (ends_in(path, ".png"))
    result = png_encode(image, background, &buffer);
  else
    result =
        cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "%s: an image's name must end in .exr or .png", path);
  if (result == CELLIST_SUCCESS) result = file_write_whole(context, path, buffer.bytes, buffer.size);
  cellist_deallocate(context, buffer.bytes);
  return result;
}

cellist_result cellist_image_read(cellist_context *context, const char *path, cellist_image **image) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (image == NULL || path == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_image_read: image or path is NULL");
  static const uint8_t exr_magic[] = {0x76, 0x2f, 0x31, 0x01};
  static const uint8_t png_magic[] = {0x89, 'P', 'N', 'G'};
  byte_buffer buffer = {.context = context};
  cellist_result result = file_read_whole(context, path, &buffer);
  if (result == CELLIST_SUCCESS) {
    if (buffer.size >= sizeof exr_magic && memcmp(buffer.bytes, exr_magic, sizeof exr_magic) == 0)
      result = exr_decode(context, path, &buffer, image);
    else if (buffer.size >= sizeof png_magic && memcmp(buffer.bytes, png_magic, sizeof png_magic) == 0)
      result = png_decode(context, path, &buffer, image);
    else
      result = cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: neither an EXR nor a PNG image", path);
  }
  cellist_deallocate(context, buffer.bytes);
  return result;
}
