/* SPDX-License-Identifier: BSD-3-Clause
 * The reference integrator against Gauss-Legendre quadrature of its own in 80-bit arithmetic, relative errors, over
 * optical depths from 1e-12 to 1e9. */
#include <math.h>

#include "../../project/optics/reference_integral.h"
#include "../../project/optics/reference_integral_special.h"
#include "harness.h"
#include "oracle.h"

static double relative_error(double got, real expected) {
  return expected == 0 ? fabs(got) : (double)fabsl((got - expected) / expected);
}

static void check_weights(double a, double b) {
  double front, back;
  real exact_front, exact_back;
  const double depth = reference_piece_weights(a, b, &front, &back);
  oracle_weights(a, b, &exact_front, &exact_back);
  if (relative_error(front, exact_front) > 1e-14 || relative_error(back, exact_back) > 1e-14 ||
      relative_error(depth, ((real)a + b) / 2) > 1e-15)
    fail_msg("a %.17g b %.17g: relative errors %.3g and %.3g", a, b, relative_error(front, exact_front),
             relative_error(back, exact_back));
}

TEST(weights_of_a_piece_are_exact_from_1e_minus_12_to_1e9)
{
  random_state random = {1};
  for (int round = 0; round < 1500; round++) {
    const double scale = pow(10, random_between(&random, -12, 9));
    check_weights(scale, scale * random_unit(&random));
    check_weights(scale * random_unit(&random), scale);
  }
  for (int exponent = -12; exponent <= 9; exponent++) {
    const double scale = pow(10, exponent);
    check_weights(scale, 0);
    check_weights(0, scale);
    check_weights(scale, scale);
  }
}

TEST(nearly_constant_extinction_is_no_special_case)
{
  random_state random = {2};
  for (int round = 0; round < 1000; round++) {
    const double scale = pow(10, random_between(&random, -3, 4));
    const double other = scale * (1 + pow(10, random_between(&random, -17, -3)) * (round % 2 ? 1 : -1));
    check_weights(scale, other);
    check_weights(other, scale);
  }
}

TEST(closed_forms_and_quadrature_meet)
{
  random_state random = {3};
  for (int round = 0; round < 2000; round++) {
    /* Depths of 1 to 2: the public function takes the closed form, ten points still suffice for 1e-10. */
    const double a = random_between(&random, 0, 2), b = 2 - a + random_between(&random, 1e-9, 2 - a);
    double front, back, other_front, other_back;
    reference_piece_weights(a, b, &front, &back);
    reference_piece_weights_by_quadrature(a, b, &other_front, &other_back);
    assert_true(fabs(front - other_front) < 1e-10 && fabs(back - other_back) < 1e-10);
  }
}

TEST(extremes_stay_finite)
{
  const double values[] = {0, 5e-324, 1e-310, 1e-30, 1, 1e30, 1e300, 1.7e308};
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < 8; j++) {
      double front, back;
      const double depth = reference_piece_weights(values[i], values[j], &front, &back);
      assert_true(isfinite(depth) && front >= 0 && back >= 0 && front + back <= 1 + 1e-15);
    }
}

TEST(special_functions_match_80_bit_ones)
{
  random_state random = {4};
  for (int round = 0; round < 2000; round++) {
    const double x = pow(10, random_between(&random, -6, 3));
    /* erfcx: the library's own in 80 bits as far as it does not underflow. */
    if (x < 100) {
      const real exact = expl((real)x * x) * erfcl(x);
      assert_true(relative_error(reference_erfcx(x), exact) < 1e-15);
    }
    /* Dawson: exp(-x^2) times the power series of the integral, whose terms are all positive. */
    if (x < 20) {
      const real square = (real)x * x;
      real term = x * expl(-square), sum = term;
      for (int k = 1; k < 3000; k++) {
        term *= square / k;
        sum += term / (2 * k + 1);
      }
      assert_true(relative_error(reference_dawson(x), sum) < 2e-15);
    }
  }
}

static cellist_transfer transfer_of(size_t count, cellist_transfer_knot *knots) {
  return (cellist_transfer){count, knots};
}

TEST(pieces_cover_a_segment_and_meet_at_the_knots)
{
  cellist_transfer_knot knots[] = {
      {0, 1, {1, 0, 0}}, {1, 3, {0, 1, 0}}, {1, 5, {0, 0, 1}}, {1, 7, {0, 0, 1}}, {4, 2, {1, 1, 1}}};
  const cellist_transfer transfer = transfer_of(5, knots);
  random_state random = {5};
  for (int round = 0; round < 5000; round++) {
    /* Half of the ends lie on knots. */
    const double ends[2] = {round % 3 ? random_between(&random, -2, 6) : (double)random_below(&random, 5),
                            round % 2 ? random_between(&random, -2, 6) : (double)random_below(&random, 5)};
    reference_pieces pieces;
    reference_piece piece;
    reference_pieces_begin(&pieces, &transfer, ends[0], ends[1]);
    double at = ends[0], position = 0, share = 0;
    while (reference_pieces_next(&pieces, &piece)) {
      assert_true(piece.scalar[0] == at && piece.begin == position);
      assert_true(piece.end >= piece.begin && piece.share >= 0);
      const double low = fmin(piece.scalar[0], piece.scalar[1]), high = fmax(piece.scalar[0], piece.scalar[1]);
      for (int k = 0; k < 5; k++) assert_true(knots[k].value <= low || knots[k].value >= high);
      /* In the middle the piece is what the transfer function says. */
      const double middle = 0.5 * (low + high);
      const double expected = middle < 0                                     ? 1
                              : middle <= 1 && (low < high ? middle < 1 : 1) ? 1 + 2 * middle
                              : middle < 4                                   ? 7 - 5 * (middle - 1) / 3
                                                                             : 2;
      assert_true(fabs(0.5 * (piece.extinction[0] + piece.extinction[1]) - expected) < 1e-14);
      at = piece.scalar[1];
      position = piece.end;
      share += piece.share;
    }
    assert_true(at == ends[1] && position == 1 && fabs(share - 1) < 1e-14);
  }
}
