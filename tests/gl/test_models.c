/* SPDX-License-Identifier: BSD-3-Clause
 * Every optical model and framebuffer against the reference caster, on a mesh of many cells. */
#include "scene.h"

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
