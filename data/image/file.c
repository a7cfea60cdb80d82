/* SPDX-License-Identifier: BSD-3-Clause
 * File: whole files to and from memory. What is written appears under its name whole or not at all. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "image_private.h"

bool byte_buffer_reserve(byte_buffer *buffer, size_t size) {
  if (size <= buffer->capacity) return true;
  const size_t capacity = size < SIZE_MAX / 2 ? size + size / 2 + 4096 : size;
  uint8_t *grown = cellist_reallocate(buffer->context, buffer->bytes, buffer->size, capacity, 1);
  if (grown == NULL) return false;
  buffer->bytes = grown;
  buffer->capacity = capacity;
  return true;
}

static bool write_and_close(FILE *file, const uint8_t *bytes, size_t size) {
  const bool written = fwrite(bytes, 1, size, file) == size;
  return fclose(file) == 0 && written;
}

cellist_result file_write_whole(cellist_context *context, const char *path, const uint8_t *bytes, size_t size) {
  if (strcmp(path, "-") == 0) {
    if (fwrite(bytes, 1, size, stdout) == size && fflush(stdout) == 0) return CELLIST_SUCCESS;
    return cellist_fail(context, CELLIST_ERROR_IO, "standard output: %s", strerror(errno));
  }
  const size_t room = strlen(path) + 32;
  char *temporary = cellist_allocate(context, room, 1);
  if (temporary == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  snprintf(temporary, room, "%s.%ld.part", path, (long)getpid());
  cellist_result result = CELLIST_SUCCESS;
  FILE *file = fopen(temporary, "wb");
  if (file == NULL || !write_and_close(file, bytes, size) || rename(temporary, path) != 0) {
    result = cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, strerror(errno));
    if (file != NULL) remove(temporary);
  }
  cellist_deallocate(context, temporary);
  return result;
}

cellist_result file_read_whole(cellist_context *context, const char *path, byte_buffer *buffer) {
  FILE *file = strcmp(path, "-") == 0 ? stdin : fopen(path, "rb");
  if (file == NULL) return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be opened: %s", path, strerror(errno));
  struct stat status;
  size_t step = 1 << 16;
  if (fstat(fileno(file), &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0)
    step = (size_t)status.st_size + 1;
  cellist_result result = CELLIST_SUCCESS;
  for (;;) {
    if (!byte_buffer_reserve(buffer, buffer->size + step)) {
      result = CELLIST_ERROR_OUT_OF_MEMORY;
      break;
    }
    const size_t got = fread(buffer->bytes + buffer->size, 1, buffer->capacity - buffer->size, file);
    buffer->size += got;
    if (got == 0) break;
  }
  if (result == CELLIST_SUCCESS && ferror(file))
    result = cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be read: %s", path, strerror(errno));
  if (file != stdin) fclose(file);
  return result;
}
