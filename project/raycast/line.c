/* SPDX-License-Identifier: BSD-3-Clause
 * Line: side tests by a projection along the line.
 *
 * Shearing space so that the ray runs along its largest axis (Woop, Benthin, Wald, "Watertight Ray/Triangle
 * Intersection", 2013) makes a side test a cross product of two points in the plane, with each point's two coordinates
 * computed once. Where that product is smaller than its proved rounding error, the exact sign of
 * det[a - o, b - o, d] on the doubles as given decides instead, and where this is 0 the sign of its first derivative
 * that is not: simulation of simplicity (Edelsbrunner, Muecke 1990) with one displaced object, the ray. Needs
 * -ffp-contract=off. */
#include "line.h"

#include <cellist/predicates.h>
#include <math.h>

/* u = 2^-53 times the operations behind a coordinate. With all scaled distances from the origin below M: the difference
 * from the origin, the quotient, their product and the last difference leave 6 u M in a coordinate of at most 2 M, two
 * products and their difference some 2 u M more per coordinate. 16 doubles that; below 8 signs may be wrong. */
static const double SIDE_ERROR = 16 * 0x1p-53;

void line_begin(ray_line *line, const double *positions, const double bounds[6], const double origin[3],
                const double direction[3]) {
  line->positions = positions;
  line->retry_count = 0;
  double largest = 0;
  for (int k = 0; k < 3; k++) {
    line->origin[k] = origin[k];
    line->direction[k] = direction[k];
    largest = fmax(largest, fmax(fabs(origin[k]), fmax(fabs(bounds[k]), fabs(bounds[3 + k]))));
  }
  int exponent = 0;
  frexp(largest, &exponent);
  /* Within the range of normal numbers: scaling stays exact but for what is 2^-1000 of the largest anyway. */
  line->scale = ldexp(1, -(exponent < -1000 ? -1000 : exponent > 1000 ? 1000 : exponent));

  line->z = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(direction[k]) > fabs(direction[line->z])) line->z = k;
  line->x = (line->z + 1) % 3;
  line->y = (line->z + 2) % 3;
  if (direction[line->z] < 0) { /* keeps the projection's sense of rotation that of the determinant */
    const int swap = line->x;
    line->x = line->y;
    line->y = swap;
  }
  line->shear_x = direction[line->x] / direction[line->z];
  line->shear_y = direction[line->y] / direction[line->z];
  line->unit = 1 / line->scale;
  line->depth_per_z = 1 / (line->scale * direction[line->z]);

  double reach = 0;
  for (int k = 0; k < 3; k++)
    for (int side = 0; side < 6; side += 3)
      reach = fmax(reach, fabs(bounds[k + side] * line->scale - origin[k] * line->scale));
  line->error = SIDE_ERROR * reach;
  line->depth_error = SIDE_ERROR * reach * fabs(line->depth_per_z);
}

line_point line_project(const ray_line *line, uint32_t point) {
  const double *p = &line->positions[3 * (size_t)point], *o = line->origin;
  const double z = p[line->z] * line->scale - o[line->z] * line->scale;
  return (line_point){point, (p[line->x] * line->scale - o[line->x] * line->scale) - line->shear_x * z,
                      (p[line->y] * line->scale - o[line->y] * line->scale) - line->shear_y * z, z * line->depth_per_z};
}

/* The exact sign of the edge's extent from a to b along one axis of the projection. */
static int extent_sign(const ray_line *line, uint32_t a, uint32_t b, int axis) {
  /* det[(e, 0), (0, 0, 1), (d, 0)] = -(e x d) in the plane of that axis and z, with e = b - a. */
  const double *p = &line->positions[3 * (size_t)a], *q = &line->positions[3 * (size_t)b];
  const double from[3] = {p[axis], p[line->z], 0}, to[3] = {q[axis], q[line->z], 0}, up[3] = {p[axis], p[line->z], 1};
  const double direction[3] = {line->direction[axis], line->direction[line->z], 0};
  const int sign = -cellist_orient3d_direction(from, to, up, direction);
  return line->direction[line->z] > 0 ? sign : -sign;
}

int line_side(ray_line *line, const line_point *a, const line_point *b, bool *is_tie) {
  *is_tie = false;
  const double side = a->x * b->y - a->y * b->x;
  const double error =
      line->error * (fabs(a->x) + fabs(a->y) + fabs(b->x) + fabs(b->y)) + line->error * line->error + 1e-290;
  if (side > error) return 1;
  if (-side > error) return -1;
  line->retry_count++;
  const double *p = &line->positions[3 * (size_t)a->id], *q = &line->positions[3 * (size_t)b->id];
  int sign = cellist_orient3d_direction(line->origin, p, q, line->direction);
  if (sign != 0) return sign;
  *is_tie = true;
  sign = -extent_sign(line, a->id, b->id, line->y);
  return sign != 0 ? sign : extent_sign(line, a->id, b->id, line->x);
}

line_crossing line_cross_face(const ray_line *line, const line_point corner[3], const bool is_tie[3]) {
  line_crossing crossing = {.depth_error = line->depth_error};
  const line_point *a = &corner[0], *b = &corner[1], *c = &corner[2];
  double *weight = crossing.weight, doubt[3], sum = 0;
  for (int k = 0; k < 3; k++) {
    const line_point *from = &corner[(k + 1) % 3], *to = &corner[(k + 2) % 3];
    weight[k] = is_tie[(k + 1) % 3] ? 0 : fabs(from->x * to->y - from->y * to->x);
    doubt[k] = line->error * (fabs(from->x) + fabs(from->y) + fabs(to->x) + fabs(to->y) + line->error);
    sum += weight[k];
  }
  if (!(sum > 0)) { /* the line lies in the face's plane: where the displaced line passes as the shift vanishes */
    weight[0] = fabs(c->y - b->y);
    weight[1] = fabs(a->y - c->y);
    weight[2] = fabs(b->y - a->y);
    sum = weight[0] + weight[1] + weight[2];
  }
  if (!(sum > 0)) {
    weight[0] = fabs(c->x - b->x);
    weight[1] = fabs(a->x - c->x);
    weight[2] = fabs(b->x - a->x);
    sum = weight[0] + weight[1] + weight[2];
  }
  const double scale_down = 1 / sum;
  double beside_x = 0, beside_y = 0, depth_doubt = 0;
  for (int k = 0; k < 3; k++) {
    weight[k] = sum > 0 ? weight[k] / sum : 1.0 / 3;
    crossing.depth += weight[k] * corner[k].z;
    beside_x += weight[k] * corner[k].x;
    beside_y += weight[k] * corner[k].y;
  }
  double spread = 0;
  for (int k = 0; k < 3; k++) {
    const double distance = fabs(corner[k].z - crossing.depth);
    spread = distance > spread ? distance : spread;
    depth_doubt += doubt[k] * distance;
  }
  crossing.depth_error += depth_doubt * scale_down;
  /* The true point lies in the face as well. */
  if (!(crossing.depth_error < spread + line->depth_error)) crossing.depth_error = spread + line->depth_error;
  crossing.offset = (fabs(beside_x) + fabs(beside_y) + line->error) * line->unit;
  return crossing;
}
