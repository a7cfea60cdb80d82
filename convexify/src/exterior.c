/* SPDX-License-Identifier: BSD-3-Clause
 * Exterior: the facets that enclose what is to be cut ([C] section 6.1, step 4), and its connected parts.
 *
 * Hull and boundary may split a flat patch differently. A facet is a chain of directed edges, so the paper's "remove
 * all triangles that appear twice" is a sum here: the hull side's outline, split at the boundary's vertices on it, less
 * the boundary faces in its plane; inner edges cancel whatever the triangles. A boundary edge that merely touches a
 * hull side from below becomes a slit in it, or sectors there would be wrong. */
#include "tree.h"

uint32_t work_add_edge(work *w, uint32_t a, uint32_t b, uint32_t line_a, uint32_t line_b, bool line_is_points) {
  list_push(w, &w->edges,
            (work_edge){.v = {a, b},
                        .first_use = CELLIST_NONE,
                        .line = {line_a, line_b},
                        .reflex_cell = CELLIST_NONE,
                        .line_is_points = line_is_points});
  return (uint32_t)w->edges.count - 1;
}

uint32_t work_add_facet(work *w, uint32_t plane, uint32_t front, uint32_t back) {
  list_push(w, &w->facets, (work_facet){.plane = plane, .first_use = CELLIST_NONE, .cells = {front, back}});
  return (uint32_t)w->facets.count - 1;
}

void work_add_use(work *w, uint32_t facet, uint32_t edge, bool forward) {
  work_edge *e = &w->edges.items[edge];
  work_facet *f = &w->facets.items[facet];
  list_push(w, &w->uses, (work_use){edge, facet, e->first_use, f->first_use, forward});
  e->first_use = f->first_use = (uint32_t)w->uses.count - 1;
}

uint32_t work_add_piece(work *w) {
  list_push(w, &w->pieces, (work_piece){0});
  return (uint32_t)w->pieces.count - 1;
}

/* ---- Edges between points ------------------------------------------------------------------------------------ */

static void grow_table(work *w, size_t size) {
  work_reserve(w, &w->edge_table, size, sizeof *w->edge_table.items);
  w->edge_table.count = size;
  memset(w->edge_table.items, 0xff, size * sizeof *w->edge_table.items);
  for (size_t e = 0; e < w->edges.count; e++) {
    const uint32_t *v = w->edges.items[e].v;
    size_t slot = work_mix((uint64_t)v[0] << 32 | v[1]) & (size - 1);
    while (w->edge_table.items[slot] != CELLIST_NONE) slot = (slot + 1) & (size - 1);
    w->edge_table.items[slot] = (uint32_t)e;
  }
}

uint32_t work_point_edge(work *w, uint32_t a, uint32_t b, bool *forward) {
  *forward = a < b;
  const uint32_t low = a < b ? a : b, high = a < b ? b : a;
  if (w->edges.count == 0)
    grow_table(w, 1024);
  else if (2 * w->edges.count >= w->edge_table.count)
    grow_table(w, 2 * w->edge_table.count);
  const size_t mask = w->edge_table.count - 1;
  size_t slot = work_mix((uint64_t)low << 32 | high) & mask;
  for (; w->edge_table.items[slot] != CELLIST_NONE; slot = (slot + 1) & mask) {
    const work_edge *e = &w->edges.items[w->edge_table.items[slot]];
    if (e->v[0] == low && e->v[1] == high) return w->edge_table.items[slot];
  }
  const uint32_t edge = work_add_edge(w, low, high, low, high, true);
  w->edge_table.items[slot] = edge;
  return edge;
}

void work_use_points(work *w, uint32_t facet, uint32_t a, uint32_t b) {
  bool forward;
  const uint32_t edge = work_point_edge(w, a, b, &forward);
  work_add_use(w, facet, edge, forward);
}

/* ---- Flat sides share a plane -------------------------------------------------------------------------------- */

static uint32_t find_root(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

static double plane_size(const work *w, uint32_t plane) {
  const double *n = w->planes.items[plane].normal;
  return fabs(n[0]) + fabs(n[1]) + fabs(n[2]);
}

struct half_edge {
  uint64_t key;
  uint32_t face, opposite;
};

static int compare_half_edges(const void *a, const void *b) {
  const struct half_edge *x = a, *y = b;
  if (x->key != y->key) return x->key < y->key ? -1 : 1;
  return x->face < y->face ? -1 : x->face > y->face;
}

/* planes[i] of triangles i (vertices at v + i * stride): those of adjacent coplanar triangles that face the same way
 * become that of the largest one. Planes made for the others stay unused. */
static void share_planes(work *w, size_t count, const uint32_t *v, uint32_t *plane, size_t stride, uint32_t *parent) {
  struct half_edge *halves = work_block(w, 3 * count, sizeof *halves);
  for (size_t t = 0; t < count; t++) {
    parent[t] = (uint32_t)t;
    for (size_t k = 0; k < 3; k++) {
      const uint32_t a = v[t * stride + k], b = v[t * stride + (k + 1) % 3];
      halves[3 * t + k] = (struct half_edge){a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, (uint32_t)t,
                                             v[t * stride + (k + 2) % 3]};
    }
  }
  qsort(halves, 3 * count, sizeof *halves, compare_half_edges);
  for (size_t i = 0; i + 1 < 3 * count; i++) {
    const struct half_edge *x = &halves[i], *y = &halves[i + 1];
    if (x->key != y->key || (i + 2 < 3 * count && halves[i + 2].key == x->key) ||
        (i > 0 && halves[i - 1].key == x->key))
      continue;
    if (exact_side(w, y->opposite, plane[x->face * stride]) != 0 ||
        exact_same_direction(w, plane[x->face * stride], plane[y->face * stride]) < 0)
      continue;
    const uint32_t a = find_root(parent, x->face), b = find_root(parent, y->face);
    const bool keep_a = plane_size(w, plane[a * stride]) >= plane_size(w, plane[b * stride]);
    if (keep_a)
      parent[b] = a;
    else
      parent[a] = b;
  }
  for (size_t t = 0; t < count; t++) plane[t * stride] = plane[find_root(parent, (uint32_t)t) * stride];
  work_block_end(w);
}

struct hull_side {
  uint32_t v[3], plane;
};

static int compare_keys(const void *a, const void *b) {
  const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return x < y ? -1 : x > y;
}

/* The lowest of a side's corners, the one farthest from it, and the one that spans most with both. */
static struct hull_side widest(const work *w, const uint64_t *corners, size_t count) {
  const uint32_t lowest = (uint32_t)corners[0];
  struct hull_side side = {{lowest, lowest, lowest}, (uint32_t)(corners[0] >> 32)};
  const double *a = w->vertices.items[lowest].p, *b = a;
  for (int pass = 1; pass < 3; pass++) {
    double most = 0;
    for (size_t i = 1; i < count; i++) {
      const double *p = w->vertices.items[(uint32_t)corners[i]].p;
      double size = 0;
      for (int k = 0; k < 3; k++) {
        const int j = (k + 1) % 3, l = (k + 2) % 3;
        const double part = pass == 1 ? p[k] - a[k] : (b[j] - a[j]) * (p[l] - a[l]) - (b[l] - a[l]) * (p[j] - a[j]);
        size += part * part;
      }
      if (size <= most) continue;
      most = size;
      side.v[pass] = (uint32_t)corners[i];
    }
    b = w->vertices.items[side.v[1]].p;
  }
  return side;
}

/* How CGAL splits a flat side into triangles changes from call to call. So that the same mesh always gives the same
 * complex, a side's plane is spanned by corners that do not depend on it, and sides are numbered by them. */
static void settle_sides(work *w, key_list *corners) {
  corners->count = 0;
  for (size_t t = 0; t < w->hull.count; t++)
    for (int k = 0; k < 3; k++) list_push(w, corners, (uint64_t)w->hull.items[t].plane << 32 | w->hull.items[t].v[k]);
  qsort(corners->items, corners->count, sizeof *corners->items, compare_keys);
  size_t kept = 0;
  for (size_t i = 0; i < corners->count; i++)
    if (kept == 0 || corners->items[kept - 1] != corners->items[i]) corners->items[kept++] = corners->items[i];
  struct hull_side *sides = work_block(w, w->hull.count, sizeof *sides);
  size_t count = 0;
  for (size_t begin = 0, end; begin < kept; begin = end) {
    for (end = begin + 1; end < kept && corners->items[end] >> 32 == corners->items[begin] >> 32;) end++;
    struct hull_side side = widest(w, &corners->items[begin], end - begin);
    const size_t planes = w->planes.count, limbs = w->limbs.count;
    uint32_t plane = exact_add_plane(w, side.v[0], side.v[1], side.v[2]);
    for (size_t i = begin; plane == CELLIST_NONE && i < end; i++) { /* a side as thin as rounding: any corner will do */
      side.v[2] = (uint32_t)corners->items[i];
      plane = exact_add_plane(w, side.v[0], side.v[1], side.v[2]);
    }
    if (plane == CELLIST_NONE) work_stop(w, CELLIST_ERROR_INTERNAL, "convexify: the hull has a side of no area");
    if (exact_same_direction(w, plane, side.plane) < 0) {
      const uint32_t swap = side.v[1];
      side.v[1] = side.v[2];
      side.v[2] = swap;
    }
    w->planes.count = planes;
    w->limbs.count = limbs;
    sides[count++] = side;
  }
  qsort(sides, count, sizeof *sides, work_compare3);
  work_reserve(w, &w->ids, w->planes.count + count, sizeof *w->ids.items);
  for (size_t s = 0; s < count; s++)
    w->ids.items[sides[s].plane] = exact_add_plane(w, sides[s].v[0], sides[s].v[1], sides[s].v[2]);
  for (size_t t = 0; t < w->hull.count; t++) w->hull.items[t].plane = w->ids.items[w->hull.items[t].plane];
  work_block_end(w);
}

/* ---- Hull sides less boundary faces -------------------------------------------------------------------------- */

static bool is_on(const hull_sides *s, uint32_t vertex, uint32_t plane) {
  for (uint32_t i = s->start.items[vertex]; i < s->start.items[vertex + 1]; i++)
    if ((uint32_t)s->on.items[i] == plane) return true;
  return false;
}

static void find_vertices_on_sides(work *w, hull_sides *s) {
  const size_t count = w->hull.count, vertex_count = w->vertices.count;
  double_list *boxes = &w->box_scratch, *nodes = &w->node_scratch;
  work_reserve(w, boxes, 6 * count, sizeof(double));
  work_reserve(w, nodes, tree_box_count(count), sizeof(double));
  w->ids.count = 0;
  for (size_t t = 0; t < count; t++) {
    double *box = &boxes->items[6 * t];
    for (int k = 0; k < 3; k++) {
      box[k] = HUGE_VAL;
      box[3 + k] = -HUGE_VAL;
      for (int c = 0; c < 3; c++) {
        const double x = w->vertices.items[w->hull.items[t].v[c]].p[k];
        /* Rounded coordinates of points are monotone, so no margin is needed. */
        box[k] = fmin(box[k], x);
        box[3 + k] = fmax(box[3 + k], x);
      }
    }
    list_push(w, &w->ids, (uint32_t)t);
  }
  tree_build(w->ids.items, count, boxes->items, nodes->items);
  for (uint32_t v = 0; v < vertex_count; v++) {
    const double *p = w->vertices.items[v].p;
    const double box[6] = {p[0], p[1], p[2], p[0], p[1], p[2]};
    w->touched.count = 0;
    tree_meeting(w, w->ids.items, count, boxes->items, nodes->items, box, &w->touched);
    for (size_t i = 0; i < w->touched.count; i++) {
      const uint32_t plane = w->hull.items[w->touched.items[i]].plane;
      if (exact_side(w, v, plane) == 0) list_push(w, &s->on, (uint64_t)v << 32 | plane);
    }
  }
  if (s->on.count > 0) qsort(s->on.items, s->on.count, sizeof *s->on.items, compare_keys);
  size_t kept = 0;
  for (size_t i = 0; i < s->on.count; i++)
    if (kept == 0 || s->on.items[kept - 1] != s->on.items[i]) s->on.items[kept++] = s->on.items[i];
  s->on.count = kept;
  work_reserve(w, &s->start, vertex_count + 1, sizeof *s->start.items);
  for (uint32_t v = 0, i = 0; v <= vertex_count; v++) {
    while (i < kept && s->on.items[i] >> 32 < v) i++;
    s->start.items[v] = i;
  }
}

static void chain_add(work *w, hull_sides *s, uint32_t plane, uint32_t a, uint32_t b) {
  bool forward;
  const uint32_t edge = work_point_edge(w, a, b, &forward);
  list_push(w, &s->chain, (uint64_t)plane << 32 | edge << 1 | !forward);
}

/* The hull's edges between two sides, split at the vertices on both, once for either side. */
static void chain_outlines(work *w, hull_sides *s) {
  struct half_edge *halves = work_block(w, 3 * w->hull.count, sizeof *halves);
  for (size_t t = 0; t < w->hull.count; t++)
    for (size_t k = 0; k < 3; k++) {
      const uint32_t a = w->hull.items[t].v[k], b = w->hull.items[t].v[(k + 1) % 3];
      halves[3 * t + k] =
          (struct half_edge){a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, w->hull.items[t].plane, a < b};
    }
  qsort(halves, 3 * w->hull.count, sizeof *halves, compare_half_edges);
  /* Per pair of sides the vertices on both, in order along their common edge. */
  for (size_t i = 0; i + 1 < 3 * w->hull.count; i += 2) {
    const struct half_edge *x = &halves[i], *y = &halves[i + 1];
    if (x->key != y->key || x->opposite == y->opposite)
      work_stop(w, CELLIST_ERROR_INTERNAL, "convexify: the hull is not closed");
    if (x->face == y->face) continue;
    uint32_t from = (uint32_t)(x->key >> 32), to = (uint32_t)x->key;
    list_push(w, &w->hits, from);
    list_push(w, &w->hits, to);
    list_push(w, &w->hits, x->opposite ? x->face : y->face); /* the side that goes from low to high */
    list_push(w, &w->hits, x->opposite ? y->face : x->face);
  }
  work_block_end(w);
  /* The vertices of a side that has few hull corners may be many: go through them once per side, not per edge. */
  key_list *by_plane = &s->by_plane;
  work_reserve(w, by_plane, s->on.count, sizeof *by_plane->items);
  for (size_t i = 0; i < s->on.count; i++) by_plane->items[i] = s->on.items[i] << 32 | s->on.items[i] >> 32;
  if (s->on.count > 0) qsort(by_plane->items, s->on.count, sizeof *by_plane->items, compare_keys);
  for (size_t i = 0; i < w->hits.count; i += 4) {
    const uint32_t from = w->hits.items[i], to = w->hits.items[i + 1];
    const uint32_t up = w->hits.items[i + 2], down = w->hits.items[i + 3];
    const int along = exact_compare(w, to, from);
    size_t low = 0, high = s->on.count;
    while (low < high) {
      const size_t middle = low + (high - low) / 2;
      if (by_plane->items[middle] >> 32 < up)
        low = middle + 1;
      else
        high = middle;
    }
    w->sorted.count = 0;
    list_push(w, &w->sorted, from);
    for (; low < s->on.count && by_plane->items[low] >> 32 == up; low++) {
      const uint32_t v = (uint32_t)by_plane->items[low];
      if (v == from || v == to || !is_on(s, v, down)) continue;
      if (exact_compare(w, v, from) * along <= 0 || exact_compare(w, to, v) * along <= 0) continue;
      list_push(w, &w->sorted, v);
      for (size_t j = w->sorted.count - 1;
           j > 1 && exact_compare(w, w->sorted.items[j], w->sorted.items[j - 1]) * along < 0; j--) {
        const uint32_t swap = w->sorted.items[j];
        w->sorted.items[j] = w->sorted.items[j - 1];
        w->sorted.items[j - 1] = swap;
      }
    }
    list_push(w, &w->sorted, to);
    for (size_t j = 0; j + 1 < w->sorted.count; j++) {
      chain_add(w, s, up, w->sorted.items[j], w->sorted.items[j + 1]);
      chain_add(w, s, down, w->sorted.items[j + 1], w->sorted.items[j]);
    }
  }
}

/* The hull side that holds all three vertices of a face, or CELLIST_NONE. */
static uint32_t side_of_face(const hull_sides *s, const uint32_t v[3]) {
  for (uint32_t i = s->start.items[v[0]]; i < s->start.items[v[0] + 1]; i++) {
    const uint32_t plane = (uint32_t)s->on.items[i];
    if (is_on(s, v[1], plane) && is_on(s, v[2], plane)) return plane;
  }
  return CELLIST_NONE;
}

/* Edges of boundary faces that touch one hull side in its inside and bound no face on it: slits. on_side[edge]: some
 * face at the edge lies on a side. */
enum { SLIT = 1 };

static void chain_slits(work *w, hull_sides *s, size_t boundary_edge_count, const uint8_t *on_side) {
  for (uint32_t e = 0; e < boundary_edge_count; e++) {
    if (on_side[e]) continue;
    const uint32_t a = w->edges.items[e].v[0], b = w->edges.items[e].v[1];
    uint32_t plane = CELLIST_NONE, count = 0;
    for (uint32_t i = s->start.items[a]; i < s->start.items[a + 1]; i++)
      if (is_on(s, b, (uint32_t)s->on.items[i])) {
        plane = (uint32_t)s->on.items[i];
        count++;
      }
    if (count != 1) continue;
    list_push(w, &s->chain, (uint64_t)plane << 32 | e << 1);
    list_push(w, &s->chain, (uint64_t)plane << 32 | e << 1 | 1);
    w->edges.items[e].stamp = SLIT;
  }
}

static void make_side_facets(work *w, hull_sides *s, uint32_t cell) {
  if (s->chain.count > 0) qsort(s->chain.items, s->chain.count, sizeof *s->chain.items, compare_keys);
  uint32_t facet = CELLIST_NONE, plane = CELLIST_NONE;
  for (size_t i = 0; i < s->chain.count;) {
    const uint64_t key = s->chain.items[i] >> 1;
    int forward = 0, backward = 0;
    for (; i < s->chain.count && s->chain.items[i] >> 1 == key; i++) {
      if (s->chain.items[i] & 1)
        backward++;
      else
        forward++;
    }
    const uint32_t own = (uint32_t)(key >> 31), edge = (uint32_t)(key & 0x7fffffff);
    const bool slit = w->edges.items[edge].stamp == SLIT;
    if (!slit && forward == backward) continue;
    if (own != plane || facet == CELLIST_NONE) {
      facet = work_add_facet(w, own, CELLIST_NONE, cell);
      plane = own;
    }
    if (slit || forward > backward) work_add_use(w, facet, edge, true);
    if (slit || backward > forward) work_add_use(w, facet, edge, false);
  }
}

/* ---- Pieces -------------------------------------------------------------------------------------------------- */

static uint32_t cell_of_facet(const work *w, uint32_t facet) {
  for (int side = 0; side < 2; side++)
    if (w->facets.items[facet].cells[side] < w->mesh->tet_count)
      return w->mesh->tet_origin[w->facets.items[facet].cells[side]];
  return CELLIST_NONE;
}

_Noreturn static void fail_nested(work *w, uint32_t member) {
  work_stop(w, CELLIST_ERROR_GEOMETRY, "the part of the mesh around cell %u lies inside other cells",
            cell_of_facet(w, member / 2));
}

/* The sign of a shell that has no hull side, seen from the exterior: 1 encloses it (a cavity), -1 is enclosed by it. */
static int shell_sign(work *w, const uint32_t *members, size_t count, uint32_t boundary_facets) {
  w->sorted.count = 0;
  for (size_t i = 0; i < count; i++) {
    const uint32_t f = members[i] / 2;
    if (f >= boundary_facets) return 1;
    const uint32_t *v = w->boundary.items[f].v;
    for (int c = 0; c < 3; c++) list_push(w, &w->sorted, v[2 - c]); /* outwards from the exterior */
  }
  return exact_volume_sign(w, w->sorted.items, count);
}

static void add_member(work *w, uint32_t piece, uint32_t member) {
  w->facets.items[member / 2].cells[member % 2] = piece_cell(w, piece);
  set_push(w, &w->pieces.items[piece].members, member);
}

/* Parts the exterior into connected pieces: every outward shell is one, with the inward shells inside it. */
static void make_pieces(work *w, uint32_t boundary_facets) {
  const uint32_t exterior = (uint32_t)w->mesh->tet_count;
  id_list *shells = &w->hits; /* begin, end of each shell's members in w->ids, and sign */
  shells->count = 0;
  id_list *members = &w->ids;
  members->count = 0;
  w->epoch++;
  for (uint32_t f = 0; f < w->facets.count; f++)
    for (uint32_t side = 0; side < 2; side++) {
      if (w->facets.items[f].cells[side] != exterior || w->facets.items[f].stamp[side] == w->epoch) continue;
      const uint32_t begin = (uint32_t)members->count;
      members_connected(w, 2 * f + side, members);
      const uint32_t end = (uint32_t)members->count;
      const int sign = shell_sign(w, &members->items[begin], end - begin, boundary_facets);
      list_push(w, shells, begin);
      list_push(w, shells, end);
      list_push(w, shells, sign >= 0);
      if (sign != 0) continue;
      fail_nested(w, members->items[begin]);
    }
  uint32_t outward = 0;
  for (size_t i = 0; i < shells->count; i += 3) outward += shells->items[i + 2];
  w->sorted.count = 0;
  for (size_t i = 0; i < shells->count; i += 3) {
    const uint32_t piece = shells->items[i + 2] ? work_add_piece(w) : CELLIST_NONE;
    list_push(w, &w->sorted, piece);
  }
  uint32_t shell_number = 0;
  for (size_t i = 0; i < shells->count; i += 3) {
    if (shells->items[i + 2]) continue;
    const uint32_t member = members->items[shells->items[i]];
    /* The container: the innermost outward shell around it. */
    uint32_t container = CELLIST_NONE;
    for (size_t j = 0; j < shells->count; j += 3) {
      if (!shells->items[j + 2]) continue;
      const uint32_t *own = &members->items[shells->items[j]];
      const size_t count = shells->items[j + 1] - shells->items[j];
      if (outward > 1 && !surface_contains(w, own, count, member)) continue;
      if (container == CELLIST_NONE ||
          surface_contains(w, &members->items[shells->items[container]],
                           shells->items[container + 1] - shells->items[container], own[0]))
        container = (uint32_t)j;
    }
    if (container == CELLIST_NONE) fail_nested(w, member);
    const uint32_t piece = w->sorted.items[container / 3];
    shell_number++;
    for (uint32_t m = shells->items[i]; m < shells->items[i + 1]; m++) {
      w->facets.items[members->items[m] / 2].shell = shell_number;
      add_member(w, piece, members->items[m]);
    }
    list_push(w, &w->pieces.items[piece].shells, member);
  }
  for (size_t i = 0; i < shells->count; i += 3)
    for (uint32_t m = shells->items[i]; shells->items[i + 2] && m < shells->items[i + 1]; m++)
      add_member(w, w->sorted.items[i / 3], members->items[m]);
}

/* Marks the input's reflex edges, gives them to their pieces, and links them by their end points. */
static void find_reflex_edges(work *w) {
  id_list *start = &w->input_reflex_start;
  work_reserve(w, start, w->vertices.count + 2, sizeof *start->items);
  start->count = w->vertices.count + 2;
  memset(start->items, 0, start->count * sizeof *start->items);
  for (uint32_t e = 0; e < w->edges.count; e++) {
    const uint32_t cell = sector_reflex_cell(w, e);
    if (cell == CELLIST_NONE) continue;
    edge_own(w, e, cell);
    for (int end = 0; end < 2 && !w->edges.items[e].is_flat; end++) start->items[w->edges.items[e].v[end] + 2]++;
  }
  for (size_t v = 2; v < start->count; v++) start->items[v] += start->items[v - 1];
  work_reserve(w, &w->input_reflex, start->items[start->count - 1], sizeof *w->input_reflex.items);
  for (uint32_t e = 0; e < w->edges.count; e++) {
    const work_edge *edge = &w->edges.items[e];
    for (int end = 0; end < 2 && edge->reflex_cell != CELLIST_NONE && !edge->is_flat; end++)
      w->input_reflex.items[start->items[edge->v[end] + 1]++] = edge->v[1 - end];
  }
}

/* Every edge is used as often forwards as backwards, or the boundary is open there. */
static void check_closed(work *w) {
  for (size_t e = 0; e < w->edges.count; e++) {
    int sum = 0;
    uint32_t facet = 0;
    for (uint32_t u = w->edges.items[e].first_use; u != CELLIST_NONE; u = w->uses.items[u].next_in_edge) {
      const work_use *use = &w->uses.items[u];
      const uint32_t *cells = w->facets.items[use->facet].cells;
      const bool front = cells[0] == w->mesh->tet_count;
      if (!front && cells[1] != w->mesh->tet_count) continue;
      sum += use->forward == front ? 1 : -1;
      facet = use->facet;
    }
    if (sum != 0)
      work_stop(w, CELLIST_ERROR_GEOMETRY, "the boundary is not closed near cell %u", cell_of_facet(w, facet));
  }
}

static void build_facets(work *w, hull_sides *s) {
  const uint32_t exterior = (uint32_t)w->mesh->tet_count;
  const size_t count = w->boundary.count;
  work_reserve(w, &w->ids, count + w->hull.count, sizeof *w->ids.items);
  share_planes(w, count, w->boundary.items[0].v, &w->boundary.items[0].plane, 5, w->ids.items);
  share_planes(w, w->hull.count, w->hull.items[0].v, &w->hull.items[0].plane, 4, w->ids.items);
  settle_sides(w, &s->chain);
  s->chain.count = 0;
  find_vertices_on_sides(w, s);
  uint32_t *sides_of = cellist_allocate(w->context, count, sizeof *sides_of);
  w->side_scratch = sides_of;
  if (sides_of == NULL) work_fail(w, CELLIST_ERROR_OUT_OF_MEMORY);
  for (size_t f = 0; f < count; f++) {
    const boundary_face *face = &w->boundary.items[f];
    sides_of[f] = side_of_face(s, face->v);
    const bool inside = sides_of[f] == CELLIST_NONE;
    if (!inside && exact_same_direction(w, face->plane, sides_of[f]) < 0)
      work_stop(w, CELLIST_ERROR_GEOMETRY, "cell %u lies outside the hull", w->mesh->tet_origin[face->tet]);
    const uint32_t facet =
        work_add_facet(w, inside ? face->plane : sides_of[f], inside ? exterior : CELLIST_NONE, face->tet);
    for (int k = 0; k < 3; k++) work_use_points(w, facet, face->v[k], face->v[(k + 1) % 3]);
  }
  const size_t boundary_edge_count = w->edges.count;
  w->hits.count = 0;
  chain_outlines(w, s);
  work_reserve(w, &w->ids, boundary_edge_count, sizeof *w->ids.items);
  uint8_t *on_side = (uint8_t *)w->ids.items;
  memset(on_side, 0, boundary_edge_count);
  for (size_t f = 0; f < count; f++) {
    if (sides_of[f] == CELLIST_NONE) continue;
    for (int k = 0; k < 3; k++) {
      const uint32_t *v = w->boundary.items[f].v;
      bool forward;
      on_side[work_point_edge(w, v[k], v[(k + 1) % 3], &forward)] = 1;
      chain_add(w, s, sides_of[f], v[(k + 1) % 3], v[k]);
    }
  }
  chain_slits(w, s, boundary_edge_count, on_side);
  make_side_facets(w, s, exterior);
  const size_t side_facets_end = w->facets.count;
  for (size_t f = count; f < side_facets_end; f++) facet_part(w, (uint32_t)f);
  for (size_t f = 0; f < w->facets.count; f++) {
    const work_facet *facet = &w->facets.items[f];
    w->stats.exterior_facets += facet->cells[0] == exterior || facet->cells[1] == exterior;
  }
}

void exterior_build(work *w) {
  build_facets(w, &w->sides);
  w->epoch = SLIT + 1;
  check_closed(w);
  make_pieces(w, (uint32_t)w->boundary.count);
  find_reflex_edges(w);
}
