/* SPDX-License-Identifier: BSD-3-Clause
 * Terminal: a progress bar that redraws at most ten times a second, and one line per error. */
#include "terminal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "clock.h"

/* The bar, and what stands around it: a line that is wider than the terminal cannot be drawn over. */
enum { BAR_WIDTH = 30, AROUND_BAR = 22 };
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

static int bar_width(void) {
  struct winsize size;
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return BAR_WIDTH;
  const int room = size.ws_col - AROUND_BAR;
  return room > BAR_WIDTH ? BAR_WIDTH : room > 1 ? room : 1;
}

/* A stage that goes on after others have reported holds them: they are not shown until it is done. */
static bool is_held(const char *stage, double fraction) {
  static char latest[32], before[32], outer[32]; /* stages; outer "": none */
  static double latest_fraction, before_fraction;
  if (outer[0] != '\0' && strcmp(stage, outer) != 0) return true;
  if (strcmp(stage, latest) != 0) {
    if (strcmp(stage, before) == 0 && fraction > before_fraction) snprintf(outer, sizeof outer, "%s", stage);
    memcpy(before, latest, sizeof before);
    before_fraction = latest_fraction;
    snprintf(latest, sizeof latest, "%s", stage);
  }
  latest_fraction = fraction;
  if (fraction >= 1) outer[0] = '\0';
  return false;
}

static bool show_progress(void *user, const char *stage, double fraction) {
  (void)user;
  const double now = clock_seconds();
  if (is_held(stage, fraction)) return true;
  if (fraction >= 1) {
    terminal_clear_progress();
    return true;
  }
  if (now - last_drawn < REDRAW_SECONDS) return true;
  last_drawn = now;
  progress_is_shown = true;
  const int width = bar_width(), filled = (int)(fraction * width);
  fprintf(stderr, "\r%-12s [%.*s%*s] %3d %%", stage, filled, "##############################", width - filled, "",
          (int)(100 * fraction));
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
