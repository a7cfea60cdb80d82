/* SPDX-License-Identifier: BSD-3-Clause
 * What a pipeline holds, and the steps that share it. Private to tools/pipeline/. */
#ifndef CELLIST_TOOLS_PIPELINE_PRIVATE_H
#define CELLIST_TOOLS_PIPELINE_PRIVATE_H

#include <cellist/pipeline.h>
#include <cellist/soft.h>
#include <cellist/sort.h>

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
  cellist_transfer transfer;
  cellist_pipeline_desc desc; /* its texts are not kept */
  cellist_renderer renderer;  /* never AUTO */
  cellist_isosurface *isos;   /* the pipeline's copy, which desc refers to */
  double unit_distance;
  double load_seconds;
  cellist_raycaster *caster;
  cellist_soft *soft;
  cellist_sorter *sorter;
  uint32_t *order; /* [tet_count] far to near */
#ifdef CELLIST_HAS_GL
  cellist_gl *gl;
#endif
};

/* Seconds of a monotonic clock: for statistics, never for a choice. */
double pipeline_seconds(void);

/* The length of the bounds' diagonal. */
double pipeline_diagonal(const cellist_pipeline *pipeline);

/* plan.c: notes in stats that the picture did without something; the rest is for printf. */
void pipeline_leave_out(cellist_pipeline_stats *stats, const char *what, const char *why, ...)
    __attribute__((format(printf, 3, 4)));

/* optics.c: the transfer function in mesh units; the model with its defaults filled in. */
cellist_result pipeline_load_transfer(cellist_pipeline *pipeline);
cellist_result pipeline_keep_model(cellist_pipeline *pipeline);

/* order.c: makes the sorter; sorts for the frame's eye into pipeline->order. */
cellist_result pipeline_make_sorter(cellist_pipeline *pipeline);
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
