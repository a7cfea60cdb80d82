/* SPDX-License-Identifier: BSD-3-Clause
 * HTML: one page that holds everything: figures, charts (SVG, in line) and small pictures (PNG, base64). The full-size
 * pictures stand beside it. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

static const char STYLE[] =
    "body{font:15px/1.45 sans-serif;max-width:1180px;margin:2em auto;padding:0 1em;color:#111;background:#fff}"
    "table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums}"
    "th,td{padding:.2em .6em;border-bottom:1px solid #ccc;text-align:right}"
    "th:nth-child(2),td:nth-child(2),th.l,td.l{text-align:left}"
    "tr.pareto td{font-weight:bold}figure{display:inline-block;margin:.4em;vertical-align:top;width:300px}"
    "figcaption{font-size:12px}figure img{border:1px solid #ddd;background:#fff}svg{max-width:100%;height:auto}";

static void write_text(FILE *html, const char *text) {
  for (; *text != '\0'; text++) {
    switch (*text) {
      case '<': fputs("&lt;", html); break;
      case '>': fputs("&gt;", html); break;
      case '&': fputs("&amp;", html); break;
      case '"': fputs("&quot;", html); break;
      default: fputc(*text, html);
    }
  }
}

static void write_base64(FILE *html, FILE *file) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  unsigned char in[3];
  for (size_t count; (count = fread(in, 1, 3, file)) > 0;) {
    const unsigned bits = (unsigned)in[0] << 16 | (count > 1 ? (unsigned)in[1] << 8 : 0) | (count > 2 ? in[2] : 0);
    const char out[4] = {digits[bits >> 18], digits[bits >> 12 & 63], count > 1 ? digits[bits >> 6 & 63] : '=',
                         count > 2 ? digits[bits & 63] : '='};
    fwrite(out, 1, 4, html);
  }
}

static void write_picture(FILE *html, const report_run *report, const char *name, size_t setting, const char *kind) {
  char path[4096];
  report_path(report, path, "pictures/%s-%02zu%s-small.png", name, setting, kind);
  FILE *file = fopen(path, "rb");
  if (file == NULL) return;
  fprintf(html, "<a href=\"pictures/%s-%02zu%s.png\"><img alt=\"%s\" src=\"data:image/png;base64,", name, setting, kind,
          kind[0] != '\0' ? "difference" : "picture");
  write_base64(html, file);
  fprintf(html, "\"></a>");
  fclose(file);
}

static void write_chart(FILE *html, const report_run *report, const char *name) {
  char path[4096], line[4096];
  report_path(report, path, "charts/%s.svg", name);
  FILE *file = fopen(path, "r");
  if (file == NULL) return;
  bool is_inside = false; /* from <svg on: a page has no XML head in its middle */
  while (fgets(line, sizeof line, file) != NULL) {
    if (!is_inside && strncmp(line, "<svg", 4) == 0) is_inside = true;
    if (is_inside) fputs(line, html);
  }
  fclose(file);
}

static const report_row *row_of(const report_run *report, size_t mesh, size_t setting) {
  for (size_t i = 0; i < report->row_count; i++)
    if (report->rows[i].mesh == mesh && report->rows[i].setting == setting) return &report->rows[i];
  return NULL;
}

static void write_row(FILE *html, const report_row *row) {
  const report_setting *setting = report_setting_at(row->setting);
  if (!row->drawn) {
    fprintf(html, "<tr><td>%zu</td><td>%s</td><td class=l>%s</td><td class=l colspan=9>", row->setting + 1,
            setting->name, setting->factor);
    write_text(html, row->message);
    fprintf(html, "</td></tr>\n");
    return;
  }
  fprintf(html,
          "<tr%s><td>%zu</td><td>%s</td><td "
          "class=l>%s</td><td>%.1f</td><td>%.1f</td><td>%.1f</td><td>%.1f</td><td>%.2f</td>"
          "<td class=l>%s</td><td>%.2e</td><td>%.2e</td><td>%.6f</td></tr>\n",
          row->pareto ? " class=pareto" : "", row->setting + 1, setting->name, setting->factor,
          1e3 * row->convexify_seconds, 1e3 * row->prepare_seconds, 1e3 * row->sort_seconds, 1e3 * row->draw_seconds,
          (double)row->fragments * 1e-6, row->order, row->error.rmse, row->error.max_abs, row->error.ssim);
}

static void write_mesh(FILE *html, const report_run *report, size_t mesh) {
  char name[128];
  report_short_name(report->meshes[mesh], name);
  fprintf(html, "<h2 id=\"%s\">", name);
  write_text(html, report->meshes[mesh]);
  fprintf(html, "</h2>\n");
  write_chart(html, report, name);
  fprintf(html,
          "<table><thead><tr><th>no.</th><th>setting</th><th class=l>varied</th><th>convexify ms</th><th>prepare ms"
          "</th><th>sort ms</th><th>draw ms</th><th>M fragments</th><th class=l>order</th><th>rmse</th><th>max</th>"
          "<th>ssim</th></tr></thead><tbody>\n");
  for (size_t i = 0; report_setting_at(i) != NULL; i++) {
    const report_row *row = row_of(report, mesh, i);
    if (row != NULL) write_row(html, row);
  }
  fprintf(html, "</tbody></table>\n");
  for (size_t i = 0; report_setting_at(i) != NULL; i++) {
    const report_row *row = row_of(report, mesh, i);
    if (row == NULL || !row->drawn) continue;
    fprintf(html, "<figure>");
    write_picture(html, report, name, i, "");
    write_picture(html, report, name, i, "-difference");
    fprintf(html, "<figcaption>%zu %s; difference, white: %.1e</figcaption></figure>\n", i + 1,
            report_setting_at(i)->name, row->error.max_abs);
  }
}

static void write_value(FILE *html, const json_t *value) {
  if (json_is_string(value))
    write_text(html, json_string_value(value));
  else if (json_is_integer(value))
    fprintf(html, "%lld", (long long)json_integer_value(value));
  else if (json_is_real(value))
    fprintf(html, "%.4g", json_real_value(value));
  else if (json_is_boolean(value))
    fprintf(html, json_is_true(value) ? "yes" : "no");
}

/* An object as two columns. */
static void write_object(FILE *html, json_t *object) {
  const char *key;
  json_t *value;
  fprintf(html, "<table>\n");
  json_object_foreach(object, key, value) {
    fprintf(html, "<tr><td class=l>%s</td><td class=l>", key);
    write_value(html, value);
    fprintf(html, "</td></tr>\n");
  }
  fprintf(html, "</table>\n");
}

/* An array of like objects: their keys are the head. */
static void write_array(FILE *html, const json_t *rows) {
  const char *key;
  json_t *value, *row;
  size_t i;
  fprintf(html, "<table>\n");
  json_array_foreach(rows, i, row) {
    if (i == 0) {
      fprintf(html, "<tr>");
      json_object_foreach(row, key, value) fprintf(html, "<th class=l>%s</th>", key);
      fprintf(html, "</tr>\n");
    }
    fprintf(html, "<tr>");
    json_object_foreach(row, key, value) {
      fprintf(html, "<td class=l>");
      write_value(html, value);
      fprintf(html, "</td>");
    }
    fprintf(html, "</tr>\n");
  }
  fprintf(html, "</table>\n");
}

cellist_result report_write_html(cellist_context *context, const report_run *report, const json_t *stability) {
  char path[4096];
  report_path(report, path, "report.html");
  FILE *html = fopen(path, "w");
  if (html == NULL) return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
  fprintf(
      html,
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Cellist: error against run time</title>"
      "<style>%s</style></head><body>\n<h1>Error against run time</h1>\n"
      "<p>Pictures of %ux%u pixels, from azimuth %g and elevation %g degrees, transfer function ramp at unit "
      "distance diagonal/50. The truth is the double-precision ray caster, unlit for the unlit settings and lit "
      "exactly for the lit ones (" REPORT_LIGHT
      "); errors are over covered pixels, linear premultiplied RGBA. Times "
      "are medians of %u frames from places half a degree apart, after a first one that is not counted. One factor is "
      "varied at a time. Bold rows are on the Pareto front: no other setting is both faster and closer. In the charts "
      "numbers are the rows of the table, filled points are unlit, open ones lit; errors below 1e-9 stand at 1e-9. "
      "Differences are scaled so that the largest is white.</p>\n",
      STYLE, report->options->size[0], report->options->size[1], CELLIST_VIEW_AZIMUTH, CELLIST_VIEW_ELEVATION,
      report->options->frames);
  write_object(html, report->machine);
  fprintf(html, "<ul>\n");
  char name[128];
  for (size_t i = 0; i < report->mesh_count; i++) {
    report_short_name(report->meshes[i], name);
    fprintf(html, "<li><a href=\"#%s\">%s</a></li>\n", name, name);
  }
  if (stability != NULL) fprintf(html, "<li><a href=\"#stability\">stability</a></li>\n");
  fprintf(html, "</ul>\n");
  for (size_t i = 0; i < report->mesh_count; i++) write_mesh(html, report, i);
  if (stability != NULL) {
    fprintf(html,
            "<h2 id=\"stability\">Stability</h2>\n<p>Stiff and extreme scenes, each with what must happen.</p>\n");
    write_array(html, stability);
  }
  fprintf(html, "</body></html>\n");
  const bool failed = ferror(html) != 0;
  if (fclose(html) != 0 || failed)
    return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
  return CELLIST_SUCCESS;
}
