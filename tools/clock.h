/* SPDX-License-Identifier: BSD-3-Clause
 * Clock: seconds for statistics and progress. Never decides what is drawn. Private to tools/. */
#ifndef CELLIST_TOOLS_CLOCK_H
#define CELLIST_TOOLS_CLOCK_H

#include <time.h>

/* Seconds since some fixed moment, never running backwards. */
static inline double clock_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

#endif
