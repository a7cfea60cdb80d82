/* SPDX-License-Identifier: BSD-3-Clause
 * Each cell's place in an order. Private to sort/. */
#ifndef CELLIST_SORT_RANKS_H
#define CELLIST_SORT_RANKS_H

#include <cellist/sort.h>

/* ranks[tet]: its place in the order, or its group's first place.
 * Errors: INVALID_ARGUMENT (order is no permutation, groups are not ascending ranges of it). */
cellist_result sort_ranks(cellist_context *context, size_t tet_count, const uint32_t *order,
                          const cellist_group *groups, size_t group_count, uint32_t *ranks);

#endif
