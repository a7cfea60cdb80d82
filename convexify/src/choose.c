/* SPDX-License-Identifier: BSD-3-Clause
 * Choose: the plane of the next cut ([C] section 6.2). Some reflex edges of the piece are drawn at random; candidates
 * are the planes of the two faces at each and, a kind of our own, planes through it and another reflex edge of the
 * input that shares a point with it: they resolve two edges at once (spx 1300 cells without, 804 with them). Every
 * candidate holds three input points, so nothing constructed ever spans a plane.
 *
 * Our score: reflex edges that the plane splits less those that lie in it, then facets crossed. The paper's: facets
 * crossed. Scores are heuristics and evaluated in double; what a vertex near a plane counts for changes no result but
 * the choice. */
#include <limits.h>

#include "work.h"

/* Distances below this, in units of the piece's extent, count as on the plane when scores are counted. */
static const double ON_PLANE = 1e-11;

enum { DEFAULT_CANDIDATES = 20 };

/* Second edges drawn at either point of a reflex edge: 1 gives spx 796 cells (median of 3 seeds), 4 give 783 for half
 * as much time again. */
enum { PAIRS_PER_POINT = 4 };

/* How many reflex edges a choice may look at, and facets to break ties: more candidates compete in small pieces than in
 * large ones, which bounds the work of a cut. Large pieces do not miss them: spx 768 to 778 cells with 4,000, 769 to
 * 791 without bound, 780 to 810 with 2,000; octopus_low 859 to 898, 1,005 to 1,048, 830 to 880. */
enum { LOOKS = 4000, TIE_LOOKS = 2000 };

struct candidate {
  uint32_t plane; /* CELLIST_NONE: through points */
  uint32_t points[3];
  double normal[3], offset;
};

static bool spans(work *w, struct candidate *c) {
  const double *p = w->vertices.items[c->points[0]].p, *q = w->vertices.items[c->points[1]].p,
               *r = w->vertices.items[c->points[2]].p;
  double length = 0;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    c->normal[k] = (q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i]);
    length += c->normal[k] * c->normal[k];
  }
  length = sqrt(length);
  if (!(length > 1e-200)) return false;
  c->offset = 0;
  for (int k = 0; k < 3; k++) {
    c->normal[k] /= length;
    c->offset -= c->normal[k] * p[k];
  }
  return true;
}

static void of_plane(const work *w, struct candidate *c, uint32_t plane) {
  const work_plane *p = &w->planes.items[plane];
  const double length = sqrt(p->normal[0] * p->normal[0] + p->normal[1] * p->normal[1] + p->normal[2] * p->normal[2]);
  c->plane = plane;
  for (int k = 0; k < 3; k++) c->normal[k] = p->normal[k] / length;
  c->offset = p->offset / length;
}

static int side_about(const work *w, const struct candidate *c, uint32_t vertex) {
  const double *p = w->vertices.items[vertex].p;
  const double value = c->normal[0] * p[0] + c->normal[1] * p[1] + c->normal[2] * p[2] + c->offset;
  return value > ON_PLANE ? 1 : value < -ON_PLANE ? -1 : 0;
}

/* Reflex edges of the piece near the plane; those of its other pieces are not among them. */
static void gather_near(work *w, const struct candidate *c, uint32_t piece, set_kind kind) {
  const uint32_t cell = piece_cell(w, piece);
  set_near(w, set_of(w, piece, kind), c->normal, c->offset, ON_PLANE, &w->near);
  size_t kept = 0;
  for (size_t i = 0; i < w->near.count; i++)
    if (set_holds(w, cell, kind, w->near.items[i])) w->near.items[kept++] = w->near.items[i];
  w->near.count = kept;
}

/* Of w->near: no more than the exact score. */
static long reflex_score(const work *w, const struct candidate *c) {
  long score = 0;
  for (size_t i = 0; i < w->near.count; i++) {
    const uint32_t *v = w->edges.items[w->near.items[i]].v;
    const int a = side_about(w, c, v[0]), b = side_about(w, c, v[1]);
    score += a * b < 0;
    score -= a == 0 && b == 0;
  }
  return score;
}

/* An edge that lies in the plane but for rounding is not resolved by it: it is split, with a sliver on either side. On
 * spheres whose edges follow great circles this made three times as many cells. */
static long exact_reflex_score(work *w, const struct candidate *c) {
  long score = 0;
  const size_t planes = w->planes.count, limbs = w->limbs.count;
  const uint32_t plane =
      c->plane != CELLIST_NONE ? c->plane : exact_add_plane(w, c->points[0], c->points[1], c->points[2]);
  if (plane == CELLIST_NONE) return LONG_MAX;
  for (size_t i = 0; i < w->near.count; i++) {
    const uint32_t *v = w->edges.items[w->near.items[i]].v;
    int sides[2] = {side_about(w, c, v[0]), side_about(w, c, v[1])};
    if (sides[0] * sides[1] > 0) continue;
    for (int end = 0; end < 2; end++)
      if (sides[end] == 0) sides[end] = exact_side(w, v[end], plane);
    score += sides[0] * sides[1] < 0;
    score -= sides[0] == 0 && sides[1] == 0;
  }
  w->planes.count = planes;
  w->limbs.count = limbs;
  return score;
}

static long crossed_facets(work *w, const struct candidate *c, uint32_t piece) {
  long crossed = 0;
  gather_near(w, c, piece, SET_MEMBERS);
  for (size_t i = 0; i < w->near.count; i++) {
    int span = 0;
    for (EACH_USE(w, u, w->near.items[i] / 2)) {
      const uint32_t *v = w->edges.items[w->uses.items[u].edge].v;
      if ((span & 5) == 5) break;
      for (int end = 0; end < 2; end++) span |= 1 << (1 + side_about(w, c, v[end]));
    }
    crossed += (span & 5) == 5;
  }
  return crossed;
}

struct choice {
  struct candidate best;
  long score, crossed;
  set_kind kind;    /* of edges that count */
  long looks, ties; /* what is left of LOOKS and TIE_LOOKS */
  bool any, crossed_known;
};

static void compete(work *w, uint32_t piece, struct choice *choice, const struct candidate *c) {
  long score = 0, crossed = 0;
  bool crossed_known = false;
  if (w->desc.score == CELLIST_SCORE_PAPER) {
    score = crossed_facets(w, c, piece);
    if (choice->any && score >= choice->score) return;
  } else {
    gather_near(w, c, piece, choice->kind);
    choice->looks -= (long)w->near.count;
    if (choice->any && reflex_score(w, c) > choice->score) return;
    score = exact_reflex_score(w, c);
    if (score == LONG_MAX || (choice->any && score > choice->score)) return;
    if (choice->any && score == choice->score) {
      if (choice->ties <= 0) return;
      if (!choice->crossed_known) choice->crossed = crossed_facets(w, &choice->best, piece);
      choice->crossed_known = crossed_known = true;
      crossed = crossed_facets(w, c, piece);
      choice->ties -= (long)w->near.count;
      if (crossed >= choice->crossed) return;
    }
  }
  choice->best = *c;
  choice->score = score;
  choice->crossed = crossed;
  choice->crossed_known = crossed_known;
  choice->any = true;
}

/* Planes through a reflex edge and the reflex input edges at one of its input's points. */
static void compete_pairs(work *w, uint32_t piece, struct choice *choice, const work_edge *e) {
  for (int draw = 0; draw < 2 * PAIRS_PER_POINT; draw++) {
    const int end = draw % 2;
    const uint32_t at = e->line[end], other = e->line[1 - end];
    const uint32_t begin = w->input_reflex_start.items[at], count = w->input_reflex_start.items[at + 1] - begin;
    if (count < 2) continue;
    const uint32_t third = w->input_reflex.items[begin + random_below(&w->random, count)];
    struct candidate c = {.plane = CELLIST_NONE, .points = {at, other, third}};
    if (third != other && spans(w, &c)) compete(w, piece, choice, &c);
  }
}

/* A reflex edge of the piece: the nth, or any one. */
static uint32_t draw_edge(work *w, uint32_t piece, set_kind kind, bool any, size_t *nth) {
  const work_set *reflex = set_of(w, piece, kind);
  const uint32_t cell = piece_cell(w, piece);
  for (;;) {
    const size_t drawn = any ? (size_t)random_below(&w->random, reflex->items.count) : (*nth)++;
    if (set_holds(w, cell, kind, reflex->items.items[drawn])) return reflex->items.items[drawn];
  }
}

/* A piece whose reflex edges all count as flat. */
static bool is_flat_enough(work *w, uint32_t piece) {
  set_list(w, piece, SET_MEMBERS, &w->sorted);
  return flat_enough(w, w->sorted.items, w->sorted.count);
}

uint32_t choose_plane(work *w, uint32_t piece) {
  const set_kind kind = w->pieces.items[piece].reflex.live > 0 ? SET_REFLEX : SET_FLAT;
  const work_set *reflex = set_of(w, piece, kind);
  if (reflex->live == 0 || (kind == SET_FLAT && is_flat_enough(w, piece))) return CELLIST_NONE;
  set_arrange(w, piece, kind);
  set_arrange(w, piece, SET_MEMBERS);
  const size_t wanted = w->desc.candidates > 0 ? w->desc.candidates : DEFAULT_CANDIDATES;
  const bool any = wanted < reflex->live;
  const size_t draws = any ? wanted : reflex->live;
  const uint32_t cell = piece_cell(w, piece);
  struct choice choice = {.kind = kind, .looks = LOOKS, .ties = TIE_LOOKS};
  w->choices++;
  size_t nth = 0;
  for (size_t i = 0; i < draws && choice.looks > 0; i++) {
    const uint32_t edge = draw_edge(w, piece, kind, any, &nth);
    sectors_gather(w, edge, cell);
    for (size_t j = 0; j + 1 < w->events.count; j += 2) {
      if (sector_angle(w, edge, &w->events.items[j], &w->events.items[j + 1]) >= 0) continue;
      for (size_t k = j; k < j + 2; k++) {
        const uint32_t plane = w->facets.items[w->events.items[k].facet].plane;
        if (w->planes.items[plane].choice == w->choices) continue;
        w->planes.items[plane].choice = w->choices;
        struct candidate c;
        of_plane(w, &c, plane);
        compete(w, piece, &choice, &c);
      }
    }
    const work_edge e = w->edges.items[edge];
    if (w->desc.score == CELLIST_SCORE_OWN && e.line_is_points) compete_pairs(w, piece, &choice, &e);
  }
  if (choice.best.plane != CELLIST_NONE) return choice.best.plane;
  const uint32_t *points = choice.best.points;
  return exact_add_plane(w, points[0], points[1], points[2]);
}

/* Boundary faces a grid cell, on average over a grid as deep as wide; fewer means more and more compact cells.
 * spx gets 8 planes, as in the measurement that grids sort better by (136 instead of 1,369 real cells in cycles). */
static const double FACES_PER_GRID_CELL = 4;

void pieces_cut_by_grid(work *w) {
  const double *bounds = w->mesh->bounds;
  double extent = 0;
  for (int k = 0; k < 3; k++) extent = fmax(extent, bounds[3 + k] / 2 - bounds[k] / 2);
  const double step = ldexp(1, w->shift - ADDED_BITS);
  double along = w->desc.grid_size;
  if (along == 0) along = fmin(fmax(cbrt((double)w->boundary.count / FACES_PER_GRID_CELL), 2), 64);
  for (uint32_t axis = 0; axis < 3; axis++) {
    const double length = bounds[3 + axis] - bounds[axis];
    const int planes = (int)ceil(along * (length / 2) / extent);
    for (int i = 1; i <= planes; i++) {
      const double offset = rint((bounds[axis] + length * i / (planes + 1)) / step) * step;
      if (offset <= bounds[axis] || offset >= bounds[3 + axis]) continue;
      const uint32_t plane = exact_add_axis_plane(w, axis, offset);
      const size_t count = w->pieces.count;
      for (uint32_t piece = 0; piece < count; piece++) piece_cut(w, piece, plane);
      work_progress(w, PROGRESS_CUT, PROGRESS_CUT, 0);
    }
  }
}

void pieces_cut_all(work *w) {
  const double most = (double)w->reflex_count;
  for (uint32_t piece = 0; piece < w->pieces.count;) {
    work_progress(w, PROGRESS_CUT, PROGRESS_MERGE, most > 0 ? 1 - (double)w->reflex_count / most : 1);
    const uint32_t plane = choose_plane(w, piece);
    if (plane == CELLIST_NONE) {
      piece++;
      continue;
    }
    if (!piece_cut(w, piece, plane))
      work_stop(w, CELLIST_ERROR_INTERNAL, "convexify: a plane through a reflex edge does not cut");
  }
}
