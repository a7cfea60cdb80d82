/* SPDX-License-Identifier: BSD-3-Clause
 * Fans: the projected tetrahedra of Shirley and Tuchman [C 2], correct in perspective.
 *
 * The class follows from exact signs alone. One back face and up to three front faces, or the other way round: the
 * corner opposite to the lone face is the thick vertex, and each of the other faces that is not seen edge-on is a
 * triangle at it. So a corner on an edge (one face edge-on) gives two triangles and two corners on one point (two faces
 * edge-on) one, without a class of their own. Two and two: the thick vertex is where the edge between the front faces
 * crosses the edge between the back faces.
 *
 * Differs from the paper: front and back have a depth each, and scalars are divided by their own; what vanishes at the
 * silhouette is an attribute of its own instead of a difference of two. Rounding may put a thick vertex past an edge by
 * an ulp; it is clamped to it. */
#include "fan.h"

#include <math.h>

#include <cellist/mesh.h>

/* A point of the picture and what is linear there. */
struct point {
  double x, y;          /* in pixels from the centre */
  double scalar, depth; /* divided by depth, and 1 / depth; parallel: as they are */
};

static struct point between(const struct point *a, const struct point *b, double t) {
  return (struct point){a->x + t * (b->x - a->x), a->y + t * (b->y - a->y), a->scalar + t * (b->scalar - a->scalar),
                        a->depth + t * (b->depth - a->depth)};
}

static double twice_area(const struct point *a, const struct point *b, const struct point *c) {
  return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static gl_fan_corner corner_of(const gl_picture *picture, const struct point *front, const struct point *back,
                               double thickness, float record) {
  return (gl_fan_corner){.x = (float)(front->x / picture->half_width),
                         .y = (float)(front->y / picture->half_height),
                         .record = record,
                         .front = {(float)front->scalar, (float)front->depth},
                         .back = {(float)back->scalar, (float)back->depth},
                         .thickness = (float)fmax(thickness, 0)};
}

static gl_fan_corner thin_corner(const gl_picture *picture, const struct point *point, float record) {
  return corner_of(picture, point, point, 0, record);
}

static gl_fan_corner thick_corner(const gl_picture *picture, const struct point *front, const struct point *back,
                                  float record) {
  const double thickness = picture->parallel ? back->depth - front->depth : front->depth - back->depth;
  return corner_of(picture, front, back, thickness, record);
}

/* The point of face lone at the picture of the corner opposite to it. */
static struct point on_face(const struct point p[4], unsigned lone) {
  const uint8_t *face = CELLIST_TET_FACE[lone];
  double weight[3], sum = 0;
  const double whole = twice_area(&p[face[0]], &p[face[1]], &p[face[2]]);
  for (int i = 0; i < 3; i++) {
    weight[i] = twice_area(&p[lone], &p[face[(i + 1) % 3]], &p[face[(i + 2) % 3]]) / whole;
    weight[i] = weight[i] > 0 ? weight[i] : 0; /* NaN too: the face is thinner than the coordinates tell */
    sum += weight[i];
  }
  struct point made = {p[lone].x, p[lone].y, 0, 0};
  for (int i = 0; i < 3; i++) {
    const double share = sum > 0 ? weight[i] / sum : 1.0 / 3;
    made.scalar += share * p[face[i]].scalar;
    made.depth += share * p[face[i]].depth;
  }
  return made;
}

static int fan_of_lone_face(const gl_picture *picture, const struct point p[4], unsigned sides, unsigned lone,
                            float record, gl_fan_corner *out) {
  const struct point opposite = on_face(p, lone);
  const bool is_back = sides & 1u << lone;
  const gl_fan_corner thick =
      is_back ? thick_corner(picture, &p[lone], &opposite, record) : thick_corner(picture, &opposite, &p[lone], record);
  int count = 0;
  for (unsigned k = 0; k < 4; k++) {
    if (k == lone || !(sides & 17u << k)) continue;
    out[count++] = thick;
    for (int i = 0; i < 3; i++)
      if (CELLIST_TET_FACE[k][i] != lone) out[count++] = thin_corner(picture, &p[CELLIST_TET_FACE[k][i]], record);
  }
  return count;
}

/* Where edges ab and cd cross, as a share of each, 0..1. */
static void cross_edges(const struct point *a, const struct point *b, const struct point *c, const struct point *d,
                        double shares[2]) {
  const double ab_c = twice_area(a, b, c), ab_d = twice_area(a, b, d);
  const double cd_a = twice_area(c, d, a), cd_b = twice_area(c, d, b);
  const double along[2] = {cd_a / (cd_a - cd_b), ab_c / (ab_c - ab_d)};
  for (int i = 0; i < 2; i++) shares[i] = along[i] >= 0 ? fmin(along[i], 1) : isnan(along[i]) ? 0.5 : 0;
}

static int fan_of_two_and_two(const gl_picture *picture, const struct point p[4], unsigned sides, float record,
                              gl_fan_corner *out) {
  unsigned front_edge[2], back_edge[2], fronts = 0, backs = 0; /* corners */
  for (unsigned k = 0; k < 4; k++) /* an edge lies in the faces that are not opposite to its ends */
    if (sides & 1u << k)
      front_edge[fronts++] = k;
    else
      back_edge[backs++] = k;
  const struct point *ring[4] = {&p[front_edge[0]], &p[back_edge[0]], &p[front_edge[1]], &p[back_edge[1]]};
  double shares[2];
  cross_edges(ring[0], ring[2], ring[1], ring[3], shares);
  const struct point front = between(ring[0], ring[2], shares[0]), back = between(ring[1], ring[3], shares[1]);
  const gl_fan_corner thick = thick_corner(picture, &front, &back, record);
  int count = 0;
  for (int i = 0; i < 4; i++) {
    out[count++] = thick;
    out[count++] = thin_corner(picture, ring[i], record);
    out[count++] = thin_corner(picture, ring[(i + 1) % 4], record);
  }
  return count;
}

int gl_fan_of_tet(const gl_picture *picture, const double *const corners[4], const float scalars[4], unsigned sides,
                  float record, gl_fan_corner out[3 * GL_FAN_TRIANGLES]) {
  struct point p[4];
  unsigned backs = 0, fronts = 0, last_back = 0, last_front = 0;
  for (unsigned k = 0; k < 4; k++) {
    const double z = corners[k][2], w = picture->parallel ? 1 : z;
    p[k] = (struct point){corners[k][0] / w, corners[k][1] / w, scalars[k] / w, picture->parallel ? z : 1 / z};
    if (sides & 1u << k) {
      backs++;
      last_back = k;
    } else if (sides & 16u << k) {
      fronts++;
      last_front = k;
    }
  }
  if (backs == 1) return fan_of_lone_face(picture, p, sides, last_back, record, out);
  if (fronts == 1) return fan_of_lone_face(picture, p, sides, last_front, record, out);
  return fan_of_two_and_two(picture, p, sides, record, out);
}
