/* SPDX-License-Identifier: BSD-3-Clause
 * A part of the tets sorted alone. Private to sort/. */
#ifndef CELLIST_SORT_SUBSET_H
#define CELLIST_SORT_SUBSET_H

#include <cellist/sort.h>

/* The tets that are sorted, with numbers of their own in the order of their ids. */
typedef struct sort_subset {
  size_t tet_count, wanted_count;
  uint32_t *ids;   /* [tet_count] in the mesh; NULL: all tets are sorted and wanted */
  uint8_t *wanted; /* [tet_count] those that the order is to hold */
  uint8_t *cut;    /* [tet_count] bit k: across face k lies a tet that is left out */
  uint32_t *tets, *neighbours, *order;
  /* What is there of the complex; facets that left-out tets have are gone. */
  cellist_sorter_complex complex;
  uint32_t *facet_planes, *facet_cells;
} sort_subset;

/* Fills a zeroed subset, and replaces mesh by what is to be sorted; mesh->complex then refers to the subset.
 * wanted: [tet_count of mesh]. Errors: OUT_OF_MEMORY (what is there can be released). */
cellist_result sort_subset_create(cellist_context *context, const uint8_t *wanted, cellist_sorter_desc *mesh,
                                  sort_subset *subset);
void sort_subset_release(cellist_context *context, sort_subset *subset);

/* The neighbours with the tet itself across each cut face, so that no cut face is taken for the boundary's.
 * out: [4 tet_count], holding neighbours. */
void sort_subset_close_cuts(const sort_subset *subset, uint32_t *out);

/* Writes the wanted tets of subset->order by their ids in the mesh, and makes the groups theirs. Returns how many
 * groups are left. */
size_t sort_subset_take(const sort_subset *subset, uint32_t *order, cellist_group *groups, size_t group_count);

#endif
