/* SPDX-License-Identifier: BSD-3-Clause
 * Faces seen edge-on: a ray that lies exactly in a face which two cells share must count one of them. A regular grid of
 * one colour, seen from its own planes and vertices, must be as smooth as a slab. */
#include <cellist/generate.h>
#include <cellist/sort.h>

#include "stage.h"

enum { SIZE = 65 }; /* odd: pixels' centres lie on the axes */

static cellist_transfer_knot KNOT[] = {{0, 0, {0.9, 0.4, 0.1}}};
static const cellist_transfer TRANSFER = {1, KNOT};

typedef struct scene {
  cellist_context *context;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_gl *gl;
  cellist_image *image;
  uint32_t *order;
  size_t count;
  double low[3], step;
} scene;

static void open_scene(scene *made) {
  *made = (scene){.context = harness_context(2)};
  const cellist_generate_desc generate = {.size = 384};
  assert_success(made->context, cellist_generate(made->context, "grid", &generate, &made->mesh));
  assert_success(made->context, cellist_scalar_select(made->context, made->mesh, NULL, &made->scalar));
  assert_success(made->context, cellist_image_create(made->context, SIZE, SIZE, STAGE_CHANNELS, 6, &made->image));
  assert_success(made->context, cellist_gl_create(made->context, NULL, &made->gl));
  assert_success(made->context, cellist_gl_upload(made->gl, made->mesh, &made->scalar));
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  assert_int_equal(arrays->tet_count, 6 * 4 * 4 * 4);
  made->count = arrays->tet_count;
  made->order = malloc(made->count * sizeof *made->order);
  memcpy(made->low, arrays->bounds, sizeof made->low);
  made->step = (arrays->bounds[3] - arrays->bounds[0]) / 4;
  KNOT[0].extinction = 0.5 / made->step;
}

static void close_scene(scene *made) {
  free(made->order);
  cellist_gl_destroy(made->gl);
  cellist_image_destroy(made->image);
  cellist_scalar_release(made->context, &made->scalar);
  cellist_mesh_destroy(made->mesh);
  harness_context_destroy(made->context);
}

/* Length of the ray in the grid. */
static double length_inside(const scene *made, const cellist_frame *frame, double x, double y) {
  double origin[3], direction[3], front = frame->near_distance, back = HUGE_VAL;
  cellist_frame_ray(frame, x, y, origin, direction);
  for (int k = 0; k < 3; k++) {
    const double a = made->low[k] - origin[k], b = a + 4 * made->step;
    if (direction[k] == 0 && !(a < 0 && b > 0)) return 0;
    if (direction[k] == 0) continue;
    front = fmax(front, fmin(a / direction[k], b / direction[k]));
    back = fmin(back, fmax(a / direction[k], b / direction[k]));
  }
  const double norm = sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
  return front < back ? (back - front) * norm : 0;
}

/* Eye and target in steps of the grid from its low corner; height: of a parallel view in steps. */
static void check_view(scene *made, const double eye[3], const double target[3], const double up[3], double height) {
  cellist_view view = {.fovy_degrees = 60, .parallel_height = height * made->step};
  for (int k = 0; k < 3; k++) {
    view.eye[k] = made->low[k] + eye[k] * made->step;
    view.target[k] = made->low[k] + target[k] * made->step;
    view.up[k] = up[k];
  }
  cellist_frame frame;
  assert_success(made->context, cellist_frame_from_view(made->context, &view, SIZE, SIZE, &frame));
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  cellist_viewpoint viewpoint = {.parallel = frame.parallel};
  memcpy(viewpoint.position, frame.parallel ? frame.forward : frame.eye, sizeof viewpoint.position);
  cellist_sorter *sorter = NULL;
  assert_success(made->context, cellist_sorter_create(made->context, &desc, &sorter));
  assert_success(made->context, cellist_sorter_sort(sorter, &viewpoint, made->order, NULL));
  cellist_sorter_destroy(sorter);
  const cellist_gl_group all = {0, made->count};
  for (size_t groups = 0; groups < 2; groups++) {
    const cellist_gl_settings settings = {.groups = &all, .group_count = groups};
    assert_success(made->context, cellist_gl_render(made->gl, &frame, &TRANSFER, made->order, made->count, &settings,
                                                    made->image, NULL));
    const float *alpha = cellist_image_channel(made->image, "A");
    size_t compared = 0, wrong = 0;
    for (uint32_t y = 0; y < SIZE; y++)
      for (uint32_t x = 0; x < SIZE; x++) {
        const double length = length_inside(made, &frame, x + 0.5, y + 0.5);
        bool at_edge = false; /* of the whole grid: its own faces seen edge-on belong to one cell only */
        for (int corner = 0; corner < 8; corner++)
          at_edge = at_edge || (length_inside(made, &frame, x + 0.5 + cos(corner * 0.785) / 100,
                                              y + 0.5 + sin(corner * 0.785) / 100) > 0) != (length > 0);
        if (at_edge) continue;
        compared += length > 0;
        wrong += !(fabs(alpha[y * SIZE + x] - (1 - exp(-KNOT[0].extinction * length))) <= 1e-5);
      }
    assert_true(compared > SIZE * SIZE / 8);
    if (wrong > 0)
      fail_msg("%zu of %zu pixels wrong from %g %g %g towards %g %g %g", wrong, compared, eye[0], eye[1], eye[2],
               target[0], target[1], target[2]);
  }
}

static const double UP_Y[3] = {0, 1, 0}, UP_Z[3] = {0, 0, 1};

TEST(a_grid_seen_from_its_planes_is_smooth)
{
  scene made;
  open_scene(&made);
  check_view(&made, (double[3]){2, 2, 9}, (double[3]){2, 2, 0}, UP_Y, 0); /* on the axis, where planes meet */
  check_view(&made, (double[3]){1, 2, 9}, (double[3]){1, 2, 0}, UP_Y, 0);
  check_view(&made, (double[3]){2.3, 2, 8}, (double[3]){2.3, 2, 0}, UP_Y, 0); /* in one plane */
  check_view(&made, (double[3]){9, 9, 2}, (double[3]){0, 0, 2}, UP_Z, 0);     /* in a plane of diagonals */
  close_scene(&made);
}

TEST(a_grid_seen_from_its_own_vertex_is_smooth)
{
  scene made;
  open_scene(&made);
  for (int axis = 0; axis < 3; axis++)
    for (int sign = -1; sign <= 1; sign += 2) {
      const double eye[3] = {2, 2, 2};
      double target[3] = {2, 2, 2};
      target[axis] += sign;
      check_view(&made, eye, target, axis == 2 ? UP_Y : UP_Z, 0);
    }
  check_view(&made, (double[3]){1, 3, 2}, (double[3]){2, 3.7, 1.1}, UP_Z, 0); /* in general directions */
  check_view(&made, (double[3]){2, 2, 2}, (double[3]){4, 3, 2}, UP_Z, 0);
  check_view(&made, (double[3]){1, 1, 1}, (double[3]){3, 3, 3}, UP_Z, 0); /* along a cube's diagonal */
  close_scene(&made);
}

/* One step is thirteen pixels, so that columns and rows of pixels' centres lie in planes of the grid. */
TEST(a_grid_seen_along_its_planes_is_smooth)
{
  scene made;
  open_scene(&made);
  for (int axis = 0; axis < 3; axis++) {
    double eye[3] = {2, 2, 2};
    const double target[3] = {2, 2, 2};
    eye[axis] = 9;
    check_view(&made, eye, target, axis == 2 ? UP_Y : UP_Z, 5);
  }
  check_view(&made, (double[3]){9, 9, 2}, (double[3]){0, 0, 2}, UP_Z, 5);
  check_view(&made, (double[3]){9, 9, 9}, (double[3]){0, 0, 0}, UP_Z, 5);
  close_scene(&made);
}

/* Directions of whole multiples of 45 degrees, worked out in floating point: planes are seen edge-on up to rounding.
 * Where several such planes meet in one pixel, their lines no longer do. */
TEST(a_grid_seen_nearly_along_its_planes_is_smooth)
{
  scene made;
  open_scene(&made);
  const double centre[3] = {2, 2, 2}, quarter = 0.78539816339744831;
  for (int azimuth = 0; azimuth < 8; azimuth++)
    for (int elevation = -1; elevation <= 1; elevation++) {
      const double a = azimuth * quarter, e = elevation * quarter;
      const double eye[3] = {2 + 9 * cos(e) * cos(a), 2 + 9 * cos(e) * sin(a), 2 + 9 * sin(e)};
      check_view(&made, eye, centre, UP_Z, 0);
      check_view(&made, eye, centre, UP_Z, 5);
    }
  close_scene(&made);
}
