/* SPDX-License-Identifier: BSD-3-Clause
 * Groups: cells whose order is not told must come out right wherever they stand, by each of the ways to do it. A sorted
 * order is cut into groups at random and each is shuffled; the reference caster, which needs no order, judges. */
#include <cellist/generate.h>
#include <cellist/raycast.h>
#include <cellist/sort.h>

#include "stage.h"

enum { SIZE = 64, LONGEST = 400 };

static cellist_transfer_knot KNOTS[] = {
    {-0.6, 0.3, {0, 0, 1}}, {-0.1, 4, {0, 1, 1}}, {0.2, 0.5, {1, 0.2, 0}}, {0.8, 9, {1, 1, 0}}};
static const cellist_transfer TRANSFER = {4, KNOTS};

typedef struct scene {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_gl *gl;
  cellist_image *image;
  size_t count;
  uint32_t *order;
  cellist_gl_group *groups;
  size_t group_count;
  random_state random;
} scene;

/* A plate of side x side x 1 cubes of six tets: many cells, few on a ray. */
static cellist_mesh *make_plate(cellist_context *context, uint32_t side) {
  static const uint32_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  const uint32_t points_a_side = side + 1, step[3] = {1, points_a_side, points_a_side * points_a_side};
  const uint32_t point_count = 2 * step[2], tet_count = 6 * side * side;
  double *points = malloc(3 * point_count * sizeof *points), *values = malloc(point_count * sizeof *values);
  uint32_t *tets = malloc(4 * tet_count * sizeof *tets);
  for (uint32_t i = 0; i < point_count; i++) {
    points[3 * i] = i % points_a_side / (double)side;
    points[3 * i + 1] = i / points_a_side % points_a_side / (double)side;
    points[3 * i + 2] = i / step[2] * 0.1;
    values[i] = sin(3 * points[3 * i]) * cos(4 * points[3 * i + 1]) + i / step[2] * 0.5;
  }
  for (uint32_t t = 0; t < tet_count; t++) {
    uint32_t at = t / 6 % side + t / 6 / side * points_a_side;
    for (uint32_t c = 0; c < 4; c++) {
      tets[4 * t + c] = at;
      if (c < 3) at += step[path[t % 6][c]];
    }
  }
  const cellist_field field = {"wave", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {point_count, points, tet_count, tets, NULL, 1, &field};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  free(points);
  free(values);
  free(tets);
  return mesh;
}

/* cells: of a perturbed grid; 0: a plate of more cells than a batch. bytes: for lists. */
static void open_scene(scene *made, size_t cells, size_t bytes) {
  const cellist_gl_desc desc = {.list_bytes = bytes};
  *made = (scene){.context = harness_context(2), .random = {99}};
  const cellist_generate_desc generate = {.size = cells, .perturb = 0.3};
  if (cells > 0)
    assert_success(made->context, cellist_generate(made->context, "grid", &generate, &made->mesh));
  else
    made->mesh = make_plate(made->context, 80);
  assert_success(made->context, cellist_scalar_select(made->context, made->mesh, NULL, &made->scalar));
  assert_success(made->context, cellist_image_create(made->context, SIZE, SIZE, STAGE_CHANNELS, 6, &made->image));
  assert_success(made->context, cellist_gl_create(made->context, &desc, &made->gl));
  assert_success(made->context, cellist_gl_upload(made->gl, made->mesh, &made->scalar));
  made->count = cellist_mesh_get_arrays(made->mesh)->tet_count;
  made->order = malloc(made->count * sizeof *made->order);
  made->groups = malloc(made->count * sizeof *made->groups);
}

static void close_scene(scene *made) {
  free(made->order);
  free(made->groups);
  cellist_gl_destroy(made->gl);
  cellist_image_destroy(made->image);
  cellist_scalar_release(made->context, &made->scalar);
  cellist_mesh_destroy(made->mesh);
  harness_context_destroy(made->context);
}

/* From outside, from inside, in parallel. */
static cellist_frame look(const scene *made, int which) {
  const double *bounds = cellist_mesh_get_arrays(made->mesh)->bounds;
  double middle[3], eye[3], target[3], size = 0;
  for (int k = 0; k < 3; k++) {
    middle[k] = 0.5 * (bounds[k] + bounds[3 + k]);
    size = fmax(size, bounds[3 + k] - bounds[k]);
  }
  const double from[3] = {1.1, -0.8, 0.7};
  for (int k = 0; k < 3; k++) {
    eye[k] = middle[k] + size * (which == 1 ? 0.05 * k + 0.013 : from[k]);
    target[k] = which == 1 ? bounds[3 + k] - 0.1 * k * size : middle[k];
  }
  return stage_frame(made->context, eye, target, which == 2 ? 1.3 * size : 0, 0, SIZE);
}

static void sort(scene *made, const cellist_frame *frame) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  const cellist_sorter_desc desc = {arrays->point_count, arrays->positions,  arrays->tet_count,
                                    arrays->tets,        arrays->neighbours, NULL};
  cellist_viewpoint viewpoint = {.parallel = frame->parallel};
  memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
  cellist_sorter *sorter = NULL;
  assert_success(made->context, cellist_sorter_create(made->context, &desc, &sorter));
  assert_success(made->context, cellist_sorter_sort(sorter, &viewpoint, made->order, NULL));
  cellist_sorter_destroy(sorter);
}

/* Cuts the order into single cells and groups of up to longest cells, and shuffles these. */
static void shuffle(scene *made, size_t longest) {
  made->group_count = 0;
  for (size_t begin = 0; begin < made->count;) {
    const size_t left = made->count - begin;
    size_t length = random_below(&made->random, 3) > 0 ? 1 + (size_t)random_below(&made->random, longest) : 1;
    if (length > left) length = left;
    for (size_t i = length; i > 1; i--) {
      const size_t other = (size_t)random_below(&made->random, i);
      const uint32_t kept = made->order[begin + i - 1];
      made->order[begin + i - 1] = made->order[begin + other];
      made->order[begin + other] = kept;
    }
    if (length > 1) made->groups[made->group_count++] = (cellist_gl_group){begin, length};
    begin += length;
  }
}

/* The greatest difference from the reference, of colours and of depths relative to depth. */
static double compare(scene *made, const cellist_frame *frame, const cellist_gl_settings *settings,
                      cellist_gl_stats *stats) {
  cellist_image *truth = NULL;
  cellist_raycaster *caster = NULL;
  assert_success(made->context, cellist_image_create(made->context, SIZE, SIZE, STAGE_CHANNELS, 6, &truth));
  assert_success(made->context, cellist_raycaster_create(made->context, made->mesh, &made->scalar, NULL, &caster));
  const cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_REFERENCE, .optics = settings->optics};
  const cellist_raycast_output output = {.image = truth};
  assert_success(made->context, cellist_raycaster_render(caster, frame, &TRANSFER, &desc, &output, NULL));
  assert_success(made->context,
                 cellist_gl_render(made->gl, frame, &TRANSFER, made->order, made->count, settings, made->image, stats));
  double worst = 0, seen = 0;
  const float *alpha = cellist_image_channel(truth, "A");
  for (size_t c = 0; c < 6; c++)
    for (size_t i = 0; i < SIZE * SIZE; i++) {
      const double got = cellist_image_channel(made->image, STAGE_CHANNELS[c])[i];
      const double wanted = cellist_image_channel(truth, STAGE_CHANNELS[c])[i];
      if (c < 4) seen = fmax(seen, wanted);
      if (c == 4 && alpha[i] > 0.01f && settings->optics.model != CELLIST_MODEL_MAXIMUM)
        worst = fmax(worst, 1e-3 * fabs(got - wanted) / wanted);
      if (c < 4) worst = fmax(worst, fabs(got - wanted));
    }
  assert_true(seen > 0.5);
  cellist_raycaster_destroy(caster);
  cellist_image_destroy(truth);
  return worst;
}

static void check_groups(cellist_gl_group_method method, size_t cells, size_t longest, cellist_model model) {
  const cellist_isosurface isos[] = {{0.2, 0.4}, {0.45, 0.5}, {0.6, 0.7}};
  scene made;
  open_scene(&made, cells, 0);
  for (int which = 0; which < 3; which++) {
    const cellist_frame frame = look(&made, which);
    sort(&made, &frame);
    shuffle(&made, longest);
    cellist_gl_settings settings = {
        .optics = {.model = model, .iso_count = 3, .isos = isos}, .groups = made.groups, .group_method = method};
    cellist_gl_stats stats;
    const double unaware = compare(&made, &frame, &settings, &stats);
    settings.group_count = made.group_count;
    const double worst = compare(&made, &frame, &settings, &stats);
    assert_true(stats.group_count > 0 && stats.group_count <= made.group_count);
    if (!(worst <= 2e-5)) fail_msg("view %d: worst error %g", which, worst);
    assert_true(unaware > 1e-3); /* the order mattered */
  }
  close_scene(&made);
}

TEST(small_groups_are_composited_by_depth)
{ check_groups(CELLIST_GL_GROUPS_AUTO, 500, 16, CELLIST_MODEL_EMISSION_ABSORPTION); }
TEST(large_groups_are_composited_by_depth)
{ check_groups(CELLIST_GL_GROUPS_AUTO, 3000, LONGEST, CELLIST_MODEL_EMISSION_ABSORPTION); }
TEST(lists_composite_groups_by_depth)
{ check_groups(CELLIST_GL_GROUPS_LISTS, 500, 20, CELLIST_MODEL_EMISSION_ABSORPTION); }
TEST(layers_composite_groups_by_depth)
{ check_groups(CELLIST_GL_GROUPS_LAYERS, 3000, LONGEST, CELLIST_MODEL_EMISSION_ABSORPTION); }
TEST(isosurfaces_in_groups_are_composited_by_depth)
{
  check_groups(CELLIST_GL_GROUPS_AUTO, 1500, 60, CELLIST_MODEL_ISOSURFACES);
  check_groups(CELLIST_GL_GROUPS_LAYERS, 1500, 60, CELLIST_MODEL_ISOSURFACES);
}

/* The whole mesh as one group that is more than one batch; by lists also with little memory, to the same bits. */
TEST(a_mesh_in_no_order_at_all_is_composited)
{
  float first[4 * SIZE * SIZE];
  for (int method = CELLIST_GL_GROUPS_AUTO; method <= CELLIST_GL_GROUPS_LAYERS; method++) {
    scene made;
    open_scene(&made, 0, method == CELLIST_GL_GROUPS_LISTS ? 600000 : 0);
    const cellist_frame frame = look(&made, 0);
    for (uint32_t i = 0; i < made.count; i++) made.order[i] = i;
    made.groups[0] = (cellist_gl_group){0, made.count};
    const cellist_gl_settings settings = {
        .groups = made.groups, .group_count = 1, .group_method = (cellist_gl_group_method)method};
    cellist_gl_stats stats;
    const double worst = compare(&made, &frame, &settings, &stats);
    if (!(worst <= 2e-5)) fail_msg("method %d: worst error %g", method, worst);
    assert_true(stats.fragment_count > 3000 && stats.cell_count > 33000 && stats.cell_count <= made.count);
    for (size_t c = 0; c < 4; c++) {
      const float *plane = cellist_image_channel(made.image, STAGE_CHANNELS[c]);
      if (method == CELLIST_GL_GROUPS_AUTO) memcpy(&first[c * SIZE * SIZE], plane, SIZE * SIZE * sizeof *plane);
      if (method == CELLIST_GL_GROUPS_LISTS) assert_memory_equal(&first[c * SIZE * SIZE], plane, SIZE * SIZE * 4);
    }
    close_scene(&made);
  }
}

TEST(models_that_need_no_order_have_no_groups)
{
  scene made;
  open_scene(&made, 500, 0);
  const cellist_frame frame = look(&made, 0);
  for (uint32_t i = 0; i < made.count; i++) made.order[i] = i;
  made.groups[0] = (cellist_gl_group){0, made.count};
  const cellist_model models[] = {CELLIST_MODEL_ABSORPTION, CELLIST_MODEL_EMISSION, CELLIST_MODEL_MAXIMUM};
  for (size_t i = 0; i < 3; i++) {
    const cellist_gl_settings settings = {.optics = {.model = models[i]}, .groups = made.groups, .group_count = 1};
    cellist_gl_stats stats;
    const double worst = compare(&made, &frame, &settings, &stats);
    if (!(worst <= 2e-5 && stats.group_count == 0)) fail_msg("model %d: worst error %g", (int)models[i], worst);
  }
  close_scene(&made);
}

TEST(bad_groups_are_named)
{
  scene made;
  open_scene(&made, 100, 0);
  const cellist_frame frame = look(&made, 0);
  for (uint32_t i = 0; i < made.count; i++) made.order[i] = i;
  const cellist_gl_group wrong[3][2] = {{{0, 4}, {3, 2}}, {{5, 3}, {1, 2}}, {{0, 2}, {made.count - 1, 2}}};
  for (size_t i = 0; i < 3; i++) {
    const cellist_gl_settings settings = {.groups = wrong[i], .group_count = 2};
    assert_failure(made.context,
                   cellist_gl_render(made.gl, &frame, &TRANSFER, made.order, made.count, &settings, made.image, NULL),
                   CELLIST_ERROR_INVALID_ARGUMENT, "group 1");
  }
  const cellist_gl_settings missing = {.group_count = 2};
  assert_failure(made.context,
                 cellist_gl_render(made.gl, &frame, &TRANSFER, made.order, made.count, &missing, made.image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "groups is NULL");
  close_scene(&made);
}

static cellist_result draw_one_group(cellist_context *context, void *user) {
  static const double values[8] = {0, 1, 0.3, 0.8, 0.2, 0.4, 0.6, 0.1};
  static const double points[24] = {0, 0, 0, 1, 0, 0, 0.2, 1.1, 0, 0.3, 0.3, 0.9,
                                    2, 0, 0, 3, 0, 0, 2.2, 1.1, 0, 2.3, 0.3, 0.9};
  const cellist_gl_group group = {0, 2};
  const cellist_gl_settings settings = {
      .groups = &group, .group_count = 1, .group_method = *(const cellist_gl_group_method *)user};
  const double eye[3] = {3, -2, 1.5}, target[3] = {0.4, 0.4, 0.2};
  const uint32_t order[2] = {0, 1};
  stage made;
  cellist_result result = stage_open(context, CELLIST_GL_AUTO, 2, points, values, 16, &made);
  if (result == CELLIST_SUCCESS) {
    const cellist_frame frame = stage_frame(context, eye, target, 0, 0, 16);
    result = cellist_gl_render(made.gl, &frame, &TRANSFER, order, 2, &settings, made.image, NULL);
  }
  stage_close(&made);
  return result;
}

TEST(failed_allocations_are_reported)
{
  for (int method = CELLIST_GL_GROUPS_AUTO; method <= CELLIST_GL_GROUPS_LAYERS; method++) {
    cellist_gl_group_method which = (cellist_gl_group_method)method;
    check_allocation_failures(draw_one_group, &which);
  }
}
