/* SPDX-License-Identifier: BSD-3-Clause
 * Surfaces in the picture of every renderer: closed forms, each renderer against the reference, surfaces in front of,
 * behind, beside and around the volume, cut by clip planes, hit exactly on edges and vertices. */
#include <cellist/compare.h>

#include "shapes.h"
#include "stage.h"

enum { SIZE = 48 };

static const double TOLERANCE[RENDERER_COUNT] = {1e-7, 3e-6, 3e-6, 3e-6, 2e-5};

/* A box of constant extinction and colour, a large plane through it: what lies before the plane, and then the plane as
 * seen through it. */
static void check_plane(cellist_model model) {
  static cellist_transfer_knot knot[] = {{0, 0.9, {0.9, 0.4, 0.1}}};
  static const float paint[3] = {0.2f, 0.7f, 0.5f};
  const cellist_transfer transfer = {1, knot};
  const double low[3] = {0, 0, 0}, high[3] = {2, 1.5, 1}, centre[3] = {1, 0.75, 0.5}, radius = 1.4;
  cellist_context *context = harness_context(2);
  stage made;
  const double slope[3] = {0.3, 0.2, 0.1};
  stage_open(&made, context, stage_box(context, 3, low, high, 0.1, slope), &transfer, 1);
  random_state random = {21};
  size_t compared[2] = {0, 0};
  for (int round = 0; round < 8; round++) {
    cellist_view view = stage_random_view(&random, centre, radius, round);
    cellist_frame frame;
    assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frame));
    double through[3], u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) {
      through[k] = centre[k] + random_between(&random, -0.4, 0.4);
      n[k] = random_between(&random, -1, 1) - 2 * frame.forward[k];
    }
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) n[k] /= length;
    const int axis = fabs(n[0]) < 0.6 ? 0 : 1;
    for (int k = 0; k < 3; k++) u[k] = 20 * ((k == axis) - n[axis] * n[k]);
    for (int k = 0; k < 3; k++) v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
    cellist_surface *surface = shape_plane(context, through, u, v, 1 + (uint32_t)round, paint);
    const double facing = 0.2 + 0.8 * fabs(n[0] * frame.forward[0] + n[1] * frame.forward[1] + n[2] * frame.forward[2]);
    const cellist_optics optics = {.model = model};
    for (int renderer = 0; renderer < RENDERER_COUNT; renderer++) {
      cellist_image *image = stage_draw_with(&made, renderer, &frame, &optics, surface);
      if (image == NULL) continue;
      for (uint32_t i = 0; i < SIZE * SIZE; i++) {
        double origin[3], direction[3], speed = 0, t_plane = 0, stretch = 0;
        cellist_frame_ray(&frame, i % SIZE + 0.5, i / SIZE + 0.5, origin, direction);
        for (int k = 0; k < 3; k++) {
          speed += n[k] * direction[k];
          t_plane += n[k] * (through[k] - origin[k]);
          stretch += direction[k] * direction[k];
        }
        t_plane /= speed;
        if (!(t_plane > 0) || fabs(t_plane) > 10) t_plane = HUGE_VAL; /* behind the eye, or far outside */
        double front = 0, back = t_plane;
        for (int k = 0; k < 3; k++) {
          const double a = (low[k] - origin[k]) / direction[k], b = (high[k] - origin[k]) / direction[k];
          front = fmax(front, fmin(a, b));
          back = fmin(back, fmax(a, b));
        }
        const double depth = front < back ? 0.9 * (back - front) * sqrt(stretch) : 0;
        const bool behind = t_plane < HUGE_VAL, met = front < back;
        for (size_t c = 0; c < 4; c++) {
          const double own = c == 3 ? 1 : knot[0].colour[c], light = c == 3 ? 1 : paint[c] * facing;
          double truth = 0;
          switch (model) {
            case CELLIST_MODEL_ABSORPTION:
              truth = (c == 3 ? 1 - exp(-depth) : 0) + (behind ? exp(-depth) * light : 0);
              break;
            case CELLIST_MODEL_EMISSION: truth = (c == 3 ? 0 : own * depth) + (behind ? light : 0); break;
            case CELLIST_MODEL_MAXIMUM: truth = met ? own : behind ? light : 0; break;
            default: truth = own * (1 - exp(-depth)) + (behind ? exp(-depth) * light : 0);
          }
          const double got = stage_value(image, c, i);
          if (model == CELLIST_MODEL_MAXIMUM && fabs(back - front) < (renderer == BY_FACES ? 1e-4 : 1e-5))
            continue; /* met or not */
          if (!(fabs(got - truth) <= TOLERANCE[renderer]))
            fail_msg("%s, model %d, view %d, pixel %u, channel %zu: %.9g instead of %.9g", RENDERER_NAMES[renderer],
                     (int)model, round, i, c, got, truth);
        }
        if (behind)
          assert_true(fabs(stage_value(image, 5, i) - t_plane) <= 2e-6 * t_plane + (renderer == BY_FACES ? 2e-5 : 0));
        if (behind) assert_true(stage_value(image, 4, i) <= stage_value(image, 5, i));
        compared[met && behind]++;
      }
      cellist_image_destroy(image);
    }
    cellist_surface_destroy(surface);
  }
  assert_true(compared[0] > 1000 && compared[1] > 1000);
  stage_close(&made);
  harness_context_destroy(context);
}

TEST(a_plane_in_a_slab_is_seen_through_what_lies_before_it)
{ check_plane(CELLIST_MODEL_EMISSION_ABSORPTION); }
TEST(a_plane_behind_absorption_is_darkened)
{ check_plane(CELLIST_MODEL_ABSORPTION); }
TEST(a_plane_behind_emission_is_added_whole)
{ check_plane(CELLIST_MODEL_EMISSION); }
TEST(a_plane_shows_where_no_maximum_is_before_it)
{ check_plane(CELLIST_MODEL_MAXIMUM); }

/* Pixels whose neighbours see the surface at other depths: its silhouette, where OpenGL's grid may decide otherwise. */
static bool is_at_edge(const cellist_image *alone, uint32_t at, uint32_t width, uint32_t height, float step) {
  const uint32_t x = at % width, y = at / width;
  const float *z = cellist_image_channel(alone, "Z");
  for (int dy = -1; dy <= 1; dy++)
    for (int dx = -1; dx <= 1; dx++) {
      const int64_t i = (int64_t)x + dx, j = (int64_t)y + dy;
      if (i < 0 || j < 0 || i >= width || j >= height) continue;
      const float other = z[(uint32_t)j * width + (uint32_t)i];
      if (isinf(other) != isinf(z[at]) || (!isinf(other) && fabsf(other - z[at]) > step)) return true;
    }
  return false;
}

static void check_sphere(const char *name, uint64_t seed, bool smooth, const cellist_light *light) {
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  const cellist_generate_desc desc = {.size = 2500};
  assert_success(context, cellist_generate(context, name, &desc, &mesh));
  const double *b = cellist_mesh_get_arrays(mesh)->bounds;
  const double radius = 0.5 * hypot(hypot(b[3] - b[0], b[4] - b[1]), b[5] - b[2]);
  const double centre[3] = {0.5 * (b[0] + b[3]), 0.5 * (b[1] + b[4]), 0.5 * (b[2] + b[5])};
  stage made, nothing;
  stage_open(&made, context, mesh, NULL, radius / 4);
  const cellist_mesh_desc no_cells = {0};
  cellist_mesh *empty = NULL;
  assert_success(context, cellist_mesh_create(context, &no_cells, &empty));
  stage_open(&nothing, context, empty, NULL, 1);
  random_state random = {seed};
  size_t seen = 0, excused = 0;
  for (int round = 0; round < 5; round++) {
    cellist_view view = stage_random_view(&random, centre, radius, round);
    double middle[3];
    for (int k = 0; k < 3; k++) middle[k] = centre[k] + 0.3 * radius * random_between(&random, -1, 1);
    cellist_surface *surface = shape_sphere(context, middle, 0.35 * radius, 12, smooth);
    if (round > 1) { /* cut both */
      cellist_clip_plane *plane = &view.clips[view.clip_count++];
      plane->offset = 0.1 * radius;
      for (int k = 0; k < 3; k++) {
        plane->normal[k] = random_between(&random, -1, 1);
        plane->offset += plane->normal[k] * middle[k];
      }
    }
    cellist_frame frame;
    cellist_optics optics = {0};
    if (light != NULL) optics.light = *light;
    assert_success(context, cellist_frame_from_view(context, &view, 2 * SIZE, 2 * SIZE, &frame));
    cellist_image *alone = stage_draw_with(&nothing, BY_REFERENCE, &frame, NULL, surface);
    cellist_image *reference = stage_draw_with(&made, BY_REFERENCE, &frame, &optics, surface);
    for (uint32_t i = 0; i < 4 * SIZE * SIZE; i++) seen += stage_value(alone, 3, i) == 1;
    for (int renderer = 1; renderer < RENDERER_COUNT; renderer++) {
      cellist_image *image = stage_draw_with(&made, renderer, &frame, &optics, surface);
      if (image == NULL) continue;
      double sum = 0;
      for (uint32_t i = 0; i < 4 * SIZE * SIZE; i++) {
        double most = 0;
        for (size_t c = 0; c < 4; c++)
          most = fmax(most, fabs((double)stage_value(image, c, i) - stage_value(reference, c, i)));
        if (most > 2e-3 && renderer == BY_FACES && is_at_edge(alone, i, 2 * SIZE, 2 * SIZE, 0.1f * (float)radius)) {
          excused++;
          continue;
        }
        sum += most * most;
        if (!(most <= 2e-3))
          fail_msg("%s, seed %llu, %s, view %d, pixel %u: off by %g", name, (unsigned long long)seed,
                   RENDERER_NAMES[renderer], round, i, most);
      }
      const double rmse = sqrt(sum / (4 * SIZE * SIZE));
      if (!(rmse <= 1e-4)) fail_msg("%s, %s, view %d: rmse %g", name, RENDERER_NAMES[renderer], round, rmse);
      cellist_image_destroy(image);
    }
    cellist_image_destroy(alone);
    cellist_image_destroy(reference);
    cellist_surface_destroy(surface);
  }
  assert_true(seen > 2000 && excused <= seen / 500);
  stage_close(&made);
  stage_close(&nothing);
  harness_context_destroy(context);
}

TEST(a_sphere_in_a_ball_agrees_with_the_reference)
{ check_sphere("ball", 31, false, NULL); }
TEST(a_smooth_sphere_in_gears_agrees_with_the_reference)
{ check_sphere("gears", 32, true, NULL); }

TEST(a_lit_sphere_agrees_with_the_reference)
{
  const cellist_light light = {.enabled = true,
                               .direction = {0.3, -0.5, 0.7},
                               .ambient = 0.3,
                               .diffuse = 0.5,
                               .specular = 0.4,
                               .shininess = 20,
                               .gradient_unit = 1,
                               .cell_gradients = true};
  check_sphere("ball", 33, true, &light);
}

/* Renderer by renderer, what a surface changes of the picture without it. */
TEST(surfaces_hide_what_is_behind_them_and_nothing_else)
{
  cellist_context *context = harness_context(2);
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1}, slope[3] = {0.5, 0.1, 0.3};
  static const float paint[3] = {0.3f, 0.6f, 0.9f};
  stage made;
  stage_open(&made, context, stage_box(context, 3, low, high, 0, slope), NULL, 0.3);
  const cellist_view view = {.eye = {0.5, 0.5, 6}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy_degrees = 25};
  cellist_frame frame;
  assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frame));
  const double u[3] = {9, 0, 0}, v[3] = {0, 9, 0};
  const double in_front[3] = {0.5, 0.5, 3}, behind[3] = {0.5, 0.5, -3}, behind_eye[3] = {0.5, 0.5, 7};
  cellist_surface *front_plane = shape_plane(context, in_front, u, v, 2, paint);
  cellist_surface *back_plane = shape_plane(context, behind, u, v, 2, paint);
  cellist_surface *unseen = shape_plane(context, behind_eye, u, v, 2, paint);
  cellist_surface *empty = NULL;
  const cellist_surface_arrays none = {0};
  assert_success(context, cellist_surface_create(context, &none, &empty));
  const cellist_surface *const two[] = {unseen, back_plane, empty};
  cellist_surface *joined = NULL;
  assert_success(context, cellist_surface_join(context, two, 3, &joined));
  for (int renderer = 0; renderer < RENDERER_COUNT; renderer++) {
    cellist_image *plain = stage_draw(&made, renderer, &frame, NULL);
    cellist_image *hidden = stage_draw_with(&made, renderer, &frame, NULL, front_plane);
    cellist_image *over = stage_draw_with(&made, renderer, &frame, NULL, back_plane);
    cellist_image *same[2] = {stage_draw_with(&made, renderer, &frame, NULL, empty),
                              stage_draw_with(&made, renderer, &frame, NULL, unseen)};
    cellist_image *both = stage_draw_with(&made, renderer, &frame, NULL, joined);
    for (uint32_t i = 0; i < SIZE * SIZE; i++) {
      const float alpha = stage_value(plain, 3, i);
      for (size_t c = 0; c < 4; c++) {
        const float colour = c == 3 ? 1 : paint[c], own = stage_value(plain, c, i);
        assert_true(fabsf(stage_value(hidden, c, i) - colour) <= 1e-6f);
        assert_true(fabsf(stage_value(over, c, i) - (own + (1 - alpha) * colour)) <= 2e-6f);
        assert_true(fabsf(stage_value(both, c, i) - stage_value(over, c, i)) <= 1e-6f);
        for (int k = 0; k < 2; k++) assert_true(fabsf(stage_value(same[k], c, i) - own) <= 1e-6f);
      }
      assert_true(fabsf(stage_value(hidden, 4, i) - 3) < 1e-5f && fabsf(stage_value(hidden, 5, i) - 3) < 1e-5f);
      assert_true(fabsf(stage_value(over, 5, i) - 9) < 1e-5f);
      for (size_t c = 4; c < 6; c++)
        assert_true(stage_value(same[1], c, i) == stage_value(plain, c, i) ||
                    fabsf(stage_value(same[1], c, i) - stage_value(plain, c, i)) < 1e-5f);
    }
    cellist_image_destroy(plain);
    cellist_image_destroy(hidden);
    cellist_image_destroy(over);
    cellist_image_destroy(both);
    for (int k = 0; k < 2; k++) cellist_image_destroy(same[k]);
  }
  cellist_surface_destroy(front_plane);
  cellist_surface_destroy(back_plane);
  cellist_surface_destroy(unseen);
  cellist_surface_destroy(empty);
  cellist_surface_destroy(joined);
  stage_close(&made);
  harness_context_destroy(context);
}

TEST(clip_planes_and_the_near_plane_cut_surfaces)
{
  cellist_context *context = harness_context(1);
  const cellist_mesh_desc no_cells = {0};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &no_cells, &mesh));
  stage made;
  stage_open(&made, context, mesh, NULL, 1);
  const double centre[3] = {0, 0, 0};
  cellist_surface *sphere = shape_sphere(context, centre, 1, 24, true);
  for (int parallel = 0; parallel < 2; parallel++) {
    cellist_view view = {.eye = {0, -5, 0}, .up = {0, 0, 1}, .fovy_degrees = 30};
    if (parallel) view.parallel_height = 2.5;
    for (int cut = 0; cut < 4; cut++) {
      view.clip_count = 0;
      view.near_distance = 0;
      if (cut == 1) view.clips[view.clip_count++] = (cellist_clip_plane){{0, -1, 0}, 0}; /* y >= 0: the far half */
      if (cut == 2) view.near_distance = 5;                                              /* the same */
      if (cut == 3) view.clips[view.clip_count++] = (cellist_clip_plane){{0, 1, 0}, -2}; /* nothing */
      cellist_frame frame;
      assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frame));
      for (int renderer = 0; renderer < RENDERER_COUNT; renderer++) {
        cellist_image *image = stage_draw_with(&made, renderer, &frame, NULL, sphere);
        const uint32_t middle = SIZE / 2 * SIZE + SIZE / 2;
        const float z = stage_value(image, 4, middle), alpha = stage_value(image, 3, middle);
        if (cut == 3)
          assert_true(isinf(z) && alpha == 0);
        else
          assert_true(fabsf(z - (cut == 0 ? 4 : 6)) < 0.02f && alpha == 1);
        cellist_image_destroy(image);
      }
    }
  }
  cellist_surface_destroy(sphere);
  stage_close(&made);
  harness_context_destroy(context);
}

/* Triangles whose edges and vertices lie exactly on the rays of pixels: a closed surface has no holes there, seen from
 * outside or inside, by any renderer. */
TEST(rays_along_edges_and_through_vertices_find_no_holes)
{
  cellist_context *context = harness_context(1);
  const cellist_mesh_desc no_cells = {0};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &no_cells, &mesh));
  stage made;
  stage_open(&made, context, mesh, NULL, 1);
  enum { N = 16 };
  static const float paint[3] = {1, 1, 1};
  /* In parallel, pixel centres lie at multiples of 1; the grid's vertices too. */
  const double u[3] = {N, 0, 0}, v[3] = {0, N, 0}, middle[3] = {0, 0, 0};
  cellist_surface *grid = shape_plane(context, middle, u, v, N, paint);
  const cellist_view above = {.eye = {0, 0, 9}, .up = {0, 1, 0}, .parallel_height = 2 * N - 1};
  /* From the centre of a cube of such grids, vertices at whole multiples of the same slope. */
  cellist_surface *sides[6], *cube = NULL;
  for (int s = 0; s < 6; s++) {
    double at[3] = {0, 0, 0}, along[3] = {0, 0, 0}, across[3] = {0, 0, 0};
    at[s % 3] = s < 3 ? N : -N;
    along[(s + 1) % 3] = across[(s + 2) % 3] = N;
    sides[s] = shape_plane(context, at, along, across, N, paint);
  }
  assert_success(context, cellist_surface_join(context, (const cellist_surface *const *)sides, 6, &cube));
  const cellist_view inside = {.eye = {0, 0, 0}, .target = {1, 0, 0}, .up = {0, 0, 1}, .fovy_degrees = 90};
  const cellist_view corner = {.eye = {0, 0, 0}, .target = {1, 1, 1}, .up = {0, 0, 1}, .fovy_degrees = 120};
  const struct {
    const cellist_view *view;
    const cellist_surface *surface;
    uint32_t size;
  } looks[] = {{&above, grid, 2 * N - 1}, {&inside, cube, 2 * N}, {&inside, cube, 2 * N + 1}, {&corner, cube, 33}};
  for (size_t l = 0; l < sizeof looks / sizeof *looks; l++) {
    cellist_frame frame;
    assert_success(context, cellist_frame_from_view(context, looks[l].view, looks[l].size, looks[l].size, &frame));
    for (int renderer = 0; renderer < RENDERER_COUNT; renderer++) {
      cellist_image *image = stage_draw_with(&made, renderer, &frame, NULL, looks[l].surface);
      for (uint32_t i = 0; i < looks[l].size * looks[l].size; i++)
        if (stage_value(image, 3, i) != 1) fail_msg("%s, look %zu: a hole at pixel %u", RENDERER_NAMES[renderer], l, i);
      cellist_image_destroy(image);
    }
  }
  for (int s = 0; s < 6; s++) cellist_surface_destroy(sides[s]);
  cellist_surface_destroy(cube);
  cellist_surface_destroy(grid);
  stage_close(&made);
  harness_context_destroy(context);
}

/* The mesh's own boundary hides the whole volume, from outside. */
TEST(a_meshs_own_boundary_leaves_nothing_of_its_volume)
{
  cellist_context *context = harness_context(2);
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1}, slope[3] = {0.5, 0.1, 0.3};
  stage made;
  stage_open(&made, context, stage_box(context, 3, low, high, 0, slope), NULL, 0.02);
  const double paint[3] = {0, 1, 0};
  const cellist_surface_cells cells = {.mesh = made.mesh, .colour = paint};
  cellist_surface *boundary = NULL;
  assert_success(context, cellist_surface_from_cells(context, &cells, &boundary));
  assert_int_equal(cellist_surface_get_arrays(boundary)->triangle_count, 6 * 9 * 2);
  random_state random = {5};
  const double centre[3] = {0.5, 0.5, 0.5};
  for (int round = 0; round < 3; round++) {
    const cellist_view view = stage_random_view(&random, centre, 0.9, round);
    cellist_frame frame;
    assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frame));
    for (int renderer = 0; renderer <= BY_FAN; renderer++) {
      const bool is_gl = renderer == BY_FACES || renderer == BY_FAN;
      cellist_image *image = stage_draw_with(&made, renderer, &frame, NULL, boundary);
      size_t covered = 0;
      for (uint32_t i = 0; i < SIZE * SIZE; i++) {
        if (stage_value(image, 3, i) == 0) continue;
        covered++;
        if (is_gl && stage_value(image, 3, i) != 1) continue; /* a silhouette, by OpenGL's grid */
        assert_true(stage_value(image, 3, i) == 1);
        assert_true(stage_value(image, 0, i) <= 1e-4f && stage_value(image, 2, i) <= 1e-4f);
        assert_true(stage_value(image, 1, i) > 0.2f);
      }
      assert_true(covered > 300);
      cellist_image_destroy(image);
      /* Where a maximum is asked for, a sliver of a cell would show all of its colour. */
      image = stage_draw_with(&made, renderer, &frame, &(cellist_optics){.model = CELLIST_MODEL_MAXIMUM}, boundary);
      if (image == NULL) continue;
      size_t other = 0; /* colours: silhouettes, by OpenGL's grid */
      for (uint32_t i = 0; i < SIZE * SIZE; i++)
        other += stage_value(image, 0, i) > 1e-4f || stage_value(image, 2, i) > 1e-4f;
      assert_true(other <= (is_gl ? 3 : 0));
      cellist_image_destroy(image);
    }
  }
  cellist_surface_destroy(boundary);
  stage_close(&made);
  harness_context_destroy(context);
}

/* Triangles that coincide lie at one depth: every renderer shows the first of them, whichever way round. */
TEST(of_triangles_that_coincide_the_first_is_seen)
{
  cellist_context *context = harness_context(1);
  const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1}, slope[3] = {0.5, 0.1, 0.3};
  stage made;
  stage_open(&made, context, stage_box(context, 3, low, high, 0, slope), NULL, 1);
  const double green[3] = {0, 1, 0}, red[3] = {1, 0, 0};
  cellist_surface *parts[2], *other = NULL, *both = NULL;
  for (int i = 0; i < 2; i++) {
    const cellist_surface_cells cells = {.mesh = made.mesh, .colour = i == 0 ? green : red};
    assert_success(context, cellist_surface_from_cells(context, &cells, &parts[i]));
  }
  cellist_surface_arrays turned = *cellist_surface_get_arrays(parts[1]);
  uint32_t *triangles = malloc(3 * turned.triangle_count * sizeof *triangles);
  for (size_t i = 0; i < turned.triangle_count; i++)
    for (size_t c = 0; c < 3; c++) {
      const size_t from = i % 2 == 0 ? (c + i) % 3 : 2 - c;
      triangles[3 * i + c] = turned.triangles[3 * i + from];
    }
  turned.triangles = triangles;
  assert_success(context, cellist_surface_create(context, &turned, &other));
  assert_success(context, cellist_surface_join(context, (const cellist_surface *const[]){parts[0], other}, 2, &both));
  assert_int_equal(cellist_surface_get_arrays(both)->triangle_count,
                   cellist_surface_get_arrays(parts[0])->triangle_count);
  random_state random = {6};
  const double centre[3] = {0.5, 0.5, 0.5};
  for (int round = 0; round < 3; round++) {
    const cellist_view view = stage_random_view(&random, centre, 0.9, round);
    cellist_frame frame;
    assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frame));
    for (int renderer = 0; renderer <= BY_FAN; renderer++) {
      cellist_image *image = stage_draw_with(&made, renderer, &frame, NULL, both);
      size_t covered = 0;
      for (uint32_t i = 0; i < SIZE * SIZE; i++) {
        if (stage_value(image, 3, i) != 1) continue;
        covered++;
        if (!(stage_value(image, 0, i) <= 1e-4f)) fail_msg("%s: red at pixel %u", RENDERER_NAMES[renderer], i);
      }
      assert_true(covered > 300);
      cellist_image_destroy(image);
    }
  }
  cellist_surface_destroy(both);
  cellist_surface_destroy(other);
  for (int i = 0; i < 2; i++) cellist_surface_destroy(parts[i]);
  free(triangles);
  stage_close(&made);
  harness_context_destroy(context);
}

struct failing {
  int renderer;
};

static cellist_result draw_once(cellist_context *context, void *user) {
  const struct failing *failing = user;
  static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, values[4] = {0, 1, 2, 3};
  static const uint32_t tet[4] = {0, 1, 2, 3}, triangle[3] = {1, 2, 3};
  static cellist_transfer_knot knot[] = {{0, 1, {1, 1, 1}}};
  const cellist_transfer transfer = {1, knot};
  const cellist_field field = {"s", CELLIST_ON_POINTS, 1, values};
  const cellist_mesh_desc desc = {4, points, 1, tet, NULL, 1, &field};
  const cellist_surface_arrays arrays = {4, points, points, NULL, 1, triangle};
  const cellist_view view = {.eye = {3, 3, 3}, .up = {0, 0, 1}, .fovy_degrees = 40};
  cellist_frame frame;
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar = {0};
  cellist_surface *surface = NULL, *joined = NULL, *around = NULL;
  cellist_image *image = NULL;
  cellist_raycaster *caster = NULL;
  cellist_soft *soft = NULL;
  cellist_result result = cellist_frame_from_view(context, &view, 8, 8, &frame);
  if (result == CELLIST_SUCCESS) result = cellist_mesh_create(context, &desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, mesh, NULL, &scalar);
  if (result == CELLIST_SUCCESS) result = cellist_surface_create(context, &arrays, &surface);
  const cellist_surface_cells cells = {.mesh = mesh};
  if (result == CELLIST_SUCCESS) result = cellist_surface_from_cells(context, &cells, &around);
  const cellist_surface *const both[] = {surface, around};
  if (result == CELLIST_SUCCESS) result = cellist_surface_join(context, both, 2, &joined);
  if (result == CELLIST_SUCCESS) result = cellist_image_create(context, 8, 8, CHANNELS, CHANNEL_COUNT, &image);
  if (failing->renderer <= BY_FAST) {
    if (result == CELLIST_SUCCESS) result = cellist_raycaster_create(context, mesh, &scalar, NULL, &caster);
    const cellist_raycast_desc cast = {
        .precision = failing->renderer == BY_FAST ? CELLIST_PRECISION_FAST : CELLIST_PRECISION_REFERENCE,
        .surface = joined};
    const cellist_raycast_output output = {.image = image};
    if (result == CELLIST_SUCCESS) result = cellist_raycaster_render(caster, &frame, &transfer, &cast, &output, NULL);
  } else {
    const uint32_t order = 0;
    const cellist_soft_settings settings = {.order = &order, .order_count = 1, .surface = joined};
    if (result == CELLIST_SUCCESS) result = cellist_soft_create(context, mesh, &scalar, NULL, &soft);
    if (result == CELLIST_SUCCESS) result = cellist_soft_render(soft, &frame, &transfer, &settings, image, NULL);
  }
  cellist_raycaster_destroy(caster);
  cellist_soft_destroy(soft);
  cellist_image_destroy(image);
  cellist_surface_destroy(joined);
  cellist_surface_destroy(around);
  cellist_surface_destroy(surface);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  for (int renderer = 0; renderer <= BY_SOFT; renderer++) {
    struct failing failing = {renderer};
    check_allocation_failures(draw_once, &failing);
  }
}

TEST(bad_arrays_are_refused_by_number)
{
  cellist_context *context = harness_context(1);
  double points[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  uint32_t triangle[3] = {0, 1, 3};
  cellist_surface_arrays arrays = {3, points, NULL, NULL, 1, triangle};
  cellist_surface *surface = NULL;
  assert_failure(context, cellist_surface_create(context, &arrays, &surface), CELLIST_ERROR_INVALID_ARGUMENT,
                 "triangle 0 names point 3");
  triangle[2] = 2;
  points[4] = NAN;
  assert_failure(context, cellist_surface_create(context, &arrays, &surface), CELLIST_ERROR_GEOMETRY, "point 1");
  points[4] = 0;
  arrays.positions = NULL;
  assert_failure(context, cellist_surface_create(context, &arrays, &surface), CELLIST_ERROR_INVALID_ARGUMENT, "NULL");
  assert_null(surface);
  harness_context_destroy(context);
}
