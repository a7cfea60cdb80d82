/* SPDX-License-Identifier: BSD-3-Clause
 * Fast entries: see fast_entries.h. A face is left out only where rounding cannot matter: boxes are widened, and a face
 * counts as turned away only if its area is negative beyond its rounding error. */
#include "fast_entries.h"

#include <string.h>

/* Ranges into which the faces are split. A constant, so that the order of a tile's list never changes. */
enum { RANGE_COUNT = 64 };

/* Relative rounding error of a vertex's place on the screen, several units in the last place. Smaller: a face could be
 * missed where it covers a pixel's centre by less than a rounding error; larger: more boxes to test in vain. */
static const float PLACE_ERROR = 2e-6f;

static bool is_boundary(const cellist_mesh_arrays *mesh, size_t i) { return mesh->neighbours[i] == CELLIST_NONE; }

cellist_result fast_bins_create(cellist_context *context, const cellist_mesh_arrays *mesh, fast_bins *bins) {
  size_t count = 0;
  for (size_t i = 0; i < 4 * mesh->tet_count; i++) count += is_boundary(mesh, i);
  bins->faces = cellist_allocate(context, count, sizeof *bins->faces);
  bins->boxes = cellist_allocate(context, count, sizeof *bins->boxes);
  if (bins->faces == NULL || bins->boxes == NULL) {
    fast_bins_release(context, bins);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  for (size_t i = 0; i < 4 * mesh->tet_count; i++)
    if (is_boundary(mesh, i)) bins->faces[bins->face_count++] = (uint32_t)i;
  return CELLIST_SUCCESS;
}

void fast_bins_release(cellist_context *context, fast_bins *bins) {
  cellist_deallocate(context, bins->faces);
  cellist_deallocate(context, bins->boxes);
  cellist_deallocate(context, bins->begin);
  cellist_deallocate(context, bins->counts);
  cellist_deallocate(context, bins->indices);
  *bins = (fast_bins){0};
}

struct fill {
  const fast_scene *scene;
  fast_bins *bins;
  float x_scale, y_scale; /* pixels per screen coordinate */
};

/* Pixels whose centres lie between low and high (screen coordinates), widened by the rounding error. */
static void cover(float low, float high, float first, float scale, uint32_t count, int32_t *begin, int32_t *end) {
  const float a = (low - first) * scale, b = (high - first) * scale;
  const float error = PLACE_ERROR * (fabsf(a) + fabsf(b) + fabsf(first * scale)) + 1e-3f;
  const float from = fminf(a, b) - error, to = fmaxf(a, b) + error;
  /* Comparisons are written so that a NaN (a vertex in the eye's plane) covers everything. */
  *begin = from > 0 ? (from < (float)count ? (int32_t)ceilf(from) : (int32_t)count) : 0;
  *end = to < (float)count - 1 ? (to >= 0 ? (int32_t)floorf(to) : -1) : (int32_t)count - 1;
}

/* Which pixels a face may cover with its front. */
static fast_box box_of(const struct fill *fill, uint32_t face) {
  const fast_scene *scene = fill->scene;
  static const fast_box NOWHERE = {0, 0, -1, -1};
  const uint32_t *v = &scene->tets[4 * (size_t)(face >> 2)];
  const uint8_t *corner = CELLIST_TET_FACE[face & 3];
  float x[3], y[3];
  int behind = 0;
  for (int k = 0; k < 3; k++) {
    const fast_vertex p = scene->vertices[v[corner[k]]];
    x[k] = scene->sheared ? p.x / p.a : p.x;
    y[k] = scene->sheared ? p.y / p.a : p.y;
    behind += scene->sheared && !(p.a > 0);
  }
  if (behind != 0 && behind != 3) return (fast_box){0, 0, (int32_t)scene->width - 1, (int32_t)scene->height - 1};
  const float left = (x[1] - x[0]) * (y[2] - y[0]), right = (y[1] - y[0]) * (x[2] - x[0]);
  const float size = fabsf(x[0]) + fabsf(x[1]) + fabsf(x[2]) + fabsf(y[0]) + fabsf(y[1]) + fabsf(y[2]);
  const float reach = fabsf(x[1] - x[0]) + fabsf(x[2] - x[0]) + fabsf(y[1] - y[0]) + fabsf(y[2] - y[0]);
  /* Seen through the eye, behind it, a face keeps its orientation: all three x and y change their sign. */
  if (left - right < -4 * PLACE_ERROR * size * reach) return NOWHERE;
  fast_box box;
  cover(fminf(x[0], fminf(x[1], x[2])), fmaxf(x[0], fmaxf(x[1], x[2])), scene->ray_x[0], fill->x_scale, scene->width,
        &box.left, &box.right);
  cover(fminf(y[0], fminf(y[1], y[2])), fmaxf(y[0], fmaxf(y[1], y[2])), scene->ray_y[0], fill->y_scale, scene->height,
        &box.top, &box.bottom);
  return box.left > box.right || box.top > box.bottom ? NOWHERE : box;
}

static size_t range_begin(const fast_bins *bins, size_t range) { return bins->face_count * range / RANGE_COUNT; }

static void count_ranges(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct fill *fill = user;
  fast_bins *bins = fill->bins;
  const size_t tiles = (size_t)bins->tiles_across * bins->tiles_down;
  for (size_t range = begin; range < end; range++) {
    uint32_t *counts = &bins->counts[range * tiles];
    memset(counts, 0, tiles * sizeof *counts);
    for (size_t i = range_begin(bins, range); i < range_begin(bins, range + 1); i++) {
      const fast_box box = bins->boxes[i] = box_of(fill, bins->faces[i]);
      for (int32_t ty = box.top / FAST_TILE; ty <= box.bottom / FAST_TILE && box.bottom >= 0; ty++)
        for (int32_t tx = box.left / FAST_TILE; tx <= box.right / FAST_TILE; tx++)
          counts[(uint32_t)ty * bins->tiles_across + (uint32_t)tx]++;
    }
  }
}

static void fill_ranges(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct fill *fill = user;
  fast_bins *bins = fill->bins;
  const size_t tiles = (size_t)bins->tiles_across * bins->tiles_down;
  for (size_t range = begin; range < end; range++) {
    uint32_t *next = &bins->counts[range * tiles]; /* where the range's next face of a tile goes, from begin[tile] */
    for (size_t i = range_begin(bins, range); i < range_begin(bins, range + 1); i++) {
      const fast_box box = bins->boxes[i];
      for (int32_t ty = box.top / FAST_TILE; ty <= box.bottom / FAST_TILE && box.bottom >= 0; ty++)
        for (int32_t tx = box.left / FAST_TILE; tx <= box.right / FAST_TILE; tx++) {
          const size_t tile = (uint32_t)ty * bins->tiles_across + (uint32_t)tx;
          bins->indices[bins->begin[tile] + next[tile]++] = (uint32_t)i;
        }
    }
  }
}

static cellist_result reserve_tiles(cellist_context *context, fast_bins *bins, size_t tiles) {
  if (tiles <= bins->tile_count) return CELLIST_SUCCESS;
  cellist_deallocate(context, bins->begin);
  cellist_deallocate(context, bins->counts);
  bins->tile_count = 0;
  bins->begin = cellist_allocate(context, tiles + 1, sizeof *bins->begin);
  bins->counts = cellist_allocate(context, tiles, RANGE_COUNT * sizeof *bins->counts);
  if (bins->begin == NULL || bins->counts == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  bins->tile_count = tiles;
  return CELLIST_SUCCESS;
}

cellist_result fast_bins_fill(cellist_context *context, const fast_scene *scene, fast_bins *bins) {
  bins->tiles_across = (scene->width + FAST_TILE - 1) / FAST_TILE;
  bins->tiles_down = (scene->height + FAST_TILE - 1) / FAST_TILE;
  const size_t tiles = (size_t)bins->tiles_across * bins->tiles_down;
  if (reserve_tiles(context, bins, tiles) != CELLIST_SUCCESS) return CELLIST_ERROR_OUT_OF_MEMORY;
  struct fill fill = {.scene = scene, .bins = bins};
  const uint32_t w = scene->width, h = scene->height;
  fill.x_scale = w > 1 ? (float)(w - 1) / (scene->ray_x[w - 1] - scene->ray_x[0]) : INFINITY;
  fill.y_scale = h > 1 ? (float)(h - 1) / (scene->ray_y[h - 1] - scene->ray_y[0]) : INFINITY;
  cellist_parallel_for(context, RANGE_COUNT, 1, count_ranges, &fill);
  size_t total = 0;
  for (size_t tile = 0; tile < tiles; tile++) {
    bins->begin[tile] = total;
    uint32_t before = 0;
    for (size_t range = 0; range < RANGE_COUNT; range++) {
      const uint32_t count = bins->counts[range * tiles + tile];
      bins->counts[range * tiles + tile] = before;
      before += count;
    }
    total += before;
  }
  bins->begin[tiles] = total;
  if (total > bins->index_capacity) {
    cellist_deallocate(context, bins->indices);
    bins->index_capacity = 0;
    bins->indices = cellist_allocate(context, total + total / 4, sizeof *bins->indices);
    if (bins->indices == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    bins->index_capacity = total + total / 4;
  }
  cellist_parallel_for(context, RANGE_COUNT, 1, fill_ranges, &fill);
  return CELLIST_SUCCESS;
}

static bool add_entry(cellist_context *context, fast_tile *tile, uint32_t pixel, uint32_t face, float z) {
  if (tile->entry_count == tile->entry_capacity) {
    const size_t capacity = tile->entry_capacity == 0 ? 4 * FAST_TILE_PIXELS : 2 * tile->entry_capacity;
    fast_entry *grown =
        cellist_reallocate(context, tile->entries, tile->entry_capacity, capacity, sizeof *tile->entries);
    if (grown == NULL) return false;
    tile->entries = grown;
    tile->entry_capacity = capacity;
  }
  uint32_t *link = &tile->first[pixel];
  while (*link != CELLIST_NONE && tile->entries[*link].z <= z) link = &tile->entries[*link].next;
  tile->entries[tile->entry_count] = (fast_entry){z, face, *link};
  *link = (uint32_t)tile->entry_count++;
  return true;
}

/* Whether a face that spans the tile (or the whole image, if it crosses the eye's plane) passes it by: all four corner
 * rays lie clearly outside of one and the same edge. */
static bool passes_by(const fast_scene *scene, const fast_tile *tile, const uint32_t id[3]) {
  const float rx[2] = {scene->ray_x[tile->left], scene->ray_x[tile->left + tile->width - 1]};
  const float ry[2] = {scene->ray_y[tile->top], scene->ray_y[tile->top + tile->height - 1]};
  int outside[3] = {0};
  for (int c = 0; c < 4; c++) {
    fast_point p[3];
    for (int k = 0; k < 3; k++) p[k] = fast_see(scene, id[k], rx[c & 1], ry[c >> 1]);
    for (int k = 0; k < 3; k++) {
      const fast_point *a = &p[k], *b = &p[k < 2 ? k + 1 : 0];
      const float error = 4 * PLACE_ERROR * (fabsf(a->x) + fabsf(a->y) + fabsf(a->a) + 1) *
                          (fabsf(b->x) + fabsf(b->y) + fabsf(b->a) + 1);
      outside[k] += a->x * b->y - a->y * b->x < -error;
    }
  }
  return outside[0] == 4 || outside[1] == 4 || outside[2] == 4;
}

/* As fast_enter, for many rays at one face: whether a ray enters there, and how deep. */
static inline bool enters(const fast_scene *scene, const fast_vertex v[3], const uint32_t id[3], float rx, float ry,
                          float *z) {
  fast_point p[3];
  float w[3];
  for (int k = 0; k < 3; k++) p[k] = fast_see_vertex(scene, v[k], rx, ry);
  for (int k = 0; k < 3; k++) {
    const int i = k < 2 ? k + 1 : 0, j = k > 0 ? k - 1 : 2;
    w[k] = fast_side(p[i], p[j], id[i], id[j]);
    if (!(w[k] > 0)) return false;
  }
  *z = fast_cross(scene, p, w).z;
  return true;
}

static bool rasterise(cellist_context *context, const fast_scene *scene, fast_tile *tile, uint32_t face,
                      const fast_box *box) {
  const int32_t tile_left = (int32_t)tile->left, tile_top = (int32_t)tile->top;
  const int32_t left = box->left > tile_left ? box->left : tile_left, top = box->top > tile_top ? box->top : tile_top;
  const int32_t tile_right = tile_left + (int32_t)tile->width - 1, tile_bottom = tile_top + (int32_t)tile->height - 1;
  const int32_t right = box->right < tile_right ? box->right : tile_right;
  const int32_t bottom = box->bottom < tile_bottom ? box->bottom : tile_bottom;
  const uint32_t *v = &scene->tets[4 * (size_t)(face >> 2)];
  const uint8_t *corner = CELLIST_TET_FACE[face & 3];
  const uint32_t id[3] = {v[corner[0]], v[corner[1]], v[corner[2]]};
  const fast_vertex corners[3] = {scene->vertices[id[0]], scene->vertices[id[1]], scene->vertices[id[2]]};
  /* Where a box fills the tile, four more tests are cheap compared with a thousand. */
  if (right - left >= FAST_TILE / 2 && bottom - top >= FAST_TILE / 2 && passes_by(scene, tile, id)) return true;
  for (int32_t y = top; y <= bottom; y++)
    for (int32_t x = left; x <= right; x++) {
      float z;
      if (!enters(scene, corners, id, scene->ray_x[x], scene->ray_y[y], &z)) continue;
      if (!add_entry(context, tile, (uint32_t)((y - tile_top) * FAST_TILE + x - tile_left), face, z)) return false;
    }
  return true;
}

bool fast_tile_find_entries(cellist_context *context, const fast_scene *scene, const fast_bins *bins, size_t tile_index,
                            fast_tile *tile) {
  tile->left = (uint32_t)(tile_index % bins->tiles_across) * FAST_TILE;
  tile->top = (uint32_t)(tile_index / bins->tiles_across) * FAST_TILE;
  tile->width = scene->width - tile->left < FAST_TILE ? scene->width - tile->left : FAST_TILE;
  tile->height = scene->height - tile->top < FAST_TILE ? scene->height - tile->top : FAST_TILE;
  tile->entry_count = 0;
  memset(tile->first, 0xff, sizeof tile->first);
  for (size_t i = bins->begin[tile_index]; i < bins->begin[tile_index + 1]; i++) {
    const uint32_t index = bins->indices[i];
    if (!rasterise(context, scene, tile, bins->faces[index], &bins->boxes[index])) return false;
  }
  return true;
}
