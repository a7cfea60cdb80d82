/* SPDX-License-Identifier: BSD-3-Clause
 * Peers: centroid and power sort, as fast as they reasonably get on one thread: centres are made once, in floats; keys
 * are a float's bits. VTK's projected tetrahedra
 * are ordered by centroids (vtkCellCenterDepthSort). */
#include <math.h>
#include <string.h>

#include "peer.h"

static void make_centroids(cellist_peer *peer) {
  const cellist_sorter_desc *mesh = &peer->mesh;
  for (size_t i = 0; i < mesh->tet_count; i++) {
    for (size_t k = 0; k < 3; k++) {
      double sum = 0;
      for (size_t c = 0; c < 4; c++) sum += 0.25 * mesh->points[3 * (size_t)mesh->tets[4 * i + c] + k];
      peer->centres[4 * i + k] = (float)sum;
    }
    peer->centres[4 * i + 3] = 0;
  }
}

/* Circumspheres: the eye's power, |eye - centre|^2 - radius^2, orders the cells of a Delaunay mesh. */
static void make_circumspheres(cellist_peer *peer) {
  const cellist_sorter_desc *mesh = &peer->mesh;
  for (size_t i = 0; i < mesh->tet_count; i++) {
    const double *a = &mesh->points[3 * (size_t)mesh->tets[4 * i]];
    double e[3][3], square[3], cross[3][3], centre[3];
    for (size_t j = 0; j < 3; j++) {
      square[j] = 0;
      for (size_t k = 0; k < 3; k++) {
        e[j][k] = mesh->points[3 * (size_t)mesh->tets[4 * i + j + 1] + k] - a[k];
        square[j] += e[j][k] * e[j][k];
      }
    }
    double volume = 0, radius = 0;
    for (size_t j = 0; j < 3; j++) {
      const double *u = e[(j + 1) % 3], *w = e[(j + 2) % 3];
      for (size_t k = 0; k < 3; k++) cross[j][k] = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
    }
    for (size_t k = 0; k < 3; k++) volume += e[0][k] * cross[0][k];
    for (size_t k = 0; k < 3; k++) {
      centre[k] = 0;
      for (size_t j = 0; j < 3 && volume != 0; j++) centre[k] += square[j] * cross[j][k] / (2 * volume);
      radius += centre[k] * centre[k];
      peer->centres[4 * i + k] = (float)(a[k] + centre[k]);
    }
    peer->centres[4 * i + 3] = (float)radius;
  }
}

size_t peer_fill_items(cellist_peer *peer, const sort_eye *eye, bool boundary_only) {
  const float at[3] = {(float)eye->at[0], (float)eye->at[1], (float)eye->at[2]};
  const uint32_t *neighbours = peer->mesh.neighbours;
  size_t count = 0;
  for (size_t i = 0; i < peer->mesh.tet_count; i++) {
    if (boundary_only && neighbours[4 * i] != CELLIST_NONE && neighbours[4 * i + 1] != CELLIST_NONE &&
        neighbours[4 * i + 2] != CELLIST_NONE && neighbours[4 * i + 3] != CELLIST_NONE)
      continue;
    const float *centre = &peer->centres[4 * i];
    float nearness = 0;
    if (eye->parallel) {
      nearness = centre[0] * at[0] + centre[1] * at[1] + centre[2] * at[2];
    } else {
      const float x = centre[0] - at[0], y = centre[1] - at[1], z = centre[2] - at[2];
      nearness = centre[3] - (x * x + y * y + z * z);
    }
    uint32_t bits = 0;
    memcpy(&bits, &nearness, sizeof bits);
    peer->items[count++] = (peer_item){bits >> 31 ? ~bits : bits | 0x80000000u, (uint32_t)i};
  }
  return count;
}

peer_item *peer_radix_sort(peer_item *items, size_t count) {
  enum { BITS = 11, SIZE = 1 << BITS };
  uint32_t starts[3][SIZE];
  memset(starts, 0, sizeof starts);
  for (size_t i = 0; i < count; i++)
    for (unsigned pass = 0; pass < 3; pass++) starts[pass][items[i].key >> (BITS * pass) & (SIZE - 1)]++;
  for (unsigned pass = 0; pass < 3; pass++) {
    uint32_t sum = 0;
    for (size_t b = 0; b < SIZE; b++) {
      const uint32_t here = starts[pass][b];
      starts[pass][b] = sum;
      sum += here;
    }
  }
  peer_item *from = items, *to = &items[count];
  for (unsigned pass = 0; pass < 3; pass++) {
    for (size_t i = 0; i < count; i++) to[starts[pass][from[i].key >> (BITS * pass) & (SIZE - 1)]++] = from[i];
    peer_item *swap = from;
    from = to;
    to = swap;
  }
  return from;
}

static bool is_less(peer_item a, peer_item b) { return a.key < b.key || (a.key == b.key && a.tet < b.tet); }

/* Quicksort by the median of three, insertion sort below 24, the smaller side first. */
static void quicksort(peer_item *items, size_t count) {
  while (count > 24) {
    peer_item a = items[0], b = items[count / 2], c = items[count - 1];
    const peer_item pivot = is_less(a, b) ? (is_less(b, c)   ? b
                                             : is_less(a, c) ? c
                                                             : a)
                                          : (is_less(a, c)   ? a
                                             : is_less(b, c) ? c
                                                             : b);
    size_t i = 0, j = count - 1;
    for (;;) {
      while (is_less(items[i], pivot)) i++;
      while (is_less(pivot, items[j])) j--;
      if (i >= j) break;
      const peer_item swap = items[i];
      items[i++] = items[j];
      items[j--] = swap;
    }
    const size_t split = j + 1;
    if (split < count - split) {
      quicksort(items, split);
      items += split;
      count -= split;
    } else {
      quicksort(&items[split], count - split);
      count = split;
    }
  }
  for (size_t i = 1; i < count; i++) {
    const peer_item moving = items[i];
    size_t at = i;
    for (; at > 0 && is_less(moving, items[at - 1]); at--) items[at] = items[at - 1];
    items[at] = moving;
  }
}

static void sort_by_radix(cellist_peer *peer, const sort_eye *eye, uint32_t *order) {
  const size_t count = peer_fill_items(peer, eye, false);
  const peer_item *sorted = peer_radix_sort(peer->items, count);
  for (size_t i = 0; i < count; i++) order[i] = sorted[i].tet;
}

static void sort_by_comparison(cellist_peer *peer, const sort_eye *eye, uint32_t *order) {
  const size_t count = peer_fill_items(peer, eye, false);
  quicksort(peer->items, count);
  for (size_t i = 0; i < count; i++) order[i] = peer->items[i].tet;
}

static const struct {
  const char *name;
  void (*sort)(cellist_peer *peer, const sort_eye *eye, uint32_t *order);
} peers[] = {{"centroid", sort_by_radix},
             {"centroid_compare", sort_by_comparison},
             {"mpvo_nc", peer_sort_mpvo_nc},
             {"power", sort_by_radix}};
enum { PEER_COUNT = sizeof peers / sizeof peers[0] };

const char *cellist_peer_name(size_t i) { return i < PEER_COUNT ? peers[i].name : NULL; }

cellist_result cellist_peer_create(cellist_context *context, const cellist_sorter_desc *mesh, const char *name,
                                   cellist_peer **peer) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || name == NULL || peer == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_peer_create: NULL");
  size_t which = 0;
  while (which < PEER_COUNT && strcmp(peers[which].name, name) != 0) which++;
  if (which == PEER_COUNT)
    return cellist_fail(context, CELLIST_ERROR_NOT_FOUND,
                        "no peer '%s'; there are: centroid, centroid_compare, mpvo_nc, power", name);
  cellist_peer *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->mesh = *mesh;
  created->sort = peers[which].sort;
  created->centres = cellist_allocate(context, mesh->tet_count, 4 * sizeof *created->centres);
  created->items = cellist_allocate(context, mesh->tet_count, 2 * sizeof *created->items);
  cellist_result result =
      created->centres != NULL && created->items != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS && created->sort == peer_sort_mpvo_nc) result = peer_prepare_mpvo_nc(created);
  if (result != CELLIST_SUCCESS) {
    cellist_peer_destroy(created);
    return result;
  }
  if (strcmp(name, "power") == 0)
    make_circumspheres(created);
  else
    make_centroids(created);
  *peer = created;
  return CELLIST_SUCCESS;
}

void cellist_peer_destroy(cellist_peer *peer) {
  if (peer == NULL) return;
  cellist_deallocate(peer->context, peer->centres);
  cellist_deallocate(peer->context, peer->planes);
  cellist_deallocate(peer->context, peer->items);
  cellist_deallocate(peer->context, peer->stack);
  cellist_deallocate(peer->context, peer->visited);
  cellist_deallocate(peer->context, peer);
}

cellist_result cellist_peer_sort(cellist_peer *peer, const cellist_viewpoint *viewpoint, uint32_t *order) {
  if (peer == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (viewpoint == NULL || (order == NULL && peer->mesh.tet_count > 0))
    return cellist_fail(peer->context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_peer_sort: NULL");
  const sort_eye eye = sort_eye_of(viewpoint);
  peer->sort(peer, &eye, order);
  return CELLIST_SUCCESS;
}
