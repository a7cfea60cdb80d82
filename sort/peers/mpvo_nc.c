/* SPDX-License-Identifier: BSD-3-Clause
 * MPVO-NC: Williams' heuristic for non-convex meshes ("Visibility-ordering meshed polyhedra", 1992, section 6): the
 * boundary cells in order of distance, farthest first; from each a depth-first search that puts a cell out after
 * all its neighbours behind it. Face planes in floats; cycles are cut where the search meets them. Cells that only a
 * gap separates are ordered by distance, which is wrong for some. */
#include <string.h>

#include "peer.h"

cellist_result peer_prepare_mpvo_nc(cellist_peer *peer) {
  const cellist_sorter_desc *mesh = &peer->mesh;
  const cellist_result result = peer_prepare_centroids(peer);
  if (result != CELLIST_SUCCESS) return result;
  peer->planes = cellist_allocate(peer->context, mesh->tet_count, 16 * sizeof *peer->planes);
  peer->stack = cellist_allocate(peer->context, mesh->tet_count, sizeof *peer->stack);
  peer->visited = cellist_allocate(peer->context, mesh->tet_count, sizeof *peer->visited);
  if (peer->planes == NULL || peer->stack == NULL || peer->visited == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < mesh->tet_count; i++) {
    for (size_t k = 0; k < 4; k++) {
      const double *p[3];
      for (size_t c = 0; c < 3; c++) p[c] = &mesh->points[3 * (size_t)mesh->tets[4 * i + SORT_TET_FACE[k][c]]];
      double normal[3], offset = 0;
      for (size_t c = 0; c < 3; c++) {
        const size_t x = (c + 1) % 3, y = (c + 2) % 3;
        normal[c] = (p[1][x] - p[0][x]) * (p[2][y] - p[0][y]) - (p[1][y] - p[0][y]) * (p[2][x] - p[0][x]);
      }
      for (size_t c = 0; c < 3; c++) {
        offset -= normal[c] * p[0][c];
        peer->planes[16 * i + 4 * k + c] = (float)normal[c];
      }
      peer->planes[16 * i + 4 * k + 3] = (float)offset;
    }
  }
  return CELLIST_SUCCESS;
}

/* visited: 0 no; 1 to 4 on the stack, so many faces seen; 5 out. */
enum { ALL_FACES = 4, OUT = 5 };

static size_t search(cellist_peer *peer, const float eye[4], uint32_t from, uint32_t *order, size_t count) {
  size_t depth = 0;
  peer->stack[0] = from;
  peer->visited[from] = 1;
  uint8_t next_face = 0;
  for (;;) {
    const uint32_t tet = peer->stack[depth];
    uint32_t behind = CELLIST_NONE;
    while (next_face < ALL_FACES && behind == CELLIST_NONE) {
      const float *plane = &peer->planes[16 * (size_t)tet + 4 * (size_t)next_face];
      const uint32_t other = peer->mesh.neighbours[4 * (size_t)tet + next_face++];
      if (other == CELLIST_NONE || peer->visited[other] != 0) continue;
      if (plane[0] * eye[0] + plane[1] * eye[1] + plane[2] * eye[2] + plane[3] * eye[3] < 0) behind = other;
    }
    if (behind != CELLIST_NONE) {
      peer->visited[tet] = next_face;
      peer->stack[++depth] = behind;
      peer->visited[behind] = 1;
      next_face = 0;
      continue;
    }
    order[count++] = tet;
    peer->visited[tet] = OUT;
    if (depth-- == 0) return count;
    next_face = peer->visited[peer->stack[depth]];
  }
}

cellist_result peer_sort_mpvo_nc(cellist_peer *peer, const sort_eye *eye, uint32_t *order) {
  const float at[4] = {(float)eye->at[0], (float)eye->at[1], (float)eye->at[2], eye->parallel ? 0 : 1};
  memset(peer->visited, 0, peer->mesh.tet_count);
  const size_t boundary_count = peer_fill_items(peer, eye, true);
  const peer_item *sorted = peer_radix_sort(peer->items, boundary_count);
  size_t count = 0;
  for (size_t i = 0; i < boundary_count; i++)
    if (peer->visited[sorted[i].tet] == 0) count = search(peer, at, sorted[i].tet, order, count);
  for (uint32_t i = 0; i < peer->mesh.tet_count; i++) /* what no boundary cell lies in front of */
    if (peer->visited[i] == 0) count = search(peer, at, i, order, count);
  return CELLIST_SUCCESS;
}
