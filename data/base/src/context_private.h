/* SPDX-License-Identifier: BSD-3-Clause
 * The context's inside, shared by context.c and workers.c only. */
#ifndef CELLIST_CONTEXT_PRIVATE_H
#define CELLIST_CONTEXT_PRIVATE_H

#include <cellist/context.h>
#include <pthread.h>

/* Long enough for a path, a cell id and a reason; a longer message is cut at its end. */
enum { ERROR_CAPACITY = 1024 };

struct workers;

struct cellist_context {
  cellist_context_desc desc;
  pthread_mutex_t error_lock;
  bool has_error;
  char error[ERROR_CAPACITY];
  struct workers *workers; /* NULL until the first parallel call */
};

void workers_stop(cellist_context *context);

#endif
