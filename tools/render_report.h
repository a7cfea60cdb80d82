/* SPDX-License-Identifier: BSD-3-Clause
 * Render report: what `cellist render` says when it is done, for people and for machines. */
#ifndef CELLIST_TOOLS_RENDER_REPORT_H
#define CELLIST_TOOLS_RENDER_REPORT_H

#include <cellist/pipeline.h>

#include "options.h"

/* What the command was asked for. */
struct render_options {
  text_list outputs;
  const char *renderer, *backend, *framebuffer, *precision, *tets;
  unsigned size[2], frames, turntable, threads;
  number_list background;
  double error, time; /* 0: not asked for */
  bool json, explain, no_plan;
};

/* What it did. */
struct render_outcome {
  const struct render_options *options;
  const char *mesh_name;
  const cellist_pipeline *pipeline;
  cellist_pipeline_stats stats;       /* of the last frame */
  double sort, draw, total;           /* seconds: medians per frame; the whole command */
  const cellist_pipeline_stats *full; /* of the last frame drawn without a plan; NULL unless asked to explain */
};

/* Prints one object on standard output; returns the exit status. */
int render_report_json(const struct render_outcome *outcome);

/* Prints lines, on standard error if a picture goes to standard output; returns the exit status. */
int render_report_text(const struct render_outcome *outcome);

#endif
