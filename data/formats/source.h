/* SPDX-License-Identifier: BSD-3-Clause
 * Source: the bytes of a file, and the messages about them. Private to data/.
 *
 * A file is mapped, so that its bytes cost no memory of ours and a hostile one is only read where a reader looks; a
 * pipe is read into memory as it grows. */
#ifndef CELLIST_FORMATS_SOURCE_H
#define CELLIST_FORMATS_SOURCE_H

#include "grid.h"

struct source {
  const char *name; /* as the user gave it, "standard input" for "-" */
  const uint8_t *bytes;
  size_t size;
  const char *solution; /* PLOT3D: the user's name of the file with the variables, or NULL */
  void *mapped;         /* how source_close gives the bytes back */
  void *owned_bytes;
  char *owned_name;
  /* Opens a file named in this one. NULL: files beside it cannot be read (standard input, memory). */
  cellist_result (*open_beside)(cellist_context *context, const struct source *source, const char *name,
                                struct source *opened);
};

/* Opens path, or standard input for "-". IO with the path and the system's reason. */
cellist_result source_open(cellist_context *context, const char *path, struct source *source);

/* A source over bytes that the caller keeps; name too. */
struct source source_of_memory(const char *name, const void *bytes, size_t size);

/* Opens name, relative to the folder of source's own path. */
cellist_result source_open_beside(cellist_context *context, const struct source *source, const char *name,
                                  struct source *opened);

/* Opens the file whose name is source's with its last suffix_length characters replaced by suffix. *found: whether
 * there is one; there being none is no error. */
cellist_result source_try_sibling(cellist_context *context, const struct source *source, size_t suffix_length,
                                  const char *suffix, struct source *opened, bool *found);

/* Frees and zeroes; a zeroed source is legal. */
void source_close(cellist_context *context, struct source *source);

bool source_has_suffix(const struct source *source, const char *suffix);

/* "NAME: byte AT: reason", as FORMAT. */
cellist_result source_fail_at(cellist_context *context, const struct source *source, size_t at, const char *format, ...)
    CELLIST_PRINTF(4, 5);

/* "NAME: reason", as FORMAT. */
cellist_result source_fail(cellist_context *context, const struct source *source, const char *format, ...)
    CELLIST_PRINTF(3, 4);

#endif
