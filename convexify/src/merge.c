/* SPDX-License-Identifier: BSD-3-Clause
 * Merge: joins neighbouring pieces whose union is convex. Two convex pieces meet in one convex polygon of one plane;
 * their union is convex if at every edge around it the two outer facets make at most 180 degrees. If the polygon were
 * only part of a side, that side would go on at 180 degrees by itself, so the test covers this too. spx: 804 to 785. */
#include "work.h"

/* Facets between two reports: a few milliseconds. */
enum { PROGRESS_FACETS = 4096 };

static bool shares(const work *w, uint32_t facet, uint32_t cell_a, uint32_t cell_b) {
  const uint32_t *cells = w->facets.items[facet].cells;
  return (cells[0] == cell_a && cells[1] == cell_b) || (cells[0] == cell_b && cells[1] == cell_a);
}

/* Whether the two stay convex together at all edges of this common facet that border on other facets. */
static bool fits_at(work *w, uint32_t facet, uint32_t cell_a, uint32_t cell_b) {
  const int side_a = w->facets.items[facet].cells[0] == cell_a ? 0 : 1;
  for (EACH_USE(w, u, facet)) {
    const work_event a = sector_mate(w, u, side_a), b = sector_mate(w, u, 1 - side_a);
    if (shares(w, a.facet, cell_a, cell_b) || shares(w, b.facet, cell_a, cell_b)) {
      if (a.facet != b.facet) return false;
      continue;
    }
    if (a.closing == b.closing || sector_angle(w, w->uses.items[u].edge, a.closing ? &b : &a, a.closing ? &a : &b) < 0)
      return false;
  }
  return true;
}

/* Pieces that are convex but for edges that count as flat: whether their union is, too. */
static bool stay_flat(work *w, uint32_t cell_a, uint32_t cell_b) {
  const uint32_t cells[2] = {cell_a, cell_b};
  work_piece *pieces[2] = {piece_of(w, cell_a), piece_of(w, cell_b)};
  if (pieces[0]->flat.live + pieces[1]->flat.live == 0) return true;
  w->sorted.count = 0;
  for (int i = 0; i < 2; i++)
    for (size_t j = 0; j < pieces[i]->members.items.count; j++) {
      const uint32_t member = pieces[i]->members.items.items[j];
      if (w->facets.items[member / 2].cells[member % 2] == cells[i] && !shares(w, member / 2, cell_a, cell_b))
        list_push(w, &w->sorted, member);
    }
  if (!flat_enough(w, w->sorted.items, w->sorted.count)) return false;
  pieces[0]->flat.live += pieces[1]->flat.live;
  return true;
}

/* Members that left for another piece must not be there twice when that piece comes back. */
static void drop_stale_members(work *w, uint32_t cell) {
  id_list *members = &piece_of(w, cell)->members.items;
  size_t kept = 0;
  for (size_t i = 0; i < members->count; i++)
    if (set_holds(w, cell, SET_MEMBERS, members->items[i])) members->items[kept++] = members->items[i];
  members->count = kept;
}

static bool try_merge(work *w, uint32_t cell_a, uint32_t cell_b) {
  if (piece_of(w, cell_a)->members.items.count < piece_of(w, cell_b)->members.items.count) {
    const uint32_t swap = cell_a;
    cell_a = cell_b;
    cell_b = swap;
  }
  drop_stale_members(w, cell_b);
  id_list *members = &piece_of(w, cell_b)->members.items;
  for (size_t i = 0; i < members->count; i++) {
    const uint32_t facet = members->items[i] / 2;
    if (shares(w, facet, cell_a, cell_b) && !fits_at(w, facet, cell_a, cell_b)) return false;
  }
  if (!stay_flat(w, cell_a, cell_b)) return false;
  for (size_t i = 0; i < members->count; i++) {
    const uint32_t member = members->items[i];
    work_facet *f = &w->facets.items[member / 2];
    if (shares(w, member / 2, cell_a, cell_b)) {
      f->cells[0] = f->cells[1] = CELLIST_NONE;
    } else {
      f->cells[member % 2] = cell_a;
      set_push(w, &piece_of(w, cell_a)->members, member);
    }
  }
  members->count = 0;
  w->stats.merges++;
  return true;
}

void pieces_merge(work *w) {
  for (size_t p = 0; p < w->pieces.count; p++) drop_stale_members(w, piece_cell(w, p));
  bool changed = true;
  while (changed) {
    changed = false;
    for (uint32_t f = 0; f < w->facets.count; f++) {
      if (f % PROGRESS_FACETS == 0)
        work_progress(w, PROGRESS_MERGE, PROGRESS_FINISH, 0.5 * (double)f / (double)w->facets.count);
      const uint32_t a = w->facets.items[f].cells[0], b = w->facets.items[f].cells[1];
      if (!is_piece(w, a) || !is_piece(w, b) || a == b) continue;
      changed |= fits_at(w, f, a, b) && try_merge(w, a, b);
    }
  }
}
