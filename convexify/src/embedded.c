/* SPDX-License-Identifier: BSD-3-Clause
 * Embedded: whether the boundary is one that an exterior can lie outside of. Faces may share vertices and edges, no
 * more; a crushed mesh, whose faces cross, is found here, before anything is built on it. Closed surfaces that do not
 * cross may still enclose each other wrongly (a solid within a solid): exterior.c finds that. All tests exact. */
#include <cellist/predicates.h>

#include "tree.h"

/* Faces between two reports: a few milliseconds. */
enum { PROGRESS_FACES = 1024 };

static int orient(const work *w, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  return cellist_orient3d(exact_point(w, a), exact_point(w, b), exact_point(w, c), exact_point(w, d));
}

/* The turn a, b, c with the axis left out. */
static int flat_turn(const work *w, int axis, uint32_t a, uint32_t b, uint32_t c) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double *p = exact_point(w, a), *q = exact_point(w, b), *r = exact_point(w, c);
  return cellist_orient2d((const double[2]){p[i], p[j]}, (const double[2]){q[i], q[j]}, (const double[2]){r[i], r[j]});
}

static bool flat_segments_meet(const work *w, int axis, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  const int ac = flat_turn(w, axis, a, b, c), ad = flat_turn(w, axis, a, b, d);
  const int ca = flat_turn(w, axis, c, d, a), cb = flat_turn(w, axis, c, d, b);
  if (ac != 0 || ad != 0 || ca != 0 || cb != 0) return ac * ad <= 0 && ca * cb <= 0;
  const double *p = exact_point(w, a), *q = exact_point(w, b), *r = exact_point(w, c), *s = exact_point(w, d);
  for (int k = 0; k < 3; k++)
    if (k != axis && (fmax(p[k], q[k]) < fmin(r[k], s[k]) || fmax(r[k], s[k]) < fmin(p[k], q[k]))) return false;
  return true;
}

/* Whether the closed segment p q meets the closed triangle. */
static bool segment_meets(work *w, uint32_t p, uint32_t q, const boundary_face *face) {
  const uint32_t *t = face->v;
  const int at_p = exact_side(w, p, face->plane), at_q = exact_side(w, q, face->plane);
  if (at_p * at_q > 0) return false;
  if (at_p != 0 || at_q != 0) {
    const int a = orient(w, p, q, t[0], t[1]), b = orient(w, p, q, t[1], t[2]), c = orient(w, p, q, t[2], t[0]);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
  }
  int axis = 0;
  while (flat_turn(w, axis, t[0], t[1], t[2]) == 0) axis++; /* a boundary face has area */
  const int a = flat_turn(w, axis, t[0], t[1], p), b = flat_turn(w, axis, t[1], t[2], p),
            c = flat_turn(w, axis, t[2], t[0], p);
  if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) return true;
  for (int i = 0; i < 3; i++)
    if (flat_segments_meet(w, axis, p, q, t[i], t[(i + 1) % 3])) return true;
  return false;
}

/* Whether two faces meet in more than the vertices that they share. */
static bool faces_cross(work *w, const boundary_face *first, const boundary_face *second) {
  const uint32_t *a = first->v, *b = second->v;
  int shared = 0, own_a = 0, own_b = 0; /* sums of the corners that are shared: 0 + 1 + 2 less these are the others */
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      if (a[i] == b[j]) {
        shared++;
        own_a += i;
        own_b += j;
      }
  if (shared >= 3) return true;
  if (shared == 2) {
    const int i = 3 - own_a, j = 3 - own_b;
    const uint32_t u = a[(i + 1) % 3], v = a[(i + 2) % 3];
    if (exact_side(w, b[j], first->plane) != 0) return false;
    int axis = 0;
    while (flat_turn(w, axis, u, v, a[i]) == 0) axis++;
    return flat_turn(w, axis, u, v, a[i]) == flat_turn(w, axis, u, v, b[j]);
  }
  if (shared == 1) {
    const int i = own_a, j = own_b;
    return segment_meets(w, a[(i + 1) % 3], a[(i + 2) % 3], second) ||
           segment_meets(w, b[(j + 1) % 3], b[(j + 2) % 3], first);
  }
  for (int i = 0; i < 3; i++)
    if (segment_meets(w, a[i], a[(i + 1) % 3], second) || segment_meets(w, b[i], b[(i + 1) % 3], first)) return true;
  return false;
}

void boundary_check_embedded(work *w) {
  const size_t count = w->boundary.count;
  double_list *boxes = &w->box_scratch, *nodes = &w->node_scratch;
  work_reserve(w, boxes, 6 * count, sizeof(double));
  work_reserve(w, nodes, tree_box_count(count), sizeof(double));
  id_list *ids = &w->ids;
  ids->count = 0;
  for (size_t f = 0; f < count; f++) {
    double *box = &boxes->items[6 * f];
    for (int k = 0; k < 3; k++) {
      const uint32_t *v = w->boundary.items[f].v;
      const double x = exact_point(w, v[0])[k], y = exact_point(w, v[1])[k], z = exact_point(w, v[2])[k];
      box[k] = fmin(x, fmin(y, z));
      box[3 + k] = fmax(x, fmax(y, z));
    }
    list_push(w, ids, (uint32_t)f);
  }
  tree_build(ids->items, count, boxes->items, nodes->items);
  id_list *near = &w->touched;
  for (size_t f = 0; f < count; f++) {
    if (f % PROGRESS_FACES == 0)
      work_progress(w, PROGRESS_BOUNDARY, PROGRESS_CUT, 0.1 + 0.8 * (double)f / (double)count);
    near->count = 0;
    tree_meeting(w, ids->items, count, boxes->items, nodes->items, &boxes->items[6 * f], near);
    for (size_t i = 0; i < near->count; i++) {
      const uint32_t g = near->items[i];
      if (g <= f || !faces_cross(w, &w->boundary.items[f], &w->boundary.items[g])) continue;
      const uint32_t *origin = w->mesh->tet_origin;
      work_stop(w, CELLIST_ERROR_GEOMETRY,
                "boundary faces of cells %u and %u cross, or touch other than at shared vertices and edges",
                origin[w->boundary.items[f].tet], origin[w->boundary.items[g].tet]);
    }
  }
}
