/* SPDX-License-Identifier: BSD-3-Clause
 * Pairs: memory of the pool. */
#include "pairs.h"

cellist_result sort_pairs_reserve(cellist_context *context, sort_pairs *pairs, size_t blocks) {
  if (blocks <= pairs->capacity) return CELLIST_SUCCESS;
  void *next = cellist_reallocate(context, pairs->next, pairs->capacity, blocks, sizeof *pairs->next);
  if (next == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  pairs->next = next;
  const size_t size = 2 * SORT_PAIR_BLOCK * sizeof *pairs->items;
  void *items = cellist_reallocate(context, pairs->items, pairs->capacity, blocks, size);
  if (items == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  pairs->items = items;
  pairs->capacity = blocks;
  return CELLIST_SUCCESS;
}

void sort_pairs_release(cellist_context *context, sort_pairs *pairs) {
  cellist_deallocate(context, pairs->next);
  cellist_deallocate(context, pairs->items);
  pairs->next = pairs->items = NULL;
  pairs->capacity = 0;
}
