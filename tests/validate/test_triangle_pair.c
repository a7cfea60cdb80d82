/* SPDX-License-Identifier: BSD-3-Clause
 * Pairs of triangles on small integer grids, where every special case is common, against integer arithmetic that goes
 * another way: intervals on the line of two planes as fractions, and clipping in one plane. */
#include <math.h>
#include <src/triangle_pair.h>
#include <stdbool.h>

#include "harness.h"

typedef __int128_t integer;

struct pair {
  int shared;
  int corner[6][3]; /* of a, then of b, whose first `shared` corners are a's */
  double real[6][3];
  pair_triangle a, b;
};

static int sign(integer x) { return (x > 0) - (x < 0); }

static integer determinant(const int *a, const int *b, const int *c, const int *d) {
  integer e[3][3];
  for (int k = 0; k < 3; k++) {
    e[0][k] = b[k] - a[k];
    e[1][k] = c[k] - a[k];
    e[2][k] = d[k] - a[k];
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* Turns b's or a's corners at random, keeping ids and places together. */
static void finish_pair(struct pair *pair, random_state *random) {
  for (int i = 0; i < 6; i++)
    for (int k = 0; k < 3; k++) pair->real[i][k] = pair->corner[i][k];
  const uint32_t turn_a = (uint32_t)random_below(random, 3), turn_b = (uint32_t)random_below(random, 3);
  const bool flip = random_below(random, 2) != 0;
  for (uint32_t i = 0; i < 3; i++) {
    const uint32_t from_a = (i + turn_a) % 3, step = flip ? 3 - i : i, from_b = (step + turn_b) % 3;
    pair->a.id[i] = from_a;
    pair->a.corner[i] = pair->real[from_a];
    pair->b.id[i] = (int)from_b < pair->shared ? from_b : 3 + from_b;
    pair->b.corner[i] = pair->real[3 + from_b];
  }
}

/* Interval of a triangle on the line where its plane cuts another, given its corners' sides of that plane. */
struct interval {
  bool exists;
  integer low, low_over, high, high_over; /* fractions with positive denominators */
};

static struct interval interval_of(int (*corner)[3], const integer side[3], int axis) {
  struct interval interval = {0};
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3;
    integer at, over;
    if (side[i] == 0) {
      at = corner[i][axis];
      over = 1;
    } else if (sign(side[i]) * sign(side[j]) < 0) {
      at = corner[i][axis] * side[j] - corner[j][axis] * side[i];
      over = side[j] - side[i];
      if (over < 0) at = -at, over = -over;
    } else {
      continue;
    }
    if (!interval.exists || at * interval.low_over < interval.low * over) interval.low = at, interval.low_over = over;
    if (!interval.exists || at * interval.high_over > interval.high * over)
      interval.high = at, interval.high_over = over;
    interval.exists = true;
  }
  return interval;
}

static bool is_mixed(const integer side[3]) {
  bool above = false, below = false;
  for (int i = 0; i < 3; i++) above |= side[i] > 0, below |= side[i] < 0;
  return above && below;
}

static pair_contact expect_in_space(struct pair *pair, const integer of_a[3], const integer of_b[3]) {
  int n[2][3];
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 3; k++) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      int(*p)[3] = &pair->corner[3 * t];
      n[t][k] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
    }
  int axis = -1;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    if (n[0][i] * n[1][j] != n[0][j] * n[1][i]) axis = k;
  }
  if (axis < 0) return PAIR_APART; /* parallel planes */
  const struct interval a = interval_of(&pair->corner[0], of_a, axis), b = interval_of(&pair->corner[3], of_b, axis);
  if (!a.exists || !b.exists) return PAIR_APART;
  const int first = sign(b.high * a.low_over - a.low * b.high_over);
  const int second = sign(a.high * b.low_over - b.low * a.high_over);
  if (first < 0 || second < 0 || (pair->shared > 0 && (first == 0 || second == 0))) return PAIR_APART;
  const bool has_length = first > 0 && second > 0 && sign(a.high * a.low_over - a.low * a.high_over) > 0 &&
                          sign(b.high * b.low_over - b.low * b.high_over) > 0;
  if (pair->shared == 2 || (pair->shared == 1 && !has_length)) return PAIR_APART;
  return has_length && is_mixed(of_a) && is_mixed(of_b) ? PAIR_CROSS : PAIR_TOUCH;
}

/* Filled in place: its triangles point into it. */
static void random_pair(struct pair *pair, random_state *random, int shared) {
  pair->shared = shared;
  const uint64_t range = 2 + random_below(random, 7);
  for (int i = 0; i < 6; i++)
    for (int k = 0; k < 3; k++) pair->corner[i][k] = (int)random_below(random, range);
  for (int i = 0; i < shared; i++)
    for (int k = 0; k < 3; k++) pair->corner[3 + i][k] = pair->corner[i][k];
  finish_pair(pair, random);
}

TEST(triangles_in_two_planes_match_fractions)
{
  random_state random = {41};
  for (int shared = 0; shared <= 2; shared++) {
    size_t seen[PAIR_CROSS + 1] = {0};
    for (int round = 0; round < 150000; round++) {
      struct pair pair;
      random_pair(&pair, &random, shared);
      integer of_a[3], of_b[3];
      int flat = 0;
      for (int i = 0; i < 3; i++) {
        of_a[i] = determinant(pair.corner[3], pair.corner[4], pair.corner[5], pair.corner[i]);
        of_b[i] = determinant(pair.corner[0], pair.corner[1], pair.corner[2], pair.corner[3 + i]);
        flat += (of_a[i] == 0) + (of_b[i] == 0);
      }
      if (flat == 6) continue; /* one plane, or no area */
      const pair_contact expected = expect_in_space(&pair, of_a, of_b);
      assert_int_equal(pair_classify(&pair.a, &pair.b), expected);
      assert_int_equal(pair_classify(&pair.b, &pair.a), expected);
      seen[expected]++;
    }
    assert_true(seen[PAIR_APART] > 100 && (shared == 2 || (seen[PAIR_TOUCH] > 100 && seen[PAIR_CROSS] > 100)));
  }
}

/* ---- In one plane ----------------------------------------------------------------------------------- */

typedef int flat_point[2];

static int turn(const flat_point a, const flat_point b, const flat_point c) {
  const int area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  return (area > 0) - (area < 0);
}

/* Twice the area of the common part, by clipping with floating point: areas below 1e-6 do not occur on such grids. */
static double common_area(flat_point *a, flat_point *b) {
  double polygon[16][2], clipped[16][2];
  int count = 3;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 2; k++) polygon[i][k] = a[i][k];
  const int way = turn(b[0], b[1], b[2]);
  for (int edge = 0; edge < 3; edge++) {
    const int *from = b[edge], *to = b[(edge + 1) % 3];
    int kept = 0;
    for (int i = 0; i < count; i++) {
      const double *p = polygon[i], *q = polygon[(i + 1) % count];
      const double dp = way * ((to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0]));
      const double dq = way * ((to[0] - from[0]) * (q[1] - from[1]) - (to[1] - from[1]) * (q[0] - from[0]));
      if (dp >= 0) clipped[kept][0] = p[0], clipped[kept++][1] = p[1];
      if (dp * dq < 0) {
        const double t = dp / (dp - dq);
        clipped[kept][0] = p[0] + t * (q[0] - p[0]);
        clipped[kept++][1] = p[1] + t * (q[1] - p[1]);
      }
    }
    count = kept;
    for (int i = 0; i < count; i++) polygon[i][0] = clipped[i][0], polygon[i][1] = clipped[i][1];
  }
  double area = 0;
  for (int i = 0; i < count; i++) {
    const double *p = polygon[i], *q = polygon[(i + 1) % count];
    area += p[0] * q[1] - p[1] * q[0];
  }
  return fabs(area);
}

static bool is_between(const flat_point a, const flat_point b, const flat_point p) {
  const int along = (p[0] - a[0]) * (p[0] - b[0]) + (p[1] - a[1]) * (p[1] - b[1]);
  return turn(a, b, p) == 0 && along <= 0;
}

/* Do edges of the two have a point, or (more) a length in common? Without a common area that is all there can be. */
static bool edges_meet(flat_point *a, flat_point *b, bool more) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const int *p = a[i], *q = a[(i + 1) % 3], *r = b[j], *s = b[(j + 1) % 3];
      const bool in_line = turn(p, q, r) == 0 && turn(p, q, s) == 0;
      if (in_line) { /* what they share ends in ends of theirs */
        const int *ends[4] = {p, q, r, s}, *found = NULL;
        for (int m = 0; m < 4; m++) {
          if (!is_between(p, q, ends[m]) || !is_between(r, s, ends[m])) continue;
          if (!more || (found != NULL && (found[0] != ends[m][0] || found[1] != ends[m][1]))) return true;
          found = ends[m];
        }
      } else if (!more && turn(p, q, r) * turn(p, q, s) <= 0 && turn(r, s, p) * turn(r, s, q) <= 0) {
        return true;
      }
    }
  return false;
}

TEST(triangles_in_one_plane_match_clipping)
{
  random_state random = {42};
  for (int shared = 0; shared <= 3; shared++) {
    size_t seen[PAIR_CROSS + 1] = {0};
    for (int round = 0; round < 100000; round++) {
      struct pair pair = {.shared = shared};
      flat_point flat[6];
      const uint64_t range = 3 + random_below(&random, 5);
      for (int i = 0; i < 6; i++)
        for (int k = 0; k < 2; k++) flat[i][k] = (int)random_below(&random, range);
      for (int i = 0; i < shared; i++) flat[3 + i][0] = flat[i][0], flat[3 + i][1] = flat[i][1];
      if (turn(flat[0], flat[1], flat[2]) == 0 || turn(flat[3], flat[4], flat[5]) == 0) continue;
      bool is_doubled = false; /* a corner in the place of another without being shared by id */
      for (int i = 0; i < 3; i++)
        for (int j = 3; j < 6; j++)
          is_doubled |= !(i == j - 3 && i < shared) && flat[i][0] == flat[j][0] && flat[i][1] == flat[j][1];
      if (is_doubled && shared > 0) continue;
      const int lift = (int)random_below(&random, 4); /* z = 0, x, y or 2 x + 3 y + 1 */
      for (int i = 0; i < 6; i++) {
        const int x = flat[i][0], y = flat[i][1];
        pair.corner[i][0] = x;
        pair.corner[i][1] = y;
        pair.corner[i][2] = lift == 0 ? 0 : lift == 1 ? x : lift == 2 ? y : 2 * x + 3 * y + 1;
      }
      finish_pair(&pair, &random);
      int way[2]; /* read off the triangles as they are given to the function */
      for (int t = 0; t < 2; t++) {
        const pair_triangle *triangle = t == 0 ? &pair.a : &pair.b;
        flat_point p[3];
        for (int i = 0; i < 3; i++)
          for (int k = 0; k < 2; k++) p[i][k] = (int)triangle->corner[i][k];
        way[t] = turn(p[0], p[1], p[2]);
      }
      const bool same_way = way[0] == way[1];
      pair_contact expected = PAIR_APART;
      if (shared == 3)
        expected = same_way ? PAIR_CROSS : PAIR_MATCH;
      else if (common_area(&flat[0], &flat[3]) > 1e-6)
        expected = same_way ? PAIR_CROSS : PAIR_FACE;
      else if (shared < 2 && edges_meet(&flat[0], &flat[3], shared == 1))
        expected = PAIR_TOUCH;
      assert_int_equal(pair_classify(&pair.a, &pair.b), expected);
      assert_int_equal(pair_classify(&pair.b, &pair.a), expected);
      seen[expected]++;
    }
    assert_true(seen[PAIR_CROSS] > 100 && (shared == 3 || (seen[PAIR_FACE] > 100 && seen[PAIR_APART] > 100)));
    assert_true(shared >= 2 || seen[PAIR_TOUCH] > 100);
  }
}

TEST(triangles_without_area_meet_nothing)
{
  static const double points[6][3] = {{0, 0, 0}, {2, 2, 2}, {4, 4, 4}, {1, 0, 1}, {0, 1, 1}, {3, 3, 0}};
  const pair_triangle line = {{0, 1, 2}, {points[0], points[1], points[2]}};
  const pair_triangle other = {{3, 4, 5}, {points[3], points[4], points[5]}};
  assert_int_equal(pair_classify(&line, &other), PAIR_APART);
  assert_int_equal(pair_classify(&other, &line), PAIR_APART);
  assert_int_equal(pair_classify(&line, &line), PAIR_APART);
}
