/* SPDX-License-Identifier: BSD-3-Clause
 * Hierarchy: boxes around the mesh's boundary faces, and which of the faces a line may meet. Private. */
#ifndef CELLIST_RAYCAST_HIERARCHY_H
#define CELLIST_RAYCAST_HIERARCHY_H

#include <cellist/mesh.h>

/* Children of a node, and faces of a leaf. Eight boxes are a few cache lines; 4 and 16 were no faster. */
enum { HIERARCHY_FANOUT = 8, HIERARCHY_MAX_LEVELS = 12 };

typedef struct hierarchy_box {
  double low[3], high[3];
} hierarchy_box;

/* Boundary faces stand in the order of their tets, which is Hilbert order, so neighbours in the list are neighbours in
 * space and no sorting is needed: leaf i holds faces 8i to 8i+7, a node of level l its eight successors of level l-1.
 */
typedef struct face_hierarchy {
  size_t face_count;
  uint32_t *faces;                              /* [face_count] 4 * tet + the corner opposite to the face */
  int level_count;                              /* 0: no face at all */
  size_t level_begin[HIERARCHY_MAX_LEVELS + 1]; /* in boxes; level 0: one box a leaf */
  hierarchy_box *boxes;
} face_hierarchy;

cellist_result hierarchy_build(cellist_context *context, const cellist_mesh_arrays *mesh, face_hierarchy *made);
/* The same over any triangles, [3 count] point ids; neighbours in the list should be neighbours in space. Faces are
 * then numbers of triangles. */
cellist_result hierarchy_build_triangles(cellist_context *context, const double *positions, const uint32_t *triangles,
                                         size_t count, face_hierarchy *made);
void hierarchy_release(cellist_context *context, face_hierarchy *hierarchy);

/* Calls visit for every leaf whose box the whole line may meet; boxes are never missed because of rounding.
 * visit: faces is the leaf's list; returns false to end the search. */
typedef bool (*hierarchy_visitor)(void *user, const uint32_t *faces, size_t count);
bool hierarchy_query(const face_hierarchy *hierarchy, const double origin[3], const double direction[3],
                     hierarchy_visitor visit, void *user);

#endif
