/* SPDX-License-Identifier: BSD-3-Clause
 * Order: the pipeline's sorter and the order of the frame that is drawn. */
#include <string.h>

#include "pipeline.h"

cellist_result pipeline_make_sorter(cellist_pipeline *pipeline) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->drawn);
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  const cellist_result result = cellist_sorter_create(pipeline->context, &desc, &pipeline->sorter);
  if (result != CELLIST_SUCCESS) return result;
  pipeline->order = cellist_allocate(pipeline->context, arrays->tet_count, sizeof *pipeline->order);
  return pipeline->order != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

/* Sorts the cells for the frame's eye. */
cellist_result pipeline_sort(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_pipeline_stats *stats) {
  cellist_viewpoint viewpoint = {.parallel = frame->parallel};
  memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
  cellist_sort_stats sorted;
  const double begin = pipeline_seconds();
  const cellist_result result = cellist_sorter_sort(pipeline->sorter, &viewpoint, pipeline->order, &sorted);
  if (result != CELLIST_SUCCESS) return result;
  stats->sort_seconds = pipeline_seconds() - begin;
  stats->order = sorted.exact ? "exact" : "approximate";
  stats->group_count = sorted.group_count;
  stats->cells_in_groups = sorted.cells_in_groups;
  return CELLIST_SUCCESS;
}
