/* SPDX-License-Identifier: BSD-3-Clause
 * Boundary: the surface of the mesh as the exterior sees it ([C] section 6.1, steps 1 and 2).
 *
 * Points with equal coordinates become one vertex, so an unmerged seam is a surface in contact with itself, face on
 * face: such pairs part two tets, bound no exterior, and become facets of the complex as they are. Flat tets at the
 * surface are peeled off, since what bounds the exterior has to have an inside; the sort keeps them as neighbours. */
#include "work.h"

static uint32_t cell_of(const work *w, uint32_t tet) { return w->mesh->tet_origin[tet]; }

/* peeled[tet]: flat, and reached from outside through flat tets only. */
static void peel_flat_tets(work *w, uint8_t *peeled) {
  const cellist_mesh_arrays *mesh = w->mesh;
  id_list *queue = &w->ids;
  queue->count = 0;
  for (size_t t = 0; t < mesh->tet_count; t++) {
    peeled[t] = 0;
    if ((mesh->tet_flags[t] & CELLIST_TET_FLAT) == 0) continue;
    for (size_t k = 0; k < 4 && !peeled[t]; k++) peeled[t] = mesh->neighbours[4 * t + k] == CELLIST_NONE;
    if (peeled[t]) list_push(w, queue, (uint32_t)t);
  }
  while (queue->count > 0) {
    const size_t t = queue->items[--queue->count];
    for (size_t k = 0; k < 4; k++) {
      const uint32_t next = mesh->neighbours[4 * t + k];
      if (next == CELLIST_NONE || peeled[next] || (mesh->tet_flags[next] & CELLIST_TET_FLAT) == 0) continue;
      peeled[next] = 1;
      list_push(w, queue, next);
    }
  }
}

static uint64_t hash_position(const double *p) {
  uint64_t h = 0;
  for (int k = 0; k < 3; k++) {
    const double value = p[k] + 0.0; /* -0 equals 0 */
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    h = work_mix(h ^ bits);
  }
  return h;
}

static size_t table_size(size_t count) {
  size_t size = 16;
  while (size < 2 * count) size *= 2;
  return size;
}

static void table_clear(work *w, id_list *table, size_t size) {
  work_reserve(w, table, size, sizeof *table->items);
  table->count = size;
  memset(table->items, 0xff, size * sizeof *table->items);
}

/* The vertex of a mesh point, made at its first use; equal coordinates give one vertex. */
static uint32_t vertex_of(work *w, uint32_t point) {
  if (w->point_vertex.items[point] != CELLIST_NONE) return w->point_vertex.items[point];
  const double *p = &w->mesh->positions[3 * (size_t)point];
  const size_t mask = w->edge_table.count - 1;
  size_t slot = hash_position(p) & mask;
  for (; w->edge_table.items[slot] != CELLIST_NONE; slot = (slot + 1) & mask) {
    const uint32_t vertex = w->edge_table.items[slot];
    const double *q = &w->mesh->positions[3 * (size_t)w->vertices.items[vertex].point];
    if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) return w->point_vertex.items[point] = vertex;
  }
  const uint32_t vertex = exact_add_point(w, p, point);
  w->edge_table.items[slot] = vertex;
  return w->point_vertex.items[point] = vertex;
}

/* Takes pairs of faces on the same three vertices out of the boundary. */
static void pair_contacts(work *w) {
  table_clear(w, &w->edge_table, table_size(w->boundary.count));
  const size_t mask = w->edge_table.count - 1;
  id_list *gone = &w->ids;
  gone->count = 0;
  work_reserve(w, gone, w->boundary.count + 1, sizeof *gone->items);
  memset(gone->items, 0, w->boundary.count * sizeof *gone->items);
  for (size_t f = 0; f < w->boundary.count; f++) {
    const boundary_face *face = &w->boundary.items[f];
    uint32_t key[3] = {face->v[0], face->v[1], face->v[2]};
    const bool odd = work_sort3(key);
    size_t slot = work_mix(work_mix(work_mix(key[0]) ^ key[1]) ^ key[2]) & mask;
    for (;; slot = (slot + 1) & mask) {
      const uint32_t other = w->edge_table.items[slot];
      if (other == CELLIST_NONE) {
        w->edge_table.items[slot] = (uint32_t)f;
        break;
      }
      const boundary_face *o = &w->boundary.items[other];
      uint32_t other_key[3] = {o->v[0], o->v[1], o->v[2]};
      const bool other_odd = work_sort3(other_key);
      if (memcmp(key, other_key, sizeof key) != 0) continue;
      if (odd == other_odd || gone->items[other])
        work_stop(w, CELLIST_ERROR_GEOMETRY, "cells %u and %u lie on the same side of a face that they share",
                  cell_of(w, face->tet), cell_of(w, o->tet));
      gone->items[f] = gone->items[other] = 1;
      const uint32_t contact[5] = {o->tet, face->tet, o->v[0], o->v[1], o->v[2]};
      for (int i = 0; i < 5; i++) list_push(w, &w->contacts, contact[i]);
      break;
    }
  }
  size_t kept = 0;
  for (size_t f = 0; f < w->boundary.count; f++)
    if (!gone->items[f]) w->boundary.items[kept++] = w->boundary.items[f];
  w->boundary.count = kept;
}

/* More bits than this from the lowest one of a coordinate to the mesh's extent, and products of the highest degree
 * (21, a turn of three meets) would not fit WIDE_LIMBS. */
enum { BIT_LIMIT = 1200 };

static void begin_exact(work *w, const uint8_t *peeled) {
  const cellist_mesh_arrays *mesh = w->mesh;
  double extent = 0, largest = 0;
  int lowest = 4096;
  for (int k = 0; k < 3; k++) {
    extent = fmax(extent, mesh->bounds[3 + k] / 2 - mesh->bounds[k] / 2);
    for (int side = 0; side < 2; side++) {
      const int exponent = wide_lowest_exponent(mesh->bounds[3 * side + k]);
      lowest = exponent < lowest ? exponent : lowest;
      largest = fmax(largest, fabs(mesh->bounds[3 * side + k]));
    }
  }
  for (size_t t = 0; t < mesh->tet_count; t++) {
    if (peeled[t]) continue;
    for (size_t k = 0; k < 4; k++) {
      const uint32_t next = mesh->neighbours[4 * t + k];
      if (next != CELLIST_NONE && !peeled[next]) continue;
      for (size_t c = 0; c < 4; c++) {
        if (c == k) continue;
        const double *p = &mesh->positions[3 * (size_t)mesh->tets[4 * t + c]];
        for (int i = 0; i < 3; i++) {
          const int exponent = wide_lowest_exponent(p[i]);
          lowest = exponent < lowest ? exponent : lowest;
        }
      }
    }
  }
  int power = 0, highest = 0;
  frexp(extent, &power);
  frexp(largest, &highest);
  const int bits = w->desc.exterior == CELLIST_EXTERIOR_DELAUNAY ? MESHER_BITS : ADDED_BITS;
  if (power - bits < lowest) lowest = power - bits;
  if (highest - lowest > BIT_LIMIT)
    work_stop(w, CELLIST_ERROR_UNSUPPORTED, "coordinates from 2^%d to 2^%d: exact planes would need more than %d bits",
              lowest, highest, BIT_LIMIT);
  exact_begin(w, mesh->bounds, lowest);
}

void boundary_gather(work *w) {
  const cellist_mesh_arrays *mesh = w->mesh;
  work_reserve(w, &w->sorted, mesh->tet_count / 4 + 1, sizeof *w->sorted.items);
  uint8_t *peeled = (uint8_t *)w->sorted.items;
  peel_flat_tets(w, peeled);
  begin_exact(w, peeled);
  work_reserve(w, &w->point_vertex, mesh->point_count + 1, sizeof *w->point_vertex.items);
  w->point_vertex.count = mesh->point_count;
  memset(w->point_vertex.items, 0xff, mesh->point_count * sizeof *w->point_vertex.items);
  size_t count = 0;
  for (int pass = 0; pass < 2; pass++) {
    if (pass == 1) table_clear(w, &w->edge_table, table_size(3 * count));
    for (size_t t = 0; t < mesh->tet_count; t++) {
      if (peeled[t]) continue;
      for (size_t k = 0; k < 4; k++) {
        const uint32_t next = mesh->neighbours[4 * t + k];
        if (next != CELLIST_NONE && !peeled[next]) continue;
        count += pass == 0;
        if (pass == 0) continue;
        boundary_face face = {.tet = (uint32_t)t, .plane = CELLIST_NONE};
        for (size_t c = 0; c < 3; c++) face.v[c] = vertex_of(w, mesh->tets[4 * t + CELLIST_TET_FACE[k][c]]);
        list_push(w, &w->boundary, face);
      }
    }
  }
  pair_contacts(w);
  for (size_t f = 0; f < w->boundary.count; f++) {
    boundary_face *face = &w->boundary.items[f];
    face->plane = exact_add_plane(w, face->v[0], face->v[1], face->v[2]);
    if (face->plane == CELLIST_NONE)
      work_stop(w, CELLIST_ERROR_GEOMETRY, "cell %u has a boundary face of no area", cell_of(w, face->tet));
  }
}
