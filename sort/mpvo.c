/* SPDX-License-Identifier: BSD-3-Clause
 * MPVO: meshed polyhedra visibility order (Williams 1992; Roettger et al. 2004, section 3).
 *
 * Of the two cells at a face, the one on the eye's side of the face's plane lies in front. A cell is ready when all
 * its neighbours behind it are out. Of the ready cells the farthest comes next, so that parts of a concave mesh that
 * share no face stand in order of distance; if none is ready (a cycle), the farthest of all that are left breaks it. */
#include "mpvo.h"

#include <string.h>

/* Distance as an integer that orders like it: the bits of a non-negative float. */
static uint32_t distance_key(const sort_eye *eye, const cellist_sorter_desc *mesh, uint32_t tet) {
  double squared = 0, along = 0;
  for (int k = 0; k < 3; k++) {
    double centre = 0;
    for (int c = 0; c < 4; c++) centre += 0.25 * mesh->points[3 * (size_t)mesh->tets[4 * (size_t)tet + c] + k];
    squared += (centre - eye->at[k]) * (centre - eye->at[k]);
    along -= centre * eye->at[k];
  }
  const float distance = (float)(eye->parallel ? along : squared);
  uint32_t bits = 0;
  memcpy(&bits, &distance, sizeof bits);
  return bits >> 31 ? ~bits : bits | 0x80000000u;
}

static void heap_push(uint64_t *heap, size_t *count, uint64_t key) {
  size_t at = (*count)++;
  while (at > 0 && heap[(at - 1) / 2] < key) {
    heap[at] = heap[(at - 1) / 2];
    at = (at - 1) / 2;
  }
  heap[at] = key;
}

static uint64_t heap_pop(uint64_t *heap, size_t *count) {
  const uint64_t top = heap[0], last = heap[--*count];
  size_t at = 0;
  for (;;) {
    size_t child = 2 * at + 1;
    if (child >= *count) break;
    if (child + 1 < *count && heap[child + 1] > heap[child]) child++;
    if (heap[child] <= last) break;
    heap[at] = heap[child];
    at = child;
  }
  heap[at] = last;
  return top;
}

static uint8_t state_of(const cellist_sorter_desc *mesh, const sort_eye *eye, uint32_t tet) {
  uint8_t state = 0;
  for (size_t k = 0; k < 4; k++) {
    if (mesh->neighbours[4 * (size_t)tet + k] == CELLIST_NONE) continue;
    const double *p[3];
    for (size_t c = 0; c < 3; c++) p[c] = &mesh->points[3 * (size_t)mesh->tets[4 * (size_t)tet + SORT_TET_FACE[k][c]]];
    const int side = sort_eye_side(eye, p[0], p[1], p[2]);
    state = (uint8_t)(state + (side > 0 ? 1 << k : side < 0 ? 16 : 0));
  }
  return state;
}

/* The farthest cell that is not out yet; OUT marks those that are. */
enum { OUT = 0x80 };
static uint32_t farthest_left(const cellist_sorter *sorter, const sort_eye *eye) {
  uint32_t farthest = CELLIST_NONE, farthest_key = 0;
  for (uint32_t i = 0; i < sorter->mesh.tet_count; i++) {
    if (sorter->state[i] & OUT) continue;
    const uint32_t key = distance_key(eye, &sorter->mesh, i);
    if (farthest != CELLIST_NONE && key <= farthest_key) continue;
    farthest = i;
    farthest_key = key;
  }
  return farthest;
}

void sort_by_faces(cellist_sorter *sorter, const sort_eye *eye, uint32_t *order, cellist_sort_stats *stats) {
  const cellist_sorter_desc *mesh = &sorter->mesh;
  uint8_t *state = sorter->state;
  size_t ready_count = 0;
  for (uint32_t i = 0; i < mesh->tet_count; i++) {
    state[i] = state_of(mesh, eye, i);
    if (state[i] < 16) heap_push(sorter->heap, &ready_count, (uint64_t)distance_key(eye, mesh, i) << 32 | i);
  }
  stats->exact = sorter->convex;
  for (size_t out = 0; out < mesh->tet_count; out++) {
    if (ready_count == 0) stats->exact = false;
    const uint32_t tet = ready_count > 0 ? (uint32_t)heap_pop(sorter->heap, &ready_count) : farthest_left(sorter, eye);
    order[out] = tet;
    const uint8_t front = state[tet] & 15;
    state[tet] = OUT;
    for (size_t k = 0; k < 4; k++) {
      if (!(front >> k & 1)) continue;
      const uint32_t next = mesh->neighbours[4 * (size_t)tet + k];
      if (state[next] & OUT) continue;
      state[next] = (uint8_t)(state[next] - 16);
      if (state[next] < 16) heap_push(sorter->heap, &ready_count, (uint64_t)distance_key(eye, mesh, next) << 32 | next);
    }
  }
}
