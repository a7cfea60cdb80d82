/* SPDX-License-Identifier: BSD-3-Clause
 * Pipeline: one object from mesh to picture. */
#include <cellist/compare.h>
#include <cellist/pipeline.h>
#include <math.h>
#include <string.h>

#include "harness.h"

static cellist_result draw(cellist_context *context, const cellist_pipeline_desc *desc, cellist_image **image,
                           cellist_pipeline_stats *stats) {
  cellist_pipeline *pipeline = NULL;
  cellist_result result = cellist_pipeline_create(context, desc, &pipeline);
  if (result == CELLIST_SUCCESS) result = cellist_pipeline_draw(pipeline, NULL, 32, 24, image, stats);
  cellist_pipeline_destroy(pipeline);
  return result;
}

static cellist_result draw_and_release(cellist_context *context, void *user) {
  cellist_image *image = NULL;
  const cellist_result result = draw(context, user, &image, NULL);
  cellist_image_destroy(image);
  return result;
}

TEST(failed_allocations_leak_nothing)
{
  cellist_pipeline_desc desc = {.source = "sample:grid:48", .renderer = CELLIST_RENDERER_CAST};
  check_allocation_failures(draw_and_release, &desc);
  desc.precision = CELLIST_PRECISION_REFERENCE;
  check_allocation_failures(draw_and_release, &desc);
  desc.renderer = CELLIST_RENDERER_SOFT;
  check_allocation_failures(draw_and_release, &desc);
}

TEST(every_renderer_draws_the_same_picture)
{
  cellist_context *context = harness_context(2);
  cellist_pipeline_desc desc = {.source = "sample:gears",
                                .optics = {.unit_diagonal_fraction = 50},
                                .renderer = CELLIST_RENDERER_CAST,
                                .precision = CELLIST_PRECISION_REFERENCE};
  cellist_image *reference = NULL;
  assert_success(context, draw(context, &desc, &reference, NULL));
  static const cellist_renderer renderers[] = {CELLIST_RENDERER_SOFT, CELLIST_RENDERER_FACES, CELLIST_RENDERER_FAN,
                                               CELLIST_RENDERER_AUTO};
  desc.precision = CELLIST_PRECISION_FAST;
  for (size_t i = 0; i < sizeof renderers / sizeof renderers[0]; i++) {
    cellist_image *image = NULL;
    cellist_image_error error;
    desc.renderer = renderers[i];
    assert_success(context, draw(context, &desc, &image, NULL));
    assert_success(context, cellist_image_compare(context, image, reference, &error, NULL));
    assert_true(error.covered_pixels > 50 && error.rmse < (renderers[i] == CELLIST_RENDERER_FAN ? 1e-3 : 1e-5));
    cellist_image_destroy(image);
  }
  cellist_image_destroy(reference);
  harness_context_destroy(context);
}

/* Gears whose teeth lie in front of each other in circles. */
TEST(cycles_are_exact_through_opengl)
{
  cellist_pipeline_desc desc = {.source = shared_data("gears_t.vtu"),
                                .optics = {.unit_diagonal_fraction = 50},
                                .renderer = CELLIST_RENDERER_CAST,
                                .precision = CELLIST_PRECISION_REFERENCE};
  cellist_context *context = harness_context(2);
  cellist_image *images[2] = {NULL, NULL};
  cellist_pipeline_stats stats;
  for (int i = 0; i < 2; i++) {
    cellist_pipeline *pipeline = NULL;
    assert_success(context, cellist_pipeline_create(context, &desc, &pipeline));
    assert_success(context, cellist_pipeline_draw(pipeline, NULL, 128, 128, &images[i], &stats));
    cellist_pipeline_destroy(pipeline);
    desc.renderer = CELLIST_RENDERER_FACES;
    desc.precision = CELLIST_PRECISION_FAST;
  }
  cellist_image_error error;
  assert_success(context, cellist_image_compare(context, images[1], images[0], &error, NULL));
  assert_true(stats.group_count > 0 && stats.cells_in_groups > 0);
  assert_string_equal(stats.order, "exact");
  if (!(error.rmse < 1e-6 && error.max_abs < 1e-4)) fail_msg("rmse %g, max %g", error.rmse, error.max_abs);
  cellist_image_destroy(images[0]);
  cellist_image_destroy(images[1]);
  harness_context_destroy(context);
}

TEST(a_picture_says_how_it_was_made)
{
  cellist_context *context = harness_context(2);
  const cellist_pipeline_desc desc = {.source = "sample:grid:384", .optics = {.unit_diagonal_fraction = 50}};
  cellist_image *image = NULL;
  cellist_pipeline_stats stats;
  assert_success(context, draw(context, &desc, &image, &stats));
  assert_non_null(strstr(cellist_image_attribute(image, "owner"), "cellist"));
  assert_non_null(strstr(cellist_image_attribute(image, "cellist camera"), "perspective eye "));
  assert_non_null(strstr(cellist_image_attribute(image, "cellist optics"), "unstructured"));
  assert_non_null(strstr(cellist_image_attribute(image, "cellist method"), stats.renderer));
  size_t covered = 0;
  for (size_t i = 0; i < 32 * 24; i++) {
    const float alpha = cellist_image_channel(image, "A")[i], z = cellist_image_channel(image, "Z")[i];
    covered += alpha > 0;
    assert_true(isfinite(z) == (alpha > 0));
  }
  assert_true(covered > 100 && stats.fragments > covered && stats.transfer_knots == 5);
  cellist_image_destroy(image);
  harness_context_destroy(context);
}

TEST(opacity_scale_thickens)
{
  cellist_context *context = harness_context(1);
  double sum[2] = {0, 0};
  for (int i = 0; i < 2; i++) {
    const cellist_pipeline_desc desc = {.source = "sample:grid:384", .optics = {.opacity_scale = i == 0 ? 0.5 : 2}};
    cellist_image *image = NULL;
    assert_success(context, draw(context, &desc, &image, NULL));
    for (size_t k = 0; k < 32 * 24; k++) sum[i] += cellist_image_channel(image, "A")[k];
    cellist_image_destroy(image);
  }
  assert_true(sum[0] > 0 && sum[1] > 1.2 * sum[0]);
  harness_context_destroy(context);
}

TEST(samples_take_a_seed_and_parts)
{
  cellist_context *context = harness_context(1);
  static const char *const sources[] = {"sample:grid:384,perturb=0.3,seed=7", "sample:grid:384,seed=7,perturb=0.3",
                                        "sample:grid:384,perturb=0.3,seed=8", "sample:cyclic,parts=9"};
  cellist_mesh *meshes[4] = {NULL};
  for (int i = 0; i < 4; i++) assert_success(context, cellist_pipeline_load(context, sources[i], NULL, &meshes[i]));
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(meshes[0]), *b = cellist_mesh_get_arrays(meshes[1]);
  const cellist_mesh_arrays *c = cellist_mesh_get_arrays(meshes[2]);
  assert_memory_equal(a->positions, b->positions, 3 * a->point_count * sizeof *a->positions);
  assert_true(memcmp(a->positions, c->positions, 3 * a->point_count * sizeof *a->positions) != 0);
  assert_int_equal(cellist_mesh_get_arrays(meshes[3])->tet_count, 9);
  cellist_mesh *none = NULL;
  assert_failure(context, cellist_pipeline_load(context, "sample:grid:384,colour=2", NULL, &none),
                 CELLIST_ERROR_INVALID_ARGUMENT, "perturb=P");
  assert_failure(context, cellist_pipeline_load(context, "sample:grid,seed=-2", NULL, &none),
                 CELLIST_ERROR_INVALID_ARGUMENT, "seed=N");
  assert_failure(context, cellist_pipeline_load(context, "sample:grid,perturb=3", NULL, &none),
                 CELLIST_ERROR_INVALID_ARGUMENT, "perturb is 3");
  assert_null(none);
  for (int i = 0; i < 4; i++) cellist_mesh_destroy(meshes[i]);
  harness_context_destroy(context);
}

TEST(a_program_s_own_mesh_and_transfer_function_give_the_same_picture)
{
  cellist_context *context = harness_context(1);
  cellist_pipeline_desc desc = {.source = "sample:grid:384", .optics = {.unit_distance = 0.5}};
  cellist_image *images[2] = {NULL};
  assert_success(context, draw(context, &desc, &images[0], NULL));
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar;
  cellist_transfer transfer;
  assert_success(context, cellist_pipeline_load(context, desc.source, NULL, &mesh));
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scalar));
  const cellist_transfer_desc wanted = {.range = {scalar.minimum, scalar.maximum}, .unit_distance = 0.5};
  assert_success(context, cellist_transfer_load(context, &wanted, &transfer));
  const cellist_pipeline_desc own = {.mesh = mesh, .optics = {.function = &transfer}};
  assert_success(context, draw(context, &own, &images[1], NULL));
  for (int k = 0; k < 4; k++)
    assert_memory_equal(cellist_image_channel(images[0], &"R\0G\0B\0A"[2 * k]),
                        cellist_image_channel(images[1], &"R\0G\0B\0A"[2 * k]), 32 * 24 * sizeof(float));
  transfer.knots[1].extinction = -1;
  cellist_image *none = NULL;
  assert_failure(context, draw(context, &own, &none, NULL), CELLIST_ERROR_INVALID_ARGUMENT, "knot");
  cellist_image_destroy(images[0]);
  cellist_image_destroy(images[1]);
  cellist_transfer_release(context, &transfer);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(what_does_not_exist_is_named)
{
  cellist_context *context = harness_context(1);
  cellist_image *image = NULL;
  cellist_pipeline_desc desc = {.source = "sample:nonsense"};
  assert_failure(context, draw(context, &desc, &image, NULL), CELLIST_ERROR_NOT_FOUND, "nonsense");
  desc.source = "sample:grid:minus";
  assert_failure(context, draw(context, &desc, &image, NULL), CELLIST_ERROR_INVALID_ARGUMENT, "size");
  desc.source = "no/such/mesh.vtu";
  assert_failure(context, draw(context, &desc, &image, NULL), CELLIST_ERROR_IO, "no/such/mesh.vtu");
  desc.source = "sample:grid";
  desc.optics.scalar = "nonsense";
  assert_failure(context, draw(context, &desc, &image, NULL), CELLIST_ERROR_NOT_FOUND, "no scalar 'nonsense'");
  assert_null(image);
  harness_context_destroy(context);
}

/* What a picture of two spheres' tets says about its order and its pixels. */
static double error_of(cellist_context *context, const cellist_pipeline_desc *desc, const cellist_image *reference,
                       const char *order) {
  cellist_image *image = NULL;
  cellist_pipeline_stats stats;
  cellist_image_error error;
  assert_success(context, draw(context, desc, &image, &stats));
  assert_string_equal(stats.order, order);
  assert_success(context, cellist_image_compare(context, image, reference, &error, NULL));
  cellist_image_destroy(image);
  return error.rmse;
}

TEST(wrong_orders_and_narrow_framebuffers_show)
{
  cellist_context *context = harness_context(2);
  cellist_pipeline_desc desc = {.source = "sample:ball:3000",
                                .optics = {.transfer = "dense", .unit_diagonal_fraction = 10},
                                .precision = CELLIST_PRECISION_REFERENCE,
                                .renderer = CELLIST_RENDERER_CAST};
  cellist_image *reference = NULL;
  assert_success(context, draw(context, &desc, &reference, NULL));
  desc.renderer = CELLIST_RENDERER_SOFT;
  assert_true(error_of(context, &desc, reference, "exact") < 1e-5);
  desc.sorting = CELLIST_SORTING_CENTROID;
  const double centroid = error_of(context, &desc, reference, "approximate");
  desc.sorting = CELLIST_SORTING_NONE;
  const double unsorted = error_of(context, &desc, reference, "approximate");
  print_message("by centroids %g, unsorted %g\n", centroid, unsorted);
  assert_true(centroid > 1e-5 && unsorted > 2 * centroid);
  cellist_image_destroy(reference);
  harness_context_destroy(context);
}

TEST(segments_are_estimated_without_drawing)
{
  static const char *const sources[] = {"sample:ball:5000", "sample:torus", "sample:gears", "sample:swiss-cheese"};
  cellist_context *context = harness_context(2);
  for (size_t i = 0; i < 8; i++) {
    /* Thin, so that no ray ends early. */
    const cellist_pipeline_desc desc = {
        .source = sources[i / 2], .renderer = CELLIST_RENDERER_CAST, .optics = {.opacity_scale = 0.01}};
    cellist_pipeline *pipeline = NULL;
    cellist_image *image = NULL;
    cellist_pipeline_stats stats;
    cellist_frame frame;
    assert_success(context, cellist_pipeline_create(context, &desc, &pipeline));
    const cellist_mesh *mesh = cellist_pipeline_mesh(pipeline);
    cellist_view view = cellist_view_orbit(cellist_mesh_get_arrays(mesh)->bounds, 40, 20);
    if (i % 2 == 1) view.parallel_height = 1.2 * fabs(view.eye[0] - view.target[0]);
    assert_success(context, cellist_frame_from_view(context, &view, 128, 128, &frame));
    assert_success(context, cellist_pipeline_draw(pipeline, &view, 128, 128, &image, &stats));
    const double estimated = cellist_pipeline_estimate_fragments(mesh, &frame);
    print_message("%s: %g estimated, %llu drawn\n", desc.source, estimated, (unsigned long long)stats.fragments);
    assert_true(fabs(estimated / (double)stats.fragments - 1) < 0.03);
    cellist_image_destroy(image);
    cellist_pipeline_destroy(pipeline);
  }
  harness_context_destroy(context);
}
