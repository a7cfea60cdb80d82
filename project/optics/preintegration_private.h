/* SPDX-License-Identifier: BSD-3-Clause
 * What pre-integration and its kernels share. Private. */
#ifndef CELLIST_PREINTEGRATION_PRIVATE_H
#define CELLIST_PREINTEGRATION_PRIVATE_H

#include <cellist/preintegration.h>
#include <math.h>

/* A piece of the way from one node to the next on which extinction and colour are linear. */
typedef struct preintegration_piece {
  float place, width;  /* counted in nodes, place from the node before */
  float extinction[2]; /* per length unit, at its front and back; above 0 */
  float colour[2][3];
} preintegration_piece;

/* One direction along the scalar. Nodes are counted in that direction. */
typedef struct preintegration_job {
  uint32_t scalar_count, length_count;
  bool descending;
  const preintegration_piece *pieces;
  const uint32_t *piece_begin; /* [scalar_count] those from node i to i+1 begin here */
  const double *depths;        /* [scalar_count] integral of the extinction up to node i, node by node */
  const float *lengths;        /* [length_count + 7] in length units */
  float *ambient, *front, *back;
} preintegration_job;

/* Floats of scratch that a kernel needs for each node, beginning at a multiple of 32 bytes. */
enum { PREINTEGRATION_SCRATCH = 80 };

typedef void (*preintegration_kernel)(const preintegration_job *job, uint32_t step, float *scratch);
void preintegration_fill_avx2(const preintegration_job *job, uint32_t step, float *scratch);
void preintegration_fill_portable(const preintegration_job *job, uint32_t step, float *scratch);

/* For tests: updates use the kernel that any processor has. */
CELLIST_API void preintegration_use_portable(cellist_preintegration *tables);

#endif
