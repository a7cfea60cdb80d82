/* SPDX-License-Identifier: BSD-3-Clause
 * What a pipeline holds, and the steps that share it. Private to tools/pipeline/. */
#ifndef CELLIST_TOOLS_PIPELINE_PRIVATE_H
#define CELLIST_TOOLS_PIPELINE_PRIVATE_H

#include <cellist/order.h>
#include <cellist/pipeline.h>
#include <cellist/soft.h>
#include <cellist/sort.h>
#include <cellist/sort_peers.h>

#include "../clock.h"

#ifdef CELLIST_HAS_GL
#include <cellist/gl.h>
#endif

struct cellist_pipeline {
  cellist_context *context;
  cellist_mesh *loaded;     /* NULL if the mesh is the caller's */
  const cellist_mesh *mesh; /* loaded, or the caller's */
  cellist_scalar scalar;
  const cellist_mesh *drawn;          /* what renderers get: the mesh, or those of its tets that can show something */
  const cellist_scalar *drawn_scalar; /* of drawn */
  cellist_mesh *part;                 /* what drawn is if it is not the whole mesh; else NULL */
  cellist_scalar part_scalar;
  uint8_t *visible;                 /* [tets of the mesh] what stays in the order; NULL: all of drawn */
  size_t visible_count, kept_count; /* that can show something; that gradients need too */
  cellist_transfer transfer;
  cellist_pipeline_desc desc; /* its texts are not kept */
  cellist_renderer renderer;  /* never AUTO */
  char reason[96];            /* why it was chosen */
  cellist_budget budget;      /* what was made of desc's error or seconds */
  cellist_isosurface *isos;   /* the pipeline's copy, which desc refers to */
  double unit_distance;
  double load_seconds, prepare_seconds;
  char method[48]; /* of integration, for stats */
  cellist_raycaster *caster;
  cellist_soft *soft;
  cellist_surface *surface;      /* all of the scene's, joined; NULL: none */
  cellist_order *sorted;         /* the sorter and its exterior; NULL if no exact order is needed */
  cellist_sorter *sorter;        /* sorted's */
  cellist_sort_stats sort_stats; /* of the order that stands in order */
  cellist_peer *peer;            /* orders in the sorter's place; else NULL */
  uint32_t *order;               /* [order_count] tets of drawn, far to near */
  size_t order_count;
  cellist_group *groups; /* [group_count] of the order */
  size_t group_count, group_capacity;
#ifdef CELLIST_HAS_GL
  cellist_gl *gl;
#endif
};

/* The length of the bounds' diagonal. */
double pipeline_diagonal(const cellist_pipeline *pipeline);

/* choose.c: sets the renderer that the pipeline was asked for, or the one that suits the scene; says why. */
cellist_result pipeline_choose(cellist_pipeline *pipeline);
/* Opens an OpenGL context, and keeps it if something faster than software draws there. */
bool pipeline_has_gpu(cellist_pipeline *pipeline);

/* visible.c: marks the tets that can show something, and counts them. */
cellist_result pipeline_find_visible(const cellist_pipeline *pipeline, uint8_t *visible, size_t *count);
/* Marks also every tet that shares a point with a marked one. */
cellist_result pipeline_grow_visible(const cellist_pipeline *pipeline, uint8_t *visible, size_t *count);

/* plan.c: marks the tets that can show something, which then decides how they are drawn. */
cellist_result pipeline_look(cellist_pipeline *pipeline);
/* Decides what is drawn; the renderer must have been chosen. */
cellist_result pipeline_plan(cellist_pipeline *pipeline);
/* Why the optics need no order, or NULL if they do. */
const char *pipeline_order_free(const cellist_pipeline *pipeline);
/* Takes invisible tets out of order and groups, if the plan says so. */
void pipeline_filter_order(cellist_pipeline *pipeline);
/* Notes what the plan left out; after the frame. */
void pipeline_note_plan(const cellist_pipeline *pipeline, cellist_pipeline_stats *stats);
/* Notes in stats that the picture did without something; the rest is for printf. */
void pipeline_leave_out(cellist_pipeline_stats *stats, const char *what, const char *why, ...)
    __attribute__((format(printf, 3, 4)));

/* optics.c: the transfer function in mesh units; the model with its defaults filled in. */
cellist_result pipeline_load_transfer(cellist_pipeline *pipeline);
cellist_result pipeline_keep_model(cellist_pipeline *pipeline);
/* How faces integrates the model, in words: "exact", "psi", "table 128x128x32". */
const char *pipeline_name_method(cellist_pipeline *pipeline);
/* Whether that is by other means than exactly. */
bool pipeline_is_inexact(const cellist_pipeline *pipeline);
/* Whether the transfer function is too sharp for scalars in single precision. */
bool pipeline_is_narrow(const cellist_pipeline *pipeline);

/* surfaces.c: the scene's opaque surface; what an image's attributes say of it and of clip planes. */
cellist_result pipeline_make_surface(cellist_pipeline *pipeline);
cellist_result pipeline_describe_cuts(const cellist_pipeline *pipeline, const cellist_frame *frame,
                                      cellist_image *image);

/* order.c: makes the sorter, if the optics need an order; fills order and groups for the frame's eye. */
cellist_result pipeline_make_order(cellist_pipeline *pipeline);
cellist_result pipeline_sort(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_pipeline_stats *stats);

/* One file a renderer: makes it ready; draws a frame and fills in stats. */
cellist_result pipeline_make_cast(cellist_pipeline *pipeline);
cellist_result pipeline_draw_cast(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                  cellist_pipeline_stats *stats);
cellist_result pipeline_make_soft(cellist_pipeline *pipeline);
cellist_result pipeline_draw_soft(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                  cellist_pipeline_stats *stats);
cellist_result pipeline_make_gl(cellist_pipeline *pipeline);
cellist_result pipeline_draw_gl(cellist_pipeline *pipeline, const cellist_frame *frame, cellist_image *image,
                                cellist_pipeline_stats *stats);

#endif
