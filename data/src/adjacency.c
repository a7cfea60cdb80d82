/* SPDX-License-Identifier: BSD-3-Clause
 * Adjacency: which tets share a face.
 *
 * Faces are dealt into buckets by their lowest point id (a counting sort: 16 bytes a tet) and matched inside each
 * bucket by their other two ids. Two tets are neighbours only if they are the face's only two and lie on its two
 * sides: a fold (both on one side) or a face of three tets would give a sorter contradictory arcs and a ray two ways
 * out, so these stay boundary and are counted. Which side is combinatorial: the parity of the face's corners as
 * seen from outside. Flat tets have no side of their own, so they are turned to suit their neighbours first. */
#include "mesh_private.h"

#include <cellist/radix.h>
#include <string.h>

struct face_key {
  uint32_t low, middle, high;
  bool odd; /* the outward corners are an odd permutation of (low, middle, high) */
};

static struct face_key face_key_of(const uint32_t *tets, uint32_t face) {
  const uint32_t *v = &tets[face & ~3u];
  const uint8_t *corner = CELLIST_TET_FACE[face & 3];
  uint32_t a = v[corner[0]], b = v[corner[1]], c = v[corner[2]];
  bool odd = false;
  uint32_t swap;
  if (a > b) swap = a, a = b, b = swap, odd = !odd;
  if (b > c) swap = b, b = c, c = swap, odd = !odd;
  if (a > b) swap = a, a = b, b = swap, odd = !odd;
  return (struct face_key){a, b, c, odd};
}

/* Scratch of one bucket, grown to the largest. */
struct bucket {
  uint64_t *keys, *scratch_keys;
  uint32_t *scratch_faces;
  size_t capacity;
};

static cellist_result bucket_reserve(cellist_context *context, struct bucket *bucket, size_t count) {
  if (count <= bucket->capacity) return CELLIST_SUCCESS;
  cellist_deallocate(context, bucket->keys);
  cellist_deallocate(context, bucket->scratch_keys);
  cellist_deallocate(context, bucket->scratch_faces);
  bucket->capacity = 2 * count;
  bucket->keys = cellist_allocate(context, bucket->capacity, sizeof *bucket->keys);
  bucket->scratch_keys = cellist_allocate(context, bucket->capacity, sizeof *bucket->scratch_keys);
  bucket->scratch_faces = cellist_allocate(context, bucket->capacity, sizeof *bucket->scratch_faces);
  const bool ok = bucket->keys != NULL && bucket->scratch_keys != NULL && bucket->scratch_faces != NULL;
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

static void sort_bucket(struct bucket *bucket, uint32_t *faces, size_t count) {
  /* Below this an insertion sort is faster than the radix sort's fixed cost; only speed depends on it. */
  enum { INSERTION_LIMIT = 128 };
  uint64_t *keys = bucket->keys;
  if (count > INSERTION_LIMIT) {
    cellist_radix_sort(keys, faces, count, bucket->scratch_keys, bucket->scratch_faces, 64);
    return;
  }
  for (size_t i = 1; i < count; i++) {
    const uint64_t key = keys[i];
    const uint32_t face = faces[i];
    size_t j = i;
    for (; j > 0 && keys[j - 1] > key; j--) {
      keys[j] = keys[j - 1];
      faces[j] = faces[j - 1];
    }
    keys[j] = key;
    faces[j] = face;
  }
}

/* faces[] sorted so that those with the same three points are next to each other. */
static cellist_result sort_faces(cellist_context *context, size_t point_count, size_t tet_count, const uint32_t *tets,
                                 uint32_t *faces) {
  uint32_t *start = cellist_allocate_zeroed(context, point_count + 2, sizeof *start);
  if (start == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  const uint32_t face_count = (uint32_t)(4 * tet_count);
  for (uint32_t f = 0; f < face_count; f++) start[face_key_of(tets, f).low + 2]++;
  for (size_t i = 2; i < point_count + 2; i++) start[i] += start[i - 1];
  for (uint32_t f = 0; f < face_count; f++) faces[start[face_key_of(tets, f).low + 1]++] = f;

  struct bucket bucket = {0};
  cellist_result result = CELLIST_SUCCESS;
  for (size_t point = 0; point < point_count && result == CELLIST_SUCCESS; point++) {
    uint32_t *own = &faces[start[point]];
    const size_t count = start[point + 1] - start[point];
    result = bucket_reserve(context, &bucket, count);
    if (result != CELLIST_SUCCESS) break;
    for (size_t i = 0; i < count; i++) {
      const struct face_key key = face_key_of(tets, own[i]);
      bucket.keys[i] = (uint64_t)key.middle << 32 | key.high;
    }
    sort_bucket(&bucket, own, count);
  }
  cellist_deallocate(context, bucket.keys);
  cellist_deallocate(context, bucket.scratch_keys);
  cellist_deallocate(context, bucket.scratch_faces);
  cellist_deallocate(context, start);
  return result;
}

static bool same_points(struct face_key a, struct face_key b) {
  return a.low == b.low && a.middle == b.middle && a.high == b.high;
}

/* Fills mate[face] = the face of the other tet, for faces of exactly two tets; CELLIST_NONE otherwise. */
static void match_faces(size_t tet_count, const uint32_t *tets, const uint32_t *faces, uint32_t *mate,
                        cellist_mesh_facts *facts) {
  const size_t face_count = 4 * tet_count;
  for (size_t begin = 0, end; begin < face_count; begin = end) {
    const struct face_key key = face_key_of(tets, faces[begin]);
    for (end = begin + 1; end < face_count && same_points(key, face_key_of(tets, faces[end])); end++) {
    }
    for (size_t i = begin; i < end; i++) mate[faces[i]] = CELLIST_NONE;
    if (end - begin == 2) {
      mate[faces[begin]] = faces[begin + 1];
      mate[faces[begin + 1]] = faces[begin];
    } else if (end - begin > 2) {
      facts->overfull_face_count++;
    }
  }
}

/* Mirrors a tet by exchanging its corners 2 and 3, and with them the faces opposite to these. */
static void mirror(uint32_t *tets, uint32_t *mate, size_t tet) {
  uint32_t *v = &tets[4 * tet], *m = &mate[4 * tet];
  uint32_t swap = v[2];
  v[2] = v[3];
  v[3] = swap;
  swap = m[2];
  m[2] = m[3];
  m[3] = swap;
  for (uint32_t k = 2; k < 4; k++)
    if (m[k] != CELLIST_NONE) mate[m[k]] = (uint32_t)(4 * tet + k);
}

/* Turns a flat tet so that most faces which it shares with settled tets are seen from their two sides. */
static void settle(uint32_t *tets, uint32_t *mate, uint8_t *settled, size_t tet) {
  int agreement = 0;
  for (uint32_t k = 0; k < 4; k++) {
    const uint32_t face = (uint32_t)(4 * tet + k), other = mate[face];
    if (other == CELLIST_NONE || !settled[other / 4]) continue;
    agreement += face_key_of(tets, face).odd != face_key_of(tets, other).odd ? 1 : -1;
  }
  if (agreement < 0) mirror(tets, mate, tet);
  settled[tet] = 1;
}

/* Settles all flat tets, from those next to sound ones inwards; a part with flat tets only keeps its first one. */
static cellist_result turn_flat_tets(cellist_context *context, size_t tet_count, uint32_t *tets,
                                     const uint8_t *tet_flags, size_t flat_count, uint32_t *mate) {
  if (flat_count == 0) return CELLIST_SUCCESS;
  /* Each flat tet is queued by a neighbour at most four times, and once more by the scans. */
  uint32_t *queue = cellist_allocate(context, flat_count, 5 * sizeof *queue);
  uint8_t *settled = cellist_allocate(context, tet_count, 1);
  cellist_result result = queue != NULL && settled != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) {
    size_t head = 0, tail = 0;
    for (size_t i = 0; i < tet_count; i++) settled[i] = (tet_flags[i] & CELLIST_TET_FLAT) == 0;
    for (size_t i = 0; i < tet_count; i++) {
      bool touches = false;
      for (size_t f = 4 * i; f < 4 * i + 4; f++) touches |= mate[f] != CELLIST_NONE && settled[mate[f] / 4];
      if (!settled[i] && touches) queue[tail++] = (uint32_t)i;
    }
    for (size_t seed = 0; seed < tet_count || head < tail;) {
      size_t tet = head < tail ? queue[head++] : seed++;
      if (settled[tet]) continue;
      settle(tets, mate, settled, tet);
      for (size_t f = 4 * tet; f < 4 * tet + 4; f++)
        if (mate[f] != CELLIST_NONE && !settled[mate[f] / 4]) queue[tail++] = mate[f] / 4;
    }
  }
  cellist_deallocate(context, queue);
  cellist_deallocate(context, settled);
  return result;
}

cellist_result mesh_link_neighbours(cellist_context *context, size_t point_count, size_t tet_count, uint32_t *tets,
                                    const uint8_t *tet_flags, uint32_t *neighbours, cellist_mesh_facts *facts) {
  uint32_t *faces = cellist_allocate(context, tet_count, 4 * sizeof *faces);
  if (faces == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = sort_faces(context, point_count, tet_count, tets, faces);
  uint32_t *mate = neighbours; /* faces until the last step */
  if (result == CELLIST_SUCCESS) match_faces(tet_count, tets, faces, mate, facts);
  cellist_deallocate(context, faces);
  if (result == CELLIST_SUCCESS) result = turn_flat_tets(context, tet_count, tets, tet_flags, facts->flat_count, mate);
  if (result != CELLIST_SUCCESS) return result;

  for (uint32_t f = 0; f < 4 * tet_count; f++) {
    const uint32_t other = mate[f];
    if (other == CELLIST_NONE || other < f) continue;
    if (face_key_of(tets, f).odd == face_key_of(tets, other).odd) {
      facts->folded_face_count++;
      mate[f] = mate[other] = CELLIST_NONE;
    }
  }
  for (size_t f = 0; f < 4 * tet_count; f++) {
    if (mate[f] == CELLIST_NONE)
      facts->boundary_face_count++;
    else
      neighbours[f] = mate[f] / 4;
  }
  return CELLIST_SUCCESS;
}
