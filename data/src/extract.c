/* SPDX-License-Identifier: BSD-3-Clause
 * Extract: some tets of a mesh as a mesh of their own. What was decided when the mesh was made (orientation, Hilbert
 * order, who is whose neighbour) holds for any part of it, so nothing is decided again: one pass over points and tets.
 */
#include <math.h>
#include <string.h>

#include "mesh_private.h"

/* new_tets[i], new_points[i]: the id in the part, or CELLIST_NONE. */
struct renumbering {
  uint32_t *new_tets, *new_points;
};

static void number_tets(const cellist_mesh_arrays *whole, const uint8_t *keep, struct renumbering *ids,
                        cellist_mesh_arrays *part) {
  for (size_t i = 0; i < whole->point_count; i++) ids->new_points[i] = CELLIST_NONE;
  for (size_t i = 0; i < whole->tet_count; i++) {
    ids->new_tets[i] = keep[i] ? (uint32_t)part->tet_count++ : CELLIST_NONE;
    if (!keep[i]) continue;
    for (size_t k = 0; k < 4; k++) ids->new_points[whole->tets[4 * i + k]] = 0;
  }
  for (size_t i = 0; i < whole->point_count; i++)
    if (ids->new_points[i] == 0) ids->new_points[i] = (uint32_t)part->point_count++;
}

/* The part's arrays, in the order of cellist_mesh_arrays, and the maps back to the whole. */
struct part_arrays {
  double *positions;
  uint32_t *point_origin, *tets, *neighbours, *tet_origin, *points_of_whole, *tets_of_whole;
  uint8_t *tet_flags;
};

static void release_part(cellist_context *context, const struct part_arrays *part) {
  void *const blocks[] = {part->positions,  part->point_origin,    part->tets,          part->neighbours,
                          part->tet_origin, part->points_of_whole, part->tets_of_whole, part->tet_flags};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) cellist_deallocate(context, blocks[i]);
}

static bool allocate_part(cellist_context *context, size_t points, size_t tets, struct part_arrays *part) {
  part->positions = cellist_allocate(context, points, 3 * sizeof *part->positions);
  part->point_origin = cellist_allocate(context, points, sizeof *part->point_origin);
  part->points_of_whole = cellist_allocate(context, points, sizeof *part->points_of_whole);
  part->tets = cellist_allocate(context, tets, 4 * sizeof *part->tets);
  part->neighbours = cellist_allocate(context, tets, 4 * sizeof *part->neighbours);
  part->tet_origin = cellist_allocate(context, tets, sizeof *part->tet_origin);
  part->tets_of_whole = cellist_allocate(context, tets, sizeof *part->tets_of_whole);
  part->tet_flags = cellist_allocate(context, tets, sizeof *part->tet_flags);
  return part->positions != NULL && part->point_origin != NULL && part->points_of_whole != NULL && part->tets != NULL &&
         part->neighbours != NULL && part->tet_origin != NULL && part->tets_of_whole != NULL && part->tet_flags != NULL;
}

static void fill_points(const cellist_mesh_arrays *whole, const struct renumbering *ids, struct part_arrays *part,
                        double bounds[6]) {
  for (int k = 0; k < 3; k++) {
    bounds[k] = HUGE_VAL;
    bounds[3 + k] = -HUGE_VAL;
  }
  for (size_t i = 0; i < whole->point_count; i++) {
    const size_t at = ids->new_points[i];
    if (at == CELLIST_NONE) continue;
    part->point_origin[at] = whole->point_origin[i];
    part->points_of_whole[at] = (uint32_t)i;
    for (size_t k = 0; k < 3; k++) {
      const double x = whole->positions[3 * i + k];
      part->positions[3 * at + k] = x;
      bounds[k] = fmin(bounds[k], x);
      bounds[3 + k] = fmax(bounds[3 + k], x);
    }
  }
}

static void fill_tets(const cellist_mesh_arrays *whole, const struct renumbering *ids, struct part_arrays *part,
                      cellist_mesh_facts *facts) {
  for (size_t i = 0; i < whole->tet_count; i++) {
    const size_t at = ids->new_tets[i];
    if (at == CELLIST_NONE) continue;
    part->tet_origin[at] = whole->tet_origin[i];
    part->tet_flags[at] = whole->tet_flags[i];
    part->tets_of_whole[at] = (uint32_t)i;
    facts->inverted_count += (whole->tet_flags[i] & CELLIST_TET_INVERTED) != 0;
    facts->flat_count += (whole->tet_flags[i] & CELLIST_TET_FLAT) != 0;
    for (size_t k = 0; k < 4; k++) {
      const uint32_t other = whole->neighbours[4 * i + k];
      const uint32_t neighbour = other == CELLIST_NONE ? CELLIST_NONE : ids->new_tets[other];
      part->tets[4 * at + k] = ids->new_points[whole->tets[4 * i + k]];
      part->neighbours[4 * at + k] = neighbour;
      facts->boundary_face_count += neighbour == CELLIST_NONE;
    }
  }
}

static cellist_result extract(cellist_context *context, const cellist_mesh_arrays *whole, const uint8_t *keep,
                              struct renumbering *ids, cellist_mesh *mesh, uint32_t **points, uint32_t **tets) {
  ids->new_tets = cellist_allocate(context, whole->tet_count, sizeof *ids->new_tets);
  ids->new_points = cellist_allocate(context, whole->point_count, sizeof *ids->new_points);
  if (ids->new_tets == NULL || ids->new_points == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_mesh_arrays *arrays = &mesh->arrays;
  number_tets(whole, keep, ids, arrays);
  struct part_arrays part = {0};
  if (!allocate_part(context, arrays->point_count, arrays->tet_count, &part)) {
    release_part(context, &part);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  fill_points(whole, ids, &part, arrays->bounds);
  if (arrays->point_count == 0) memset(arrays->bounds, 0, sizeof arrays->bounds);
  fill_tets(whole, ids, &part, &mesh->facts);
  mesh->facts.file_cell_count = arrays->tet_count;
  arrays->positions = part.positions;
  arrays->point_origin = part.point_origin;
  arrays->tets = part.tets;
  arrays->neighbours = part.neighbours;
  arrays->tet_origin = part.tet_origin;
  arrays->tet_flags = part.tet_flags;
  if (points != NULL)
    *points = part.points_of_whole;
  else
    cellist_deallocate(context, part.points_of_whole);
  if (tets != NULL)
    *tets = part.tets_of_whole;
  else
    cellist_deallocate(context, part.tets_of_whole);
  return CELLIST_SUCCESS;
}

cellist_result cellist_mesh_extract(cellist_context *context, const cellist_mesh *mesh, const uint8_t *keep,
                                    cellist_mesh **part, uint32_t **points, uint32_t **tets) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || part == NULL || (keep == NULL && mesh->arrays.tet_count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_mesh_extract: mesh, keep or part is NULL");
  cellist_mesh *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  struct renumbering ids = {0};
  const cellist_result result = extract(context, &mesh->arrays, keep, &ids, created, points, tets);
  cellist_deallocate(context, ids.new_tets);
  cellist_deallocate(context, ids.new_points);
  if (result == CELLIST_SUCCESS)
    *part = created;
  else
    cellist_mesh_destroy(created);
  return result;
}
