/* SPDX-License-Identifier: BSD-3-Clause
 * Clip planes and boxes in every renderer: closed forms, each renderer against the reference, planes that say the same
 * in other words. */
#include <cellist/compare.h>
#include <stdio.h>

#include "stage.h"

enum { SIZE = 48 };

static cellist_clip_plane random_plane(random_state *random, const double centre[3], double radius) {
  cellist_clip_plane plane = {.offset = random_between(random, -0.2, 0.9) * radius};
  double length = 0;
  for (int k = 0; k < 3; k++) {
    plane.normal[k] = random_between(random, -1, 1);
    length += plane.normal[k] * plane.normal[k];
  }
  length = sqrt(length);
  plane.offset *= length;
  for (int k = 0; k < 3; k++) plane.offset += plane.normal[k] * centre[k];
  return plane;
}

/* Length of the ray inside the box and on the kept side of all planes, beyond the near plane: in long double, plane by
 * plane. *nearest: how near the ray comes to where the answer jumps. */
static long double kept_length(const cellist_view *view, const cellist_frame *frame, const double low[3],
                               const double high[3], double x, double y) {
  double origin[3], direction[3];
  cellist_frame_ray(frame, x, y, origin, direction);
  long double front = view->near_distance, back = HUGE_VALL, stretch = 0;
  for (uint32_t i = 0; i < 6 + view->clip_count; i++) {
    long double speed = 0, left;
    if (i < 6) {
      const int k = (int)i % 3;
      speed = i < 3 ? -direction[k] : direction[k];
      left = i < 3 ? (long double)origin[k] - low[k] : (long double)high[k] - origin[k];
    } else {
      const cellist_clip_plane *plane = &view->clips[i - 6];
      left = plane->offset;
      for (int k = 0; k < 3; k++) {
        speed += (long double)plane->normal[k] * direction[k];
        left -= (long double)plane->normal[k] * origin[k];
      }
    }
    if (speed > 0)
      back = fminl(back, left / speed);
    else if (speed < 0)
      front = fmaxl(front, left / speed);
    else if (left < 0)
      return 0;
  }
  for (int k = 0; k < 3; k++) stretch += (long double)direction[k] * direction[k];
  return front < back ? (back - front) * sqrtl(stretch) : 0;
}

/* Constant extinction and colour: c (1 - exp(-e l)), whatever the cells. Random planes, boxes, both, near planes too.
 */
TEST(a_clipped_slab_matches_the_closed_form)
{
  static cellist_transfer_knot knot[] = {{0, 1.3, {0.9, 0.4, 0.1}}};
  const cellist_transfer transfer = {1, knot};
  const double low[3] = {1, 2, -1}, high[3] = {3, 3.5, 1}, centre[3] = {2, 2.75, 0}, radius = 1.6;
  static const double tolerance[RENDERER_COUNT] = {1e-12, 2e-6, 2e-6, 2e-6, 1e-5};
  cellist_context *context = harness_context(2);
  stage made;
  const double slope[3] = {0.3, 0.2, 0.1};
  stage_open(&made, context, stage_box(context, 3, low, high, 0.1, slope), &transfer, 1);
  random_state random = {7};
  size_t compared = 0;
  for (int round = 0; round < 8; round++) {
    cellist_view view = stage_random_view(&random, centre, radius, round);
    if (round % 3 == 2) view.near_distance = 2.3 * radius;
    const int planes = round % 4;
    for (int i = 0; i < planes; i++) view.clips[view.clip_count++] = random_plane(&random, centre, radius);
    if (round % 4 != 1) {
      double box[6];
      for (int k = 0; k < 3; k++) {
        box[k] = low[k] + random_between(&random, -0.2, 0.4) * (high[k] - low[k]);
        box[3 + k] = high[k] + random_between(&random, -0.4, 0.2) * (high[k] - low[k]);
      }
      assert_true(cellist_view_clip_box(&view, box));
    }
    cellist_frame frame;
    assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frame));
    for (int renderer = 0; renderer < RENDERER_COUNT; renderer++) {
      cellist_image *image = stage_draw(&made, renderer, &frame, NULL);
      for (uint32_t i = 0; i < SIZE * SIZE; i++) {
        const double x = i % SIZE + 0.5, y = i / SIZE + 0.5;
        const long double length = kept_length(&view, &frame, low, high, x, y);
        compared += length > 0;
        for (size_t c = 0; c < 4; c++) {
          const double truth = (double)(-expm1l(-1.3L * length)) * (c < 3 ? knot[0].colour[c] : 1);
          const double got = stage_value(image, c, i);
          /* Images hold floats. */
          if (!(fabs(got - truth) <= tolerance[renderer] + 0x1p-24))
            fail_msg("%s, view %d, pixel %g %g, channel %zu: %.9g instead of %.9g", RENDERER_NAMES[renderer], round, x,
                     y, c, got, truth);
        }
      }
      cellist_image_destroy(image);
    }
  }
  assert_true(compared > 5000);
  stage_close(&made);
  harness_context_destroy(context);
}

static void compare_on_sample(const char *name, uint64_t seed, const double rmse[RENDERER_COUNT]) {
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  const cellist_generate_desc desc = {.size = 2500};
  assert_success(context, cellist_generate(context, name, &desc, &mesh));
  const double *b = cellist_mesh_get_arrays(mesh)->bounds;
  const double radius = 0.5 * hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2]);
  const double centre[3] = {0.5 * (b[0] + b[3]), 0.5 * (b[1] + b[4]), 0.5 * (b[2] + b[5])};
  stage made;
  stage_open(&made, context, mesh, NULL, radius / 10);
  random_state random = {seed};
  size_t covered = 0;
  for (int round = 0; round < 6; round++) {
    cellist_view view = stage_random_view(&random, centre, radius, round);
    for (int i = 0; i <= round % 3; i++) view.clips[view.clip_count++] = random_plane(&random, centre, radius);
    cellist_frame frame;
    assert_success(context, cellist_frame_from_view(context, &view, 2 * SIZE, 2 * SIZE, &frame));
    cellist_image *reference = stage_draw(&made, BY_REFERENCE, &frame, NULL);
    for (int renderer = 1; renderer < RENDERER_COUNT; renderer++) {
      cellist_image *image = stage_draw(&made, renderer, &frame, NULL);
      cellist_image_error error;
      assert_success(context, cellist_image_compare(context, image, reference, &error, NULL));
      covered += error.covered_pixels;
      if (!(error.rmse <= rmse[renderer] && error.max_abs <= 2e-3))
        fail_msg("seed %llu, view %d, %s: rmse %.3g, max %.3g", (unsigned long long)seed, round,
                 RENDERER_NAMES[renderer], error.rmse, error.max_abs);
      /* Depths are those of the reference, too, wherever both see much. */
      for (uint32_t i = 0; i < 4 * SIZE * SIZE; i++) {
        if (stage_value(reference, 3, i) < 0.01f) continue;
        for (size_t c = 4; c < 6; c++)
          if (!(fabsf(stage_value(image, c, i) - stage_value(reference, c, i)) <= 1e-3f * (float)radius))
            fail_msg("seed %llu, view %d, %s, pixel %u: %s is %g instead of %g", (unsigned long long)seed, round,
                     RENDERER_NAMES[renderer], i, CHANNELS[c], stage_value(image, c, i), stage_value(reference, c, i));
      }
      cellist_image_destroy(image);
    }
    cellist_image_destroy(reference);
  }
  assert_true(covered > 10000);
  stage_close(&made);
  harness_context_destroy(context);
}

TEST(random_planes_through_a_ball_agree_with_the_reference)
{
  static const double rmse[RENDERER_COUNT] = {0, 1e-5, 1e-5, 1e-5, 1e-5};
  compare_on_sample("ball", 11, rmse);
}

TEST(random_planes_through_gears_agree_with_the_reference)
{
  static const double rmse[RENDERER_COUNT] = {0, 5e-5, 5e-5, 5e-5, 5e-5};
  compare_on_sample("gears", 12, rmse);
}

/* -forward . x <= -(forward . eye + D) is a near plane in other words. */
TEST(a_plane_across_the_line_of_sight_is_a_near_plane)
{
  cellist_context *context = harness_context(2);
  const double low[3] = {0, 0, 0}, high[3] = {2, 1, 1}, slope[3] = {0.5, 0.1, 0.3}, centre[3] = {1, 0.5, 0.5};
  stage made;
  stage_open(&made, context, stage_box(context, 4, low, high, 0, slope), NULL, 0.2);
  random_state random = {3};
  for (int round = 0; round < 4; round++) {
    cellist_view view = stage_random_view(&random, centre, 1.2, round);
    cellist_frame frames[2];
    view.near_distance = round == 3 ? 0.3 : 3;
    assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frames[0]));
    cellist_clip_plane *plane = &view.clips[view.clip_count++];
    plane->offset = -view.near_distance;
    for (int k = 0; k < 3; k++) {
      plane->normal[k] = -frames[0].forward[k];
      plane->offset -= frames[0].forward[k] * frames[0].eye[k];
    }
    view.near_distance = 0;
    assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frames[1]));
    for (int renderer = 0; renderer < RENDERER_COUNT; renderer++) {
      cellist_image *images[2];
      for (int i = 0; i < 2; i++) images[i] = stage_draw(&made, renderer, &frames[i], NULL);
      double seen = 0;
      for (uint32_t i = 0; i < SIZE * SIZE; i++)
        for (size_t c = 0; c < 4; c++) {
          seen += stage_value(images[0], c, i);
          const float difference = fabsf(stage_value(images[0], c, i) - stage_value(images[1], c, i));
          if (!(difference <= 2e-6f))
            fail_msg("%s, view %d, pixel %u: %g", RENDERER_NAMES[renderer], round, i, difference);
        }
      assert_true(seen > 100);
      for (int i = 0; i < 2; i++) cellist_image_destroy(images[i]);
    }
  }
  stage_close(&made);
  harness_context_destroy(context);
}

TEST(clipping_everything_leaves_an_empty_picture_and_a_large_box_changes_nothing)
{
  cellist_context *context = harness_context(1);
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1}, slope[3] = {0.5, 0.1, 0.3};
  const double none[6] = {0.2, 2, 0.2, 0.8, 3, 0.8}, all[6] = {-5, -5, -5, 5, 5, 5};
  stage made;
  stage_open(&made, context, stage_box(context, 2, low, high, 0, slope), NULL, 0.1);
  static const cellist_model models[] = {CELLIST_MODEL_EMISSION_ABSORPTION, CELLIST_MODEL_ABSORPTION,
                                         CELLIST_MODEL_EMISSION, CELLIST_MODEL_MAXIMUM, CELLIST_MODEL_ISOSURFACES};
  const cellist_isosurface iso = {0.45, 1};
  for (int parallel = 0; parallel < 2; parallel++)
    for (int m = 0; m < 5; m++) {
      const cellist_optics optics = {.model = models[m], .iso_count = 1, .isos = &iso};
      cellist_view views[3];
      cellist_frame frames[3];
      for (int i = 0; i < 3; i++) {
        views[i] = cellist_view_orbit(made.arrays->bounds, 20, 30);
        if (parallel) views[i].parallel_height = 2;
        if (i > 0) assert_true(cellist_view_clip_box(&views[i], i == 1 ? none : all));
        assert_success(context, cellist_frame_from_view(context, &views[i], SIZE, SIZE, &frames[i]));
      }
      for (int renderer = 0; renderer < RENDERER_COUNT; renderer++) {
        cellist_image *plain = stage_draw(&made, renderer, &frames[0], &optics);
        if (plain == NULL) continue;
        cellist_image *empty = stage_draw(&made, renderer, &frames[1], &optics);
        cellist_image *full = stage_draw(&made, renderer, &frames[2], &optics);
        double seen = 0;
        for (uint32_t i = 0; i < SIZE * SIZE; i++) {
          for (size_t c = 0; c < 4; c++) {
            assert_true(stage_value(empty, c, i) == 0);
            seen += stage_value(plain, c, i);
            assert_true(fabsf(stage_value(full, c, i) - stage_value(plain, c, i)) <= 1e-6f);
          }
          assert_true(isinf(stage_value(empty, 4, i)) && stage_value(empty, 5, i) == 0);
        }
        assert_true(seen > 100 || models[m] == CELLIST_MODEL_ISOSURFACES);
        cellist_image_destroy(plain);
        cellist_image_destroy(empty);
        cellist_image_destroy(full);
      }
    }
  stage_close(&made);
  harness_context_destroy(context);
}

TEST(intervals_know_planes_along_the_ray_and_huge_or_tiny_normals)
{
  cellist_context *context = harness_context(1);
  cellist_view view = {.eye = {0, 0, 0}, .target = {1, 0, 0}, .up = {0, 0, 1}, .fovy_degrees = 40, .clip_count = 2};
  static const double scales[] = {1, 3, 1e300, 1e-300, 0x1p-1060};
  for (size_t s = 0; s < sizeof scales / sizeof *scales; s++) {
    const double scale = scales[s];
    view.clips[0] = (cellist_clip_plane){{scale, 0, 0}, 4 * scale};   /* x <= 4 */
    view.clips[1] = (cellist_clip_plane){{-scale, 0, 0}, -2 * scale}; /* x >= 2 */
    cellist_frame frame;
    double origin[3], direction[3], interval[2];
    assert_success(context, cellist_frame_from_view(context, &view, 11, 11, &frame));
    cellist_frame_ray(&frame, 5.5, 5.5, origin, direction);
    cellist_frame_interval(&frame, origin, direction, interval);
    assert_true(interval[0] == 2 && interval[1] == 4);
  }
  /* The middle ray runs along the plane y = 0.1, or -0.1, and is kept or not. */
  for (int side = 0; side < 2; side++) {
    view.clip_count = 1;
    view.clips[0] = (cellist_clip_plane){{0, 1, 0}, side ? 0.1 : -0.1};
    cellist_frame frame;
    assert_success(context, cellist_frame_from_view(context, &view, 11, 11, &frame));
    const double origin[3] = {0, 0, 0}, direction[3] = {1, 0, 0};
    double interval[2];
    cellist_frame_interval(&frame, origin, direction, interval);
    assert_true(side ? interval[0] == 0 && isinf(interval[1]) && interval[1] > 0
                     : isinf(interval[0]) && interval[1] == -HUGE_VAL);
  }
  harness_context_destroy(context);
}

TEST(bad_planes_are_refused_by_number)
{
  cellist_context *context = harness_context(1);
  cellist_frame frame;
  cellist_view view = {.eye = {3, 0, 0}, .up = {0, 0, 1}, .fovy_degrees = 40, .clip_count = 2};
  view.clips[0] = (cellist_clip_plane){{1, 0, 0}, 1};
  assert_failure(context, cellist_frame_from_view(context, &view, 4, 4, &frame), CELLIST_ERROR_INVALID_ARGUMENT,
                 "clip plane 1");
  view.clips[1] = (cellist_clip_plane){{1, NAN, 0}, 1};
  assert_failure(context, cellist_frame_from_view(context, &view, 4, 4, &frame), CELLIST_ERROR_INVALID_ARGUMENT,
                 "clip plane 1");
  view.clips[1] = (cellist_clip_plane){{1, 0, 0}, INFINITY};
  assert_failure(context, cellist_frame_from_view(context, &view, 4, 4, &frame), CELLIST_ERROR_INVALID_ARGUMENT,
                 "clip plane 1");
  view.clip_count = CELLIST_MAX_CLIP_PLANES + 1;
  assert_failure(context, cellist_frame_from_view(context, &view, 4, 4, &frame), CELLIST_ERROR_INVALID_ARGUMENT,
                 "17 clip planes");
  const double box[6] = {0, 0, 0, 1, 1, 1};
  view.clip_count = CELLIST_MAX_CLIP_PLANES - 5;
  assert_false(cellist_view_clip_box(&view, box));
  assert_int_equal(view.clip_count, CELLIST_MAX_CLIP_PLANES - 5);
  view.clip_count = CELLIST_MAX_CLIP_PLANES - 6;
  assert_true(cellist_view_clip_box(&view, box));
  harness_context_destroy(context);
}
