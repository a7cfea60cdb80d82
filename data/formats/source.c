/* SPDX-License-Identifier: BSD-3-Clause
 * Source: maps files, reads pipes, finds files beside a file, words the messages. */
#include "source.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static cellist_result fail_io(cellist_context *context, const char *name, const char *what) {
  char reason[128] = "";
  if (strerror_r(errno, reason, sizeof reason) != 0) reason[0] = '\0';
  return cellist_fail(context, CELLIST_ERROR_IO, "%s: %s: %s", name, what, reason);
}

/* A pipe's size is not known: the buffer doubles, so it is never more than twice what has come. */
static cellist_result read_stream(cellist_context *context, int file, struct source *source) {
  size_t capacity = 1 << 16, size = 0;
  uint8_t *bytes = cellist_allocate(context, capacity, 1);
  if (bytes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (;;) {
    if (size == capacity) {
      uint8_t *grown = cellist_reallocate(context, bytes, size, 2 * capacity, 1);
      if (grown == NULL) {
        cellist_deallocate(context, bytes);
        return CELLIST_ERROR_OUT_OF_MEMORY;
      }
      bytes = grown;
      capacity *= 2;
    }
    const ssize_t got = read(file, bytes + size, capacity - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      const cellist_result result = fail_io(context, source->name, "cannot be read");
      cellist_deallocate(context, bytes);
      return result;
    }
    if (got == 0) break;
    size += (size_t)got;
  }
  source->bytes = source->owned_bytes = bytes;
  source->size = size;
  return CELLIST_SUCCESS;
}

static cellist_result read_file(cellist_context *context, int file, struct source *source) {
  struct stat status;
  if (fstat(file, &status) != 0) return fail_io(context, source->name, "cannot be read");
  if (S_ISDIR(status.st_mode)) return cellist_fail(context, CELLIST_ERROR_IO, "%s: is a directory", source->name);
  if (!S_ISREG(status.st_mode) || status.st_size == 0) return read_stream(context, file, source);
  void *mapped = mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_PRIVATE, file, 0);
  if (mapped == MAP_FAILED) return read_stream(context, file, source);
  source->mapped = mapped;
  source->bytes = mapped;
  source->size = (size_t)status.st_size;
  return CELLIST_SUCCESS;
}

static cellist_result open_path(cellist_context *context, char *path, struct source *source) {
  *source = (struct source){.name = path, .owned_name = path, .open_beside = source_open_beside};
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  cellist_result result = CELLIST_SUCCESS;
  if (file < 0) {
    result = fail_io(context, path, "cannot be opened");
  } else {
    result = read_file(context, file, source);
    close(file);
  }
  if (result != CELLIST_SUCCESS) source_close(context, source);
  return result;
}

cellist_result source_open(cellist_context *context, const char *path, struct source *source) {
  *source = (struct source){0};
  if (strcmp(path, "-") == 0) {
    source->name = "standard input";
    return read_file(context, STDIN_FILENO, source);
  }
  char *copy = cellist_allocate(context, strlen(path) + 1, 1);
  if (copy == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memcpy(copy, path, strlen(path) + 1);
  return open_path(context, copy, source);
}

struct source source_of_memory(const char *name, const void *bytes, size_t size) {
  return (struct source){.name = name, .bytes = bytes, .size = size};
}

static size_t folder_length(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash != NULL ? (size_t)(slash - path) + 1 : 0;
}

cellist_result source_open_beside(cellist_context *context, const struct source *source, const char *name,
                                  struct source *opened) {
  *opened = (struct source){0};
  const size_t folder = name[0] == '/' ? 0 : folder_length(source->name), length = strlen(name);
  char *path = cellist_allocate(context, folder + length + 1, 1);
  if (path == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (folder > 0) memcpy(path, source->name, folder);
  memcpy(path + folder, name, length + 1);
  return open_path(context, path, opened);
}

cellist_result source_try_sibling(cellist_context *context, const struct source *source, size_t suffix_length,
                                  const char *suffix, struct source *opened, bool *found) {
  *opened = (struct source){0};
  *found = false;
  const char *name = source->name + folder_length(source->name);
  if (source->open_beside == NULL || strlen(name) < suffix_length) return CELLIST_SUCCESS;
  const size_t stem = strlen(name) - suffix_length, size = folder_length(source->name) + stem + strlen(suffix) + 1;
  char *path = cellist_allocate(context, size, 1);
  if (path == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  snprintf(path, size, "%.*s%s", (int)(folder_length(source->name) + stem), source->name, suffix);
  cellist_result result = CELLIST_SUCCESS;
  *found = strcmp(path, source->name) != 0 && (source->open_beside != source_open_beside || access(path, R_OK) == 0);
  if (*found) result = source->open_beside(context, source, path + folder_length(source->name), opened);
  cellist_deallocate(context, path);
  return result;
}

void source_close(cellist_context *context, struct source *source) {
  if (source->mapped != NULL) munmap(source->mapped, source->size);
  cellist_deallocate(context, source->owned_bytes);
  cellist_deallocate(context, source->owned_name);
  *source = (struct source){0};
}

bool source_has_suffix(const struct source *source, const char *suffix) {
  const size_t name = strlen(source->name), length = strlen(suffix);
  return name >= length && strcmp(source->name + name - length, suffix) == 0;
}

/* Long enough for what a reader says; the path is cut by the context if need be. */
enum { REASON_CAPACITY = 512 };

cellist_result source_fail_at(cellist_context *context, const struct source *source, size_t at, const char *format,
                              ...) {
  char reason[REASON_CAPACITY];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason, sizeof reason, format, arguments);
  va_end(arguments);
  return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: byte %zu: %s", source->name, at, reason);
}

cellist_result source_fail(cellist_context *context, const struct source *source, const char *format, ...) {
  char reason[REASON_CAPACITY];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reason, sizeof reason, format, arguments);
  va_end(arguments);
  return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: %s", source->name, reason);
}
