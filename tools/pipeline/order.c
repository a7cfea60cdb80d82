/* SPDX-License-Identifier: BSD-3-Clause
 * Order: the pipeline's sorter and the order of the frame that is drawn. */
#include <string.h>

#include "pipeline.h"

/* A part of the mesh is cut out anew for each transfer function, and only where its gaps are cheap to sort: unless told
 * otherwise it gets no exterior. */
static cellist_result make_sorter(cellist_pipeline *pipeline) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->drawn);
  const cellist_sorter_desc mesh = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  if (pipeline->desc.sorting == CELLIST_SORTING_CENTROID)
    return cellist_peer_create(pipeline->context, &mesh, "centroid", &pipeline->peer);
  cellist_order_desc desc = pipeline->desc.order;
  desc.wanted = pipeline->visible;
  if (desc.pictures == 0) desc.pictures = pipeline->desc.frames;
  if (pipeline->part != NULL && desc.exterior == CELLIST_ORDER_AUTO && !desc.needs_complex)
    desc.exterior = CELLIST_ORDER_NONE;
  const cellist_result result = cellist_order_create(pipeline->context, pipeline->drawn, &desc, &pipeline->sorted);
  if (result == CELLIST_SUCCESS) pipeline->sorter = cellist_order_sorter(pipeline->sorted);
  return result;
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

static void note_exterior(const cellist_pipeline *pipeline, cellist_pipeline_stats *stats) {
  const cellist_order_facts *facts = cellist_order_get_facts(pipeline->sorted);
  stats->exterior = facts->exterior;
  stats->exterior_reason = facts->reason;
  stats->imaginary_cells = facts->imaginary_cells;
  stats->convexify_seconds = facts->seconds;
  if (facts->imaginary_cells == 0) pipeline_leave_out(stats, "exterior", "%s", facts->reason);
}

/* Fills order and groups. If that fails, the order that stood there is lost. */
static cellist_result sort_anew(cellist_pipeline *pipeline, const cellist_viewpoint *viewpoint) {
  pipeline->sort_stats = (cellist_sort_stats){0};
  cellist_result result = CELLIST_SUCCESS;
  if (pipeline->peer != NULL)
    result = cellist_peer_sort(pipeline->peer, viewpoint, pipeline->order);
  else
    result = cellist_sorter_sort(pipeline->sorter, viewpoint, pipeline->order, &pipeline->sort_stats);
  if (result == CELLIST_SUCCESS && pipeline->peer == NULL) result = keep_groups(pipeline);
  if (result != CELLIST_SUCCESS) {
    cellist_pipeline_forget_order(pipeline);
    return result;
  }
  if (pipeline->peer == NULL) { /* the sorter leaves invisible tets out itself */
    pipeline->order_count = cellist_sorter_order_size(pipeline->sorter);
    return CELLIST_SUCCESS;
  }
  pipeline->order_count = cellist_mesh_get_arrays(pipeline->drawn)->tet_count;
  pipeline_filter_order(pipeline);
  return CELLIST_SUCCESS;
}

cellist_result pipeline_sort(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_pipeline_stats *stats) {
  const char *order_free = pipeline_order_free(pipeline);
  stats->order = "none";
  if (order_free != NULL) {
    pipeline_leave_out(stats, "exterior", "%s", order_free);
    pipeline_leave_out(stats, "sort", "%s", order_free);
    return CELLIST_SUCCESS;
  }
  if (pipeline->desc.sorting == CELLIST_SORTING_NONE) {
    stats->order = "approximate";
    return CELLIST_SUCCESS;
  }
  if (pipeline->sorted != NULL) note_exterior(pipeline, stats);
  cellist_viewpoint viewpoint = {.parallel = frame->parallel};
  memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
  if (pipeline->sorter != NULL && !pipeline->desc.no_plan && cellist_sorter_is_current(pipeline->sorter, &viewpoint)) {
    pipeline_leave_out(stats, "sort (same eye)", "the order depends on the eye's place alone");
  } else {
    const double begin = clock_seconds();
    const cellist_result result = sort_anew(pipeline, &viewpoint);
    if (result != CELLIST_SUCCESS) return result;
    stats->sort_seconds = clock_seconds() - begin;
  }
  stats->order = pipeline->sort_stats.exact ? "exact" : "approximate";
  stats->group_count = pipeline->sort_stats.group_count;
  stats->cells_in_groups = pipeline->sort_stats.cells_in_groups;
  return CELLIST_SUCCESS;
}

void cellist_pipeline_forget_order(cellist_pipeline *pipeline) {
  if (pipeline != NULL && pipeline->sorter != NULL) cellist_sorter_forget(pipeline->sorter);
}
