/* SPDX-License-Identifier: BSD-3-Clause
 * Codec: zlib, lz4 (raw blocks) and lzma (.xz streams) as vtkZLibDataCompressor, vtkLZ4DataCompressor and
 * vtkLZMADataCompressor write them. Both libraries that allocate do so through the context. */
#include "codec.h"

#include <lz4.h>
#include <lzma.h>
#include <string.h>
#include <zlib.h>

/* Dictionaries of up to 64 MiB are what the strongest preset uses, and one costs that much memory whatever the block
 * holds; smaller refuses files, larger lets a small file take more. */
static const uint64_t LZMA_MEMORY_LIMIT = (uint64_t)80 << 20;

struct codec {
  cellist_context *context;
  enum codec_kind kind;
  z_stream zlib;
  bool has_zlib;
  bool out_of_memory;
};

static void *zlib_allocate(void *user, unsigned count, unsigned size) { return cellist_allocate(user, count, size); }
static void zlib_deallocate(void *user, void *block) { cellist_deallocate(user, block); }
static void *lzma_allocate(void *user, size_t count, size_t size) { return cellist_allocate(user, count, size); }
static void lzma_deallocate(void *user, void *block) { cellist_deallocate(user, block); }

cellist_result codec_create(cellist_context *context, enum codec_kind kind, struct codec **codec) {
  struct codec *made = cellist_allocate_zeroed(context, 1, sizeof *made);
  if (made == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  made->context = context;
  made->kind = kind;
  if (kind == CODEC_ZLIB) {
    made->zlib.zalloc = zlib_allocate;
    made->zlib.zfree = zlib_deallocate;
    made->zlib.opaque = context;
    made->has_zlib = inflateInit(&made->zlib) == Z_OK;
    if (!made->has_zlib) {
      codec_destroy(made);
      return cellist_fail(context, CELLIST_ERROR_OUT_OF_MEMORY, "zlib cannot start");
    }
  }
  *codec = made;
  return CELLIST_SUCCESS;
}

void codec_destroy(struct codec *codec) {
  if (codec == NULL) return;
  if (codec->has_zlib) inflateEnd(&codec->zlib);
  cellist_deallocate(codec->context, codec);
}

size_t codec_largest_ratio(enum codec_kind kind) {
  switch (kind) {
    case CODEC_NONE: return 1;
    case CODEC_ZLIB: return 1032; /* 258 bytes by 2 bits: deflate's limit */
    case CODEC_LZ4: return 255;   /* one length byte */
    case CODEC_LZMA: return 8192; /* 273 bytes by a fraction of a bit; zeros measured 6,900 to 7,100 */
  }
  return 1;
}

static bool decode_zlib(struct codec *codec, const uint8_t *block, size_t block_size, uint8_t *out, size_t size) {
  z_stream *z = &codec->zlib;
  if (inflateReset(z) != Z_OK) return false;
  z->next_in = (Bytef *)block;
  z->next_out = out;
  size_t in_left = block_size, out_left = size;
  for (;;) {
    /* zlib counts in unsigned: feed huge blocks in parts. */
    const unsigned in_part = in_left < (1u << 30) ? (unsigned)in_left : 1u << 30;
    const unsigned out_part = out_left < (1u << 30) ? (unsigned)out_left : 1u << 30;
    z->avail_in = in_part;
    z->avail_out = out_part;
    const int status = inflate(z, Z_NO_FLUSH);
    in_left -= in_part - z->avail_in;
    out_left -= out_part - z->avail_out;
    if (status == Z_STREAM_END) return out_left == 0;
    if (status == Z_MEM_ERROR) codec->out_of_memory = true;
    if (status != Z_OK) return false;
  }
}

static bool decode_lzma(struct codec *codec, const uint8_t *block, size_t block_size, uint8_t *out, size_t size) {
  const lzma_allocator allocator = {lzma_allocate, lzma_deallocate, codec->context};
  uint64_t memory_limit = LZMA_MEMORY_LIMIT;
  size_t in_at = 0, out_at = 0;
  const lzma_ret status =
      lzma_stream_buffer_decode(&memory_limit, 0, &allocator, block, &in_at, block_size, out, &out_at, size);
  if (status == LZMA_MEM_ERROR) codec->out_of_memory = true;
  return status == LZMA_OK && out_at == size;
}

bool codec_decode(struct codec *codec, const uint8_t *block, size_t block_size, uint8_t *out, size_t size) {
  switch (codec->kind) {
    case CODEC_NONE:
      if (block_size == size && size > 0) memcpy(out, block, size);
      return block_size == size;
    case CODEC_ZLIB: return decode_zlib(codec, block, block_size, out, size);
    case CODEC_LZ4:
      return block_size <= INT32_MAX && size <= INT32_MAX &&
             LZ4_decompress_safe((const char *)block, (char *)out, (int)block_size, (int)size) == (int)size;
    case CODEC_LZMA: return decode_lzma(codec, block, block_size, out, size);
  }
  return false;
}

bool codec_is_out_of_memory(const struct codec *codec) { return codec->out_of_memory; }
