/* SPDX-License-Identifier: BSD-3-Clause
 * Delaunay exterior: the tets that TetGen puts between the boundary and the hull become the imaginary cells. They are
 * compact, and compact cells sort far better than few large ones (spx: no view cyclic, where cut cells leave all views
 * cyclic).
 *
 * TetGen works with tolerances, so nothing it says is trusted: every exterior tet must be positively oriented, every
 * face shared by two tets on its two sides, every boundary face present, and the outer faces a closed, locally convex
 * surface, all exactly. Then the tets and the mesh cover the hull once (positive orientation, boundary of degree one).
 * Otherwise the exterior is cut instead. */
#include "work.h"

#ifdef CELLIST_HAVE_TETGEN
#include <cellist/predicates.h>

#include "delaunay_tetgen.h"

enum { UNKNOWN, OUTSIDE, WITHIN }; /* of the mesh */

/* A face of one of TetGen's tets, or of the boundary. */
typedef struct face_record {
  uint32_t key[3]; /* vertices, ascending */
  uint32_t id;     /* 4 tet + corner, or the number of the boundary face */
  bool of_mesh, odd;
} face_record;

static int compare_records(const void *a, const void *b) {
  const face_record *x = a, *y = b;
  const int order = work_compare3(x->key, y->key);
  if (order != 0) return order;
  if (x->of_mesh != y->of_mesh) return x->of_mesh ? -1 : 1;
  return x->id < y->id ? -1 : x->id > y->id;
}

static face_record record_of(const uint32_t v[3], uint32_t id, bool of_mesh) {
  face_record r = {{v[0], v[1], v[2]}, id, of_mesh, false};
  r.odd = work_sort3(r.key);
  return r;
}

typedef struct delaunay {
  delaunay_tets tets;
  uint32_t *corners; /* [4 tet_count] vertices, positively oriented where it matters */
  uint32_t *mate;    /* [4 tet_count] the face on the other side, or CELLIST_NONE */
  uint32_t *wall;    /* [4 tet_count] the boundary face there, or CELLIST_NONE */
  uint8_t *state;    /* [tet_count] */
  uint8_t *bare;     /* [boundary faces] nothing outside: part of the hull */
  face_record *records;
} delaunay;

static int orient(const work *w, const uint32_t v[3], uint32_t d) {
  return cellist_orient3d(exact_point(w, v[0]), exact_point(w, v[1]), exact_point(w, v[2]), exact_point(w, d));
}

static void face_of(const delaunay *d, uint32_t face, uint32_t v[3]) {
  for (int k = 0; k < 3; k++) v[k] = d->corners[4 * (face / 4) + CELLIST_TET_FACE[face % 4][k]];
}

/* TetGen's own points, snapped to what the work's integers hold, and its tets on vertices. */
static void take_tets(work *w, delaunay *d, size_t given) {
  const double step = ldexp(1, w->base);
  for (size_t p = given; p < d->tets.point_count; p++) {
    double at[3];
    for (int k = 0; k < 3; k++) {
      at[k] = ldexp(d->tets.positions[3 * p + (size_t)k], w->shift);
      if (wide_lowest_exponent(at[k]) < w->base) at[k] = rint(at[k] / step) * step;
      list_push(w, &w->added_points, at[k]);
    }
    exact_add_point(w, at, (uint32_t)(w->mesh->point_count + w->added_points.count / 3 - 1));
  }
  for (size_t t = 0; t < d->tets.tet_count; t++) {
    uint32_t *v = &d->corners[4 * t];
    for (int k = 0; k < 4; k++) v[k] = (uint32_t)d->tets.tets[4 * t + (size_t)k];
    if (orient(w, v, v[3]) >= 0) continue;
    const uint32_t swap = v[2];
    v[2] = v[3];
    v[3] = swap;
  }
}

/* Mates and walls. False: faces that do not match, or boundary faces that are missing. */
static bool match_faces(work *w, delaunay *d) {
  const size_t count = 4 * d->tets.tet_count;
  for (uint32_t f = 0; f < count; f++) {
    uint32_t v[3];
    face_of(d, f, v);
    d->records[f] = record_of(v, f, false);
    d->mate[f] = d->wall[f] = CELLIST_NONE;
  }
  for (uint32_t b = 0; b < w->boundary.count; b++) d->records[count + b] = record_of(w->boundary.items[b].v, b, true);
  const size_t all = count + w->boundary.count;
  qsort(d->records, all, sizeof *d->records, compare_records);
  memset(d->state, UNKNOWN, d->tets.tet_count);
  for (size_t begin = 0, end; begin < all; begin = end) {
    const face_record *r = &d->records[begin];
    for (end = begin + 1; end < all && memcmp(r->key, d->records[end].key, sizeof r->key) == 0; end++) {
    }
    const size_t tets = end - begin - r->of_mesh;
    if (tets == 0 || tets > 2) return false;
    const face_record *x = &r[r->of_mesh], *y = &r[end - begin - 1];
    if (tets == 2) {
      if (x->odd == y->odd) return false;
      d->mate[x->id] = y->id;
      d->mate[y->id] = x->id;
    }
    if (!r->of_mesh) continue;
    d->bare[r->id] = 1;
    for (const face_record *f = x; f <= y; f++) {
      d->wall[f->id] = r->id;
      const uint8_t side = f->odd == r->odd ? WITHIN : OUTSIDE;
      if (d->state[f->id / 4] != UNKNOWN && d->state[f->id / 4] != side) return false;
      d->state[f->id / 4] = side;
      if (side == OUTSIDE) d->bare[r->id] = 0;
    }
  }
  return true;
}

/* Spreads OUTSIDE up to the boundary. False: it reaches the inside, or a tet of no positive volume. */
static bool spread(work *w, delaunay *d) {
  id_list *stack = &w->ids;
  stack->count = 0;
  for (uint32_t t = 0; t < d->tets.tet_count; t++)
    if (d->state[t] == OUTSIDE) list_push(w, stack, t);
  while (stack->count > 0) {
    const uint32_t t = stack->items[--stack->count];
    if (orient(w, &d->corners[4 * t], d->corners[4 * t + 3]) <= 0) return false;
    for (uint32_t f = 4 * t; f < 4 * t + 4; f++) {
      if (d->wall[f] != CELLIST_NONE || d->mate[f] == CELLIST_NONE) continue;
      const uint32_t next = d->mate[f] / 4;
      if (d->state[next] == WITHIN) return false;
      if (d->state[next] == UNKNOWN) list_push(w, stack, next);
      d->state[next] = OUTSIDE;
    }
  }
  return true;
}

typedef struct outer_edge {
  uint64_t key;
  uint32_t v[3], opposite; /* the face, and its corner off the edge */
  bool forward;
} outer_edge;

static int compare_edges(const void *a, const void *b) {
  const outer_edge *x = a, *y = b;
  return x->key != y->key ? (x->key < y->key ? -1 : 1) : x->forward - y->forward;
}

static void add_outer(outer_edge *edges, size_t *count, const uint32_t v[3]) {
  for (int k = 0; k < 3; k++) {
    const uint32_t a = v[k], b = v[(k + 1) % 3];
    edges[(*count)++] =
        (outer_edge){a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, {v[0], v[1], v[2]}, v[(k + 2) % 3], a < b};
  }
}

/* Whether the outer faces form a closed, locally convex surface. */
static bool is_hull(work *w, const delaunay *d) {
  size_t faces = 0, count = 0;
  for (size_t b = 0; b < w->boundary.count; b++) faces += d->bare[b];
  for (size_t f = 0; f < 4 * d->tets.tet_count; f++)
    faces += d->state[f / 4] == OUTSIDE && d->mate[f] == CELLIST_NONE && d->wall[f] == CELLIST_NONE;
  outer_edge *edges = work_block(w, 3 * faces, sizeof *edges);
  for (size_t b = 0; b < w->boundary.count; b++)
    if (d->bare[b]) add_outer(edges, &count, w->boundary.items[b].v);
  for (uint32_t f = 0; f < 4 * d->tets.tet_count; f++) {
    if (d->state[f / 4] != OUTSIDE || d->mate[f] != CELLIST_NONE || d->wall[f] != CELLIST_NONE) continue;
    uint32_t v[3];
    face_of(d, f, v);
    add_outer(edges, &count, v);
  }
  qsort(edges, count, sizeof *edges, compare_edges);
  bool ok = count > 0;
  for (size_t i = 0; ok && i < count; i += 2) {
    const outer_edge *x = &edges[i], *y = &edges[i + 1];
    ok = i + 1 < count && x->key == y->key && x->forward != y->forward &&
         (i + 2 >= count || edges[i + 2].key != x->key) && orient(w, x->v, y->opposite) <= 0 &&
         orient(w, y->v, x->opposite) <= 0;
  }
  work_block_end(w);
  return ok;
}

static void add_triangle(work *w, const uint32_t v[3], uint32_t front, uint32_t back) {
  const uint32_t plane = exact_add_plane(w, v[0], v[1], v[2]);
  const uint32_t facet = work_add_facet(w, plane, front, back);
  for (int k = 0; k < 3; k++) work_use_points(w, facet, v[k], v[(k + 1) % 3]);
}

/* The exterior tets as pieces, with all their facets. */
static void build(work *w, const delaunay *d) {
  const uint32_t base = (uint32_t)w->mesh->tet_count;
  work_reserve(w, &w->sorted, d->tets.tet_count, sizeof *w->sorted.items);
  for (uint32_t t = 0; t < d->tets.tet_count; t++)
    w->sorted.items[t] = d->state[t] == OUTSIDE ? base + work_add_piece(w) : CELLIST_NONE;
  for (uint32_t f = 0; f < 4 * d->tets.tet_count; f++) {
    if (d->state[f / 4] != OUTSIDE) continue;
    const uint32_t own = w->sorted.items[f / 4];
    uint32_t v[3], beyond = CELLIST_NONE;
    face_of(d, f, v);
    if (d->wall[f] != CELLIST_NONE) {
      beyond = w->boundary.items[d->wall[f]].tet;
    } else if (d->mate[f] != CELLIST_NONE) {
      if (d->mate[f] < f) continue;
      beyond = w->sorted.items[d->mate[f] / 4];
    }
    add_triangle(w, v, beyond, own);
  }
  for (size_t b = 0; b < w->boundary.count; b++)
    if (d->bare[b]) add_triangle(w, w->boundary.items[b].v, CELLIST_NONE, w->boundary.items[b].tet);
  w->stats.exterior_facets = w->boundary.count;
}

/* No longjmp from here: the caller is C++. */
static bool is_awaited(void *user) {
  const work *w = user;
  return cellist_progress(w->context, "convexifying", w->progress / PROGRESS_END) == CELLIST_SUCCESS;
}

static bool attempt(work *w, delaunay *d) {
  const size_t given = w->vertices.count;
  double_list *scaled = &w->box_scratch;
  work_reserve(w, scaled, 3 * given, sizeof(double));
  for (uint32_t v = 0; v < given; v++)
    for (size_t k = 0; k < 3; k++) scaled->items[3 * v + k] = ldexp(exact_point(w, v)[k], -w->shift);
  work_reserve(w, &w->ids, 3 * w->boundary.count, sizeof *w->ids.items);
  for (size_t b = 0; b < w->boundary.count; b++)
    memcpy(&w->ids.items[3 * b], w->boundary.items[b].v, 3 * sizeof(uint32_t));
  const delaunay_result done =
      delaunay_compute(given, scaled->items, w->boundary.count, w->ids.items, is_awaited, w, &d->tets);
  if (done == DELAUNAY_CANCELLED) work_fail(w, CELLIST_ERROR_CANCELLED);
  if (done != DELAUNAY_DONE) return false;
  const size_t tets = d->tets.tet_count;
  d->corners = cellist_allocate(w->context, tets, 4 * sizeof *d->corners);
  d->mate = cellist_allocate(w->context, tets, 4 * sizeof *d->mate);
  d->wall = cellist_allocate(w->context, tets, 4 * sizeof *d->wall);
  d->state = cellist_allocate(w->context, tets, 1);
  d->bare = cellist_allocate_zeroed(w->context, w->boundary.count, 1);
  d->records = cellist_allocate(w->context, 4 * tets + w->boundary.count, sizeof *d->records);
  if (d->corners == NULL || d->mate == NULL || d->wall == NULL || d->state == NULL || d->bare == NULL ||
      d->records == NULL)
    work_fail(w, CELLIST_ERROR_OUT_OF_MEMORY);
  take_tets(w, d, given);
  if (!match_faces(w, d) || !spread(w, d) || !is_hull(w, d)) return false;
  build(w, d);
  return true;
}

void delaunay_release_work(work *w) {
  delaunay *d = w->delaunay;
  if (d == NULL) return;
  delaunay_release(&d->tets);
  void *blocks[] = {d->corners, d->mate, d->wall, d->state, d->bare, d->records, d};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) cellist_deallocate(w->context, blocks[i]);
  w->delaunay = NULL;
}

bool delaunay_build(work *w) {
  const size_t points = w->added_points.count, vertices = w->vertices.count;
  w->delaunay = cellist_allocate_zeroed(w->context, 1, sizeof(delaunay));
  if (w->delaunay == NULL) work_fail(w, CELLIST_ERROR_OUT_OF_MEMORY);
  const bool done = attempt(w, w->delaunay);
  delaunay_release_work(w);
  if (done) return true;
  w->added_points.count = points;
  w->vertices.count = vertices;
  cellist_log(w->context, CELLIST_LOG_INFO, "TetGen does not take this boundary: the exterior is cut");
  return false;
}
#else
void delaunay_release_work(work *w) { (void)w; }

bool delaunay_build(work *w) {
  cellist_log(w->context, CELLIST_LOG_INFO, "built without TetGen: the exterior is cut");
  return false;
}
#endif
