/* SPDX-License-Identifier: BSD-3-Clause
 * Caps: from the directed edges of a cross-section to its connected regions, one facet each. Loops are traced with the
 * region to their left; where several meet in a vertex, the next edge is the first one clockwise from where the last
 * came from. Loops that run the other way are holes and belong to the innermost loop around them. A facet that a line
 * cuts more than once falls apart in the same way. */
#include "work.h"

/* The side of the use's line, seen along it, that the vertex is on: 1 left, -1 right. */
static int left_of(work *w, const cap_use *use, uint32_t vertex) {
  if (vertex == use->from || vertex == use->to) return 0;
  return w->cap_sign * exact_turn(w, w->cap_axis, use->from, use->to, vertex);
}

_Noreturn static void fail_cap(work *w) {
  work_stop(w, CELLIST_ERROR_GEOMETRY, "convexify: a cross-section of the exterior does not close");
}

/* 1: within 180 degrees clockwise of where in came from; 2: straight on; 3: beyond; 4: back along the same edge. */
static int clockwise_class(work *w, const cap_use *in, const cap_use *out) {
  if (out->edge == in->edge) return 4;
  const int left = left_of(w, in, out->to);
  return left > 0 ? 1 : left == 0 ? 2 : 3;
}

static bool clockwise_before(work *w, const cap_use *in, const cap_use *a, const cap_use *b) {
  const int class_a = clockwise_class(w, in, a), class_b = clockwise_class(w, in, b);
  if (class_a != class_b) return class_a < class_b;
  return left_of(w, a, b->to) < 0;
}

static int compare_uses(const void *a, const void *b) {
  const cap_use *x = a, *y = b;
  if (x->from != y->from) return x->from < y->from ? -1 : 1;
  if (x->to != y->to) return x->to < y->to ? -1 : 1;
  return x->edge < y->edge ? -1 : x->edge > y->edge;
}

static void link_uses(work *w) {
  cap_use *uses = w->cap_uses.items;
  const size_t count = w->cap_uses.count;
  qsort(uses, count, sizeof *uses, compare_uses);
  for (size_t i = 0; i < count; i++) {
    size_t low = 0, high = count;
    while (low < high) {
      const size_t middle = low + (high - low) / 2;
      if (uses[middle].from < uses[i].to)
        low = middle + 1;
      else
        high = middle;
    }
    if (low == count || uses[low].from != uses[i].to) fail_cap(w);
    size_t best = low;
    for (size_t j = low + 1; j < count && uses[j].from == uses[i].to; j++)
      if (clockwise_before(w, &uses[i], &uses[j], &uses[best])) best = j;
    uses[i].next = (uint32_t)best;
  }
}

/* Area in the plane's dominant projection, for choosing the innermost of nested loops; sign not needed. */
static double loop_area(const work *w, uint32_t first) {
  const int axis = w->cap_axis;
  const cap_use *uses = w->cap_uses.items;
  const double *o = w->vertices.items[uses[first].from].p;
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  double area = 0;
  uint32_t i = first;
  do {
    const double *p = w->vertices.items[uses[i].from].p, *q = w->vertices.items[uses[i].to].p;
    area += (p[x] - o[x]) * (q[y] - o[y]) - (p[y] - o[y]) * (q[x] - o[x]);
  } while ((i = uses[i].next) != first);
  return fabs(area);
}

static void trace_loops(work *w) {
  cap_use *uses = w->cap_uses.items;
  w->cap_loops.count = 0;
  for (uint32_t first = 0; first < w->cap_uses.count; first++) {
    if (uses[first].loop != CELLIST_NONE) continue;
    cap_loop loop = {.first = first, .outer = CELLIST_NONE, .top = uses[first].to};
    uint32_t i = first;
    do {
      if (uses[i].loop != CELLIST_NONE) fail_cap(w);
      uses[i].loop = (uint32_t)w->cap_loops.count;
      if (exact_compare(w, uses[i].to, loop.top) > 0) loop.top = uses[i].to;
    } while ((i = uses[i].next) != first);
    /* At its extreme vertex a hole's corner holds the outward direction: it spans more than 180 degrees. */
    do {
      if (uses[i].to == loop.top) loop.hole |= clockwise_class(w, &uses[i], &uses[uses[i].next]) >= 3;
    } while ((i = uses[i].next) != first);
    loop.area = loop_area(w, first);
    list_push(w, &w->cap_loops, loop);
  }
}

/* Whether the vertex is inside the loop, by the winding of its edges past a half-line; -1: on it. */
static int is_inside(work *w, const cap_loop *loop, uint32_t vertex) {
  const cap_use *uses = w->cap_uses.items;
  const int y = (w->cap_axis + 2) % 3;
  int winding = 0;
  uint32_t i = loop->first;
  do {
    if (uses[i].from == vertex) return -1;
    const int from = exact_compare_axis(w, uses[i].from, vertex, y), to = exact_compare_axis(w, uses[i].to, vertex, y);
    if ((from > 0) == (to > 0)) continue;
    const int left = w->cap_sign * left_of(w, &uses[i], vertex);
    if (to > 0 && left > 0) winding++;
    if (from > 0 && left < 0) winding--;
  } while ((i = uses[i].next) != loop->first);
  return winding != 0;
}

static void nest_holes(work *w) {
  size_t outer_count = 0;
  uint32_t outer = CELLIST_NONE;
  for (uint32_t i = 0; i < w->cap_loops.count; i++)
    if (!w->cap_loops.items[i].hole) {
      outer = i;
      outer_count++;
    }
  if (outer_count == 0) fail_cap(w);
  for (uint32_t i = 0; i < w->cap_loops.count; i++) {
    cap_loop *hole = &w->cap_loops.items[i];
    if (!hole->hole) {
      hole->outer = i;
      continue;
    }
    if (outer_count == 1) {
      hole->outer = outer;
      continue;
    }
    for (uint32_t j = 0; j < w->cap_loops.count; j++) {
      cap_loop *around = &w->cap_loops.items[j];
      if (around->hole || (hole->outer != CELLIST_NONE && around->area >= w->cap_loops.items[hole->outer].area))
        continue;
      int inside = -1;
      uint32_t k = hole->first;
      do inside = is_inside(w, around, w->cap_uses.items[k].from);
      while (inside < 0 && (k = w->cap_uses.items[k].next) != hole->first);
      if (inside > 0) hole->outer = j;
    }
    if (hole->outer == CELLIST_NONE) fail_cap(w);
  }
}

/* Connected regions of w->cap_uses: each loop's outer loop. */
void regions_find(work *w, uint32_t plane) {
  const work_plane *p = &w->planes.items[plane];
  w->cap_axis = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(p->normal[k]) > fabs(p->normal[w->cap_axis])) w->cap_axis = k;
  w->cap_sign = p->normal[w->cap_axis] > 0 ? 1 : -1;
  link_uses(w);
  trace_loops(w);
  nest_holes(w);
}

void caps_make(work *w, uint32_t plane, uint32_t cell) {
  regions_find(w, plane);
  w->cap_facets.count = 0;
  for (uint32_t i = 0; i < w->cap_loops.count; i++) {
    if (w->cap_loops.items[i].hole) continue;
    const uint32_t facet = work_add_facet(w, plane, cell, cell);
    w->cap_loops.items[i].facet = facet;
    list_push(w, &w->cap_facets, facet);
  }
  for (size_t i = 0; i < w->cap_uses.count; i++) {
    const cap_use *use = &w->cap_uses.items[i];
    work_add_use(w, w->cap_loops.items[w->cap_loops.items[use->loop].outer].facet, use->edge, use->forward);
  }
}

uint32_t facet_beside(work *w, uint32_t facet) {
  const work_facet old = w->facets.items[facet];
  const uint32_t added = work_add_facet(w, old.plane, old.cells[0], old.cells[1]);
  w->facets.items[added].shell = old.shell;
  for (uint32_t side = 0; side < 2; side++)
    if (is_piece(w, old.cells[side]) && w->pieces.count > 0)
      set_push(w, &piece_of(w, old.cells[side])->members, 2 * added + side);
  return added;
}

void facet_part(work *w, uint32_t facet) {
  w->cap_uses.count = 0;
  for (EACH_USE(w, u, facet)) {
    const work_use *use = &w->uses.items[u];
    const uint32_t *v = w->edges.items[use->edge].v;
    list_push(w, &w->cap_uses,
              (cap_use){.edge = use->edge,
                        .from = v[use->forward ? 0 : 1],
                        .to = v[use->forward ? 1 : 0],
                        .use = u,
                        .loop = CELLIST_NONE,
                        .forward = use->forward});
  }
  regions_find(w, w->facets.items[facet].plane);
  bool first = true;
  for (uint32_t i = 0; i < w->cap_loops.count; i++) {
    if (w->cap_loops.items[i].hole) continue;
    const uint32_t own = first ? facet : facet_beside(w, facet);
    w->cap_loops.items[i].facet = own;
    if (!first) list_push(w, &w->touched, own);
    first = false;
  }
  w->facets.items[facet].first_use = CELLIST_NONE;
  for (size_t i = 0; i < w->cap_uses.count; i++) {
    const cap_use *use = &w->cap_uses.items[i];
    const uint32_t target = w->cap_loops.items[w->cap_loops.items[use->loop].outer].facet;
    w->uses.items[use->use].facet = target;
    w->uses.items[use->use].next_in_facet = w->facets.items[target].first_use;
    w->facets.items[target].first_use = use->use;
  }
}
