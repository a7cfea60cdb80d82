/* SPDX-License-Identifier: BSD-3-Clause
 * The psi table: known limits, quadrature, and its error between nodes. */
#include <math.h>
#include <stdlib.h>

#include "../../project/optics/psi.h"
#include "harness.h"
#include "segment.h"

TEST(means_have_their_known_limits)
{
  double first, second;
  for (int i = 0; i <= 10; i++) { /* nothing absorbed: extinction (1-t)(1-w) + t w weighs the places */
    const double t = i / 10.0;
    psi_means(0, t, &first, &second);
    assert_true(fabs(first - (1 + t) / 3) < 1e-14);
    assert_true(fabs(second - (1 + 2 * t) / 6) < 1e-14);
    psi_means(INFINITY, t, &first, &second);
    assert_true(first == 0 && second == 0);
  }
  for (double m = 0.01; m < 1e4; m *= 3) { /* constant extinction */
    psi_means(m, 0.5, &first, &second);
    assert_true(fabs(first - (1 / m - 1 / expm1(m))) < 1e-11);
  }
}

/* Against the oracle of segments: a transfer function that is one piece, whose colour is the place. */
TEST(means_are_those_of_quadrature)
{
  random_state random = {4};
  for (int i = 0; i < 500; i++) {
    const double m = pow(10, random_between(&random, -4, 3)), share = random_unit(&random);
    cellist_transfer_knot knots[] = {{0, 2 * m * (1 - share), {1, 1, 1}}, {1, 2 * m * share, {1, 1, 1}}};
    const cellist_transfer transfer = {2, knots};
    const segment truth = segment_integrate(&transfer, 0, 1, 1);
    double first, second;
    psi_means(m, share, &first, &second);
    assert_true(fabs(first - truth.first / truth.opacity) < 1e-9);
    assert_true(fabs(second - truth.second / truth.opacity) < 1e-9);
  }
}

TEST(the_table_errs_little_between_nodes)
{
  float *table = malloc(PSI_FLOATS * sizeof *table);
  psi_table_fill(table);
  random_state random = {5};
  double usual = 0, most = 0;
  for (int i = 0; i < 200000; i++) {
    const double m = pow(10, random_between(&random, -5, 5)), share = random_unit(&random);
    double first, second, expected_first, expected_second;
    psi_look_up(table, m, share, &first, &second);
    psi_means(m, share, &expected_first, &expected_second);
    const double error =
        -expm1(-m) * fmax(fabs(first - expected_first), fabs(second - expected_second)); /* of what is seen */
    if (m <= 1) usual = fmax(usual, error);
    most = fmax(most, error);
    assert_true(isfinite(first) && isfinite(second));
  }
  print_message("largest error up to a depth of 1: %.3g, of all: %.3g\n", usual, most);
  assert_true(usual < 1e-5);
  assert_true(most < 1e-3);
  free(table);
}
