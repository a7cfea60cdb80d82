/* SPDX-License-Identifier: BSD-3-Clause
 * Sorter: what a caller meets. Checks what is given, keeps what views share, and runs one view's stages. */
#include "sorter.h"

#include <math.h>
#include <string.h>

#include "components.h"
#include "convexity.h"
#include "faces.h"
#include "mpvo.h"

enum { TET_LIMIT = 1 << 30 }; /* 4 tet + corner must fit 32 bits, CELLIST_NONE apart */

static cellist_result check_tet(cellist_context *context, const cellist_sorter_desc *mesh, uint32_t tet) {
  const uint32_t *v = &mesh->tets[4 * (size_t)tet];
  const double *p[4];
  for (int k = 0; k < 4; k++) {
    if (v[k] >= mesh->point_count)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "tet %u uses point %u of %zu", tet, v[k],
                          mesh->point_count);
    p[k] = &mesh->points[3 * (size_t)v[k]];
    if (!isfinite(p[k][0]) || !isfinite(p[k][1]) || !isfinite(p[k][2]))
      return cellist_fail(context, CELLIST_ERROR_GEOMETRY, "tet %u uses point %u at (%g, %g, %g)", tet, v[k], p[k][0],
                          p[k][1], p[k][2]);
  }
  if (cellist_orient3d(p[0], p[1], p[2], p[3]) < 0)
    return cellist_fail(context, CELLIST_ERROR_GEOMETRY, "tet %u has a negative volume", tet);
  return CELLIST_SUCCESS;
}

/* The face that they share turns one way seen from outside the one and the other way seen from outside the other. */
static bool are_on_two_sides(const cellist_sorter_desc *mesh, uint32_t tet, uint32_t k, uint32_t other, uint32_t back) {
  const uint32_t *v = &mesh->tets[4 * (size_t)tet], *w = &mesh->tets[4 * (size_t)other];
  uint32_t at = 0;
  while (at < 2 && w[SORT_TET_FACE[back][at]] != v[SORT_TET_FACE[k][0]]) at++;
  return w[SORT_TET_FACE[back][(at + 2) % 3]] == v[SORT_TET_FACE[k][1]];
}

static cellist_result check_neighbours(cellist_context *context, const cellist_sorter_desc *mesh, uint32_t tet) {
  for (uint32_t k = 0; k < 4; k++) {
    const uint32_t other = mesh->neighbours[4 * (size_t)tet + k];
    if (other == CELLIST_NONE) continue;
    if (other >= mesh->tet_count || other == tet)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "tet %u has tet %u of %zu as its neighbour", tet,
                          other, mesh->tet_count);
    const uint32_t back = sort_opposite_corner(mesh, tet, k, other);
    if (back == 4 || mesh->neighbours[4 * (size_t)other + back] != tet)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "tet %u has tet %u as its neighbour across a face that tet %u does not know", tet, other,
                          other);
    if (!are_on_two_sides(mesh, tet, k, other, back))
      return cellist_fail(context, CELLIST_ERROR_GEOMETRY, "tets %u and %u are neighbours on the same side of a face",
                          tet, other);
  }
  return CELLIST_SUCCESS;
}

static cellist_result check_mesh(cellist_context *context, const cellist_sorter_desc *mesh) {
  if (mesh->tet_count >= TET_LIMIT)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%zu tets are more than 32-bit ids allow", mesh->tet_count);
  if (mesh->tet_count > 0 && (mesh->points == NULL || mesh->tets == NULL || mesh->neighbours == NULL))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_sorter_create: an array is NULL");
  cellist_result result = CELLIST_SUCCESS;
  for (uint32_t i = 0; i < mesh->tet_count && result == CELLIST_SUCCESS; i++) result = check_tet(context, mesh, i);
  for (uint32_t i = 0; i < mesh->tet_count && result == CELLIST_SUCCESS; i++)
    result = check_neighbours(context, mesh, i);
  return result;
}

/* What orders cells across gaps, unless there are none. */
static cellist_result prepare_gaps(cellist_sorter *sorter) {
  cellist_context *context = sorter->context;
  if (sorter->convex) return CELLIST_SUCCESS;
  cellist_sorter_desc mesh = sorter->mesh;
  cellist_result result = CELLIST_SUCCESS;
  sorter->has_complex = mesh.complex != NULL;
  if (sorter->has_complex) {
    result = sort_complex_create(context, &mesh, sorter->subset.cut, &sorter->complex, &sorter->cells);
    if (result != CELLIST_SUCCESS) return result;
    sorter->queue = cellist_allocate(context, sorter->cells.count, sizeof *sorter->queue);
    if (sorter->queue == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    if (sorter->complex.exposed != NULL) mesh.neighbours = sorter->complex.exposed;
  }
  uint32_t *closed = NULL;
  if (sorter->subset.ids != NULL) {
    closed = cellist_allocate(context, mesh.tet_count, 4 * sizeof *closed);
    if (closed == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    memcpy(closed, mesh.neighbours, mesh.tet_count * 4 * sizeof *closed);
    sort_subset_close_cuts(&sorter->subset, closed);
    mesh.neighbours = closed;
  }
  result = sort_gaps_create(context, &mesh, &sorter->gaps);
  cellist_deallocate(context, closed);
  return result;
}

static cellist_result prepare(cellist_sorter *sorter, const uint8_t *wanted) {
  cellist_context *context = sorter->context;
  cellist_result result = check_mesh(context, &sorter->mesh);
  if (result == CELLIST_SUCCESS) result = sort_is_convex(context, &sorter->mesh, &sorter->convex);
  if (result == CELLIST_SUCCESS && wanted != NULL)
    result = sort_subset_create(context, wanted, &sorter->mesh, &sorter->subset);
  sorter->cells = sort_cells_of_mesh(&sorter->mesh);
  if (result == CELLIST_SUCCESS) result = prepare_gaps(sorter);
  if (result == CELLIST_SUCCESS) result = sort_components_prepare(sorter);
  if (result == CELLIST_SUCCESS) result = sort_planes_create(context, &sorter->cells, &sorter->planes);
  if (result != CELLIST_SUCCESS) return result;
  sorter->mesh.complex = NULL;
  sorter->uses_ends = sorter->convex && sorter->cells.count >= SORT_ENDS_MINIMUM;
  if (sorter->uses_ends) result = sort_ends_create(context, &sorter->cells, &sorter->ends);
  if (result != CELLIST_SUCCESS) return result;
  sorter->state = cellist_allocate_zeroed(context, 4 * sorter->planes.group_count + 8, sizeof *sorter->state);
  return sorter->state != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

static cellist_result create(cellist_context *context, const cellist_sorter_desc *desc, const uint8_t *wanted,
                             cellist_sorter **sorter) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (desc == NULL || sorter == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_sorter_create: desc or sorter is NULL");
  cellist_sorter *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->given = created->mesh = *desc;
  created->given.complex = NULL;
  const cellist_result result = prepare(created, wanted);
  if (result == CELLIST_SUCCESS)
    *sorter = created;
  else
    cellist_sorter_destroy(created);
  return result;
}

cellist_result cellist_sorter_create(cellist_context *context, const cellist_sorter_desc *desc,
                                     cellist_sorter **sorter) {
  return create(context, desc, NULL, sorter);
}

cellist_result cellist_sorter_create_subset(cellist_context *context, const cellist_sorter_desc *desc,
                                            const uint8_t *wanted, cellist_sorter **sorter) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (wanted == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_sorter_create_subset: wanted is NULL");
  return create(context, desc, wanted, sorter);
}

size_t cellist_sorter_order_size(const cellist_sorter *sorter) {
  return sorter->subset.ids != NULL ? sorter->subset.wanted_count : sorter->mesh.tet_count;
}

void cellist_sorter_destroy(cellist_sorter *sorter) {
  if (sorter == NULL) return;
  cellist_context *context = sorter->context;
  sort_gaps_release(context, &sorter->gaps);
  sort_planes_release(context, &sorter->planes);
  sort_ends_release(context, &sorter->ends);
  cellist_deallocate(context, sorter->state);
  sort_complex_release(context, &sorter->complex);
  sort_subset_release(context, &sorter->subset);
  cellist_deallocate(context, sorter->queue);
  cellist_deallocate(context, sorter->groups);
  cellist_deallocate(context, sorter->parts);
  cellist_deallocate(context, sorter->scratch);
  cellist_deallocate(context, sorter);
}

bool cellist_sorter_is_convex(const cellist_sorter *sorter) { return sorter->convex; }

/* The queue's tets, without the imaginary cells among them. */
static size_t take_tets(const cellist_sorter *sorter, size_t queued, uint32_t *order) {
  const uint32_t *queue = sorter->queue;
  const size_t tet_count = sorter->mesh.tet_count;
  size_t count = 0, i = 0;
  for (; i < queued && count < tet_count; i++) {
    order[count] = queue[i];
    count += queue[i] < tet_count;
  }
  return count;
}

cellist_result cellist_sorter_sort(cellist_sorter *sorter, const cellist_viewpoint *viewpoint, uint32_t *order,
                                   cellist_sort_stats *stats) {
  if (sorter == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (viewpoint == NULL || (order == NULL && cellist_sorter_order_size(sorter) > 0))
    return cellist_fail(sorter->context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_sorter_sort: NULL");
  const double *at = viewpoint->position;
  if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]))
    return cellist_fail(sorter->context, CELLIST_ERROR_INVALID_ARGUMENT, "a viewpoint at (%g, %g, %g)", at[0], at[1],
                        at[2]);
  if (viewpoint->parallel && at[0] == 0 && at[1] == 0 && at[2] == 0)
    return cellist_fail(sorter->context, CELLIST_ERROR_INVALID_ARGUMENT, "a parallel view without a direction");
  const sort_eye eye = sort_eye_of(viewpoint);
  uint32_t *wanted_order = order;
  if (sorter->subset.ids != NULL) order = sorter->subset.order;
  cellist_sort_stats found = {.exact = true,
                              .sorted_tet_count = sorter->mesh.tet_count,
                              .imaginary_cell_count = sorter->complex.imaginary_count,
                              .link_count = sorter->complex.links.facet_count};
  sorter->group_count = 0;
  sorter->is_current = false;
  if (sorter->uses_ends) sort_ends_choose(&sorter->ends, &eye);
  found.exact_sign_count = sort_planes_find_states(sorter->context, &sorter->cells, &sorter->planes, &eye,
                                                   sorter->state, sorter->uses_ends ? &sorter->ends : NULL);
  cellist_result result = CELLIST_SUCCESS;
  sorter->uses_gap_arcs = !sorter->convex && !sorter->has_complex;
  if (sorter->uses_gap_arcs) {
    result = sort_gaps_find(sorter->context, &sorter->gaps, &eye);
    if (result != CELLIST_SUCCESS) return result;
    found.gap_arc_count = sorter->gaps.arc_count;
    found.gap_candidate_count = sorter->gaps.candidate_count;
  }
  sort_links_find(&sorter->complex.links, &eye);
  size_t done = sort_topologically(sorter, sorter->queue != NULL ? sorter->queue : order);
  if (sorter->queue != NULL) done = take_tets(sorter, done, order);
  if (done < sorter->mesh.tet_count) result = sort_components(sorter, &eye, order, done, &found);
  if (result != CELLIST_SUCCESS) {
    sorter->group_count = 0;
    return result;
  }
  if (sorter->subset.ids != NULL)
    sorter->group_count = sort_subset_take(&sorter->subset, wanted_order, sorter->groups, sorter->group_count);
  sorter->is_current = true;
  sorter->viewpoint = *viewpoint;
  found.group_count = sorter->group_count;
  for (size_t i = 0; i < sorter->group_count; i++) {
    const size_t count = sorter->groups[i].count;
    found.cells_in_groups += count;
    if (count > found.largest_group) found.largest_group = count;
  }
  if (stats != NULL) *stats = found;
  return CELLIST_SUCCESS;
}

bool cellist_sorter_is_current(const cellist_sorter *sorter, const cellist_viewpoint *viewpoint) {
  const cellist_viewpoint *last = &sorter->viewpoint;
  return sorter->is_current && last->parallel == viewpoint->parallel && last->position[0] == viewpoint->position[0] &&
         last->position[1] == viewpoint->position[1] && last->position[2] == viewpoint->position[2];
}

void cellist_sorter_forget(cellist_sorter *sorter) { sorter->is_current = false; }

void cellist_sorter_groups(const cellist_sorter *sorter, const cellist_group **groups, size_t *count) {
  *groups = sorter->groups;
  *count = sorter->group_count;
}
