/* SPDX-License-Identifier: BSD-3-Clause
 * Convexity: a connected closed surface that bends outwards at each of its edges bounds a convex body (Tietze and
 * Nakajima; van Heijenoort 1952). So walk over the boundary faces from one of them; at each edge turn through the
 * cells around it to the next boundary face, and look whether that face's far corner lies in or below this face's
 * plane. If no edge is reflex and all boundary faces were reached, the mesh is convex. */
#include "convexity.h"

#include "faces.h"
#include "view.h"

/* The boundary face (4 tet + corner) next to one across its edge opposite to corner j of the tet, and in *far the
 * corner of it that is not on the edge. */
static uint32_t next_boundary_face(const cellist_sorter_desc *mesh, uint32_t face, uint32_t j, uint32_t *far) {
  uint32_t tet = face / 4, out = face % 4, in = j;
  for (;;) {
    /* The edge is the tet's two corners other than `out` and `in`; leave through the face opposite to `in`. */
    const uint32_t next = mesh->neighbours[4 * (size_t)tet + in];
    const uint32_t *v = &mesh->tets[4 * (size_t)tet];
    if (next == CELLIST_NONE) {
      *far = v[out];
      return 4 * tet + in;
    }
    /* In the next cell the corner across which it was entered becomes `out`; the shared corner off the edge, `in`. */
    const uint32_t shared = v[out];
    const uint32_t entered = sort_opposite_corner(mesh, tet, in, next);
    in = 0;
    while (mesh->tets[4 * (size_t)next + in] != shared) in++;
    out = entered;
    tet = next;
  }
}

cellist_result sort_is_convex(cellist_context *context, const cellist_sorter_desc *mesh, bool *convex) {
  *convex = true;
  size_t boundary_count = 0;
  uint32_t first = CELLIST_NONE;
  for (size_t i = 0; i < 4 * mesh->tet_count; i++) {
    if (mesh->neighbours[i] != CELLIST_NONE) continue;
    if (boundary_count++ == 0) first = (uint32_t)i;
  }
  if (boundary_count == 0) return CELLIST_SUCCESS;
  uint8_t *reached = cellist_allocate_zeroed(context, mesh->tet_count, 1); /* a bit for each face */
  uint32_t *queue = cellist_allocate(context, boundary_count, sizeof *queue);
  if (reached == NULL || queue == NULL) {
    cellist_deallocate(context, reached);
    cellist_deallocate(context, queue);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  size_t count = 1;
  queue[0] = first;
  reached[first / 4] = (uint8_t)(1u << (first % 4));
  for (size_t i = 0; i < count && *convex; i++) {
    const uint32_t face = queue[i];
    const uint32_t *v = &mesh->tets[face & ~3u];
    const uint8_t *corner = SORT_TET_FACE[face % 4];
    const double *p[3];
    for (int k = 0; k < 3; k++) p[k] = &mesh->points[3 * (size_t)v[corner[k]]];
    for (int k = 0; k < 3 && *convex; k++) {
      uint32_t far = 0;
      const uint32_t next = next_boundary_face(mesh, face, corner[k], &far);
      if (cellist_orient3d(p[0], p[1], p[2], &mesh->points[3 * (size_t)far]) > 0) *convex = false;
      const uint8_t bit = (uint8_t)(1u << (next % 4));
      if (reached[next / 4] & bit) continue;
      reached[next / 4] |= bit;
      queue[count++] = next;
    }
  }
  if (count < boundary_count) *convex = false;
  cellist_deallocate(context, reached);
  cellist_deallocate(context, queue);
  return CELLIST_SUCCESS;
}
