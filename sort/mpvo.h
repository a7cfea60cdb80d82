/* SPDX-License-Identifier: BSD-3-Clause
 * Order by the faces that cells share. Private to sort/. */
#ifndef CELLIST_SORT_MPVO_H
#define CELLIST_SORT_MPVO_H

#include "sorter.h"

/* Fills order and stats->exact. */
void sort_by_faces(cellist_sorter *sorter, const sort_eye *eye, uint32_t *order, cellist_sort_stats *stats);

#endif
