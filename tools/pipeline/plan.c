/* SPDX-License-Identifier: BSD-3-Clause
 * Plan: what a scene does not need is left out, and said. */
#include <stdarg.h>
#include <stdio.h>

#include "pipeline.h"

void pipeline_leave_out(cellist_pipeline_stats *stats, const char *what, const char *why, ...) {
  if (stats->left_out_count == CELLIST_LEFT_OUT_LIMIT) return;
  cellist_left_out *entry = &stats->left_out[stats->left_out_count++];
  entry->what = what;
  va_list arguments;
  va_start(arguments, why);
  vsnprintf(entry->why, sizeof entry->why, why, arguments);
  va_end(arguments);
}
