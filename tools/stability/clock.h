/* SPDX-License-Identifier: BSD-3-Clause
 * Clock: seconds for the table's column. Verdicts never depend on it. Private to tools/stability/. */
#ifndef CELLIST_TOOLS_STABILITY_CLOCK_H
#define CELLIST_TOOLS_STABILITY_CLOCK_H

#include <time.h>

static inline double stability_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

#endif
