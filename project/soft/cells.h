/* SPDX-License-Identifier: BSD-3-Clause
 * Cells: from four tets to what covers their pixels: planes and scalars relative to one of the cell's faces.
 * Included by each kernel.
 *
 * In a perspective view let w = 1/t along the ray r = (u, v, 1) from the eye. With the barycentric function
 * L(p) = a . p - h of a corner (0 on the opposite face, positive inside), L(t r) >= 0 becomes, for every t > 0,
 *   w <= (a . r) / h  where h > 0 (the eye is outside: an entry),  w >= (a . r) / h  where h < 0 (an exit):
 * both sides are linear in the pixel, whatever lies behind the eye; nothing is clipped. Parallel views get the same
 * with w = -t, a . r - h above and a_z below the line. A pixel is covered where the smallest entry and the near plane
 * exceed the largest exit: no edge is tested, no thick vertex made (algorithms as in [W] section 4, by pixel).
 *
 * Planes and scalars are measured from the plane of the face that changes least over the cell's rectangle (it need not
 * be evaluated, then): in thin cells, seen however obliquely, differences stay small. With the scalar's gradient g and
 * a corner p, (s(t r) - s(p)) w = g . r - (g . p) w, again linear in the pixel and in w.
 *
 * Setting up takes double precision, pixels take single precision. Where that does not do (a face or gradient so steep
 * over the rectangle that rounding shows, the eye's plane through the cell) the cell is `careful`: its pixels are
 * worked out in double precision. */
#ifndef CELLIST_SOFT_CELLS_H
#define CELLIST_SOFT_CELLS_H

#include <optics/lanes.h>

#include "scene.h"

/* A plane or scalar may vary over the cell's rectangle by this many times the cell's own depth or scalar range. Twice
 * that is twice the error (2^-23 times this, of a cell's depth: 1.5e-5 of the optical depth at its longest ray), and
 * half as many careful cells. */
#define CAREFUL_RATIO 128.0

/* Scalars are 0 to 1 over the mesh; a cell's range below this is counted as this. Smaller: more careful cells. */
#define CAREFUL_SCALAR 1e-3

/* A face is seen edge-on, its plane says nothing in single precision, if the eye is this near to it for its distance.
 * Smaller: pixels in its picture may see cells of both sides by turns; larger: more careful cells. */
#define CAREFUL_EDGE_ON 1e-6

/* With the eye in the cell and the near plane at 0 the entry's 1/t is infinite: it is cut to this many times the
 * exit's. Larger: 1/t loses digits of the exit; smaller: this share of the length is missing. */
#define ENTRY_LIMIT 1048576.0

/* Faces are planes relative to the reference face's, 0 for itself; the plane after them is the near plane. */
enum { NEAR_PLANE = 4, CELL_PLANES };

typedef struct cell_batch {
  float plane[CELL_PLANES][3][4]; /* [face][constant, per x, per y][lane] */
  soft_record record[4];
  double gradient[3][4], corner[4][4]; /* of the scalar; x y z s of the first corner */
  double z_low[4], z_high[4], s_low[4], s_high[4];
  double reference[4];                     /* which face it is */
  double turn[3][3][4], corner_turn[3][4]; /* of the gradient at points: derivatives of each part; at the corner */
  soft_gradient_record gradient_record[4];
  unsigned usable, careful, clipped, is_entry[4]; /* bit per lane; clipped: by the near plane; is_entry by face */
} cell_batch;

typedef struct cell_vector {
  d4 x, y, z;
} cell_vector;

static inline cell_vector vector_sub(const d4 a[4], const d4 b[4]) {
  return (cell_vector){d4_sub(a[0], b[0]), d4_sub(a[1], b[1]), d4_sub(a[2], b[2])};
}
static inline cell_vector vector_cross(cell_vector a, cell_vector b) {
  return (cell_vector){d4_sub(d4_mul(a.y, b.z), d4_mul(a.z, b.y)), d4_sub(d4_mul(a.z, b.x), d4_mul(a.x, b.z)),
                       d4_sub(d4_mul(a.x, b.y), d4_mul(a.y, b.x))};
}
static inline d4 vector_dot(cell_vector a, cell_vector b) {
  return d4_add(d4_add(d4_mul(a.x, b.x), d4_mul(a.y, b.y)), d4_mul(a.z, b.z));
}
static inline cell_vector vector_scale(cell_vector a, d4 s) {
  return (cell_vector){d4_mul(a.x, s), d4_mul(a.y, s), d4_mul(a.z, s)};
}

/* Gradients of the four barycentric functions; returns the lanes whose volume has the sign that the mesh promises
 * (rounding of a sliver's points may take it: what is left of its depth is some 1e-15 of the mesh). */
static inline unsigned cell_gradients(const d4 v[4][4], cell_vector a[4]) {
  const cell_vector e1 = vector_sub(v[1], v[0]), e2 = vector_sub(v[2], v[0]), e3 = vector_sub(v[3], v[0]);
  const cell_vector f2 = vector_sub(v[2], v[1]), f3 = vector_sub(v[3], v[1]);
  a[1] = vector_cross(e2, e3);
  a[2] = vector_cross(e3, e1);
  a[3] = vector_cross(e1, e2);
  a[0] = vector_cross(f3, f2);
  const d4 volume = vector_dot(e1, a[1]); /* negative: right, up, forward is left-handed */
  const d4 inverse = d4_div(d4_all(1), volume);
  for (int k = 0; k < 4; k++) a[k] = vector_scale(a[k], inverse);
  return d4_at_most(volume, d4_all(-1e-300));
}

/* A linear function of place along rays, relative to a plane w = place + ..: (f - base) w, or f - base in parallel. */
typedef struct cell_linear {
  d4 at, per_x, per_y, per_end;
} cell_linear;

/* The frame of a batch's four cells: their first rays, steps across pixels, and the reference planes. */
typedef struct cell_rays {
  bool parallel;
  d4 across, upward, step_x, step_y;
  d4 place, place_x, place_y;
} cell_rays;

/* gradient: of the function; corner: where it is its base. */
static inline cell_linear cell_linear_of(const cell_rays *rays, cell_vector gradient, const d4 corner[3]) {
  cell_linear made;
  if (rays->parallel) {
    const d4 x = d4_sub(rays->across, corner[0]), y = d4_sub(rays->upward, corner[1]);
    const d4 z = d4_add(rays->place, corner[2]); /* minus the depth above the corner's */
    made.per_end = gradient.z;
    made.at = d4_sub(d4_add(d4_mul(gradient.x, x), d4_mul(gradient.y, y)), d4_mul(gradient.z, z));
  } else {
    made.per_end = vector_dot(gradient, (cell_vector){corner[0], corner[1], corner[2]});
    const d4 along = d4_add(d4_add(d4_mul(gradient.x, rays->across), d4_mul(gradient.y, rays->upward)), gradient.z);
    made.at = d4_sub(along, d4_mul(made.per_end, rays->place));
  }
  made.per_x = d4_sub(d4_mul(gradient.x, rays->step_x), d4_mul(made.per_end, rays->place_x));
  made.per_y = d4_sub(d4_mul(gradient.y, rays->step_y), d4_mul(made.per_end, rays->place_y));
  return made;
}

static inline d4 cell_size(d4 at, d4 per_x, d4 per_y, d4 columns, d4 rows) {
  return d4_add(d4_abs(at), d4_add(d4_mul(d4_abs(per_x), columns), d4_mul(d4_abs(per_y), rows)));
}

/* The cells' gradients from those at their points, part by part. */
static inline void cells_set_gradients(const soft_scene *scene, const uint32_t cell[4], const cell_rays *rays,
                                       const cell_vector a[4], const d4 corner[3], cell_batch *batch) {
  for (int part = 0; part < 3; part++) {
    double value[4][4];
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 4; k++)
        value[k][i] = scene->model.point_gradients[scene->tets[4 * (size_t)cell[i] + (size_t)k]][part];
    const d4 base = d4_load(value[0]);
    cell_vector turn = vector_scale(a[1], d4_sub(d4_load(value[1]), base));
    for (int k = 2; k < 4; k++) {
      const cell_vector more = vector_scale(a[k], d4_sub(d4_load(value[k]), base));
      turn = (cell_vector){d4_add(turn.x, more.x), d4_add(turn.y, more.y), d4_add(turn.z, more.z)};
    }
    const cell_linear linear = cell_linear_of(rays, turn, corner);
    const d4 record[5] = {linear.at, linear.per_x, linear.per_y, linear.per_end, base};
    for (int field = 0; field < 5; field++) {
      float lanes[4];
      d4_store_float(lanes, record[field]);
      for (int i = 0; i < 4; i++) batch->gradient_record[i].g[3 * field + part] = lanes[i];
    }
    d4_store(batch->turn[part][0], turn.x);
    d4_store(batch->turn[part][1], turn.y);
    d4_store(batch->turn[part][2], turn.z);
    d4_store(batch->corner_turn[part], base);
  }
}

/* cell: four tets; rect: theirs, cut to the tile. */
static inline void cells_set_up(const soft_scene *scene, const uint32_t cell[4], const soft_rect rect[4],
                                cell_batch *batch) {
  d4 v[4][4];
  for (int k = 0; k < 4; k++) {
    const double *row[4];
    for (int i = 0; i < 4; i++) row[i] = &scene->vertices[scene->tets[4 * (size_t)cell[i] + (size_t)k]].x;
    d4_transpose(row, v[k]);
  }
  double u0[4], v0[4], wide[4], high[4];
  for (int i = 0; i < 4; i++) {
    u0[i] = scene->across + scene->across_step * rect[i].x0;
    v0[i] = scene->upward + scene->upward_step * rect[i].y0;
    wide[i] = rect[i].x1 - rect[i].x0;
    high[i] = rect[i].y1 - rect[i].y0;
  }
  const d4 columns = d4_load(wide), rows = d4_load(high);
  cell_rays rays = {.parallel = scene->parallel,
                    .across = d4_load(u0),
                    .upward = d4_load(v0),
                    .step_x = d4_all(scene->across_step),
                    .step_y = d4_all(scene->upward_step)};

  cell_vector a[4];
  batch->usable = cell_gradients((const d4(*)[4])v, a);
  const d4 z_low = d4_min(d4_min(v[0][2], v[1][2]), d4_min(v[2][2], v[3][2]));
  const d4 z_high = d4_max(d4_max(v[0][2], v[1][2]), d4_max(v[2][2], v[3][2]));
  d4 extent, farthest, least; /* of w: the cell's range; depth; w at the farthest point, or what counts as that */
  if (scene->parallel) {
    extent = least = d4_sub(z_high, z_low);
    farthest = d4_all(1);
    batch->careful = 0;
  } else {
    least = d4_div(d4_all(1), z_high);
    extent = d4_mul(d4_div(d4_sub(z_high, z_low), z_low), least);
    farthest = z_high;
    batch->careful = d4_at_most(z_low, d4_all(0));
  }
  batch->clipped = d4_at_most(z_low, d4_all(scene->near));

  unsigned edge_on = 0;
  d4 at[4], per_x[4], per_y[4], best = d4_all(0), reference = d4_all(0);
  for (int k = 0; k < 4; k++) {
    const d4 *on = v[k == 0 ? 1 : 0];
    const d4 h = vector_dot(a[k], (cell_vector){on[0], on[1], on[2]});
    const d4 flat = d4_add(d4_mul(a[k].x, rays.across), d4_mul(a[k].y, rays.upward));
    const d4 above = scene->parallel ? d4_sub(flat, h) : d4_add(flat, a[k].z);
    const d4 below = scene->parallel ? a[k].z : h;
    const d4 reach = scene->parallel
                         ? d4_all(1)
                         : vector_dot((cell_vector){on[0], on[1], on[2]}, (cell_vector){on[0], on[1], on[2]});
    edge_on |= d4_at_most(d4_mul(below, below),
                          d4_mul(d4_all(CAREFUL_EDGE_ON * CAREFUL_EDGE_ON), d4_mul(vector_dot(a[k], a[k]), reach)));
    const d4 inverse = d4_div(d4_all(1), below);
    batch->is_entry[k] = d4_at_most(d4_all(0), below);
    at[k] = d4_mul(above, inverse);
    per_x[k] = d4_mul(d4_mul(a[k].x, rays.step_x), inverse);
    per_y[k] = d4_mul(d4_mul(a[k].y, rays.step_y), inverse);
    const d4 steep = d4_add(d4_mul(d4_abs(per_x[k]), columns), d4_mul(d4_abs(per_y[k]), rows));
    if (k == 0) {
      best = steep;
      rays.place = at[0];
      rays.place_x = per_x[0];
      rays.place_y = per_y[0];
      continue;
    }
    const d4 better = d4_less(steep, best);
    best = d4_select(better, steep, best);
    reference = d4_select(better, d4_all(k), reference);
    rays.place = d4_select(better, at[k], rays.place);
    rays.place_x = d4_select(better, per_x[k], rays.place_x);
    rays.place_y = d4_select(better, per_y[k], rays.place_y);
  }
  const d4 limit = d4_mul(d4_all(CAREFUL_RATIO), extent);
  unsigned plain = d4_at_most(best, d4_mul(d4_all(CAREFUL_RATIO), least));
  for (int k = 0; k < 4; k++) {
    const d4 constant = d4_sub(at[k], rays.place);
    const d4 x = d4_sub(per_x[k], rays.place_x), y = d4_sub(per_y[k], rays.place_y);
    const d4 size = cell_size(constant, x, y, columns, rows);
    plain &= d4_at_most(size, limit);
    d4_store_float(batch->plane[k][0], constant);
    d4_store_float(batch->plane[k][1], x);
    d4_store_float(batch->plane[k][2], y);
  }
  const d4 near = d4_all(scene->parallel ? -scene->near : 1 / scene->near);
  d4_store_float(batch->plane[NEAR_PLANE][0], d4_sub(near, rays.place));
  d4_store_float(batch->plane[NEAR_PLANE][1], d4_sub(d4_all(0), rays.place_x));
  d4_store_float(batch->plane[NEAR_PLANE][2], d4_sub(d4_all(0), rays.place_y));

  d4 s[4];
  for (int k = 0; k < 4; k++) s[k] = v[k][3];
  if (scene->cell_scalars != NULL) {
    double value[4];
    for (int i = 0; i < 4; i++) value[i] = scene->cell_scalars[cell[i]];
    for (int k = 0; k < 4; k++) s[k] = d4_load(value);
  }
  cell_vector gradient = vector_scale(a[1], d4_sub(s[1], s[0]));
  for (int k = 2; k < 4; k++) {
    const cell_vector part = vector_scale(a[k], d4_sub(s[k], s[0]));
    gradient = (cell_vector){d4_add(gradient.x, part.x), d4_add(gradient.y, part.y), d4_add(gradient.z, part.z)};
  }
  const d4 s_low = d4_min(d4_min(s[0], s[1]), d4_min(s[2], s[3]));
  const d4 s_high = d4_max(d4_max(s[0], s[1]), d4_max(s[2], s[3]));
  const cell_linear scalar = cell_linear_of(&rays, gradient, v[0]);
  /* What an end's rounding does to the scalar, s_end times it, does not count: the steeper the scalar is along the ray,
   * the shorter is what the cell holds of it. */
  const d4 varies = d4_mul(farthest, cell_size(scalar.at, scalar.per_x, scalar.per_y, columns, rows));
  const d4 range = d4_max(d4_sub(s_high, s_low), d4_all(CAREFUL_SCALAR));
  plain &= d4_at_most(varies, d4_mul(d4_all(CAREFUL_RATIO), range));
  batch->careful |= edge_on | (15 & ~plain);

  const d4 record[3][4] = {{rays.place, rays.place_x, rays.place_y, scalar.at},
                           {scalar.per_x, scalar.per_y, scalar.per_end, s[0]},
                           {s_low, s_high, d4_all(1), d4_all(0)}};
  for (int i = 0; i < 3; i++)
    d4_store_rows(&batch->record[0].place + 4 * i, sizeof(soft_record) / sizeof(float), record[i]);
  if (scene->model.gradients == SOFT_POINT_GRADIENTS) cells_set_gradients(scene, cell, &rays, a, v[0], batch);
  d4_store(batch->reference, reference);
  d4_store(batch->gradient[0], gradient.x);
  d4_store(batch->gradient[1], gradient.y);
  d4_store(batch->gradient[2], gradient.z);
  for (int i = 0; i < 3; i++) d4_store(batch->corner[i], v[0][i]);
  d4_store(batch->corner[3], s[0]);
  d4_store(batch->z_low, z_low);
  d4_store(batch->z_high, z_high);
  d4_store(batch->s_low, s_low);
  d4_store(batch->s_high, s_high);
}

#endif
