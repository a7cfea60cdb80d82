/* SPDX-License-Identifier: BSD-3-Clause
 * Tile: fills one tile, near cells first. Included once by each kernel.
 *
 * Rows of a cell's rectangle are tested eight pixels at a time; what is covered is packed into a list, and the list
 * shaded eight fragments at a time (shade.h). The order is walked backwards, so that transmittance is what is blended
 * and a tile that has become opaque is done. */
#ifndef CELLIST_SOFT_TILE_H
#define CELLIST_SOFT_TILE_H

#include <string.h>

#include "cells.h"
#include "shade.h"

/* Fragments that are gathered before they are shaded, at most a tile more: the list stays in the second-level cache. */
enum { SHADE_AT = 1024 };

/* One cell of a batch, with its place in the tile. */
typedef struct tile_cell {
  const cell_batch *batch;
  int lane;
  uint32_t cell;
  soft_rect rect;
  int32_t origin; /* of the rectangle, as a pixel of the tile */
  double place;   /* as the record has it, from which fragments' ends are measured */
} tile_cell;

static inline void put_record(const cell_batch *batch, int lane, soft_record *record) {
  record->s = batch->record[0][lane];
  record->slope = batch->record[1][lane];
  record->slope_x = batch->record[2][lane];
  record->slope_y = batch->record[3][lane];
  record->depth = batch->record[4][lane];
  record->place = batch->record[5][lane];
  record->s_low = batch->record[6][lane];
  record->s_high = batch->record[7][lane];
}

/* faces: exits first, exit_count of them. Inlined with a constant count, so that the loops over faces unroll.
 * limits: whose near_place and far_place to keep to; NULL: near_limit is that of every pixel. */
static inline __attribute__((always_inline)) void fill_rows(const tile_cell *cell, const int faces[4],
                                                            const int exit_count, float near_limit,
                                                            const soft_worker *limits, soft_fragments *fragments) {
  static const float ramp[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  static const int32_t step[8] = {0, 0x10001, 0x20002, 0x30003, 0x40004, 0x50005, 0x60006, 0x70007};
  const cell_batch *batch = cell->batch;
  const int lane = cell->lane, width = cell->rect.x1 - cell->rect.x0 + 1, height = cell->rect.y1 - cell->rect.y0 + 1;
  const f8 columns = f8_load(ramp), limit = f8_all(near_limit);
  const i8 places = i8_load(step);
  const int32_t index = (int32_t)fragments->record_count;
  for (int x = 0; x < width; x += 8) {
    f8 across[4];
    for (int k = 0; k < 4; k++) {
      const float(*plane)[4] = batch->plane[faces[k]];
      across[k] = f8_add(f8_all(plane[0][lane]), f8_mul(f8_all(plane[1][lane]), f8_add(columns, f8_all((float)x))));
    }
    const unsigned inside = width - x >= 8 ? 255 : (1u << (width - x)) - 1;
    for (int y = 0; y < height; y++) {
      f8 value[4];
      for (int k = 0; k < 4; k++)
        value[k] = f8_add(across[k], f8_mul(f8_all(batch->plane[faces[k]][2][lane]), f8_all((float)y)));
      f8 leaves = value[0], enters = limit;
      for (int k = 1; k < exit_count; k++) leaves = f8_max(leaves, value[k]);
      for (int k = exit_count; k < 4; k++) enters = f8_min(value[k], enters);
      if (limits != NULL) {
        const size_t pixel = (size_t)(cell->origin + y * SOFT_TILE + x);
        enters = f8_min(enters, f8_differences(limits->near_place + pixel, cell->place));
        leaves = f8_max(leaves, f8_differences(limits->far_place + pixel, cell->place));
      }
      const unsigned covered = m8_bits(f8_greater(enters, leaves)) & inside;
      if (covered == 0) continue;
      const size_t at = fragments->count;
      const i8 packing = lanes_packing(covered);
      f8_store_packed(fragments->near_end + at, enters, packing);
      f8_store_packed(fragments->far_end + at, leaves, packing);
      const int32_t first = cell->origin + y * SOFT_TILE + x + (x << 16) + (y << 24);
      i8_store_packed(fragments->where + at, i8_add(i8_all(first), places), packing);
      i8_store(fragments->cell + at, i8_all(index));
      fragments->count += (size_t)__builtin_popcount(covered);
    }
  }
}

static inline void fill_plain(const soft_scene *scene, const soft_worker *limits, const tile_cell *cell,
                              soft_fragments *fragments) {
  const cell_batch *batch = cell->batch;
  int faces[4], exit_count = 0, entry_count = 0;
  for (int k = 0; k < 4; k++)
    if (!(batch->is_entry[k] >> cell->lane & 1)) faces[exit_count++] = k;
  for (int k = 0; k < 4; k++)
    if (batch->is_entry[k] >> cell->lane & 1) faces[exit_count + entry_count++] = k;
  const float near_limit = (float)((scene->parallel ? -scene->near : 1 / scene->near) - cell->place);
  const size_t before = fragments->count;
  switch (exit_count) {
    case 1: fill_rows(cell, faces, 1, near_limit, limits, fragments); break;
    case 2: fill_rows(cell, faces, 2, near_limit, limits, fragments); break;
    case 3: fill_rows(cell, faces, 3, near_limit, limits, fragments); break;
    case 4: fill_rows(cell, faces, 4, near_limit, limits, fragments); break;
    default: return; /* no face is left through: rounding, of a cell thinner than it */
  }
  if (fragments->count > before) put_record(batch, cell->lane, &fragments->records[fragments->record_count++]);
}

/* The plane of a face, from its points in the order of their ids: the two cells that share it get the same bits, so
 * that a ray within rounding of it is counted once. Positive, times side, is inside. */
typedef struct careful_plane {
  double normal[3], offset, side;
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
  }
}

/* Cuts leaves..enters by a plane; false if the ray lies beside it. A ray in the plane counts as one displaced to the
 * right by an infinitesimal, and up by its square. */
static inline bool cut_by_plane(const careful_plane *plane, bool parallel, double u, double v, double *leaves,
                                double *enters) {
  const double *n = plane->normal;
  const double flat = n[0] * u + n[1] * v;
  const double above = parallel ? flat - plane->offset : flat + n[2], below = parallel ? n[2] : plane->offset;
  const double is_inside = below * plane->side;
  if (is_inside > 0)
    *enters = fmin(*enters, above / below);
  else if (is_inside < 0)
    *leaves = fmax(*leaves, above / below);
  else
    return (above != 0 ? above : n[0] != 0 ? n[0] : n[1]) * plane->side > 0;
  return true;
}

/* One pixel in double precision: false if the cell does not cover it. The record's reference ray is the pixel's own.
 * limits: places between which the ray is seen, near and far. */
static inline bool careful_pixel(const soft_scene *scene, const tile_cell *cell, const careful_plane planes[4],
                                 double u, double v, const double limits[2], soft_record *record, float *near_end) {
  const cell_batch *batch = cell->batch;
  const int lane = cell->lane;
  const bool parallel = scene->parallel;
  double leaves = fmax(parallel ? -batch->z_high[lane] : 1 / batch->z_high[lane], limits[1]);
  double enters = limits[0];
  for (int k = 0; k < 4; k++)
    if (!cut_by_plane(&planes[k], parallel, u, v, &leaves, &enters)) return false;
  if (!parallel) enters = fmin(enters, ENTRY_LIMIT * leaves);
  if (!(enters > leaves)) return false;
  const double t = parallel ? -leaves : 1 / leaves, stretch = parallel ? 1 : t;
  const double *gx = batch->gradient[0], *gy = batch->gradient[1], *gz = batch->gradient[2];
  const double s = batch->corner[3][lane] + gx[lane] * (stretch * u - batch->corner[0][lane]) +
                   gy[lane] * (stretch * v - batch->corner[1][lane]) + gz[lane] * (t - batch->corner[2][lane]);
  const double slope = parallel ? gz[lane] : gx[lane] * u + gy[lane] * v + gz[lane];
  *record = (soft_record){.s = (float)fmin(fmax(s, batch->s_low[lane]), batch->s_high[lane]),
                          .slope = (float)slope,
                          .depth = (float)stretch,
                          .place = (float)leaves,
                          .s_low = batch->record[6][lane],
                          .s_high = batch->record[7][lane]};
  *near_end = (float)(enters - leaves);
  return true;
}

static void fill_careful(const soft_scene *scene, const soft_worker *limits, const tile_cell *cell,
                         soft_fragments *fragments) {
  const soft_rect rect = cell->rect;
  if (!(cell->batch->z_high[cell->lane] > 0) && !scene->parallel) return;
  careful_plane planes[4];
  careful_planes(scene, cell->cell, planes);
  for (int y = rect.y0; y <= rect.y1; y++) {
    const double v = scene->upward + scene->upward_step * y;
    for (int x = rect.x0; x <= rect.x1; x++) {
      const size_t at = fragments->count;
      const double u = scene->across + scene->across_step * x;
      const int32_t pixel = cell->origin + (y - rect.y0) * SOFT_TILE + (x - rect.x0);
      double seen[2] = {scene->parallel ? -scene->near : 1 / scene->near, -HUGE_VAL};
      if (limits != NULL) {
        seen[0] = limits->near_place[pixel];
        seen[1] = limits->far_place[pixel];
      }
      if (!careful_pixel(scene, cell, planes, u, v, seen, &fragments->records[fragments->record_count],
                         &fragments->near_end[at]))
        continue;
      fragments->far_end[at] = 0;
      fragments->where[at] = pixel;
      fragments->cell[at] = (int32_t)fragments->record_count++;
      fragments->count++;
    }
  }
}

static bool is_opaque(const soft_scene *scene, const soft_worker *worker) {
  const m8 none = m8_from_bits(0);
  m8 clear = none;
  const f8 limit = f8_all(scene->transfer->opaque);
  const float *p = &worker->pixels[0][0];
  for (size_t i = 0; i < 4 * SOFT_TILE_PIXELS; i += 8) clear = m8_or(clear, f8_greater(f8_load(p + i), limit));
  return (m8_bits(clear) & 0x88) == 0;
}

/* The part of a cell's rectangle that lies in the tile. */
static inline soft_rect cut_rect(soft_rect rect, uint32_t left, uint32_t top) {
  const uint32_t right = left + SOFT_TILE - 1, bottom = top + SOFT_TILE - 1;
  return (soft_rect){(uint16_t)(rect.x0 > left ? rect.x0 : left), (uint16_t)(rect.y0 > top ? rect.y0 : top),
                     (uint16_t)(rect.x1 < right ? rect.x1 : right), (uint16_t)(rect.y1 < bottom ? rect.y1 : bottom)};
}

/* Fragments of the entries from last - 1 down to first, in this order. keep: they are not shaded in between. */
static bool fill_entries(const soft_scene *scene, soft_worker *worker, uint32_t left, uint32_t top, size_t first,
                         size_t last, bool keep) {
  soft_fragments *fragments = &worker->fragments;
  const soft_worker *limits = scene->frame != NULL ? worker : NULL;
  size_t since = 0;
  while (last > first) {
    const int count = last - first < 4 ? (int)(last - first) : 4;
    uint32_t cell[4];
    soft_rect rect[4];
    for (int i = 0; i < 4; i++) {
      const uint32_t place = scene->entries[last - 1 - (size_t)(i < count ? i : 0)];
      cell[i] = scene->order[place];
      rect[i] = cut_rect(scene->rects[place], left, top);
    }
    last -= (size_t)count;
    cell_batch batch;
    cells_set_up(scene, cell, rect, &batch);
    for (int i = 0; i < count; i++) {
      if (!(batch.usable >> i & 1)) continue;
      const tile_cell one = {&batch,
                             i,
                             cell[i],
                             rect[i],
                             (int32_t)((rect[i].y0 - top) * SOFT_TILE + (rect[i].x0 - left)),
                             batch.record[5][i]};
      const size_t area = (size_t)(rect[i].x1 - rect[i].x0 + 1) * (size_t)(rect[i].y1 - rect[i].y0 + 1);
      if (!soft_fragments_reserve(scene->context, fragments, area)) return false;
      if (batch.careful >> i & 1) {
        worker->careful_count++;
        fill_careful(scene, limits, &one, fragments);
      } else {
        fill_plain(scene, limits, &one, fragments);
      }
      if (keep || fragments->count < SHADE_AT) continue;
      since += fragments->count;
      shade_fragments(scene, worker, left, top);
      if (since < 4 * SOFT_TILE_PIXELS) continue;
      since = 0;
      if (is_opaque(scene, worker)) return true;
    }
  }
  return true;
}

/* The first of the entries from begin on whose place in the order is at least `place`. */
static size_t first_entry(const soft_scene *scene, size_t begin, size_t end, size_t place) {
  while (begin < end) {
    const size_t middle = begin + (end - begin) / 2;
    if (scene->entries[middle] < place)
      begin = middle + 1;
    else
      end = middle;
  }
  return begin;
}

static bool fill_tile(const soft_scene *scene, soft_worker *worker, uint32_t left, uint32_t top, size_t begin,
                      size_t end) {
  for (size_t g = scene->group_count; g-- > 0;) {
    const cellist_soft_group *group = &scene->groups[g];
    const size_t from = first_entry(scene, begin, end, group->begin);
    const size_t to = first_entry(scene, from, end, group->begin + group->count);
    if (to == from) continue;
    if (!fill_entries(scene, worker, left, top, to, end, false)) return false;
    shade_fragments(scene, worker, left, top);
    if (!fill_entries(scene, worker, left, top, from, to, true) || !soft_sort_fragments(scene, worker)) return false;
    shade_fragments(scene, worker, left, top);
    end = from;
  }
  if (!fill_entries(scene, worker, left, top, begin, end, false)) return false;
  shade_fragments(scene, worker, left, top);
  return true;
}

static void store_tile(const soft_scene *scene, const soft_worker *worker, uint32_t left, uint32_t top) {
  for (uint32_t y = top; y < scene->height && y < top + SOFT_TILE; y++)
    for (uint32_t x = left; x < scene->width && x < left + SOFT_TILE; x++) {
      const size_t from = (size_t)(y - top) * SOFT_TILE + (x - left), to = (size_t)y * scene->width + x;
      float colour[3], alpha = 1 - worker->pixels[from][3];
      float z = (float)(worker->z[from] * scene->unit), z_back = (float)(worker->z_back[from] * scene->unit);
      for (int k = 0; k < 3; k++) colour[k] = worker->pixels[from][k];
      surface_layer_put_behind(&scene->layer, to, colour, &alpha, &z, &z_back);
      for (int k = 0; k < 3; k++)
        if (scene->colour[k] != NULL) scene->colour[k][to] = colour[k];
      if (scene->alpha != NULL) scene->alpha[to] = alpha;
      if (scene->z != NULL) scene->z[to] = z;
      if (scene->z_back != NULL) scene->z_back[to] = z_back;
    }
}

/* What is seen of each ray of the tile. */
static void set_limits(const soft_scene *scene, soft_worker *worker, uint32_t left, uint32_t top) {
  for (uint32_t y = 0; y < SOFT_TILE && top + y < scene->height; y++)
    for (uint32_t x = 0; x < SOFT_TILE && left + x < scene->width; x++) {
      double origin[3], direction[3], limits[2];
      cellist_frame_ray(scene->frame, left + x + 0.5, top + y + 0.5, origin, direction);
      cellist_frame_interval(scene->frame, origin, direction, limits);
      if (scene->layer.depth != NULL)
        limits[1] = fmin(limits[1], scene->layer.depth[(size_t)(top + y) * scene->width + left + x]);
      const size_t at = (size_t)y * SOFT_TILE + x;
      const bool sees = limits[0] < limits[1];
      if (scene->parallel) {
        worker->near_place[at] = -limits[0] / scene->unit;
        worker->far_place[at] = -limits[1] / scene->unit;
      } else {
        worker->near_place[at] = sees ? scene->unit / limits[0] : 0; /* at depth 0: infinity */
        worker->far_place[at] = sees ? scene->unit / limits[1] : HUGE_VAL;
      }
    }
}

static bool draw_tile(const soft_scene *scene, soft_worker *worker, size_t tile) {
  const uint32_t left = (uint32_t)(tile % scene->tiles_across) * SOFT_TILE;
  const uint32_t top = (uint32_t)(tile / scene->tiles_across) * SOFT_TILE;
  for (size_t i = 0; i < SOFT_TILE_PIXELS; i++) {
    memcpy(worker->pixels[i], (const float[4]){0, 0, 0, 1}, sizeof worker->pixels[i]);
    worker->z[i] = HUGE_VALF;
    worker->z_back[i] = 0;
  }
  worker->fragments.count = worker->fragments.record_count = 0;
  if (scene->frame != NULL) set_limits(scene, worker, left, top);
  if (!fill_tile(scene, worker, left, top, scene->tile_begin[tile], scene->tile_begin[tile + 1])) return false;
  store_tile(scene, worker, left, top);
  return true;
}

#endif
