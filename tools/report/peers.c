/* SPDX-License-Identifier: BSD-3-Clause
 * Peers: figures of other programs, measured elsewhere, for the charts. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

enum { COLUMNS = 32, WANTED = 4 };
static const char *const NAMES[WANTED] = {"mesh", "name", "seconds", "rmse"};

/* Splits at commas in place; fields may stand in double quotes. Returns their number. */
static size_t split(char *line, char *fields[COLUMNS]) {
  size_t count = 0;
  line[strcspn(line, "\r\n")] = '\0';
  for (char *at = line; count < COLUMNS;) {
    const bool is_quoted = *at == '"';
    char *begin = is_quoted ? at + 1 : at;
    char *end = is_quoted ? strchr(begin, '"') : begin + strcspn(begin, ",");
    if (end == NULL) end = begin + strlen(begin);
    fields[count++] = begin;
    char *comma = strchr(end, ',');
    *end = '\0';
    if (comma == NULL) break;
    at = comma + 1;
  }
  return count;
}

static cellist_result read_line(cellist_context *context, report_run *report, size_t line, char *fields[COLUMNS],
                                size_t count, const size_t column[WANTED]) {
  const char *path = report->options->peers;
  for (size_t k = 0; k < WANTED; k++)
    if (column[k] >= count)
      return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: line %zu has no %s", path, line, NAMES[k]);
  char *end = NULL;
  report_peer peer = {0};
  snprintf(peer.mesh, sizeof peer.mesh, "%s", fields[column[0]]);
  snprintf(peer.name, sizeof peer.name, "%s", fields[column[1]]);
  double *const numbers[] = {&peer.seconds, &peer.rmse};
  for (size_t k = 0; k < 2; k++) {
    const char *text = fields[column[2 + k]];
    *numbers[k] = strtod(text, &end);
    if (end == text || *end != '\0' || !(*numbers[k] > 0) || !isfinite(*numbers[k]))
      return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: line %zu: %s '%s' is not a number above 0", path, line,
                          NAMES[2 + k], text);
  }
  report_peer *grown = realloc(report->peers, (report->peer_count + 1) * sizeof *grown);
  if (grown == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  grown[report->peer_count++] = peer;
  report->peers = grown;
  return CELLIST_SUCCESS;
}

static cellist_result find_columns(cellist_context *context, const char *path, char *fields[COLUMNS], size_t count,
                                   size_t column[WANTED]) {
  for (size_t k = 0; k < WANTED; k++) {
    column[k] = COLUMNS;
    for (size_t i = 0; i < count; i++)
      if (strcmp(fields[i], NAMES[k]) == 0) column[k] = i;
    if (column[k] == COLUMNS)
      return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: no column '%s' (it needs mesh, name, seconds, rmse)",
                          path, NAMES[k]);
  }
  return CELLIST_SUCCESS;
}

cellist_result report_read_peers(cellist_context *context, report_run *report) {
  const char *path = report->options->peers;
  if (path == NULL) return CELLIST_SUCCESS;
  FILE *file = fopen(path, "r");
  if (file == NULL) return cellist_fail(context, CELLIST_ERROR_IO, "%s: %s", path, strerror(errno));
  char *line = NULL, *fields[COLUMNS];
  size_t capacity = 0, number = 0, column[WANTED];
  cellist_result result = CELLIST_SUCCESS;
  bool has_head = false;
  while (result == CELLIST_SUCCESS && getline(&line, &capacity, file) > 0) {
    number++;
    if (line[0] == '\n' || line[0] == '#') continue;
    const size_t count = split(line, fields);
    result = has_head ? read_line(context, report, number, fields, count, column)
                      : find_columns(context, path, fields, count, column);
    has_head = true;
  }
  if (result == CELLIST_SUCCESS && !has_head)
    result = cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: is empty", path);
  free(line);
  fclose(file);
  return result;
}
