/* SPDX-License-Identifier: BSD-3-Clause
 * Plan: what a scene does not need is left out, and said why (algorithms of the field: empty-space skipping, order
 * independence of commuting optics). Made once a pipeline, from counts and committed constants, so that results repeat.
 *
 * Invisible cells are left out in one of two ways. Where the visible ones are cheap to draw as a mesh of their own,
 * they become one: nothing else is walked, sorted or transformed. Where cutting them out would leave a surface so
 * ragged that its gaps cost more than the cells saved, only the cells that lie among the
 * visible ones are sorted, and the order holds the visible ones. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "costs.h"
#include "pipeline.h"

/* Cost of a boundary face, in tets. A sort looks at pairs of boundary faces across gaps: 0.7 to 1.2 us a face against
 * some 10 ns a tet (spx, sci_torso, impeller). A ray that enters costs as much as crossing four tets, and a ray meets
 * half as many faces of a boundary as of a tet. Other values change speed, never a picture. */
static const double SORT_FACE_COST = 100, CAST_FACE_COST = 2;

void pipeline_leave_out(cellist_pipeline_stats *stats, const char *what, const char *why, ...) {
  if (stats->left_out_count == CELLIST_LEFT_OUT_LIMIT) return;
  cellist_left_out *entry = &stats->left_out[stats->left_out_count++];
  entry->what = what;
  va_list arguments;
  va_start(arguments, why);
  vsnprintf(entry->why, sizeof entry->why, why, arguments);
  va_end(arguments);
}

/* One colour wherever there is extinction: C = c (1 - product of transmittances). */
static bool has_one_colour(const cellist_transfer *transfer) {
  for (size_t i = 1; i < transfer->knot_count; i++)
    if (memcmp(transfer->knots[i].colour, transfer->knots[0].colour, sizeof transfer->knots[0].colour) != 0)
      return false;
  return true;
}

const char *pipeline_order_free(const cellist_pipeline *pipeline) {
  const cellist_optics *model = &pipeline->desc.optics.model;
  if (pipeline->desc.no_plan) return NULL;
  switch (model->model) {
    case CELLIST_MODEL_ABSORPTION: return "absorption alone commutes";
    case CELLIST_MODEL_EMISSION: return "emission alone commutes";
    case CELLIST_MODEL_MAXIMUM: return "a maximum needs no order";
    case CELLIST_MODEL_EMISSION_ABSORPTION:
      return !model->light.enabled && has_one_colour(&pipeline->transfer)
                 ? "emission and absorption of one colour commute"
                 : NULL;
    default: return NULL;
  }
}

size_t plan_count_boundary(const cellist_mesh_arrays *mesh, const uint8_t *keep) {
  size_t count = 0;
  for (size_t i = 0; i < mesh->tet_count; i++)
    for (size_t k = 0; k < 4 && keep[i]; k++) {
      const uint32_t other = mesh->neighbours[4 * i + k];
      count += other == CELLIST_NONE || !keep[other];
    }
  return count;
}

static bool is_part_cheaper(const cellist_pipeline *pipeline, const uint8_t *keep, size_t kept) {
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(pipeline->mesh);
  const double whole_faces = (double)cellist_mesh_get_facts(pipeline->mesh)->boundary_face_count;
  const double part = (double)kept, part_faces = (double)plan_count_boundary(mesh, keep),
               whole = (double)mesh->tet_count;
  if (pipeline->renderer == CELLIST_RENDERER_CAST)
    return part + CAST_FACE_COST * part_faces < whole + CAST_FACE_COST * whole_faces;
  /* The whole may turn out convex, so only tets count on its side. */
  return pipeline_order_free(pipeline) != NULL || part + SORT_FACE_COST * part_faces < whole;
}

static cellist_result make_part(cellist_pipeline *pipeline, const uint8_t *keep) {
  cellist_context *context = pipeline->context;
  const cellist_scalar *whole = &pipeline->scalar;
  cellist_scalar *part = &pipeline->part_scalar;
  uint32_t *points = NULL, *tets = NULL;
  const cellist_result result = cellist_mesh_extract(context, pipeline->mesh, keep, &pipeline->part, &points, &tets);
  if (result != CELLIST_SUCCESS) return result;
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->part);
  *part = *whole;
  part->nan_cell_count = 0; /* such cells are not in the part */
  part->count = whole->association == CELLIST_ON_POINTS ? arrays->point_count : arrays->tet_count;
  part->name = cellist_allocate(context, strlen(whole->name) + 1, 1);
  part->values = cellist_allocate(context, part->count, sizeof *part->values);
  if (part->name != NULL && part->values != NULL) {
    const uint32_t *ids = whole->association == CELLIST_ON_POINTS ? points : tets;
    memcpy(part->name, whole->name, strlen(whole->name) + 1);
    for (size_t i = 0; i < part->count; i++) part->values[i] = whole->values[ids[i]];
    pipeline->drawn = pipeline->part;
    pipeline->drawn_scalar = part;
  }
  cellist_deallocate(context, points);
  cellist_deallocate(context, tets);
  return pipeline->drawn_scalar == part ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

/* Lit by gradients at points: these come from all tets around a point, so the part must have them too. */
static bool needs_ring(const cellist_pipeline *pipeline) {
  const cellist_light *light = &pipeline->desc.optics.model.light;
  return light->enabled && !light->cell_gradients && pipeline->scalar.association == CELLIST_ON_POINTS;
}

cellist_result pipeline_look(cellist_pipeline *pipeline) {
  const size_t tet_count = cellist_mesh_get_arrays(pipeline->mesh)->tet_count;
  pipeline->visible_count = pipeline->kept_count = tet_count;
  if (pipeline->desc.no_plan || tet_count == 0) return CELLIST_SUCCESS;
  pipeline->visible = cellist_allocate(pipeline->context, tet_count, 1);
  if (pipeline->visible == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = pipeline_find_visible(pipeline, pipeline->visible, &pipeline->visible_count);
  pipeline->kept_count = pipeline->visible_count;
  if (result == CELLIST_SUCCESS && needs_ring(pipeline))
    result = pipeline_grow_visible(pipeline, pipeline->visible, &pipeline->kept_count);
  return result;
}

cellist_result pipeline_plan(cellist_pipeline *pipeline) {
  const size_t tet_count = cellist_mesh_get_arrays(pipeline->mesh)->tet_count, kept = pipeline->kept_count;
  pipeline->drawn = pipeline->mesh;
  pipeline->drawn_scalar = &pipeline->scalar;
  cellist_result result = CELLIST_SUCCESS;
  if (kept < tet_count && is_part_cheaper(pipeline, pipeline->visible, kept))
    result = make_part(pipeline, pipeline->visible);
  else if (kept < tet_count && pipeline->renderer != CELLIST_RENDERER_CAST)
    return CELLIST_SUCCESS; /* they are taken out of the order */
  cellist_deallocate(pipeline->context, pipeline->visible);
  pipeline->visible = NULL;
  return result;
}

void pipeline_filter_order(cellist_pipeline *pipeline) {
  if (pipeline->visible == NULL) return;
  cellist_group *groups = pipeline->groups;
  size_t count = 0, kept = 0, group = 0, begin = 0;
  for (size_t i = 0; i < pipeline->order_count; i++) {
    if (group < pipeline->group_count && i == groups[group].begin) begin = count;
    if (pipeline->visible[pipeline->order[i]]) pipeline->order[count++] = pipeline->order[i];
    if (group == pipeline->group_count || i + 1 < groups[group].begin + groups[group].count) continue;
    group++;
    if (count > begin + 1) groups[kept++] = (cellist_group){begin, count - begin};
  }
  pipeline->order_count = count;
  pipeline->group_count = kept;
}

void pipeline_note_plan(const cellist_pipeline *pipeline, cellist_pipeline_stats *stats) {
  const size_t tet_count = cellist_mesh_get_arrays(pipeline->mesh)->tet_count;
  stats->visible_cells = pipeline->visible_count;
  if (pipeline->drawn != pipeline->mesh || pipeline->visible != NULL)
    pipeline_leave_out(stats, "invisible cells", "%zu of %zu can show nothing%s", tet_count - pipeline->visible_count,
                       tet_count, pipeline->visible != NULL ? "; sorted only where they lie among the others" : "");
  if (pipeline->desc.no_plan) return;
  if (!pipeline->desc.optics.model.light.enabled) pipeline_leave_out(stats, "light", "no light in the scene");
  if (strcmp(stats->order, "exact") == 0 && stats->group_count == 0)
    pipeline_leave_out(stats, "groups", "no cells lie in front of each other in a circle");
}
