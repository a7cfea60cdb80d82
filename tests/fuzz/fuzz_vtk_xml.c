/* SPDX-License-Identifier: BSD-3-Clause
 * Fuzz target: VTU, PVTU and VTS. */
#include <formats/read.h>

#include "fuzz_formats.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* zlib's ratio; a .xz block of zeros can hold more, but not in as few bytes as libFuzzer makes. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  return fuzz_read(read_vtk_xml, "fuzz.vtu", data, size, 1032);
}
