/* SPDX-License-Identifier: BSD-3-Clause
 * Stable sort of 64-bit keys with 32-bit values, in linear time. */
#ifndef CELLIST_RADIX_H
#define CELLIST_RADIX_H

#include <cellist/context.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Sorts count (key, value) pairs by the key's lowest key_bits bits, ascending and stable.
 * Arrays: count entries each, the caller's; the scratch pair is overwritten. The result is in keys and values.
 * Threads: any. Cost: one pass per byte of key that is not the same for all. */
CELLIST_API void cellist_radix_sort(uint64_t *keys, uint32_t *values, size_t count, uint64_t *scratch_keys,
                                    uint32_t *scratch_values, unsigned key_bits);

#ifdef __cplusplus
}
#endif
#endif
