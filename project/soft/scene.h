/* SPDX-License-Identifier: BSD-3-Clause
 * Scene: what the kernels that fill tiles are given, and what they share. Private.
 *
 * Lengths are measured in units of the mesh's diagonal, so that single precision neither overflows nor vanishes. */
#ifndef CELLIST_SOFT_SCENE_H
#define CELLIST_SOFT_SCENE_H

#include <cellist/soft.h>
#include <optics/fast_optics.h>
#include <surface/layer.h>

/* Pixels along a tile's side: its pixels stay in the first-level cache, and a pixel's place fits in ten bits. */
enum { SOFT_TILE = 32, SOFT_TILE_PIXELS = SOFT_TILE * SOFT_TILE };

/* A point seen from the eye: along right, up and forward; s is its scalar as the optics take it. */
typedef struct soft_vertex {
  double x, y, z, s;
} soft_vertex;

/* Pixels whose centres a cell's picture may cover, inclusive; x0 > x1: none. */
typedef struct soft_rect {
  uint16_t x0, y0, x1, y1;
} soft_rect;

/* All that does not change while tiles are filled. */
typedef struct soft_scene {
  cellist_context *context;
  bool parallel;
  /* The ray of pixel (i, j)'s centre goes through (across + i across_step, upward + j upward_step, 1), or in parallel
   * views starts at (.., .., 0) and goes along (0, 0, 1). */
  double across, across_step, upward, upward_step;
  double near;
  const cellist_frame *frame; /* whose clip planes limit each ray, as the layer does; NULL: the near plane alone does */
  surface_layer layer;        /* behind what is drawn; {0}: none */
  double unit;                /* world length of 1 */
  uint32_t width, height, tiles_across;
  const uint32_t *tets, *order;
  const soft_vertex *vertices;
  const double *cell_scalars; /* NULL: scalars are the vertices' */
  const soft_rect *rects;     /* [order_count] */
  const uint32_t *entries;    /* places in the order, ascending, of each tile */
  const size_t *tile_begin;   /* [tiles + 1] into entries */
  const cellist_soft_group *groups;
  size_t group_count;
  const fast_transfer *transfer;
  float *colour[3], *alpha, *z, *z_back; /* the image's planes; NULL: not wanted */
} soft_scene;

/* What a cell contributes to eight or fewer pixels is worked out from these, relative to its own reference ray, the one
 * of its rectangle's first pixel, at depth `depth`: see tile.h. */
typedef struct soft_record {
  float s, slope, slope_x, slope_y; /* scalar there, and its derivatives along the ray and across */
  float depth, place;               /* place is 1/depth, in parallel views -depth */
  float s_low, s_high;              /* the cell's range, to which scalars are clamped */
} soft_record;

/* Pixels of cells that wait to be shaded, near to far on each pixel. */
typedef struct soft_fragments {
  size_t count, capacity, record_count;
  float *near_end, *far_end; /* places where the ray enters and leaves, relative to the record's */
  int32_t *where;            /* pixel of the tile, 2^16 times x and 2^24 times y within the cell's rectangle */
  int32_t *cell;             /* index of the record */
  soft_record *records;      /* [capacity] */
} soft_fragments;

/* One worker's own memory. */
typedef struct soft_worker {
  soft_fragments fragments, sorted;
  uint64_t *keys, *scratch_keys; /* [sort_capacity] */
  uint32_t *values, *scratch_values;
  size_t sort_capacity;
  float (*pixels)[4]; /* [SOFT_TILE_PIXELS] colour gathered so far, and transmittance */
  float *z, *z_back;  /* [SOFT_TILE_PIXELS] */
  /* [SOFT_TILE_PIXELS + 8] places (1/depth, in parallel views -depth) between which each ray is seen, far below near;
   * only where the scene has a frame. Eight more, since vectors are loaded whole. */
  double *near_place, *far_place;
  uint64_t fragment_count, careful_count;
} soft_worker;

/* Makes room for count fragments more; false without memory. */
bool soft_fragments_reserve(cellist_context *context, soft_fragments *fragments, size_t count);
void soft_fragments_release(cellist_context *context, soft_fragments *fragments);

/* Puts the worker's fragments in order of pixel, then of depth, near first; false without memory. */
bool soft_sort_fragments(const soft_scene *scene, soft_worker *worker);

/* Fills one tile and writes it to the image; false without memory. */
typedef bool (*soft_tile_function)(const soft_scene *scene, soft_worker *worker, size_t tile);
bool soft_tile_portable(const soft_scene *scene, soft_worker *worker, size_t tile);
/* Only where __builtin_cpu_supports("avx2") and "fma". */
bool soft_tile_avx2(const soft_scene *scene, soft_worker *worker, size_t tile);

#endif
