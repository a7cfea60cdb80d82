/* SPDX-License-Identifier: BSD-3-Clause
 * Plain cells, four at a time: those with all corners before the eye and a place in the picture, whose faces have signs
 * that rounding cannot change and pictures that are no lines. They are most; what is not plain is left to cells.c and
 * records.c, which have it exact. Private. */
#ifndef CELLIST_GL_PLAIN_H
#define CELLIST_GL_PLAIN_H

#include "cells.h"

enum { GL_PLAIN_LANES = 4 };

/* Four cells' footprints and records. */
typedef struct gl_plain {
  unsigned left;                                             /* bit per lane: not plain, nothing is written */
  unsigned nothing;                                          /* plain, but nothing of it can be seen */
  float records[GL_PLAIN_LANES][GL_RECORD_FLOATS];           /* without light */
  float footprints[GL_PLAIN_LANES][GL_FOOTPRINT_CORNERS][2]; /* in the picture, -1..1 */
  uint8_t corner_count[GL_PLAIN_LANES];                      /* of the footprint */
  gl_shown shown[GL_PLAIN_LANES];
  float longest[GL_PLAIN_LANES]; /* edge, in units */
} gl_plain;

/* The cells are four; tets may repeat. Threads: any. */
typedef void gl_plain_kernel(const gl_cells *cells, const uint32_t tets[GL_PLAIN_LANES], gl_plain *out);

gl_plain_kernel gl_plain_portable;
/* Only where __builtin_cpu_supports("avx2") and "fma". */
gl_plain_kernel gl_plain_avx2;

#endif
