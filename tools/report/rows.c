/* SPDX-License-Identifier: BSD-3-Clause
 * Rows: what a report has measured. While it is made, each row is a line of JSON in DIRECTORY/report.rows, after one
 * that says for which files and options they hold; a run that was stopped goes on after the last whole line. */
#include <cellist/version.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "../terminal.h"
#include "report.h"

void report_path(const report_run *report, char path[4096], const char *format, ...) {
  const int length = snprintf(path, 4096, "%s/", report->options->directory);
  if (length < 0 || length >= 4096) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(path + length, 4096 - (size_t)length, format, arguments);
  va_end(arguments);
}

void report_short_name(const char *mesh, char name[128]) {
  const char *slash = strrchr(mesh, '/');
  snprintf(name, 128, "%s", slash != NULL ? slash + 1 : mesh);
  char *dot = strrchr(name, '.');
  if (dot != NULL && dot != name) *dot = '\0';
  for (char *c = name; *c != '\0'; c++)
    if ((*c < 'a' || *c > 'z') && (*c < 'A' || *c > 'Z') && (*c < '0' || *c > '9')) *c = '_';
}

/* What rows must agree on to be used again: a mesh file is the same if size and time of change are. */
static json_t *key_of(const report_run *report) {
  json_t *meshes = json_array();
  for (size_t i = 0; i < report->mesh_count; i++) {
    struct stat file = {0};
    const bool is_file = stat(report->meshes[i], &file) == 0;
    json_array_append_new(
        meshes, json_pack("[o, I, I]", terminal_text(report->meshes[i]), (json_int_t)(is_file ? file.st_size : 0),
                          (json_int_t)(is_file ? file.st_mtime : 0)));
  }
  const report_options *options = report->options;
  return json_pack("{s:s, s:i, s:i, s:i, s:i, s:o}", "version", CELLIST_VERSION_STRING, "width", (int)options->size[0],
                   "height", (int)options->size[1], "frames", (int)options->frames, "threads", (int)options->threads,
                   "meshes", meshes);
}

static json_t *row_to_json(const report_run *report, const report_row *row) {
  const report_setting *setting = report_setting_at(row->setting);
  char integration[32], name[128];
  report_short_name(report->meshes[row->mesh], name);
  json_t *object =
      json_pack("{s:I, s:I, s:s, s:s, s:s, s:s, s:s, s:i, s:s, s:i, s:s, s:b, s:o}", "mesh_index",
                (json_int_t)row->mesh, "setting_index", (json_int_t)row->setting, "mesh", name, "factor",
                setting->factor, "setting", setting->name, "renderer", report_renderer_name(setting), "integration",
                report_integration_name(setting, integration), "samples", (int)setting->samples, "framebuffer",
                report_framebuffer_name(setting), "threads", (int)setting->threads, "sorting",
                report_sorting_name(setting), "drawn", (int)row->drawn, "message", terminal_text(row->message));
  if (!row->drawn || object == NULL) return object;
  json_t *seconds =
      json_pack("{s:f, s:f, s:f, s:f, s:f}", "convexify", row->convexify_seconds, "prepare", row->prepare_seconds,
                "sort", row->sort_seconds, "draw", row->draw_seconds, "frame", row->sort_seconds + row->draw_seconds);
  json_object_set_new(object, "tets", json_integer((json_int_t)row->tets));
  json_object_set_new(object, "seconds", seconds);
  json_object_set_new(object, "fragments", json_integer((json_int_t)row->fragments));
  json_object_set_new(object, "order", json_string(row->order));
  json_object_set_new(object, "covered_pixels", json_integer((json_int_t)row->error.covered_pixels));
  json_object_set_new(object, "rmse", json_real(row->error.rmse));
  json_object_set_new(object, "max_abs", json_real(row->error.max_abs));
  json_object_set_new(object, "psnr", terminal_number(row->error.psnr));
  json_object_set_new(object, "ssim", json_real(row->error.ssim));
  json_object_set_new(object, "pixels_over_2_255", json_real(row->error.pixels_over_2_255));
  json_object_set_new(object, "pareto", json_boolean(row->pareto));
  return object;
}

static double number_of(const json_t *object, const char *name) {
  const json_t *value = json_object_get(object, name);
  return json_is_number(value) ? json_number_value(value) : INFINITY; /* null stands for infinity */
}

/* False if the line is not a row of this report. */
static bool row_from_json(const report_run *report, const json_t *object, report_row *row) {
  json_int_t mesh = -1, setting = -1;
  const char *message = NULL;
  int drawn = 0;
  if (json_unpack((json_t *)object, "{s:I, s:I, s:b, s:s}", "mesh_index", &mesh, "setting_index", &setting, "drawn",
                  &drawn, "message", &message) != 0 ||
      mesh < 0 || (size_t)mesh >= report->mesh_count || setting < 0 || report_setting_at((size_t)setting) == NULL)
    return false;
  *row = (report_row){.mesh = (size_t)mesh, .setting = (size_t)setting, .drawn = drawn != 0};
  snprintf(row->message, sizeof row->message, "%s", message);
  if (!row->drawn) return true;
  const json_t *seconds = json_object_get(object, "seconds");
  const char *order = json_string_value(json_object_get(object, "order"));
  snprintf(row->order, sizeof row->order, "%s", order != NULL ? order : "");
  row->tets = (size_t)json_integer_value(json_object_get(object, "tets"));
  row->fragments = (uint64_t)json_integer_value(json_object_get(object, "fragments"));
  row->convexify_seconds = number_of(seconds, "convexify");
  row->prepare_seconds = number_of(seconds, "prepare");
  row->sort_seconds = number_of(seconds, "sort");
  row->draw_seconds = number_of(seconds, "draw");
  row->error =
      (cellist_image_error){.covered_pixels = (size_t)json_integer_value(json_object_get(object, "covered_pixels")),
                            .rmse = number_of(object, "rmse"),
                            .max_abs = number_of(object, "max_abs"),
                            .psnr = number_of(object, "psnr"),
                            .ssim = number_of(object, "ssim"),
                            .pixels_over_2_255 = number_of(object, "pixels_over_2_255")};
  return true;
}

static bool keep(report_run *report, const report_row *row) {
  report_row *grown = realloc(report->rows, (report->row_count + 1) * sizeof *grown);
  if (grown == NULL) return false;
  grown[report->row_count++] = *row;
  report->rows = grown;
  return true;
}

static cellist_result append_line(cellist_context *context, const report_run *report, const json_t *object,
                                  const char *mode) {
  char path[4096];
  report_path(report, path, "report.rows");
  FILE *file = fopen(path, mode);
  char *text = json_dumps(object, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
  const bool failed = file == NULL || text == NULL || fprintf(file, "%s\n", text) < 0;
  free(text);
  if ((file != NULL && fclose(file) != 0) || failed)
    return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
  return CELLIST_SUCCESS;
}

cellist_result report_rows_resume(cellist_context *context, report_run *report) {
  char path[4096], *line = NULL;
  size_t capacity = 0, number = 0;
  report_path(report, path, "report.rows");
  json_t *key = key_of(report);
  FILE *file = fopen(path, "r");
  bool is_ours = false;
  while (file != NULL && getline(&line, &capacity, file) > 0) {
    json_t *object = json_loads(line, 0, NULL);
    report_row row;
    if (number++ == 0)
      is_ours = json_equal(object, key);
    else if (is_ours && object != NULL && row_from_json(report, object, &row))
      keep(report, &row);
    json_decref(object);
    if (!is_ours) break;
  }
  free(line);
  if (file != NULL) fclose(file);
  /* Written anew, so that a line that was cut goes. */
  cellist_result result = append_line(context, report, key, "w");
  for (size_t i = 0; i < report->row_count && result == CELLIST_SUCCESS; i++) {
    json_t *object = row_to_json(report, &report->rows[i]);
    result = append_line(context, report, object, "a");
    json_decref(object);
  }
  json_decref(key);
  return result;
}

cellist_result report_rows_add(cellist_context *context, report_run *report, const report_row *row) {
  if (!keep(report, row)) return CELLIST_ERROR_OUT_OF_MEMORY;
  json_t *object = row_to_json(report, row);
  const cellist_result result = append_line(context, report, object, "a");
  json_decref(object);
  return result;
}

void report_rows_finish(const report_run *report) {
  char path[4096];
  report_path(report, path, "report.rows");
  remove(path);
}

void report_mark_pareto(report_run *report) {
  for (size_t i = 0; i < report->row_count; i++) {
    report_row *row = &report->rows[i];
    const double seconds = row->sort_seconds + row->draw_seconds;
    const bool lit = report_setting_at(row->setting)->samples > 0;
    row->pareto = row->drawn;
    for (size_t k = 0; k < report->row_count && row->pareto; k++) {
      const report_row *other = &report->rows[k];
      const double others = other->sort_seconds + other->draw_seconds;
      if (k == i || !other->drawn || other->mesh != row->mesh ||
          (report_setting_at(other->setting)->samples > 0) != lit)
        continue;
      const bool is_better = others < seconds || other->error.rmse < row->error.rmse;
      if (others <= seconds && other->error.rmse <= row->error.rmse && (is_better || k < i)) row->pareto = false;
    }
  }
}

json_t *report_to_json(const report_run *report) {
  json_t *rows = json_array(), *meshes = json_array();
  for (size_t i = 0; i < report->row_count; i++) json_array_append_new(rows, row_to_json(report, &report->rows[i]));
  for (size_t i = 0; i < report->mesh_count; i++) json_array_append_new(meshes, terminal_text(report->meshes[i]));
  const report_options *options = report->options;
  return json_pack("{s:s, s:O, s:i, s:i, s:i, s:i, s:s, s:s, s:o, s:o}", "version", CELLIST_VERSION_STRING, "machine",
                   report->machine, "width", (int)options->size[0], "height", (int)options->size[1], "frames",
                   (int)options->frames, "threads", (int)options->threads, "view", "orbit 30.96,34.45", "optics",
                   "transfer ramp, unit diagonal/50; lit: " REPORT_LIGHT, "meshes", meshes, "rows", rows);
}

cellist_result report_write_csv(cellist_context *context, const report_run *report) {
  char path[4096], name[128], integration[32];
  report_path(report, path, "report.csv");
  FILE *file = fopen(path, "w");
  if (file == NULL) return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
  fprintf(file,
          "mesh,tets,factor,setting,renderer,integration,samples,framebuffer,threads,sorting,order,width,height,"
          "seconds_convexify,seconds_prepare,seconds_sort,seconds_draw,seconds_frame,fragments,rmse,max_abs,psnr,"
          "ssim,pixels_over_2_255,pareto,message\n");
  for (size_t i = 0; i < report->row_count; i++) {
    const report_row *row = &report->rows[i];
    const report_setting *setting = report_setting_at(row->setting);
    report_short_name(report->meshes[row->mesh], name);
    fprintf(file, "%s,%zu,%s,\"%s\",%s,%s,%u,%s,%u,%s,%s,%u,%u,", name, row->tets, setting->factor, setting->name,
            report_renderer_name(setting), report_integration_name(setting, integration), setting->samples,
            report_framebuffer_name(setting), setting->threads, report_sorting_name(setting), row->order,
            report->options->size[0], report->options->size[1]);
    if (row->drawn)
      fprintf(file, "%.6f,%.6f,%.6f,%.6f,%.6f,%llu,%.6e,%.6e,%.4f,%.8f,%.4f,%d,\n", row->convexify_seconds,
              row->prepare_seconds, row->sort_seconds, row->draw_seconds, row->sort_seconds + row->draw_seconds,
              (unsigned long long)row->fragments, row->error.rmse, row->error.max_abs, row->error.psnr, row->error.ssim,
              row->error.pixels_over_2_255, row->pareto);
    else {
      fprintf(file, ",,,,,,,,,,,0,\"");
      for (const char *c = row->message; *c != '\0'; c++) fprintf(file, *c == '"' ? "\"\"" : "%c", *c);
      fprintf(file, "\"\n");
    }
  }
  const bool failed = ferror(file) != 0;
  if (fclose(file) != 0 || failed)
    return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
  return CELLIST_SUCCESS;
}
