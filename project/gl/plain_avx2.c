/* SPDX-License-Identifier: BSD-3-Clause
 * Plain cells for AVX2 and FMA, compiled for these alone and reached only where the processor has them. */
#include "plain_kernel.h"

void gl_plain_avx2(const gl_cells *cells, const uint32_t tets[GL_PLAIN_LANES], gl_plain *out) {
  plain_prepare(cells, tets, out);
}
