/* SPDX-License-Identifier: BSD-3-Clause
 * Cut: parts a piece by a plane ([C] section 6.1, the loop's steps 2 to 4), exactly.
 *
 * Vertices are classified; edges that cross are split, for all facets that use them; facets that cross are split along
 * their zero vertices, by parity: just above the line one is inside the facet after an odd number of its edges that
 * leave upwards, just below likewise, and where both hold a new edge is needed. Where the plane falls in a sector of
 * the piece at an edge, the cap has that edge. Unlike the paper's, caps are not triangulated (diagonals raise every
 * vertex's degree), and no vertex is moved onto the plane. */
#include "work.h"

static int side_of(work *w, uint32_t vertex, uint32_t plane) {
  work_vertex *v = &w->vertices.items[vertex];
  if (v->stamp != w->epoch) {
    const int sign = exact_side(w, vertex, plane);
    v->stamp = w->epoch;
    v->sign = (int8_t)sign;
  }
  return v->sign;
}

/* Bit 0: has vertices below the plane; bit 1: on it; bit 2: above. */
static int span_of(work *w, uint32_t facet, uint32_t plane) {
  int span = 0;
  for (EACH_USE(w, u, facet)) {
    const uint32_t *v = w->edges.items[w->uses.items[u].edge].v;
    if (span == 7) break;
    span |= 1 << (side_of(w, v[0], plane) + 1);
    span |= 1 << (side_of(w, v[1], plane) + 1);
  }
  return span;
}

/* w->touched: the piece's facets (each once) that the plane meets. False: all on one side, for sure. */
static bool gather_touched(work *w, uint32_t piece, uint32_t plane) {
  const uint32_t cell = piece_cell(w, piece);
  set_arrange(w, piece, SET_MEMBERS);
  const work_plane *p = &w->planes.items[plane];
  int all = set_near(w, &w->pieces.items[piece].members, p->normal, p->offset, 0, &w->near);
  w->touched.count = 0;
  for (size_t i = 0; i < w->near.count; i++) {
    const uint32_t member = w->near.items[i];
    if (!set_holds(w, cell, SET_MEMBERS, member)) continue;
    const int span = span_of(w, member / 2, plane);
    all |= span;
    if (span != 1 && span != 4) list_push(w, &w->touched, member / 2);
  }
  return (all & 5) == 5;
}

/* A vertex may touch the inside of an edge or a facet that does not know it: where the input meets an old cap from the
 * other side, say. As long as nothing passes through it this is harmless; here it becomes a common vertex, or what the
 * touch parts would count as connected. w->zeros: the piece's vertices on the plane. */
static void gather_zeros(work *w) {
  w->zeros.count = 0;
  w->epoch_edges++;
  for (size_t i = 0; i < w->touched.count; i++)
    for (EACH_USE(w, u, w->touched.items[i]))
      for (int end = 0; end < 2; end++) {
        const uint32_t v = w->edges.items[w->uses.items[u].edge].v[end];
        work_vertex *vertex = &w->vertices.items[v];
        if (vertex->sign != 0 || vertex->visited == w->epoch_edges) continue;
        vertex->visited = w->epoch_edges;
        list_push(w, &w->zeros, v);
      }
}

static uint32_t meet_or_touch(work *w, const work_edge *line, uint32_t plane) {
  const uint32_t meet = exact_add_meet(w, line, plane);
  for (size_t i = 0; i < w->zeros.count; i++) {
    const uint32_t zero = w->zeros.items[i];
    if (exact_compare(w, zero, meet) != 0) continue;
    w->vertices.count--;
    return zero;
  }
  return meet;
}

static void split_edge(work *w, uint32_t edge, uint32_t plane) {
  const work_edge line = w->edges.items[edge];
  const uint32_t middle = meet_or_touch(w, &line, plane);
  w->vertices.items[middle].stamp = w->epoch;
  w->vertices.items[middle].sign = 0;
  const uint32_t added = work_add_edge(w, middle, line.v[1], line.line[0], line.line[1], line.line_is_points);
  w->edges.items[edge].v[1] = middle;
  for (uint32_t u = line.first_use; u != CELLIST_NONE; u = w->uses.items[u].next_in_edge)
    work_add_use(w, w->uses.items[u].facet, added, w->uses.items[u].forward);
  edge_own(w, added, line.reflex_cell);
}

static void split_edges(work *w, uint32_t plane) {
  w->ids.count = 0;
  for (size_t i = 0; i < w->touched.count; i++)
    for (EACH_USE(w, u, w->touched.items[i])) {
      work_edge *e = &w->edges.items[w->uses.items[u].edge];
      if (e->stamp == w->epoch) continue;
      e->stamp = w->epoch;
      if (side_of(w, e->v[0], plane) * side_of(w, e->v[1], plane) < 0) list_push(w, &w->ids, w->uses.items[u].edge);
    }
  gather_zeros(w);
  for (size_t i = 0; i < w->ids.count; i++) split_edge(w, w->ids.items[i], plane);
}

/* Zero vertices of a facet, sorted along the line, in w->hits as vertex, up, down. */
static void gather_crossings(work *w, uint32_t facet) {
  id_list *hits = &w->hits;
  hits->count = 0;
  for (EACH_USE(w, u, facet)) {
    const uint32_t *v = w->edges.items[w->uses.items[u].edge].v;
    for (int end = 0; end < 2; end++) {
      if (w->vertices.items[v[end]].sign != 0) continue;
      const int other = w->vertices.items[v[1 - end]].sign;
      size_t at = 0;
      while (at < hits->count && hits->items[at] != v[end]) at += 3;
      if (at == hits->count)
        for (int i = 0; i < 3; i++) list_push(w, hits, i == 0 ? v[end] : 0);
      hits->items[at + 1] += other > 0;
      hits->items[at + 2] += other < 0;
    }
  }
  for (size_t i = 3; i < hits->count; i += 3)
    for (size_t j = i; j > 0 && exact_compare(w, hits->items[j], hits->items[j - 3]) < 0; j -= 3)
      for (size_t k = 0; k < 3; k++) {
        const uint32_t swap = hits->items[j + k];
        hits->items[j + k] = hits->items[j - 3 + k];
        hits->items[j - 3 + k] = swap;
      }
}

static bool has_edge(const work *w, uint32_t facet, uint32_t a, uint32_t b) {
  for (EACH_USE(w, u, facet)) {
    const uint32_t *v = w->edges.items[w->uses.items[u].edge].v;
    if ((v[0] == a && v[1] == b) || (v[0] == b && v[1] == a)) return true;
  }
  return false;
}

/* New edges from a to b, parted at zero vertices that touch the facet in between; into w->split. */
static void add_new_edges(work *w, uint32_t a, uint32_t b, uint32_t plane, uint32_t facet_plane) {
  for (;;) {
    uint32_t next = b;
    for (size_t i = 0; i < w->zeros.count; i++) {
      const uint32_t zero = w->zeros.items[i];
      if (exact_compare(w, zero, a) > 0 && exact_compare(w, zero, next) < 0 && exact_side(w, zero, facet_plane) == 0)
        next = zero;
    }
    list_push(w, &w->split, work_add_edge(w, a, next, plane, facet_plane, false));
    if (next == b) return;
    a = next;
  }
}

/* Splits a facet that has vertices on both sides; what is below becomes a new facet. */
static void split_facet(work *w, uint32_t facet, uint32_t plane) {
  gather_crossings(w, facet);
  const work_facet old = w->facets.items[facet];
  const uint32_t below = facet_beside(w, facet);

  /* New edges, where the line is inside both just above and just below and no slit lies there. */
  w->split.count = 0;
  int above_parity = 0, below_parity = 0;
  size_t gaps = 0; /* chords: runs of the line inside the facet */
  bool in_chord = false;
  for (size_t i = 0; i + 3 < w->hits.count; i += 3) {
    const uint32_t a = w->hits.items[i], b = w->hits.items[i + 3];
    above_parity ^= w->hits.items[i + 1] & 1;
    below_parity ^= w->hits.items[i + 2] & 1;
    const bool is_chord = above_parity && below_parity;
    gaps += is_chord && !in_chord;
    in_chord = is_chord;
    if (!is_chord || has_edge(w, facet, a, b)) continue;
    add_new_edges(w, a, b, plane, old.plane);
  }

  /* Which way a new edge runs around the upper part: its inside is to the left of the use, seen from the facet's
   * positive side; the direction a to b has it there if (normal x direction) points up. */
  uint32_t upper = CELLIST_NONE;
  for (uint32_t u = old.first_use, next; u != CELLIST_NONE; u = next) {
    work_use *use = &w->uses.items[u];
    next = use->next_in_facet;
    const uint32_t *v = w->edges.items[use->edge].v;
    int sign = w->vertices.items[v[0]].sign != 0 ? w->vertices.items[v[0]].sign : w->vertices.items[v[1]].sign;
    if (sign == 0) /* along the line: inside above if normal x direction points up, n_plane . (n_facet x d) > 0 */
      sign = sector_turn(w, use->edge, plane, old.plane) * (use->forward ? 1 : -1);
    if (sign > 0) {
      use->next_in_facet = upper;
      upper = u;
    } else {
      use->facet = below;
      use->next_in_facet = w->facets.items[below].first_use;
      w->facets.items[below].first_use = u;
    }
  }
  w->facets.items[facet].first_use = upper;
  for (size_t i = 0; i < w->split.count; i++) {
    const uint32_t edge = w->split.items[i];
    const bool forward_above = sector_turn(w, edge, plane, old.plane) > 0;
    work_add_use(w, facet, edge, forward_above);
    work_add_use(w, below, edge, !forward_above);
  }
  list_push(w, &w->touched, below);
  if (gaps == 1 && w->hits.count <= 6) return;
  /* Met more than once, by a vertex at least: the parts may have come apart. */
  facet_part(w, facet);
  facet_part(w, below);
}

static int facet_sign(const work *w, uint32_t facet) {
  for (EACH_USE(w, u, facet)) {
    const uint32_t *v = w->edges.items[w->uses.items[u].edge].v;
    if (w->vertices.items[v[0]].sign != 0) return w->vertices.items[v[0]].sign;
    if (w->vertices.items[v[1]].sign != 0) return w->vertices.items[v[1]].sign;
  }
  return 0;
}

/* Of w->events, which come in counter-clockwise order from some start: the first one above the plane (sign 1) or below
 * it (-1), counting from the plane on; NULL: none. */
static const work_event *first_beyond(work *w, uint32_t edge, int sign) {
  const size_t count = w->events.count;
  const work_event *events = w->events.items;
  size_t beyond = 0;
  for (size_t i = 0; i < count; i++) {
    if (facet_sign(w, events[i].facet) != sign) continue;
    if (count == 1 || facet_sign(w, events[(i + count - 1) % count].facet) != sign) return &events[i];
    beyond++;
  }
  /* All of them: the first one follows the widest gap, which holds the other half. */
  for (size_t i = 0; i < beyond; i++) {
    const work_event *e = &events[i];
    bool is_first = true;
    for (size_t j = 0; j < count && is_first; j++) {
      const work_event *o = &events[j];
      if (o == e) continue;
      is_first = e->direction * o->direction *
                     sector_turn(w, edge, w->facets.items[e->facet].plane, w->facets.items[o->facet].plane) >
                 0;
    }
    if (is_first) return e;
  }
  return NULL;
}

/* Whether the piece is on the cap's place to the left (right) of an edge in the plane: the next event ends the piece.
 */
static void cap_at_edge(work *w, uint32_t edge, uint32_t cell, uint32_t plane) {
  sectors_gather(w, edge, cell);
  const work_event *left = NULL, *right = NULL;
  bool beyond = false;
  for (size_t i = 0; i < w->events.count; i++) {
    const work_event *e = &w->events.items[i];
    const uint32_t own = w->facets.items[e->facet].plane;
    if (facet_sign(w, e->facet) != 0)
      beyond = true;
    else if (e->direction * (own == plane ? 1 : exact_same_direction(w, own, plane)) > 0)
      left = e;
    else
      right = e;
  }
  if (!beyond) return;
  const work_event *first_upper = first_beyond(w, edge, 1), *first_lower = first_beyond(w, edge, -1);
  const work_event *after_left = first_upper != NULL ? first_upper : right != NULL ? right : first_lower;
  const work_event *after_right = first_lower != NULL ? first_lower : left != NULL ? left : first_upper;
  const work_edge *e = &w->edges.items[edge];
  cap_use cap = {.edge = edge, .loop = CELLIST_NONE};
  if (left == NULL && after_left->closing) {
    cap.from = e->v[0];
    cap.to = e->v[1];
    cap.forward = true;
    list_push(w, &w->cap_uses, cap);
  }
  if (right == NULL && after_right->closing) {
    cap.from = e->v[1];
    cap.to = e->v[0];
    cap.forward = false;
    list_push(w, &w->cap_uses, cap);
  }
}

static void gather_cap(work *w, uint32_t cell, uint32_t plane) {
  w->cap_uses.count = 0;
  w->on_plane.count = 0;
  w->epoch_edges++;
  for (size_t i = 0; i < w->touched.count; i++)
    for (EACH_USE(w, u, w->touched.items[i])) {
      work_edge *e = &w->edges.items[w->uses.items[u].edge];
      if (w->vertices.items[e->v[0]].sign != 0 || w->vertices.items[e->v[1]].sign != 0) continue;
      if (e->visited == w->epoch_edges) continue;
      e->visited = w->epoch_edges;
      list_push(w, &w->on_plane, w->uses.items[u].edge);
    }
  for (size_t i = 0; i < w->on_plane.count; i++) cap_at_edge(w, w->on_plane.items[i], cell, plane);
}

bool piece_cut(work *w, uint32_t piece, uint32_t plane) {
  w->epoch++;
  if (!gather_touched(w, piece, plane)) return false;
  split_edges(w, plane);
  const size_t touched = w->touched.count;
  for (size_t i = 0; i < touched; i++)
    if ((span_of(w, w->touched.items[i], plane) & 5) == 5) split_facet(w, w->touched.items[i], plane);
  gather_cap(w, piece_cell(w, piece), plane);
  if (w->cap_uses.count == 0) return false;
  caps_make(w, plane, piece_cell(w, piece));
  pieces_part(w, piece, plane);
  w->stats.cuts++;
  return true;
}
