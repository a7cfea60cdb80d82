/* SPDX-License-Identifier: BSD-3-Clause
 * Sorts a user's own arrays (points, cells, neighbours) from far to near, with no other module of Cellist. */
#include <cellist/sort.h>
#include <stdio.h>

/* Two tets that share a face: a corner of a cube, and the one beyond it. */
static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
static const uint32_t tets[] = {0, 1, 2, 3, 1, 2, 3, 4};

int main(void) {
  const uint32_t none = CELLIST_NONE;
  const uint32_t neighbours[] = {1, none, none, none, none, none, none, 0}; /* across the face opposite to corner k */
  const cellist_sorter_desc mesh = {
      .point_count = 5, .points = points, .tet_count = 2, .tets = tets, .neighbours = neighbours};
  const cellist_viewpoint eye = {.position = {3, 3, 3}};
  uint32_t order[2];
  cellist_context *context = NULL;
  cellist_sorter *sorter = NULL;
  cellist_result result = cellist_context_create(NULL, &context);
  if (result == CELLIST_SUCCESS) result = cellist_sorter_create(context, &mesh, &sorter);
  if (result == CELLIST_SUCCESS) result = cellist_sorter_sort(sorter, &eye, order, NULL);
  if (result == CELLIST_SUCCESS) printf("far to near: %u %u\n", order[0], order[1]);
  cellist_sorter_destroy(sorter);
  cellist_context_destroy(context);
  return result == CELLIST_SUCCESS ? 0 : 1;
}
