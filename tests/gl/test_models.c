/* SPDX-License-Identifier: BSD-3-Clause
 * Every optical model and framebuffer against the reference caster, on a mesh of many cells. */
#include <cellist/raycast.h>
#include <cellist/sort.h>

#include "stage.h"

enum { PIXELS = 64, CELLS_A_SIDE = 5 };

static cellist_transfer_knot KNOTS[] = {
    {0.05, 0, {0, 0, 1}}, {0.3, 1.5, {0, 1, 1}}, {0.45, 0.2, {1, 0.2, 0}}, {0.8, 6, {1, 1, 0}}};
static const cellist_transfer TRANSFER = {4, KNOTS};

struct scene {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_gl *gl;
  cellist_raycaster *caster;
  cellist_image *image;
  double *truth;
};

/* A cube of cubes of six tets with moved inner points, and a scalar that bends through it. */
static void open_scene(struct scene *scene) {
  static const uint32_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  enum { N = CELLS_A_SIDE, SIDE = N + 1, POINTS = SIDE * SIDE * SIDE, TETS = 6 * N * N * N };
  static double points[3 * POINTS], values[POINTS];
  static uint32_t tets[4 * TETS];
  const uint32_t step[3] = {1, SIDE, SIDE * SIDE};
  random_state random = {5};
  for (uint32_t i = 0; i < POINTS; i++) {
    double *p = &points[3 * i];
    for (int k = 0; k < 3; k++) {
      const uint32_t at = i / step[k] % SIDE;
      p[k] = (at + (at > 0 && at < N ? random_between(&random, -0.1, 0.1) : 0)) / N;
    }
    values[i] = 0.5 + 0.4 * sin(5 * p[0] + 2 * p[1]) * cos(4 * p[2] + p[1]);
  }
  for (uint32_t t = 0; t < TETS; t++) {
    const uint32_t cube = t / 6;
    uint32_t at = cube % N * step[0] + cube / N % N * step[1] + cube / N / N * step[2];
    for (uint32_t c = 0; c < 4; c++) {
      tets[4 * t + c] = at;
      if (c < 3) at += step[path[t % 6][c]];
    }
  }
  *scene = (struct scene){.context = harness_context(2)};
  const cellist_field field = {"bend", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {POINTS, points, TETS, tets, NULL, 1, &field};
  assert_success(scene->context, cellist_mesh_create(scene->context, &desc, &scene->mesh));
  assert_success(scene->context, cellist_scalar_select(scene->context, scene->mesh, NULL, &scene->scalar));
  assert_success(scene->context, cellist_gl_create(scene->context, NULL, &scene->gl));
  assert_success(scene->context, cellist_gl_upload(scene->gl, scene->mesh, &scene->scalar));
  assert_success(scene->context,
                 cellist_raycaster_create(scene->context, scene->mesh, &scene->scalar, NULL, &scene->caster));
  assert_success(scene->context,
                 cellist_image_create(scene->context, PIXELS, PIXELS, STAGE_CHANNELS, 6, &scene->image));
  scene->truth = malloc(4 * PIXELS * PIXELS * sizeof(double));
}

static void close_scene(struct scene *scene) {
  free(scene->truth);
  cellist_image_destroy(scene->image);
  cellist_raycaster_destroy(scene->caster);
  cellist_gl_destroy(scene->gl);
  cellist_scalar_release(scene->context, &scene->scalar);
  cellist_mesh_destroy(scene->mesh);
  harness_context_destroy(scene->context);
}

/* The root of the mean square and the greatest difference from the reference; whether anything was seen. */
static void compare(struct scene *scene, const cellist_frame *frame, const cellist_gl_settings *settings, double *rmse,
                    double *most) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(scene->mesh);
  const cellist_sorter_desc desc = {arrays->point_count, arrays->positions,  arrays->tet_count,
                                    arrays->tets,        arrays->neighbours, NULL};
  cellist_viewpoint viewpoint = {.parallel = frame->parallel};
  memcpy(viewpoint.position, frame->parallel ? frame->forward : frame->eye, sizeof viewpoint.position);
  cellist_sorter *sorter = NULL;
  uint32_t *order = malloc(arrays->tet_count * sizeof *order);
  assert_success(scene->context, cellist_sorter_create(scene->context, &desc, &sorter));
  assert_success(scene->context, cellist_sorter_sort(sorter, &viewpoint, order, NULL));
  assert_success(scene->context, cellist_gl_render(scene->gl, frame, &TRANSFER, order, arrays->tet_count, settings,
                                                   scene->image, NULL));
  const cellist_raycast_desc cast = {.precision = CELLIST_PRECISION_REFERENCE, .optics = settings->optics};
  const cellist_raycast_output output = {.rgba = scene->truth};
  assert_success(scene->context, cellist_raycaster_render(scene->caster, frame, &TRANSFER, &cast, &output, NULL));
  double sum = 0, seen = 0;
  *most = 0;
  for (size_t i = 0; i < PIXELS * PIXELS; i++)
    for (size_t c = 0; c < 4; c++) {
      const double difference =
          fabs(cellist_image_channel(scene->image, STAGE_CHANNELS[c])[i] - scene->truth[4 * i + c]);
      assert_true(isfinite(difference));
      sum += difference * difference;
      *most = fmax(*most, difference);
      seen = fmax(seen, scene->truth[4 * i + c]);
    }
  *rmse = sqrt(sum / (4.0 * PIXELS * PIXELS));
  assert_true(seen > 0.1);
  cellist_sorter_destroy(sorter);
  free(order);
}

/* From outside, from inside and in parallel. */
static cellist_frame frame_of(struct scene *scene, int which) {
  const double eyes[3][3] = {{2.6, -1.3, 1.9}, {0.47, 0.41, 0.53}, {2, 2.5, 1.4}};
  const double outside[3] = {0.5, 0.5, 0.5}, inside[3] = {1, 0.7, 0.2};
  return stage_frame(scene->context, eyes[which], which == 1 ? inside : outside, which == 2 ? 1.9 : 0, 0, PIXELS);
}

static void check_model(const cellist_gl_settings *settings, double limit) {
  struct scene scene;
  open_scene(&scene);
  for (int which = 0; which < 3; which++) {
    const cellist_frame frame = frame_of(&scene, which);
    double rmse, most;
    compare(&scene, &frame, settings, &rmse, &most);
    if (!(most <= limit)) fail_msg("view %d: rmse %g, most %g", which, rmse, most);
  }
  close_scene(&scene);
}

static void check_plain_model(cellist_model model) {
  const cellist_gl_settings settings = {.optics = {.model = model}};
  check_model(&settings, 2e-5);
}

TEST(emission_and_absorption_match_the_reference)
{ check_plain_model(CELLIST_MODEL_EMISSION_ABSORPTION); }
TEST(absorption_matches_the_reference)
{ check_plain_model(CELLIST_MODEL_ABSORPTION); }
TEST(emission_matches_the_reference)
{ check_plain_model(CELLIST_MODEL_EMISSION); }
TEST(maximum_intensity_matches_the_reference)
{ check_plain_model(CELLIST_MODEL_MAXIMUM); }

TEST(isosurfaces_match_the_reference)
{
  const cellist_isosurface isos[] = {{0.7, 0.5}, {0.31, 1}, {0.52, 0.25}};
  const cellist_gl_settings settings = {.optics = {.model = CELLIST_MODEL_ISOSURFACES, .iso_count = 3, .isos = isos}};
  check_model(&settings, 2e-5);
}

static const cellist_light LIGHT = {true, {0.3, -0.8, 0.6}, 0.2, 0.7, 0.4, 6, 1.5, true};

TEST(lit_volumes_match_the_reference)
{
  for (int model = CELLIST_MODEL_EMISSION_ABSORPTION; model <= CELLIST_MODEL_EMISSION; model += 2) {
    const cellist_gl_settings settings = {.optics = {.model = (cellist_model)model, .light = LIGHT}};
    check_model(&settings, 5e-5);
  }
}

TEST(lit_isosurfaces_match_the_reference)
{
  const cellist_isosurface isos[] = {{0.7, 0.5}, {0.31, 1}, {0.52, 0.25}};
  const cellist_gl_settings settings = {
      .optics = {.model = CELLIST_MODEL_ISOSURFACES, .iso_count = 3, .isos = isos, .light = LIGHT}};
  check_model(&settings, 5e-5);
}

static cellist_light point_light(double specular) {
  cellist_light light = LIGHT;
  light.cell_gradients = false;
  light.specular = specular;
  return light;
}

/* Ambient and diffuse light are exact along a segment, also where the diffuse part changes sign. */
TEST(diffuse_light_by_gradients_at_points_matches_the_reference)
{
  for (int model = CELLIST_MODEL_EMISSION_ABSORPTION; model <= CELLIST_MODEL_EMISSION; model += 2) {
    const cellist_gl_settings settings = {.optics = {.model = (cellist_model)model, .light = point_light(0)}};
    check_model(&settings, 2e-5);
  }
}

TEST(isosurfaces_lit_by_gradients_at_points_match_the_reference)
{
  const cellist_isosurface isos[] = {{0.7, 0.5}, {0.31, 1}, {0.52, 0.25}};
  const cellist_gl_settings settings = {
      .optics = {.model = CELLIST_MODEL_ISOSURFACES, .iso_count = 3, .isos = isos, .light = point_light(0.4)}};
  check_model(&settings, 5e-5);
}

/* The highlight is taken at two places a sample: more samples, less error. */
TEST(more_samples_bring_highlights_closer_to_the_reference)
{
  struct scene scene;
  open_scene(&scene);
  for (int which = 0; which < 3; which++) {
    const cellist_frame frame = frame_of(&scene, which);
    double last = 2e-3;
    for (uint32_t samples = 1; samples <= 4; samples *= 2) {
      const cellist_gl_settings settings = {.optics = {.light = point_light(0.4), .sample_count = samples}};
      double rmse, most;
      compare(&scene, &frame, &settings, &rmse, &most);
      print_message("view %d, samples %u: rmse %.3g, most %.3g\n", which, samples, rmse, most);
      if (!(rmse < last)) fail_msg("view %d, samples %u: rmse %g, most %g", which, samples, rmse, most);
      last = 0.6 * rmse;
    }
  }
  close_scene(&scene);
}

/* Halves and bytes cost what their rounding at each blend costs, not more. */
TEST(smaller_framebuffers_err_by_their_rounding)
{
  struct scene scene;
  open_scene(&scene);
  const cellist_frame frame = frame_of(&scene, 0);
  double last = 0;
  for (int format = CELLIST_FRAMEBUFFER_32F; format <= CELLIST_FRAMEBUFFER_8; format++) {
    static const double limits[] = {1e-6, 1e-3, 2e-2};
    const cellist_gl_settings settings = {.framebuffer = (cellist_framebuffer)format};
    double rmse, most;
    compare(&scene, &frame, &settings, &rmse, &most);
    if (!(rmse <= limits[format] && rmse > last)) fail_msg("format %d: rmse %g, most %g", format, rmse, most);
    last = rmse;
  }
  close_scene(&scene);
}
