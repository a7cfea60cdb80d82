/* SPDX-License-Identifier: BSD-3-Clause
 * Flat: reflex edges that a user lets count as flat. Curved boundaries and faces that were split in two have many that
 * are reflex by a hair, and each of them costs a cell ([C] has 836 cells for spx by moving near vertices onto planes).
 *
 * Signs stay exact; what is given up is convexity, by a known measure. An angle alone bounds nothing: along a saddle,
 * or around a sphere, small angles add up. So a piece is left as it is only if no vertex of it stands farther beyond
 * the plane of one of its facets than a single edge of the angle could bring it: the sine times the piece's diagonal.
 * Every point of a piece lies within the hull of its vertices, so this bounds how deep a ray can be on the wrong side
 * of a plane. Angle and distance are computed from exact coefficients: their error is a few units in the last place. */
#include "tree.h"

/* Angle and distance are rounded up by this factor, more than what their last steps lose. */
static const double ROUND_UP = 1 + 0x1p-44;

double flat_angle(work *w, const work_event *begin, const work_event *end) {
  const uint32_t a = w->facets.items[begin->facet].plane, b = w->facets.items[end->facet].plane;
  const double *m = w->planes.items[a].normal, *n = w->planes.items[b].normal;
  if (begin->direction * end->direction * (m[0] * n[0] + m[1] * n[1] + m[2] * n[2]) >= 0) return PI;
  double cross[3];
  for (int k = 0; k < 3; k++) cross[k] = exact_cross_value(w, a, b, k);
  const double sine = hypot(hypot(cross[0], cross[1]), cross[2]) / hypot(hypot(m[0], m[1]), m[2]) /
                      hypot(hypot(n[0], n[1]), n[2]) * ROUND_UP;
  return sine < 1 ? asin(sine) * ROUND_UP : PI;
}

bool flat_edge(work *w, uint32_t edge, uint32_t cell) {
  if (!(w->flat > 0)) return false;
  sectors_gather(w, edge, cell);
  for (size_t i = 0; i + 1 < w->events.count; i += 2) {
    const work_event *begin = &w->events.items[i], *end = &w->events.items[i + 1];
    if (sector_angle(w, edge, begin, end) < 0 && flat_angle(w, begin, end) > w->flat) return false;
  }
  return true;
}

typedef struct overhang {
  work *w;
  const uint32_t *vertices; /* ids of the tree's items */
  const double *nodes;
  uint32_t plane;
  double sign; /* 1: beyond is where the plane is positive */
  double size; /* of the plane's normal */
  double most; /* so far */
} overhang;

static void look_beyond(overhang *o, const uint32_t *items, size_t count, size_t node) {
  const work_plane *p = &o->w->planes.items[o->plane];
  const double *box = &o->nodes[6 * node];
  double value = p->offset, terms = fabs(p->offset);
  for (int k = 0; k < 3; k++) {
    const double n = p->normal[k];
    value += n * (o->sign * n > 0 ? box[3 + k] : box[k]);
    terms += fabs(n) * fmax(fabs(box[k]), fabs(box[3 + k]));
  }
  if (o->sign * value + SIDE_BOUND * terms <= o->most * o->size) return;
  if (count > TREE_LEAF) {
    const size_t half = count / 2;
    look_beyond(o, items, half, 2 * node + 1);
    look_beyond(o, items + half, count - half, 2 * node + 2);
    return;
  }
  for (size_t i = 0; i < count; i++) {
    const uint32_t vertex = o->vertices[items[i]];
    const double *v = o->w->vertices.items[vertex].p;
    const double x = p->normal[0] * v[0], y = p->normal[1] * v[1], z = p->normal[2] * v[2];
    const double error = SIDE_BOUND * (fabs(x) + fabs(y) + fabs(z) + fabs(p->offset));
    if (o->sign * (x + y + z + p->offset) + error <= o->most * o->size) continue;
    o->most = fmax(o->most, o->sign * exact_height(o->w, vertex, o->plane) / o->size * ROUND_UP);
  }
}

double flat_overhang(work *w, const uint32_t *members, size_t count, double *diagonal) {
  id_list *vertices = &w->set_order, *planes = &w->near;
  vertices->count = planes->count = 0;
  w->epoch_edges++;
  for (size_t i = 0; i < count; i++) {
    list_push(w, planes, 2 * w->facets.items[members[i] / 2].plane + members[i] % 2);
    for (EACH_USE(w, u, members[i] / 2))
      for (int end = 0; end < 2; end++) {
        const uint32_t v = w->edges.items[w->uses.items[u].edge].v[end];
        if (w->vertices.items[v].visited == w->epoch_edges) continue;
        w->vertices.items[v].visited = w->epoch_edges;
        list_push(w, vertices, v);
      }
  }
  const size_t vertex_count = vertices->count;
  work_reserve(w, vertices, 2 * vertex_count, sizeof *vertices->items);
  work_reserve(w, &w->set_boxes, 6 * vertex_count, sizeof *w->set_boxes.items);
  work_reserve(w, &w->node_scratch, tree_box_count(vertex_count), sizeof(double));
  uint32_t *items = vertices->items + vertex_count;
  for (size_t i = 0; i < vertex_count; i++) {
    items[i] = (uint32_t)i;
    for (int k = 0; k < 6; k++) w->set_boxes.items[6 * i + (size_t)k] = w->vertices.items[vertices->items[i]].p[k % 3];
  }
  tree_build(items, vertex_count, w->set_boxes.items, w->node_scratch.items);
  overhang o = {.w = w, .vertices = vertices->items, .nodes = w->node_scratch.items};
  const double *box = w->node_scratch.items;
  *diagonal = hypot(hypot(box[3] - box[0], box[4] - box[1]), box[5] - box[2]);
  uint32_t last = CELLIST_NONE;
  for (size_t i = 0; i < planes->count; i++) {
    if (planes->items[i] == last) continue;
    last = planes->items[i];
    o.plane = last / 2;
    o.sign = last % 2 == 0 ? -1 : 1;
    const double *n = w->planes.items[o.plane].normal;
    o.size = hypot(hypot(n[0], n[1]), n[2]);
    look_beyond(&o, items, vertex_count, 0);
  }
  return o.most;
}

bool flat_enough(work *w, const uint32_t *members, size_t count) {
  double diagonal;
  const double most = flat_overhang(w, members, count, &diagonal);
  return most <= sin(w->flat) * diagonal;
}
