/* SPDX-License-Identifier: BSD-3-Clause
 * Costs: what drawing a picture takes, counted, not clocked, so that choices repeat. Private to tools/pipeline/. */
#ifndef CELLIST_TOOLS_PIPELINE_COSTS_H
#define CELLIST_TOOLS_PIPELINE_COSTS_H

#include <cellist/pipeline.h>

/* Nanoseconds that making an exterior takes, a boundary face (spx, bluntfin and post; gears_t 400,000). */
enum { EXTERIOR_FACE_COST = 20000 };

/* What a picture's cost depends on. */
typedef struct draw_counts {
  double tets, fragments, pixels, boundary_faces;
} draw_counts;

/* A way to draw. Nanoseconds of one thread, without sorting. */
typedef struct draw_cost {
  const char *name; /* of the setting, as in reports */
  cellist_renderer renderer;
  cellist_precision precision;
  bool is_lit;
  uint32_t samples;        /* of light by gradients at points; 0: none, or exact */
  bool draws_every_model;  /* not only emission-absorption and absorption */
  bool draws_narrow_peaks; /* of the transfer function */
  double error;            /* root mean square: the worst that a report shows on the sound real meshes */
  double frame, tet, fragment, pixel, entry;
} draw_cost;

/* estimate.c. visible: [tets of the mesh] those that count; NULL: all. */
draw_counts draw_counts_of(const cellist_mesh *mesh, const cellist_frame *frame, const uint8_t *visible);
/* plan.c: faces of kept tets that have no kept tet behind them. */
size_t plan_count_boundary(const cellist_mesh_arrays *mesh, const uint8_t *keep);

/* The costs of every way; *count of them. */
const draw_cost *draw_costs(size_t *count);
/* The one of a renderer, without light. */
const draw_cost *draw_cost_of(cellist_renderer renderer, cellist_precision precision);

/* budget.c: chooses by the error or the seconds that the pipeline's desc asks for. */
cellist_result pipeline_choose_budget(cellist_pipeline *pipeline, const draw_counts *counts);

/* Seconds of a picture on so many threads. */
double draw_cost_seconds(const draw_cost *cost, const draw_counts *counts, unsigned threads);

#endif
