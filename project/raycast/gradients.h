/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients of the scalar, for light and for error bounds. Private to the reference caster. */
#ifndef CELLIST_RAYCAST_GRADIENTS_H
#define CELLIST_RAYCAST_GRADIENTS_H

#include <cellist/mesh.h>

/* The gradient of the linear function through the corners of a tet; 0 if the tet is flat, a corner has no finite
 * scalar, or the scalar is one per cell. */
void gradient_of_cell(const cellist_mesh_arrays *mesh, const cellist_scalar *scalar, uint32_t tet, double gradient[3]);

/* For every tet an upper bound of the length of that gradient. slopes: [tets], filled. */
void gradient_slopes(cellist_context *context, const cellist_mesh_arrays *mesh, const cellist_scalar *scalar,
                     float *slopes);

/* Fills [3 tets]. */
void gradients_of_cells(cellist_context *context, const cellist_mesh_arrays *mesh, const cellist_scalar *scalar,
                        double *gradients);

/* Fills [3 points] by least squares over the edges that meet at a point, each once; edges to scalars that are not
 * finite are left out. All 0 if the scalar is one per cell. Errors: OUT_OF_MEMORY. Cost: some 150 bytes a tet for the
 * time of the call. */
cellist_result gradients_at_points(cellist_context *context, const cellist_mesh_arrays *mesh,
                                   const cellist_scalar *scalar, double *gradients);

#endif
