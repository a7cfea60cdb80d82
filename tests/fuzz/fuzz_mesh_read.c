/* SPDX-License-Identifier: BSD-3-Clause
 * Fuzz target: telling the format from the content. */
#include <cellist/mesh.h>

#include "fuzz_formats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static cellist_result read_any(cellist_context *context, const struct source *source, struct grid *grid) {
  cellist_mesh *mesh = NULL;
  (void)grid;
  const cellist_result result =
      cellist_mesh_read_memory(context, source->name, source->bytes, source->size, NULL, &mesh);
  cellist_mesh_destroy(mesh);
  return result == CELLIST_SUCCESS ? CELLIST_ERROR_NOT_FOUND : result; /* there is no grid to go on with */
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) { return fuzz_read(read_any, "fuzz", data, size, 1032); }
