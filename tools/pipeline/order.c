/* SPDX-License-Identifier: BSD-3-Clause
 * Order: the pipeline's sorter and the order of the frame that is drawn. */
#include <string.h>

#include "pipeline.h"

static cellist_result make_sorter(cellist_pipeline *pipeline) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->drawn);
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  if (pipeline->desc.sorting == CELLIST_SORTING_CENTROID)
    return cellist_peer_create(pipeline->context, &desc, "centroid", &pipeline->peer);
  return cellist_sorter_create(pipeline->context, &desc, &pipeline->sorter);
}

cellist_result pipeline_make_order(cellist_pipeline *pipeline) {
  const size_t tet_count = cellist_mesh_get_arrays(pipeline->drawn)->tet_count;
  pipeline->order = cellist_allocate(pipeline->context, tet_count, sizeof *pipeline->order);
  if (pipeline->order == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (pipeline_order_free(pipeline) == NULL && pipeline->desc.sorting != CELLIST_SORTING_NONE)
    return make_sorter(pipeline);
  pipeline->order_count = tet_count;
  for (uint32_t i = 0; i < tet_count; i++) pipeline->order[i] = i;
  pipeline_filter_order(pipeline);
  return CELLIST_SUCCESS;
}

static cellist_result keep_groups(cellist_pipeline *pipeline) {
  const cellist_group *groups = NULL;
  size_t count = 0;
  cellist_sorter_groups(pipeline->sorter, &groups, &count);
  if (count > pipeline->group_capacity) {
    cellist_group *grown = cellist_allocate(pipeline->context, count, sizeof *grown);
    if (grown == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    cellist_deallocate(pipeline->context, pipeline->groups);
    pipeline->groups = grown;
    pipeline->group_capacity = count;
  }
  if (count > 0) memcpy(pipeline->groups, groups, count * sizeof *groups);
  pipeline->group_count = count;
  return CELLIST_SUCCESS;
}

cellist_result pipeline_sort(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_pipeline_stats *stats) {
  const char *order_free = pipeline_order_free(pipeline);
  stats->order = "none";
  if (order_free != NULL) {
    pipeline_leave_out(stats, "sort", "%s", order_free);
    return CELLIST_SUCCESS;
  }
  if (pipeline->desc.sorting == CELLIST_SORTING_NONE) {
    stats->order = "approximate";
    return CELLIST_SUCCESS;
  }
  cellist_viewpoint viewpoint = {.parallel = frame->parallel};
  memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
  cellist_sort_stats sorted = {.exact = false};
  const double begin = pipeline_seconds();
  cellist_result result = pipeline->peer != NULL
                              ? cellist_peer_sort(pipeline->peer, &viewpoint, pipeline->order)
                              : cellist_sorter_sort(pipeline->sorter, &viewpoint, pipeline->order, &sorted);
  if (result == CELLIST_SUCCESS && pipeline->peer == NULL) result = keep_groups(pipeline);
  if (result != CELLIST_SUCCESS) return result;
  pipeline->order_count = cellist_mesh_get_arrays(pipeline->drawn)->tet_count;
  pipeline_filter_order(pipeline);
  stats->sort_seconds = pipeline_seconds() - begin;
  stats->order = sorted.exact ? "exact" : "approximate";
  stats->group_count = sorted.group_count;
  stats->cells_in_groups = sorted.cells_in_groups;
  return CELLIST_SUCCESS;
}
