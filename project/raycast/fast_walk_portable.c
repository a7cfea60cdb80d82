/* SPDX-License-Identifier: BSD-3-Clause
 * Fast walk in plain C, one ray at a time: on machines without AVX2, and the other half of its test. */
#include "fast_walk.h"

/* One ray on its way. */
struct ray {
  const fast_scene *scene;
  fast_pixel *pixel;
  float rx, ry, stretch; /* length per depth */
  uint32_t interval;     /* of the transfer function, holds the scalar */
  float reached;         /* depth up to which the ray has been followed */
  float near, far;       /* what is seen of it */
};

/* Whether it matters that the depths between which a segment lies are rounded. */
static inline bool is_doubtful(const struct ray *ray, float extent, float s, float next_s, float before) {
  const fast_transfer *transfer = &ray->scene->transfer;
  const uint32_t first = fast_find_interval(transfer, s), last = fast_find_interval(transfer, next_s);
  const float extinction =
      fmaxf(fast_extinction(&transfer->intervals[first], s), fast_extinction(&transfer->intervals[last], next_s));
  return fast_is_doubtful(extent, extinction > FAST_DENSE, first != last, before, ray->pixel->light.transmittance);
}

/* Returns false if the segment shows the rounding of depths. */
static bool add_cell(struct ray *ray, float z, float s, float next_z, float next_s) {
  const fast_scene *scene = ray->scene;
  fast_pixel *pixel = ray->pixel;
  if (!(next_z > ray->near && z < ray->far)) return true;
  pixel->cell_count++;
  if (isnan(s) || isnan(next_s)) return true;
  if (!(next_z > z)) return !(scene->is_dense && is_doubtful(ray, 0, s, next_s, pixel->light.transmittance));
  const float extent = next_z - z, rise = next_s - s, enters = z, entry_s = s;
  if (z < ray->near) {
    s = entry_s + (ray->near - enters) / extent * rise;
    z = ray->near;
  }
  if (next_z > ray->far) {
    next_s = entry_s + (ray->far - enters) / extent * rise;
    next_z = ray->far;
  }
  const float before = pixel->light.transmittance;
  uint32_t interval = ray->interval;
  const fast_interval *in = &scene->transfer.intervals[interval];
  if (!(s >= in->low && s <= in->high)) interval = fast_find_interval(&scene->transfer, s);
  float seen[2];
  ray->interval = fast_add_segment(&scene->transfer, interval, s, next_s, (next_z - z) * ray->stretch, &pixel->light,
                                   &pixel->piece_count, scene->wants_depth ? seen : NULL);
  if (scene->wants_depth && pixel->light.transmittance < before) {
    pixel->z = fminf(pixel->z, z + seen[0] * (next_z - z));
    pixel->z_back = fmaxf(pixel->z_back, z + seen[1] * (next_z - z));
  }
  return !(scene->is_dense && is_doubtful(ray, next_z - z, s, next_s, before));
}

/* Returns false if the ray got lost, met a face within its plane, or needs depths to more digits. */
static inline bool walk_chain(struct ray *ray, fast_stand *stand, fast_layout layout, uint64_t *step_count) {
  const fast_scene *scene = ray->scene;
  float z = stand->now.z, s = stand->now.s;
  for (;;) {
    ++*step_count;
    const uint32_t apex = stand->place.apex, cell = stand->place.cell;
    const fast_point p = fast_see(scene, apex, ray->rx, ray->ry);
    float side[3];
    bool unusable = false;
    for (int k = 0; k < 3; k++) side[k] = fast_side(p, stand->p[k], apex, stand->id[k]);
    if (scene->has_nan) unusable = isnan(p.b + stand->p[0].b + stand->p[1].b + stand->p[2].b);
    const int exit = side[1] > 0 && side[2] < 0 ? 0 : side[2] > 0 && side[0] < 0 ? 1 : 2;
    const int i = exit < 2 ? exit + 1 : 0, j = exit > 0 ? exit - 1 : 2;
    if (!(side[i] > 0 && side[j] < 0)) return false;
    const uint32_t leaving = stand->id[exit];
    stand->id[exit] = apex;
    stand->p[exit] = p;
    stand->w[i] = -side[j];
    stand->w[j] = side[i];
    stand->place = fast_cells_next(&scene->cells, layout, stand->place, stand->id, leaving);
    if (fast_is_edge_on(stand->p, stand->w)) return false;
    const fast_crossing next = fast_cross(scene, stand->p, stand->w);
    const float next_z = fmaxf(next.z, z);
    const float cell_s = scene->cell_scalars != NULL ? scene->cell_scalars[cell] : 0;
    const bool usable = scene->cell_scalars != NULL ? add_cell(ray, z, cell_s, next_z, cell_s)
                                                    : add_cell(ray, z, unusable ? NAN : s, next_z, next.s);
    if (!usable) return false;
    z = next_z;
    s = next.s;
    ray->reached = z;
    if (stand->place.cell == CELLIST_NONE) return true;
    if (ray->pixel->light.transmittance < scene->transfer.opaque || z >= ray->far) return true;
  }
}

static inline void walk_pixel(const fast_scene *scene, fast_tile *tile, uint32_t at, fast_layout layout) {
  fast_pixel *pixel = &tile->pixels[at];
  *pixel = (fast_pixel){.light.transmittance = 1, .z = INFINITY, .z_back = -INFINITY};
  struct ray ray = {.scene = scene,
                    .pixel = pixel,
                    .rx = scene->ray_x[tile->left + at % FAST_TILE],
                    .ry = scene->ray_y[tile->top + at / FAST_TILE],
                    .reached = -INFINITY,
                    .near = scene->clips ? tile->near[at] : -INFINITY,
                    .far = scene->clips ? tile->far[at] : INFINITY};
  ray.stretch = fast_ray_stretch(scene, ray.rx, ray.ry);
  bool folded = false;
  for (uint32_t e = tile->first[at]; e != CELLIST_NONE; e = tile->entries[e].next) {
    fast_stand stand;
    if (tile->entries[e].z >= ray.far) break;
    if (!fast_enter(scene, tile->entries[e].face, ray.rx, ray.ry, &stand)) continue;
    folded = folded || stand.now.z < ray.reached - FAST_FOLD_TOLERANCE * (1 + fabsf(ray.reached));
    if (fast_is_edge_on(stand.p, stand.w) || !walk_chain(&ray, &stand, layout, &tile->step_count)) {
      tile->retries[tile->retry_count++] = (uint16_t)at;
      return;
    }
    if (pixel->light.transmittance < scene->transfer.opaque) break;
  }
  tile->fold_ray_count += folded;
}

/* One copy of the walk a layout. */
static void walk_ranked(const fast_scene *scene, fast_tile *tile, uint32_t at) {
  walk_pixel(scene, tile, at, FAST_RANKED);
}
static void walk_tet32(const fast_scene *scene, fast_tile *tile, uint32_t at) {
  walk_pixel(scene, tile, at, FAST_TET32);
}
static void walk_tet20(const fast_scene *scene, fast_tile *tile, uint32_t at) {
  walk_pixel(scene, tile, at, FAST_TET20);
}
static void walk_tet16(const fast_scene *scene, fast_tile *tile, uint32_t at) {
  walk_pixel(scene, tile, at, FAST_TET16);
}

void fast_walk_portable(const fast_scene *scene, fast_tile *tile) {
  static void (*const WALK[FAST_LAYOUT_COUNT])(const fast_scene *, fast_tile *, uint32_t) = {walk_ranked, walk_tet32,
                                                                                             walk_tet20, walk_tet16};
  for (uint32_t i = 0; i < FAST_TILE_PIXELS; i++) {
    const uint32_t at = fast_tile_pixel(i);
    if (tile->first[at] != CELLIST_NONE) WALK[scene->cells.layout](scene, tile, at);
  }
}
