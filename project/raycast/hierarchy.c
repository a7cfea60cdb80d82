/* SPDX-License-Identifier: BSD-3-Clause
 * Hierarchy: an implicit tree of boxes over the boundary faces in Hilbert order, as linear hierarchies over
 * space-filling curves are (Lauterbach et al. 2009), without codes to sort because the mesh is in order already. */
#include "hierarchy.h"

#include <math.h>
#include <string.h>

static void include_point(hierarchy_box *box, const double p[3]) {
  for (int k = 0; k < 3; k++) {
    box->low[k] = fmin(box->low[k], p[k]);
    box->high[k] = fmax(box->high[k], p[k]);
  }
}

static hierarchy_box empty_box(void) {
  return (hierarchy_box){{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
}

static size_t parents_of(size_t count) { return (count + HIERARCHY_FANOUT - 1) / HIERARCHY_FANOUT; }

/* The box of the leaf that holds the i-th face, ready for this face's points; faces come in order. */
static hierarchy_box *leaf_of(face_hierarchy *hierarchy, size_t i) {
  hierarchy_box *box = &hierarchy->boxes[i / HIERARCHY_FANOUT];
  if (i % HIERARCHY_FANOUT == 0) *box = empty_box();
  return box;
}

static void fill_level(face_hierarchy *hierarchy, int level) {
  const hierarchy_box *child = &hierarchy->boxes[hierarchy->level_begin[level - 1]];
  const size_t count = hierarchy->level_begin[level] - hierarchy->level_begin[level - 1];
  for (size_t i = 0; i < count; i++) {
    hierarchy_box *box = &hierarchy->boxes[hierarchy->level_begin[level] + i / HIERARCHY_FANOUT];
    if (i % HIERARCHY_FANOUT == 0) *box = empty_box();
    include_point(box, child[i].low);
    include_point(box, child[i].high);
  }
}

/* Room for so many faces (at least one), and how many boxes each level has. */
static cellist_result reserve(cellist_context *context, size_t face_count, face_hierarchy *made) {
  *made = (face_hierarchy){.face_count = face_count};
  size_t box_count = 0;
  for (size_t count = parents_of(made->face_count);; count = parents_of(count)) {
    made->level_begin[made->level_count++] = box_count;
    box_count += count;
    if (count == 1) break;
  }
  made->level_begin[made->level_count] = box_count;
  made->faces = cellist_allocate(context, made->face_count, sizeof *made->faces);
  made->boxes = cellist_allocate(context, box_count, sizeof *made->boxes);
  if (made->faces == NULL || made->boxes == NULL) {
    hierarchy_release(context, made);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  return CELLIST_SUCCESS;
}

cellist_result hierarchy_build(cellist_context *context, const cellist_mesh_arrays *mesh, face_hierarchy *made) {
  size_t face_count = 0, at = 0;
  for (size_t f = 0; f < 4 * mesh->tet_count; f++) face_count += mesh->neighbours[f] == CELLIST_NONE;
  *made = (face_hierarchy){0};
  if (face_count == 0) return CELLIST_SUCCESS;
  const cellist_result result = reserve(context, face_count, made);
  if (result != CELLIST_SUCCESS) return result;
  for (size_t f = 0; f < 4 * mesh->tet_count; f++) {
    if (mesh->neighbours[f] != CELLIST_NONE) continue;
    hierarchy_box *box = leaf_of(made, at);
    made->faces[at++] = (uint32_t)f;
    for (int c = 0; c < 3; c++)
      include_point(box, &mesh->positions[3 * (size_t)mesh->tets[f / 4 * 4 + CELLIST_TET_FACE[f % 4][c]]]);
  }
  for (int level = 1; level < made->level_count; level++) fill_level(made, level);
  return CELLIST_SUCCESS;
}

cellist_result hierarchy_build_triangles(cellist_context *context, const double *positions, const uint32_t *triangles,
                                         size_t count, face_hierarchy *made) {
  *made = (face_hierarchy){0};
  if (count == 0) return CELLIST_SUCCESS;
  const cellist_result result = reserve(context, count, made);
  if (result != CELLIST_SUCCESS) return result;
  for (size_t i = 0; i < count; i++) {
    hierarchy_box *box = leaf_of(made, i);
    made->faces[i] = (uint32_t)i;
    for (size_t c = 0; c < 3; c++) include_point(box, &positions[3 * (size_t)triangles[3 * i + c]]);
  }
  for (int level = 1; level < made->level_count; level++) fill_level(made, level);
  return CELLIST_SUCCESS;
}

void hierarchy_release(cellist_context *context, face_hierarchy *hierarchy) {
  cellist_deallocate(context, hierarchy->faces);
  cellist_deallocate(context, hierarchy->boxes);
  memset(hierarchy, 0, sizeof *hierarchy);
}

/* Slabs. Each bound is moved outwards by more than its difference and quotient round: 4 u relative (2 u would do), and
 * the smallest normal number for quotients that underflow. Any less and a ray along an edge of the box may miss it. */
static bool meets_box(const hierarchy_box *box, const double origin[3], const double direction[3]) {
  double enter = -HUGE_VAL, leave = HUGE_VAL;
  for (int k = 0; k < 3; k++) {
    if (direction[k] == 0) {
      if (origin[k] < box->low[k] || origin[k] > box->high[k]) return false;
      continue;
    }
    const double first = (box->low[k] - origin[k]) / direction[k], second = (box->high[k] - origin[k]) / direction[k];
    double near = first < second ? first : second, far = first < second ? second : first;
    near -= fabs(near) * 0x1p-51 + 0x1p-1022;
    far += fabs(far) * 0x1p-51 + 0x1p-1022;
    enter = near > enter ? near : enter;
    leave = far < leave ? far : leave;
  }
  return enter <= leave;
}

bool hierarchy_query(const face_hierarchy *hierarchy, const double origin[3], const double direction[3],
                     hierarchy_visitor visit, void *user) {
  if (hierarchy->level_count == 0) return true;
  struct {
    int level;
    size_t node;
  } stack[HIERARCHY_FANOUT * HIERARCHY_MAX_LEVELS];
  size_t depth = 0;
  stack[depth].level = hierarchy->level_count - 1;
  stack[depth++].node = 0;
  while (depth > 0) {
    const int level = stack[--depth].level;
    const size_t node = stack[depth].node;
    if (!meets_box(&hierarchy->boxes[hierarchy->level_begin[level] + node], origin, direction)) continue;
    const size_t first = node * HIERARCHY_FANOUT;
    const size_t successors =
        level == 0 ? hierarchy->face_count : hierarchy->level_begin[level] - hierarchy->level_begin[level - 1];
    const size_t left = successors - first, count = left < HIERARCHY_FANOUT ? left : HIERARCHY_FANOUT;
    if (level == 0) {
      if (!visit(user, &hierarchy->faces[first], count)) return false;
      continue;
    }
    for (size_t i = 0; i < count; i++) {
      stack[depth].level = level - 1;
      stack[depth++].node = first + i;
    }
  }
  return true;
}
