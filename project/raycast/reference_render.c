/* SPDX-License-Identifier: BSD-3-Clause
 * Reference render: rays in tiles, shared out among the workers. A pixel depends on its own ray alone and counts are
 * integers, so nothing depends on who drew what. */
#include <math.h>
#include <stdatomic.h>

#include "raycaster.h"
#include "reference_shade.h"
#include "reference_walk.h"

/* Pixels along a tile's side; small enough to share out a small picture, large enough to keep cells in the cache. */
enum { TILE = 16 };

/* How often progress is reported at most, and cancelling possible. */
enum { STAGES = 32 };

/* Where a pixel's values go in an image; NULL: the image has no such channel. */
struct planes {
  float *colour[3], *alpha, *z, *z_back, *transmittance, *cells, *segments;
};

struct job {
  cellist_raycaster *caster;
  const cellist_frame *frame;
  const cellist_transfer *transfer;
  const cellist_optics *optics;
  const cellist_raycast_output *output;
  struct planes planes;
  size_t first_tile;   /* of the stage */
  ray_walker *walkers; /* one per worker */
  uint64_t *segment_counts;
  atomic_bool failed;
};

static struct planes planes_of(const cellist_image *image) {
  struct planes planes = {0};
  if (image == NULL) return planes;
  static const char *const COLOUR[3] = {"R", "G", "B"};
  for (int k = 0; k < 3; k++) planes.colour[k] = cellist_image_channel(image, COLOUR[k]);
  planes.alpha = cellist_image_channel(image, "A");
  planes.z = cellist_image_channel(image, "Z");
  planes.z_back = cellist_image_channel(image, "ZBack");
  planes.transmittance = cellist_image_channel(image, "transmittance.Y");
  planes.cells = cellist_image_channel(image, "cells.Y");
  planes.segments = cellist_image_channel(image, "segments.Y");
  return planes;
}

static void put(float *plane, size_t at, double value) {
  if (plane != NULL) plane[at] = (float)value;
}

static void store(const struct job *job, size_t at, const shade_pixel *pixel, uint32_t cell_count) {
  const cellist_raycast_output *output = job->output;
  for (int k = 0; k < 3; k++) {
    if (output->rgba != NULL) output->rgba[4 * at + (size_t)k] = pixel->colour[k];
    put(job->planes.colour[k], at, pixel->colour[k]);
  }
  if (output->rgba != NULL) output->rgba[4 * at + 3] = pixel->alpha;
  if (output->transmittance != NULL) output->transmittance[at] = pixel->transmittance;
  if (output->z != NULL) output->z[at] = pixel->z;
  if (output->z_back != NULL) output->z_back[at] = pixel->z_back;
  if (output->cell_count != NULL) output->cell_count[at] = cell_count;
  if (output->segment_count != NULL) output->segment_count[at] = pixel->segment_count;
  put(job->planes.alpha, at, pixel->alpha);
  put(job->planes.z, at, pixel->z);
  put(job->planes.z_back, at, pixel->z_back);
  put(job->planes.transmittance, at, pixel->transmittance);
  put(job->planes.cells, at, cell_count);
  put(job->planes.segments, at, pixel->segment_count);
}

static void draw_pixel(struct job *job, uint32_t x, uint32_t y, unsigned worker) {
  ray_walker *walker = &job->walkers[worker];
  double origin[3], direction[3];
  cellist_frame_ray(job->frame, x + 0.5, y + 0.5, origin, direction);
  if (!walk_ray(walker, origin, direction, job->frame->near_distance)) {
    atomic_store(&job->failed, true);
    return;
  }
  const double length_per_t = hypot(hypot(direction[0], direction[1]), direction[2]);
  const shade_pixel pixel =
      shade_segments(job->optics, job->transfer, walker->segments, walker->segment_count, length_per_t);
  job->segment_counts[worker] += pixel.segment_count;
  store(job, (size_t)y * job->frame->width + x, &pixel, walker->ray_steps);
}

static void draw_tiles(void *user, size_t begin, size_t end, unsigned worker) {
  struct job *job = user;
  const uint32_t width = job->frame->width, height = job->frame->height, across = (width + TILE - 1) / TILE;
  for (size_t tile = job->first_tile + begin; tile < job->first_tile + end && !atomic_load(&job->failed); tile++) {
    const uint32_t left = (uint32_t)(tile % across) * TILE, top = (uint32_t)(tile / across) * TILE;
    for (uint32_t y = top; y < height && y < top + TILE; y++)
      for (uint32_t x = left; x < width && x < left + TILE; x++) draw_pixel(job, x, y, worker);
  }
}

static cellist_result draw_all(cellist_context *context, struct job *job) {
  const size_t across = (job->frame->width + TILE - 1) / TILE, down = (job->frame->height + TILE - 1) / TILE;
  const size_t tile_count = across * down, stage_size = (tile_count + STAGES - 1) / STAGES;
  cellist_result result = cellist_progress(context, "casting", 0);
  while (job->first_tile < tile_count && result == CELLIST_SUCCESS) {
    const size_t left = tile_count - job->first_tile, count = left < stage_size ? left : stage_size;
    cellist_parallel_for(context, count, 1, draw_tiles, job);
    if (atomic_load(&job->failed)) return CELLIST_ERROR_OUT_OF_MEMORY; /* the worker left the message */
    job->first_tile += count;
    result = cellist_progress(context, "casting", (double)job->first_tile / (double)tile_count);
  }
  return result;
}

static void sum_up(const struct job *job, unsigned worker_count, cellist_raycast_stats *stats) {
  for (unsigned i = 0; i < worker_count; i++) {
    const ray_walker *walker = &job->walkers[i];
    stats->ray_count += walker->ray_count;
    stats->entry_count += walker->total_entries;
    stats->step_count += walker->step_count;
    stats->segment_count += job->segment_counts[i];
    stats->retry_count += walker->retry_count;
    stats->fold_ray_count += walker->fold_ray_count;
  }
  stats->error_bound = HUGE_VAL;
}

cellist_result raycaster_render_reference(cellist_raycaster *caster, const cellist_frame *frame,
                                          const cellist_transfer *transfer, const cellist_optics *optics,
                                          const cellist_raycast_output *output, cellist_raycast_stats *stats) {
  cellist_context *context = caster->context;
  if (!caster->has_hierarchy) {
    const cellist_result result = hierarchy_build(context, cellist_mesh_get_arrays(caster->mesh), &caster->hierarchy);
    if (result != CELLIST_SUCCESS) return result;
    caster->has_hierarchy = true;
  }
  const unsigned worker_count = cellist_context_worker_count(context);
  struct job job = {.caster = caster, .frame = frame, .transfer = transfer, .optics = optics, .output = output};
  job.planes = planes_of(output->image);
  atomic_init(&job.failed, false);
  job.walkers = cellist_allocate_zeroed(context, worker_count, sizeof *job.walkers);
  job.segment_counts = cellist_allocate_zeroed(context, worker_count, sizeof *job.segment_counts);
  cellist_result result = CELLIST_ERROR_OUT_OF_MEMORY;
  if (job.walkers != NULL && job.segment_counts != NULL) {
    for (unsigned i = 0; i < worker_count; i++) {
      job.walkers[i].context = context;
      job.walkers[i].mesh = cellist_mesh_get_arrays(caster->mesh);
      job.walkers[i].scalar = caster->scalar;
      job.walkers[i].hierarchy = &caster->hierarchy;
    }
    result = draw_all(context, &job);
    sum_up(&job, worker_count, stats);
    for (unsigned i = 0; i < worker_count; i++) walk_release(&job.walkers[i]);
  }
  cellist_deallocate(context, job.walkers);
  cellist_deallocate(context, job.segment_counts);
  return result;
}
