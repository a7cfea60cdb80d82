/* SPDX-License-Identifier: BSD-3-Clause
 * EXR through OpenEXRCore, its C interface, from and to memory.
 *
 * Written: one part of scan lines, every channel as 32-bit float, ZIP-compressed. Read: one part of scan lines or tiles
 * (the finest level), half, float and uint channels. OpenEXRCore's allocation hooks take no user pointer, so its own
 * working memory is malloc's; the image's is the context's. */
#include <openexr.h>
#include <string.h>

#include "image_private.h"

/* Where OpenEXRCore's callbacks find the bytes, and where the first message goes. */
struct stream {
  cellist_context *context;
  const char *path; /* NULL when writing */
  byte_buffer *buffer;
  bool out_of_memory;
};

static void on_error(exr_const_context_t exr, exr_result_t code, const char *message) {
  struct stream *stream = NULL;
  (void)code;
  if (exr == NULL || exr_get_user_data(exr, (void **)&stream) != EXR_ERR_SUCCESS || stream == NULL) return;
  cellist_fail(stream->context, CELLIST_ERROR_FORMAT, "%s: %s", stream->path != NULL ? stream->path : "EXR", message);
}

static int64_t write_bytes(exr_const_context_t exr, void *user, const void *bytes, uint64_t size, uint64_t offset,
                           exr_stream_error_func_ptr_t report) {
  (void)exr, (void)report;
  struct stream *stream = user;
  byte_buffer *buffer = stream->buffer;
  if (offset > SIZE_MAX - size || !byte_buffer_reserve(buffer, (size_t)(offset + size))) {
    stream->out_of_memory = true;
    return -1;
  }
  if (offset > buffer->size) memset(buffer->bytes + buffer->size, 0, (size_t)offset - buffer->size);
  memcpy(buffer->bytes + offset, bytes, (size_t)size);
  if (offset + size > buffer->size) buffer->size = (size_t)(offset + size);
  return (int64_t)size;
}

static int64_t read_bytes(exr_const_context_t exr, void *user, void *bytes, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t report) {
  (void)exr, (void)report;
  const byte_buffer *buffer = ((struct stream *)user)->buffer;
  if (offset >= buffer->size) return 0;
  const uint64_t left = buffer->size - offset, count = size < left ? size : left;
  memcpy(bytes, buffer->bytes + offset, (size_t)count);
  return (int64_t)count;
}

static int64_t stream_size(exr_const_context_t exr, void *user) {
  (void)exr;
  return (int64_t)((struct stream *)user)->buffer->size;
}

static exr_result_t write_header(exr_context_t exr, const cellist_image *image) {
  int part = 0;
  exr_result_t result = exr_add_part(exr, "image", EXR_STORAGE_SCANLINE, &part);
  if (result == EXR_ERR_SUCCESS)
    result = exr_initialize_required_attr_simple(exr, part, (int32_t)image->width, (int32_t)image->height,
                                                 EXR_COMPRESSION_ZIP);
  for (size_t i = 0; i < image->channel_count && result == EXR_ERR_SUCCESS; i++)
    result = exr_add_channel(exr, part, image->channels[i].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
  for (size_t i = 0; i < image->attribute_count && result == EXR_ERR_SUCCESS; i++)
    result = exr_attr_set_string(exr, part, image->attributes[i].name, image->attributes[i].value);
  return result == EXR_ERR_SUCCESS ? exr_write_header(exr) : result;
}

/* Points the pipeline's channels at the planes' rows from y on. */
static void attach_rows(const cellist_image *image, exr_encode_pipeline_t *pipeline, uint32_t y) {
  for (int16_t i = 0; i < pipeline->channel_count; i++) {
    exr_coding_channel_info_t *channel = &pipeline->channels[i];
    const float *plane = cellist_image_channel(image, channel->channel_name);
    channel->encode_from_ptr = (const uint8_t *)(plane + (size_t)y * image->width);
    channel->user_bytes_per_element = sizeof(float);
    channel->user_data_type = EXR_PIXEL_FLOAT;
    channel->user_pixel_stride = sizeof(float);
    channel->user_line_stride = (int32_t)(image->width * sizeof(float));
  }
}

static exr_result_t write_rows(exr_context_t exr, const cellist_image *image) {
  exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
  bool started = false;
  int32_t step = 1;
  exr_result_t result = exr_get_scanlines_per_chunk(exr, 0, &step);
  for (uint32_t y = 0; y < image->height && result == EXR_ERR_SUCCESS; y += (uint32_t)step) {
    exr_chunk_info_t chunk;
    result = exr_write_scanline_chunk_info(exr, 0, (int)y, &chunk);
    if (result == EXR_ERR_SUCCESS)
      result =
          started ? exr_encoding_update(exr, 0, &chunk, &pipeline) : exr_encoding_initialize(exr, 0, &chunk, &pipeline);
    if (result != EXR_ERR_SUCCESS) break;
    attach_rows(image, &pipeline, y);
    if (!started) result = exr_encoding_choose_default_routines(exr, 0, &pipeline);
    started = true;
    if (result == EXR_ERR_SUCCESS) result = exr_encoding_run(exr, 0, &pipeline);
  }
  if (started) exr_encoding_destroy(exr, &pipeline);
  return result;
}

cellist_result exr_encode(const cellist_image *image, byte_buffer *buffer) {
  cellist_context *context = image->context;
  struct stream stream = {context, NULL, buffer, false};
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.user_data = &stream;
  settings.error_handler_fn = on_error;
  settings.write_fn = write_bytes;
  exr_context_t exr = NULL;
  exr_result_t result = exr_start_write(&exr, "image.exr", EXR_WRITE_FILE_DIRECTLY, &settings);
  if (result == EXR_ERR_SUCCESS) result = exr_set_longname_support(exr, 1);
  if (result == EXR_ERR_SUCCESS) result = write_header(exr, image);
  if (result == EXR_ERR_SUCCESS) result = write_rows(exr, image);
  if (exr != NULL) {
    const exr_result_t finished = exr_finish(&exr);
    if (result == EXR_ERR_SUCCESS) result = finished;
  }
  if (result == EXR_ERR_SUCCESS) return CELLIST_SUCCESS;
  if (stream.out_of_memory || result == EXR_ERR_OUT_OF_MEMORY)
    return cellist_fail(context, CELLIST_ERROR_OUT_OF_MEMORY, "out of memory while writing EXR");
  return cellist_fail(context, CELLIST_ERROR_INTERNAL, "EXR: %s", exr_get_default_error_message(result));
}

/* Points the pipeline's channels at the planes, for a chunk whose first pixel is (x, y) of the image. */
static void attach_planes(const cellist_image *image, exr_decode_pipeline_t *pipeline, uint32_t x, uint32_t y) {
  for (int16_t i = 0; i < pipeline->channel_count; i++) {
    exr_coding_channel_info_t *channel = &pipeline->channels[i];
    float *plane = cellist_image_channel(image, channel->channel_name);
    channel->decode_to_ptr = (uint8_t *)(plane + (size_t)y * image->width + x);
    channel->user_bytes_per_element = sizeof(float);
    channel->user_data_type = EXR_PIXEL_FLOAT;
    channel->user_pixel_stride = sizeof(float);
    channel->user_line_stride = (int32_t)(image->width * sizeof(float));
  }
}

static exr_result_t decode_chunk(exr_context_t exr, const cellist_image *image, exr_decode_pipeline_t *pipeline,
                                 const exr_chunk_info_t *chunk, bool *started, uint32_t x, uint32_t y) {
  exr_result_t result =
      *started ? exr_decoding_update(exr, 0, chunk, pipeline) : exr_decoding_initialize(exr, 0, chunk, pipeline);
  if (result != EXR_ERR_SUCCESS) return result;
  attach_planes(image, pipeline, x, y);
  /* Chosen anew for each chunk: the last ones of a row or image may be of another size. */
  *started = true;
  result = exr_decoding_choose_default_routines(exr, 0, pipeline);
  return result == EXR_ERR_SUCCESS ? exr_decoding_run(exr, 0, pipeline) : result;
}

static exr_result_t read_scan_lines(exr_context_t exr, const cellist_image *image, const exr_attr_box2i_t *window,
                                    exr_decode_pipeline_t *pipeline, bool *started) {
  int32_t step = 1;
  exr_result_t result = exr_get_scanlines_per_chunk(exr, 0, &step);
  for (uint32_t y = 0; y < image->height && result == EXR_ERR_SUCCESS; y += (uint32_t)step) {
    exr_chunk_info_t chunk;
    result = exr_read_scanline_chunk_info(exr, 0, (int)((int64_t)window->min.y + y), &chunk);
    if (result == EXR_ERR_SUCCESS) result = decode_chunk(exr, image, pipeline, &chunk, started, 0, y);
  }
  return result;
}

static exr_result_t read_tiles(exr_context_t exr, const cellist_image *image, exr_decode_pipeline_t *pipeline,
                               bool *started) {
  int32_t width = 0, height = 0;
  exr_result_t result = exr_get_tile_sizes(exr, 0, 0, 0, &width, &height);
  if (result == EXR_ERR_SUCCESS && (width <= 0 || height <= 0)) return EXR_ERR_FILE_BAD_HEADER;
  for (uint32_t y = 0; y < image->height && result == EXR_ERR_SUCCESS; y += (uint32_t)height)
    for (uint32_t x = 0; x < image->width && result == EXR_ERR_SUCCESS; x += (uint32_t)width) {
      exr_chunk_info_t chunk;
      result = exr_read_tile_chunk_info(exr, 0, (int)(x / (uint32_t)width), (int)(y / (uint32_t)height), 0, 0, &chunk);
      if (result == EXR_ERR_SUCCESS) result = decode_chunk(exr, image, pipeline, &chunk, started, x, y);
    }
  return result;
}

static cellist_result create_for(cellist_context *context, const char *path, exr_context_t exr, size_t file_size,
                                 const exr_attr_box2i_t *window, cellist_image **image) {
  /* A compressed row of one value needs some bytes a chunk; 4096 pixels a byte of file is beyond ZIP's 1:1032. */
  static const uint64_t PIXELS_PER_BYTE = 4096;
  const exr_attr_chlist_t *list = NULL;
  if (exr_get_channels(exr, 0, &list) != EXR_ERR_SUCCESS || list->num_channels <= 0)
    return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: no channels", path);
  const int64_t width = (int64_t)window->max.x - window->min.x + 1, height = (int64_t)window->max.y - window->min.y + 1;
  if (width <= 0 || height <= 0 || (uint64_t)width > PIXELS_PER_BYTE * file_size / (uint64_t)height)
    return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: %lld x %lld pixels do not fit a file of %zu bytes", path,
                        (long long)width, (long long)height, file_size);
  for (int i = 0; i < list->num_channels; i++)
    if (list->entries[i].x_sampling != 1 || list->entries[i].y_sampling != 1)
      return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: channel %s is subsampled", path,
                          list->entries[i].name.str);
  const char **names = cellist_allocate(context, (size_t)list->num_channels, sizeof *names);
  if (names == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (int i = 0; i < list->num_channels; i++) names[i] = list->entries[i].name.str;
  const cellist_result result =
      cellist_image_create(context, (uint32_t)width, (uint32_t)height, names, (size_t)list->num_channels, image);
  cellist_deallocate(context, names);
  return result;
}

static cellist_result read_attributes(exr_context_t exr, cellist_image *image) {
  int32_t count = 0;
  if (exr_get_attribute_count(exr, 0, &count) != EXR_ERR_SUCCESS) return CELLIST_SUCCESS;
  for (int32_t i = 0; i < count; i++) {
    const exr_attribute_t *attribute = NULL;
    if (exr_get_attribute_by_index(exr, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute) != EXR_ERR_SUCCESS) continue;
    if (attribute->type != EXR_ATTR_STRING || attribute->string->str == NULL) continue;
    const cellist_result result = cellist_image_set_attribute(image, attribute->name, attribute->string->str);
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

cellist_result exr_decode(cellist_context *context, const char *path, const byte_buffer *buffer,
                          cellist_image **image) {
  struct stream stream = {context, path, (byte_buffer *)buffer, false};
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  settings.user_data = &stream;
  settings.error_handler_fn = on_error;
  settings.read_fn = read_bytes;
  settings.size_fn = stream_size;
  settings.flags = EXR_CONTEXT_FLAG_STRICT_HEADER | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
  exr_context_t exr = NULL;
  exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
  exr_attr_box2i_t window;
  int part_count = 0;
  exr_result_t opened = exr_start_read(&exr, path, &settings);
  if (opened == EXR_ERR_SUCCESS) opened = exr_get_count(exr, &part_count);
  if (opened == EXR_ERR_SUCCESS) opened = exr_get_storage(exr, 0, &storage);
  if (opened == EXR_ERR_SUCCESS) opened = exr_get_data_window(exr, 0, &window);
  if (opened != EXR_ERR_SUCCESS) {
    if (exr != NULL) exr_finish(&exr);
    return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: %s", path, exr_get_default_error_message(opened));
  }
  cellist_image *created = NULL;
  cellist_result result = CELLIST_SUCCESS;
  if (part_count != 1 || (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED))
    result = cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: an EXR of several parts or of deep pixels", path);
  if (result == CELLIST_SUCCESS) result = create_for(context, path, exr, buffer->size, &window, &created);
  if (result == CELLIST_SUCCESS) result = read_attributes(exr, created);
  if (result == CELLIST_SUCCESS) {
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    bool started = false;
    const exr_result_t decoded = storage == EXR_STORAGE_SCANLINE
                                     ? read_scan_lines(exr, created, &window, &pipeline, &started)
                                     : read_tiles(exr, created, &pipeline, &started);
    if (started) exr_decoding_destroy(exr, &pipeline);
    if (decoded != EXR_ERR_SUCCESS)
      result = cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: %s", path, exr_get_default_error_message(decoded));
  }
  exr_finish(&exr);
  if (result == CELLIST_SUCCESS)
    *image = created;
  else
    cellist_image_destroy(created);
  return result;
}
