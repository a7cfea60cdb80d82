/* SPDX-License-Identifier: BSD-3-Clause
 * Radix: least significant byte first; a byte that all keys share costs its count and no move. */
#include <cellist/radix.h>

#include <string.h>

void cellist_radix_sort(uint64_t *keys, uint32_t *values, size_t count, uint64_t *scratch_keys,
                        uint32_t *scratch_values, unsigned key_bits) {
  uint64_t *from_keys = keys, *to_keys = scratch_keys;
  uint32_t *from_values = values, *to_values = scratch_values;
  for (unsigned shift = 0; shift < key_bits; shift += 8) {
    size_t start[256] = {0};
    for (size_t i = 0; i < count; i++) start[(from_keys[i] >> shift) & 255]++;
    if (count == 0 || start[(from_keys[0] >> shift) & 255] == count) continue;
    size_t sum = 0;
    for (size_t digit = 0; digit < 256; digit++) {
      const size_t here = start[digit];
      start[digit] = sum;
      sum += here;
    }
    for (size_t i = 0; i < count; i++) {
      const size_t to = start[(from_keys[i] >> shift) & 255]++;
      to_keys[to] = from_keys[i];
      to_values[to] = from_values[i];
    }
    uint64_t *swap_keys = from_keys;
    from_keys = to_keys;
    to_keys = swap_keys;
    uint32_t *swap_values = from_values;
    from_values = to_values;
    to_values = swap_values;
  }
  if (from_keys != keys) {
    memcpy(keys, from_keys, count * sizeof *keys);
    memcpy(values, from_values, count * sizeof *values);
  }
}
