/* SPDX-License-Identifier: BSD-3-Clause
 * Sectors: what is around an edge. Turning about an edge, counter-clockwise seen against its direction, every facet of
 * a cell either ends a sector of the cell or begins one. Input edges where more than two boundary faces meet need no
 * case of their own this way: "the two triangles of an edge" made overlapping caps in a prototype. */
#include "work.h"

/* The direction of the edge along axis k: sign of v[1] less v[0]. */
static int edge_sign(work *w, const work_edge *e, int k) { return exact_compare_axis(w, e->v[1], e->v[0], k); }

int sector_turn(work *w, uint32_t edge, uint32_t plane_a, uint32_t plane_b) {
  if (plane_a == plane_b) return 0;
  const work_edge *e = &w->edges.items[edge];
  const double *p = w->vertices.items[e->v[0]].p, *q = w->vertices.items[e->v[1]].p;
  int k = 0;
  for (int i = 1; i < 3; i++)
    if (fabs(q[i] - p[i]) > fabs(q[k] - p[k])) k = i;
  int along = edge_sign(w, e, k);
  for (int i = 0; along == 0 && i < 3; i++) along = edge_sign(w, e, k = i);
  return along * exact_cross(w, plane_a, plane_b, k);
}

/* The direction of an event's facet, and where the cell is: the facet's inside is direction * (normal x edge), and
 * turning goes on to the side direction * normal. */
static work_event event_of(const work *w, uint32_t use, int side) {
  const work_use *u = &w->uses.items[use];
  const int8_t direction = u->forward ? 1 : -1;
  return (work_event){use, u->facet, (uint8_t)side, direction, (direction > 0) == (side == 1)};
}

/* 0: same direction as the reference; 1: below 180 degrees; 2: opposite; 3: above. */
static int turn_class(work *w, uint32_t edge, const work_event *reference, const work_event *other) {
  const uint32_t a = w->facets.items[reference->facet].plane, b = w->facets.items[other->facet].plane;
  const int directions = reference->direction * other->direction;
  const int turn = directions * sector_turn(w, edge, a, b);
  if (turn != 0) return turn > 0 ? 1 : 3;
  const int same = a == b ? 1 : exact_same_direction(w, a, b);
  return directions * same > 0 ? 0 : 2;
}

int sector_angle(work *w, uint32_t edge, const work_event *begin, const work_event *end) {
  const int class = turn_class(w, edge, begin, end);
  if (class == 1) return 1;
  /* In one direction: all around (a slit); a contact of no extent would have been refused before. */
  return class == 2 ? 0 : -1;
}

static bool comes_before(work *w, uint32_t edge, const work_event *reference, const work_event *a,
                         const work_event *b) {
  const int class_a = turn_class(w, edge, reference, a), class_b = turn_class(w, edge, reference, b);
  if (class_a != class_b) return class_a < class_b;
  if (class_a == 1 || class_a == 3) {
    const int turn = a->direction * b->direction *
                     sector_turn(w, edge, w->facets.items[a->facet].plane, w->facets.items[b->facet].plane);
    if (turn != 0) return turn > 0;
  }
  return a->closing && !b->closing; /* the two sides of one facet */
}

void sectors_gather(work *w, uint32_t edge, uint32_t cell) {
  w->events.count = 0;
  for (uint32_t u = w->edges.items[edge].first_use; u != CELLIST_NONE; u = w->uses.items[u].next_in_edge) {
    const work_facet *f = &w->facets.items[w->uses.items[u].facet];
    for (int side = 0; side < 2; side++)
      if (f->cells[side] == cell) list_push(w, &w->events, event_of(w, u, side));
  }
  const size_t count = w->events.count;
  work_event *events = w->events.items;
  if (count > 2) {
    const work_event reference = events[0];
    for (size_t i = 1; i < count; i++)
      for (size_t j = i; j > 0 && comes_before(w, edge, &reference, &events[j], &events[j - 1]); j--) {
        const work_event swap = events[j];
        events[j] = events[j - 1];
        events[j - 1] = swap;
      }
  }
  bool sound = count % 2 == 0;
  if (count > 0 && events[0].closing) { /* begin with a beginning */
    const work_event first = events[0];
    memmove(events, events + 1, (count - 1) * sizeof *events);
    events[count - 1] = first;
  }
  for (size_t i = 0; i < count; i++) sound &= events[i].closing == (i % 2 == 1);
  if (sound) return;
  uint32_t tet = CELLIST_NONE;
  for (size_t i = 0; i < count; i++)
    for (int side = 0; side < 2; side++) {
      const uint32_t other = w->facets.items[events[i].facet].cells[side];
      if (other < w->mesh->tet_count) tet = w->mesh->tet_origin[other];
    }
  work_stop(w, CELLIST_ERROR_GEOMETRY, "the surface around cell %u does not bound a volume", tet);
}

work_event sector_mate(work *w, uint32_t use, int side) {
  const work_use *u = &w->uses.items[use];
  const uint32_t cell = w->facets.items[u->facet].cells[side];
  /* Two events, as nearly everywhere: each other's mates, no order needed. */
  uint32_t other = CELLIST_NONE;
  int other_side = 0, count = 0;
  for (uint32_t i = w->edges.items[u->edge].first_use; i != CELLIST_NONE; i = w->uses.items[i].next_in_edge) {
    const work_facet *f = &w->facets.items[w->uses.items[i].facet];
    for (int s = 0; s < 2; s++) {
      if (f->cells[s] != cell || (i == use && s == side)) continue;
      other = i;
      other_side = s;
      count++;
    }
  }
  if (count == 1) return event_of(w, other, other_side);
  sectors_gather(w, u->edge, cell);
  for (size_t i = 0; i < w->events.count; i++)
    if (w->events.items[i].use == use && w->events.items[i].side == side) return w->events.items[i ^ 1];
  return event_of(w, use, side);
}

uint32_t sector_reflex_cell(work *w, uint32_t edge) {
  for (uint32_t u = w->edges.items[edge].first_use; u != CELLIST_NONE; u = w->uses.items[u].next_in_edge) {
    for (int side = 0; side < 2; side++) {
      const uint32_t cell = w->facets.items[w->uses.items[u].facet].cells[side];
      if (!is_piece(w, cell)) continue;
      const work_event own = event_of(w, u, side);
      if (own.closing) continue;
      const work_event mate = sector_mate(w, u, side);
      if (sector_angle(w, edge, &own, &mate) < 0) return cell;
    }
  }
  return CELLIST_NONE;
}

void edge_own(work *w, uint32_t edge, uint32_t cell) {
  work_edge *e = &w->edges.items[edge];
  if (e->reflex_cell == cell) return;
  if (e->reflex_cell != CELLIST_NONE) {
    work_piece *piece = piece_of(w, e->reflex_cell);
    (e->is_flat ? &piece->flat : &piece->reflex)->live--;
    w->reflex_count -= !e->is_flat;
  }
  e->reflex_cell = cell;
  if (cell == CELLIST_NONE) return;
  e->is_flat = flat_edge(w, edge, cell);
  work_piece *piece = piece_of(w, cell);
  set_push(w, e->is_flat ? &piece->flat : &piece->reflex, edge);
  w->reflex_count += !e->is_flat;
}
