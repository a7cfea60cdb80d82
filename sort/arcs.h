/* SPDX-License-Identifier: BSD-3-Clause
 * The inner loop of the topological sort: which cells lie directly in front of a batch of cells. Private to sort/. */
#ifndef CELLIST_SORT_ARCS_H
#define CELLIST_SORT_ARCS_H

#include <stddef.h>
#include <stdint.h>

#include "signs/kernel.h"

/* Lists the neighbours across the faces that bits 0-3 of each cell's state name, cell by cell, face by face.
 * tets: [count]. ahead: [count] cells whose neighbours are to come from memory meanwhile. arcs: room for 4 count + 4;
 * returns how many there are. *states: all the cells' states or-ed. */
typedef size_t (*sort_arc_kernel)(const uint32_t *neighbours, const uint8_t *state, const uint32_t *tets, size_t count,
                                  const uint32_t *ahead, uint32_t *arcs, uint32_t *states);

size_t sort_list_arcs_portable(const uint32_t *neighbours, const uint8_t *state, const uint32_t *tets, size_t count,
                               const uint32_t *ahead, uint32_t *arcs, uint32_t *states);

/* The same; only where sort_has_avx2() says so. */
size_t sort_list_arcs_avx2(const uint32_t *neighbours, const uint8_t *state, const uint32_t *tets, size_t count,
                           const uint32_t *ahead, uint32_t *arcs, uint32_t *states);

#endif
