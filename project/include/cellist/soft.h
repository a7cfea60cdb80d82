/* SPDX-License-Identifier: BSD-3-Clause
 * Soft: a projector that needs no OpenGL. Cells in order, binned to tiles, each footprint filled with vector
 * instructions, every pixel with exact entry, exit and optics. */
#ifndef CELLIST_SOFT_H
#define CELLIST_SOFT_H

#include <cellist/image.h>
#include <cellist/mesh.h>
#include <cellist/optics.h>
#include <cellist/surface.h>
#include <cellist/transfer.h>
#include <cellist/view.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cellist_soft cellist_soft;

/* {0} is the default. */
typedef struct cellist_soft_desc {
  bool portable; /* plain C even where the processor has AVX2: for tests and measurements */
} cellist_soft_desc;

/* Makes a projector for a mesh and a scalar on it.
 * Arrays: mesh and scalar are borrowed and must outlive the projector. desc may be NULL. *soft is the caller's, for
 *   cellist_soft_destroy.
 * Errors: INVALID_ARGUMENT (NULL, a scalar that is not of this mesh), OUT_OF_MEMORY.
 * Threads: one call per context at a time. Cost: linear in points and tets. */
CELLIST_API cellist_result cellist_soft_create(cellist_context *context, const cellist_mesh *mesh,
                                               const cellist_scalar *scalar, const cellist_soft_desc *desc,
                                               cellist_soft **soft);

/* Frees the projector; NULL is legal. */
CELLIST_API void cellist_soft_destroy(cellist_soft *soft);

/* order[begin] to order[begin + count - 1] lie in front of each other in a circle: on every pixel they are composited
 * by their depth there, which is exact as long as no two overlap. */
typedef struct cellist_soft_group {
  size_t begin, count;
} cellist_soft_group;

/* What is drawn. {0} draws nothing: an order of no cells. */
typedef struct cellist_soft_settings {
  cellist_optics optics; /* every model, lit or not */
  /* [order_count] tets of the mesh, far to near for this frame's eye, each at most once. Ids beyond the mesh's tets
   * (imaginary cells), flat cells and cells with a NaN or infinite scalar may be in it and are not drawn. */
  const uint32_t *order;
  size_t order_count;
  const cellist_soft_group *groups; /* [group_count] ascending, disjoint; may be NULL if there are none */
  size_t group_count;
  const cellist_surface *surface; /* stands in the picture; NULL: none */
} cellist_soft_settings;

/* What a render did. */
typedef struct cellist_soft_stats {
  uint64_t cell_count;     /* cells whose bounding rectangle holds a pixel's centre */
  uint64_t fragment_count; /* pixels of cells that were shaded */
  uint64_t careful_count;  /* cells and tiles worked out in double precision: slivers, edge-on faces, the eye inside */
  bool vectorised;         /* AVX2 was used */
} cellist_soft_stats;

/* Draws one view.
 * Arrays: those of the image's channels R G B A, Z, ZBack that it has are filled: premultiplied linear colour, and the
 *   depth along frame->forward where the first contribution begins and the last one ends (infinity and 0 where there
 *   is none). settings and its arrays are read during the call; stats may be NULL.
 * Errors: INVALID_ARGUMENT (NULL, an image of another size, a transfer function without knots, out of order or not
 *   finite, optics that cellist_optics_check refuses, groups beyond the order), UNSUPPORTED (more than 65,535 pixels
 *   along a side), OUT_OF_MEMORY, CANCELLED.
 * Threads: one render per projector at a time; the context's workers share out tiles, the picture does not depend on
 *   their number. Pictures with and without AVX2 differ by rounding.
 * Cost: linear in cells and fragments; memory of earlier calls is used again. */
CELLIST_API cellist_result cellist_soft_render(cellist_soft *soft, const cellist_frame *frame,
                                               const cellist_transfer *transfer, const cellist_soft_settings *settings,
                                               cellist_image *image, cellist_soft_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
