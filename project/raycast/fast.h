/* SPDX-License-Identifier: BSD-3-Clause
 * Fast: the caster in single precision, from mesh and scalar to pixels. Private to the ray caster; the public call is
 * cellist_raycaster_render with `fast` precision. */
#ifndef CELLIST_RAYCAST_FAST_H
#define CELLIST_RAYCAST_FAST_H

#include "../surface/layer.h"
#include "fast_entries.h"
#include "raycaster.h"

/* Which code walks: the best for this machine, or plain C (the results differ by rounding only). */
typedef enum fast_kernel { FAST_KERNEL_BEST, FAST_KERNEL_PORTABLE } fast_kernel;

typedef struct fast_caster fast_caster;

/* Packs the mesh's cells. mesh and scalar are borrowed. Errors: OUT_OF_MEMORY. Cost: linear in the mesh. */
cellist_result fast_caster_create(cellist_context *context, const cellist_mesh_arrays *mesh,
                                  const cellist_scalar *scalar, fast_layout layout, fast_caster **caster);
void fast_caster_destroy(fast_caster *caster);

/* Bytes that cells, and vertices, take. */
size_t fast_caster_cell_bytes(const fast_caster *caster);
size_t fast_caster_vertex_bytes(const fast_caster *caster);

typedef struct fast_draw_desc {
  bool absorption_only; /* black */
  bool wants_depth;     /* fill z and z_back of pixels */
  fast_kernel kernel;
  const surface_layer *layer; /* rays end there; NULL: none */
  bool skips_walk;            /* only find entries: for benchmarks */
} fast_draw_desc;

typedef struct fast_stats {
  uint64_t ray_count, entry_count, step_count, piece_count, fold_ray_count;
  size_t retry_count;
  uint32_t *retries; /* [retry_count] pixels (y * width + x) whose rays got lost: to be cast by other means. Belongs to
                        the caster, until its next frame */
} fast_stats;

/* Takes a finished tile, on the worker that drew it: tile->first tells which pixels were drawn at all. */
typedef void (*fast_sink)(void *user, const fast_scene *scene, const fast_tile *tile);

/* Draws a frame. The transfer function has been checked.
 * Errors: OUT_OF_MEMORY, CANCELLED. Threads: the context's workers share out tiles of FAST_TILE x FAST_TILE pixels; a
 * pixel does not depend on who drew it. Cost: linear in vertices, boundary faces and cells passed. */
cellist_result fast_caster_draw(fast_caster *caster, const cellist_frame *frame, const cellist_transfer *transfer,
                                const fast_draw_desc *desc, fast_sink sink, void *user, fast_stats *stats);

/* The public render by `fast`; the arguments have been checked. */
cellist_result raycaster_render_fast(cellist_raycaster *caster, const cellist_frame *frame,
                                     const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                     const cellist_raycast_output *output, cellist_raycast_stats *stats);

#endif
