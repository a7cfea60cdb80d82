/* SPDX-License-Identifier: BSD-3-Clause
 * Predicates: signs of orientation determinants, exact for any finite doubles.
 *
 * A floating-point evaluation decides when its magnitude exceeds Shewchuk's forward error bound ("Adaptive
 * Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997, section 4.3); otherwise the
 * determinant is computed in wide integers. Shewchuk's bounds assume that nothing underflows, so the filter also
 * asks that the bound be a normal number far above the rounding of subnormals; overflow gives infinity or NaN and
 * fails the comparison. Integers instead of his expansions: no limit on exponents, and as fast on mesh data,
 * whose coordinates rarely span more than a few limbs. Needs -ffp-contract=off. */
#include <cellist/predicates.h>

#include "../wide.h"

/* Shewchuk's o3derrboundA = (7 + 56 u) u and ccwerrboundA = (3 + 16 u) u with u = 2^-53, each rounded up by some
 * 0.3 % to make room for underflow (below). A smaller bound gives wrong signs. With d a direction fewer differences are
 * rounded, so the bound holds as well. */
static const double ORIENT3D_BOUND = 7.8e-16;
static const double ORIENT2D_BOUND = 3.34e-16;

/* Underflow loses at most 2^-1074 a product, times the third factor: some 1e-322 in all, far below 0.3 % of an error
 * bound that exceeds this guard. A smaller guard lets subnormal products decide. */
static const double UNDERFLOW_GUARD = 1e-290;

static int is_certain(double determinant, double error, double largest_factor) {
  return error > UNDERFLOW_GUARD * fmax(1, largest_factor) && (determinant > error || -determinant > error);
}

static int smaller(int a, int b) { return a < b ? a : b; }

static int orient3d_exact(const double a[3], const double b[3], const double c[3], const double d[3],
                          int d_is_direction) {
  /* Four points of one axis-aligned plane are the commonest exact zero. */
  for (int k = 0; k < 3; k++)
    if (a[k] == b[k] && a[k] == c[k] && (d_is_direction ? d[k] == 0 : d[k] == a[k])) return 0;

  /* The determinant is linear in d - a (or d), so that row may have a power of two of its own. */
  int base = 4096, base_d = 4096;
  for (int k = 0; k < 3; k++) {
    base = smaller(
        base, smaller(wide_lowest_exponent(a[k]), smaller(wide_lowest_exponent(b[k]), wide_lowest_exponent(c[k]))));
    base_d = smaller(base_d, wide_lowest_exponent(d[k]));
  }
  if (!d_is_direction) base = base_d = smaller(base, base_d);

  wide origin, ab[3], ac[3], ad[3];
  for (int k = 0; k < 3; k++) {
    wide_from_double(&origin, a[k], base);
    wide_from_double(&ab[k], b[k], base);
    wide_subtract(&ab[k], &ab[k], &origin);
    wide_from_double(&ac[k], c[k], base);
    wide_subtract(&ac[k], &ac[k], &origin);
    wide_from_double(&ad[k], d[k], base_d);
    if (!d_is_direction) wide_subtract(&ad[k], &ad[k], &origin);
  }
  wide minor, scratch, term, sum;
  sum.sign = 0;
  sum.length = 0;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    wide_determinant2(&minor, &ab[i], &ab[j], &ac[i], &ac[j], &scratch);
    wide_multiply(&term, &minor, &ad[k]);
    wide_add(&sum, &sum, &term);
  }
  return sum.sign;
}

static int orient3d_filtered(const double a[3], const double b[3], const double c[3], const double d[3],
                             int d_is_direction) {
  const double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
  const double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
  const double dx = d_is_direction ? d[0] : d[0] - a[0];
  const double dy = d_is_direction ? d[1] : d[1] - a[1];
  const double dz = d_is_direction ? d[2] : d[2] - a[2];

  const double by_cz = by * cz, bz_cy = bz * cy;
  const double bz_cx = bz * cx, bx_cz = bx * cz;
  const double bx_cy = bx * cy, by_cx = by * cx;
  const double determinant = (by_cz - bz_cy) * dx + (bz_cx - bx_cz) * dy + (bx_cy - by_cx) * dz;
  const double permanent = (fabs(by_cz) + fabs(bz_cy)) * fabs(dx) + (fabs(bz_cx) + fabs(bx_cz)) * fabs(dy) +
                           (fabs(bx_cy) + fabs(by_cx)) * fabs(dz);
  const double largest = fmax(fabs(dx), fmax(fabs(dy), fabs(dz)));
  if (is_certain(determinant, ORIENT3D_BOUND * permanent, largest)) return determinant > 0 ? 1 : -1;
  return orient3d_exact(a, b, c, d, d_is_direction);
}

int cellist_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
  return orient3d_filtered(a, b, c, d, 0);
}

int cellist_orient3d_direction(const double a[3], const double b[3], const double c[3], const double direction[3]) {
  return orient3d_filtered(a, b, c, direction, 1);
}

int cellist_orient2d(const double a[2], const double b[2], const double c[2]) {
  const double left = (b[0] - a[0]) * (c[1] - a[1]);
  const double right = (b[1] - a[1]) * (c[0] - a[0]);
  const double determinant = left - right;
  if (is_certain(determinant, ORIENT2D_BOUND * (fabs(left) + fabs(right)), 1)) return determinant > 0 ? 1 : -1;

  int base = 4096;
  for (int k = 0; k < 2; k++)
    base = smaller(
        base, smaller(wide_lowest_exponent(a[k]), smaller(wide_lowest_exponent(b[k]), wide_lowest_exponent(c[k]))));
  wide origin, ab[2], ac[2], result, scratch;
  for (int k = 0; k < 2; k++) {
    wide_from_double(&origin, a[k], base);
    wide_from_double(&ab[k], b[k], base);
    wide_subtract(&ab[k], &ab[k], &origin);
    wide_from_double(&ac[k], c[k], base);
    wide_subtract(&ac[k], &ac[k], &origin);
  }
  wide_determinant2(&result, &ab[0], &ab[1], &ac[0], &ac[1], &scratch);
  return result.sign;
}
