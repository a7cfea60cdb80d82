/* SPDX-License-Identifier: BSD-3-Clause
 * Fragments: the pixels of cells that wait to be shaded, and their order inside a group.
 *
 * Cells of a group are convex and disjoint: on one ray, the middles of what they cover stand in the order in which the
 * ray meets them (paper [C], section 4; algorithms of groups are the same for pairs and for hundreds of cells here,
 * since a stable radix sort of a tile's fragments costs less than shading them). */
#include <cellist/radix.h>
#include <string.h>

#include "scene.h"

static bool grow(cellist_context *context, void *array, size_t old_count, size_t new_count, size_t size) {
  void *block;
  memcpy(&block, array, sizeof block);
  block = cellist_reallocate(context, block, old_count, new_count, size);
  if (block == NULL) return false;
  memcpy(array, &block, sizeof block);
  return true;
}

bool soft_fragments_reserve(cellist_context *context, soft_fragments *fragments, size_t count) {
  const size_t needed = fragments->count + count + 8; /* vectors are stored whole */
  if (needed <= fragments->capacity) return true;
  const size_t old = fragments->capacity, capacity = needed > 2 * old ? needed : 2 * old;
  const bool ok = grow(context, &fragments->near_end, old, capacity, sizeof *fragments->near_end) &&
                  grow(context, &fragments->far_end, old, capacity, sizeof *fragments->far_end) &&
                  grow(context, &fragments->where, old, capacity, sizeof *fragments->where) &&
                  grow(context, &fragments->cell, old, capacity, sizeof *fragments->cell) &&
                  grow(context, &fragments->records, old, capacity, sizeof *fragments->records) &&
                  (!fragments->has_gradients ||
                   grow(context, &fragments->gradients, old, capacity, sizeof *fragments->gradients)) &&
                  (!fragments->is_sharp || grow(context, &fragments->ends, old, capacity, sizeof *fragments->ends));
  if (ok) fragments->capacity = capacity;
  return ok;
}

void soft_fragments_release(cellist_context *context, soft_fragments *fragments) {
  cellist_deallocate(context, fragments->near_end);
  cellist_deallocate(context, fragments->far_end);
  cellist_deallocate(context, fragments->where);
  cellist_deallocate(context, fragments->cell);
  cellist_deallocate(context, fragments->records);
  cellist_deallocate(context, fragments->gradients);
  cellist_deallocate(context, fragments->ends);
  *fragments = (soft_fragments){0};
}

static bool reserve_keys(cellist_context *context, soft_worker *worker, size_t count) {
  if (count <= worker->sort_capacity) return true;
  const size_t old = worker->sort_capacity, capacity = count > 2 * old ? count : 2 * old;
  const bool ok = grow(context, &worker->keys, old, capacity, sizeof *worker->keys) &&
                  grow(context, &worker->scratch_keys, old, capacity, sizeof *worker->scratch_keys) &&
                  grow(context, &worker->values, old, capacity, sizeof *worker->values) &&
                  grow(context, &worker->scratch_values, old, capacity, sizeof *worker->scratch_values);
  if (ok) worker->sort_capacity = capacity;
  return ok;
}

/* Larger places first: they are nearer. */
static uint32_t nearness_key(float place) {
  uint32_t bits;
  memcpy(&bits, &place, sizeof bits);
  bits = bits >> 31 ? ~bits : bits | 0x80000000u;
  return ~bits;
}

bool soft_sort_fragments(const soft_scene *scene, soft_worker *worker) {
  soft_fragments *from = &worker->fragments, *to = &worker->sorted;
  const size_t count = from->count;
  to->count = 0;
  if (!reserve_keys(scene->context, worker, count) || !soft_fragments_reserve(scene->context, to, count)) return false;
  for (size_t i = 0; i < count; i++) {
    const soft_record *record = &from->records[from->cell[i]];
    const float x = (float)(from->where[i] >> 16 & 0xff), y = (float)(from->where[i] >> 24);
    const float place = record->place + record->place_x * x + record->place_y * y;
    const float middle = place + 0.5f * (from->near_end[i] + from->far_end[i]);
    worker->keys[i] = (uint64_t)(from->where[i] & 0xffff) << 32 | nearness_key(middle);
    worker->values[i] = (uint32_t)i;
  }
  cellist_radix_sort(worker->keys, worker->values, count, worker->scratch_keys, worker->scratch_values, 48);
  for (size_t i = 0; i < count; i++) {
    const uint32_t source = worker->values[i];
    to->near_end[i] = from->near_end[source];
    to->far_end[i] = from->far_end[source];
    to->where[i] = from->where[source];
    to->cell[i] = from->cell[source];
  }
  memcpy(to->records, from->records, from->record_count * sizeof *to->records);
  if (from->has_gradients) memcpy(to->gradients, from->gradients, from->record_count * sizeof *to->gradients);
  if (from->is_sharp) memcpy(to->ends, from->ends, from->record_count * sizeof *to->ends);
  to->count = count;
  to->record_count = from->record_count;
  const soft_fragments swapped = *from;
  *from = *to;
  *to = swapped;
  return true;
}
