/* SPDX-License-Identifier: BSD-3-Clause
 * Predicates against exact answers known by construction, and against their own symmetries. */
#include <cellist/predicates.h>
#include <math.h>

#include "harness.h"

static int orient(double p[4][3]) { return cellist_orient3d(p[0], p[1], p[2], p[3]); }

TEST(unit_tet_is_positive)
{
  double p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  assert_int_equal(orient(p), 1);
}

TEST(exchange_of_two_points_changes_the_sign)
{
  random_state random = {1};
  for (int round = 0; round < 20000; round++) {
    double p[4][3];
    /* A tiny integer grid reaches every degenerate case; the offset defeats the filter. */
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++) p[i][k] = 1e15 + 0.125 * (double)random_below(&random, 4);
    const int sign = orient(p);
    const int i = (int)random_below(&random, 4), j = (i + 1 + (int)random_below(&random, 3)) % 4;
    for (int k = 0; k < 3; k++) {
      const double swap = p[i][k];
      p[i][k] = p[j][k];
      p[j][k] = swap;
    }
    assert_int_equal(orient(p), -sign);
  }
}

TEST(integer_points_match_integer_arithmetic)
{
  random_state random = {2};
  for (int round = 0; round < 20000; round++) {
    double p[4][3];
    __int128_t q[4][3];
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++) {
        const int64_t x = (int64_t)random_below(&random, 1u << 20) - (1 << 19);
        q[i][k] = i < 3 || round % 2 ? x : q[0][k] + q[1][k] - q[2][k]; /* half of them exactly coplanar */
        p[i][k] = (double)(int64_t)q[i][k];
      }
    __int128_t b[3], c[3], d[3];
    for (int k = 0; k < 3; k++) b[k] = q[1][k] - q[0][k], c[k] = q[2][k] - q[0][k], d[k] = q[3][k] - q[0][k];
    const __int128_t determinant =
        b[0] * (c[1] * d[2] - c[2] * d[1]) - b[1] * (c[0] * d[2] - c[2] * d[0]) + b[2] * (c[0] * d[1] - c[1] * d[0]);
    assert_int_equal(orient(p), determinant > 0 ? 1 : determinant < 0 ? -1 : 0);
  }
}

TEST(extreme_exponents_do_not_change_the_sign)
{
  const int exponents[] = {-1060, -700, -350, -100, 0, 100, 350, 700, 1000};
  random_state random = {3};
  for (int round = 0; round < 2000; round++) {
    double p[4][3];
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++) p[i][k] = (double)random_below(&random, 8);
    const int sign = orient(p);
    for (size_t e = 0; e < sizeof exponents / sizeof exponents[0]; e++) {
      double scaled[4][3];
      for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) scaled[i][k] = ldexp(p[i][k], exponents[e]);
      assert_int_equal(orient(scaled), sign);
    }
  }
}

TEST(one_unit_in_the_last_place_decides)
{
  const double a[3] = {0.1, 0.1, 0.1}, b[3] = {0.7, 0.1, 0.1}, c[3] = {0.1, 0.9, 0.1};
  const double on[3] = {0.3, 0.4, 0.1};
  const double above[3] = {0.3, 0.4, nextafter(0.1, 1)}, below[3] = {0.3, 0.4, nextafter(0.1, 0)};
  assert_int_equal(cellist_orient3d(a, b, c, on), 0);
  assert_int_equal(cellist_orient3d(a, b, c, above), 1);
  assert_int_equal(cellist_orient3d(a, b, c, below), -1);
}

TEST(mixed_scales_in_one_tet_are_exact)
{
  const double a[3] = {0, 0, 0}, b[3] = {1e300, 0, 0}, c[3] = {0, 1e-300, 0};
  const double above[3] = {1e300, 1e300, 5e-324}, on[3] = {-1e300, 3, 0};
  assert_int_equal(cellist_orient3d(a, b, c, above), 1);
  assert_int_equal(cellist_orient3d(a, b, c, on), 0);
}

TEST(direction_is_a_point_at_infinity)
{
  random_state random = {4};
  for (int round = 0; round < 20000; round++) {
    double a[3], b[3], c[3], direction[3], far_point[3];
    for (int k = 0; k < 3; k++) {
      a[k] = (double)random_below(&random, 5);
      b[k] = (double)random_below(&random, 5);
      c[k] = (double)random_below(&random, 5);
      direction[k] = (double)random_below(&random, 5) - 2;
      far_point[k] = a[k] + direction[k]; /* exact: a lies in the plane */
    }
    assert_int_equal(cellist_orient3d_direction(a, b, c, direction), cellist_orient3d(a, b, c, far_point));
  }
}

TEST(orient2d_sees_one_unit_in_the_last_place)
{
  const double a[2] = {12, 12}, b[2] = {24, 24};
  double p[2] = {0.5, 0.5};
  assert_int_equal(cellist_orient2d(a, b, p), 0);
  p[1] = nextafter(0.5, 1);
  assert_int_equal(cellist_orient2d(a, b, p), 1);
  p[1] = nextafter(0.5, 0);
  assert_int_equal(cellist_orient2d(a, b, p), -1);
}
