/* SPDX-License-Identifier: BSD-3-Clause
 * Sort peers: how others order cells, as honest baselines for time and for wrong pairs. Not for use in a renderer. */
#ifndef CELLIST_SORT_PEERS_H
#define CELLIST_SORT_PEERS_H

#include <cellist/sort.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cellist_peer cellist_peer;

/* The name of peer i, or NULL from the last one on:
 * "centroid"          distance of the cells' centres, radix sort of 32-bit keys in three passes of 11 bits (VTK's way)
 * "centroid_compare"  the same keys, introsort (what std::sort is)
 * "mpvo_nc"           MPVO for non-convex meshes (Williams 1992): depth-first from the boundary cells in order of
 *                     distance
 * "power"             power distance to the circumspheres (Cignoni, De Floriani 1998): exact for Delaunay meshes
 * "bsp_xmpvo"         MPVO, and a BSP tree of the boundary for what lies across gaps (Comba et al. 1999): exact for
 *                     meshes without cycles
 * Threads: any. */
CELLIST_API const char *cellist_peer_name(size_t i);

/* Prepares a peer for a mesh.
 * Arrays: mesh's are borrowed. *peer is the caller's.
 * Errors: INVALID_ARGUMENT (NULL), NOT_FOUND (no such name; the message lists them), OUT_OF_MEMORY.
 * Threads: one call per context at a time.
 * Cost: linear; bsp_xmpvo: some 10 us a boundary face. The mesh is not checked: a sorter does that. */
CELLIST_API cellist_result cellist_peer_create(cellist_context *context, const cellist_sorter_desc *mesh,
                                               const char *name, cellist_peer **peer);

/* Frees the peer; NULL is legal. */
CELLIST_API void cellist_peer_destroy(cellist_peer *peer);

/* Writes the peer's order for a view, far to near. It uses one thread (bsp_xmpvo: the context's, for signs).
 * Arrays: order has tet_count entries.
 * Errors: INVALID_ARGUMENT (NULL), OUT_OF_MEMORY (bsp_xmpvo: a view needs more than those before).
 * Threads: one call per peer at a time. Cost: linear; introsort n log n; bsp_xmpvo: and boundary faces times cells that
 * wait for nearer ones. */
CELLIST_API cellist_result cellist_peer_sort(cellist_peer *peer, const cellist_viewpoint *viewpoint, uint32_t *order);

#ifdef __cplusplus
}
#endif
#endif
