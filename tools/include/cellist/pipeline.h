/* SPDX-License-Identifier: BSD-3-Clause
 * Pipeline: from a mesh file to a picture in one object. Read, order, project; what a scene does not need is left out.
 * The command and the viewer use it, and so can any program that wants it all. */
#ifndef CELLIST_PIPELINE_H
#define CELLIST_PIPELINE_H

#include <cellist/image.h>
#include <cellist/mesh.h>
#include <cellist/order.h>
#include <cellist/raycast.h>
#include <cellist/surface.h>
#include <cellist/transfer.h>
#include <cellist/view.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a mesh from a file ("-": standard input) or makes a generated one ("sample:NAME" or "sample:NAME:SIZE", then
 * any of ",seed=N", ",perturb=P", ",parts=N", as cellist_generate_desc).
 * desc may be NULL. *mesh is the caller's. Errors: those of cellist_mesh_read; NOT_FOUND (no such sample).
 * Threads: one call per context at a time. */
CELLIST_API cellist_result cellist_pipeline_load(cellist_context *context, const char *source,
                                                 const cellist_mesh_read_desc *desc, cellist_mesh **mesh);

/* What the mesh looks like; {0} is valid. */
typedef struct cellist_pipeline_optics {
  const char *scalar;   /* as cellist_scalar_select; NULL: the default one */
  const char *transfer; /* a built-in name or a ParaView JSON file; NULL: "ramp" */
  /* The program's own, per length of the mesh's units: taken as it is, in place of transfer, range, unit, scale,
   * convention and colours. Copied. */
  const cellist_transfer *function;
  bool has_range;                /* false: the scalar's own range; a constant scalar then takes the middle */
  double range[2];               /* the scalars that the transfer function covers */
  double unit_distance;          /* in mesh units; 0: as the next one says */
  double unit_diagonal_fraction; /* the unit is the bounds' diagonal / this; 0: ParaView's automatic one */
  double opacity_scale;          /* multiplies extinction; 0 means 1 */
  cellist_opacity_convention convention;
  bool srgb_colours; /* as cellist_transfer_desc */
  /* What a ray gathers. light.gradient_unit may be 0: the scalar's range per tenth of the bounds' diagonal. Isosurfaces
   * are copied. */
  cellist_optics model;
} cellist_pipeline_optics;

typedef enum cellist_renderer {
  CELLIST_RENDERER_AUTO,  /* soft or cast, by counted work; faces where a backend is named that is not software */
  CELLIST_RENDERER_FACES, /* OpenGL, each cell exact on every pixel, in visibility order */
  CELLIST_RENDERER_FAN,   /* OpenGL, each cell as a fan of triangles, in visibility order */
  CELLIST_RENDERER_SOFT,  /* cell projection without OpenGL; composites groups exactly */
  CELLIST_RENDERER_CAST   /* ray caster, needs neither OpenGL nor an order */
} cellist_renderer;

/* Where OpenGL comes from: as cellist_gl_backend. */
typedef enum cellist_backend {
  CELLIST_BACKEND_AUTO,
  CELLIST_BACKEND_OSMESA,
  CELLIST_BACKEND_EGL,
  CELLIST_BACKEND_GLFW
} cellist_backend;

/* How projected cells are ordered. Only the first is right; the others show what it is worth. */
typedef enum cellist_sorting {
  CELLIST_SORTING_EXACT,
  CELLIST_SORTING_CENTROID, /* by the distance of the cells' centres, as many programs do */
  CELLIST_SORTING_NONE      /* as the cells are kept */
} cellist_sorting;

/* An opaque surface in the scene, see cellist/surface.h. */
typedef struct cellist_pipeline_surface {
  /* An STL, OBJ or PLY file; "boundary": the mesh's own; "cells:SCALAR=LO..HI": the cells all of whose values lie in
   * that range, either end of which may be left out; "ids:3+7..20": cells by the file's ids. */
  const char *source;
  const cellist_surface *surface; /* the program's own, in place of source; read during the call only */
  bool has_colour;                /* false: a file's own colours, else grey; cells: the transfer function's colours */
  double colour[3];               /* linear */
} cellist_pipeline_surface;

typedef struct cellist_pipeline_desc {
  const char *source;       /* as cellist_pipeline_load */
  const cellist_mesh *mesh; /* the program's own, in place of source, which then is a name for messages or NULL;
                               borrowed while the pipeline lives */
  cellist_mesh_read_desc read;
  cellist_pipeline_optics optics;
  cellist_renderer renderer;
  uint32_t width, height, frames; /* size and number of the pictures to come, which AUTO chooses a renderer for; 0:
                                     512 and many */
  const cellist_view *view;       /* of these pictures, likewise; NULL: the usual one. Read during the call only */
  /* For AUTO, one of them above 0: the cheapest way to draw whose root mean square error is expected to be at most
   * this, or else the closest whose frame is expected to take at most so many seconds on the context's threads. Sets
   * precision, framebuffer, integration and, where it is 0, optics.model.sample_count. By counts and constants, so that
   * it repeats. No way so close is an error (UNSUPPORTED), none so fast a warning. */
  double error, seconds;
  cellist_order_desc order;        /* what cells are sorted with, where an exact order is needed */
  cellist_backend backend;         /* for faces and fan */
  cellist_framebuffer framebuffer; /* for faces and fan; maximum intensity is always drawn in floats */
  cellist_sorting sorting;         /* for faces and soft */
  uint32_t tets;                   /* for cast: bytes a cell of the compact layouts, as cellist_raycaster_desc */
  cellist_precision precision;     /* for cast; fast falls back to reference for models that it does not draw */
  size_t surface_count;
  const cellist_pipeline_surface *surfaces; /* [surface_count] read during the call only */
  bool no_plan;                             /* do everything, also what this scene does not need: for comparison */
} cellist_pipeline_desc;

/* A piece of work that a scene did not need, and why. */
typedef struct cellist_left_out {
  const char *what; /* "exterior", "sort", "sort (same eye)", "groups", "invisible cells", "light", "tables"; belongs to
                       the library */
  char why[96];
} cellist_left_out;

enum { CELLIST_LEFT_OUT_LIMIT = 12 };

/* What a way to draw is expected to need. */
typedef struct cellist_budget {
  const char *name; /* the setting's, as in reports; belongs to the library; NULL: nothing was asked for */
  double error;     /* root mean square: the worst that a report over real meshes shows */
  double seconds;   /* a frame, without sorting, on the machine that was measured */
} cellist_budget;

/* Seconds and facts of the last picture. Texts belong to the library. */
typedef struct cellist_pipeline_stats {
  double load_seconds;                     /* once: read, adjacency, Hilbert order */
  double convexify_seconds;                /* once: the exterior, made or read; 0 if nothing was convexified */
  double prepare_seconds;                  /* once: the plan, what the renderer keeps, without convexify_seconds */
  double sort_seconds, draw_seconds;       /* of the last picture */
  const char *renderer, *method, *backend; /* what was used; backend is "none" without OpenGL */
  const char *renderer_reason;             /* why this renderer; belongs to the pipeline */
  cellist_budget budget;                   /* what an error or seconds asked for made of it */
  const char *pixels;                      /* "32f", "16f" or "8": what was blended in */
  const char *precision;                   /* "fast" (single precision) or "reference" */
  double error_bound;                      /* proved, of reference; infinity where none is known */
  const char *order;                       /* "exact", "approximate", or "none" if no order was needed */
  const char *exterior, *exterior_reason;  /* as cellist_order_facts; NULL if no order was needed */
  size_t imaginary_cells;
  size_t group_count, cells_in_groups; /* cells that lie in front of each other in circles, where order matters */
  uint64_t fragments;                  /* segments that contributed, as the renderer counts them */
  const char *convention;              /* of opacity: "unstructured" or "image" */
  size_t transfer_knots;
  double unit_distance;
  size_t visible_cells; /* tets that can show something, by their scalars' range; all of them without a plan */
  size_t left_out_count;
  cellist_left_out left_out[CELLIST_LEFT_OUT_LIMIT]; /* [left_out_count] what this scene did not need */
} cellist_pipeline_stats;

typedef struct cellist_pipeline cellist_pipeline;

/* Loads the mesh, chooses scalar and transfer function, makes the renderer ready.
 * Arrays: desc and its texts are read during the call only; *pipeline is the caller's.
 * Errors: those of reading, scalar and transfer function; GRAPHICS (no OpenGL context); UNSUPPORTED (a renderer
 *   that this build leaves out). Threads: one call per context at a time. */
CELLIST_API cellist_result cellist_pipeline_create(cellist_context *context, const cellist_pipeline_desc *desc,
                                                   cellist_pipeline **pipeline);
CELLIST_API void cellist_pipeline_destroy(cellist_pipeline *pipeline);

/* The mesh and the scalar that are drawn; they belong to the pipeline. */
CELLIST_API const cellist_mesh *cellist_pipeline_mesh(const cellist_pipeline *pipeline);
CELLIST_API const cellist_scalar *cellist_pipeline_scalar(const cellist_pipeline *pipeline);

/* About how many segments (cells on rays) a picture of a mesh has, without drawing it: what its cost depends on.
 * Threads: any. Cost: that of 20,000 tets at most. */
CELLIST_API double cellist_pipeline_estimate_fragments(const cellist_mesh *mesh, const cellist_frame *frame);

/* Draws one view.
 * Arrays: view may be NULL: the whole mesh, from CELLIST_VIEW_AZIMUTH and CELLIST_VIEW_ELEVATION. *image is the
 * caller's, with channels R G B A (premultiplied, linear) and Z (depth of the first contribution along the line of
 * sight, infinity where there is none), and camera and settings as attributes. stats may be NULL. Errors: those of
 * cellist_frame_from_view, of the sorter and of the renderer. Threads: the one that created the pipeline. Cost: that of
 * sorting and drawing. */
CELLIST_API cellist_result cellist_pipeline_draw(cellist_pipeline *pipeline, const cellist_view *view, uint32_t width,
                                                 uint32_t height, cellist_image **image, cellist_pipeline_stats *stats);

/* Makes the next picture sort its cells, though the eye may be where it was: for timing. */
CELLIST_API void cellist_pipeline_forget_order(cellist_pipeline *pipeline);

#ifdef __cplusplus
}
#endif
#endif
