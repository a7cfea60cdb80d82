/* SPDX-License-Identifier: BSD-3-Clause
 * Array: the numbers of one DataArray, from text, base64 or raw bytes, whole or in compressed blocks.
 *
 * Nothing is allocated before the file's own bytes justify it: text needs two bytes a number, plain data their size,
 * and compressed blocks may not promise more than their codec's largest ratio. Every encoded byte may serve one array
 * only (the document's budget), so overlapping offsets cannot make much of little. */
#include "../text.h"
#include "xml.h"

#include <stdio.h>
#include <string.h>

/* Encoded bytes: raw, or base64 whose groups of four decode on their own (so that padding between a header and its
 * data does no harm). */
struct stream {
  const uint8_t *at, *end;
  bool is_base64;
  uint8_t group[3]; /* decoded and not yet taken */
  unsigned group_size;
};

static int base64_digit(uint8_t c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Decodes the next group of four; false at the end or at what is no base64. */
static bool next_group(struct stream *stream) {
  int digits[4] = {0};
  int count = 0, padding = 0;
  while (count < 4 && stream->at < stream->end) {
    const uint8_t c = *stream->at++;
    if (c == ' ' || (c >= '\t' && c <= '\r')) continue;
    if (c == '=') {
      padding++;
      digits[count++] = 0;
      continue;
    }
    const int digit = base64_digit(c);
    if (digit < 0 || padding > 0) return false;
    digits[count++] = digit;
  }
  if (count < 4 || padding > 2) return false;
  const unsigned bits = (unsigned)(digits[0] << 18 | digits[1] << 12 | digits[2] << 6 | digits[3]);
  stream->group[0] = (uint8_t)(bits >> 16);
  stream->group[1] = (uint8_t)(bits >> 8);
  stream->group[2] = (uint8_t)bits;
  stream->group_size = 3 - (unsigned)padding;
  return true;
}

/* The most bytes that the stream can still give. */
static size_t stream_left(const struct stream *stream) {
  const size_t left = (size_t)(stream->end - stream->at);
  return stream->is_base64 ? left / 4 * 3 + stream->group_size : left;
}

static bool stream_read(struct stream *stream, uint8_t *out, size_t size) {
  if (!stream->is_base64) {
    if ((size_t)(stream->end - stream->at) < size) return false;
    if (size > 0) memcpy(out, stream->at, size);
    stream->at += size;
    return true;
  }
  while (size > 0) {
    if (stream->group_size == 0 && !next_group(stream)) return false;
    const unsigned taken = stream->group_size < size ? stream->group_size : (unsigned)size;
    memcpy(out, stream->group, taken);
    memmove(stream->group, stream->group + taken, stream->group_size - taken);
    stream->group_size -= taken;
    out += taken;
    size -= taken;
  }
  return true;
}

struct decoder {
  cellist_context *context;
  const struct source *source;
  struct xml_document *document;
  const struct xml_array *array;
  struct stream stream;
  struct element_sink sink;
  uint64_t block_count, block_size, last_size; /* of compressed data, decoded */
  uint8_t *block_sizes;                        /* compressed, as in the file */
};

static cellist_result fail(const struct decoder *decoder, const char *reason) {
  const size_t at =
      decoder->stream.at != NULL ? (size_t)(decoder->stream.at - decoder->source->bytes) : decoder->array->begin;
  return source_fail_at(decoder->context, decoder->source, at, "array '%.64s': %s", decoder->array->name, reason);
}

static bool read_word(struct decoder *decoder, uint64_t *word) {
  uint8_t bytes[8];
  const size_t size = decoder->document->header_size;
  if (!stream_read(&decoder->stream, bytes, size)) return false;
  *word =
      size == 4 ? element_load_u32(bytes, decoder->document->swap) : element_load_u64(bytes, decoder->document->swap);
  return true;
}

static uint64_t compressed_size(const struct decoder *decoder, uint64_t block) {
  const size_t size = decoder->document->header_size;
  const uint8_t *bytes = decoder->block_sizes + size * block;
  return size == 4 ? element_load_u32(bytes, decoder->document->swap)
                   : element_load_u64(bytes, decoder->document->swap);
}

static uint64_t decoded_size(const struct decoder *decoder, uint64_t block) {
  return block + 1 == decoder->block_count ? decoder->last_size : decoder->block_size;
}

/* Reads the header of compressed data; *size: decoded bytes in all, justified by the compressed ones. */
static cellist_result read_blocks_header(struct decoder *decoder, uint64_t *size) {
  const uint64_t ratio = codec_largest_ratio(decoder->document->codec);
  *size = 0;
  if (!read_word(decoder, &decoder->block_count)) return fail(decoder, "the header is cut");
  if (decoder->block_count == 0) return CELLIST_SUCCESS;
  if (!read_word(decoder, &decoder->block_size) || !read_word(decoder, &decoder->last_size))
    return fail(decoder, "the header is cut");
  if (decoder->last_size == 0) decoder->last_size = decoder->block_size;
  if (decoder->block_count > stream_left(&decoder->stream) / decoder->document->header_size)
    return fail(decoder, "the header promises more blocks than the file has bytes for");
  const size_t bytes = (size_t)decoder->block_count * decoder->document->header_size;
  decoder->block_sizes = cellist_allocate(decoder->context, bytes, 1);
  if (decoder->block_sizes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (!stream_read(&decoder->stream, decoder->block_sizes, bytes)) return fail(decoder, "the header is cut");
  uint64_t left = stream_left(&decoder->stream);
  for (uint64_t block = 0; block < decoder->block_count; block++) {
    const uint64_t packed = compressed_size(decoder, block), plain = decoded_size(decoder, block);
    if (packed > left) return fail(decoder, "a block lies beyond the end of the data");
    if (plain / ratio > packed) return fail(decoder, "a block promises more than its compressed bytes can hold");
    left -= packed;
    *size += plain; /* no overflow: each is at most ratio times bytes of the file, plus ratio */
  }
  return CELLIST_SUCCESS;
}

static cellist_result push(struct decoder *decoder, const uint8_t *bytes, size_t size) {
  if (element_sink_push(&decoder->sink, bytes, size)) return CELLIST_SUCCESS;
  char reason[80];
  snprintf(reason, sizeof reason, "value %zu is negative, too large or not whole", decoder->sink.filled);
  return fail(decoder, reason);
}

static cellist_result read_blocks(struct decoder *decoder) {
  uint64_t largest = 0, largest_packed = 0;
  for (uint64_t block = 0; block < decoder->block_count; block++) {
    const uint64_t packed = compressed_size(decoder, block), plain = decoded_size(decoder, block);
    largest = plain > largest ? plain : largest;
    largest_packed = packed > largest_packed ? packed : largest_packed;
  }
  struct codec *codec = NULL;
  uint8_t *plain = cellist_allocate(decoder->context, (size_t)largest, 1), *packed = NULL;
  cellist_result result = plain != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS && decoder->stream.is_base64) {
    packed = cellist_allocate(decoder->context, (size_t)largest_packed, 1);
    if (packed == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  }
  if (result == CELLIST_SUCCESS) result = codec_create(decoder->context, decoder->document->codec, &codec);
  for (uint64_t block = 0; block < decoder->block_count && result == CELLIST_SUCCESS; block++) {
    const size_t from = (size_t)compressed_size(decoder, block), to = (size_t)decoded_size(decoder, block);
    const uint8_t *bytes = decoder->stream.at;
    if (packed == NULL) {
      decoder->stream.at += from;
    } else if (stream_read(&decoder->stream, packed, from)) {
      bytes = packed;
    } else {
      result = fail(decoder, "the base64 data are cut or malformed");
      break;
    }
    if (codec_decode(codec, bytes, from, plain, to))
      result = push(decoder, plain, to);
    else if (codec_is_out_of_memory(codec))
      result = cellist_fail(decoder->context, CELLIST_ERROR_OUT_OF_MEMORY, "out of memory");
    else
      result = fail(decoder, "a compressed block is damaged");
  }
  codec_destroy(codec);
  cellist_deallocate(decoder->context, plain);
  cellist_deallocate(decoder->context, packed);
  return result;
}

static cellist_result read_plain(struct decoder *decoder, uint64_t size) {
  uint8_t portion[3072];
  if (!decoder->stream.is_base64) {
    const cellist_result result = push(decoder, decoder->stream.at, (size_t)size);
    decoder->stream.at += size;
    return result;
  }
  while (size > 0) {
    const size_t part = size < sizeof portion ? (size_t)size : sizeof portion;
    if (!stream_read(&decoder->stream, portion, part)) return fail(decoder, "the base64 data are cut or malformed");
    const cellist_result result = push(decoder, portion, part);
    if (result != CELLIST_SUCCESS) return result;
    size -= part;
  }
  return CELLIST_SUCCESS;
}

/* Allocates the values once their number is known to be justified. */
static cellist_result prepare_values(struct decoder *decoder, uint64_t bytes, size_t *count, void **values) {
  const size_t each = element_size(decoder->array->type);
  if (bytes % each != 0) return fail(decoder, "its size is no multiple of its numbers' size");
  if (*count != SIZE_MAX && bytes / each != *count) {
    char reason[96];
    snprintf(reason, sizeof reason, "holds %llu numbers instead of %zu", (unsigned long long)(bytes / each), *count);
    return fail(decoder, reason);
  }
  *count = (size_t)(bytes / each);
  *values = cellist_allocate(decoder->context, *count, element_kind_size(decoder->sink.kind));
  if (*values == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  decoder->sink.values = *values;
  decoder->sink.count = *count;
  return CELLIST_SUCCESS;
}

static cellist_result decode_binary(struct decoder *decoder, size_t *count, void **values) {
  const bool is_packed = decoder->document->codec != CODEC_NONE;
  uint64_t size = 0;
  cellist_result result = CELLIST_SUCCESS;
  if (is_packed)
    result = read_blocks_header(decoder, &size);
  else if (!read_word(decoder, &size))
    result = fail(decoder, "the header is cut");
  if (result == CELLIST_SUCCESS && !is_packed && size > stream_left(&decoder->stream))
    result = fail(decoder, "its size goes beyond the end of the data");
  if (result == CELLIST_SUCCESS) result = prepare_values(decoder, size, count, values);
  if (result == CELLIST_SUCCESS) result = is_packed ? read_blocks(decoder) : read_plain(decoder, size);
  cellist_deallocate(decoder->context, decoder->block_sizes);
  return result;
}

static cellist_result decode_text(struct decoder *decoder, size_t *count, void **values) {
  struct text text = {decoder->stream.at, decoder->stream.at, decoder->stream.end, 0};
  if (*count == SIZE_MAX) {
    struct text ahead = text;
    for (*count = 0; text_next_word(&ahead).length > 0;) ++*count;
  }
  if (*count > ((size_t)(text.end - text.at) + 1) / 2) return fail(decoder, "has fewer numbers than it should");
  *values = cellist_allocate(decoder->context, *count, element_kind_size(decoder->sink.kind));
  if (*values == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  size_t filled = 0;
  const bool ok = text_read_values(&text, decoder->sink.kind, *values, *count, &filled);
  decoder->stream.at = text.at;
  if (!ok) {
    char reason[80];
    snprintf(reason, sizeof reason, "value %zu is missing or not of its type", filled);
    return fail(decoder, reason);
  }
  if (text_next_word(&text).length > 0) return fail(decoder, "has more numbers than it should");
  decoder->stream.at = decoder->stream.end;
  return CELLIST_SUCCESS;
}

static cellist_result locate(struct decoder *decoder) {
  const struct xml_document *document = decoder->document;
  const struct xml_array *array = decoder->array;
  const uint8_t *bytes = decoder->source->bytes;
  if (array->format != XML_APPENDED) {
    decoder->stream = (struct stream){.at = bytes + array->begin, .end = bytes + array->end};
    decoder->stream.is_base64 = array->format == XML_INLINE;
    return CELLIST_SUCCESS;
  }
  if (!document->has_appended) return fail(decoder, "is appended, but the file has no appended data");
  const size_t left = decoder->source->size - document->appended;
  if (array->offset >= left) return fail(decoder, "its offset lies beyond the end of the file");
  decoder->stream.at = bytes + document->appended + array->offset;
  decoder->stream.end = bytes + decoder->source->size;
  decoder->stream.is_base64 = document->appended_is_base64;
  return CELLIST_SUCCESS;
}

cellist_result xml_decode(cellist_context *context, const struct source *source, struct xml_document *document,
                          const struct xml_array *array, enum element_kind kind, size_t *count, void **values) {
  struct decoder decoder = {.context = context, .source = source, .document = document, .array = array};
  decoder.sink = (struct element_sink){.type = array->type, .swap = document->swap, .kind = kind};
  *values = NULL;
  if (!array->has_numbers) return fail(&decoder, "is of a type that holds no numbers");
  cellist_result result = locate(&decoder);
  const uint8_t *from = decoder.stream.at;
  if (result == CELLIST_SUCCESS && (size_t)(decoder.stream.end - from) > document->budget)
    decoder.stream.end = from + document->budget;
  if (result == CELLIST_SUCCESS)
    result = array->format == XML_ASCII ? decode_text(&decoder, count, values) : decode_binary(&decoder, count, values);
  if (result == CELLIST_SUCCESS) {
    document->budget -= (size_t)(decoder.stream.at - from);
  } else {
    cellist_deallocate(context, *values);
    *values = NULL;
  }
  return result;
}

static cellist_result read_field(cellist_context *context, const struct source *source, struct xml_document *document,
                                 const struct xml_array *array, struct grid *grid) {
  const bool on_points = array->section == XML_POINT_DATA;
  const cellist_association association = on_points ? CELLIST_ON_POINTS : CELLIST_ON_CELLS;
  size_t count = 0;
  void *values = NULL;
  if (__builtin_mul_overflow(on_points ? grid->point_count : grid->cell_count, (size_t)array->component_count, &count))
    return source_fail(context, source, "array '%.64s' is too large", array->name);
  cellist_result result = xml_decode(context, source, document, array, ELEMENT_AS_DOUBLE, &count, &values);
  if (result != CELLIST_SUCCESS) return result;
  const bool is_level = strcmp(array->name, "vtkGhostLevels") == 0;
  if (array->component_count == 1 && (is_level || strcmp(array->name, "vtkGhostType") == 0)) {
    result = grid_hide_by_ghost_type(context, grid, association, values, is_level);
    cellist_deallocate(context, values);
    return result;
  }
  return grid_add_field(context, grid, array->name, association, array->component_count, values);
}

cellist_result xml_read_fields(cellist_context *context, const struct source *source, struct xml_document *document,
                               size_t piece, struct grid *grid) {
  size_t end = 0;
  for (size_t i = xml_first_array(document, piece, &end); i < end; i++) {
    const struct xml_array *array = &document->arrays[i];
    if (array->section != XML_POINT_DATA && array->section != XML_CELL_DATA) continue;
    if (!array->has_numbers) {
      cellist_log(context, CELLIST_LOG_INFO, "%s: array '%s' holds no numbers: left out", source->name, array->name);
      continue;
    }
    const cellist_result result = read_field(context, source, document, array, grid);
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

cellist_result xml_read_points(cellist_context *context, const struct source *source, struct xml_document *document,
                               size_t piece, size_t point_count, double **points) {
  const struct xml_array *array = xml_find(document, piece, XML_POINTS, NULL);
  if (point_count >= CELLIST_NONE)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: %zu points are more than 32-bit ids allow",
                        source->name, point_count);
  if (array == NULL && point_count > 0) return source_fail(context, source, "a piece has no Points");
  if (array != NULL && array->component_count != 3 && point_count > 0)
    return source_fail(context, source, "points have %u coordinates instead of 3", array->component_count);
  size_t count = 3 * point_count;
  void *values = NULL;
  const cellist_result result = array != NULL && point_count > 0
                                    ? xml_decode(context, source, document, array, ELEMENT_AS_DOUBLE, &count, &values)
                                    : CELLIST_SUCCESS;
  *points = values;
  return result;
}
