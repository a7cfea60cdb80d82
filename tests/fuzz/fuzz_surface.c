/* SPDX-License-Identifier: BSD-3-Clause
 * Surface files in memory; the first byte chooses the format. */
#include <cellist/surface.h>
#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const char *const names[] = {"f.stl", "f.obj", "f.ply"};
  static cellist_context *context = NULL;
  if (size == 0) return 0;
  const cellist_context_desc desc = {.worker_count = 1};
  if (context == NULL && cellist_context_create(&desc, &context) != CELLIST_SUCCESS) return 0;
  cellist_surface *surface = NULL;
  cellist_surface_read_memory(context, names[data[0] % 3], data + 1, size - 1, NULL, &surface);
  cellist_surface_destroy(surface);
  cellist_context_take_error(context);
  return 0;
}
