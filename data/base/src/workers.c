/* SPDX-License-Identifier: BSD-3-Clause
 * Workers: a pool of threads that share out ranges of one loop at a time.
 *
 * Ranges are handed out by an atomic counter in units of the caller's grain, so which thread runs a range varies
 * but the ranges do not: a body that writes only what belongs to its range gives the same bits on any number of
 * threads. If threads cannot be started the loop runs on those that could, the caller's own at worst. */
#include "context_private.h"

#include <stdatomic.h>

struct workers;

struct worker {
  pthread_t thread;
  struct workers *pool;
  unsigned index;
};

struct workers {
  pthread_mutex_t lock;
  pthread_cond_t work_ready, work_done;
  unsigned long generation; /* of the loop being run; a worker runs each generation once */
  bool stopping;
  bool running; /* a loop is under way: nested calls run serially */
  unsigned busy;
  unsigned started;
  cellist_range_function body;
  void *user;
  size_t count, grain;
  atomic_size_t next;
  struct worker worker[];
};

static void run_ranges(struct workers *pool, unsigned index) {
  for (;;) {
    const size_t begin = atomic_fetch_add(&pool->next, pool->grain);
    if (begin >= pool->count) return;
    const size_t left = pool->count - begin;
    pool->body(pool->user, begin, begin + (left < pool->grain ? left : pool->grain), index);
  }
}

static void *worker_main(void *argument) {
  struct worker *self = argument;
  struct workers *pool = self->pool;
  unsigned long seen = 0;
  pthread_mutex_lock(&pool->lock);
  for (;;) {
    while (!pool->stopping && pool->generation == seen) pthread_cond_wait(&pool->work_ready, &pool->lock);
    if (pool->stopping) break;
    seen = pool->generation;
    pthread_mutex_unlock(&pool->lock);
    run_ranges(pool, self->index);
    pthread_mutex_lock(&pool->lock);
    if (--pool->busy == 0) pthread_cond_signal(&pool->work_done);
  }
  pthread_mutex_unlock(&pool->lock);
  return NULL;
}

static struct workers *workers_start(cellist_context *context) {
  if (context->workers != NULL) return context->workers;
  const unsigned helpers = context->desc.worker_count - 1;
  const cellist_allocator *allocator = &context->desc.allocator;
  /* Straight from the allocator: having no pool is not an error, the loop then runs serially. */
  struct workers *pool = allocator->allocate(allocator->user, sizeof *pool + helpers * sizeof pool->worker[0]);
  if (pool == NULL) return NULL;
  *pool = (struct workers){0};
  pthread_mutex_init(&pool->lock, NULL);
  pthread_cond_init(&pool->work_ready, NULL);
  pthread_cond_init(&pool->work_done, NULL);
  for (unsigned i = 0; i < helpers; i++) {
    pool->worker[i].pool = pool;
    pool->worker[i].index = i + 1;
    if (pthread_create(&pool->worker[i].thread, NULL, worker_main, &pool->worker[i]) != 0) break;
    pool->started++;
  }
  context->workers = pool;
  return pool;
}

void workers_stop(cellist_context *context) {
  struct workers *pool = context->workers;
  if (pool == NULL) return;
  pthread_mutex_lock(&pool->lock);
  pool->stopping = true;
  pthread_cond_broadcast(&pool->work_ready);
  pthread_mutex_unlock(&pool->lock);
  for (unsigned i = 0; i < pool->started; i++) pthread_join(pool->worker[i].thread, NULL);
  pthread_cond_destroy(&pool->work_done);
  pthread_cond_destroy(&pool->work_ready);
  pthread_mutex_destroy(&pool->lock);
  context->desc.allocator.deallocate(context->desc.allocator.user, pool);
  context->workers = NULL;
}

static void run_serially(size_t count, size_t grain, cellist_range_function body, void *user, unsigned worker) {
  for (size_t begin = 0; begin < count; begin += grain)
    body(user, begin, count - begin < grain ? count : begin + grain, worker);
}

void cellist_parallel_for(cellist_context *context, size_t count, size_t grain, cellist_range_function body,
                          void *user) {
  if (count == 0) return;
  if (grain == 0 || grain > count) grain = count;
  struct workers *pool = NULL;
  if (context->desc.worker_count > 1 && grain < count) pool = workers_start(context);
  /* `running` is only ever changed by the thread that owns the context; a body that calls back in sees true. */
  if (pool == NULL || pool->started == 0 || pool->running) {
    run_serially(count, grain, body, user, 0);
    return;
  }
  pthread_mutex_lock(&pool->lock);
  pool->running = true;
  pool->body = body;
  pool->user = user;
  pool->count = count;
  pool->grain = grain;
  atomic_store(&pool->next, 0);
  pool->busy = pool->started;
  pool->generation++;
  pthread_cond_broadcast(&pool->work_ready);
  pthread_mutex_unlock(&pool->lock);

  run_ranges(pool, 0);

  pthread_mutex_lock(&pool->lock);
  while (pool->busy > 0) pthread_cond_wait(&pool->work_done, &pool->lock);
  pool->running = false;
  pthread_mutex_unlock(&pool->lock);
}
