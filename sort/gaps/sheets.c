/* SPDX-License-Identifier: BSD-3-Clause
 * Sheets: union-find over the few faces at hand. */
#include "sheets.h"

#include <math.h>

static uint32_t find_root(sort_sheets *sheets, uint32_t at) {
  while (sheets->roots[at] != at) {
    sheets->roots[at] = sheets->roots[sheets->roots[at]];
    at = sheets->roots[at];
  }
  return at;
}

static bool stands_at(const sort_sheets *sheets, uint32_t face, uint32_t place) {
  return place < sheets->count && sheets->faces[place] == face;
}

void sort_sheets_begin(sort_sheets *sheets) {
  sheets->count = 0;
  sheets->hidden_depth = HUGE_VALF;
  sheets->hidden_height = HUGE_VAL;
}

void sort_sheets_add(sort_sheets *sheets, const sort_boundary *boundary, uint32_t face, uint32_t crossing,
                     float farthest, double highest) {
  if (sheets->count == SORT_SHEET_LIMIT) return;
  const uint32_t own = (uint32_t)sheets->count++;
  sheets->faces[own] = face;
  sheets->roots[own] = own;
  sheets->missing[own] = 0;
  sheets->farthest[own] = farthest;
  sheets->highest[own] = highest;
  sheets->places[face] = own;
  for (uint32_t k = 0; k < 3; k++) {
    if (!(crossing >> k & 1)) continue;
    const uint32_t mate = boundary->mates[3 * (size_t)face + k], a = find_root(sheets, own);
    if (mate == CELLIST_NONE || !stands_at(sheets, mate, sheets->places[mate])) {
      sheets->missing[a]++;
      continue;
    }
    const uint32_t b = find_root(sheets, sheets->places[mate]);
    sheets->missing[b]--; /* the mate was without this face until now */
    if (a == b) continue;
    sheets->roots[b] = a;
    sheets->missing[a] += sheets->missing[b];
    sheets->farthest[a] = fmaxf(sheets->farthest[a], sheets->farthest[b]);
    sheets->highest[a] = fmax(sheets->highest[a], sheets->highest[b]);
  }
  const uint32_t root = find_root(sheets, own);
  if (sheets->missing[root] > 0) return;
  sheets->hidden_depth = fminf(sheets->hidden_depth, sheets->farthest[root]);
  sheets->hidden_height = fmin(sheets->hidden_height, sheets->highest[root]);
}
