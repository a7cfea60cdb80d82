/* SPDX-License-Identifier: BSD-3-Clause
 * Renderer through OpenGL 4.1 core: cells in order, each drawn exactly on every pixel, blended from far to near. */
#ifndef CELLIST_GL_H
#define CELLIST_GL_H

#include <cellist/image.h>
#include <cellist/mesh.h>
#include <cellist/optics.h>
#include <cellist/surface.h>
#include <cellist/transfer.h>
#include <cellist/view.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where the OpenGL context comes from. */
typedef enum cellist_gl_backend {
  CELLIST_GL_AUTO,   /* EGL where it has a real device, else OSMesa, else EGL in software */
  CELLIST_GL_OSMESA, /* in memory, no display */
  CELLIST_GL_EGL,    /* no display, a GPU if there is one */
  CELLIST_GL_GLFW    /* a hidden window of the desktop */
} cellist_gl_backend;

/* {0} is the default. */
typedef struct cellist_gl_desc {
  cellist_gl_backend backend;
  size_t list_bytes; /* memory for per-pixel lists, at most; 0: what this OpenGL allows. Less costs time */
} cellist_gl_desc;

typedef struct cellist_gl cellist_gl;

/* Opens an OpenGL context of its own and the renderer in it.
 * Arrays: desc may be NULL. *gl is the caller's, for cellist_gl_destroy.
 * Errors: INVALID_ARGUMENT, UNSUPPORTED (a backend that was not built in), GRAPHICS (no context of version 4.1),
 *   OUT_OF_MEMORY.
 * Threads: one call per context at a time. The OpenGL context is current only inside calls on this renderer, and no
 *   other is current on the thread afterwards.
 * Cost: some 10 ms with Mesa; shaders are compiled when first used. */
CELLIST_API cellist_result cellist_gl_create(cellist_context *context, const cellist_gl_desc *desc, cellist_gl **gl);

/* Frees the renderer and its OpenGL context; NULL is legal. The context that made it must still exist. */
CELLIST_API void cellist_gl_destroy(cellist_gl *gl);

/* Who draws: the backend's name and OpenGL's own words, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)". The texts belong to
 * the renderer. Threads: any. */
CELLIST_API const char *cellist_gl_backend_name(const cellist_gl *gl);
CELLIST_API const char *cellist_gl_device_name(const cellist_gl *gl);

/* Makes this mesh and scalar the ones that render draws.
 * Arrays: both are borrowed until the next upload or cellist_gl_destroy.
 * Errors: INVALID_ARGUMENT (NULL, a scalar that is not of this mesh), OUT_OF_MEMORY. After a failure the renderer
 *   still has what it had.
 * Threads: one call per renderer at a time. Cost: linear in points and tets. */
CELLIST_API cellist_result cellist_gl_upload(cellist_gl *gl, const cellist_mesh *mesh, const cellist_scalar *scalar);

/* How cells are projected. */
typedef enum cellist_gl_method {
  CELLIST_GL_FACES, /* on each pixel by the planes of the cell's faces: exact to rounding */
  CELLIST_GL_FAN    /* as fans of triangles around the thick vertex (Shirley and Tuchman), in perspective: up to 1/256
                       pixel off where OpenGL moves corners. Cells with a corner beside or behind the eye, those in groups,
                       and all that are lit by gradients at points are drawn as faces */
} cellist_gl_method;

/* {0} is the default: emission and absorption, floats. Every model is drawn, lit by one gradient a cell or by gradients
 * at points; maximum intensity always in floats. Emission, absorption and maximum intensity need no order: any
 * will do. */
typedef struct cellist_gl_settings {
  cellist_optics optics;
  cellist_framebuffer framebuffer;
  const cellist_gl_group *groups; /* [group_count] ascending, disjoint; may be NULL if there are none */
  size_t group_count;
  cellist_gl_group_method group_method;
  const cellist_surface *surface; /* stands in the picture; NULL: none */
  cellist_gl_method method;
} cellist_gl_settings;

/* What a render did. */
typedef struct cellist_gl_stats {
  uint64_t cell_count;     /* cells of the order that can show something */
  uint64_t triangle_count; /* that their footprints were drawn with */
  uint64_t fragment_count; /* pixels of cells that contributed; those of a group of up to 16 cells count once */
  uint64_t left_count;     /* of cell_count, what CELLIST_GL_FAN left to faces */
  uint64_t group_count;    /* groups composited by themselves; none where the model needs no order */
} cellist_gl_stats;

/* Draws one view.
 * Arrays: order[order_count] holds tets of the mesh, far to near for this frame's eye, each at most once; flat cells
 *   and cells with a NaN or infinite scalar may be in it and are not drawn. Those of the image's channels R G B A, Z,
 *   ZBack that it has are filled: premultiplied linear colour, and the depth along frame->forward where the first
 *   contribution begins and the last one ends (infinity and 0 where there is none). settings and stats may be NULL.
 * Errors: INVALID_ARGUMENT (nothing uploaded, a tet that does not exist, an image of another size, a transfer function
 *   without knots, out of order or not finite, an isosurface's opacity or a number of samples out of range, groups
 *   beyond the order or out of order), UNSUPPORTED (a size beyond this OpenGL's, lists below 4.3),
 *   GRAPHICS, OUT_OF_MEMORY.
 * Threads: one call per renderer at a time; the context's workers prepare the cells, the picture does not depend on
 *   their number.
 * Cost: linear in cells and fragments. */
CELLIST_API cellist_result cellist_gl_render(cellist_gl *gl, const cellist_frame *frame,
                                             const cellist_transfer *transfer, const uint32_t *order,
                                             size_t order_count, const cellist_gl_settings *settings,
                                             cellist_image *image, cellist_gl_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
