/* SPDX-License-Identifier: BSD-3-Clause
 * Plain cells, four at a time: both kernels give the same bits, and what the exact way gives, up to rounding. */
#include <cellist/predicates.h>
#include <gl/cells.h>
#include <gl/plain.h>
#include <gl/records.h>
#include <stdio.h>

#include "random_cells.h"

static cellist_transfer_knot KNOTS[] = {{-0.4, 0.0, {0, 0, 1}}, {0.1, 0.9, {0, 1, 1}}, {1.2, 0.4, {1, 0, 0}}};
static const cellist_transfer TRANSFER = {3, KNOTS};

/* The largest difference, in the unit of the largest number of its triple. */
static double difference(const float *a, const float *b) {
  static const uint8_t triples[5][3] = {{4, 5, 6}, {8, 9, 10}, {12, 13, 14}, {16, 17, 18}, {11, 15, 19}};
  double most = fabs((double)a[7] - b[7]) / fmax(1, fabs((double)b[7]));
  for (int t = 0; t < 5; t++) {
    double size = 0, apart = 0;
    for (int i = 0; i < 3; i++) {
      size = fmax(size, fabs((double)b[triples[t][i]]));
      apart = fmax(apart, fabs((double)a[triples[t][i]] - b[triples[t][i]]));
    }
    most = fmax(most, apart / size);
  }
  return most;
}

/* By the exact predicates alone. */
static unsigned sides_of(const stage *made, const cellist_frame *frame, uint32_t tet) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  unsigned sides = 0;
  for (unsigned k = 0; k < 4; k++) {
    const double *p[3];
    for (int i = 0; i < 3; i++)
      p[i] = &arrays->positions[3 * (size_t)arrays->tets[4 * (size_t)tet + CELLIST_TET_FACE[k][i]]];
    const int inward = frame->parallel ? cellist_orient3d_direction(p[0], p[1], p[2], frame->forward)
                                       : -cellist_orient3d(p[0], p[1], p[2], frame->eye);
    if (inward != 0) sides |= inward > 0 ? 1u << k : 16u << k;
  }
  return sides;
}

static void compare_kernels(bool sliver, bool parallel) {
  random_state random = {81};
  double *points = malloc(CELLS * 12 * sizeof *points), *values = malloc(CELLS * 4 * sizeof *values);
  make_cells(&random, sliver, 0, points, values);
  cellist_context *context = harness_context(1);
  stage made;
  assert_success(context, stage_open(context, CELLIST_GL_AUTO, CELLS, points, values, SIZE, &made));
  gl_cells_mesh mesh;
  assert_success(context, gl_cells_mesh_make(context, made.mesh, &made.scalar, &mesh));
  const gl_scale scale = gl_scale_of(&made.scalar);
  const cellist_optics optics = {.model = CELLIST_MODEL_EMISSION_ABSORPTION};
  gl_intervals intervals;
  assert_success(context, gl_intervals_make(context, &TRANSFER, &optics, scale, gl_unit_of(mesh.arrays), &intervals));
  size_t plain_count = 0, seen = 0;
  double worst = 0;
  for (int view = 0; view < 20; view++) {
    const double centre[3] = {0, 0, 0};
    double eye[3];
    random_point(&random, 1, eye);
    const double norm = sqrt(eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]);
    for (int k = 0; k < 3; k++) eye[k] *= random_between(&random, 3, 9) / norm;
    const cellist_frame frame = stage_frame(context, eye, centre, parallel ? 3 : 0, 0, 256);
    const gl_light light = gl_light_of_frame(&optics, &frame);
    gl_cells cells;
    assert_success(context, gl_cells_begin(context, &mesh, &frame, &intervals, &light, 1.0 / 256, &cells));
    for (uint32_t first = 0; first + GL_PLAIN_LANES <= CELLS; first += GL_PLAIN_LANES) {
      const uint32_t tets[GL_PLAIN_LANES] = {first, first + 1, first + 2, first + 3};
      gl_plain plain;
      memset(&plain, 0, sizeof plain);
      gl_plain_portable(&cells, tets, &plain);
#ifdef __x86_64__
      if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
        gl_plain other;
        memset(&other, 0, sizeof other);
        gl_plain_avx2(&cells, tets, &other);
        assert_int_equal(other.left, plain.left);
        assert_int_equal(other.nothing, plain.nothing);
        for (int lane = 0; lane < GL_PLAIN_LANES; lane++) {
          if ((plain.left | plain.nothing) >> lane & 1) continue;
          assert_memory_equal(other.records[lane], plain.records[lane], sizeof plain.records[lane]);
          assert_memory_equal(other.footprints[lane], plain.footprints[lane],
                              plain.corner_count[lane] * sizeof plain.footprints[lane][0]);
        }
      }
#endif
      for (unsigned lane = 0; lane < GL_PLAIN_LANES; lane++) {
        seen += !(plain.nothing >> lane & 1);
        if ((plain.left | plain.nothing) >> lane & 1) continue;
        gl_record record;
        const unsigned sides = sides_of(&made, &frame, tets[lane]);
        gl_record_write(&cells, tets[lane], &plain.shown[lane], sides, false, &record);
        assert_false(record.has_extra);
        if (memcmp(record.floats, plain.records[lane], 4 * sizeof(float)) != 0) continue; /* two faces as large */
        plain_count++;
        worst = fmax(worst, difference(plain.records[lane], record.floats));
      }
    }
    gl_cells_release(&cells);
  }
  printf("%zu of %zu cells plain, records differ by %.2g\n", plain_count, seen, worst);
  assert_true(plain_count > seen / 3);
  if (!(worst < 1e-5)) fail_msg("a record differs by %g", worst);
  gl_intervals_release(context, &intervals);
  gl_cells_mesh_release(context, &mesh);
  stage_close(&made);
  harness_context_destroy(context);
  free(points);
  free(values);
}

TEST(random_cells_in_perspective)
{ compare_kernels(false, false); }
TEST(random_cells_in_parallel)
{ compare_kernels(false, true); }
TEST(slivers_in_perspective)
{ compare_kernels(true, false); }
TEST(slivers_in_parallel)
{ compare_kernels(true, true); }
