/* SPDX-License-Identifier: BSD-3-Clause
 * Settings: what a report draws. Around `faces` exact, unlit and lit with one sample, one factor is varied at a time.
 */
#include <stdio.h>
#include <string.h>

#include "report.h"

#define FACES .renderer = CELLIST_RENDERER_FACES
#define TABLE .integration = CELLIST_INTEGRATION_TABLE

static const report_setting SETTINGS[] = {
    {.factor = "renderer",
     .name = "cast reference",
     .renderer = CELLIST_RENDERER_CAST,
     .precision = CELLIST_PRECISION_REFERENCE},
    {.factor = "renderer", .name = "cast fast", .renderer = CELLIST_RENDERER_CAST},
    {.factor = "renderer", .name = "soft", .renderer = CELLIST_RENDERER_SOFT},
    {.factor = "renderer", .name = "faces", FACES},
    {.factor = "renderer", .name = "fan", .renderer = CELLIST_RENDERER_FAN},
    {.factor = "integration", .name = "faces psi", FACES, .integration = CELLIST_INTEGRATION_PSI},
    {.factor = "integration", .name = "faces table 32^3", FACES, TABLE, .table_size = {32, 32}},
    {.factor = "integration", .name = "faces table 64^3", FACES, TABLE, .table_size = {64, 64}},
    {.factor = "integration", .name = "faces table 128^3", FACES, TABLE, .table_size = {128, 128}},
    {.factor = "integration", .name = "faces table 128x128x256", FACES, TABLE, .table_size = {128, 256}},
    {.factor = "framebuffer", .name = "faces 16f", FACES, .framebuffer = CELLIST_FRAMEBUFFER_16F},
    {.factor = "framebuffer", .name = "faces 8", FACES, .framebuffer = CELLIST_FRAMEBUFFER_8},
    {.factor = "threads", .name = "cast fast, 1 thread", .renderer = CELLIST_RENDERER_CAST, .threads = 1},
    {.factor = "threads", .name = "soft, 1 thread", .renderer = CELLIST_RENDERER_SOFT, .threads = 1},
    {.factor = "threads", .name = "faces, 1 thread", FACES, .threads = 1},
    {.factor = "order",
     .name = "soft by centroids",
     .renderer = CELLIST_RENDERER_SOFT,
     .sorting = CELLIST_SORTING_CENTROID},
    {.factor = "order", .name = "soft unsorted", .renderer = CELLIST_RENDERER_SOFT, .sorting = CELLIST_SORTING_NONE},
    {.factor = "light",
     .name = "lit cast reference",
     .renderer = CELLIST_RENDERER_CAST,
     .precision = CELLIST_PRECISION_REFERENCE,
     .samples = 1},
    {.factor = "light", .name = "lit soft", .renderer = CELLIST_RENDERER_SOFT, .samples = 1},
    {.factor = "light", .name = "lit faces", FACES, .samples = 1},
    {.factor = "samples", .name = "lit soft, 4 samples", .renderer = CELLIST_RENDERER_SOFT, .samples = 4},
    {.factor = "samples", .name = "lit faces, 2 samples", FACES, .samples = 2},
    {.factor = "samples", .name = "lit faces, 3 samples", FACES, .samples = 3},
    {.factor = "samples", .name = "lit faces, 4 samples", FACES, .samples = 4},
    {.factor = "integration", .name = "lit faces table 64^3", FACES, TABLE, .table_size = {64, 64}, .samples = 1},
};

const report_setting *report_setting_at(size_t i) {
  return i < sizeof SETTINGS / sizeof SETTINGS[0] ? &SETTINGS[i] : NULL;
}

void report_setting_apply(const report_setting *setting, cellist_pipeline_desc *desc) {
  cellist_optics *optics = &desc->optics.model;
  desc->renderer = setting->renderer;
  desc->precision = setting->precision;
  desc->framebuffer = setting->framebuffer;
  desc->sorting = setting->sorting;
  optics->integration = setting->integration;
  memcpy(optics->table_size, setting->table_size, sizeof optics->table_size);
  optics->sample_count = setting->samples;
  if (setting->samples > 0)
    optics->light =
        (cellist_light){.enabled = true, .ambient = 0.35, .diffuse = 0.65, .specular = 0.2, .shininess = 20};
}

const char *report_renderer_name(const report_setting *setting) {
  switch (setting->renderer) {
    case CELLIST_RENDERER_FACES: return "faces";
    case CELLIST_RENDERER_FAN: return "fan";
    case CELLIST_RENDERER_SOFT: return "soft";
    default: return setting->precision == CELLIST_PRECISION_REFERENCE ? "cast reference" : "cast fast";
  }
}

const char *report_integration_name(const report_setting *setting, char text[32]) {
  if (setting->integration == CELLIST_INTEGRATION_EXACT) return "exact";
  if (setting->integration == CELLIST_INTEGRATION_PSI) return "psi";
  snprintf(text, 32, "table %ux%ux%u", setting->table_size[0], setting->table_size[0], setting->table_size[1]);
  return text;
}

const char *report_framebuffer_name(const report_setting *setting) {
  static const char *const names[] = {
      [CELLIST_FRAMEBUFFER_32F] = "32f", [CELLIST_FRAMEBUFFER_16F] = "16f", [CELLIST_FRAMEBUFFER_8] = "8"};
  return names[setting->framebuffer];
}

const char *report_sorting_name(const report_setting *setting) {
  static const char *const names[] = {
      [CELLIST_SORTING_EXACT] = "exact", [CELLIST_SORTING_CENTROID] = "centroid", [CELLIST_SORTING_NONE] = "none"};
  return names[setting->sorting];
}
