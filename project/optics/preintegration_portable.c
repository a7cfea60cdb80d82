/* SPDX-License-Identifier: BSD-3-Clause
 * The kernel of pre-integration for any processor. */
#include "preintegration_kernel.h"

_Static_assert(GATHERED_VECTORS * 8 <= PREINTEGRATION_SCRATCH, "the scratch is too small");

void preintegration_fill_portable(const preintegration_job *job, uint32_t step, float *scratch) {
  fill_step(job, step, scratch);
}
