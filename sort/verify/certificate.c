/* SPDX-License-Identifier: BSD-3-Clause
 * Certificate: permutation, groups, and the exact side of the eye at every shared face; linear time. It does not see
 * cells that only a gap separates: rays do (rays.c). */
#include <cellist/sort_verify.h>

#include "../view.h"
#include "ranks.h"

cellist_result sort_ranks(cellist_context *context, size_t tet_count, const uint32_t *order,
                          const cellist_group *groups, size_t group_count, uint32_t *ranks) {
  for (size_t i = 0; i < tet_count; i++) ranks[i] = CELLIST_NONE;
  for (size_t i = 0; i < tet_count; i++) {
    if (order[i] >= tet_count || ranks[order[i]] != CELLIST_NONE)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "order[%zu] is %u, which is %s", i, order[i],
                          order[i] >= tet_count ? "no tet" : "there already");
    ranks[order[i]] = (uint32_t)i;
  }
  size_t end = 0;
  for (size_t g = 0; g < group_count; g++) {
    const size_t begin = groups[g].begin, count = groups[g].count;
    if (begin < end || count > tet_count || begin > tet_count - count)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "group %zu (%zu cells from place %zu) is out of range or order", g, count, begin);
    for (size_t i = begin; i < begin + count; i++) ranks[order[i]] = (uint32_t)begin;
    end = begin + count;
  }
  return CELLIST_SUCCESS;
}

cellist_result cellist_order_certify(cellist_context *context, const cellist_sorter_desc *mesh,
                                     const cellist_viewpoint *viewpoint, const uint32_t *order,
                                     const cellist_group *groups, size_t group_count, cellist_certificate *found) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || viewpoint == NULL || found == NULL || (order == NULL && mesh->tet_count > 0) ||
      (groups == NULL && group_count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_order_certify: NULL");
  uint32_t *ranks = cellist_allocate(context, mesh->tet_count, sizeof *ranks);
  if (ranks == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  const cellist_result result = sort_ranks(context, mesh->tet_count, order, groups, group_count, ranks);
  cellist_certificate certificate = {0};
  const sort_eye eye = sort_eye_of(viewpoint);
  for (uint32_t tet = 0; tet < mesh->tet_count && result == CELLIST_SUCCESS; tet++) {
    for (size_t k = 0; k < 4; k++) {
      const uint32_t other = mesh->neighbours[4 * (size_t)tet + k];
      if (other == CELLIST_NONE || other < tet) continue;
      const double *p[3];
      for (size_t c = 0; c < 3; c++)
        p[c] = &mesh->points[3 * (size_t)mesh->tets[4 * (size_t)tet + SORT_TET_FACE[k][c]]];
      const int side = sort_eye_side(&eye, p[0], p[1], p[2]);
      if (side == 0) continue;
      certificate.group_faces += ranks[tet] == ranks[other];
      certificate.faces += ranks[tet] != ranks[other];
      certificate.violations += side > 0 ? ranks[tet] > ranks[other] : ranks[tet] < ranks[other];
    }
  }
  cellist_deallocate(context, ranks);
  if (result == CELLIST_SUCCESS) *found = certificate;
  return result;
}
