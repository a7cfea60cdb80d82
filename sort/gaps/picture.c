/* SPDX-License-Identifier: BSD-3-Clause
 * Pictures: conservative projections that find candidates; they never decide anything.
 *
 * Outside the mesh one picture does, on a plane across the line from the eye to the mesh's middle, whatever the camera
 * looks at. Vertices are taken relative to the middle, so that a far eye loses no digits: with right and up
 * orthogonal to the axis to within rounding, what is neglected shifts all of the picture alike.
 * Inside, or close to a long flank, six pictures around the eye do, each with the faces clipped to its quarter turn. */
#include "picture.h"

#include <math.h>
#include <string.h>

/* Rounding of one operation. */
static const double UNIT = 0x1p-53;

/* How many roundings a coordinate of the picture may suffer, generously (about 20 are counted): a smaller number lets
 * rounding decide turns. */
static const double PICTURE_ROUNDINGS = 64;

/* A vertex must lie within this cosine (72 degrees) of the picture's axis. Nearer to 0 the picture stretches; only
 * speed depends on it. */
static const double WIDEST_COSINE = 0.3;

/* A cube side's picture reaches this much over its edge, and its boxes are wider by it: more than rounding moves a
 * clipped corner. Smaller, a face that touches the edge might be missed on both sides of it. */
static const double CUBE_MARGIN = 1e-7;

/* A clipped corner nearer to the eye than this part of its triangle's size is not to be trusted: the box is the whole
 * side. Below CUBE_MARGIN times this, rounding could move a corner out of its box. */
static const double CUBE_NEAREST = 1e-6;

static double smaller(double a, double b) { return a < b ? a : b; }
static double larger(double a, double b) { return a > b ? a : b; }

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* A unit vector along v, without overflow; v is not 0. */
static void normalise(const double *v, double *out) {
  const double largest = larger(fabs(v[0]), larger(fabs(v[1]), fabs(v[2])));
  for (int k = 0; k < 3; k++) out[k] = v[k] / largest;
  const double length = sqrt(dot(out, out));
  for (int k = 0; k < 3; k++) out[k] /= length;
}

/* right x up = towards. */
static void make_frame(const double towards[3], double right[3], double up[3]) {
  int smallest = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(towards[k]) < fabs(towards[smallest])) smallest = k;
  double axis[3] = {0, 0, 0};
  axis[smallest] = 1;
  double across[3];
  for (int k = 0; k < 3; k++)
    across[k] = axis[(k + 1) % 3] * towards[(k + 2) % 3] - axis[(k + 2) % 3] * towards[(k + 1) % 3];
  normalise(across, right);
  for (int k = 0; k < 3; k++)
    up[k] = towards[(k + 1) % 3] * right[(k + 2) % 3] - towards[(k + 2) % 3] * right[(k + 1) % 3];
}

bool sort_picture_project(const sort_boundary *boundary, const uint32_t *vertices, size_t count, const sort_eye *eye,
                          double *picture, double *depths, double *error, double *depth_error) {
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < count; i++) {
    const double *p = &boundary->positions[3 * (size_t)vertices[i]];
    for (size_t k = 0; k < 3; k++) {
      low[k] = smaller(low[k], p[k]);
      high[k] = larger(high[k], p[k]);
    }
  }
  double middle[3], towards[3], distance = 0, radius = 0;
  for (int k = 0; k < 3; k++) {
    middle[k] = 0.5 * low[k] + 0.5 * high[k];
    towards[k] = eye->parallel ? eye->at[k] : eye->at[k] - middle[k];
    distance = larger(distance, fabs(towards[k]));
    radius = larger(radius, high[k] - middle[k]);
  }
  if (distance == 0) return false;
  normalise(towards, towards);
  if (!eye->parallel) {
    double to_eye[3];
    for (int k = 0; k < 3; k++) to_eye[k] = eye->at[k] - middle[k];
    distance = dot(to_eye, towards);
  }
  double right[3], up[3];
  make_frame(towards, right, up);
  double nearest = HUGE_VAL, widest = 0;
  for (size_t i = 0; i < count; i++) {
    const size_t vertex = vertices[i];
    double v[3];
    for (size_t k = 0; k < 3; k++) v[k] = boundary->positions[3 * vertex + k] - middle[k];
    double x = dot(v, right), y = dot(v, up);
    const double depth = (eye->parallel ? 0 : distance) - dot(v, towards);
    depths[vertex] = depth;
    if (!eye->parallel) {
      if (!(depth > 0) || !(depth >= WIDEST_COSINE * sqrt(x * x + y * y + depth * depth))) return false;
      x /= depth;
      y /= depth;
      nearest = smaller(nearest, depth);
    }
    picture[2 * vertex] = x;
    picture[2 * vertex + 1] = y;
    widest = larger(widest, larger(fabs(x), fabs(y)));
  }
  const double stretch = eye->parallel ? larger(1, radius / widest) : (distance + 2 * radius) / nearest;
  *error = PICTURE_ROUNDINGS * UNIT * widest * stretch;
  *depth_error = PICTURE_ROUNDINGS * UNIT * ((eye->parallel ? 0 : distance) + 3 * radius);
  if (isfinite(*error) && isfinite(4 * distance + 8 * radius)) return true;
  if (!eye->parallel) return false;
  /* No extent, or too large a one for doubles: all in one place, so that exact tests decide everything. */
  for (size_t i = 0; i < count; i++)
    picture[2 * (size_t)vertices[i]] = picture[2 * (size_t)vertices[i] + 1] = depths[vertices[i]] = 0;
  *error = *depth_error = 0;
  return true;
}

sort_box sort_picture_box(const double *picture, const double *depths, double error, double depth_error,
                          const uint32_t corners[3]) {
  const double *p = &picture[2 * (size_t)corners[0]], *q = &picture[2 * (size_t)corners[1]],
               *r = &picture[2 * (size_t)corners[2]];
  sort_box box;
  for (int k = 0; k < 2; k++) {
    const double least = p[k] < q[k] ? p[k] : q[k], most = p[k] < q[k] ? q[k] : p[k];
    box.low[k] = (least < r[k] ? least : r[k]) - 2 * error;
    box.high[k] = (most > r[k] ? most : r[k]) + 2 * error;
  }
  const double a = depths[corners[0]], b = depths[corners[1]], c = depths[corners[2]];
  box.nearest = smaller(a, smaller(b, c)) - depth_error;
  box.farthest = larger(a, larger(b, c)) + depth_error;
  return box;
}

/* Cuts a convex polygon of count corners by height >= 0, where height = (1 + margin) z + sign * coordinate. */
static int clip(double (*polygon)[3], int count, int coordinate, double sign) {
  double kept[8][3];
  int kept_count = 0;
  for (int i = 0; i < count; i++) {
    const double *a = polygon[i], *b = polygon[(i + 1) % count];
    const double at_a = (1 + CUBE_MARGIN) * a[2] + sign * a[coordinate];
    const double at_b = (1 + CUBE_MARGIN) * b[2] + sign * b[coordinate];
    if (at_a >= 0) memcpy(kept[kept_count++], a, sizeof kept[0]);
    if ((at_a < 0) == (at_b < 0)) continue;
    const double t = at_a / (at_a - at_b);
    for (int k = 0; k < 3; k++) kept[kept_count][k] = a[k] + t * (b[k] - a[k]);
    kept_count++;
  }
  memcpy(polygon, kept, (size_t)kept_count * sizeof kept[0]);
  return kept_count;
}

sort_box sort_cube_box(const double eye[3], const double *positions, const uint32_t corners[3], int side) {
  const sort_box nowhere = {{1, 1}, {-1, -1}, HUGE_VAL, -HUGE_VAL};
  sort_box everywhere = {{-1, -1}, {1, 1}, -HUGE_VAL, HUGE_VAL};
  double polygon[8][3], size = 0;
  const int axis = side / 2;
  for (int c = 0; c < 3; c++) {
    double v[3];
    for (int k = 0; k < 3; k++) {
      v[k] = positions[3 * (size_t)corners[c] + (size_t)k] - eye[k];
      size = larger(size, fabs(v[k]));
    }
    if (!isfinite(v[0] + v[1] + v[2])) return everywhere;
    polygon[c][0] = v[(axis + 1) % 3];
    polygon[c][1] = v[(axis + 2) % 3];
    polygon[c][2] = side % 2 == 0 ? v[axis] : -v[axis];
  }
  sort_box box = nowhere;
  for (int c = 0; c < 3; c++) {
    box.nearest = smaller(box.nearest, polygon[c][2]);
    box.farthest = larger(box.farthest, polygon[c][2]);
  }
  everywhere.nearest = box.nearest;
  everywhere.farthest = box.farthest;
  int count = 3;
  for (int plane = 0; plane < 4 && count > 0; plane++) count = clip(polygon, count, plane / 2, plane % 2 == 0 ? 1 : -1);
  if (count == 0) return nowhere;
  for (int i = 0; i < count; i++) {
    if (!(polygon[i][2] > CUBE_NEAREST * size)) return everywhere;
    for (int k = 0; k < 2; k++) {
      const double x = polygon[i][k] / polygon[i][2];
      box.low[k] = smaller(box.low[k], x - CUBE_MARGIN);
      box.high[k] = larger(box.high[k], x + CUBE_MARGIN);
    }
  }
  return box;
}
