/* SPDX-License-Identifier: BSD-3-Clause
 * Stability page: the table of stiff and extreme scenes as rows, one a case and what it is judged by. */
#include <math.h>
#include <stdio.h>

#include "../terminal.h"
#include "report.h"
#include "stability.h"

static json_t *row(const stability_case *which, const char *by, stability_verdict verdict, json_t *rmse, json_t *max,
                   double seconds, const char *message) {
  return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:f, s:o}", "case", which->name, "group",
                   stability_group_name(which->group), "exercises", which->exercises, "must", which->must, "judged by",
                   by, "verdict", stability_verdict_name(verdict), "rmse", rmse, "max", max, "seconds", seconds, "says",
                   terminal_text(message));
}

static cellist_result add_pictures(cellist_context *context, const stability_case *which, const stability_scene *scene,
                                   json_t *rows) {
  for (unsigned r = 0; r < STABILITY_RENDERER_COUNT; r++) {
    stability_picture found;
    const cellist_result result = stability_draw(context, which, scene, (stability_renderer)r, &found);
    if (result != CELLIST_SUCCESS) return result;
    json_array_append_new(
        rows, row(which, stability_renderer_name((stability_renderer)r), found.verdict, terminal_number(found.rmse),
                  terminal_number(found.max), found.seconds, found.message));
  }
  return CELLIST_SUCCESS;
}

static cellist_result add_order(cellist_context *context, const stability_case *which, const stability_scene *scene,
                                json_t *rows) {
  stability_order found;
  const cellist_result result = stability_sort(context, which, scene, &found);
  if (result != CELLIST_SUCCESS) return result;
  char text[400];
  snprintf(text, sizeof text, "%zu of %zu pairs inverted, %zu groups, %zu unsorted %s", found.inversions, found.pairs,
           found.groups, found.unsorted, found.message);
  json_array_append_new(rows, row(which, "order", found.verdict, json_null(), json_null(), found.seconds, text));
  return CELLIST_SUCCESS;
}

static cellist_result add_case(cellist_context *context, const stability_case *which, json_t *rows) {
  stability_scene scene;
  cellist_result result = stability_build(context, which, &scene);
  if (result == CELLIST_SUCCESS) result = add_pictures(context, which, &scene, rows);
  if (result == CELLIST_SUCCESS) result = add_order(context, which, &scene, rows);
  stability_scene_release(&scene);
  return result;
}

cellist_result report_stability(cellist_context *context, json_t **rows) {
  size_t count = 0;
  while (stability_case_at(count) != NULL) count++;
  *rows = json_array();
  cellist_result result = *rows != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < count && result == CELLIST_SUCCESS; i++) {
    result = add_case(context, stability_case_at(i), *rows);
    if (result == CELLIST_SUCCESS) result = cellist_progress(context, "stability", (double)(i + 1) / (double)count);
  }
  return result;
}
