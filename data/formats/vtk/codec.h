/* SPDX-License-Identifier: BSD-3-Clause
 * Codec: one compressed block of a VTK file into bytes. Private to data/. */
#ifndef CELLIST_FORMATS_CODEC_H
#define CELLIST_FORMATS_CODEC_H

#include <cellist/context.h>

enum codec_kind { CODEC_NONE, CODEC_ZLIB, CODEC_LZ4, CODEC_LZMA };

struct codec;

/* A decoder whose memory is the context's. */
cellist_result codec_create(cellist_context *context, enum codec_kind kind, struct codec **codec);
void codec_destroy(struct codec *codec);

/* The most bytes that one compressed byte can stand for: a file that promises more lies. */
size_t codec_largest_ratio(enum codec_kind kind);

/* Whether the block holds exactly size bytes, now in out. */
bool codec_decode(struct codec *codec, const uint8_t *block, size_t block_size, uint8_t *out, size_t size);

/* Whether the last decoding failed for want of memory. */
bool codec_is_out_of_memory(const struct codec *codec);

#endif
