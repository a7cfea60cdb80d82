/* SPDX-License-Identifier: BSD-3-Clause
 * Search: which parts a cut has left. From either side of every cap a search walks from member to member across
 * sectors; all searches advance in turn, searches that meet become one, and when a single one is left it is not
 * finished: that part keeps the piece, so the work is that of the smaller parts ([C]'s loop rescans the whole piece per
 * cut).
 *
 * Shells without a cap keep their kind: a shell with a cap encloses its piece (the cap's plane bounds it), so inward
 * shells are only ever the input's, until a plane passes through them. */
#include "work.h"

static uint32_t find(work *w, uint32_t c) {
  search_component *items = w->components.items;
  while (items[c].parent != c) c = items[c].parent = items[items[c].parent].parent;
  return c;
}

static void push_pending(work *w, uint32_t component, uint32_t member) {
  search_component *c = &w->components.items[component];
  list_push(w, &w->nodes, (search_node){member, c->pending});
  if (c->pending == CELLIST_NONE) c->pending_last = (uint32_t)w->nodes.count - 1;
  c->pending = (uint32_t)w->nodes.count - 1;
  c->count++;
  w->facets.items[member / 2].stamp[member % 2] = w->epoch;
  w->facets.items[member / 2].mark[member % 2] = component;
}

static void unite(work *w, uint32_t a, uint32_t b) {
  search_component *x = &w->components.items[a], *y = &w->components.items[b];
  if (x->sign != y->sign) work_stop(w, CELLIST_ERROR_INTERNAL, "convexify: a cut does not part a piece");
  y->parent = a;
  x->count += y->count;
  if (y->pending != CELLIST_NONE) {
    w->nodes.items[y->pending_last].next = x->pending;
    if (x->pending == CELLIST_NONE) x->pending_last = y->pending_last;
    x->pending = y->pending;
  }
  if (y->done_first != CELLIST_NONE) {
    w->nodes.items[y->done_last].next = x->done_first;
    if (x->done_first == CELLIST_NONE) x->done_last = y->done_last;
    x->done_first = y->done_first;
  }
}

/* Takes one member from the component's pending ones and looks at its neighbours. */
static void expand(work *w, uint32_t component) {
  search_component *c = &w->components.items[component];
  const uint32_t node = c->pending, member = w->nodes.items[node].member;
  c->pending = w->nodes.items[node].next;
  w->nodes.items[node].next = c->done_first;
  if (c->done_first == CELLIST_NONE) c->done_last = node;
  c->done_first = node;
  for (EACH_USE(w, u, member / 2)) {
    const work_event mate = sector_mate(w, u, (int)(member % 2));
    const work_facet *f = &w->facets.items[mate.facet];
    const uint32_t root = find(w, component);
    if (f->stamp[mate.side] != w->epoch) {
      push_pending(w, root, 2 * mate.facet + mate.side);
    } else {
      const uint32_t other = find(w, f->mark[mate.side]);
      if (other != root) unite(w, root, other);
    }
  }
}

void members_connected(work *w, uint32_t member, id_list *out) {
  w->components.count = 0;
  w->nodes.count = 0;
  list_push(w, &w->components, (search_component){.pending = CELLIST_NONE, .done_first = CELLIST_NONE});
  push_pending(w, 0, member);
  while (w->components.items[0].pending != CELLIST_NONE) expand(w, 0);
  for (uint32_t n = w->components.items[0].done_first; n != CELLIST_NONE; n = w->nodes.items[n].next)
    list_push(w, out, w->nodes.items[n].member);
}

/* Advances all searches in turn until at most one is unfinished; its root, or the largest one's, is returned. */
static uint32_t search_in_turn(work *w) {
  id_list *active = &w->ids;
  active->count = 0;
  for (uint32_t c = 0; c < w->components.count; c++) list_push(w, active, c);
  uint32_t largest = CELLIST_NONE;
  while (active->count > 1) {
    size_t kept = 0;
    for (size_t i = 0; i < active->count; i++) {
      const uint32_t c = active->items[i];
      if (w->components.items[c].parent != c) continue; /* joined another one */
      if (w->components.items[c].pending != CELLIST_NONE) expand(w, c);
      const uint32_t root = find(w, c);
      if (root != c) continue;
      if (w->components.items[c].pending == CELLIST_NONE) {
        w->components.items[c].finished = true;
        if (largest == CELLIST_NONE || w->components.items[c].count > w->components.items[largest].count) largest = c;
        continue;
      }
      active->items[kept++] = c;
    }
    active->count = kept;
  }
  while (active->count == 1) {
    const uint32_t c = find(w, active->items[0]);
    if (w->components.items[c].finished) break;
    return c;
  }
  return largest;
}

static void give_to_piece(work *w, uint32_t member, uint32_t piece) {
  const uint32_t cell = piece_cell(w, piece);
  uint32_t *owner = &w->facets.items[member / 2].cells[member % 2];
  piece_of(w, *owner)->members.live--;
  *owner = cell;
  set_push(w, &w->pieces.items[piece].members, member);
}

/* Finds out which pieces are reflex at the edges of these members. */
static void give_reflex_edges(work *w, const uint32_t *members, size_t count) {
  w->epoch_edges++;
  for (size_t i = 0; i < count; i++)
    for (EACH_USE(w, u, members[i] / 2)) {
      work_edge *e = &w->edges.items[w->uses.items[u].edge];
      if (e->reflex_cell == CELLIST_NONE || e->visited == w->epoch_edges) continue;
      e->visited = w->epoch_edges;
      edge_own(w, w->uses.items[u].edge, sector_reflex_cell(w, w->uses.items[u].edge));
    }
}

static int member_sign(work *w, uint32_t member, uint32_t plane) {
  for (EACH_USE(w, u, member / 2)) {
    const int sign = exact_side(w, w->edges.items[w->uses.items[u].edge].v[0], plane);
    if (sign != 0) return sign;
  }
  return 0;
}

/* Gives an inward shell that the cut left alone to the part around it. */
static void place_shell(work *w, uint32_t piece, uint32_t shell, uint32_t plane) {
  id_list *members = &w->split;
  members->count = 0;
  w->epoch++;
  members_connected(w, shell, members);
  int sign = 0;
  for (size_t i = 0; sign == 0 && i < members->count; i++) sign = member_sign(w, members->items[i], plane);
  uint32_t target = piece, candidates = 0;
  for (size_t i = 0; i < w->parts.count; i++) candidates += w->parts.items[i].sign == sign;
  for (size_t i = 0; i < w->parts.count; i++) {
    const search_part *part = &w->parts.items[i];
    if (part->sign != sign) continue;
    if (candidates == 1) target = part->piece;
    if (candidates == 1 || part->piece == piece) continue;
    const work_piece *p = &w->pieces.items[part->piece];
    if (surface_contains(w, p->members.items.items, p->members.items.count, shell)) target = part->piece;
  }
  list_push(w, &w->pieces.items[target].shells, shell);
  if (target == piece) return;
  for (size_t i = 0; i < members->count; i++) give_to_piece(w, members->items[i], target);
  give_reflex_edges(w, members->items, members->count);
}

/* The inward shells of the piece that the caps did not join to the rest, as members, in w->hits; they leave the piece.
 */
static void take_loose_shells(work *w, uint32_t piece) {
  id_list *joined = &w->on_plane;
  joined->count = 0;
  for (size_t i = 0; i < w->cap_facets.count; i++)
    for (EACH_USE(w, u, w->cap_facets.items[i]))
      for (uint32_t v = w->edges.items[w->uses.items[u].edge].first_use; v != CELLIST_NONE;
           v = w->uses.items[v].next_in_edge) {
        const uint32_t shell = w->facets.items[w->uses.items[v].facet].shell;
        if (shell != 0 && (joined->count == 0 || joined->items[joined->count - 1] != shell))
          list_push(w, joined, shell);
      }
  id_list *shells = &w->pieces.items[piece].shells;
  w->hits.count = 0;
  for (size_t i = 0; i < shells->count; i++) {
    const uint32_t number = w->facets.items[shells->items[i] / 2].shell;
    bool loose = true;
    for (size_t j = 0; j < joined->count && loose; j++) loose = joined->items[j] != number;
    if (loose) list_push(w, &w->hits, shells->items[i]);
  }
  shells->count = 0;
}

void pieces_part(work *w, uint32_t piece, uint32_t plane) {
  const uint32_t cell = piece_cell(w, piece);
  w->epoch++;
  w->components.count = 0;
  w->nodes.count = 0;
  for (uint32_t i = 0; i < 2 * w->cap_facets.count; i++) {
    const uint32_t member = 2 * w->cap_facets.items[i / 2] + i % 2;
    list_push(w, &w->components,
              (search_component){
                  .parent = i, .pending = CELLIST_NONE, .done_first = CELLIST_NONE, .sign = i % 2 == 0 ? 1 : -1});
    push_pending(w, i, member);
    set_push(w, &w->pieces.items[piece].members, member);
  }
  const uint32_t keeper = search_in_turn(w);
  w->parts.count = 0;
  for (uint32_t c = 0; c < w->components.count; c++) {
    if (w->components.items[c].parent != c) continue;
    const uint32_t own = c == keeper ? piece : work_add_piece(w);
    list_push(w, &w->parts, (search_part){w->components.items[c].sign, own});
    if (c == keeper) continue;
    for (uint32_t n = w->components.items[c].done_first; n != CELLIST_NONE; n = w->nodes.items[n].next)
      give_to_piece(w, w->nodes.items[n].member, own);
    const id_list *members = &w->pieces.items[own].members.items;
    give_reflex_edges(w, members->items, members->count);
  }
  /* Where the piece that stays was reflex at a cap, too. */
  w->sorted.count = 0;
  for (size_t i = 0; i < w->cap_facets.count; i++) list_push(w, &w->sorted, 2 * w->cap_facets.items[i]);
  give_reflex_edges(w, w->sorted.items, w->sorted.count);
  if (w->pieces.items[piece].shells.count == 0) return;
  take_loose_shells(w, piece);
  id_list loose = w->hits; /* surface_contains does not use it */
  for (size_t i = 0; i < loose.count; i++) {
    if (w->facets.items[loose.items[i] / 2].cells[loose.items[i] % 2] != cell) continue;
    place_shell(w, piece, loose.items[i], plane);
  }
}
