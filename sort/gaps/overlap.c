/* SPDX-License-Identifier: BSD-3-Clause
 * Overlap: exact tests of two triangles as an eye sees them, without a constructed point.
 *
 * A triangle and the eye span a cone. The cones' interiors are disjoint exactly if a plane through the eye separates
 * them, and if one does, then so does one that holds an edge of either triangle; if the cones may lie on opposite
 * sides of the eye, one may also need the plane through a vertex of each (the extreme rays of the set of separating
 * normals are of these two kinds). All of these are read from 18 signs: each edge's side against each vertex.
 *
 * Where the cones overlap, one triangle is nearer all over the overlap, as they do not cut each other. Planes tell most
 * cases; otherwise the overlap's own vertices tell: a vertex of one triangle inside the other's cone (its side of
 * the other's plane), or two edges that cross (the orientation of their four ends). Triangles of a flawed mesh that
 * cut each other count as "leaves before" if they do so on any ray: what contradicts that makes a group, never a
 * wrong order. Triangles that touch face to face count as "leaves before" too: unmerged seams are such. */
#include "overlap.h"

/* Rounding of one operation. */
static const double UNIT = 0x1p-53;

/* A doubt below this may itself have lost digits. */
static const double UNDERFLOW_GUARD = 1e-290;

enum { UNKNOWN = 2 };

/* 1 if a, b, c turn counter-clockwise as the eye sees them. */
static int turn(const sort_scene *scene, uint32_t a, uint32_t b, uint32_t c) {
  if (a == b || b == c || a == c) return 0;
  if (scene->picture != NULL) {
    const double *p = &scene->picture[2 * (size_t)a], *q = &scene->picture[2 * (size_t)b],
                 *r = &scene->picture[2 * (size_t)c];
    const double qx = q[0] - p[0], qy = q[1] - p[1], rx = r[0] - p[0], ry = r[1] - p[1];
    const double left = qx * ry, right = qy * rx, determinant = left - right;
    /* Each difference is off by at most 2.01 errors of the picture; 4 leaves room for what is of second order. */
    const double doubt = 4 * scene->picture_error * (fabs(qx) + fabs(qy) + fabs(rx) + fabs(ry)) +
                         8 * UNIT * (fabs(left) + fabs(right)) + 16 * scene->picture_error * scene->picture_error;
    if (determinant > doubt) return 1;
    if (-determinant > doubt) return -1;
  }
  const double *x = scene->positions;
  return sort_eye_side(&scene->eye, &x[3 * (size_t)a], &x[3 * (size_t)b], &x[3 * (size_t)c]);
}

/* Which side of the face's plane each of the other face's corners lies on; false as soon as it is known that none lies
 * outside, unless all lie in the plane. range: NULL, or filled with bounds of the corners' heights above the plane. */
static bool sides(const sort_scene *scene, sort_face face, const uint32_t others[3], int signs[3], sort_cover *range) {
  const double *x = scene->positions;
  const uint32_t *own = face.corners;
  bool outside = false, open = false;
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  for (int k = 0; k < 3; k++) {
    const double *v = &x[3 * (size_t)others[k]];
    const double dx = v[0] - face.plane->point[0], dy = v[1] - face.plane->point[1], dz = v[2] - face.plane->point[2];
    const double height = face.plane->normal[0] * dx + face.plane->normal[1] * dy + face.plane->normal[2] * dz;
    const double doubt = face.plane->doubt * (fabs(dx) + fabs(dy) + fabs(dz));
    const bool shared = others[k] == own[0] || others[k] == own[1] || others[k] == own[2];
    const bool decided = doubt > UNDERFLOW_GUARD && (height > doubt || -height > doubt);
    signs[k] = shared ? 0 : decided ? (height > 0 ? 1 : -1) : UNKNOWN;
    outside |= signs[k] == 1;
    open |= signs[k] == UNKNOWN;
    /* Not fmin: a height that is no number must leave bounds that say nothing. */
    const double low = shared ? 0 : height - doubt, high = shared ? 0 : height + doubt;
    lowest = low > lowest ? lowest : low;
    highest = high < highest ? highest : high;
  }
  if (range != NULL) {
    if (lowest > range->hidden) return false;
    range->lowest = lowest;
    range->highest = highest;
  }
  if (outside && !open) return true;
  if (!outside && !open) return signs[0] == 0 && signs[1] == 0 && signs[2] == 0;
  for (int k = 0; k < 3; k++) {
    if (signs[k] == UNKNOWN)
      signs[k] = cellist_orient3d(&x[3 * (size_t)own[0]], &x[3 * (size_t)own[1]], &x[3 * (size_t)own[2]],
                                  &x[3 * (size_t)others[k]]);
    outside |= signs[k] == 1;
  }
  return outside || (signs[0] == 0 && signs[1] == 0 && signs[2] == 0);
}

/* signs[i][k]: the turn of triangle a's edge i (to i + 1) and b's vertex k. Returns false when an edge separates. */
static bool edge_signs(const sort_scene *scene, const uint32_t a[3], const uint32_t b[3], int signs[3][3]) {
  for (int i = 0; i < 3; i++) {
    bool inside = false;
    for (int k = 0; k < 3; k++) {
      signs[i][k] = turn(scene, a[i], a[(i + 1) % 3], b[k]);
      inside |= signs[i][k] > 0;
    }
    if (!inside) return false;
  }
  return true;
}

/* Does the plane through the eye, a vertex of one cone and a vertex of the other separate them? */
static bool vertices_separate(int of_a[3][3], int of_b[3][3]) {
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      /* The plane through a[i] and b[j], at the other two vertices of a and of b. */
      const int a0 = -of_a[i][j], a1 = of_a[(i + 2) % 3][j];
      const int b0 = of_b[j][i], b1 = -of_b[(j + 2) % 3][i];
      if (a0 == 0 && a1 == 0 && b0 == 0 && b1 == 0) continue; /* a[i] and b[j] span no plane */
      if (a0 >= 0 && a1 >= 0 && b0 <= 0 && b1 <= 0) return true;
      if (a0 <= 0 && a1 <= 0 && b0 >= 0 && b1 >= 0) return true;
    }
  }
  return false;
}

static int minimum(const int x[3]) { return x[0] < x[1] ? (x[0] < x[2] ? x[0] : x[2]) : (x[1] < x[2] ? x[1] : x[2]); }

/* Which of b's edges may cross a: not those that have all of a on the inner side, nor those of which both ends lie
 * beyond one of a's edges. */
static uint32_t crossing_edges(int of_a[3][3], int of_b[3][3]) {
  uint32_t crossing = 0;
  for (int j = 0; j < 3; j++) {
    bool crosses = minimum(of_b[j]) < 0;
    for (int i = 0; i < 3; i++) crosses &= of_a[i][j] > 0 || of_a[i][(j + 1) % 3] > 0;
    crossing |= (uint32_t)crosses << j;
  }
  return crossing;
}

bool sort_leaves_before(const sort_scene *scene, sort_face leaving_face, sort_face entering_face, sort_cover *cover) {
  const uint32_t *leaving = leaving_face.corners, *entering = entering_face.corners;
  /* Beyond the leaving face, and before the entering one: outside both. */
  int beyond[3], before[3];
  if (!sides(scene, leaving_face, entering, beyond, cover) || !sides(scene, entering_face, leaving, before, NULL))
    return false;
  const bool coplanar = beyond[0] == 0 && beyond[1] == 0 && beyond[2] == 0;

  /* Both counter-clockwise as the eye sees them; the eye sees the leaving face from behind. */
  const uint32_t a[3] = {leaving[0], leaving[2], leaving[1]};
  const int a_before[3] = {before[0], before[2], before[1]};
  int of_a[3][3], of_b[3][3];
  if (!edge_signs(scene, a, entering, of_a) || !edge_signs(scene, entering, a, of_b)) return false;
  if (scene->around_eye && vertices_separate(of_a, of_b)) return false;
  if (cover != NULL) {
    cover->is_behind = minimum(beyond) >= 0;
    cover->crossing = crossing_edges(of_a, of_b);
  }
  if (coplanar || minimum(beyond) >= 0 || minimum(before) >= 0) return true;

  for (int k = 0; k < 3; k++) {
    const int in_a[3] = {of_a[0][k], of_a[1][k], of_a[2][k]}, in_b[3] = {of_b[0][k], of_b[1][k], of_b[2][k]};
    if (beyond[k] > 0 && minimum(in_a) >= 0) return true;
    if (a_before[k] > 0 && minimum(in_b) >= 0) return true;
  }
  const double *x = scene->positions;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      const int i1 = (i + 1) % 3, j1 = (j + 1) % 3, sign = of_a[i][j1];
      if (sign == 0 || of_a[i][j] != -sign || of_b[j][i1] != -sign || of_b[j][i] != sign) continue;
      if (cellist_orient3d(&x[3 * (size_t)a[i]], &x[3 * (size_t)a[i1]], &x[3 * (size_t)entering[j]],
                           &x[3 * (size_t)entering[j1]]) == sign)
        return true;
    }
  }
  return false;
}
