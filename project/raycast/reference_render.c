/* SPDX-License-Identifier: BSD-3-Clause
 * Reference render: rays in tiles, shared out among the workers. A pixel depends on its own ray alone and counts are
 * integers, so nothing depends on who drew what. */
#include <cellist/gradients.h>
#include <math.h>
#include <stdatomic.h>

#include "outputs.h"
#include "raycaster.h"
#include "reference_behind.h"
#include "reference_limits.h"
#include "reference_shade.h"
#include "reference_shift.h"
#include "reference_walk.h"
#include "slopes.h"

/* Pixels along a tile's side; small enough to share out a small picture, large enough to keep cells in the cache. */
enum { TILE = 16 };

/* How often progress is reported at most, and cancelling possible. */
enum { STAGES = 32 };

/* Single pixels that a worker takes at a time. */
enum { LISTED_GRAIN = 16 };

/* What a worker keeps. */
struct hand {
  ray_walker walker;
  uint64_t segment_count;
  double error;
};

struct job {
  cellist_raycaster *caster;
  const cellist_frame *frame;
  const shade_scene *scene;
  const behind_scene *behind;
  pixel_outputs outputs;
  const uint32_t *pixels; /* y * width + x: draw these only; NULL: the whole picture */
  size_t first_tile;      /* of the stage */
  struct hand *hands;     /* one per worker */
  atomic_bool failed;
};

static void draw_pixel(struct job *job, uint32_t x, uint32_t y, struct hand *hand) {
  ray_walker *walker = &hand->walker;
  double origin[3], direction[3];
  cellist_frame_ray(job->frame, x + 0.5, y + 0.5, origin, direction);
  walk_limits limits = limits_of_ray(job->frame, origin, direction);
  const behind_point behind = behind_meet(job->behind, origin, direction, &limits, &walker->retry_count);
  if (!walk_ray(walker, origin, direction, &limits)) {
    atomic_store(&job->failed, true);
    return;
  }
  const double length_per_t = hypot(hypot(direction[0], direction[1]), direction[2]);
  shade_pixel pixel = shade_segments(job->scene, walker->segments, walker->segment_count, length_per_t);
  behind_add(&behind, &pixel);
  hand->segment_count += pixel.segment_count;
  hand->error = fmax(hand->error, pixel.error);
  outputs_store(&job->outputs, (size_t)y * job->frame->width + x, &pixel, walker->ray_steps);
}

static void draw_tiles(void *user, size_t begin, size_t end, unsigned worker) {
  struct job *job = user;
  const uint32_t width = job->frame->width, height = job->frame->height, across = (width + TILE - 1) / TILE;
  for (size_t tile = job->first_tile + begin; tile < job->first_tile + end && !atomic_load(&job->failed); tile++) {
    const uint32_t left = (uint32_t)(tile % across) * TILE, top = (uint32_t)(tile / across) * TILE;
    for (uint32_t y = top; y < height && y < top + TILE; y++)
      for (uint32_t x = left; x < width && x < left + TILE; x++) draw_pixel(job, x, y, &job->hands[worker]);
  }
}

static void draw_listed(void *user, size_t begin, size_t end, unsigned worker) {
  struct job *job = user;
  const uint32_t width = job->frame->width;
  for (size_t i = begin; i < end && !atomic_load(&job->failed); i++)
    draw_pixel(job, job->pixels[i] % width, job->pixels[i] / width, &job->hands[worker]);
}

static cellist_result draw_all(cellist_context *context, struct job *job) {
  const size_t across = (job->frame->width + TILE - 1) / TILE, down = (job->frame->height + TILE - 1) / TILE;
  const size_t tile_count = across * down, stage_size = (tile_count + STAGES - 1) / STAGES;
  cellist_result result = cellist_progress(context, "casting", 0);
  while (job->first_tile < tile_count && result == CELLIST_SUCCESS) {
    const size_t left = tile_count - job->first_tile, count = left < stage_size ? left : stage_size;
    cellist_parallel_for(context, count, 1, draw_tiles, job);
    if (atomic_load(&job->failed)) return CELLIST_ERROR_OUT_OF_MEMORY;
    job->first_tile += count;
    result = cellist_progress(context, "casting", (double)job->first_tile / (double)tile_count);
  }
  return result;
}

static void sum_up(const struct job *job, unsigned worker_count, cellist_raycast_stats *stats) {
  for (unsigned i = 0; i < worker_count; i++) {
    const ray_walker *walker = &job->hands[i].walker;
    stats->ray_count += walker->ray_count;
    stats->entry_count += walker->total_entries;
    stats->step_count += walker->step_count;
    stats->segment_count += job->hands[i].segment_count;
    stats->retry_count += walker->retry_count;
    stats->fold_ray_count += walker->fold_ray_count;
    stats->error_bound = fmax(stats->error_bound, job->hands[i].error);
  }
}

/* What later pictures use again. */
static cellist_result prepare(cellist_raycaster *caster, const cellist_optics *optics) {
  cellist_context *context = caster->context;
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(caster->mesh);
  if (!caster->has_hierarchy) {
    const cellist_result result = hierarchy_build(context, mesh, &caster->hierarchy);
    if (result != CELLIST_SUCCESS) return result;
    caster->has_hierarchy = true;
  }
  if (caster->shifted == NULL && shift_of(caster->scalar) != 0) {
    caster->shifted = shift_values(context, caster->scalar, shift_of(caster->scalar));
    if (caster->shifted == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    caster->shift = shift_of(caster->scalar);
  }
  if (caster->slopes == NULL && caster->scalar->association == CELLIST_ON_POINTS) {
    caster->slopes = cellist_allocate(context, mesh->tet_count, sizeof *caster->slopes);
    if (caster->slopes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    gradient_slopes(context, mesh, caster->scalar, caster->slopes);
  }
  if (!optics->light.enabled) return CELLIST_SUCCESS;
  if (optics->light.cell_gradients && caster->cell_gradients == NULL) {
    double *gradients = cellist_allocate(context, mesh->tet_count, 3 * sizeof *gradients);
    if (gradients == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    const cellist_result result = cellist_gradients_of_cells(context, caster->mesh, caster->scalar, gradients);
    if (result != CELLIST_SUCCESS) {
      cellist_deallocate(context, gradients);
      return result;
    }
    caster->cell_gradients = gradients;
  }
  if (!optics->light.cell_gradients && caster->point_gradients == NULL) {
    double *gradients = cellist_allocate(context, mesh->point_count, 3 * sizeof *gradients);
    if (gradients == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    const cellist_result result = cellist_gradients_at_points(context, caster->mesh, caster->scalar, gradients);
    if (result != CELLIST_SUCCESS) {
      cellist_deallocate(context, gradients);
      return result;
    }
    caster->point_gradients = gradients;
  }
  return CELLIST_SUCCESS;
}

static cellist_result draw_scene(cellist_raycaster *caster, const cellist_frame *frame, const shade_scene *scene,
                                 const behind_scene *behind, const cellist_raycast_output *output,
                                 const uint32_t *pixels, size_t pixel_count, cellist_raycast_stats *stats) {
  cellist_context *context = caster->context;
  const cellist_light *light = &scene->optics.light;
  const unsigned worker_count = cellist_context_worker_count(context);
  cellist_scalar scalar = *caster->scalar;
  if (caster->shifted != NULL) scalar.values = caster->shifted;
  struct job job = {.caster = caster,
                    .frame = frame,
                    .scene = scene,
                    .behind = behind,
                    .outputs = outputs_of(output),
                    .pixels = pixels};
  atomic_init(&job.failed, false);
  job.hands = cellist_allocate_zeroed(context, worker_count, sizeof *job.hands);
  if (job.hands == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (unsigned i = 0; i < worker_count; i++) {
    ray_walker *walker = &job.hands[i].walker;
    walker->context = context;
    walker->mesh = cellist_mesh_get_arrays(caster->mesh);
    walker->scalar = &scalar;
    walker->hierarchy = &caster->hierarchy;
    walker->slopes = caster->slopes;
    if (light->enabled && light->cell_gradients) walker->cell_gradients = caster->cell_gradients;
    if (light->enabled && !light->cell_gradients) walker->point_gradients = caster->point_gradients;
  }
  cellist_result result = CELLIST_SUCCESS;
  if (pixels == NULL)
    result = draw_all(context, &job);
  else
    cellist_parallel_for(context, pixel_count, LISTED_GRAIN, draw_listed, &job);
  if (atomic_load(&job.failed)) result = CELLIST_ERROR_OUT_OF_MEMORY; /* the worker left the message */
  sum_up(&job, worker_count, stats);
  for (unsigned i = 0; i < worker_count; i++) walk_release(&job.hands[i].walker);
  cellist_deallocate(context, job.hands);
  return result;
}

static cellist_result render(cellist_raycaster *caster, const cellist_frame *frame, const cellist_transfer *transfer,
                             const cellist_raycast_desc *desc, const cellist_raycast_output *output,
                             const uint32_t *pixels, size_t pixel_count, cellist_raycast_stats *stats) {
  cellist_result result = prepare(caster, &desc->optics);
  if (result != CELLIST_SUCCESS) return result;
  cellist_transfer function = *transfer;
  cellist_optics model = desc->optics;
  if (caster->shifted != NULL) {
    result = shift_optics(caster->context, caster->shift, &function, &model);
    if (result != CELLIST_SUCCESS) return result;
  }
  shade_scene scene;
  behind_scene behind;
  result = shade_begin(caster->context, &model, &function, frame, &scene);
  if (result == CELLIST_SUCCESS) result = behind_begin(caster, desc->surface, &scene, frame, &behind);
  if (result == CELLIST_SUCCESS)
    result = draw_scene(caster, frame, &scene, &behind, output, pixels, pixel_count, stats);
  shade_end(caster->context, &scene);
  if (caster->shifted != NULL) shift_release(caster->context, &function, &model);
  return result;
}

cellist_result raycaster_render_reference(cellist_raycaster *caster, const cellist_frame *frame,
                                          const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                          const cellist_raycast_output *output, cellist_raycast_stats *stats) {
  return render(caster, frame, transfer, desc, output, NULL, 0, stats);
}

cellist_result raycaster_recast_pixels(cellist_raycaster *caster, const cellist_frame *frame,
                                       const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                       const cellist_raycast_output *output, const uint32_t *pixels,
                                       size_t pixel_count) {
  cellist_raycast_stats stats = {0};
  return render(caster, frame, transfer, desc, output, pixels, pixel_count, &stats);
}
