/* SPDX-License-Identifier: BSD-3-Clause
 * Stability, the reference itself: each case's picture by the reference caster against brute force in 80 bits, which
 * shares no code with it, and against a copy of the scene whose lengths are 2^40 times as long. */
#include <math.h>
#include <stdio.h>

#include "../raycast/brute.h"
#include "harness.h"
#include "stability.h"

typedef struct picture {
  double *rgba;
  cellist_raycast_stats stats;
  cellist_frame frame;
} picture;

static picture draw(cellist_context *context, const stability_scene *scene, const cellist_scalar *scalar) {
  picture made = {.rgba = malloc(4 * sizeof(double) * scene->width * scene->height)};
  assert_non_null(made.rgba);
  cellist_raycaster *caster = NULL;
  assert_success(context, cellist_frame_from_view(context, &scene->view, scene->width, scene->height, &made.frame));
  assert_success(context, cellist_raycaster_create(context, scene->mesh, scalar, NULL, &caster));
  const cellist_raycast_desc desc = {.precision = CELLIST_PRECISION_REFERENCE, .optics = scene->optics};
  assert_success(context, cellist_raycaster_render(caster, &made.frame, &scene->transfer, &desc,
                                                   &(cellist_raycast_output){.rgba = made.rgba}, &made.stats));
  cellist_raycaster_destroy(caster);
  return made;
}

static bool is_volume(const stability_scene *scene) {
  return !scene->optics.light.enabled && scene->optics.model != CELLIST_MODEL_MAXIMUM &&
         scene->optics.model != CELLIST_MODEL_ISOSURFACES;
}

/* Some hundred pixels: brute force tests every cell, and takes its time for sharp peaks. */
static double against_brute_force(const stability_scene *scene, const cellist_scalar *scalar, const picture *made) {
  /* Its quadrature stops at an absolute error: colours of at most 1, multiplied afterwards. */
  cellist_transfer_knot knots[STABILITY_KNOTS];
  const cellist_transfer transfer = {scene->transfer.knot_count, knots};
  double brightest = 0;
  for (size_t i = 0; i < 3 * transfer.knot_count; i++)
    brightest = fmax(brightest, scene->transfer.knots[i / 3].colour[i % 3]);
  for (size_t i = 0; i < transfer.knot_count; i++) {
    knots[i] = scene->transfer.knots[i];
    for (int k = 0; k < 3; k++) knots[i].colour[k] /= brightest;
  }
  brute_force brute;
  brute_begin(&brute, scene->mesh, scalar, &transfer);
  brute.optics = scene->optics;
  double worst = 0, peak = 0;
  const uint32_t count = scene->width * scene->height, step = count > 4800 ? count / 150 : 11;
  for (uint32_t i = 0; i < count; i += step) {
    double origin[3], direction[3];
    real rgba[4];
    cellist_frame_ray(&made->frame, i % scene->width + 0.5, i / scene->width + 0.5, origin, direction);
    brute_volume(&brute, origin, direction, scene->view.near_distance, rgba);
    for (int k = 0; k < 3; k++) rgba[k] *= brightest;
    for (int k = 0; k < 4; k++) {
      if (scene->optics.model == CELLIST_MODEL_ABSORPTION && k < 3) continue; /* black: brute force knows no colours */
      if (scene->optics.model == CELLIST_MODEL_EMISSION && k == 3) continue;
      worst = fmax(worst, fabs((double)(rgba[k] - made->rgba[4 * i + (size_t)k])));
      peak = fmax(peak, fabs((double)rgba[k]));
    }
  }
  brute_end(&brute);
  return peak > 0 ? worst / peak : worst;
}

/* The same scene with every length 2^40 times as long, which changes no bit of any quotient. */
static double against_scaled_copy(cellist_context *context, const stability_scene *scene, const picture *made) {
  static const double SCALE = 0x1p40;
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(scene->mesh);
  double *positions = malloc(3 * a->point_count * sizeof(double) + 1);
  for (size_t i = 0; i < 3 * a->point_count; i++) positions[i] = SCALE * a->positions[i];
  const cellist_mesh_desc desc = {a->point_count, positions, a->tet_count, a->tets, NULL, a->field_count, a->fields};
  stability_scene copy = *scene;
  copy.mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &copy.mesh));
  copy.transfer.knots = copy.knots;
  for (size_t k = 0; k < copy.transfer.knot_count; k++) copy.knots[k].extinction /= SCALE;
  copy.optics.light.gradient_unit /= SCALE;
  for (int k = 0; k < 3; k++) {
    copy.view.eye[k] *= SCALE;
    copy.view.target[k] *= SCALE;
  }
  copy.view.near_distance *= SCALE;
  copy.view.parallel_height *= SCALE;
  cellist_scalar scalar;
  assert_success(context, cellist_scalar_select(context, copy.mesh, NULL, &scalar));
  picture scaled = draw(context, &copy, &scalar);
  double worst = 0, peak = 0;
  for (size_t i = 0; i < 4 * (size_t)scene->width * scene->height; i++) {
    worst = fmax(worst, fabs(scaled.rgba[i] - made->rgba[i]));
    peak = fmax(peak, fabs(made->rgba[i]));
  }
  free(scaled.rgba);
  free(positions);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(copy.mesh);
  return peak > 0 ? worst / peak : worst;
}

static void run(stability_group group) {
  size_t failed = 0;
  for (size_t i = 0; stability_case_at(i) != NULL; i++) {
    const stability_case *which = stability_case_at(i);
    if (which->group != group) continue;
    cellist_context *context = harness_context(2);
    stability_scene scene;
    cellist_scalar scalar;
    assert_success(context, stability_build(context, which, &scene));
    assert_success(context, cellist_scalar_select(context, scene.mesh, NULL, &scalar));
    picture made = draw(context, &scene, &scalar);
    for (size_t p = 0; p < 4 * (size_t)scene.width * scene.height; p++) assert_true(isfinite(made.rgba[p]));
    const double scaled = against_scaled_copy(context, &scene, &made);
    /* Brute force counts both cells where a ray lies in their face. */
    const bool has_oracle =
        is_volume(&scene) && which->expectation == STABILITY_PICTURE && strcmp(which->name, "rays-in-faces") != 0;
    const double brute = has_oracle ? against_brute_force(&scene, &scalar, &made) : 0;
    /* Where the proved bound says that doubles are at their end, cells of 1e-10 of the mesh, they may be; and at 1e9
     * brute force's own 80 bits end at 5e-8 of a range of 1e-3. */
    const bool is_thin = made.stats.error_bound > 1e-3 && which->group == STABILITY_SHAPE;
    const double limit = is_thin ? 1e-4 : strcmp(which->name, "scalars-offset-1e9") == 0 ? 1e-7 : 1e-9;
    const bool has_bound = scene.optics.light.enabled || isfinite(made.stats.error_bound);
    const bool fails = !(scaled <= 1e-13) || !(brute <= limit) || !has_bound;
    printf("%-22s bound %.0e, scaled copy %.1e, %s %.1e%s\n", which->name, made.stats.error_bound, scaled,
           has_oracle ? "brute force" : "no oracle", brute, fails ? " FAILS" : "");
    failed += fails;
    free(made.rgba);
    cellist_scalar_release(context, &scalar);
    stability_scene_release(&scene);
    harness_context_destroy(context);
  }
  if (failed > 0) fail_msg("%zu cases fail", failed);
}

TEST(stiff_cases)
{ run(STABILITY_STIFF); }
TEST(shapes)
{ run(STABILITY_SHAPE); }
TEST(frames)
{ run(STABILITY_FRAME); }
TEST(views)
{ run(STABILITY_VIEW); }
