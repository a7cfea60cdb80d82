/* SPDX-License-Identifier: BSD-3-Clause
 * Budget: the cheapest way to draw that is close enough, or the closest that is fast enough, by what reports measured.
 */
#ifndef CELLIST_TOOLS_BUDGET_H
#define CELLIST_TOOLS_BUDGET_H

#include <cellist/pipeline.h>

typedef struct budget_choice {
  const char *name;        /* the setting's, as in reports */
  double expected_error;   /* root mean square: the worst that reports show */
  double expected_seconds; /* a frame */
} budget_choice;

/* Chooses for a mesh and a frame and sets renderer, precision, integration and framebuffer of desc, whose optics must
 * stand. error: above 0, the cheapest setting whose expected error is at most that; else seconds: the closest of those
 * expected to take at most that, or the fastest of all. Returns false if no setting is close enough; choice then has
 * the closest one. */
bool budget_choose(const cellist_mesh *mesh, const cellist_frame *frame, double error, double seconds, unsigned threads,
                   cellist_pipeline_desc *desc, budget_choice *choice);

#endif
