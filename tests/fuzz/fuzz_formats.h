/* SPDX-License-Identifier: BSD-3-Clause
 * What the readers' fuzz targets share: a reader and the making of the mesh on the fuzzer's bytes, with an allocator
 * that stops the program when a block is larger than the bytes can justify.
 *
 * A file beside the first one follows it after a line "--8<--"; whatever name is asked for opens it. */
#ifndef CELLIST_TESTS_FUZZ_FORMATS_H
#define CELLIST_TESTS_FUZZ_FORMATS_H

#include <formats/source.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a reader may allocate at once: so many bytes for each of the file's, and a fixed part for the codecs, the XML
 * parser and scratch space. Six tets of some 120 bytes come of a hexahedron, which a structured grid of bytes makes
 * of 3 bytes. */
enum { FUZZ_FACTOR = 512, FUZZ_FIXED = 1 << 20, FUZZ_TOTAL = 1 << 28 };

struct fuzz_memory {
  size_t live, limit;
};

static void *fuzz_allocate(void *user, size_t size) {
  struct fuzz_memory *memory = user;
  if (size > memory->limit) {
    fprintf(stderr, "a block of %zu bytes, where the file justifies %zu\n", size, memory->limit);
    abort();
  }
  if (size > FUZZ_TOTAL - memory->live) return NULL;
  size_t *block = aligned_alloc(64, (size + 127) / 64 * 64);
  if (block == NULL) return NULL;
  *block = size;
  memory->live += size;
  return (char *)block + 64;
}

static void fuzz_deallocate(void *user, void *block) {
  struct fuzz_memory *memory = user;
  size_t *start = (size_t *)((char *)block - 64);
  memory->live -= *start;
  free(start);
}

static struct source fuzz_beside;

static inline cellist_result fuzz_open_beside(cellist_context *context, const struct source *source, const char *name,
                                              struct source *opened) {
  (void)source, (void)name;
  if (fuzz_beside.bytes == NULL) return cellist_fail(context, CELLIST_ERROR_IO, "there is no other file");
  *opened = fuzz_beside;
  opened->open_beside = fuzz_open_beside;
  return CELLIST_SUCCESS;
}

typedef cellist_result (*fuzz_reader)(cellist_context *context, const struct source *source, struct grid *grid);

/* extra_factor: the largest ratio of a codec. */
static inline int fuzz_read(fuzz_reader reader, const char *name, const uint8_t *data, size_t size,
                            size_t extra_factor) {
  static const char separator[] = "\n--8<--\n";
  struct fuzz_memory memory = {0, size * FUZZ_FACTOR * extra_factor + FUZZ_FIXED};
  const cellist_context_desc desc = {.allocator = {fuzz_allocate, fuzz_deallocate, &memory}, .worker_count = 1};
  cellist_context *context = NULL;
  if (cellist_context_create(&desc, &context) != CELLIST_SUCCESS) abort();
  struct source source = source_of_memory(name, data, size);
  source.open_beside = fuzz_open_beside;
  fuzz_beside = (struct source){0};
  for (size_t i = 0; i + sizeof separator <= size; i++)
    if (memcmp(data + i, separator, sizeof separator - 1) == 0) {
      const size_t begin = i + sizeof separator - 1;
      source.size = i + 1;
      fuzz_beside = source_of_memory("beside", data + begin, size - begin);
      break;
    }
  struct grid grid = {0};
  cellist_mesh *mesh = NULL;
  const cellist_mesh_read_desc read = {.merge = size % 2 == 1, .merge_distance = size % 4 == 3 ? 0.25 : 0};
  if (reader(context, &source, &grid) == CELLIST_SUCCESS &&
      grid_to_mesh(context, &grid, &read, &mesh) == CELLIST_SUCCESS)
    cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  if (memory.live != 0) abort();
  return 0;
}

#endif
