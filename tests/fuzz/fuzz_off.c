/* SPDX-License-Identifier: BSD-3-Clause
 * Fuzz target: OFF with scalars. */
#include <formats/read.h>

#include "fuzz_formats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) { return fuzz_read(read_off, "fuzz.off", data, size, 1); }
