/* SPDX-License-Identifier: BSD-3-Clause
 * The kernel of pre-integration for AVX2, reached only where the processor has it. */
#include "preintegration_kernel.h"

_Static_assert(GATHERED_VECTORS * 8 <= PREINTEGRATION_SCRATCH, "the scratch is too small");

void preintegration_fill_avx2(const preintegration_job *job, uint32_t step, float *scratch) {
  fill_step(job, step, scratch);
}
