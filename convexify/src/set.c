/* SPDX-License-Identifier: BSD-3-Clause
 * Set: the facets or the reflex edges of a piece, kept so that those which a plane comes near are found without looking
 * at the others: without it every cut of a large piece costs as much as the piece has facets (two spheres of 20,000
 * triangles each took 12 s instead of 2).
 *
 * A set grows by a few items a cut and loses some to other pieces. The logarithmic method (Bentley and Saxe 1980) suits
 * that: trees of boxes over ever smaller runs of items, a short unsorted tail, and a merge of the last runs whenever
 * the tail is full. Items that left are dropped then. Boxes are those of the day a tree was built: facets and edges
 * only ever shrink. */
#include "tree.h"

enum {
  TAIL = 64, /* items without a tree; a scan of fewer is cheaper than the walk */
  STALE = 32 /* items that left, beyond as many as are left, before all is rebuilt */
};

/* Doubles of a rounded plane and a rounded box: their sum of four terms is off by less than this part of the terms. */
static const double BOX_BOUND = 64 * 0x1p-53;
/* Rounded coordinates are below this: the work's unit is at least a quarter of the extent, a box stands out by less. */
static const double COORDINATE_LIMIT = 8;

work_set *set_of(work *w, uint32_t piece, set_kind kind) {
  work_piece *p = &w->pieces.items[piece];
  return kind == SET_MEMBERS ? &p->members : kind == SET_REFLEX ? &p->reflex : &p->flat;
}

bool set_holds(const work *w, uint32_t cell, set_kind kind, uint32_t item) {
  if (kind == SET_MEMBERS) return w->facets.items[item / 2].cells[item % 2] == cell;
  return w->edges.items[item].reflex_cell == cell && w->edges.items[item].is_flat == (kind == SET_FLAT);
}

void set_push(work *w, work_set *set, uint32_t item) {
  list_push(w, &set->items, item);
  set->live++;
}

void set_release(work *w, work_set *set) {
  cellist_deallocate(w->context, set->items.items);
  cellist_deallocate(w->context, set->segments.items);
  cellist_deallocate(w->context, set->boxes.items);
  *set = (work_set){0};
}

void set_list(work *w, uint32_t piece, set_kind kind, id_list *out) {
  const id_list *items = &set_of(w, piece, kind)->items;
  out->count = 0;
  for (size_t i = 0; i < items->count; i++)
    if (set_holds(w, piece_cell(w, piece), kind, items->items[i])) list_push(w, out, items->items[i]);
}

static void grow_box(const work *w, double *box, uint32_t edge) {
  for (int end = 0; end < 2; end++) {
    const double *p = w->vertices.items[w->edges.items[edge].v[end]].p;
    for (int k = 0; k < 3; k++) {
      box[k] = fmin(box[k], p[k]);
      box[3 + k] = fmax(box[3 + k], p[k]);
    }
  }
}

static void box_of(const work *w, set_kind kind, uint32_t item, double *box) {
  for (int k = 0; k < 3; k++) {
    box[k] = HUGE_VAL;
    box[3 + k] = -HUGE_VAL;
  }
  if (kind != SET_MEMBERS) {
    grow_box(w, box, item);
    return;
  }
  for (EACH_USE(w, u, item / 2)) grow_box(w, box, w->uses.items[u].edge);
}

/* A tree over the items from begin to the end. */
static void build_segment(work *w, work_set *set, set_kind kind, size_t begin) {
  const size_t count = set->items.count - begin;
  uint32_t *items = set->items.items + begin;
  work_reserve(w, &w->set_boxes, 6 * count, sizeof *w->set_boxes.items);
  work_reserve(w, &w->set_order, 2 * count, sizeof *w->set_order.items);
  uint32_t *order = w->set_order.items, *moved = order + count;
  for (size_t i = 0; i < count; i++) {
    order[i] = (uint32_t)i;
    moved[i] = items[i];
    box_of(w, kind, items[i], &w->set_boxes.items[6 * i]);
  }
  const work_segment segment = {(uint32_t)count, (uint32_t)set->boxes.count};
  work_reserve(w, &set->boxes, set->boxes.count + tree_box_count(count), sizeof *set->boxes.items);
  list_push(w, &set->segments, segment);
  double *nodes = set->boxes.items + segment.boxes;
  tree_build(order, count, w->set_boxes.items, nodes);
  for (size_t i = 0; i < tree_box_count(count); i += 6)
    for (size_t k = i; k < i + 3; k++) { /* the margin covers the rounding */
      const double low = nodes[k], high = nodes[k + 3];
      nodes[k] = 0.5 * (low + high);
      nodes[k + 3] = 0.5 * (high - low);
    }
  set->boxes.count += tree_box_count(count);
  for (size_t i = 0; i < count; i++) items[i] = moved[order[i]];
}

void set_arrange(work *w, uint32_t piece, set_kind kind) {
  work_set *set = set_of(w, piece, kind);
  const uint32_t cell = piece_cell(w, piece);
  size_t begin = 0;
  for (size_t i = 0; i < set->segments.count; i++) begin += set->segments.items[i].count;
  if (set->items.count > 2 * set->live + STALE) {
    begin = 0;
    set->segments.count = 0;
  } else if (set->items.count - begin < TAIL) {
    return;
  }
  while (set->segments.count > 0) {
    const work_segment *last = &set->segments.items[set->segments.count - 1];
    if (last->count > 2 * (set->items.count - begin)) break;
    begin -= last->count;
    set->segments.count--;
  }
  const work_segment *last = set->segments.count > 0 ? &set->segments.items[set->segments.count - 1] : NULL;
  set->boxes.count = last != NULL ? last->boxes + tree_box_count(last->count) : 0;
  size_t kept = begin;
  for (size_t i = begin; i < set->items.count; i++)
    if (set_holds(w, cell, kind, set->items.items[i])) set->items.items[kept++] = set->items.items[i];
  set->items.count = kept;
  if (kept - begin >= TAIL) build_segment(w, set, kind, begin);
}

typedef struct set_query {
  const double *normal, *nodes;
  double size[3]; /* of the normal's components */
  double offset, margin;
  id_list *out;
  int sides;
} set_query;

/* Which side of the plane a box (centre, half sizes) is on for sure, or 0. */
static int box_side(const set_query *q, const double *box) {
  const double *n = q->normal;
  const double value = q->offset + n[0] * box[0] + n[1] * box[1] + n[2] * box[2];
  const double near = q->margin + q->size[0] * box[3] + q->size[1] * box[4] + q->size[2] * box[5];
  return value > near ? 1 : value < -near ? -1 : 0;
}

static void visit(work *w, set_query *q, const uint32_t *items, size_t count, size_t node) {
  const int side = box_side(q, &q->nodes[6 * node]);
  if (side != 0) {
    q->sides |= side > 0 ? 4 : 1;
  } else if (count > TREE_LEAF) {
    const size_t half = count / 2;
    visit(w, q, items, half, 2 * node + 1);
    visit(w, q, items + half, count - half, 2 * node + 2);
  } else {
    for (size_t i = 0; i < count; i++) list_push(w, q->out, items[i]);
  }
}

int set_near(work *w, const work_set *set, const double normal[3], double offset, double margin, id_list *out) {
  set_query query = {.normal = normal, .offset = offset, .out = out};
  double terms = fabs(offset);
  for (int k = 0; k < 3; k++) {
    query.size[k] = fabs(normal[k]);
    terms += query.size[k] * COORDINATE_LIMIT;
  }
  query.margin = margin + BOX_BOUND * terms;
  out->count = 0;
  size_t begin = 0;
  for (size_t i = 0; i < set->segments.count; i++) {
    const work_segment *segment = &set->segments.items[i];
    query.nodes = set->boxes.items + segment->boxes;
    visit(w, &query, set->items.items + begin, segment->count, 0);
    begin += segment->count;
  }
  for (size_t i = begin; i < set->items.count; i++) list_push(w, out, set->items.items[i]);
  return query.sides;
}
