/* SPDX-License-Identifier: BSD-3-Clause
 * Bins: points to the image, cells to rectangles of pixels, rectangles to tiles.
 *
 * Rectangles are made in the mesh's order, where memory is read once and in line (bounds.h); only they are fetched in
 * the order of visibility.
 * The order is cut into chunks of a fixed size. Each counts its cells in every tile; sums over tiles and chunks say
 * where each chunk's entries go; then each writes them. So a tile's entries are ascending, and the same for any number
 * of workers. */
#include "bins.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Places are cut off here, far outside every image, where floats are still exact to more than an image. */
static const double FAR_OUT = 1e9;

enum { POINT_GRAIN = 4096, TET_GRAIN = 8192, LEAST_CHUNK = 8192, MOST_CHUNKS = 256 };

/* Rectangles are fetched this many cells ahead. */
enum { AHEAD = 16 };

struct job {
  const soft_bins_input *input;
  const soft_scene *scene;
  soft_bins *bins;
  size_t chunk_size, chunk_count, tile_count;
  atomic_bool through_eye; /* a point lies behind the eye */
  atomic_size_t cell_count;
};

static void place_points(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct job *job = user;
  const soft_scene *scene = job->scene;
  const cellist_frame *frame = job->input->frame;
  bool through_eye = false;
  for (size_t i = begin; i < end; i++) {
    double offset[3];
    for (int k = 0; k < 3; k++) offset[k] = (job->input->positions[3 * i + (size_t)k] - frame->eye[k]) / scene->unit;
    soft_vertex *v = &job->bins->vertices[i];
    const double *const axis[3] = {frame->right, frame->up, frame->forward};
    double seen[3];
    for (int k = 0; k < 3; k++) seen[k] = axis[k][0] * offset[0] + axis[k][1] * offset[1] + axis[k][2] * offset[2];
    *v = (soft_vertex){seen[0], seen[1], seen[2],
                       job->input->point_scalars != NULL ? soft_scalar(scene, job->input->point_scalars[i]) : 0};
    soft_place *place = &job->bins->places[i];
    if (!scene->parallel && !(v->z > 0)) {
      through_eye = true;
      *place = (soft_place){HUGE_VALF, HUGE_VALF, HUGE_VALF, HUGE_VALF};
      continue;
    }
    const double inverse = scene->parallel ? 1 : 1 / v->z;
    /* Pixel i's centre is at i: see soft_scene. */
    const double x = (v->x * inverse - scene->across) / scene->across_step;
    const double y = (v->y * inverse - scene->upward) / scene->upward_step;
    const float px = (float)(x < -FAR_OUT ? -FAR_OUT : x < FAR_OUT ? x : FAR_OUT);
    const float py = (float)(y < -FAR_OUT ? -FAR_OUT : y < FAR_OUT ? y : FAR_OUT);
    *place = (soft_place){px, py, -px, -py};
  }
  if (through_eye) atomic_store(&job->through_eye, true);
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

/* For a tet with a point behind the eye. */
static soft_rect rect_through_eye(const struct job *job, const uint32_t tet[4]) {
  static const soft_rect nothing = {1, 1, 0, 0};
  float low[2] = {HUGE_VALF, HUGE_VALF}, high[2] = {-HUGE_VALF, -HUGE_VALF};
  bound_through_eye(job, tet, low, high);
  const float right = (float)(job->scene->width - 1), bottom = (float)(job->scene->height - 1);
  const float x0 = floorf(low[0]), x1 = ceilf(high[0]), y0 = floorf(low[1]), y1 = ceilf(high[1]);
  if (!(x0 <= x1 && y0 <= y1 && x0 <= right && y0 <= bottom && x1 >= 0 && y1 >= 0)) return nothing;
  return (soft_rect){(uint16_t)(x0 > 0 ? x0 : 0), (uint16_t)(y0 > 0 ? y0 : 0), (uint16_t)(x1 < right ? x1 : right),
                     (uint16_t)(y1 < bottom ? y1 : bottom)};
}

/* A scalar per cell has no isosurfaces. */
static bool meets_iso(const struct job *job, const uint32_t tet[4]) {
  if (job->scene->cell_scalars != NULL) return false;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int k = 0; k < 4; k++) {
    const double s = job->bins->vertices[tet[k]].s;
    low = s < low ? s : low;
    high = s > high ? s : high;
  }
  return soft_model_meets_iso(&job->scene->model, low, high);
}

static void bound_cells(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  const uint32_t *tets = job->scene->tets;
  const soft_place *places = job->bins->places;
  soft_rect *rects = job->bins->rects;
  job->input->bound(tets, (const float(*)[4])(const void *)places, begin, end, job->scene->width, job->scene->height,
                    rects);
  if (atomic_load(&job->through_eye))
    for (size_t i = begin; i < end; i++) {
      bool through = false;
      for (size_t k = 0; k < 4; k++) through = through || places[tets[4 * i + k]].x == HUGE_VALF;
      if (through) rects[i] = rect_through_eye(job, &tets[4 * i]);
    }
  const bool by_iso = job->scene->model.model == CELLIST_MODEL_ISOSURFACES;
  for (size_t i = begin; i < end; i++)
    if (!job->input->is_drawn[i] || (by_iso && !meets_iso(job, &tets[4 * i]))) rects[i] = (soft_rect){1, 1, 0, 0};
}

/* The rectangle of a place in the order; none for cells that are not the mesh's. */
static inline soft_rect rect_at(const struct job *job, size_t place) {
  const uint32_t cell = job->scene->order[place];
  if (place + AHEAD < job->input->order_count && job->scene->order[place + AHEAD] < job->input->tet_count)
    __builtin_prefetch(&job->bins->rects[job->scene->order[place + AHEAD]]);
  return cell < job->input->tet_count ? job->bins->rects[cell] : (soft_rect){1, 1, 0, 0};
}

static void count_chunks(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct job *job = user;
  for (size_t chunk = begin; chunk < end; chunk++) {
    const size_t first = chunk * job->chunk_size, left = job->input->order_count - first;
    const size_t last = first + (left < job->chunk_size ? left : job->chunk_size);
    size_t *counts = &job->bins->counts[chunk * job->tile_count], cell_count = 0;
    for (size_t i = first; i < last; i++) {
      const soft_rect rect = rect_at(job, i);
      if (rect.x0 > rect.x1) continue;
      cell_count++;
      for (size_t y = rect.y0 / SOFT_TILE; y <= rect.y1 / SOFT_TILE; y++)
        for (size_t x = rect.x0 / SOFT_TILE; x <= rect.x1 / SOFT_TILE; x++) counts[y * job->scene->tiles_across + x]++;
    }
    atomic_fetch_add(&job->cell_count, cell_count);
  }
}

static void write_chunks(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  uint32_t *entry_places = job->scene->group_count > 0 ? job->bins->entry_places : NULL;
  for (size_t chunk = begin; chunk < end; chunk++) {
    const size_t first = chunk * job->chunk_size, left = job->input->order_count - first;
    const size_t last = first + (left < job->chunk_size ? left : job->chunk_size);
    size_t *next = &job->bins->counts[chunk * job->tile_count];
    for (size_t i = first; i < last; i++) {
      const soft_rect rect = rect_at(job, i);
      if (rect.x0 > rect.x1) continue;
      for (size_t y = rect.y0 / SOFT_TILE; y <= rect.y1 / SOFT_TILE; y++)
        for (size_t x = rect.x0 / SOFT_TILE; x <= rect.x1 / SOFT_TILE; x++) {
          const size_t at = next[y * job->scene->tiles_across + x]++;
          job->bins->entries[at] = job->scene->order[i];
          if (entry_places != NULL) entry_places[at] = (uint32_t)i;
        }
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
  void *counts = bins->counts, *tile_begin = bins->tile_begin;
  bool ok = reserve(context, &counts, &bins->count_capacity, job->chunk_count * job->tile_count, sizeof *bins->counts);
  bins->counts = counts;
  ok = reserve(context, &tile_begin, &bins->tile_capacity, job->tile_count + 1, sizeof *bins->tile_begin) && ok;
  bins->tile_begin = tile_begin;
  if (bins->vertices == NULL)
    bins->vertices = cellist_allocate(context, job->input->point_count, sizeof *bins->vertices);
  if (bins->places == NULL) bins->places = cellist_allocate(context, job->input->point_count, sizeof *bins->places);
  if (bins->rects == NULL) bins->rects = cellist_allocate(context, job->input->tet_count, sizeof *bins->rects);
  return ok && bins->vertices != NULL && bins->places != NULL && bins->rects != NULL;
}

cellist_result soft_bins_make(soft_bins *bins, const soft_bins_input *input, soft_scene *scene, size_t *cell_count) {
  cellist_context *context = input->context;
  struct job job = {.input = input, .scene = scene, .bins = bins};
  atomic_init(&job.through_eye, false);
  atomic_init(&job.cell_count, 0);
  const size_t down = (scene->height + SOFT_TILE - 1) / SOFT_TILE;
  job.tile_count = scene->tiles_across * down;
  job.chunk_size = input->order_count / MOST_CHUNKS + 1;
  if (job.chunk_size < LEAST_CHUNK) job.chunk_size = LEAST_CHUNK;
  job.chunk_count = (input->order_count + job.chunk_size - 1) / job.chunk_size;
  if (!reserve_frame(&job)) return CELLIST_ERROR_OUT_OF_MEMORY;
  memset(bins->counts, 0, job.chunk_count * job.tile_count * sizeof *bins->counts);
  cellist_parallel_for(context, input->point_count, POINT_GRAIN, place_points, &job);
  cellist_parallel_for(context, input->tet_count, TET_GRAIN, bound_cells, &job);
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
  void *entries = bins->entries, *entry_places = bins->entry_places;
  bool ok = reserve(context, &entries, &bins->entry_capacity, total, sizeof *bins->entries);
  if (scene->group_count > 0)
    ok = reserve(context, &entry_places, &bins->place_capacity, total, sizeof *bins->entry_places) && ok;
  bins->entries = entries;
  bins->entry_places = entry_places;
  if (!ok) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_parallel_for(context, job.chunk_count, 1, write_chunks, &job);
  *cell_count = atomic_load(&job.cell_count);
  scene->vertices = bins->vertices;
  scene->rects = bins->rects;
  scene->entries = bins->entries;
  scene->entry_places = bins->entry_places;
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
  cellist_deallocate(context, bins->entry_places);
  *bins = (soft_bins){0};
}
