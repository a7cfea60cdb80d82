/* SPDX-License-Identifier: BSD-3-Clause
 * Render report: what `cellist render` says when it is done, for people and for machines. */
#include "render_report.h"

#include <stdio.h>
#include <string.h>

#include "terminal.h"

/* The stages' seconds of one way to draw. */
static json_t *seconds_json(const cellist_pipeline_stats *stats, double sort, double draw, double total) {
  return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "load", stats->load_seconds, "convexify", stats->convexify_seconds,
                   "prepare", stats->prepare_seconds, "sort", sort, "draw", draw, "total", total);
}

static json_t *plan_json(const cellist_pipeline_stats *stats) {
  json_t *plan = json_array();
  for (size_t i = 0; i < stats->left_out_count; i++)
    json_array_append_new(plan,
                          json_pack("{s:s, s:s}", "what", stats->left_out[i].what, "why", stats->left_out[i].why));
  return plan;
}

static double frame_seconds(const cellist_pipeline_stats *stats) { return stats->sort_seconds + stats->draw_seconds; }

int render_report_json(const struct render_outcome *outcome) {
  const struct render_options *options = outcome->options;
  const cellist_pipeline_stats *stats = &outcome->stats;
  const cellist_pipeline *pipeline = outcome->pipeline;
  json_t *left_out = json_array();
  for (size_t i = 0; i < stats->left_out_count; i++)
    json_array_append_new(left_out, json_string(stats->left_out[i].what));
  json_t *object = json_object();
  json_object_set_new(object, "renderer", json_string(stats->renderer));
  json_object_set_new(object, "renderer_reason", json_string(stats->renderer_reason));
  json_object_set_new(object, "width", json_integer(options->size[0]));
  json_object_set_new(object, "height", json_integer(options->size[1]));
  json_object_set_new(object, "frames", json_integer(options->turntable > 0 ? options->turntable : options->frames));
  json_object_set_new(object, "seconds", seconds_json(stats, outcome->sort, outcome->draw, outcome->total));
  json_object_set_new(object, "fragments", json_integer((json_int_t)stats->fragments));
  json_object_set_new(object, "left_out", left_out);
  json_object_set_new(object, "opacity_convention", json_string(stats->convention));
  json_object_set_new(object, "tf_entries", json_integer((json_int_t)stats->transfer_knots));
  json_object_set_new(object, "order", json_string(stats->order));
  json_object_set_new(object, "exterior", stats->exterior != NULL ? json_string(stats->exterior) : json_null());
  json_object_set_new(object, "exterior_reason",
                      stats->exterior_reason != NULL ? json_string(stats->exterior_reason) : json_null());
  json_object_set_new(object, "imaginary_cells", json_integer((json_int_t)stats->imaginary_cells));
  json_object_set_new(object, "groups", json_integer((json_int_t)stats->group_count));
  json_object_set_new(object, "cells_in_groups", json_integer((json_int_t)stats->cells_in_groups));
  json_object_set_new(object, "integration", json_string(stats->method));
  json_object_set_new(object, "precision", json_string(stats->precision));
  json_object_set_new(object, "error_bound", terminal_number(stats->error_bound));
  json_object_set_new(object, "context", json_string(stats->backend));
  json_object_set_new(object, "framebuffer", json_string(stats->pixels));
  json_object_set_new(object, "cells",
                      json_integer((json_int_t)cellist_mesh_get_arrays(cellist_pipeline_mesh(pipeline))->tet_count));
  json_object_set_new(object, "scalar", terminal_text(cellist_pipeline_scalar(pipeline)->name));
  json_object_set_new(object, "unit_distance", terminal_number(stats->unit_distance));
  json_object_set_new(object, "visible_cells", json_integer((json_int_t)stats->visible_cells));
  if (stats->budget.name != NULL)
    json_object_set_new(object, "choice",
                        json_pack("{s:s, s:f, s:f}", "setting", stats->budget.name, "expected_error",
                                  stats->budget.error, "expected_seconds", stats->budget.seconds));
  if (outcome->full != NULL) {
    const cellist_pipeline_stats *full = outcome->full;
    json_object_set_new(object, "plan", plan_json(stats));
    json_object_set_new(object, "seconds_without_plan",
                        seconds_json(full, full->sort_seconds, full->draw_seconds, frame_seconds(full)));
  }
  return terminal_print_json(object);
}

/* What was left out and why; what it saved where a frame without the plan was drawn to compare. */
static void explain(FILE *to, const struct render_outcome *outcome) {
  const cellist_pipeline_stats *plan = &outcome->stats, *full = outcome->full;
  fprintf(to, "plan:\n");
  for (size_t i = 0; i < plan->left_out_count; i++)
    fprintf(to, "  no %-16s %s\n", plan->left_out[i].what, plan->left_out[i].why);
  const struct {
    const char *stage;
    double planned, everything;
  } rows[] = {{"convexify", plan->convexify_seconds, full->convexify_seconds},
              {"prepare", plan->prepare_seconds, full->prepare_seconds},
              {"sort", outcome->sort, full->sort_seconds},
              {"draw", outcome->draw, full->draw_seconds}};
  fprintf(to, "  seconds     planned  everything    saved\n");
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
    fprintf(to, "  %-9s %9.4f %11.4f %8.4f\n", rows[i].stage, rows[i].planned, rows[i].everything,
            rows[i].everything - rows[i].planned);
}

int render_report_text(const struct render_outcome *outcome) {
  const struct render_options *options = outcome->options;
  const cellist_pipeline_stats *stats = &outcome->stats;
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(cellist_pipeline_mesh(outcome->pipeline));
  const cellist_scalar *scalar = cellist_pipeline_scalar(outcome->pipeline);
  FILE *to = stdout;
  for (size_t i = 0; i < options->outputs.count; i++) {
    if (strcmp(options->outputs.value[i], "-") == 0)
      to = stderr;
    else if (options->turntable == 0)
      fprintf(to, "wrote %s\n", options->outputs.value[i]);
    else
      fprintf(to, "wrote %s, %u pictures\n", options->outputs.value[i], options->turntable);
  }
  fprintf(to, "%s: %zu tets, scalar %s (%s) from %g to %g, unit distance %g (%s)\n", outcome->mesh_name,
          arrays->tet_count, scalar->name, scalar->association == CELLIST_ON_POINTS ? "points" : "cells",
          scalar->minimum, scalar->maximum, stats->unit_distance, stats->convention);
  fprintf(to, "drawn by %s (%s, %s precision, context %s), order: %s, %ux%u pixels, %llu segments\n", stats->renderer,
          stats->method, stats->precision, stats->backend, stats->order, options->size[0], options->size[1],
          (unsigned long long)stats->fragments);
  fprintf(to, "renderer: %s (%s)\n", stats->renderer, stats->renderer_reason);
  if (stats->exterior != NULL)
    fprintf(to, "exterior: %s, %zu imaginary cells (%s)\n", stats->exterior, stats->imaginary_cells,
            stats->exterior_reason);
  fprintf(to, "seconds: load %.3f, convexify %.3f, sort %.4f, draw %.4f, total %.3f\n", stats->load_seconds,
          stats->convexify_seconds, outcome->sort, outcome->draw, outcome->total);
  if (stats->budget.name != NULL)
    fprintf(to, "chosen: %s, expected root mean square error %.1e, expected seconds a frame %.2g\n", stats->budget.name,
            stats->budget.error, stats->budget.seconds);
  if (outcome->full != NULL) explain(to, outcome);
  return terminal_finish();
}
