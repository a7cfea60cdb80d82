/* SPDX-License-Identifier: BSD-3-Clause
 * Ray caster: a mesh to a picture, one ray a pixel, with neither an order nor OpenGL.
 *
 * Two precisions of one walk from tet to tet. `reference` is what every other picture is judged by: double precision,
 * exact decisions, exact optics, a bound of its error. `fast` is for pictures: single precision, compact cells. */
#ifndef CELLIST_RAYCAST_H
#define CELLIST_RAYCAST_H

#include <cellist/image.h>
#include <cellist/mesh.h>
#include <cellist/optics.h>
#include <cellist/surface.h>
#include <cellist/transfer.h>
#include <cellist/view.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum cellist_precision { CELLIST_PRECISION_FAST, CELLIST_PRECISION_REFERENCE } cellist_precision;

/* {0} is the default. */
typedef struct cellist_raycaster_desc {
  uint32_t tets; /* how `fast` keeps a cell: 32, 20 or 16 bytes (paper [A]); 0: the fastest layout */
} cellist_raycaster_desc;

typedef struct cellist_raycaster cellist_raycaster;

/* Makes a caster for a mesh and a scalar on it.
 * Arrays: mesh and scalar are borrowed and must outlive the caster. desc may be NULL. *caster is the caller's, for
 *   cellist_raycaster_destroy.
 * Errors: INVALID_ARGUMENT (NULL, a scalar that is not of this mesh, a layout that does not exist), OUT_OF_MEMORY.
 * Threads: one call per context at a time; one render per caster at a time.
 * Cost: linear in boundary faces for `reference`; what only one precision needs is made at its first render. */
CELLIST_API cellist_result cellist_raycaster_create(cellist_context *context, const cellist_mesh *mesh,
                                                    const cellist_scalar *scalar, const cellist_raycaster_desc *desc,
                                                    cellist_raycaster **caster);

/* Frees the caster; NULL is legal. */
CELLIST_API void cellist_raycaster_destroy(cellist_raycaster *caster);

/* {0} is the default: fast, emission and absorption. */
typedef struct cellist_raycast_desc {
  cellist_precision precision;
  cellist_optics optics;
  const cellist_surface *surface; /* stands in the picture; NULL: none */
} cellist_raycast_desc;

/* Where a picture goes; all arrays are the caller's, row 0 is the top one, any may be NULL. */
typedef struct cellist_raycast_output {
  double *rgba;          /* [4 width height] premultiplied, linear */
  double *transmittance; /* [width height] 1 - A without its cancellation; 1 in the models that absorb nothing */
  double *z, *z_back;    /* [width height] depth along frame->forward where the first contribution begins and the last
                            one ends; infinity and 0 where there is none */
  uint32_t *cell_count;  /* [width height] cells that the ray passed where it is seen */
  uint32_t
      *segment_count;   /* [width height] pieces of them that were integrated: split at the transfer function's knots */
  cellist_image *image; /* of the frame's size; those of its channels R G B A, Z, ZBack, transmittance.Y, cells.Y,
                           segments.Y that it has are filled */
} cellist_raycast_output;

/* What a render did and found. */
typedef struct cellist_raycast_stats {
  double error_bound;      /* of `reference`: no value of R G B A is further from the exact one for the mesh's doubles.
                              Where light is absorbed at most 1 or twice the largest colour, whichever is larger;
                              infinity where no bound is known: lit volumes and surfaces, emission whose bound leaves
                              the range of doubles, `fast` */
  uint64_t ray_count;      /* rays that met the mesh */
  uint64_t entry_count;    /* boundary faces through which they came in */
  uint64_t step_count;     /* cells that they passed */
  uint64_t segment_count;  /* pieces that were integrated */
  uint64_t retry_count;    /* side tests that rounding left open and exact arithmetic decided */
  uint64_t fold_ray_count; /* rays on which cells overlap: the mesh is flawed there, the picture arbitrary but finite */
} cellist_raycast_stats;

/* Draws one view.
 * Arrays: see cellist_raycast_output. desc and stats may be NULL.
 * Errors: INVALID_ARGUMENT (no output, an image of another size, a transfer function without knots, out of order or not
 *   finite, an opacity or light out of range), UNSUPPORTED (what `fast` does not draw), OUT_OF_MEMORY, CANCELLED.
 * Threads: one render per caster at a time; the context's workers share out tiles, results do not depend on their
 *   number.
 * Cost: linear in the cells that rays pass. */
CELLIST_API cellist_result cellist_raycaster_render(cellist_raycaster *caster, const cellist_frame *frame,
                                                    const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                                    const cellist_raycast_output *output, cellist_raycast_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
