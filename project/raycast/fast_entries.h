/* SPDX-License-Identifier: BSD-3-Clause
 * Fast entries: through which boundary faces each ray of a tile enters the mesh, from near to far. Private.
 *
 * Made anew for every frame: first all faces that may face the eye are sorted into the tiles that they may touch
 * (two passes over fixed ranges of faces, so that lists do not depend on the number of workers), then each tile
 * rasterises its faces with the walk's own side tests, just before its rays are walked. */
#ifndef CELLIST_RAYCAST_FAST_ENTRIES_H
#define CELLIST_RAYCAST_FAST_ENTRIES_H

#include "fast_scene.h"

/* Pixels along a tile's side. Smaller: faces are touched by more tiles; larger: fewer tiles to share out. */
enum { FAST_TILE = 32, FAST_TILE_PIXELS = FAST_TILE * FAST_TILE };

/* Pixels that a boundary face may cover; left > right: none. */
typedef struct fast_box {
  int32_t left, top, right, bottom; /* inclusive */
} fast_box;

/* The faces of all tiles. Reused from frame to frame. */
typedef struct fast_bins {
  uint32_t tiles_across, tiles_down;
  size_t face_count;
  uint32_t *faces;   /* [face_count] boundary faces: 4 * tet + corner opposite */
  fast_box *boxes;   /* [face_count] of this frame */
  size_t tile_count; /* capacity of begin and counts */
  size_t *begin;     /* [tiles + 1] into indices */
  uint32_t *counts;  /* [ranges of faces][tiles] */
  size_t index_capacity;
  uint32_t *indices; /* into faces and boxes, by tile */
} fast_bins;

/* Finds the mesh's boundary faces. bins must be zeroed. Errors: OUT_OF_MEMORY. */
cellist_result fast_bins_create(cellist_context *context, const cellist_mesh_arrays *mesh, fast_bins *bins);
void fast_bins_release(cellist_context *context, fast_bins *bins);

/* Sorts the faces into tiles for a frame. Errors: OUT_OF_MEMORY. Cost: linear in faces and tiles. */
cellist_result fast_bins_fill(cellist_context *context, const fast_scene *scene, fast_bins *bins);

typedef struct fast_entry {
  float z;
  uint32_t face; /* 4 * tet + corner opposite */
  uint32_t next; /* the ray's next entry, farther away; CELLIST_NONE: none */
} fast_entry;

/* What a pixel's ray found. */
typedef struct fast_pixel {
  fast_light light;
  float z, z_back; /* scene depths; z > z_back: nothing seen. Only with wants_depth */
  uint32_t cell_count, piece_count;
} fast_pixel;

/* One tile at work; each worker has one. */
typedef struct fast_tile {
  uint32_t left, top, width, height; /* of its pixels in the image */
  size_t entry_count, entry_capacity;
  fast_entry *entries;
  uint32_t first[FAST_TILE_PIXELS];                    /* entry; CELLIST_NONE: the ray misses the mesh */
  float near[FAST_TILE_PIXELS], far[FAST_TILE_PIXELS]; /* scene depths between which rays are seen; if it clips */
  fast_pixel pixels[FAST_TILE_PIXELS];
  size_t retry_count;
  uint16_t retries[FAST_TILE_PIXELS]; /* pixels whose ray got lost: to be cast by other means */
  uint64_t step_count, fold_ray_count;
} fast_tile;

/* Fills `first` and `entries` of the tile. Returns false if there was no memory. */
bool fast_tile_find_entries(cellist_context *context, const fast_scene *scene, const fast_bins *bins, size_t tile_index,
                            fast_tile *tile);

/* Pixels of a tile in the order in which rays are walked: a Z curve, so that the rays of a vector stay close together.
 * i: 0..FAST_TILE_PIXELS-1. */
static inline uint32_t fast_tile_pixel(uint32_t i) {
  uint32_t x = 0, y = 0;
  for (uint32_t bit = 0; bit < 5; bit++) {
    x |= (i >> (2 * bit) & 1) << bit;
    y |= (i >> (2 * bit + 1) & 1) << bit;
  }
  return y * FAST_TILE + x;
}

#endif
