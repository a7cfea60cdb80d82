/* SPDX-License-Identifier: BSD-3-Clause
 * Charts: error against seconds a frame, one SVG a mesh, drawn by gnuplot. Points are told apart by shape and by the
 * number of their row in the table, so the chart reads without colour; the Pareto front is a stepped line. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

/* Logarithms need a floor: differences below rounding of single precision are drawn here. */
static const double LEAST_ERROR = 1e-9;

/* Of a number of two digits, in decades. */
static const double LABEL_WIDTH = 0.12, LABEL_HEIGHT = 0.35;

cellist_result report_check_gnuplot(cellist_context *context) {
  if (system("gnuplot --version >/dev/null 2>&1") == 0) return CELLIST_SUCCESS;
  return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED,
                      "the charts need gnuplot (Debian: gnuplot-nox), which is not installed");
}

struct point {
  size_t number;
  double seconds, rmse;
  bool pareto, is_labelled;
};

static int by_seconds(const void *a, const void *b) {
  const double x = ((const struct point *)a)->seconds, y = ((const struct point *)b)->seconds;
  return (x > y) - (x < y);
}

/* One family of points: those of a mesh's rows that `lit` tells. Returns their number. */
static size_t gather(const report_run *report, size_t mesh, bool lit, struct point *points) {
  size_t count = 0;
  for (size_t i = 0; i < report->row_count; i++) {
    const report_row *row = &report->rows[i];
    if (row->mesh != mesh || !row->drawn || (report_setting_at(row->setting)->samples > 0) != lit) continue;
    points[count++] = (struct point){row->setting + 1, fmax(row->sort_seconds + row->draw_seconds, 1e-5),
                                     fmax(row->error.rmse, LEAST_ERROR), row->pareto, false};
  }
  qsort(points, count, sizeof *points, by_seconds);
  return count;
}

/* Labels that would cover each other are one. */
static bool share_label(const struct point *a, const struct point *b) {
  return fabs(log10(a->seconds / b->seconds)) < LABEL_WIDTH && fabs(log10(a->rmse / b->rmse)) < LABEL_HEIGHT;
}

/* Lines "seconds rmse label"; points without a label of their own have an empty one. */
static void write_points(FILE *script, const char *name, struct point *points, size_t count, bool front) {
  fprintf(script, "$%s << end\n", name);
  for (size_t i = 0; i < count; i++) points[i].is_labelled = false;
  for (size_t i = 0; i < count; i++) {
    if (front && !points[i].pareto) continue;
    fprintf(script, "%.6g %.6g \"", points[i].seconds, points[i].rmse);
    const char *separator = "";
    for (size_t k = i; k < count && !points[i].is_labelled; k++) {
      if (k > i && (points[k].is_labelled || !share_label(&points[i], &points[k]))) continue;
      fprintf(script, "%s%zu", separator, points[k].number);
      separator = ",";
      if (k > i) points[k].is_labelled = true;
    }
    fprintf(script, "\"\n");
  }
  fprintf(script, "end\n");
}

static size_t write_peers(FILE *script, const report_run *report, const char *mesh) {
  size_t count = 0;
  fprintf(script, "$peers << end\n");
  for (size_t i = 0; i < report->peer_count; i++) {
    if (strcmp(report->peers[i].mesh, mesh) != 0) continue;
    fprintf(script, "%.6g %.6g \"", report->peers[i].seconds, fmax(report->peers[i].rmse, LEAST_ERROR));
    for (const char *c = report->peers[i].name; *c != '\0'; c++)
      if (*c != '"' && *c != '\\') fputc(*c, script);
    fprintf(script, "\"\n");
    count++;
  }
  fprintf(script, "end\n");
  return count;
}

static void write_script(FILE *script, const report_run *report, size_t mesh, const char *name, struct point *points) {
  fprintf(script,
          "set terminal svg size 760,460 dynamic font 'sans-serif,12'\n"
          "set output 'charts/%s.svg'\n"
          "set logscale xy\nset format y '%%.0e'\nset grid\nset key outside right top\n"
          "set xlabel 'seconds a frame (sort + draw)'\nset ylabel 'root mean square error'\n"
          "set title '%s' noenhanced\nset offsets graph 0.08, graph 0.08, graph 0.08, graph 0.08\n",
          name, name);
  size_t count[2];
  for (int lit = 0; lit < 2; lit++) {
    count[lit] = gather(report, mesh, lit == 1, points);
    write_points(script, lit ? "lit" : "unlit", points, count[lit], false);
    write_points(script, lit ? "lit_front" : "unlit_front", points, count[lit], true);
  }
  const size_t peer_count = write_peers(script, report, name);
  const char *separator = "plot ";
  for (int lit = 0; lit < 2; lit++) {
    const char *family = lit ? "lit" : "unlit";
    if (count[lit] == 0) continue;
    fprintf(script,
            "%s$%s_front using 1:2 with steps dashtype %d linewidth 1.5 linecolor 'black' title '%s: Pareto front', "
            "$%s using 1:2 with points pointtype %d pointsize 0.9 linecolor 'black' title '%s', "
            "$%s using 1:2:3 with labels offset 0.9,0.6 notitle",
            separator, family, lit ? 3 : 1, family, family, lit ? 6 : 7, family, family);
    separator = ", ";
  }
  if (peer_count > 0)
    fprintf(script,
            "%s$peers using 1:2 with points pointtype 2 pointsize 1 linecolor 'black' title 'measured elsewhere', "
            "$peers using 1:2:3 with labels offset 0,-0.9 noenhanced notitle",
            separator);
  fprintf(script, "\n");
}

static bool has_points(const report_run *report, size_t mesh) {
  for (size_t i = 0; i < report->row_count; i++)
    if (report->rows[i].mesh == mesh && report->rows[i].drawn) return true;
  return false;
}

cellist_result report_write_charts(cellist_context *context, const report_run *report) {
  char path[4096], name[128];
  report_path(report, path, "charts.gp");
  struct point *points = calloc(report->row_count + 1, sizeof *points);
  FILE *script = fopen(path, "w");
  if (points == NULL || script == NULL) {
    free(points);
    if (script != NULL) fclose(script);
    return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
  }
  for (size_t i = 0; i < report->mesh_count; i++) {
    if (!has_points(report, i)) continue;
    report_short_name(report->meshes[i], name);
    fprintf(script, "reset\n");
    write_script(script, report, i, name, points);
  }
  free(points);
  const bool failed = ferror(script) != 0;
  if (fclose(script) != 0 || failed)
    return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
  /* The folder's name goes through the environment: no shell has to quote it. */
  if (setenv("CELLIST_REPORT_DIRECTORY", report->options->directory, 1) != 0 ||
      system("cd -- \"$CELLIST_REPORT_DIRECTORY\" && gnuplot charts.gp >gnuplot.log 2>&1") != 0)
    return cellist_fail(context, CELLIST_ERROR_IO, "gnuplot failed; see gnuplot.log in %s", report->options->directory);
  report_path(report, path, "gnuplot.log");
  remove(path);
  return CELLIST_SUCCESS;
}
