/* SPDX-License-Identifier: BSD-3-Clause
 * Light through OpenGL against the reference caster, which lights exactly. */
#include "scene.h"

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

/* Ambient and diffuse light are exact along a segment, also where the diffuse part changes sign. Cells lit so are drawn
 * as faces where fans are asked for. */
static void check_diffuse_light(cellist_gl_method method) {
  for (int model = CELLIST_MODEL_EMISSION_ABSORPTION; model <= CELLIST_MODEL_EMISSION; model += 2) {
    const cellist_gl_settings settings = {.optics = {.model = (cellist_model)model, .light = point_light(0)},
                                          .method = method};
    check_model(&settings, 2e-5);
  }
}

TEST(diffuse_light_by_gradients_at_points_matches_the_reference)
{ check_diffuse_light(CELLIST_GL_FACES); }
TEST(fans_lit_by_gradients_at_points_match_the_reference)
{ check_diffuse_light(CELLIST_GL_FAN); }

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
