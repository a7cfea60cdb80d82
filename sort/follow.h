/* SPDX-License-Identifier: BSD-3-Clause
 * Arcs other than those across cells' faces: gap arcs, or links to and from large imaginary cells. Private to sort/. */
#ifndef CELLIST_SORT_FOLLOW_H
#define CELLIST_SORT_FOLLOW_H

#include "sorter.h"

/* Marks the cells that arcs leave, and counts all arcs that lead to a cell as one more cell behind it. */
void sort_follow_begin(cellist_sorter *sorter);

/* Large cells with nothing behind them are out: puts what that makes ready at the queue's end; returns its length. */
size_t sort_follow_farthest(cellist_sorter *sorter, uint32_t *queue, size_t count);

/* A cell that arcs leave is out: as above. */
size_t sort_follow(cellist_sorter *sorter, uint32_t cell, uint32_t *queue, size_t count);

#endif
