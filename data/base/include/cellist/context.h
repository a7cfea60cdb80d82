/* SPDX-License-Identifier: BSD-3-Clause
 * Context: what every other call needs (allocator, messages, progress, workers), held by the caller.
 * The library has no globals, reads no environment, prints nothing and never exits. */
#ifndef CELLIST_CONTEXT_H
#define CELLIST_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define CELLIST_API __attribute__((visibility("default")))
#define CELLIST_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define CELLIST_API
#define CELLIST_PRINTF(text, first)
#endif

/* No neighbour, no cell, no point. */
#define CELLIST_NONE UINT32_MAX

/* What a call that can fail returns. A failed call changes nothing but the context's error message. */
typedef enum cellist_result {
  CELLIST_SUCCESS = 0,
  CELLIST_ERROR_INVALID_ARGUMENT, /* the caller's arguments break the function's contract */
  CELLIST_ERROR_OUT_OF_MEMORY,    /* the allocator returned NULL, or a size does not fit */
  CELLIST_ERROR_IO,               /* a file cannot be opened, read or written */
  CELLIST_ERROR_FORMAT,           /* a file's content is not what its format says */
  CELLIST_ERROR_UNSUPPORTED,      /* well formed, but beyond what Cellist handles */
  CELLIST_ERROR_GEOMETRY,         /* the mesh is flawed in a way that this call cannot take */
  CELLIST_ERROR_NOT_FOUND,        /* a name (scalar, sample, colour map) that does not exist */
  CELLIST_ERROR_GRAPHICS,         /* no OpenGL context, or OpenGL refused */
  CELLIST_ERROR_CANCELLED,        /* the progress callback returned false */
  CELLIST_ERROR_INTERNAL          /* a library below failed in a way that has no better name */
} cellist_result;

/* The result's name, e.g. "out of memory"; never NULL, never freed. Threads: any. */
CELLIST_API const char *cellist_result_string(cellist_result result);

/* Memory for everything the library makes. Both functions must be callable from several threads at once
 * when the context has more than one worker.
 * allocate:   size > 0 bytes aligned to 64, or NULL when there is no memory.
 * deallocate: a block that allocate returned. */
typedef struct cellist_allocator {
  void *(*allocate)(void *user, size_t size);
  void (*deallocate)(void *user, void *block);
  void *user;
} cellist_allocator;

typedef enum cellist_log_level { CELLIST_LOG_DEBUG, CELLIST_LOG_INFO, CELLIST_LOG_WARNING } cellist_log_level;

/* One message, without a newline. Called on the thread that called the library. */
typedef void (*cellist_log_function)(void *user, cellist_log_level level, const char *message);

/* How far the running call has come: stage is a short noun ("reading"), fraction is 0..1 of that stage.
 * Return false to cancel: the call then fails with CELLIST_ERROR_CANCELLED. Called on the calling thread. */
typedef bool (*cellist_progress_function)(void *user, const char *stage, double fraction);

/* {0} is valid and means: malloc, no messages, no progress, one worker per processor. */
typedef struct cellist_context_desc {
  cellist_allocator allocator;
  cellist_log_function log;
  void *log_user;
  cellist_progress_function progress;
  void *progress_user;
  unsigned worker_count; /* threads that a call may use, the caller's included; 0: one per processor; more than
                            256 count as 256 */
} cellist_context_desc;

typedef struct cellist_context cellist_context;

/* The descriptor with every default filled in. Threads: any. */
CELLIST_API cellist_context_desc cellist_context_desc_default(void);

/* Creates a context.
 * Arrays: none. desc may be NULL (defaults). *context is the caller's, to be given to cellist_context_destroy
 *   after everything that was made with it.
 * Errors: INVALID_ARGUMENT (context NULL, only one of allocate and deallocate set), OUT_OF_MEMORY.
 * Threads: any; different contexts are independent, one context serves one calling thread at a time.
 * Cost: constant; worker threads start at the first call that uses them. */
CELLIST_API cellist_result cellist_context_create(const cellist_context_desc *desc, cellist_context **context);

/* Joins the workers and frees the context; NULL is legal. */
CELLIST_API void cellist_context_destroy(cellist_context *context);

/* The first error message since the last call of this function, or "" if none. The text belongs to the
 * context and stays until the next failing call. Threads: the one that uses the context. */
CELLIST_API const char *cellist_context_take_error(cellist_context *context);

/* How many threads a call on this context may use, at least 1. */
CELLIST_API unsigned cellist_context_worker_count(const cellist_context *context);

/* ---- For the modules, and for programs that extend them -------------------------------------------- */

/* Memory from the context's allocator, 64-byte aligned, contents undefined (zeroed by _zeroed); count times
 * size is checked for overflow. A count or size of 0 gives a valid block.
 * Returns NULL and records OUT_OF_MEMORY on failure. Threads: workers may call it. */
CELLIST_API void *cellist_allocate(cellist_context *context, size_t count, size_t size);
CELLIST_API void *cellist_allocate_zeroed(cellist_context *context, size_t count, size_t size);

/* A block of new_count elements that starts with the old block's first min(old_count, new_count) ones. The old
 * block is freed on success and left alone on failure (NULL). block may be NULL with old_count 0. */
CELLIST_API void *cellist_reallocate(cellist_context *context, void *block, size_t old_count, size_t new_count,
                                     size_t size);

/* Gives back what the three above returned; NULL is legal. */
CELLIST_API void cellist_deallocate(cellist_context *context, void *block);

/* Records the message (if it is the first since the last take) and returns result: return cellist_fail(...). */
CELLIST_API cellist_result cellist_fail(cellist_context *context, cellist_result result, const char *format, ...)
    CELLIST_PRINTF(3, 4);

/* Sends a message to the context's log. */
CELLIST_API void cellist_log(cellist_context *context, cellist_log_level level, const char *format, ...)
    CELLIST_PRINTF(3, 4);

/* Reports progress; returns CELLIST_ERROR_CANCELLED (and records it) if the callback asks to stop. */
CELLIST_API cellist_result cellist_progress(cellist_context *context, const char *stage, double fraction);

/* Calls body on disjoint ranges that cover 0..count-1, on up to worker_count threads. Ranges start at multiples
 * of grain (0: one range), so what a body writes for its range does not depend on the number of workers.
 * worker is 0..worker_count-1, and no two running bodies share one. A call from inside a body runs serially.
 * Threads: the one that uses the context. Cost: no allocation after the first call. */
typedef void (*cellist_range_function)(void *user, size_t begin, size_t end, unsigned worker);
CELLIST_API void cellist_parallel_for(cellist_context *context, size_t count, size_t grain, cellist_range_function body,
                                      void *user);

#ifdef __cplusplus
}
#endif
#endif
