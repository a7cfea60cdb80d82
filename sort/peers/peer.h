/* SPDX-License-Identifier: BSD-3-Clause
 * What the peers share. Private to sort/peers/. */
#ifndef CELLIST_SORT_PEER_H
#define CELLIST_SORT_PEER_H

#include <cellist/sort_peers.h>

#include "../view.h"

/* A cell with a key that puts it in its place: ascending is far to near. */
typedef struct peer_item {
  uint32_t key, tet;
} peer_item;

/* What a peer does; release may be NULL. */
typedef struct peer_kind {
  const char *name;
  cellist_result (*prepare)(cellist_peer *peer);
  cellist_result (*sort)(cellist_peer *peer, const sort_eye *eye, uint32_t *order);
  void (*release)(cellist_peer *peer);
} peer_kind;

struct cellist_peer {
  cellist_context *context;
  cellist_sorter_desc mesh;
  const struct peer_kind *kind;
  float *centres;   /* [4 tet_count] x y z and what is subtracted from the squared distance */
  float *planes;    /* [16 tet_count] mpvo_nc: outward normal and offset of each face */
  peer_item *items; /* [2 tet_count] */
  uint32_t *stack;  /* [tet_count] mpvo_nc */
  uint8_t *visited;
  struct peer_bsp_xmpvo *bsp_xmpvo;
};

/* Fills items with the cells' keys (of boundary cells only, if wanted) and returns how many. */
size_t peer_fill_items(cellist_peer *peer, const sort_eye *eye, bool boundary_only);

/* Stable, in three passes of 11 bits; uses items[count] to items[2 count - 1] too. Returns where the sorted ones are.
 */
peer_item *peer_radix_sort(peer_item *items, size_t count);

/* peers.c: room for centres and items; centroids. */
cellist_result peer_prepare_centroids(cellist_peer *peer);

/* mpvo_nc.c */
cellist_result peer_prepare_mpvo_nc(cellist_peer *peer);
cellist_result peer_sort_mpvo_nc(cellist_peer *peer, const sort_eye *eye, uint32_t *order);

/* bsp_xmpvo.c */
cellist_result peer_prepare_bsp_xmpvo(cellist_peer *peer);
cellist_result peer_sort_bsp_xmpvo(cellist_peer *peer, const sort_eye *eye, uint32_t *order);
void peer_release_bsp_xmpvo(cellist_peer *peer);

#endif
