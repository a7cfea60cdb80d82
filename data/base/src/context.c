/* SPDX-License-Identifier: BSD-3-Clause
 * Context: allocator, first error message, log and progress. The workers live in workers.c. */
#define _DEFAULT_SOURCE /* madvise */
#include "context_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Cache line and the widest vector register that any kernel loads: smaller breaks aligned vector loads. */
enum { BLOCK_ALIGNMENT = 64 };
/* Blocks from LARGE_BLOCK bytes on are aligned to, and asked to lie in, huge pages: a page fault for each 2 MiB instead
 * of each 4 KiB, and fewer misses where a mesh is walked at random. */
enum { HUGE_PAGE = 2 << 20, LARGE_BLOCK = 2 * HUGE_PAGE };
/* No machine that this runs on has more processors; thousands of threads would starve it of processes. */
enum { WORKER_LIMIT = 256 };

const char *cellist_result_string(cellist_result result) {
  switch (result) {
    case CELLIST_SUCCESS: return "success";
    case CELLIST_ERROR_INVALID_ARGUMENT: return "invalid argument";
    case CELLIST_ERROR_OUT_OF_MEMORY: return "out of memory";
    case CELLIST_ERROR_IO: return "input or output failed";
    case CELLIST_ERROR_FORMAT: return "malformed file";
    case CELLIST_ERROR_UNSUPPORTED: return "unsupported";
    case CELLIST_ERROR_GEOMETRY: return "flawed geometry";
    case CELLIST_ERROR_NOT_FOUND: return "not found";
    case CELLIST_ERROR_GRAPHICS: return "graphics failed";
    case CELLIST_ERROR_CANCELLED: return "cancelled";
    case CELLIST_ERROR_INTERNAL: return "internal failure";
  }
  return "unknown result";
}

static void *default_allocate(void *user, size_t size) {
  (void)user;
  const size_t alignment = size >= LARGE_BLOCK ? HUGE_PAGE : BLOCK_ALIGNMENT;
  if (size > SIZE_MAX - alignment) return NULL;
  const size_t rounded = (size + alignment - 1) / alignment * alignment;
  void *block = aligned_alloc(alignment, rounded);
#ifdef MADV_HUGEPAGE
  if (block != NULL && alignment == HUGE_PAGE)
    (void)madvise(block, rounded, MADV_HUGEPAGE); /* advice; may be refused */
#endif
  return block;
}

static void default_deallocate(void *user, void *block) {
  (void)user;
  free(block);
}

cellist_context_desc cellist_context_desc_default(void) {
  cellist_context_desc desc = {0};
  desc.allocator = (cellist_allocator){default_allocate, default_deallocate, NULL};
  long processors = sysconf(_SC_NPROCESSORS_ONLN);
  desc.worker_count = processors > 0 ? (unsigned)processors : 1;
  return desc;
}

cellist_result cellist_context_create(const cellist_context_desc *desc, cellist_context **context) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  const cellist_context_desc defaults = cellist_context_desc_default();
  cellist_context_desc resolved = desc != NULL ? *desc : defaults;
  if ((resolved.allocator.allocate == NULL) != (resolved.allocator.deallocate == NULL))
    return CELLIST_ERROR_INVALID_ARGUMENT;
  if (resolved.allocator.allocate == NULL) resolved.allocator = defaults.allocator;
  if (resolved.worker_count == 0) resolved.worker_count = defaults.worker_count;
  if (resolved.worker_count > WORKER_LIMIT) resolved.worker_count = WORKER_LIMIT;

  cellist_context *created = resolved.allocator.allocate(resolved.allocator.user, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memset(created, 0, sizeof *created);
  created->desc = resolved;
  if (pthread_mutex_init(&created->error_lock, NULL) != 0) {
    resolved.allocator.deallocate(resolved.allocator.user, created);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  *context = created;
  return CELLIST_SUCCESS;
}

void cellist_context_destroy(cellist_context *context) {
  if (context == NULL) return;
  workers_stop(context);
  pthread_mutex_destroy(&context->error_lock);
  context->desc.allocator.deallocate(context->desc.allocator.user, context);
}

const char *cellist_context_take_error(cellist_context *context) {
  if (!context->has_error) return "";
  context->has_error = false;
  return context->error;
}

unsigned cellist_context_worker_count(const cellist_context *context) { return context->desc.worker_count; }

void *cellist_allocate(cellist_context *context, size_t count, size_t size) {
  size_t bytes = 0;
  void *block = NULL;
  if (!__builtin_mul_overflow(count, size, &bytes))
    block = context->desc.allocator.allocate(context->desc.allocator.user, bytes > 0 ? bytes : 1);
  if (block == NULL)
    cellist_fail(context, CELLIST_ERROR_OUT_OF_MEMORY, "out of memory (%zu elements of %zu bytes)", count, size);
  return block;
}

void *cellist_allocate_zeroed(cellist_context *context, size_t count, size_t size) {
  void *block = cellist_allocate(context, count, size);
  if (block != NULL) memset(block, 0, count * size);
  return block;
}

void *cellist_reallocate(cellist_context *context, void *block, size_t old_count, size_t new_count, size_t size) {
  void *moved = cellist_allocate(context, new_count, size);
  if (moved == NULL) return NULL;
  const size_t kept = old_count < new_count ? old_count : new_count;
  if (kept > 0) memcpy(moved, block, kept * size);
  cellist_deallocate(context, block);
  return moved;
}

void cellist_deallocate(cellist_context *context, void *block) {
  if (block != NULL) context->desc.allocator.deallocate(context->desc.allocator.user, block);
}

cellist_result cellist_fail(cellist_context *context, cellist_result result, const char *format, ...) {
  if (context == NULL) return result;
  pthread_mutex_lock(&context->error_lock);
  if (!context->has_error) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(context->error, sizeof context->error, format, arguments);
    va_end(arguments);
    context->has_error = true;
  }
  pthread_mutex_unlock(&context->error_lock);
  return result;
}

void cellist_log(cellist_context *context, cellist_log_level level, const char *format, ...) {
  if (context->desc.log == NULL) return;
  char message[ERROR_CAPACITY];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  context->desc.log(context->desc.log_user, level, message);
}

cellist_result cellist_progress(cellist_context *context, const char *stage, double fraction) {
  if (context->desc.progress == NULL) return CELLIST_SUCCESS;
  if (context->desc.progress(context->desc.progress_user, stage, fraction)) return CELLIST_SUCCESS;
  return cellist_fail(context, CELLIST_ERROR_CANCELLED, "%s was cancelled", stage);
}
