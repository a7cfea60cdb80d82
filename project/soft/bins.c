/* SPDX-License-Identifier: BSD-3-Clause
 * Bins: points to the image, cells to rectangles of pixels, rectangles to tiles.
 *
 * The order is cut into chunks of a fixed size. Each counts its cells in every tile; sums over tiles and chunks say
 * where each chunk's entries go; then each writes them. So a tile's entries are ascending, and the same for any number
 * of workers. */
#include "bins.h"

#include <math.h>
#include <string.h>

/* Places are rounded to floats (1/256 pixel in the largest image): rectangles are this much larger. */
static const float MARGIN = 1.0f / 64;

/* Places are cut off here, far outside every image, where floats are still exact to more than an image. */
static const double FAR_OUT = 1e9;

enum { POINT_GRAIN = 4096, LEAST_CHUNK = 8192, MOST_CHUNKS = 256 };

struct job {
  const soft_bins_input *input;
  const soft_scene *scene;
  soft_bins *bins;
  size_t chunk_size, chunk_count, tile_count;
};

static void place_points(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  const soft_scene *scene = job->scene;
  const cellist_frame *frame = job->input->frame;
  for (size_t i = begin; i < end; i++) {
    double offset[3];
    for (int k = 0; k < 3; k++) offset[k] = (job->input->positions[3 * i + (size_t)k] - frame->eye[k]) / scene->unit;
    soft_vertex *v = &job->bins->vertices[i];
    const double *const axis[3] = {frame->right, frame->up, frame->forward};
    double seen[3];
    for (int k = 0; k < 3; k++) seen[k] = axis[k][0] * offset[0] + axis[k][1] * offset[1] + axis[k][2] * offset[2];
    *v = (soft_vertex){seen[0], seen[1], seen[2], job->input->point_scalars != NULL ? job->input->point_scalars[i] : 0};
    const double inverse = scene->parallel ? 1 : v->z > 0 ? 1 / v->z : NAN;
    /* Pixel i's centre is at i: see soft_scene. */
    const double x = (v->x * inverse - scene->across) / scene->across_step;
    const double y = (v->y * inverse - scene->upward) / scene->upward_step;
    job->bins->places[i].x = (float)(isnan(x) ? x : fmin(fmax(x, -FAR_OUT), FAR_OUT));
    job->bins->places[i].y = (float)(isnan(y) ? y : fmin(fmax(y, -FAR_OUT), FAR_OUT));
  }
}

/* What a cell through the eye's plane covers: on the way to that plane its picture grows beyond all bounds, towards the
 * side on which an edge crosses the plane; elsewhere points in front bound it. low, high: x y in pixels. */
static void bound_through_eye(const struct job *job, const uint32_t tet[4], float low[2], float high[2]) {
  const soft_vertex *v[4];
  for (int k = 0; k < 4; k++) v[k] = &job->bins->vertices[tet[k]];
  for (int i = 0; i < 4; i++) {
    if (!(v[i]->z > 0)) continue;
    const soft_place place = job->bins->places[tet[i]];
    low[0] = fminf(low[0], place.x);
    high[0] = fmaxf(high[0], place.x);
    low[1] = fminf(low[1], place.y);
    high[1] = fmaxf(high[1], place.y);
    for (int j = 0; j < 4; j++) {
      if (v[j]->z > 0) continue;
      const double x = v[i]->z * v[j]->x - v[j]->z * v[i]->x, y = v[i]->z * v[j]->y - v[j]->z * v[i]->y;
      if (x >= 0) high[0] = HUGE_VALF;
      if (x <= 0) low[0] = -HUGE_VALF;
      if (y >= 0) low[1] = -HUGE_VALF; /* up is towards row 0 */
      if (y <= 0) high[1] = HUGE_VALF;
    }
  }
}

static soft_rect rect_of(const struct job *job, const uint32_t tet[4]) {
  static const soft_rect nothing = {1, 1, 0, 0};
  const soft_place *places = job->bins->places;
  float low[2] = {HUGE_VALF, HUGE_VALF}, high[2] = {-HUGE_VALF, -HUGE_VALF};
  bool through_eye = false;
  for (int k = 0; k < 4; k++) {
    const soft_place place = places[tet[k]];
    through_eye = through_eye || isnan(place.x);
    low[0] = place.x < low[0] ? place.x : low[0];
    low[1] = place.y < low[1] ? place.y : low[1];
    high[0] = place.x > high[0] ? place.x : high[0];
    high[1] = place.y > high[1] ? place.y : high[1];
  }
  if (through_eye) bound_through_eye(job, tet, low, high);
  const float right = (float)(job->scene->width - 1), bottom = (float)(job->scene->height - 1);
  const float x0 = ceilf(low[0] - MARGIN), x1 = floorf(high[0] + MARGIN);
  const float y0 = ceilf(low[1] - MARGIN), y1 = floorf(high[1] + MARGIN);
  if (!(x0 <= x1 && y0 <= y1 && x0 <= right && y0 <= bottom && x1 >= 0 && y1 >= 0)) return nothing;
  return (soft_rect){(uint16_t)(x0 > 0 ? x0 : 0), (uint16_t)(y0 > 0 ? y0 : 0), (uint16_t)(x1 < right ? x1 : right),
                     (uint16_t)(y1 < bottom ? y1 : bottom)};
}

static void count_chunks(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  for (size_t chunk = begin; chunk < end; chunk++) {
    const size_t first = chunk * job->chunk_size, left = job->input->order_count - first;
    const size_t last = first + (left < job->chunk_size ? left : job->chunk_size);
    for (size_t i = first; i < last; i++) {
      const uint32_t cell = job->scene->order[i];
      soft_rect rect = {1, 1, 0, 0};
      if (cell < job->input->tet_count && job->input->is_drawn[cell])
        rect = rect_of(job, &job->scene->tets[4 * (size_t)cell]);
      job->bins->rects[i] = rect;
      if (rect.x0 > rect.x1) continue;
      for (size_t y = rect.y0 / SOFT_TILE; y <= rect.y1 / SOFT_TILE; y++)
        for (size_t x = rect.x0 / SOFT_TILE; x <= rect.x1 / SOFT_TILE; x++)
          job->bins->counts[chunk * job->tile_count + y * job->scene->tiles_across + x]++;
    }
  }
}

static void write_chunks(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  for (size_t chunk = begin; chunk < end; chunk++) {
    const size_t first = chunk * job->chunk_size, left = job->input->order_count - first;
    const size_t last = first + (left < job->chunk_size ? left : job->chunk_size);
    size_t *next = &job->bins->counts[chunk * job->tile_count];
    for (size_t i = first; i < last; i++) {
      const soft_rect rect = job->bins->rects[i];
      if (rect.x0 > rect.x1) continue;
      for (size_t y = rect.y0 / SOFT_TILE; y <= rect.y1 / SOFT_TILE; y++)
        for (size_t x = rect.x0 / SOFT_TILE; x <= rect.x1 / SOFT_TILE; x++)
          job->bins->entries[next[y * job->scene->tiles_across + x]++] = (uint32_t)i;
    }
  }
}

/* Makes room for count elements; what was there is lost. */
static bool reserve(cellist_context *context, void **block, size_t *capacity, size_t count, size_t size) {
  if (count <= *capacity && *block != NULL) return true;
  cellist_deallocate(context, *block);
  *capacity = 0;
  *block = cellist_allocate(context, count, size);
  if (*block == NULL) return false;
  *capacity = count;
  return true;
}

static bool reserve_frame(const struct job *job) {
  soft_bins *bins = job->bins;
  cellist_context *context = job->input->context;
  void *rects = bins->rects, *counts = bins->counts, *tile_begin = bins->tile_begin;
  bool ok = reserve(context, &rects, &bins->rect_capacity, job->input->order_count, sizeof *bins->rects);
  bins->rects = rects;
  ok = reserve(context, &counts, &bins->count_capacity, job->chunk_count * job->tile_count, sizeof *bins->counts) && ok;
  bins->counts = counts;
  ok = reserve(context, &tile_begin, &bins->tile_capacity, job->tile_count + 1, sizeof *bins->tile_begin) && ok;
  bins->tile_begin = tile_begin;
  if (bins->vertices == NULL)
    bins->vertices = cellist_allocate(context, job->input->point_count, sizeof *bins->vertices);
  if (bins->places == NULL) bins->places = cellist_allocate(context, job->input->point_count, sizeof *bins->places);
  return ok && bins->vertices != NULL && bins->places != NULL;
}

cellist_result soft_bins_make(soft_bins *bins, const soft_bins_input *input, soft_scene *scene, size_t *cell_count) {
  cellist_context *context = input->context;
  struct job job = {.input = input, .scene = scene, .bins = bins};
  const size_t down = (scene->height + SOFT_TILE - 1) / SOFT_TILE;
  job.tile_count = scene->tiles_across * down;
  job.chunk_size = input->order_count / MOST_CHUNKS + 1;
  if (job.chunk_size < LEAST_CHUNK) job.chunk_size = LEAST_CHUNK;
  job.chunk_count = (input->order_count + job.chunk_size - 1) / job.chunk_size;
  if (!reserve_frame(&job)) return CELLIST_ERROR_OUT_OF_MEMORY;
  memset(bins->counts, 0, job.chunk_count * job.tile_count * sizeof *bins->counts);
  cellist_parallel_for(context, input->point_count, POINT_GRAIN, place_points, &job);
  cellist_parallel_for(context, job.chunk_count, 1, count_chunks, &job);
  size_t total = 0;
  for (size_t tile = 0; tile < job.tile_count; tile++) {
    bins->tile_begin[tile] = total;
    for (size_t chunk = 0; chunk < job.chunk_count; chunk++) {
      size_t *count = &bins->counts[chunk * job.tile_count + tile];
      const size_t here = *count;
      *count = total;
      total += here;
    }
  }
  bins->tile_begin[job.tile_count] = total;
  void *entries = bins->entries;
  const bool ok = reserve(context, &entries, &bins->entry_capacity, total, sizeof *bins->entries);
  bins->entries = entries;
  if (!ok) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_parallel_for(context, job.chunk_count, 1, write_chunks, &job);
  *cell_count = 0;
  for (size_t i = 0; i < input->order_count; i++) *cell_count += bins->rects[i].x0 <= bins->rects[i].x1;
  scene->vertices = bins->vertices;
  scene->rects = bins->rects;
  scene->entries = bins->entries;
  scene->tile_begin = bins->tile_begin;
  return CELLIST_SUCCESS;
}

void soft_bins_release(cellist_context *context, soft_bins *bins) {
  cellist_deallocate(context, bins->vertices);
  cellist_deallocate(context, bins->places);
  cellist_deallocate(context, bins->rects);
  cellist_deallocate(context, bins->counts);
  cellist_deallocate(context, bins->tile_begin);
  cellist_deallocate(context, bins->entries);
  *bins = (soft_bins){0};
}
