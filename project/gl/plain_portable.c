/* SPDX-License-Identifier: BSD-3-Clause
 * Plain cells for any processor. */
#define LANES_PORTABLE
#include "plain_kernel.h"

void gl_plain_portable(const gl_cells *cells, const uint32_t tets[GL_PLAIN_LANES], gl_plain *out) {
  plain_prepare(cells, tets, out);
}
