/* SPDX-License-Identifier: BSD-3-Clause
 * Fuzz target: TetGen, the points first, then the file that is beside them (as tets and as faces). */
#include <formats/read.h>

#include "fuzz_formats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  return fuzz_read(read_tetgen, "fuzz.node", data, size, 1);
}
