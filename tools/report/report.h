/* SPDX-License-Identifier: BSD-3-Clause
 * Report: error against run time, for meshes and settings. Private to tools/.
 *
 * For each mesh one picture by the double-precision reference caster, unlit and lit, is the truth; every setting is
 * drawn, timed and compared with it. Settings vary one factor at a time around a default. */
#ifndef CELLIST_TOOLS_REPORT_H
#define CELLIST_TOOLS_REPORT_H

#include <cellist/compare.h>
#include <cellist/pipeline.h>
#include <jansson.h>

/* One way to draw. */
typedef struct report_setting {
  const char *factor; /* what is varied here */
  const char *name;   /* unique */
  cellist_renderer renderer;
  cellist_precision precision;
  cellist_integration integration;
  uint32_t table_size[2];
  uint32_t samples; /* 0: unlit */
  cellist_framebuffer framebuffer;
  unsigned threads; /* 0: as the command was asked */
  cellist_sorting sorting;
} report_setting;

/* The light of lit settings, in words. */
#define REPORT_LIGHT "headlight, ambient 0.35, diffuse 0.65, highlight 0.2 with exponent 20"

/* Setting i, or NULL from the last one on. */
const report_setting *report_setting_at(size_t i);

/* Fills in what a setting says. */
void report_setting_apply(const report_setting *setting, cellist_pipeline_desc *desc);

/* Words for the files. */
const char *report_renderer_name(const report_setting *setting);
const char *report_integration_name(const report_setting *setting, char text[32]);
const char *report_framebuffer_name(const report_setting *setting);
const char *report_sorting_name(const report_setting *setting);

/* What one setting gave on one mesh. */
typedef struct report_row {
  size_t mesh, setting; /* indices */
  bool drawn;
  char message[200]; /* why it was not drawn, else "" */
  size_t tets;
  double convexify_seconds, prepare_seconds, sort_seconds, draw_seconds; /* medians over frames */
  uint64_t fragments;
  char order[16];
  cellist_image_error error;
  bool pareto; /* no other picture of its mesh and light is both faster and closer */
} report_row;

/* What another program reached, measured elsewhere: points in the charts. */
typedef struct report_peer {
  char mesh[128], name[64];
  double seconds, rmse;
} report_peer;

typedef struct report_options {
  const char *directory, *peers;
  unsigned size[2], frames, threads;
  bool json, stability;
} report_options;

/* A whole report. Zeroed, then filled; arrays are malloc's. */
typedef struct report_run {
  const report_options *options;
  size_t mesh_count;
  char **meshes; /* as named on the command line */
  size_t row_count;
  report_row *rows;
  size_t peer_count;
  report_peer *peers;
  json_t *machine; /* processor, system, compiler, versions */
} report_run;

/* A mesh's name without folder and ending, fit for a file name. */
void report_short_name(const char *mesh, char name[128]);

/* DIRECTORY/FILE. */
void report_path(const report_run *report, char path[4096], const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* measure.c: draws every setting of mesh i that has no row yet, and keeps each row as soon as it is there.
 * Errors: the mesh's, the reference's, IO; a setting that cannot be drawn is a row with a message. */
cellist_result report_measure(cellist_context *context, report_run *report, size_t mesh);

/* rows.c: rows kept on disk while a report is made, so that it can be resumed; and what the finished one is in.
 * _resume reads the rows of an earlier run of the same version, options and files, if there are any. */
cellist_result report_rows_resume(cellist_context *context, report_run *report);
cellist_result report_rows_add(cellist_context *context, report_run *report, const report_row *row);
void report_rows_finish(const report_run *report);
void report_mark_pareto(report_run *report);
json_t *report_to_json(const report_run *report);
cellist_result report_write_csv(cellist_context *context, const report_run *report);

/* peers.c: a CSV with a head that has the columns mesh, name, seconds, rmse. Errors: IO, FORMAT with the line. */
cellist_result report_read_peers(cellist_context *context, report_run *report);

/* machine.c: never fails; what is not known is not said. The caller's, for json_decref. */
json_t *report_machine(void);

/* charts.c: error against seconds, an SVG a mesh, by gnuplot. Errors: UNSUPPORTED (no gnuplot), IO. */
cellist_result report_check_gnuplot(cellist_context *context);
cellist_result report_write_charts(cellist_context *context, const report_run *report);

/* stability_page.c: runs the stability suite. *rows: one object a case and renderer, or order; the caller's.
 * Errors: those of building scenes; what a renderer cannot do is a verdict. */
cellist_result report_stability(cellist_context *context, json_t **rows);

/* html.c: one page that holds everything. stability may be NULL: the table of the stability suite. */
cellist_result report_write_html(cellist_context *context, const report_run *report, const json_t *stability);

#endif
