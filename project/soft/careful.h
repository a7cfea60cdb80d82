/* SPDX-License-Identifier: BSD-3-Clause
 * Careful: cells that are steep, thin or hold the eye's plane, in double precision, pixel by pixel. Included by each
 * kernel. Each pixel gets a record of its own. */
#ifndef CELLIST_SOFT_CAREFUL_H
#define CELLIST_SOFT_CAREFUL_H

#include "cells.h"

/* One cell of a batch, with its place in the tile. */
typedef struct tile_cell {
  const cell_batch *batch;
  int lane;
  uint32_t cell;
  soft_rect rect;
  int32_t origin; /* of the rectangle, as a pixel of the tile */
} tile_cell;

/* The plane of a face, from its points in the order of their ids: the two cells that share it get the same bits, so
 * that a ray within rounding of it is counted once. Positive, times side, is inside. */
typedef struct careful_plane {
  double normal[3], offset, side;
  double inverse;     /* of how far the eye is from it: a division a cell, not a pixel */
  double size, reach; /* of the normal; of what rounding of the offset (parallel: of the slope) is a part of */
} careful_plane;

static inline void order_two(uint32_t *a, uint32_t *b, double *side) {
  if (*a <= *b) return;
  const uint32_t swapped = *a;
  *a = *b;
  *b = swapped;
  *side = -*side;
}

static inline void careful_planes(const soft_scene *scene, uint32_t cell, careful_plane planes[4]) {
  for (int k = 0; k < 4; k++) {
    uint32_t id[3];
    for (int i = 0; i < 3; i++) id[i] = scene->tets[4 * (size_t)cell + CELLIST_TET_FACE[k][i]];
    double side = 1; /* outwards in the mesh's frame is inwards in the eye's, which is left-handed */
    order_two(&id[0], &id[1], &side);
    order_two(&id[1], &id[2], &side);
    order_two(&id[0], &id[1], &side);
    const soft_vertex a = scene->vertices[id[0]], b = scene->vertices[id[1]], c = scene->vertices[id[2]];
    const double e[3] = {b.x - a.x, b.y - a.y, b.z - a.z}, f[3] = {c.x - a.x, c.y - a.y, c.z - a.z};
    careful_plane *plane = &planes[k];
    for (int i = 0; i < 3; i++) plane->normal[i] = e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3];
    plane->offset = plane->normal[0] * a.x + plane->normal[1] * a.y + plane->normal[2] * a.z;
    plane->side = side;
    plane->size = fabs(plane->normal[0]) + fabs(plane->normal[1]) + fabs(plane->normal[2]);
    plane->reach = plane->size * (scene->parallel ? 1 : fabs(a.x) + fabs(a.y) + fabs(a.z));
    plane->inverse = 1 / (scene->parallel ? plane->normal[2] : plane->offset);
  }
}

/* fmin and fmax are calls into the mathematical library. */
static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

/* Rays this near to a plane that the eye is as near to lie in it: faces in one plane must agree on who has such a ray,
 * or cells of both sides, which have no order, are seen by turns. Smaller: rounding decides; larger: cells that thin.
 */
#define CAREFUL_TIE 1e-12

/* Cuts leaves..enters by a plane; false if the ray lies beside it. A ray in the plane counts as one displaced to the
 * right by an infinitesimal, and up by its square. */
static inline bool cut_by_plane(const careful_plane *plane, bool parallel, double u, double v, double *leaves,
                                double *enters) {
  const double *n = plane->normal;
  const double flat = n[0] * u + n[1] * v;
  const double above = parallel ? flat - plane->offset : flat + n[2], below = parallel ? n[2] : plane->offset;
  const double is_inside = below * plane->side;
  if (fabs(below) <= CAREFUL_TIE * plane->reach && fabs(above) <= CAREFUL_TIE * plane->size * (1 + fabs(u) + fabs(v)))
    return (fabs(n[0]) > CAREFUL_TIE * plane->size ? n[0] : n[1]) * plane->side > 0;
  if (is_inside > 0)
    *enters = smaller(*enters, above * plane->inverse);
  else if (is_inside < 0)
    *leaves = larger(*leaves, above * plane->inverse);
  else
    return (above != 0 ? above : n[0] != 0 ? n[0] : n[1]) * plane->side > 0;
  return true;
}

/* The gradient where a careful pixel's ray leaves the cell, and how it changes towards the entry. */
static inline void careful_gradient(const soft_scene *scene, const cell_batch *batch, int lane, double u, double v,
                                    double leaves, soft_gradient_record *record) {
  const double t = scene->parallel ? -leaves : 1 / leaves, stretch = scene->parallel ? 1 : t;
  const double from[3] = {stretch * u - batch->corner[0][lane], stretch * v - batch->corner[1][lane],
                          t - batch->corner[2][lane]};
  *record = (soft_gradient_record){.unused = 0};
  for (int part = 0; part < 3; part++) {
    double value = batch->corner_turn[part][lane];
    for (int k = 0; k < 3; k++) value += batch->turn[part][k][lane] * from[k];
    const double slope =
        scene->parallel
            ? batch->turn[part][2][lane]
            : t * (batch->turn[part][0][lane] * u + batch->turn[part][1][lane] * v + batch->turn[part][2][lane]);
    record->g[9 + part] = (float)slope;
    record->g[12 + part] = (float)value;
  }
}

/* Whether rays may lie within one of the planes: each is asked about, then. */
static inline bool has_edge_on(const careful_plane planes[4], bool parallel) {
  for (int k = 0; k < 4; k++) {
    const double below = parallel ? planes[k].normal[2] : planes[k].offset;
    if (!(fabs(below) > CAREFUL_TIE * planes[k].reach)) return true;
  }
  return false;
}

/* Four pixels of a row. */
typedef struct careful_four {
  double u[4], leaves[4], near_end[4], s_end[4], ends[2][4];
} careful_four;

/* Where rays enter and leave, with no plane that a ray may lie in. */
static inline void cut_four(const soft_scene *scene, const careful_plane planes[4], d4 u, double v, d4 *leaves,
                            d4 *enters) {
  for (int k = 0; k < 4; k++) {
    const careful_plane *plane = &planes[k];
    const double *n = plane->normal, below = scene->parallel ? n[2] : plane->offset;
    const d4 flat = d4_add(d4_mul(d4_all(n[0]), u), d4_all(n[1] * v));
    const d4 above = scene->parallel ? d4_sub(flat, d4_all(plane->offset)) : d4_add(flat, d4_all(n[2]));
    const d4 place = d4_mul(above, d4_all(plane->inverse));
    if (below * plane->side > 0)
      *enters = d4_min(*enters, place);
    else
      *leaves = d4_max(*leaves, place);
  }
}

/* The same, one ray after the other, to the same bits; returns the lanes whose rays do not lie beside the cell. */
static inline unsigned cut_one_by_one(const soft_scene *scene, const careful_plane planes[4], d4 u, double v,
                                      d4 *leaves, d4 *enters) {
  double each_u[4], leave[4], enter[4];
  d4_store(each_u, u);
  d4_store(leave, *leaves);
  d4_store(enter, *enters);
  unsigned within = 0;
  for (int i = 0; i < 4; i++) {
    bool is_within = true;
    for (int k = 0; k < 4 && is_within; k++)
      is_within = cut_by_plane(&planes[k], scene->parallel, each_u[i], v, &leave[i], &enter[i]);
    within |= (unsigned)is_within << i;
  }
  *leaves = d4_load(leave);
  *enters = d4_load(enter);
  return within;
}

/* Where four rays enter and leave, and the scalars there; the record's reference ray is the pixel's own. near, far:
 * between which they are seen. Returns the lanes that are covered. */
static inline unsigned careful_pixels(const soft_scene *scene, const tile_cell *cell, const careful_plane planes[4],
                                      bool one_by_one, d4 u, double v, d4 near, d4 far, careful_four *made) {
  const cell_batch *batch = cell->batch;
  const int lane = cell->lane;
  const bool parallel = scene->parallel;
  d4 leaves = d4_max(d4_all(parallel ? -batch->z_high[lane] : 1 / batch->z_high[lane]), far), enters = near;
  unsigned covered = 15;
  if (one_by_one)
    covered = cut_one_by_one(scene, planes, u, v, &leaves, &enters);
  else
    cut_four(scene, planes, u, v, &leaves, &enters);
  if (!parallel) enters = d4_min(enters, d4_mul(d4_all(ENTRY_LIMIT), leaves));
  covered &= d4_greater(enters, leaves);
  if (covered == 0) return 0;
  const d4 one = d4_all(1), t = parallel ? d4_sub(d4_all(0), leaves) : d4_div(one, leaves);
  const d4 stretch = parallel ? one : t;
  const double *gx = batch->gradient[0], *gy = batch->gradient[1], *gz = batch->gradient[2];
  const d4 x = d4_sub(d4_mul(stretch, u), d4_all(batch->corner[0][lane]));
  const d4 y = d4_sub(d4_mul(stretch, d4_all(v)), d4_all(batch->corner[1][lane]));
  const d4 z = d4_sub(t, d4_all(batch->corner[2][lane]));
  const d4 s =
      d4_add(d4_add(d4_add(d4_all(batch->corner[3][lane]), d4_mul(d4_all(gx[lane]), x)), d4_mul(d4_all(gy[lane]), y)),
             d4_mul(d4_all(gz[lane]), z));
  const d4 slope =
      parallel ? d4_all(gz[lane]) : d4_add(d4_add(d4_mul(d4_all(gx[lane]), u), d4_all(gy[lane] * v)), d4_all(gz[lane]));
  const d4 low = d4_all(batch->s_low[lane]), high = d4_all(batch->s_high[lane]);
  const d4 depth = parallel ? d4_sub(leaves, enters) : d4_sub(d4_div(one, enters), t);
  d4_store(made->u, u);
  d4_store(made->leaves, leaves);
  d4_store(made->near_end, d4_sub(enters, leaves));
  d4_store(made->s_end, parallel ? slope : d4_mul(slope, t));
  d4_store(made->ends[0], d4_min(d4_max(d4_add(s, d4_mul(slope, depth)), low), high));
  d4_store(made->ends[1], d4_min(d4_max(s, low), high));
  return covered;
}

/* A fragment of its own record. is_sharp: its scalars are kept in double precision. */
static inline void add_careful(const soft_scene *scene, const tile_cell *cell, const careful_four *four, int i,
                               double v, int32_t pixel, bool is_sharp, soft_fragments *fragments) {
  const cell_batch *batch = cell->batch;
  const int lane = cell->lane;
  const size_t at = fragments->count++, record = fragments->record_count++;
  fragments->records[record] = (soft_record){.place = (float)four->leaves[i],
                                             .s_end = (float)four->s_end[i],
                                             .base = (float)four->ends[1][i],
                                             .s_low = batch->record[lane].s_low,
                                             .s_high = batch->record[lane].s_high,
                                             .share = batch->record[lane].share,
                                             .shine = batch->record[lane].shine};
  if (fragments->is_sharp) {
    fragments->ends[record][0] = is_sharp ? four->ends[0][i] : NAN;
    fragments->ends[record][1] = four->ends[1][i];
  }
  if (fragments->has_gradients)
    careful_gradient(scene, batch, lane, four->u[i], v, fragments->records[record].place,
                     &fragments->gradients[record]);
  fragments->near_end[at] = (float)four->near_end[i];
  fragments->far_end[at] = 0;
  fragments->where[at] = pixel;
  fragments->cell[at] = (int32_t)record;
}

/* Rows in fours, or one by one where rays may lie within a face. */
static void fill_careful(const soft_scene *scene, const soft_worker *limits, const tile_cell *cell, bool is_sharp,
                         soft_fragments *fragments) {
  static const double ramp[4] = {0, 1, 2, 3};
  const soft_rect rect = cell->rect;
  if (!(cell->batch->z_high[cell->lane] > 0) && !scene->parallel) return;
  careful_plane planes[4];
  careful_planes(scene, cell->cell, planes);
  const bool one_by_one = has_edge_on(planes, scene->parallel);
  const d4 near = d4_all(scene->parallel ? -scene->near : 1 / scene->near), far = d4_all(-HUGE_VAL);
  for (int y = rect.y0; y <= rect.y1; y++) {
    const double v = scene->upward + scene->upward_step * y;
    for (int x = rect.x0; x <= rect.x1; x += 4) {
      const int32_t pixel = cell->origin + (y - rect.y0) * SOFT_TILE + (x - rect.x0);
      const int left = rect.x1 - x + 1;
      const unsigned inside = left >= 4 ? 15 : (1u << left) - 1;
      const d4 u = d4_add(d4_all(scene->across), d4_mul(d4_all(scene->across_step), d4_add(d4_all(x), d4_load(ramp))));
      const d4 begins = limits != NULL ? d4_load(limits->near_place + pixel) : near;
      const d4 ends = limits != NULL ? d4_load(limits->far_place + pixel) : far;
      careful_four four;
      const unsigned covered = careful_pixels(scene, cell, planes, one_by_one, u, v, begins, ends, &four) & inside;
      for (int i = 0; i < 4; i++)
        if (covered >> i & 1) add_careful(scene, cell, &four, i, v, pixel + i, is_sharp, fragments);
    }
  }
}

#endif
