/* SPDX-License-Identifier: BSD-3-Clause
 * Integration by psi and by tables through OpenGL, against the reference caster. */
#include "scene.h"

static cellist_light light_of(double specular) {
  return (cellist_light){.enabled = true,
                         .direction = {0.3, -0.8, 0.6},
                         .ambient = 0.2,
                         .diffuse = 0.7,
                         .specular = specular,
                         .shininess = 6,
                         .gradient_unit = 1.5};
}

/* Split at the knots, psi is as exact as its table. */
TEST(psi_matches_the_reference)
{
  for (int model = CELLIST_MODEL_EMISSION_ABSORPTION; model <= CELLIST_MODEL_ABSORPTION; model++) {
    const cellist_gl_settings settings = {
        .optics = {.model = (cellist_model)model, .integration = CELLIST_INTEGRATION_PSI}};
    check_model(&settings, 5e-5);
  }
}

TEST(psi_is_lit_as_the_reference_is)
{
  const cellist_gl_settings settings = {.optics = {.light = light_of(0), .integration = CELLIST_INTEGRATION_PSI}};
  check_model(&settings, 1e-4);
}

TEST(psi_keeps_steps_and_opaque_pieces)
{
  static cellist_transfer_knot knots[] = {{0.2, 0, {1, 0, 0}},   {0.3, 400, {1, 1, 0}}, {0.3, 0.1, {0, 1, 0}},
                                          {0.6, 0.1, {0, 1, 1}}, {0.6, 5e4, {0, 0, 1}}, {0.9, 0, {1, 0, 1}}};
  static const cellist_transfer transfer = {6, knots};
  struct scene scene;
  open_scene(&scene);
  for (int which = 0; which < 3; which++) {
    const cellist_frame frame = frame_of(&scene, which);
    const cellist_gl_settings settings = {.optics = {.integration = CELLIST_INTEGRATION_PSI}};
    double rmse, most;
    compare_with(&scene, &frame, &transfer, &settings, &rmse, &most);
    if (!(rmse < 2e-4)) fail_msg("view %d: rmse %g, most %g", which, rmse, most);
  }
  close_scene(&scene);
}

/* The transfer function has four knots that fall between nodes: errors fall with the nodes' distance. */
static void check_tables(const cellist_light *light, double limit) {
  struct scene scene;
  open_scene(&scene);
  for (int which = 0; which < 3; which++) {
    const cellist_frame frame = frame_of(&scene, which);
    double last = limit;
    for (uint32_t size = 32; size <= 128; size *= 2) {
      cellist_gl_settings settings = {.optics = {.integration = CELLIST_INTEGRATION_TABLE, .table_size = {size, 32}}};
      if (light != NULL) settings.optics.light = *light;
      double rmse, most;
      compare(&scene, &frame, &settings, &rmse, &most);
      print_message("view %d, %u scalars: rmse %.3g, most %.3g\n", which, size, rmse, most);
      if (!(rmse < last)) fail_msg("view %d, %u scalars: rmse %g, most %g", which, size, rmse, most);
      last = 0.6 * rmse;
    }
  }
  close_scene(&scene);
}

TEST(tables_come_closer_to_the_reference_with_their_size)
{ check_tables(NULL, 2e-2); }
TEST(lit_tables_come_closer_to_the_reference_with_their_size)
{
  const cellist_light light = light_of(0);
  check_tables(&light, 2e-2);
}

TEST(tables_draw_absorption_alone)
{
  const cellist_gl_settings settings = {
      .optics = {.model = CELLIST_MODEL_ABSORPTION, .integration = CELLIST_INTEGRATION_TABLE}};
  check_model(&settings, 1e-2);
}

/* Each frame has the tables of its own transfer function, size and light. */
TEST(tables_follow_what_is_drawn)
{
  static cellist_transfer_knot knots[] = {{0, 0.5, {0, 1, 0}}, {1, 2, {0, 0, 1}}};
  static const cellist_transfer other = {2, knots};
  const cellist_light light = light_of(0);
  struct scene scene;
  open_scene(&scene);
  const cellist_frame frame = frame_of(&scene, 0);
  cellist_gl_settings settings = {.optics = {.integration = CELLIST_INTEGRATION_TABLE, .table_size = {64, 16}}};
  double first, again, most;
  compare(&scene, &frame, &settings, &first, &most);
  settings.optics.light = light;
  compare(&scene, &frame, &settings, &again, &most);
  assert_true(again < 2e-2);
  settings.optics.light.enabled = false;
  compare_with(&scene, &frame, &other, &settings, &again, &most);
  assert_true(again < 1e-4);
  settings.optics.integration = CELLIST_INTEGRATION_PSI;
  compare_with(&scene, &frame, &other, &settings, &again, &most);
  assert_true(again < 1e-5);
  settings.optics.integration = CELLIST_INTEGRATION_TABLE;
  compare(&scene, &frame, &settings, &again, &most);
  assert_true(again == first);
  close_scene(&scene);
}

TEST(sizes_out_of_range_are_refused)
{
  struct scene scene;
  open_scene(&scene);
  const cellist_frame frame = frame_of(&scene, 0);
  static const uint32_t sizes[][2] = {{1, 8}, {8, 2}, {1 << 20, 8}};
  for (int i = 0; i < 3; i++) {
    const cellist_gl_settings settings = {
        .optics = {.integration = CELLIST_INTEGRATION_TABLE, .table_size = {sizes[i][0], sizes[i][1]}}};
    const uint32_t order[1] = {0};
    assert_true(cellist_gl_render(scene.gl, &frame, &TRANSFER, order, 1, &settings, scene.image, NULL) !=
                CELLIST_SUCCESS);
    assert_non_null(cellist_context_take_error(scene.context));
  }
  const cellist_gl_settings wrong = {.optics = {.integration = (cellist_integration)7}};
  assert_failure(scene.context, cellist_gl_render(scene.gl, &frame, &TRANSFER, NULL, 0, &wrong, scene.image, NULL),
                 CELLIST_ERROR_INVALID_ARGUMENT, "integration");
  close_scene(&scene);
}
