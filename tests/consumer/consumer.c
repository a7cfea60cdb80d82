/* SPDX-License-Identifier: BSD-3-Clause
 * A program in C alone that uses what a component offers; the build says which. */
#include <cellist/context.h>
#include <stdio.h>

#ifdef USE_SORT
#include <cellist/sort.h>
#endif
#ifdef USE_CELLIST
#include <cellist/pipeline.h>
#endif

int main(void) {
  cellist_context *context = NULL;
  if (cellist_context_create(NULL, &context) != CELLIST_SUCCESS) return 1;
  cellist_result result = CELLIST_SUCCESS;
#ifdef USE_SORT
  const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
  const uint32_t tets[] = {0, 1, 2, 3, 1, 2, 3, 4};
  const uint32_t neighbours[] = {1, CELLIST_NONE, CELLIST_NONE, CELLIST_NONE, CELLIST_NONE, CELLIST_NONE, CELLIST_NONE,
                                 0};
  cellist_sorter *sorter = NULL;
  const cellist_sorter_desc desc = {
      .point_count = 5, .points = points, .tet_count = 2, .tets = tets, .neighbours = neighbours};
  result = cellist_sorter_create(context, &desc, &sorter);
  if (result == CELLIST_SUCCESS) printf("a sorter of 2 cells\n");
  cellist_sorter_destroy(sorter);
#endif
#ifdef USE_CELLIST
  cellist_mesh *mesh = NULL;
  result = cellist_pipeline_load(context, "sample:grid", NULL, &mesh);
  if (result == CELLIST_SUCCESS) printf("%zu tets\n", cellist_mesh_get_arrays(mesh)->tet_count);
  cellist_mesh_destroy(mesh);
#endif
  if (result != CELLIST_SUCCESS) printf("%s\n", cellist_context_take_error(context));
  cellist_context_destroy(context);
  return result != CELLIST_SUCCESS;
}
