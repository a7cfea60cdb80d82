/* SPDX-License-Identifier: BSD-3-Clause
 * Fuzz target: MEDIT. */
#include <formats/read.h>

#include "fuzz_formats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  return fuzz_read(read_medit, "fuzz.mesh", data, size, 1);
}
