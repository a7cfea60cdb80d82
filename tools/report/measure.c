/* SPDX-License-Identifier: BSD-3-Clause
 * Measure: every setting on one mesh, timed and compared with the reference caster's picture. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../clock.h"
#include "../terminal.h"
#include "report.h"

/* A setting is not repeated once its frames have taken this long: slow ones are slow enough to be timed. */
static const double PATIENCE = 8;

enum { SMALL = 144, TRUTHS = 2 /* unlit, lit */ };

struct measurement {
  cellist_context *context;
  report_run *report;
  size_t mesh;
  char name[128];
  cellist_mesh *loaded;
  cellist_image *truth[TRUTHS];
};

static cellist_pipeline_desc scene_of(const struct measurement *m, const report_setting *setting) {
  cellist_pipeline_desc desc = {.mesh = m->loaded, .optics = {.unit_diagonal_fraction = 50}};
  report_setting_apply(setting, &desc);
  return desc;
}

/* The average of blocks of pixels: a picture for the page, at most SMALL wide and high. */
static cellist_result shrink(cellist_context *context, const cellist_image *image, cellist_image **small) {
  static const char *const channels[] = {"R", "G", "B", "A"};
  const uint32_t width = cellist_image_width(image), height = cellist_image_height(image);
  const uint32_t block = ((width > height ? width : height) + SMALL - 1) / SMALL;
  const uint32_t columns = (width + block - 1) / block, rows = (height + block - 1) / block;
  cellist_result result = cellist_image_create(context, columns, rows, channels, 4, small);
  for (size_t c = 0; c < 4 && result == CELLIST_SUCCESS; c++) {
    const float *from = cellist_image_channel(image, channels[c]);
    float *to = cellist_image_channel(*small, channels[c]);
    for (uint32_t y = 0; y < height; y++)
      for (uint32_t x = 0; x < width; x++)
        to[(size_t)(y / block) * columns + x / block] += from[(size_t)y * width + x] / (float)(block * block);
  }
  return result;
}

/* Scales a difference so that its largest value is 1, opaque, to be seen at all. */
static void stretch(cellist_image *difference, double largest) {
  static const char *const channels[] = {"R", "G", "B"};
  const size_t count = (size_t)cellist_image_width(difference) * cellist_image_height(difference);
  for (size_t c = 0; c < 3; c++) {
    float *plane = cellist_image_channel(difference, channels[c]);
    for (size_t i = 0; i < count && largest > 0; i++) plane[i] = (float)(plane[i] / largest);
  }
  float *alpha = cellist_image_channel(difference, "A");
  for (size_t i = 0; i < count; i++) alpha[i] = 1;
}

static cellist_result write_both(const struct measurement *m, const cellist_image *image, size_t setting,
                                 const char *kind) {
  static const double white[3] = {1, 1, 1};
  char path[4096];
  cellist_image *small = NULL;
  report_path(m->report, path, "pictures/%s-%02zu%s.png", m->name, setting, kind);
  cellist_result result = cellist_image_write(m->context, image, path, white);
  if (result == CELLIST_SUCCESS) result = shrink(m->context, image, &small);
  report_path(m->report, path, "pictures/%s-%02zu%s-small.png", m->name, setting, kind);
  if (result == CELLIST_SUCCESS) result = cellist_image_write(m->context, small, path, white);
  cellist_image_destroy(small);
  return result;
}

/* Draws until there are enough frames; fills in times and counts. Each is seen from another place, so that each is
 * sorted; the first one, which is kept, from where the truth is. */
static cellist_result draw_frames(const struct measurement *m, cellist_pipeline *pipeline, report_row *row,
                                  cellist_image **image) {
  const report_options *options = m->report->options;
  const double *bounds = cellist_mesh_get_arrays(m->loaded)->bounds;
  double *sort = calloc(options->frames, sizeof *sort), *draw = calloc(options->frames, sizeof *draw);
  cellist_pipeline_stats stats = {0};
  cellist_result result = sort != NULL && draw != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  const double begin = clock_seconds();
  size_t count = 0;
  bool is_done = false;
  for (unsigned i = 0; result == CELLIST_SUCCESS && !is_done; i++) {
    const cellist_view view = cellist_view_orbit(bounds, CELLIST_VIEW_AZIMUTH + 0.5 * i, CELLIST_VIEW_ELEVATION);
    cellist_image *frame = NULL;
    result = cellist_pipeline_draw(pipeline, &view, options->size[0], options->size[1], &frame, &stats);
    if (i == 0)
      *image = frame;
    else
      cellist_image_destroy(frame);
    /* The first of several frames compiles shaders and fills caches: it counts only if time runs out. */
    if (i == 1) count = 0;
    sort[count] = stats.sort_seconds;
    draw[count++] = stats.draw_seconds;
    is_done = i == (options->frames > 1 ? options->frames : 0) || clock_seconds() - begin > PATIENCE;
  }
  if (result == CELLIST_SUCCESS) {
    row->convexify_seconds = stats.convexify_seconds;
    row->prepare_seconds = stats.prepare_seconds;
    row->sort_seconds = terminal_median(sort, count);
    row->draw_seconds = terminal_median(draw, count);
    row->fragments = stats.fragments;
    snprintf(row->order, sizeof row->order, "%s", stats.order);
  }
  free(sort);
  free(draw);
  return result;
}

static cellist_result draw_setting(const struct measurement *m, cellist_context *context, const report_setting *setting,
                                   report_row *row, cellist_image **image) {
  const cellist_pipeline_desc desc = scene_of(m, setting);
  cellist_pipeline *pipeline = NULL;
  cellist_result result = cellist_pipeline_create(context, &desc, &pipeline);
  if (result == CELLIST_SUCCESS) result = draw_frames(m, pipeline, row, image);
  cellist_pipeline_destroy(pipeline);
  if (result != CELLIST_SUCCESS) {
    const char *message = cellist_context_take_error(context);
    snprintf(row->message, sizeof row->message, "%s", message[0] != '\0' ? message : cellist_result_string(result));
  }
  return result;
}

static cellist_result compare_and_write(const struct measurement *m, const cellist_image *image, report_row *row,
                                        const cellist_image *truth) {
  cellist_image *difference = NULL;
  cellist_result result = cellist_image_compare(m->context, image, truth, &row->error, &difference);
  if (result != CELLIST_SUCCESS) return result;
  row->drawn = true;
  stretch(difference, row->error.max_abs);
  result = write_both(m, image, row->setting, "");
  if (result == CELLIST_SUCCESS) result = write_both(m, difference, row->setting, "-difference");
  cellist_image_destroy(difference);
  return result;
}

/* The truth for this setting's light, drawn when first needed. */
static cellist_result truth_for(struct measurement *m, const report_setting *setting, const cellist_image **truth) {
  const bool lit = setting->samples > 0;
  if (m->truth[lit] == NULL) {
    const report_setting reference = {
        .renderer = CELLIST_RENDERER_CAST, .precision = CELLIST_PRECISION_REFERENCE, .samples = lit ? 1 : 0};
    const cellist_pipeline_desc desc = scene_of(m, &reference);
    cellist_pipeline *pipeline = NULL;
    cellist_result result = cellist_pipeline_create(m->context, &desc, &pipeline);
    if (result == CELLIST_SUCCESS)
      result = cellist_pipeline_draw(pipeline, NULL, m->report->options->size[0], m->report->options->size[1],
                                     &m->truth[lit], NULL);
    cellist_pipeline_destroy(pipeline);
    if (result != CELLIST_SUCCESS) return result;
  }
  *truth = m->truth[lit];
  return CELLIST_SUCCESS;
}

static cellist_result measure_setting(struct measurement *m, size_t index) {
  const report_setting *setting = report_setting_at(index);
  report_row row = {.mesh = m->mesh, .setting = index, .tets = cellist_mesh_get_arrays(m->loaded)->tet_count};
  const cellist_image *truth = NULL;
  cellist_result result = truth_for(m, setting, &truth);
  if (result != CELLIST_SUCCESS) return result;
  cellist_context *context = m->context;
  const bool has_own_context = setting->threads > 0;
  if (has_own_context && (context = terminal_context(setting->threads)) == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_image *image = NULL;
  result = draw_setting(m, context, setting, &row, &image);
  if (result == CELLIST_SUCCESS) result = compare_and_write(m, image, &row, truth);
  cellist_image_destroy(image);
  if (has_own_context) cellist_context_destroy(context);
  /* What a build or a renderer cannot do is part of the report; anything else ends it. */
  if (result != CELLIST_SUCCESS && result != CELLIST_ERROR_UNSUPPORTED && result != CELLIST_ERROR_GRAPHICS)
    return row.message[0] != '\0' ? cellist_fail(m->context, result, "%s, %s: %s", m->name, setting->name, row.message)
                                  : result;
  return report_rows_add(m->context, m->report, &row);
}

static bool has_row(const report_run *report, size_t mesh, size_t setting) {
  for (size_t i = 0; i < report->row_count; i++)
    if (report->rows[i].mesh == mesh && report->rows[i].setting == setting) return true;
  return false;
}

cellist_result report_measure(cellist_context *context, report_run *report, size_t mesh) {
  struct measurement m = {.context = context, .report = report, .mesh = mesh};
  report_short_name(report->meshes[mesh], m.name);
  size_t count = 0;
  while (report_setting_at(count) != NULL) count++;
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < count && result == CELLIST_SUCCESS; i++) {
    if (has_row(report, mesh, i)) continue;
    if (m.loaded == NULL) result = cellist_pipeline_load(context, report->meshes[mesh], NULL, &m.loaded);
    if (result == CELLIST_SUCCESS) result = measure_setting(&m, i);
    if (result == CELLIST_SUCCESS)
      result = cellist_progress(context, "measuring",
                                ((double)mesh + (double)i / (double)count) / (double)report->mesh_count);
  }
  for (size_t i = 0; i < TRUTHS; i++) cellist_image_destroy(m.truth[i]);
  cellist_mesh_destroy(m.loaded);
  return result;
}
