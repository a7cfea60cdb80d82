/* SPDX-License-Identifier: BSD-3-Clause
 * The kernel of plain cells, included by each file that compiles it. The same quantities as in records.c and
 * footprint.c, lane by lane; names as there.
 *
 * Signs: a corner relative to the eye, along the view's axes, is off by less than 8 u times the distance V of the
 * farthest corner, u = 2^-53, in each component measured in units. A face's sign is that of det(e, f, a) of two edges
 * and a corner, so with M for the longest component of an edge it is off by less than 2^-43 V V M, and the volume by
 * less than 2^-43 V M M: where it is larger than that (four times, for the shear), the sign is the exact one. */
#ifndef CELLIST_GL_PLAIN_KERNEL_H
#define CELLIST_GL_PLAIN_KERNEL_H

#include <math.h>
#include <optics/lanes.h>
#include <string.h>

#include "plain.h"
#include "records.h"

static const double PLAIN_SIGN_ERROR = 0x1p-41;

typedef struct plain_vector {
  d4 x, y, z;
} plain_vector;

static inline plain_vector plain_difference(plain_vector a, plain_vector b) {
  return (plain_vector){d4_sub(a.x, b.x), d4_sub(a.y, b.y), d4_sub(a.z, b.z)};
}
/* a b - c d */
static inline d4 plain_minor(d4 a, d4 b, d4 c, d4 d) { return d4_sub(d4_mul(a, b), d4_mul(c, d)); }
static inline plain_vector plain_cross(plain_vector a, plain_vector b) {
  return (plain_vector){plain_minor(a.y, b.z, a.z, b.y), plain_minor(a.z, b.x, a.x, b.z),
                        plain_minor(a.x, b.y, a.y, b.x)};
}
static inline d4 plain_dot(plain_vector a, plain_vector b) {
  return d4_add(d4_add(d4_mul(a.x, b.x), d4_mul(a.y, b.y)), d4_mul(a.z, b.z));
}
static inline d4 plain_largest(d4 a, d4 b, d4 c) { return d4_max(d4_max(d4_abs(a), d4_abs(b)), d4_abs(c)); }
static inline d4 plain_negative(d4 a) { return d4_sub(d4_all(0), a); }

/* Corners as they are or, measured from the reference pixel, sheared. */
static inline plain_vector plain_corner(const gl_point *const points[GL_PLAIN_LANES]) {
  const double *row[GL_PLAIN_LANES];
  for (int lane = 0; lane < GL_PLAIN_LANES; lane++) row[lane] = points[lane]->at;
  d4 column[4]; /* the fourth: what stands behind a point's place */
  d4_transpose(row, column);
  return (plain_vector){column[0], column[1], column[2]};
}
static inline plain_vector plain_shear(plain_vector p, const d4 reference[2], bool parallel) {
  if (parallel) return (plain_vector){d4_sub(p.x, reference[0]), d4_sub(p.y, reference[1]), p.z};
  return (plain_vector){d4_sub(p.x, d4_mul(reference[0], p.z)), d4_sub(p.y, d4_mul(reference[1], p.z)), p.z};
}

/* What a lane holds, and what is known of it without arithmetic. */
struct plain_lanes {
  const gl_point *point[4][GL_PLAIN_LANES]; /* [corner] */
  float scalar[4][GL_PLAIN_LANES];
};

static inline void plain_load(const gl_cells *cells, const uint32_t *tets, struct plain_lanes *lanes, gl_plain *out) {
  const cellist_mesh_arrays *arrays = cells->mesh->arrays;
  out->left = out->nothing = 0;
  for (unsigned lane = 0; lane < GL_PLAIN_LANES; lane++) {
    const uint32_t tet = tets[lane], *v = &arrays->tets[4 * (size_t)tet];
    const gl_point *points[4];
    gl_shown *shown = &out->shown[lane];
    for (int k = 0; k < 4; k++) lanes->point[k][lane] = points[k] = &cells->points[v[k]];
    const uint32_t all = points[0]->outside & points[1]->outside & points[2]->outside & points[3]->outside;
    const uint32_t any = points[0]->outside | points[1]->outside | points[2]->outside | points[3]->outside;
    if (all & GL_OUTSIDE_VIEW || arrays->tet_flags[tet] & CELLIST_TET_FLAT ||
        !gl_cells_find_shown(cells, tet, points, shown)) {
      out->nothing |= 1u << lane;
      continue;
    }
    for (int k = 0; k < 4; k++) lanes->scalar[k][lane] = shown->scalars[k];
    if (any & (GL_OUTSIDE_NEAR | GL_OUTSIDE_WILD)) out->left |= 1u << lane;
  }
}

/* The reference pixel of each lane: see records.c. at: places in the picture. */
static inline void plain_choose_reference(const gl_cells *cells, d4 at[4][2], d4 reference[2]) {
  const double limit[2] = {cells->picture.half_width, cells->picture.half_height};
  for (int axis = 0; axis < 2; axis++) {
    const d4 sum = d4_add(d4_add(at[0][axis], at[1][axis]), d4_add(at[2][axis], at[3][axis]));
    const d4 cut = d4_max(d4_all(-limit[axis]), d4_min(d4_all(limit[axis]), d4_mul(d4_all(0.25), sum)));
    double pixel[GL_PLAIN_LANES];
    d4_store(pixel, d4_add(cut, d4_all(limit[axis])));
    for (int lane = 0; lane < GL_PLAIN_LANES; lane++) pixel[lane] = floor(pixel[lane]) + 0.5 - limit[axis];
    reference[axis] = d4_load(pixel);
  }
}

/* Distances within the four faces' pictures, across which they are lines; see distance_from_line in records.c. A bit
 * for each lane where one may be. normal: of the faces; place: what records.c calls a face's dot. */
static inline unsigned plain_find_lines(const gl_cells *cells, const plain_vector corner[4],
                                        const plain_vector normal[4], const d4 place[4]) {
  unsigned lines = 0;
  const d4 least = d4_all(1.05 * 1.05 * GL_THIN_FACE * GL_THIN_FACE);
  const d4 farthest = d4_max(d4_max(corner[0].z, corner[1].z), d4_max(corner[2].z, corner[3].z));
  for (int k = 0; k < 4; k++) {
    const d4 slope = d4_add(d4_mul(normal[k].x, normal[k].x), d4_mul(normal[k].y, normal[k].y));
    d4 across = place[k], depth = farthest;
    if (cells->frame.parallel) {
      const uint8_t *face = CELLIST_TET_FACE[k];
      const d4 a = corner[face[0]].z, b = corner[face[1]].z, c = corner[face[2]].z;
      const d4 range = d4_sub(d4_max(d4_max(a, b), c), d4_min(d4_min(a, b), c));
      across = d4_mul(d4_mul(normal[k].z, range), d4_all(0.5)); /* from one of them, at least half the range */
      depth = d4_all(1);
      /* No slope: parallel to the picture, no line. */
      const d4 none = d4_less(d4_all(0), slope);
      across = d4_select(none, across, d4_all(1));
    }
    lines |= d4_at_most(d4_mul(across, across), d4_mul(d4_mul(least, slope), d4_mul(depth, depth)));
  }
  return lines;
}

/* Moves the ring's edges outwards by the margin, as footprint.c; of a triangle the fourth corner lies on an edge.
 * Returns the lanes that have corners too sharp for that. */
static inline unsigned plain_grow(const gl_cells *cells, d4 ring[4][2], const d4 reference[2], gl_plain *out) {
  const d4 area = plain_minor(d4_sub(ring[2][0], ring[0][0]), d4_sub(ring[3][1], ring[1][1]),
                              d4_sub(ring[2][1], ring[0][1]), d4_sub(ring[3][0], ring[1][0]));
  const d4 sign = d4_select(d4_less(area, d4_all(0)), d4_all(-1), d4_all(1));
  d4 normal[4][2];
  for (int i = 0; i < 4; i++) {
    const d4 x = d4_sub(ring[(i + 1) % 4][0], ring[i][0]), y = d4_sub(ring[(i + 1) % 4][1], ring[i][1]);
    const d4 scale = d4_div(sign, d4_sqrt(d4_add(d4_mul(x, x), d4_mul(y, y))));
    normal[i][0] = d4_mul(y, scale);
    normal[i][1] = plain_negative(d4_mul(x, scale));
  }
  unsigned blunt = 15;
  d4 grown[4][2];
  for (int i = 0; i < 4; i++) {
    const d4 *m = normal[(i + 3) % 4], *n = normal[i];
    const d4 turn = d4_add(d4_all(1), d4_add(d4_mul(m[0], n[0]), d4_mul(m[1], n[1])));
    blunt &= d4_at_most(d4_all(1.01 * GL_SHARPEST_TURN), turn); /* not where NaN */
    const d4 scale = d4_div(d4_all(cells->picture.margin), turn);
    for (int k = 0; k < 2; k++)
      grown[i][k] = d4_add(d4_add(ring[i][k], reference[k]), d4_mul(scale, d4_add(m[k], n[k])));
  }
  const d4 per_half[2] = {d4_all(1 / cells->picture.half_width), d4_all(1 / cells->picture.half_height)};
  for (int i = 0; i < 4; i += 2) {
    const d4 column[4] = {d4_mul(grown[i][0], per_half[0]), d4_mul(grown[i][1], per_half[1]),
                          d4_mul(grown[i + 1][0], per_half[0]), d4_mul(grown[i + 1][1], per_half[1])};
    d4_store_rows(out->footprints[0][i], 2 * GL_FOOTPRINT_CORNERS, column);
  }
  return ~blunt & 15;
}

/* Records of lanes whose corners stand in the order: three of the back face, the first of them opposite to a front
 * face; the one opposite. eye: the corners'; is_back: of the faces opposite to corners 1 and 2, -1 or 1. */
static inline void plain_write_records(const gl_cells *cells, const plain_vector p[4], const d4 eye[4],
                                       const d4 scalar[4], const d4 reference[2], const d4 is_back[2], gl_plain *out) {
  const bool parallel = cells->frame.parallel;
  const d4 one = d4_all(1);
  d4 w[3], edge[3][3], plane[3][3];
  for (int i = 0; i < 3; i++) w[i] = parallel ? one : p[i].z;
  for (int i = 0; i < 3; i++) {
    const int m = (i + 1) % 3, n = (i + 2) % 3;
    edge[i][0] = plain_minor(p[m].x, p[n].y, p[m].y, p[n].x);
    edge[i][1] = plain_minor(p[m].y, w[n], w[m], p[n].y);
    edge[i][2] = plain_minor(w[m], p[n].x, p[m].x, w[n]);
  }
  const d4 determinant =
      d4_add(d4_add(d4_mul(w[0], edge[0][0]), d4_mul(p[0].x, edge[0][1])), d4_mul(p[0].y, edge[0][2]));
  const d4 inverse = d4_div(one, determinant);
  d4 depth[3], field[3];
  for (int i = 0; i < 3; i++) {
    const d4 per_eye = d4_div(d4_all(-1), eye[i]);
    for (int j = 0; j < 3; j++) {
      edge[i][j] = d4_mul(edge[i][j], inverse);
      plane[i][j] = d4_mul(edge[i][j], per_eye);
    }
  }
  for (int j = 0; j < 3; j++) {
    depth[j] = parallel
                   ? d4_add(d4_add(d4_mul(edge[0][j], p[0].z), d4_mul(edge[1][j], p[1].z)), d4_mul(edge[2][j], p[2].z))
                   : d4_add(d4_add(edge[0][j], edge[1][j]), edge[2][j]);
    field[j] =
        d4_add(d4_add(d4_mul(edge[0][j], scalar[0]), d4_mul(edge[1][j], scalar[1])), d4_mul(edge[2][j], scalar[2]));
  }
  d4 growth = parallel ? d4_all(0) : scalar[0];
  for (int i = 1; i < 4; i++) growth = d4_add(growth, d4_mul(eye[i], d4_sub(scalar[i], scalar[0])));
  const d4 x = d4_add(reference[0], d4_all(cells->picture.half_width));
  const d4 y = d4_add(reference[1], d4_all(cells->picture.half_height));
  double ends[2][GL_PLAIN_LANES];
  for (int lane = 0; lane < GL_PLAIN_LANES; lane++) {
    ends[0][lane] = out->shown[lane].first;
    ends[1][lane] = out->shown[lane].last;
  }
  const d4 texels[5][4] = {{d4_mul(x, is_back[0]), d4_mul(y, is_back[1]), d4_load(ends[0]), d4_load(ends[1])},
                           {depth[0], depth[1], depth[2], growth},
                           {field[0], field[1], field[2], plane[2][0]},
                           {plane[0][0], plane[0][1], plane[0][2], plane[2][1]},
                           {plane[1][0], plane[1][1], plane[1][2], plane[2][2]}};
  for (int i = 0; i < 5; i++) d4_store_rows(&out->records[0][4 * i], GL_RECORD_FLOATS, texels[i]);
}

static inline void plain_prepare(const gl_cells *cells, const uint32_t tets[GL_PLAIN_LANES], gl_plain *out) {
  const bool parallel = cells->frame.parallel;
  const double across[2] = {cells->frame.half_width / cells->picture.half_width,
                            cells->frame.half_height / cells->picture.half_height}; /* units a pixel (at depth 1) */
  struct plain_lanes lanes;
  plain_load(cells, tets, &lanes, out);
  if ((out->left | out->nothing) == 15) return;

  /* Places in the picture, and edges. */
  plain_vector corner[4];
  d4 at[4][2], reference[2];
  for (int k = 0; k < 4; k++) {
    corner[k] = plain_corner(lanes.point[k]);
    const d4 inverse = parallel ? d4_all(1) : d4_div(d4_all(1), corner[k].z);
    at[k][0] = d4_mul(corner[k].x, inverse);
    at[k][1] = d4_mul(corner[k].y, inverse);
  }
  plain_choose_reference(cells, at, reference);
  d4 longest = d4_all(0), component = d4_all(0), farthest = d4_all(0);
  for (int k = 0; k < 4; k++) {
    farthest = d4_max(farthest, d4_abs(corner[k].z));
    for (int other = 0; other < k; other++) {
      const plain_vector edge = plain_difference(corner[k], corner[other]);
      const plain_vector e = {d4_mul(edge.x, d4_all(across[0])), d4_mul(edge.y, d4_all(across[1])), edge.z};
      longest = d4_max(longest, plain_dot(e, e));
    }
  }
  component = d4_sqrt(longest);
  d4_store_float(out->longest, component);

  /* Signs of the faces. */
  plain_vector p[4], normal[4];
  for (int k = 0; k < 4; k++) p[k] = plain_shear(corner[k], reference, parallel);
  const plain_vector e1 = plain_difference(p[1], p[0]), e2 = plain_difference(p[2], p[0]);
  const plain_vector e3 = plain_difference(p[3], p[0]);
  normal[0] = plain_cross(plain_difference(p[3], p[1]), plain_difference(p[2], p[1]));
  normal[1] = plain_cross(e2, e3);
  normal[2] = plain_cross(e3, e1);
  normal[3] = plain_cross(e1, e2);
  const d4 volume = plain_dot(e1, normal[1]);
  const double half_view = hypot(cells->frame.half_width, cells->frame.half_height);
  const d4 distance = parallel ? d4_add(farthest, d4_all(GL_FAR_OUT * half_view))
                               : d4_mul(farthest, d4_all(1 + GL_FAR_OUT * half_view));
  const d4 error = d4_mul(d4_mul(d4_all(PLAIN_SIGN_ERROR / across[0] / across[1]), distance), component);
  const d4 least_place = parallel ? error : d4_mul(error, distance), least_volume = d4_mul(error, component);
  d4 place[4];
  unsigned uncertain = d4_at_most(d4_abs(volume), least_volume);
  for (int k = 0; k < 4; k++) {
    place[k] = plain_negative(parallel ? normal[k].z : plain_dot(normal[k], p[k == 0 ? 1 : 0]));
    uncertain |= d4_at_most(d4_abs(place[k]), least_place);
  }
  out->left |= (uncertain | plain_find_lines(cells, corner, normal, place)) & ~out->nothing;
  if ((out->left | out->nothing) == 15) return;

  /* By the signs: the back face with the largest picture, and the order of the corners that belongs to it. */
  const d4 per_volume = d4_div(d4_all(1), volume);
  double eyes[4][GL_PLAIN_LANES], merits[4][GL_PLAIN_LANES], places[4][2][GL_PLAIN_LANES];
  for (int k = 0; k < 4; k++) {
    d4_store(eyes[k], d4_mul(place[k], per_volume));
    d4_store(merits[k], d4_abs(parallel ? place[k] : d4_mul(place[k], corner[k].z)));
    for (int axis = 0; axis < 2; axis++) d4_store(places[k][axis], d4_sub(at[k][axis], reference[axis]));
  }
  const gl_point *ordered[4][GL_PLAIN_LANES];
  double eye[4][GL_PLAIN_LANES], scalar[4][GL_PLAIN_LANES], is_back[2][GL_PLAIN_LANES], ring[4][2][GL_PLAIN_LANES];
  memset(eye, 0, sizeof eye);
  memset(scalar, 0, sizeof scalar);
  memset(is_back, 0, sizeof is_back);
  memset(ring, 0, sizeof ring);
  for (unsigned lane = 0; lane < GL_PLAIN_LANES; lane++) {
    unsigned back = 0, best = 0;
    double most = -1;
    for (unsigned k = 0; k < 4; k++) {
      if (!(eyes[k][lane] > 0)) continue;
      back |= 1u << k;
      if (merits[k][lane] > most) {
        most = merits[k][lane];
        best = k;
      }
    }
    if (back == 15) out->left |= 1u << lane & ~out->nothing;
    if (back == 0) out->nothing |= 1u << lane & ~out->left;
    const uint8_t *face = CELLIST_TET_FACE[best];
    unsigned first = 0;
    while (first < 2 && back & 1u << face[first]) first++;
    const unsigned corners[4] = {face[first], face[(first + 1) % 3], face[(first + 2) % 3], best};
    const bool hidden = (out->left | out->nothing) & 1u << lane;
    for (int i = 0; i < 4; i++) {
      ordered[i][lane] = lanes.point[corners[i]][lane];
      eye[i][lane] = eyes[corners[i]][lane];
      scalar[i][lane] = hidden ? 0 : (double)lanes.scalar[corners[i]][lane];
    }
    for (int i = 0; i < 2; i++) is_back[i][lane] = back & 1u << corners[1 + i] ? -1 : 1;
    const uint8_t *around = GL_FOOTPRINT_RINGS[back];
    out->corner_count[lane] = around[0];
    for (int axis = 0; axis < 2 && around[0] > 0; axis++) {
      for (int i = 0; i < around[0]; i++) ring[i][axis][lane] = places[around[1 + i]][axis][lane];
      if (around[0] == 3) ring[3][axis][lane] = 0.5 * (ring[2][axis][lane] + ring[0][axis][lane]);
    }
  }
  d4 eye4[4], scalar4[4], ring4[4][2];
  for (int k = 0; k < 4; k++) {
    p[k] = plain_shear(plain_corner(ordered[k]), reference, parallel);
    eye4[k] = d4_load(eye[k]);
    scalar4[k] = d4_load(scalar[k]);
    for (int axis = 0; axis < 2; axis++) ring4[k][axis] = d4_load(ring[k][axis]);
  }
  out->left |= plain_grow(cells, ring4, reference, out) & ~out->nothing;
  if ((out->left | out->nothing) == 15) return;
  const d4 back4[2] = {d4_load(is_back[0]), d4_load(is_back[1])};
  plain_write_records(cells, p, eye4, scalar4, reference, back4, out);
}

#endif
