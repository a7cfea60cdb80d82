/* SPDX-License-Identifier: BSD-3-Clause
 * Pairs that several workers find at once, kept in blocks that they take from one pool: which worker finds how many is
 * chance, how many blocks that takes is not. Private to sort/. */
#ifndef CELLIST_SORT_PAIRS_H
#define CELLIST_SORT_PAIRS_H

#include <cellist/context.h>
#include <stdatomic.h>

/* Pairs in a block: fewer, and blocks are taken too often; more, and those that workers leave half full are memory. */
enum { SORT_PAIR_BLOCK = 1024 };

typedef struct sort_pairs {
  size_t capacity;     /* blocks */
  uint32_t *items;     /* [2 SORT_PAIR_BLOCK capacity] far, near */
  uint32_t *next;      /* [capacity] the block that its worker took after this one */
  atomic_size_t taken; /* blocks; more than capacity: some pairs were counted only */
} sort_pairs;

/* Where one worker writes. */
typedef struct sort_pair_writer {
  uint32_t block, used; /* CELLIST_NONE and SORT_PAIR_BLOCK: none taken yet, or none left */
  size_t count;         /* pairs found, kept or not */
} sort_pair_writer;

/* Where pairs found one after the other by one worker begin. */
typedef struct sort_pair_range {
  uint32_t block, used;
  size_t count;
} sort_pair_range;

/* Blocks that hold `count` pairs, whichever workers find them. */
static inline size_t sort_pairs_blocks(size_t count, unsigned worker_count) {
  return count / SORT_PAIR_BLOCK + 2 * (size_t)worker_count;
}

/* Makes room for more blocks; those taken are kept. Errors: OUT_OF_MEMORY (what was there stays). */
cellist_result sort_pairs_reserve(cellist_context *context, sort_pairs *pairs, size_t blocks);
void sort_pairs_release(cellist_context *context, sort_pairs *pairs);

/* The next block for a worker, if there is one. */
static inline void sort_pairs_take(sort_pairs *pairs, sort_pair_writer *writer) {
  const uint32_t last = writer->block;
  if (atomic_load_explicit(&pairs->taken, memory_order_relaxed) > pairs->capacity) return;
  const size_t block = atomic_fetch_add_explicit(&pairs->taken, 1, memory_order_relaxed);
  if (block >= pairs->capacity) return;
  writer->block = (uint32_t)block;
  writer->used = 0;
  if (last != CELLIST_NONE) pairs->next[last] = writer->block;
}

/* What a worker finds from here on. */
static inline sort_pair_range sort_pairs_begin(sort_pairs *pairs, sort_pair_writer *writer) {
  if (writer->used == SORT_PAIR_BLOCK) sort_pairs_take(pairs, writer);
  return (sort_pair_range){writer->block, writer->used, 0};
}

static inline void sort_pairs_add(sort_pairs *pairs, sort_pair_writer *writer, uint32_t far, uint32_t near) {
  writer->count++;
  if (writer->used == SORT_PAIR_BLOCK) sort_pairs_take(pairs, writer);
  if (writer->used == SORT_PAIR_BLOCK) return;
  uint32_t *pair = &pairs->items[2 * ((size_t)writer->block * SORT_PAIR_BLOCK + writer->used++)];
  pair[0] = far;
  pair[1] = near;
}

/* The next stretch of a range's pairs that stand in a row; NULL after the last one. */
static inline const uint32_t *sort_pairs_next(const sort_pairs *pairs, sort_pair_range *range, size_t *count) {
  if (range->count == 0) return NULL;
  if (range->used == SORT_PAIR_BLOCK) {
    range->block = pairs->next[range->block];
    range->used = 0;
  }
  const size_t room = SORT_PAIR_BLOCK - range->used;
  const uint32_t *found = &pairs->items[2 * ((size_t)range->block * SORT_PAIR_BLOCK + range->used)];
  *count = range->count < room ? range->count : room;
  range->count -= *count;
  range->used += (uint32_t)*count;
  return found;
}

#endif
