/* SPDX-License-Identifier: BSD-3-Clause
 * Soft: the public calls; prepares a frame and shares its tiles out among the workers. */
#include <cellist/gradients.h>
#include <cellist/soft.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "bins.h"

struct cellist_soft {
  cellist_context *context;
  const cellist_mesh *mesh;
  const cellist_scalar *scalar;
  bool vectorised;
  double unit;             /* the mesh's diagonal */
  double *scalars;         /* [tets] as the optics take them, if they are on cells */
  uint8_t *is_drawn;       /* [tets] */
  double *point_gradients; /* [3 points] once light has asked for them */
  soft_bins bins;
  soft_worker *workers; /* [worker_count] */
  unsigned worker_count;
};

/* Fragments a worker has room for from the start: more than wait outside of groups. */
enum { FIRST_FRAGMENTS = 4096 };

static bool has_avx2(void) {
#ifdef CELLIST_SOFT_AVX2
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

static soft_tile_function tile_function(const cellist_soft *soft) {
#ifdef CELLIST_SOFT_AVX2
  if (soft->vectorised) return soft_tile_avx2;
#endif
  (void)soft;
  return soft_tile_portable;
}

static soft_bounds_function bounds_function(const cellist_soft *soft) {
#ifdef CELLIST_SOFT_AVX2
  if (soft->vectorised) return soft_bounds_avx2;
#endif
  (void)soft;
  return soft_bounds_portable;
}

static void mark_drawn(cellist_soft *soft) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(soft->mesh);
  const bool on_points = soft->scalar->association == CELLIST_ON_POINTS;
  for (size_t i = 0; i < arrays->tet_count; i++) {
    bool drawn = (arrays->tet_flags[i] & CELLIST_TET_FLAT) == 0;
    for (int k = 0; k < 4 && on_points; k++)
      drawn = drawn && isfinite(soft->scalar->values[arrays->tets[4 * i + (size_t)k]]);
    soft->is_drawn[i] = drawn && (on_points || isfinite(soft->scalar->values[i]));
  }
}

static cellist_result create_workers(cellist_soft *soft) {
  soft->worker_count = cellist_context_worker_count(soft->context);
  soft->workers = cellist_allocate_zeroed(soft->context, soft->worker_count, sizeof *soft->workers);
  if (soft->workers == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (unsigned i = 0; i < soft->worker_count; i++) {
    soft_worker *worker = &soft->workers[i];
    worker->pixels = cellist_allocate(soft->context, SOFT_TILE_PIXELS, sizeof *worker->pixels);
    worker->last = cellist_allocate(soft->context, SOFT_TILE_PIXELS, sizeof *worker->last);
    worker->near_place = cellist_allocate_zeroed(soft->context, SOFT_TILE_PIXELS + 8, sizeof *worker->near_place);
    worker->far_place = cellist_allocate_zeroed(soft->context, SOFT_TILE_PIXELS + 8, sizeof *worker->far_place);
    worker->pieces = cellist_allocate_zeroed(soft->context, 1, sizeof *worker->pieces);
    if (worker->pixels == NULL || worker->near_place == NULL || worker->far_place == NULL || worker->pieces == NULL ||
        worker->last == NULL || !soft_fragments_reserve(soft->context, &worker->fragments, FIRST_FRAGMENTS))
      return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  return CELLIST_SUCCESS;
}

cellist_result cellist_soft_create(cellist_context *context, const cellist_mesh *mesh, const cellist_scalar *scalar,
                                   const cellist_soft_desc *desc, cellist_soft **soft) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || scalar == NULL || soft == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a projector needs a mesh and a scalar");
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const size_t count = scalar->association == CELLIST_ON_POINTS ? arrays->point_count : arrays->tet_count;
  if (scalar->count != count || (scalar->values == NULL && count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the scalar has %zu values, the mesh needs %zu",
                        scalar->count, count);
  cellist_soft *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->mesh = mesh;
  created->scalar = scalar;
  created->vectorised = has_avx2() && !(desc != NULL && desc->portable);
  const double *b = arrays->bounds;
  created->unit = hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2]);
  if (!(created->unit > 0) || !isfinite(created->unit)) created->unit = 1;
  const bool on_cells = scalar->association == CELLIST_ON_CELLS;
  created->scalars = cellist_allocate(context, on_cells ? count : 0, sizeof *created->scalars);
  created->is_drawn = cellist_allocate(context, arrays->tet_count, sizeof *created->is_drawn);
  const bool ok = created->scalars != NULL && created->is_drawn != NULL && create_workers(created) == CELLIST_SUCCESS;
  if (!ok) {
    cellist_soft_destroy(created);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  mark_drawn(created);
  *soft = created;
  return CELLIST_SUCCESS;
}

void cellist_soft_destroy(cellist_soft *soft) {
  if (soft == NULL) return;
  cellist_context *context = soft->context;
  for (unsigned i = 0; soft->workers != NULL && i < soft->worker_count; i++) {
    soft_worker *worker = &soft->workers[i];
    soft_fragments_release(context, &worker->fragments);
    soft_fragments_release(context, &worker->sorted);
    cellist_deallocate(context, worker->keys);
    cellist_deallocate(context, worker->scratch_keys);
    cellist_deallocate(context, worker->values);
    cellist_deallocate(context, worker->scratch_values);
    cellist_deallocate(context, worker->pieces);
    cellist_deallocate(context, worker->last);
    cellist_deallocate(context, worker->pixels);
    cellist_deallocate(context, worker->near_place);
    cellist_deallocate(context, worker->far_place);
  }
  cellist_deallocate(context, soft->workers);
  cellist_deallocate(context, soft->scalars);
  cellist_deallocate(context, soft->is_drawn);
  cellist_deallocate(context, soft->point_gradients);
  soft_bins_release(context, &soft->bins);
  cellist_deallocate(context, soft);
}

static cellist_result check_settings(cellist_context *context, const cellist_soft_settings *settings) {
  if ((settings->order == NULL && settings->order_count > 0) || settings->order_count > UINT32_MAX ||
      (settings->groups == NULL && settings->group_count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the order or its groups are NULL, or too many");
  size_t reached = 0;
  for (size_t i = 0; i < settings->group_count; i++) {
    const cellist_soft_group *group = &settings->groups[i];
    if (group->begin < reached || group->begin > settings->order_count ||
        group->count > settings->order_count - group->begin)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "group %zu is out of order or beyond it", i);
    reached = group->begin + group->count;
  }
  return cellist_optics_check(context, &settings->optics);
}

static cellist_result check_frame(cellist_context *context, const cellist_frame *frame, const cellist_image *image) {
  if (frame == NULL || image == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a picture needs a frame and an image");
  if (cellist_image_width(image) != frame->width || cellist_image_height(image) != frame->height)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the image is %ux%u, the frame %ux%u",
                        cellist_image_width(image), cellist_image_height(image), frame->width, frame->height);
  if (frame->width > UINT16_MAX || frame->height > UINT16_MAX)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "the soft projector draws at most %u pixels along a side",
                        (unsigned)UINT16_MAX);
  return CELLIST_SUCCESS;
}

static soft_scene scene_of(const cellist_soft *soft, const cellist_frame *frame, const cellist_soft_settings *settings,
                           const cellist_image *image) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(soft->mesh);
  const double scale = frame->parallel ? 1 / soft->unit : 1;
  const double half_width = frame->half_width * scale, half_height = frame->half_height * scale;
  soft_scene scene = {.context = soft->context,
                      .parallel = frame->parallel,
                      .across_step = 2 * half_width / frame->width,
                      .upward_step = -2 * half_height / frame->height,
                      .near = frame->near_distance / soft->unit,
                      .frame = frame->clip_count > 0 || settings->surface != NULL ? frame : NULL,
                      .unit = soft->unit,
                      .width = frame->width,
                      .height = frame->height,
                      .tiles_across = (frame->width + SOFT_TILE - 1) / SOFT_TILE,
                      .tets = arrays->tets,
                      .order = settings->order,
                      .cell_scalars = soft->scalar->association == CELLIST_ON_CELLS ? soft->scalars : NULL,
                      .groups = settings->groups,
                      .group_count = settings->group_count,
                      .alpha = cellist_image_channel(image, "A"),
                      .z = cellist_image_channel(image, "Z"),
                      .z_back = cellist_image_channel(image, "ZBack")};
  scene.across = -half_width + 0.5 * scene.across_step;
  scene.upward = half_height + 0.5 * scene.upward_step;
  static const char *const colour[3] = {"R", "G", "B"};
  for (int k = 0; k < 3; k++) scene.colour[k] = cellist_image_channel(image, colour[k]);
  return scene;
}

struct scaling {
  cellist_soft *soft;
  const soft_scene *scene;
};

static void scale_scalars(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct scaling *scaling = user;
  for (size_t i = begin; i < end; i++)
    scaling->soft->scalars[i] = soft_scalar(scaling->scene, scaling->soft->scalar->values[i]);
}

struct tiles {
  cellist_soft *soft;
  const soft_scene *scene;
  atomic_bool failed;
};

static void draw_tiles(void *user, size_t begin, size_t end, unsigned worker) {
  struct tiles *tiles = user;
  const soft_tile_function draw = tile_function(tiles->soft);
  for (size_t tile = begin; tile < end && !atomic_load(&tiles->failed); tile++)
    if (!draw(tiles->scene, &tiles->soft->workers[worker], tile)) atomic_store(&tiles->failed, true);
}

static cellist_result draw(cellist_soft *soft, const cellist_frame *frame, const cellist_soft_settings *settings,
                           soft_scene *scene, cellist_soft_stats *stats) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(soft->mesh);
  if (scene->cell_scalars != NULL) {
    struct scaling scaling = {soft, scene};
    cellist_parallel_for(soft->context, soft->scalar->count, 16384, scale_scalars, &scaling);
  }
  const soft_bins_input input = {.context = soft->context,
                                 .frame = frame,
                                 .point_count = arrays->point_count,
                                 .tet_count = arrays->tet_count,
                                 .positions = arrays->positions,
                                 .point_scalars = scene->cell_scalars == NULL ? soft->scalar->values : NULL,
                                 .bound = bounds_function(soft),
                                 .is_drawn = soft->is_drawn,
                                 .order_count = settings->order_count};
  size_t cell_count = 0;
  cellist_result result = soft_bins_make(&soft->bins, &input, scene, &cell_count);
  if (result == CELLIST_SUCCESS) result = cellist_progress(soft->context, "projecting", 0);
  if (result != CELLIST_SUCCESS) return result;
  struct tiles tiles = {.soft = soft, .scene = scene};
  atomic_init(&tiles.failed, false);
  for (unsigned i = 0; i < soft->worker_count; i++) {
    soft->workers[i].fragment_count = 0;
    soft->workers[i].careful_count = 0;
  }
  const size_t tile_count = (size_t)scene->tiles_across * ((scene->height + SOFT_TILE - 1) / SOFT_TILE);
  cellist_parallel_for(soft->context, tile_count, 1, draw_tiles, &tiles);
  if (atomic_load(&tiles.failed)) return CELLIST_ERROR_OUT_OF_MEMORY;
  *stats = (cellist_soft_stats){.cell_count = cell_count, .vectorised = soft->vectorised};
  for (unsigned i = 0; i < soft->worker_count; i++) {
    stats->fragment_count += soft->workers[i].fragment_count;
    stats->careful_count += soft->workers[i].careful_count;
  }
  return cellist_progress(soft->context, "projecting", 1);
}

/* Whether the picture needs gradients at points; makes them on the first call that does. */
static cellist_result want_gradients(cellist_soft *soft, const cellist_optics *optics, bool *wanted) {
  *wanted = optics->light.enabled && !optics->light.cell_gradients && optics->model != CELLIST_MODEL_ABSORPTION &&
            optics->model != CELLIST_MODEL_MAXIMUM;
  if (!*wanted || soft->point_gradients != NULL) return CELLIST_SUCCESS;
  double *made = cellist_allocate(soft->context, cellist_mesh_get_arrays(soft->mesh)->point_count, 3 * sizeof *made);
  if (made == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  const cellist_result result = cellist_gradients_at_points(soft->context, soft->mesh, soft->scalar, made);
  if (result == CELLIST_SUCCESS)
    soft->point_gradients = made;
  else
    cellist_deallocate(soft->context, made);
  return result;
}

static cellist_result make_model(cellist_soft *soft, const cellist_frame *frame, const cellist_transfer *transfer,
                                 const cellist_soft_settings *settings, soft_scene *scene) {
  bool at_points = false;
  const cellist_result result = want_gradients(soft, &settings->optics, &at_points);
  if (result != CELLIST_SUCCESS) return result;
  const bool is_sharp = scene->sharp.zone_count > 0;
  for (unsigned i = 0; i < soft->worker_count; i++) { /* lists with room for other records */
    soft_worker *worker = &soft->workers[i];
    if (worker->fragments.has_gradients == at_points && worker->fragments.is_sharp == is_sharp) continue;
    soft_fragments_release(soft->context, &worker->fragments);
    soft_fragments_release(soft->context, &worker->sorted);
    worker->fragments.has_gradients = worker->sorted.has_gradients = at_points;
    worker->fragments.is_sharp = worker->sorted.is_sharp = is_sharp;
  }
  return soft_model_make(soft->context, &settings->optics, frame, transfer, scene->transfer, soft->unit,
                         at_points ? soft->point_gradients : NULL, cellist_mesh_get_arrays(soft->mesh)->point_count,
                         &scene->model);
}

cellist_result cellist_soft_render(cellist_soft *soft, const cellist_frame *frame, const cellist_transfer *transfer,
                                   const cellist_soft_settings *settings, cellist_image *image,
                                   cellist_soft_stats *stats) {
  if (soft == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_context *context = soft->context;
  if (settings == NULL) return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a picture needs settings");
  cellist_result result = check_frame(context, frame, image);
  if (result == CELLIST_SUCCESS) result = cellist_transfer_check(context, transfer);
  if (result == CELLIST_SUCCESS) result = check_settings(context, settings);
  if (result != CELLIST_SUCCESS) return result;
  fast_transfer table;
  result = fast_transfer_create(context, transfer, soft->scalar->minimum, soft->scalar->maximum, soft->unit,
                                settings->optics.model != CELLIST_MODEL_ABSORPTION, &table);
  if (result != CELLIST_SUCCESS) return result;
  soft_scene scene = scene_of(soft, frame, settings, image);
  scene.transfer = &table;
  const cellist_model model = settings->optics.model;
  scene.is_thin = (model == CELLIST_MODEL_EMISSION_ABSORPTION || model == CELLIST_MODEL_ABSORPTION) &&
                  fast_transfer_peak(transfer, soft->scalar->minimum, soft->scalar->maximum) * soft->unit <= SOFT_THIN;
  cellist_soft_stats found = {0};
  result = soft_sharp_make(context, transfer, soft->scalar->minimum, soft->scalar->maximum, soft->unit,
                           model != CELLIST_MODEL_ABSORPTION, &table, &scene.sharp);
  if (result == CELLIST_SUCCESS)
    result = surface_layer_make(context, settings->surface, frame, &settings->optics.light, &scene.layer);
  if (result == CELLIST_SUCCESS) result = make_model(soft, frame, transfer, settings, &scene);
  if (result == CELLIST_SUCCESS) result = draw(soft, frame, settings, &scene, &found);
  soft_model_release(context, &scene.model);
  soft_sharp_release(context, &scene.sharp);
  surface_layer_release(context, &scene.layer);
  if (result == CELLIST_SUCCESS && stats != NULL) *stats = found;
  fast_transfer_release(context, &table);
  return result;
}
