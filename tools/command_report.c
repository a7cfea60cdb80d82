/* SPDX-License-Identifier: BSD-3-Clause
 * cellist report: error against run time, for meshes and settings, as HTML, CSV and JSON. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "command.h"
#include "options.h"
#include "report/report.h"
#include "terminal.h"

/* What is reported on when no mesh is named: scenes that anybody has. */
static char *const SAMPLES[] = {"sample:gears", "sample:ball:100000", "sample:torus", "sample:swiss-cheese"};

static cellist_result make_folder(cellist_context *context, const report_run *report, const char *name) {
  char path[4096];
  report_path(report, path, "%s", name);
  if (mkdir(path, 0777) == 0 || errno == EEXIST) return CELLIST_SUCCESS;
  return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be made: %s", path, strerror(errno));
}

static cellist_result write_json(cellist_context *context, const report_run *report, json_t *stability) {
  char path[4096];
  report_path(report, path, "report.json");
  json_t *object = report_to_json(report);
  if (object != NULL && stability != NULL) json_object_set(object, "stability", stability);
  const bool failed = object == NULL || json_dump_file(object, path, JSON_REAL_PRECISION(17) | JSON_INDENT(1)) != 0;
  json_decref(object);
  return failed ? cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written", path) : CELLIST_SUCCESS;
}

static cellist_result make_report(cellist_context *context, report_run *report) {
  static const char *const folders[] = {"", "pictures", "charts"};
  json_t *stability = NULL;
  cellist_result result = report_check_gnuplot(context);
  if (result == CELLIST_SUCCESS) result = report_read_peers(context, report);
  for (size_t i = 0; i < 3 && result == CELLIST_SUCCESS; i++) result = make_folder(context, report, folders[i]);
  if (result == CELLIST_SUCCESS) result = report_rows_resume(context, report);
  for (size_t i = 0; i < report->mesh_count && result == CELLIST_SUCCESS; i++)
    result = report_measure(context, report, i);
  if (result == CELLIST_SUCCESS && report->options->stability) result = report_stability(context, &stability);
  report_mark_pareto(report);
  if (result == CELLIST_SUCCESS) result = report_write_csv(context, report);
  if (result == CELLIST_SUCCESS) result = write_json(context, report, stability);
  if (result == CELLIST_SUCCESS) result = report_write_charts(context, report);
  if (result == CELLIST_SUCCESS) result = report_write_html(context, report, stability);
  if (result == CELLIST_SUCCESS) report_rows_finish(report);
  json_decref(stability);
  return result;
}

static int say_done(const report_run *report) {
  size_t drawn = 0;
  for (size_t i = 0; i < report->row_count; i++) drawn += report->rows[i].drawn;
  if (report->options->json)
    return terminal_print_json(json_pack("{s:o, s:I, s:I, s:I}", "directory", terminal_text(report->options->directory),
                                         "meshes", (json_int_t)report->mesh_count, "rows",
                                         (json_int_t)report->row_count, "drawn", (json_int_t)drawn));
  terminal_clear_progress();
  printf("wrote %s/report.html, .csv, .json: %zu meshes, %zu pictures, %zu settings that this build does not draw\n",
         report->options->directory, report->mesh_count, drawn, report->row_count - drawn);
  return terminal_finish();
}

int command_report(int argc, char **argv) {
  report_options options = {.size = {512, 512}, .frames = 3};
  const option_spec table[] = {
      {"o", "DIR", "where to; made if it is not there. A run that was stopped goes on where it was", OPTION_TEXT,
       &options.directory},
      {"size", "WxH", "pixels (512x512)", OPTION_SIZE, options.size},
      {"frames", "N", "frames whose median time counts (3)", OPTION_COUNT, &options.frames},
      {"threads", "N", "threads to use (one per processor)", OPTION_COUNT, &options.threads},
      {"peer", "FILE.csv", "figures of other programs for the charts: columns mesh, name, seconds, rmse", OPTION_TEXT,
       &options.peers},
      {"stability", "", "also run the suite of stiff and extreme scenes, and show its table", OPTION_FLAG,
       &options.stability},
      {"json", "", "print what was done as one JSON object", OPTION_FLAG, &options.json},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  static const char *const examples[] = {"cellist report mesh.vtu -o report", "cellist report -o report",
                                         "cellist report a.vtu b.vtu -o report --size 1024x1024 --peer vtk.csv", NULL};
  const command_usage usage = {"report",
                               "[MESH...] -o DIR",
                               "Draws meshes (default: some samples) by every renderer and setting, one factor varied "
                               "at a time, and shows error\n"
                               "against run time: report.html, report.csv, report.json.",
                               0,
                               1000,
                               examples,
                               {table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);
  if (options.directory == NULL) return wrong_usage("report", "-o DIR is missing");
  cellist_context *context = terminal_context(options.threads);
  if (context == NULL) return 1;
  report_run report = {.options = &options, .machine = report_machine()};
  report.meshes = positional > 0 ? argv + 1 : (char **)SAMPLES;
  report.mesh_count = positional > 0 ? positional : sizeof SAMPLES / sizeof SAMPLES[0];
  const cellist_result result = make_report(context, &report);
  const int status = result == CELLIST_SUCCESS ? say_done(&report) : terminal_failure(context, result);
  free(report.rows);
  free(report.peers);
  json_decref(report.machine);
  cellist_context_destroy(context);
  return status;
}
