/* SPDX-License-Identifier: BSD-3-Clause
 * Fast caster: what stays from frame to frame, the transform of the vertices, tiles and workers. */
#include <stdatomic.h>
#include <string.h>

#include "fast.h"
#include "fast_walk.h"

/* How often progress is reported, and cancelling possible, during a frame. Each costs the workers a pause. */
enum { STAGES = 4 };

/* Depths below this share of the farthest one count as behind the eye: 1/z would lose its precision in sums. */
static const double NEAREST_RECIPROCAL = 1e-4;

struct hand {
  fast_tile tile;
  uint64_t ray_count, entry_count, piece_count;
  size_t retry_count, retry_capacity;
  uint32_t *retries;
};

struct fast_caster {
  cellist_context *context;
  const cellist_mesh_arrays *mesh;
  const cellist_scalar *scalar;
  fast_cells cells;
  fast_bins bins;
  float *scalars; /* [points] or [tets], scaled */
  bool has_nan;
  fast_vertex *vertices; /* [points] of the last frame */
  float *rays;           /* ray_x, then ray_y */
  size_t ray_capacity;
  unsigned hand_count;
  struct hand *hands; /* one per worker */
  double unit;
};

/* ---- What stays ------------------------------------------------------------------------------------- */

static void scale_scalars(fast_caster *caster) {
  const fast_transfer scale = {.scalar_low = caster->scalar->minimum,
                               .scalar_half_range = 0.5 * caster->scalar->maximum - 0.5 * caster->scalar->minimum};
  for (size_t i = 0; i < caster->scalar->count; i++)
    caster->scalars[i] =
        scale.scalar_half_range > 0
            ? fast_scalar(&scale, caster->scalar->values[i])
            : (isfinite(caster->scalar->values[i]) ? 0 : NAN); /* one value: what fast_transfer_create makes 0 */
  caster->has_nan = caster->scalar->nan_cell_count > 0;
}

static cellist_result fill_caster(fast_caster *caster, fast_layout layout) {
  cellist_context *context = caster->context;
  cellist_result result = fast_cells_create(context, caster->mesh, layout, &caster->cells);
  if (result == CELLIST_SUCCESS) result = fast_bins_create(context, caster->mesh, &caster->bins);
  if (result != CELLIST_SUCCESS) return result;
  caster->scalars = cellist_allocate(context, caster->scalar->count, sizeof *caster->scalars);
  caster->vertices = cellist_allocate(context, caster->mesh->point_count, sizeof *caster->vertices);
  caster->hand_count = cellist_context_worker_count(context);
  caster->hands = cellist_allocate_zeroed(context, caster->hand_count, sizeof *caster->hands);
  if (caster->scalars == NULL || caster->vertices == NULL || caster->hands == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  scale_scalars(caster);
  double diagonal = 0;
  for (int k = 0; k < 3; k++)
    diagonal = hypot(diagonal, 0.5 * caster->mesh->bounds[3 + k] - 0.5 * caster->mesh->bounds[k]);
  caster->unit = diagonal > 0 ? diagonal : 1;
  return CELLIST_SUCCESS;
}

cellist_result fast_caster_create(cellist_context *context, const cellist_mesh_arrays *mesh,
                                  const cellist_scalar *scalar, fast_layout layout, fast_caster **caster) {
  fast_caster *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->mesh = mesh;
  created->scalar = scalar;
  const cellist_result result = fill_caster(created, layout);
  if (result == CELLIST_SUCCESS)
    *caster = created;
  else
    fast_caster_destroy(created);
  return result;
}

void fast_caster_destroy(fast_caster *caster) {
  if (caster == NULL) return;
  cellist_context *context = caster->context;
  for (unsigned i = 0; i < caster->hand_count && caster->hands != NULL; i++) {
    cellist_deallocate(context, caster->hands[i].tile.entries);
    cellist_deallocate(context, caster->hands[i].retries);
  }
  cellist_deallocate(context, caster->hands);
  cellist_deallocate(context, caster->rays);
  cellist_deallocate(context, caster->vertices);
  cellist_deallocate(context, caster->scalars);
  fast_bins_release(context, &caster->bins);
  fast_cells_release(context, &caster->cells);
  cellist_deallocate(context, caster);
}

size_t fast_caster_cell_bytes(const fast_caster *caster) {
  return caster->cells.count * FAST_CELL_SIZE[caster->cells.layout];
}
size_t fast_caster_vertex_bytes(const fast_caster *caster) {
  return caster->mesh->point_count * sizeof *caster->vertices;
}

/* ---- A frame ---------------------------------------------------------------------------------------- */

struct frame_job {
  fast_caster *caster;
  const cellist_frame *frame;
  const surface_layer *layer;
  fast_scene scene;
  fast_walk walk;
  fast_sink sink;
  void *user;
  size_t first_tile; /* of the stage */
  atomic_bool failed;
};

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void transform_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct frame_job *job = user;
  const fast_scene *scene = &job->scene;
  const cellist_frame *frame = job->frame;
  const float *scalars = scene->cell_scalars == NULL ? job->caster->scalars : NULL;
  const double scale = 1 / scene->unit;
  for (size_t i = begin; i < end; i++) {
    const double *p = &job->caster->mesh->positions[3 * i];
    const double from_eye[3] = {p[0] - frame->eye[0], p[1] - frame->eye[1], p[2] - frame->eye[2]};
    const double x = dot(from_eye, frame->right), y = dot(from_eye, frame->up), z = dot(from_eye, frame->forward);
    const float s = scalars != NULL ? scalars[i] : 0;
    fast_vertex *v = &scene->vertices[i];
    if (scene->reciprocal) {
      const double reciprocal = 1 / z, farthest = scene->depth_offset;
      *v = (fast_vertex){(float)(x * reciprocal), (float)(y * reciprocal), (float)fmin((z - farthest) * reciprocal, 0),
                         (float)(farthest * reciprocal) * s};
    } else {
      *v = (fast_vertex){(float)(x * scale), (float)(y * scale), (float)((z - scene->depth_offset) * scale), s};
    }
  }
}

/* Nearest and farthest depth of the mesh's bounds. */
static void depth_range(const double bounds[6], const cellist_frame *frame, double range[2]) {
  range[0] = INFINITY;
  range[1] = -INFINITY;
  for (int c = 0; c < 8; c++) {
    double from_eye[3];
    for (int k = 0; k < 3; k++) from_eye[k] = bounds[k + (c >> k & 1 ? 3 : 0)] - frame->eye[k];
    const double depth = dot(from_eye, frame->forward);
    range[0] = fmin(range[0], depth);
    range[1] = fmax(range[1], depth);
  }
}

static cellist_result set_up_rays(fast_caster *caster, const cellist_frame *frame, fast_scene *scene) {
  const size_t count = (size_t)frame->width + frame->height;
  if (count > caster->ray_capacity) {
    cellist_deallocate(caster->context, caster->rays);
    caster->ray_capacity = 0;
    caster->rays = cellist_allocate(caster->context, count, sizeof *caster->rays);
    if (caster->rays == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    caster->ray_capacity = count;
  }
  const double unit = frame->parallel ? scene->unit : 1;
  for (uint32_t i = 0; i < frame->width; i++)
    caster->rays[i] = (float)((2 * (i + 0.5) / frame->width - 1) * frame->half_width / unit);
  for (uint32_t i = 0; i < frame->height; i++)
    caster->rays[frame->width + i] = (float)((1 - 2 * (i + 0.5) / frame->height) * frame->half_height / unit);
  scene->ray_x = caster->rays;
  scene->ray_y = caster->rays + frame->width;
  return CELLIST_SUCCESS;
}

static cellist_result set_up_scene(fast_caster *caster, const cellist_frame *frame, const cellist_transfer *transfer,
                                   const fast_draw_desc *desc, fast_scene *scene) {
  double depth[2];
  depth_range(caster->mesh->bounds, frame, depth);
  *scene = (fast_scene){.tets = caster->mesh->tets,
                        .cells = caster->cells,
                        .vertices = caster->vertices,
                        .has_nan = caster->has_nan,
                        .wants_depth = desc->wants_depth,
                        .perspective = !frame->parallel,
                        .unit = caster->unit,
                        .width = frame->width,
                        .height = frame->height};
  if (caster->scalar->association == CELLIST_ON_CELLS) scene->cell_scalars = caster->scalars;
  scene->reciprocal = scene->perspective && depth[0] > NEAREST_RECIPROCAL * depth[1];
  scene->sheared = scene->perspective && !scene->reciprocal;
  if (frame->parallel) scene->depth_offset = 0.5 * depth[0] + 0.5 * depth[1];
  if (scene->reciprocal) scene->depth_offset = depth[1];
  scene->is_dense =
      fast_transfer_peak(transfer, caster->scalar->minimum, caster->scalar->maximum) * scene->unit > (double)FAST_DENSE;
  scene->farthest = (float)(depth[1] / scene->unit);
  scene->clips = frame->near_distance > depth[0] || frame->clip_count > 0 || desc->layer != NULL;
  const cellist_result result = set_up_rays(caster, frame, scene);
  if (result != CELLIST_SUCCESS) return result;
  return fast_transfer_create(caster->context, transfer, caster->scalar->minimum, caster->scalar->maximum, scene->unit,
                              !desc->absorption_only, &scene->transfer);
}

static bool keep_retries(cellist_context *context, const fast_scene *scene, struct hand *hand) {
  const fast_tile *tile = &hand->tile;
  const size_t wanted = hand->retry_count + tile->retry_count;
  if (wanted > hand->retry_capacity) {
    uint32_t *grown =
        cellist_reallocate(context, hand->retries, hand->retry_capacity, 2 * wanted, sizeof *hand->retries);
    if (grown == NULL) return false;
    hand->retries = grown;
    hand->retry_capacity = 2 * wanted;
  }
  for (size_t i = 0; i < tile->retry_count; i++) {
    const uint32_t at = tile->retries[i];
    hand->retries[hand->retry_count++] = (tile->top + at / FAST_TILE) * scene->width + tile->left + at % FAST_TILE;
  }
  return true;
}

/* What is seen of each ray, as the walk counts depths. */
static void set_limits(const struct frame_job *job, fast_tile *tile) {
  const fast_scene *scene = &job->scene;
  for (uint32_t y = 0; y < tile->height; y++)
    for (uint32_t x = 0; x < tile->width; x++) {
      const uint32_t at = y * FAST_TILE + x;
      if (tile->first[at] == CELLIST_NONE) continue;
      double origin[3], direction[3], limits[2];
      cellist_frame_ray(job->frame, tile->left + x + 0.5, tile->top + y + 0.5, origin, direction);
      cellist_frame_interval(job->frame, origin, direction, limits);
      if (job->layer != NULL)
        limits[1] =
            fmin(limits[1], surface_layer_limit(job->layer, (size_t)(tile->top + y) * scene->width + tile->left + x));
      tile->near[at] = (float)((limits[0] - scene->depth_offset) / scene->unit);
      tile->far[at] = (float)((limits[1] - scene->depth_offset) / scene->unit);
    }
}

static void draw_tiles(void *user, size_t begin, size_t end, unsigned worker) {
  struct frame_job *job = user;
  fast_caster *caster = job->caster;
  struct hand *hand = &caster->hands[worker];
  fast_tile *tile = &hand->tile;
  for (size_t i = job->first_tile + begin; i < job->first_tile + end && !atomic_load(&job->failed); i++) {
    tile->retry_count = 0;
    if (!fast_tile_find_entries(caster->context, &job->scene, &caster->bins, i, tile)) {
      atomic_store(&job->failed, true);
      return;
    }
    hand->entry_count += tile->entry_count;
    if (job->scene.clips) set_limits(job, tile);
    /* An empty tile has nothing to walk; an empty mesh not even the cell 0 in which idle lanes rest. */
    if (job->walk != NULL && tile->entry_count > 0) job->walk(&job->scene, tile);
    for (uint32_t at = 0; at < FAST_TILE_PIXELS; at++) {
      if (tile->first[at] == CELLIST_NONE) continue;
      hand->ray_count++;
      if (job->walk != NULL) hand->piece_count += tile->pixels[at].piece_count;
    }
    if (job->sink != NULL) job->sink(job->user, &job->scene, tile);
    if (tile->retry_count > 0 && !keep_retries(caster->context, &job->scene, hand)) atomic_store(&job->failed, true);
  }
}

static cellist_result draw_stages(fast_caster *caster, struct frame_job *job) {
  const size_t tile_count = (size_t)caster->bins.tiles_across * caster->bins.tiles_down;
  const size_t stage_size = (tile_count + STAGES - 1) / STAGES;
  cellist_result result = cellist_progress(caster->context, "casting", 0);
  while (job->first_tile < tile_count && result == CELLIST_SUCCESS) {
    const size_t left = tile_count - job->first_tile, count = left < stage_size ? left : stage_size;
    cellist_parallel_for(caster->context, count, 1, draw_tiles, job);
    if (atomic_load(&job->failed)) return CELLIST_ERROR_OUT_OF_MEMORY; /* the worker left the message */
    job->first_tile += count;
    result = cellist_progress(caster->context, "casting", (double)job->first_tile / (double)tile_count);
  }
  return result;
}

static fast_walk choose_walk(const fast_draw_desc *desc) {
  if (desc->skips_walk) return NULL;
#if defined(CELLIST_FAST_AVX2)
  if (desc->kernel == FAST_KERNEL_BEST && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    return fast_walk_avx2;
#endif
  return fast_walk_portable;
}

/* Adds up what the workers counted, and gathers their lost rays in the first one's list. */
static cellist_result sum_up(fast_caster *caster, fast_stats *stats) {
  *stats = (fast_stats){0};
  struct hand *first = &caster->hands[0];
  for (unsigned i = 0; i < caster->hand_count; i++) {
    const struct hand *hand = &caster->hands[i];
    stats->ray_count += hand->ray_count;
    stats->entry_count += hand->entry_count;
    stats->piece_count += hand->piece_count;
    stats->step_count += hand->tile.step_count;
    stats->fold_ray_count += hand->tile.fold_ray_count;
    stats->retry_count += hand->retry_count;
  }
  if (stats->retry_count > first->retry_capacity) {
    uint32_t *grown = cellist_reallocate(caster->context, first->retries, first->retry_capacity, stats->retry_count,
                                         sizeof *first->retries);
    if (grown == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    first->retries = grown;
    first->retry_capacity = stats->retry_count;
  }
  size_t at = first->retry_count;
  for (unsigned i = 1; i < caster->hand_count; i++) {
    const struct hand *hand = &caster->hands[i];
    if (hand->retry_count > 0) memcpy(&first->retries[at], hand->retries, hand->retry_count * sizeof *hand->retries);
    at += hand->retry_count;
  }
  stats->retries = first->retries;
  return CELLIST_SUCCESS;
}

cellist_result fast_caster_draw(fast_caster *caster, const cellist_frame *frame, const cellist_transfer *transfer,
                                const fast_draw_desc *desc, fast_sink sink, void *user, fast_stats *stats) {
  struct frame_job job = {
      .caster = caster, .frame = frame, .layer = desc->layer, .walk = choose_walk(desc), .sink = sink, .user = user};
  atomic_init(&job.failed, false);
  cellist_result result = set_up_scene(caster, frame, transfer, desc, &job.scene);
  if (result != CELLIST_SUCCESS) return result;
  for (unsigned i = 0; i < caster->hand_count; i++) {
    struct hand *hand = &caster->hands[i];
    hand->ray_count = hand->entry_count = hand->piece_count = 0;
    hand->retry_count = 0;
    hand->tile.step_count = hand->tile.fold_ray_count = 0;
  }
  cellist_parallel_for(caster->context, caster->mesh->point_count, 4096, transform_range, &job);
  result = fast_bins_fill(caster->context, &job.scene, &caster->bins);
  if (result == CELLIST_SUCCESS) result = draw_stages(caster, &job);
  if (result == CELLIST_SUCCESS) result = sum_up(caster, stats);
  fast_transfer_release(caster->context, &job.scene.transfer);
  return result;
}
