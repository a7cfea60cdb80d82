/* SPDX-License-Identifier: BSD-3-Clause
 * Scene: what the kernels that fill tiles are given, and what they share. Private.
 *
 * Lengths are measured in units of the mesh's diagonal, so that single precision neither overflows nor vanishes. */
#ifndef CELLIST_SOFT_SCENE_H
#define CELLIST_SOFT_SCENE_H

#include <cellist/soft.h>
#include <optics/fast_optics.h>
#include <surface/layer.h>

#include "sharp.h"

/* Pixels along a tile's side: its pixels stay in the first-level cache, and a pixel's place fits in ten bits. */
enum { SOFT_TILE = 32, SOFT_TILE_PIXELS = SOFT_TILE * SOFT_TILE };

/* Up to this optical depth along the mesh's diagonal, the longest ray, 1 - opacity has all the digits that
 * transmittance would have. Larger: faint light behind would lose digits; smaller: A = 1 - transmittance of media as
 * thin loses them. */
#define SOFT_THIN 0.5

/* A point seen from the eye: along right, up and forward; s is its scalar as the optics take it. */
typedef struct soft_vertex {
  double x, y, z, s;
} soft_vertex;

/* Pixels whose centres a cell's picture may cover, inclusive; x0 > x1: none. */
typedef struct soft_rect {
  uint16_t x0, y0, x1, y1;
} soft_rect;

/* An isosurface in the scaled scalar. */
typedef struct soft_iso {
  float value, opacity, colour[3];
} soft_iso;

/* Gradients that light falls on: none, one a cell, or linear in each cell from those at its points. */
typedef enum soft_gradients { SOFT_NO_LIGHT, SOFT_CELL_GRADIENTS, SOFT_POINT_GRADIENTS } soft_gradients;

/* Light and surfaces of a frame; vectors along right, up and forward. */
typedef struct soft_model {
  cellist_model model;
  soft_gradients gradients;
  double light[3], halfway[3]; /* unit vectors; halfway may be 0 */
  double ambient, diffuse, specular, shininess;
  double gradient_factor;      /* makes a gradient of scaled scalars per scaled length one in the light's unit */
  float (*point_gradients)[4]; /* [points] in the light's unit, or NULL */
  uint32_t samples;            /* parts of a segment that are lit one by one, at least 1 */
  soft_iso *isos;              /* [iso_count] ascending */
  size_t iso_count;
} soft_model;

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
  const double *cell_scalars;   /* NULL: scalars are the vertices' */
  const soft_rect *rects;       /* [tets] */
  const uint32_t *entries;      /* tets of each tile, in the sequence of the order */
  const uint32_t *entry_places; /* their places in the order; NULL where there are no groups */
  const size_t *tile_begin;     /* [tiles + 1] into entries */
  const cellist_soft_group *groups;
  size_t group_count;
  const fast_transfer *transfer;
  soft_sharp sharp;
  soft_model model;
  float *colour[3], *alpha, *z, *z_back; /* the image's planes; NULL: not wanted */
  bool is_thin; /* no ray is deeper than SOFT_THIN: pixels gather opacity in place of transmittance */
} soft_scene;

/* A scalar as the optics take it: to single precision, so that equal to a knot stays equal, unless the transfer
 * function asks for more. */
static inline double soft_scalar(const soft_scene *scene, double scalar) {
  return scene->sharp.zone_count > 0 ? fast_scalar_exact(scene->transfer, scalar)
                                     : fast_scalar(scene->transfer, scalar);
}

/* What a cell contributes to a pixel is worked out from these, relative to one of its faces; x and y are the pixel's
 * place in the cell's rectangle, `end` is measured from the face's plane:
 *   w = place + place_x x + place_y y + end,   t = 1/w (parallel: -w),
 *   scalar = base + t (s + s_x x + s_y y - s_end end) (parallel: without t). */
typedef struct soft_record {
  float place, place_x, place_y;
  float s, s_x, s_y, s_end, base;
  float s_low, s_high; /* the cell's range, to which scalars are clamped */
  float share, shine;  /* light with one gradient a cell: factor of colours, and strength of the highlight */
} soft_record;

/* The same for the three components of a gradient that is linear in the cell, in units of the light. */
typedef struct soft_gradient_record {
  float g[15], unused; /* three each: there, by x, by y, by the end, base */
} soft_gradient_record;

/* Pixels of cells that wait to be shaded, near to far on each pixel. */
typedef struct soft_fragments {
  size_t count, capacity, record_count;
  float *near_end, *far_end;       /* places where the ray enters and leaves, relative to the record's */
  int32_t *where;                  /* pixel of the tile, 2^16 times x and 2^24 times y within the cell's rectangle */
  int32_t *cell;                   /* index of the record */
  soft_record *records;            /* [capacity] */
  bool has_gradients;              /* else the next is NULL */
  soft_gradient_record *gradients; /* [capacity] of records, where light takes gradients at points */
  bool is_sharp;                   /* else the next is NULL */
  double (*ends)[2]; /* [capacity] of records: the scalar where the ray enters and leaves, NaN in cells not sharp */
} soft_fragments;

/* Parts of segments within one interval of the transfer function, packed; the arrays hold SOFT_PIECES. */
enum { SOFT_PIECES = 512, SOFT_ATTRIBUTES = 8 };
typedef struct soft_pieces {
  size_t count;
  float from[SOFT_PIECES], to[SOFT_PIECES], length[SOFT_PIECES];
  int32_t interval[SOFT_PIECES], pixel[SOFT_PIECES];
  float depth[2][SOFT_PIECES];                   /* where it begins and ends */
  float attribute[SOFT_ATTRIBUTES][SOFT_PIECES]; /* of light: see pieces.h */
} soft_pieces;

/* What a pixel has gathered so far: a vector of eight. */
typedef struct soft_pixel {
  float light[4];        /* premultiplied colour and transmittance; in thin scenes opacity */
  float minus_z, z_back; /* depths of the first contribution and of the last one: both grow */
  float unused[2];
} soft_pixel;

/* One worker's own memory. */
typedef struct soft_worker {
  soft_fragments fragments, sorted;
  soft_pieces *pieces;
  uint64_t *keys, *scratch_keys; /* [sort_capacity] */
  uint32_t *values, *scratch_values;
  size_t sort_capacity;
  soft_pixel *pixels; /* [SOFT_TILE_PIXELS] */
  float (*last)[2];   /* [SOFT_TILE_PIXELS] scalar and depth where the ray left the cell before: for isosurfaces */
  /* [SOFT_TILE_PIXELS + 8] places (1/depth, in parallel views -depth) between which each ray is seen, far below near;
   * only where the scene has a frame. Eight more, since vectors are loaded whole. */
  double *near_place, *far_place;
  uint64_t fragment_count, careful_count;
} soft_worker;

/* Prepares light and isosurfaces for a frame: point_gradients are the mesh's in world units, [3 points], or NULL.
 * Errors: OUT_OF_MEMORY. */
cellist_result soft_model_make(cellist_context *context, const cellist_optics *optics, const cellist_frame *frame,
                               const cellist_transfer *transfer, const fast_transfer *table, double unit,
                               const double *point_gradients, size_t point_count, soft_model *model);
void soft_model_release(cellist_context *context, soft_model *model);

/* Whether a cell whose scalars lie between low and high may hold an isosurface. */
bool soft_model_meets_iso(const soft_model *model, double low, double high);

/* Makes room for count fragments more; false without memory. */
bool soft_fragments_reserve(cellist_context *context, soft_fragments *fragments, size_t count);
void soft_fragments_release(cellist_context *context, soft_fragments *fragments);

/* Puts the worker's fragments in order of pixel, then of depth, near first; false without memory. */
bool soft_sort_fragments(const soft_scene *scene, soft_worker *worker);

/* Bounds tets begin to end - 1 (a multiple of 8, or the last) by what their points' largest x y -x -y are. */
typedef void (*soft_bounds_function)(const uint32_t *tets, const float (*places)[4], size_t begin, size_t end,
                                     uint32_t width, uint32_t height, soft_rect *rects);
void soft_bounds_portable(const uint32_t *tets, const float (*places)[4], size_t begin, size_t end, uint32_t width,
                          uint32_t height, soft_rect *rects);
void soft_bounds_avx2(const uint32_t *tets, const float (*places)[4], size_t begin, size_t end, uint32_t width,
                      uint32_t height, soft_rect *rects);

/* Fills one tile and writes it to the image; false without memory. */
typedef bool (*soft_tile_function)(const soft_scene *scene, soft_worker *worker, size_t tile);
bool soft_tile_portable(const soft_scene *scene, soft_worker *worker, size_t tile);
/* Only where __builtin_cpu_supports("avx2") and "fma". */
bool soft_tile_avx2(const soft_scene *scene, soft_worker *worker, size_t tile);

#endif
