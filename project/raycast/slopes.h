/* SPDX-License-Identifier: BSD-3-Clause
 * Bounds of the scalar's slope, for error bounds. Private to the reference caster. */
#ifndef CELLIST_RAYCAST_SLOPES_H
#define CELLIST_RAYCAST_SLOPES_H

#include <cellist/mesh.h>

/* For every tet an upper bound of the length of the gradient of the linear function through its corners; 0 where there
 * is none. slopes: [tets], filled. */
void gradient_slopes(cellist_context *context, const cellist_mesh_arrays *mesh, const cellist_scalar *scalar,
                     float *slopes);

#endif
