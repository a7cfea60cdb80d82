/* SPDX-License-Identifier: BSD-3-Clause
 * Line: the whole line of a ray, and on which side of it an edge passes. Private to the reference caster.
 *
 * The ray is the pair of doubles (origin, direction) as given. Where it meets an edge or a vertex exactly, an
 * infinitesimal shift of the origin (first along x, then, infinitely smaller, along y of the projection below) decides:
 * every answer is that of one and the same displaced line, so that this line passes the inside of faces only, and
 * enters and leaves each tet at most once. */
#ifndef CELLIST_RAYCAST_LINE_H
#define CELLIST_RAYCAST_LINE_H

#include <cellist/mesh.h>

typedef struct ray_line {
  const double *positions;
  double origin[3], direction[3];
  int x, y, z;             /* axes of the projection along the line; z: where the direction is largest */
  double shear_x, shear_y; /* direction[x] / direction[z], direction[y] / direction[z] */
  double scale;            /* a power of two; scaled coordinates are below 1 */
  double unit;             /* 1 / scale */
  double depth_per_z;      /* ray parameter per scaled z */
  double error;            /* of a side test, per sum of its scaled coordinates; more than that of a coordinate */
  double depth_error;      /* of line_point.z */
  uint64_t retry_count;    /* side tests that took exact arithmetic */
} ray_line;

/* A point seen along the line: x and y across it, z along it as the ray's parameter. */
typedef struct line_point {
  uint32_t id;
  double x, y, z;
} line_point;

/* bounds: of all points that will be asked about. */
void line_begin(ray_line *line, const double *positions, const double bounds[6], const double origin[3],
                const double direction[3]);

line_point line_project(const ray_line *line, uint32_t point);

/* On which side of the displaced line the edge from a to b passes: the sign of det[a - origin, b - origin, direction].
 * 0 if the edge is parallel to the line (or a point): no face with this edge is ever passed. *is_tie: the edge meets
 * the line itself, and the shift decided. */
int line_side(ray_line *line, const line_point *a, const line_point *b, bool *is_tie);

/* Where the line passes through a face: weights of its corners, of sum 1, and what rounding may have done to them. The
 * point that they mean lies in the face; on a face seen edge-on it may lie some way along it. */
typedef struct line_crossing {
  double weight[3];
  double depth;       /* the ray's parameter there */
  double depth_error; /* how far the ray's true parameter may be from that */
  double offset;      /* how far the point may lie beside the ray, in the mesh's units */
} line_crossing;

/* corner: of a face all of whose edges pass on the same side; is_tie[c]: of the edge from corner c to the next. */
line_crossing line_cross_face(const ray_line *line, const line_point corner[3], const bool is_tie[3]);

#endif
