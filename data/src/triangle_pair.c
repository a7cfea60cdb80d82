/* SPDX-License-Identifier: BSD-3-Clause
 * Triangle pair: which of the ways to meet two triangles have, from signs of orientations alone.
 *
 * Two triangles in general position cut each other's planes in intervals of the planes' common line; whether these
 * overlap takes two orientations more (Guigue and Devillers, "Fast and robust triangle-triangle overlap test using
 * orientation predicates", 2003, section 3). Closed intervals tell touching, open ones crossing. Where triangles share
 * corners by id, which the paper does not treat, these always touch there, so the question is what lies beyond: that
 * follows from the signs already at hand (below). Triangles in one plane are compared by separating lines. */
#include "triangle_pair.h"

#include <cellist/predicates.h>
#include <stdbool.h>

static int sign_of_difference(int a, int b) { return (a > b) - (a < b); }

static bool is_one_side(const int sign[3]) {
  return (sign[0] > 0 && sign[1] > 0 && sign[2] > 0) || (sign[0] < 0 && sign[1] < 0 && sign[2] < 0);
}

static bool is_on_both_sides(const int sign[3]) {
  return (sign[0] > 0 || sign[1] > 0 || sign[2] > 0) && (sign[0] < 0 || sign[1] < 0 || sign[2] < 0);
}

/* Signs of b's corners against a's plane. Corners that a and b share are in it. */
static void sides_of(const pair_triangle *a, const pair_triangle *b, int sign[3]) {
  for (int i = 0; i < 3; i++) {
    const bool is_shared = b->id[i] == a->id[0] || b->id[i] == a->id[1] || b->id[i] == a->id[2];
    sign[i] = is_shared ? 0 : cellist_orient3d(a->corner[0], a->corner[1], a->corner[2], b->corner[i]);
  }
}

/* Turns the corners so that the first is the only one on its (closed) side of the other plane; returns that side. */
static int put_lonely_first(const double *corner[3], const int sign[3]) {
  int lonely = 0, side = 0;
  for (int i = 0; i < 3 && side == 0; i++) {
    const int next = sign[(i + 1) % 3], last = sign[(i + 2) % 3];
    lonely = i;
    if (sign[i] > 0 && next <= 0 && last <= 0) side = 1;
    if (sign[i] < 0 && next >= 0 && last >= 0) side = -1;
    if (sign[i] == 0 && next * last > 0) side = -next;
  }
  const double *turned[3] = {corner[lonely], corner[(lonely + 1) % 3], corner[(lonely + 2) % 3]};
  for (int i = 0; i < 3; i++) corner[i] = turned[i];
  return side;
}

static void exchange(const double **a, const double **b) {
  const double *old = *a;
  *a = *b;
  *b = old;
}

/* Triangles without a common corner whose planes differ and which both reach the other's plane. */
static pair_contact classify_general(const pair_triangle *a, const pair_triangle *b, const int of_a[3],
                                     const int of_b[3]) {
  const double *p[3] = {a->corner[0], a->corner[1], a->corner[2]};
  const double *q[3] = {b->corner[0], b->corner[1], b->corner[2]};
  const int side_a = put_lonely_first(p, of_a), side_b = put_lonely_first(q, of_b);
  if (side_a < 0) exchange(&q[1], &q[2]);
  if (side_b < 0) exchange(&p[1], &p[2]);
  const int first = cellist_orient3d(p[0], p[1], q[0], q[1]), second = cellist_orient3d(p[0], p[2], q[2], q[0]);
  if (first > 0 || second > 0) return PAIR_APART;
  const bool is_open = first < 0 && second < 0 && is_on_both_sides(of_a) && is_on_both_sides(of_b);
  return is_open ? PAIR_CROSS : PAIR_TOUCH;
}

/* Triangles v p1 p2 and v q1 q2, planes differ. With normals n = p1 x p2 and m = q1 x q2 (v the origin), the first
 * meets the other plane along m x n / (m.p2 - m.p1), the second along n x m / (n.q2 - n.q1): so beyond v they meet if
 * both reach the other's plane and these two differences have opposite signs. */
static pair_contact classify_at_corner(int a1, int a2, int b1, int b2) {
  if (a1 * a2 > 0 || b1 * b2 > 0 || sign_of_difference(a2, a1) == sign_of_difference(b2, b1)) return PAIR_APART;
  return a1 * a2 < 0 && b1 * b2 < 0 ? PAIR_CROSS : PAIR_TOUCH;
}

/* ---- In one plane -------------------------------------------------------------------------------- */

typedef struct flat_triangle {
  double corner[3][2]; /* counter-clockwise */
} flat_triangle;

static int flat_side(const flat_triangle *triangle, int edge, const double point[2]) {
  return cellist_orient2d(triangle->corner[edge], triangle->corner[(edge + 1) % 3], point);
}

/* Drops the first axis that leaves the triangle an area; returns its sign, 0 if there is none. */
static int flatten(const pair_triangle *triangle, int axis, flat_triangle *flat) {
  for (int i = 0; i < 3; i++) {
    flat->corner[i][0] = triangle->corner[i][(axis + 1) % 3];
    flat->corner[i][1] = triangle->corner[i][(axis + 2) % 3];
  }
  const int sign = cellist_orient2d(flat->corner[0], flat->corner[1], flat->corner[2]);
  if (sign < 0)
    for (int k = 0; k < 2; k++) {
      const double old = flat->corner[1][k];
      flat->corner[1][k] = flat->corner[2][k];
      flat->corner[2][k] = old;
    }
  return sign;
}

/* 2: a line along an edge of a has a and b strictly on two sides; 1: weakly; 0: none does. */
static int separation(const flat_triangle *a, const flat_triangle *b) {
  int best = 0;
  for (int edge = 0; edge < 3; edge++) {
    int highest = -1;
    for (int i = 0; i < 3; i++) {
      const int side = flat_side(a, edge, b->corner[i]);
      highest = side > highest ? side : highest;
    }
    const int here = highest < 0 ? 2 : highest == 0 ? 1 : 0;
    best = here > best ? here : best;
  }
  return best;
}

/* From origin, do a and b lie in the same direction? */
static bool is_same_direction(const double origin[2], const double a[2], const double b[2]) {
  if (cellist_orient2d(origin, a, b) != 0) return false;
  for (int k = 0; k < 2; k++)
    if (sign_of_difference(a[k] > origin[k], a[k] < origin[k]) !=
        sign_of_difference(b[k] > origin[k], b[k] < origin[k]))
      return false;
  return true;
}

static bool is_same_place(const double a[2], const double b[2]) { return a[0] == b[0] && a[1] == b[1]; }

/* With no area in common: do edges that start in a shared corner run along each other? */
static bool edges_overlap(const flat_triangle *a, const flat_triangle *b) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      if (!is_same_place(a->corner[i], b->corner[j])) continue;
      for (int m = 1; m < 3; m++)
        for (int n = 1; n < 3; n++)
          if (is_same_direction(a->corner[i], a->corner[(i + m) % 3], b->corner[(j + n) % 3])) return true;
    }
  return false;
}

static pair_contact classify_coplanar(const pair_triangle *a, const pair_triangle *b, int shared) {
  flat_triangle flat_a, flat_b;
  for (int axis = 0; axis < 3; axis++) {
    const int sign_a = flatten(a, axis, &flat_a);
    if (sign_a == 0) continue;
    const int sign_b = flatten(b, axis, &flat_b);
    if (sign_b == 0) return PAIR_APART;
    if (shared == 3) return sign_a == sign_b ? PAIR_CROSS : PAIR_MATCH;
    const int ab = separation(&flat_a, &flat_b), ba = separation(&flat_b, &flat_a);
    if (ab == 0 && ba == 0) return sign_a == sign_b ? PAIR_CROSS : PAIR_FACE;
    if (ab == 2 || ba == 2 || shared == 2) return PAIR_APART;
    return shared == 0 || edges_overlap(&flat_a, &flat_b) ? PAIR_TOUCH : PAIR_APART;
  }
  return PAIR_APART;
}

/* Planes of equal coordinate are the commonest common ones, and there the orientations have no filter. */
static bool is_in_one_axis_plane(const pair_triangle *a, const pair_triangle *b) {
  for (int k = 0; k < 3; k++) {
    const double at = a->corner[0][k];
    if (a->corner[1][k] == at && a->corner[2][k] == at && b->corner[0][k] == at && b->corner[1][k] == at &&
        b->corner[2][k] == at)
      return true;
  }
  return false;
}

static bool has_area(const pair_triangle *triangle) {
  flat_triangle flat;
  return flatten(triangle, 0, &flat) != 0 || flatten(triangle, 1, &flat) != 0 || flatten(triangle, 2, &flat) != 0;
}

pair_contact pair_classify(const pair_triangle *a, const pair_triangle *b) {
  int shared = 0, corner_a = 0, corner_b = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      if (a->id[i] == b->id[j]) {
        shared++;
        corner_a = i;
        corner_b = j;
      }
  if (shared == 3 || is_in_one_axis_plane(a, b)) return classify_coplanar(a, b, shared);
  int of_b[3], of_a[3];
  sides_of(a, b, of_b);
  if (is_one_side(of_b)) return PAIR_APART;
  if (of_b[0] == 0 && of_b[1] == 0 && of_b[2] == 0) return has_area(a) ? classify_coplanar(a, b, shared) : PAIR_APART;
  if (shared == 2) return PAIR_APART;
  sides_of(b, a, of_a);
  if (is_one_side(of_a) || (of_a[0] == 0 && of_a[1] == 0 && of_a[2] == 0)) return PAIR_APART;
  if (shared == 0) return classify_general(a, b, of_a, of_b);
  return classify_at_corner(of_a[(corner_a + 1) % 3], of_a[(corner_a + 2) % 3], of_b[(corner_b + 1) % 3],
                            of_b[(corner_b + 2) % 3]);
}
