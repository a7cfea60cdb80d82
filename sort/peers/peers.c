/* SPDX-License-Identifier: BSD-3-Clause
 * Peers: centroid and power sort, as fast as they reasonably get on one thread: centres are made once, in floats; keys
 * are a float's bits. VTK's projected tetrahedra are ordered by centroids (vtkCellCenterDepthSort). */
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

static inline bool is_less(peer_item a, peer_item b) {
  return ((uint64_t)a.key << 32 | a.tet) < ((uint64_t)b.key << 32 | b.tet);
}

/* The heap's item at `at` moves down to its place. */
static void sift(peer_item *items, size_t at, size_t count) {
  const peer_item moving = items[at];
  for (size_t child = 2 * at + 1; child < count; child = 2 * at + 1) {
    if (child + 1 < count && is_less(items[child], items[child + 1])) child++;
    if (!is_less(moving, items[child])) break;
    items[at] = items[child];
    at = child;
  }
  items[at] = moving;
}

static void heapsort(peer_item *items, size_t count) {
  for (size_t i = count / 2; i-- > 0;) sift(items, i, count);
  for (size_t i = count; i-- > 1;) {
    const peer_item last = items[i];
    items[i] = items[0];
    items[0] = last;
    sift(items, 0, i);
  }
}

/* Introsort (Musser 1997), which std::sort is: quicksort by the median of three, heapsort where that goes wrong. Runs
 * of up to 16 stay as they are. */
static void introsort(peer_item *items, size_t count, unsigned depth) {
  while (count > 16) {
    if (depth-- == 0) {
      heapsort(items, count);
      return;
    }
    const peer_item a = items[0], b = items[count / 2], c = items[count - 1];
    const peer_item low = is_less(a, b) ? a : b, high = is_less(a, b) ? b : a;
    const peer_item pivot = is_less(c, low) ? low : is_less(high, c) ? high : c;
    size_t i = 0, j = count - 1;
    for (;;) {
      while (is_less(items[i], pivot)) i++;
      while (is_less(pivot, items[j])) j--;
      if (i >= j) break;
      const peer_item swap = items[i];
      items[i++] = items[j];
      items[j--] = swap;
    }
    introsort(&items[j + 1], count - (j + 1), depth);
    count = j + 1;
  }
}

static void sort_items(peer_item *items, size_t count) {
  introsort(items, count, count > 1 ? 2 * (unsigned)(63 - __builtin_clzll(count)) : 1);
  for (size_t i = 1; i < count; i++) {
    const peer_item moving = items[i];
    size_t at = i;
    for (; at > 0 && is_less(moving, items[at - 1]); at--) items[at] = items[at - 1];
    items[at] = moving;
  }
}

static cellist_result sort_by_radix(cellist_peer *peer, const sort_eye *eye, uint32_t *order) {
  const size_t count = peer_fill_items(peer, eye, false);
  const peer_item *sorted = peer_radix_sort(peer->items, count);
  for (size_t i = 0; i < count; i++) order[i] = sorted[i].tet;
  return CELLIST_SUCCESS;
}

static cellist_result sort_by_comparison(cellist_peer *peer, const sort_eye *eye, uint32_t *order) {
  const size_t count = peer_fill_items(peer, eye, false);
  sort_items(peer->items, count);
  for (size_t i = 0; i < count; i++) order[i] = peer->items[i].tet;
  return CELLIST_SUCCESS;
}

static cellist_result allocate_items(cellist_peer *peer) {
  peer->centres = cellist_allocate(peer->context, peer->mesh.tet_count, 4 * sizeof *peer->centres);
  peer->items = cellist_allocate(peer->context, peer->mesh.tet_count, 2 * sizeof *peer->items);
  return peer->centres != NULL && peer->items != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

cellist_result peer_prepare_centroids(cellist_peer *peer) {
  const cellist_result result = allocate_items(peer);
  if (result == CELLIST_SUCCESS) make_centroids(peer);
  return result;
}

static cellist_result prepare_circumspheres(cellist_peer *peer) {
  const cellist_result result = allocate_items(peer);
  if (result == CELLIST_SUCCESS) make_circumspheres(peer);
  return result;
}

static const peer_kind kinds[] = {
    {"centroid", peer_prepare_centroids, sort_by_radix, NULL},
    {"centroid_compare", peer_prepare_centroids, sort_by_comparison, NULL},
    {"mpvo_nc", peer_prepare_mpvo_nc, peer_sort_mpvo_nc, NULL},
    {"power", prepare_circumspheres, sort_by_radix, NULL},
    {"bsp_xmpvo", peer_prepare_bsp_xmpvo, peer_sort_bsp_xmpvo, peer_release_bsp_xmpvo},
};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

const char *cellist_peer_name(size_t i) { return i < KIND_COUNT ? kinds[i].name : NULL; }

cellist_result cellist_peer_create(cellist_context *context, const cellist_sorter_desc *mesh, const char *name,
                                   cellist_peer **peer) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || name == NULL || peer == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_peer_create: NULL");
  size_t which = 0;
  while (which < KIND_COUNT && strcmp(kinds[which].name, name) != 0) which++;
  if (which == KIND_COUNT)
    return cellist_fail(context, CELLIST_ERROR_NOT_FOUND,
                        "no peer '%s'; there are: centroid, centroid_compare, mpvo_nc, power, bsp_xmpvo", name);
  cellist_peer *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->mesh = *mesh;
  created->kind = &kinds[which];
  const cellist_result result = created->kind->prepare(created);
  if (result == CELLIST_SUCCESS)
    *peer = created;
  else
    cellist_peer_destroy(created);
  return result;
}

void cellist_peer_destroy(cellist_peer *peer) {
  if (peer == NULL) return;
  if (peer->kind->release != NULL) peer->kind->release(peer);
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
  return peer->kind->sort(peer, &eye, order);
}
