/* SPDX-License-Identifier: BSD-3-Clause
 * A cell's state in one view, in a byte. Private to sort/.
 *
 * Bits 0-3: the neighbour across that face lies in front. Bit 4: other arcs lead from it to nearer cells. Bits 5-7: how
 * many cells behind it are not out (and one more for other arcs), less one: so taking off the last one carries out of
 * the byte, and the inner loop of the topological sort needs no test. */
#ifndef CELLIST_SORT_STATE_H
#define CELLIST_SORT_STATE_H

#include <stdbool.h>
#include <stdint.h>

enum {
  SORT_HAS_ARCS = 0x10,
  SORT_WAIT = 0x20, /* for each cell to wait for, on top of SORT_READY, modulo 256 */
  SORT_READY = 0xE0,
  SORT_HELD = 0xC0 /* waits for seven cells: more than there can be */
};

static inline bool sort_is_waiting(uint8_t state) { return state < SORT_READY; }

/* One cell less to wait for; true if it was the last one. */
static inline bool sort_let_go(uint8_t *state) { return __builtin_sub_overflow(*state, SORT_WAIT, state); }

#endif
