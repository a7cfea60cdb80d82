/* SPDX-License-Identifier: BSD-3-Clause
 * Validation of points: which no cell uses, and which lie in one place (a hash table over their coordinates). */
#include "validate_private.h"

#include <string.h>

static uint64_t hash_of(const double *p) {
  uint64_t hash = 0;
  for (int k = 0; k < 3; k++) {
    const double x = p[k] == 0 ? 0 : p[k]; /* -0 lies where 0 does */
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash * 0xbf58476d1ce4e5b9u >> 32;
}

static bool is_same_place(const double *a, const double *b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

/* place[i] = the first used point in the same place; an unused point is its own. */
static cellist_result find_places(validation *run, const uint8_t *used) {
  const cellist_mesh_arrays *mesh = run->mesh;
  size_t size = 16;
  while (size < 2 * mesh->point_count) size *= 2;
  uint32_t *table = cellist_allocate(run->context, size, sizeof *table);
  if (table == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memset(table, 0xff, size * sizeof *table);
  for (uint32_t i = 0; i < mesh->point_count; i++) {
    run->place[i] = i;
    if (!used[i]) continue;
    size_t slot = hash_of(point_of(mesh, i)) & (size - 1);
    while (table[slot] != CELLIST_NONE && !is_same_place(point_of(mesh, table[slot]), point_of(mesh, i)))
      slot = (slot + 1) & (size - 1);
    if (table[slot] == CELLIST_NONE)
      table[slot] = i;
    else
      run->place[i] = table[slot];
  }
  cellist_deallocate(run->context, table);
  return CELLIST_SUCCESS;
}

/* Makes the place of points the one of lowest origin among them. */
static cellist_result choose_lowest_origin(validation *run) {
  const uint32_t *origin = run->mesh->point_origin;
  uint32_t *lowest = set_create(run->context, run->mesh->point_count);
  if (lowest == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (uint32_t i = 0; i < run->mesh->point_count; i++) {
    uint32_t *best = &lowest[run->place[i]];
    if (origin[i] < origin[*best]) *best = i;
  }
  for (uint32_t i = 0; i < run->mesh->point_count; i++) run->place[i] = lowest[run->place[i]];
  cellist_deallocate(run->context, lowest);
  return CELLIST_SUCCESS;
}

cellist_result validate_points(validation *run) {
  const cellist_mesh_arrays *mesh = run->mesh;
  uint8_t *used = cellist_allocate_zeroed(run->context, mesh->point_count, 1);
  run->place = cellist_allocate(run->context, mesh->point_count, sizeof *run->place);
  cellist_result result = used != NULL && run->place != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) {
    for (size_t i = 0; i < 4 * mesh->tet_count; i++) used[mesh->tets[i]] = 1;
    result = find_places(run, used);
  }
  if (result == CELLIST_SUCCESS) result = choose_lowest_origin(run);
  if (result == CELLIST_SUCCESS) {
    cellist_finding *findings = run->report->findings;
    for (uint32_t i = 0; i < mesh->point_count; i++) {
      cellist_finding *finding = !used[i]             ? &findings[CELLIST_FINDING_UNUSED]
                                 : run->place[i] != i ? &findings[CELLIST_FINDING_COINCIDENT]
                                                      : NULL;
      if (finding == NULL) continue;
      finding->count++;
      finding_keep(finding, mesh->point_origin[i]);
    }
  }
  cellist_deallocate(run->context, used);
  return result;
}
