/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients of a scalar on a mesh, for light. */
#ifndef CELLIST_GRADIENTS_H
#define CELLIST_GRADIENTS_H

#include <cellist/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The gradient of the linear function through the corners of each tet.
 * Arrays: gradients[3 tet_count], the caller's, filled, scalar per length of the mesh; 0 for a flat tet, for one whose
 *   scalars are not all finite, and where the scalar is one per cell.
 * Errors: INVALID_ARGUMENT (NULL, a scalar of another mesh). Threads: one call per context at a time; its workers share
 *   the work. Cost: linear in tets. */
CELLIST_API cellist_result cellist_gradients_of_cells(cellist_context *context, const cellist_mesh *mesh,
                                                      const cellist_scalar *scalar, double *gradients);

/* The gradient at each point: least squares over the edges that meet there, each once, with weight 1.
 * Arrays: gradients[3 point_count], the caller's, filled, scalar per length of the mesh; edges to scalars that are not
 *   finite are left out. All 0 if the scalar is one per cell.
 * Errors: INVALID_ARGUMENT (NULL, a scalar of another mesh), OUT_OF_MEMORY. Threads: one call per context at a time.
 * Cost: a radix sort of six edges a tet; some 150 bytes a tet for the time of the call. */
CELLIST_API cellist_result cellist_gradients_at_points(cellist_context *context, const cellist_mesh *mesh,
                                                       const cellist_scalar *scalar, double *gradients);

#ifdef __cplusplus
}
#endif
#endif
