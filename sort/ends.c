/* SPDX-License-Identifier: BSD-3-Clause
 * Ends: two threads can work on one topological sort, one from behind and one from the front, without locks and with a
 * result that does not depend on chance, if each takes only cells of its own half. Whatever is then left waits for
 * cells of both halves: it comes out after the first thread's and before the second one's. The halves are of blocks of
 * cells that follow each other (in Hilbert order, so they are compact), parted by the distance of their centres; a bad
 * parting costs time, never the order. */
#include "ends.h"

#include <math.h>

enum { BINS = 1024 };

cellist_result sort_ends_create(cellist_context *context, const sort_cells *cells, sort_ends *ends) {
  const size_t count = (cells->count + SORT_BLOCK - 1) / SORT_BLOCK;
  ends->centres = cellist_allocate(context, count, 3 * sizeof *ends->centres);
  ends->depths = cellist_allocate(context, count, sizeof *ends->depths);
  ends->is_near = cellist_allocate(context, count, sizeof *ends->is_near);
  ends->mirrored = cellist_allocate_zeroed(context, count, SORT_BLOCK * sizeof *ends->mirrored);
  ends->queue = cellist_allocate(context, count / 2 + 1, SORT_BLOCK * sizeof *ends->queue);
  if (ends->centres == NULL || ends->depths == NULL || ends->is_near == NULL || ends->mirrored == NULL ||
      ends->queue == NULL)
    return CELLIST_ERROR_OUT_OF_MEMORY;
  ends->block_count = count;
  for (size_t block = 0; block < count; block++) {
    double sum[3] = {0, 0, 0};
    const size_t begin = block * SORT_BLOCK, last = begin + SORT_BLOCK;
    const size_t end = last < cells->count ? last : cells->count;
    for (size_t cell = begin; cell < end; cell++) {
      const double *p[3];
      sort_cell_face(cells, cell, 0, p);
      for (int k = 0; k < 3; k++) sum[k] += p[0][k] / 3 + p[1][k] / 3 + p[2][k] / 3;
    }
    for (size_t k = 0; k < 3; k++) ends->centres[3 * block + k] = (float)(sum[k] / (double)(end - begin));
  }
  return CELLIST_SUCCESS;
}

void sort_ends_release(cellist_context *context, sort_ends *ends) {
  cellist_deallocate(context, ends->centres);
  cellist_deallocate(context, ends->depths);
  cellist_deallocate(context, ends->is_near);
  cellist_deallocate(context, ends->mirrored);
  cellist_deallocate(context, ends->queue);
  *ends = (sort_ends){0};
}

void sort_ends_choose(sort_ends *ends, const sort_eye *eye) {
  const float at[3] = {(float)eye->at[0], (float)eye->at[1], (float)eye->at[2]};
  float low = HUGE_VALF, high = -HUGE_VALF;
  for (size_t i = 0; i < ends->block_count; i++) {
    const float *centre = &ends->centres[3 * i];
    const float x = centre[0] - at[0], y = centre[1] - at[1], z = centre[2] - at[2];
    const float depth =
        eye->parallel ? -(centre[0] * at[0] + centre[1] * at[1] + centre[2] * at[2]) : sqrtf(x * x + y * y + z * z);
    ends->depths[i] = depth;
    low = depth < low ? depth : low;
    high = depth > high ? depth : high;
  }
  /* All in one bin, or beyond what floats hold: no block is near, and all come out at the farther end. */
  size_t bins[BINS] = {0}, near = 0, cut = 0;
  const float scale = high - low > 0 ? (BINS - 1) / (high - low) : 0;
  const bool usable = scale > 0 && isfinite(scale);
  for (size_t i = 0; i < ends->block_count && usable; i++) bins[(size_t)((ends->depths[i] - low) * scale)]++;
  while (usable && cut < BINS && near + bins[cut] <= ends->block_count / 2) near += bins[cut++];
  for (size_t i = 0; i < ends->block_count; i++)
    ends->is_near[i] = usable && (size_t)((ends->depths[i] - low) * scale) < cut;
}
