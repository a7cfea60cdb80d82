/* SPDX-License-Identifier: BSD-3-Clause
 * Fuzz target: PLOT3D, a solution beside the grid. */
#include <formats/read.h>

#include "fuzz_formats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  return fuzz_read(read_plot3d, "fuzz.xyz", data, size, 1);
}
