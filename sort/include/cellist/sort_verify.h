/* SPDX-License-Identifier: BSD-3-Clause
 * Sort verification: is an order right? By rays, with a traversal that shares nothing with the sorter, and by a
 * certificate in linear time. A check of arcs alone would pass some wrong orders; rays alone see samples only. */
#ifndef CELLIST_SORT_VERIFY_H
#define CELLIST_SORT_VERIFY_H

#include <cellist/sort.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cellist_verifier cellist_verifier;

/* What rays found. */
typedef struct cellist_verification {
  size_t ray_count;   /* rays that met at least one cell */
  size_t pairs;       /* cells that follow each other on a ray, not both in one group */
  size_t inversions;  /* pairs of which the nearer one stands first in the order */
  size_t group_pairs; /* cells that follow each other on a ray, both in one group */
  size_t overlaps;    /* cells that follow each other but overlap, as in folded meshes: no order is right; in no count
                         above */
} cellist_verification;

/* Makes a verifier: boxes around runs of tets.
 * Arrays: mesh's are borrowed, neighbours are not looked at. *verifier is the caller's.
 * Errors: INVALID_ARGUMENT (NULL), OUT_OF_MEMORY.
 * Threads: one call per context at a time. Cost: linear; fast checks need cells in Hilbert order. */
CELLIST_API cellist_result cellist_verifier_create(cellist_context *context, const cellist_sorter_desc *mesh,
                                                   cellist_verifier **verifier);

/* Frees the verifier; NULL is legal. */
CELLIST_API void cellist_verifier_destroy(cellist_verifier *verifier);

/* Casts rays of the view through random places of random tets and looks at every two cells that follow each other.
 * Parts of rays shorter than 1e-9 of the mesh's diagonal count as a touch, not as a crossing. Arrays: order has
 * tet_count entries, groups group_count; found is filled. Errors: INVALID_ARGUMENT (NULL, order is no permutation, a
 * group out of range), OUT_OF_MEMORY. Threads: one call per verifier at a time, using the context's workers; the same
 * result for any number of them. Cost: some 20 us a ray in a mesh of a million tets. */
CELLIST_API cellist_result cellist_verifier_check(cellist_verifier *verifier, const cellist_viewpoint *viewpoint,
                                                  const uint32_t *order, const cellist_group *groups,
                                                  size_t group_count, size_t ray_count, uint64_t seed,
                                                  cellist_verification *found);

/* What a certificate holds: each face that two cells share has the farther one first, decided exactly. */
typedef struct cellist_certificate {
  size_t faces;       /* shared faces whose plane does not hold the eye, not inside a group */
  size_t violations;  /* faces with the nearer cell first */
  size_t group_faces; /* shared faces inside a group */
} cellist_certificate;

/* Checks that order is a permutation, that groups are ranges of it, ascending and apart, and each shared face.
 * Arrays: as for cellist_verifier_check; mesh needs neighbours.
 * Errors: INVALID_ARGUMENT (as above; the message says what), OUT_OF_MEMORY.
 * Threads: one call per context at a time. Cost: linear, some 50 ns a tet. */
CELLIST_API cellist_result cellist_order_certify(cellist_context *context, const cellist_sorter_desc *mesh,
                                                 const cellist_viewpoint *viewpoint, const uint32_t *order,
                                                 const cellist_group *groups, size_t group_count,
                                                 cellist_certificate *found);

#ifdef __cplusplus
}
#endif
#endif
