/* SPDX-License-Identifier: BSD-3-Clause
 * Read: from a file's name to its bytes and format. The whole file is read here, so that what cannot be opened or read
 * has the system's own reason, and the library below opens no other file (a material library, say) by itself. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "import.h"

enum { CHUNK = 1 << 20 };

static const struct {
  const char *ending;
  bool with_normals; /* STL's are the triangles' own, and often wrong */
} formats[] = {{"stl", false}, {"obj", true}, {"ply", true}};

static bool same_but_for_case(const char *a, const char *b) {
  for (; *a != '\0' && *b != '\0'; a++, b++) {
    const char lower = *a >= 'A' && *a <= 'Z' ? (char)(*a - 'A' + 'a') : *a;
    if (lower != *b) return false;
  }
  return *a == *b;
}

/* The format by the name's ending; -1 and a recorded failure if there is none. */
static int format_of(cellist_context *context, const char *name) {
  const char *dot = strrchr(name, '.');
  for (size_t i = 0; dot != NULL && i < sizeof formats / sizeof formats[0]; i++)
    if (same_but_for_case(dot + 1, formats[i].ending)) return (int)i;
  cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: surfaces are read from .stl, .obj and .ply files", name);
  return -1;
}

cellist_result cellist_surface_read_memory(cellist_context *context, const char *name, const void *bytes, size_t size,
                                           const double colour[3], cellist_surface **surface) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (name == NULL || (bytes == NULL && size > 0) || surface == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "cellist_surface_read_memory: name, bytes or surface is NULL");
  const int format = format_of(context, name);
  if (format < 0) return CELLIST_ERROR_UNSUPPORTED;
  if (size == 0) return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: the file is empty", name);
#if CELLIST_HAVE_ASSIMP
  return surface_import(context, name, formats[format].ending, bytes, size, formats[format].with_normals, colour,
                        surface);
#else
  (void)colour;
  return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: this build reads no surface files (no assimp)", name);
#endif
}

static cellist_result read_all(cellist_context *context, const char *path, FILE *file, char **bytes, size_t *size) {
  size_t capacity = 0;
  for (;;) {
    if (capacity - *size < CHUNK) {
      const size_t wanted = capacity < CHUNK ? 2 * CHUNK : 2 * capacity;
      char *grown = cellist_reallocate(context, *bytes, capacity, wanted, 1);
      if (grown == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
      *bytes = grown;
      capacity = wanted;
    }
    const size_t count = fread(*bytes + *size, 1, CHUNK, file);
    *size += count;
    if (ferror(file)) return cellist_fail(context, CELLIST_ERROR_IO, "%s: %s", path, strerror(errno));
    if (count == 0) return CELLIST_SUCCESS;
  }
}

cellist_result cellist_surface_read(cellist_context *context, const char *path, const double colour[3],
                                    cellist_surface **surface) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (path == NULL || surface == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_surface_read: path or surface is NULL");
  if (format_of(context, path) < 0) return CELLIST_ERROR_UNSUPPORTED;
  FILE *file = fopen(path, "rb");
  if (file == NULL) return cellist_fail(context, CELLIST_ERROR_IO, "%s: %s", path, strerror(errno));
  char *bytes = NULL;
  size_t size = 0;
  cellist_result result = read_all(context, path, file, &bytes, &size);
  fclose(file);
  if (result == CELLIST_SUCCESS) result = cellist_surface_read_memory(context, path, bytes, size, colour, surface);
  cellist_deallocate(context, bytes);
  return result;
}
