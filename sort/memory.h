/* SPDX-License-Identifier: BSD-3-Clause
 * Scratch memory that grows to what the largest view needed and is kept. Private to sort/. */
#ifndef CELLIST_SORT_MEMORY_H
#define CELLIST_SORT_MEMORY_H

#include <cellist/context.h>

/* Makes room for count elements in *block, which holds *capacity; the first `used` ones are kept. Grows by half at
 * least, so that views which differ a little seldom allocate. */
static inline cellist_result sort_reserve(cellist_context *context, void *block, size_t *capacity, size_t used,
                                          size_t count, size_t size) {
  void **at = block;
  if (count <= *capacity) return CELLIST_SUCCESS;
  const size_t room = count + count / 2 + 64;
  void *grown = cellist_reallocate(context, *at, used, room, size);
  if (grown == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  *at = grown;
  *capacity = room;
  return CELLIST_SUCCESS;
}

#endif
