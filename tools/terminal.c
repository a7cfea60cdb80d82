/* SPDX-License-Identifier: BSD-3-Clause
 * Terminal: a progress bar that redraws at most ten times a second, and one line per error. */
#include "terminal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"

enum { BAR_WIDTH = 30 };
static const double REDRAW_SECONDS = 0.1;

static bool progress_is_shown;
static double last_drawn;

static int compare_doubles(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double terminal_median(double *values, size_t count) {
  if (count == 0) return 0;
  qsort(values, count, sizeof *values, compare_doubles);
  return 0.5 * (values[count / 2] + values[(count - 1) / 2]);
}

void terminal_clear_progress(void) {
  if (progress_is_shown) fprintf(stderr, "\r\033[K");
  progress_is_shown = false;
}

static bool show_progress(void *user, const char *stage, double fraction) {
  (void)user;
  const double now = clock_seconds();
  if (fraction >= 1) {
    terminal_clear_progress();
    return true;
  }
  if (now - last_drawn < REDRAW_SECONDS) return true;
  last_drawn = now;
  progress_is_shown = true;
  const int filled = (int)(fraction * BAR_WIDTH);
  fprintf(stderr, "\r%-12s [%.*s%*s] %3.0f %%", stage, filled, "##############################", BAR_WIDTH - filled, "",
          100 * fraction);
  return true;
}

static void show_message(void *user, cellist_log_level level, const char *message) {
  (void)user;
  if (level != CELLIST_LOG_WARNING) return;
  terminal_clear_progress();
  fprintf(stderr, "cellist: warning: %s\n", message);
}

cellist_context *terminal_context(unsigned threads) {
  cellist_context_desc desc = cellist_context_desc_default();
  if (threads > 0) desc.worker_count = threads;
  desc.log = show_message;
  if (isatty(STDERR_FILENO)) desc.progress = show_progress;
  last_drawn = clock_seconds(); /* nothing is shown for what takes no time */
  cellist_context *context = NULL;
  const cellist_result result = cellist_context_create(&desc, &context);
  if (result != CELLIST_SUCCESS) fprintf(stderr, "cellist: %s\n", cellist_result_string(result));
  return context;
}

int terminal_failure(cellist_context *context, cellist_result result) {
  terminal_clear_progress();
  const char *message = cellist_context_take_error(context);
  fprintf(stderr, "cellist: %s\n", message[0] != '\0' ? message : cellist_result_string(result));
  return 1;
}

int terminal_finish(void) {
  if (fflush(stdout) == 0 && !ferror(stdout)) return 0;
  fprintf(stderr, "cellist: standard output: %s\n", strerror(errno));
  return 1;
}

json_t *terminal_text(const char *text) {
  json_t *string = json_string(text);
  if (string != NULL) return string;
  char ascii[512];
  size_t length = 0;
  for (; text[length] != '\0' && length < sizeof ascii - 1; length++)
    ascii[length] = (unsigned char)text[length] < 0x80 ? text[length] : '?';
  ascii[length] = '\0';
  return json_string(ascii);
}

json_t *terminal_number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

int terminal_print_json(json_t *object) {
  terminal_clear_progress();
  /* 17 digits: every double comes back as it was. */
  const int failed = object == NULL || json_dumpf(object, stdout, JSON_REAL_PRECISION(17) | JSON_COMPACT) != 0;
  json_decref(object);
  if (failed) {
    fprintf(stderr, "cellist: the JSON could not be written\n");
    return 1;
  }
  printf("\n");
  return terminal_finish();
}
