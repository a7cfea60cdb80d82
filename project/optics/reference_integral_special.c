/* SPDX-License-Identifier: BSD-3-Clause
 * Scaled complementary error function and Dawson's integral in double precision.
 *
 * erfcx: the C library's erfc times exp(x^2), with x^2 in two parts; its asymptotic series beyond 10.
 * Dawson: Taylor's series up to 0.25, Rybicki's sampling formula ("Dawson's Integral and the Sampling Theorem", 1989)
 * up to 10, its asymptotic series beyond. The asymptotic series are sums of (2k-1)!! / (2 x^2)^k, alternating for
 * erfcx; at x = 10 the terms fall until the hundredth, and the sum ends where they no longer count. */
#include "reference_integral_special.h"

#include <math.h>

static const double SQRT_PI = 1.7724538509055160273;

/* Where both asymptotic series have converged to 1e-17 after some 12 terms; below 6.5 they never do. */
static const double ASYMPTOTIC_FROM = 10;

/* Sum over k of (2k-1)!! (sign / (2 x^2))^k. */
static double asymptotic_series(double x, double sign) {
  const double ratio = sign / (2 * x * x);
  double sum = 1, term = 1;
  for (int k = 1; k < 40 && fabs(term) > 1e-18; k++) {
    term *= (2 * k - 1) * ratio;
    sum += term;
  }
  return sum;
}

double reference_erfcx(double x) {
  if (x > ASYMPTOTIC_FROM) return asymptotic_series(x, -1) / (x * SQRT_PI);
  const double square = x * x, rest = fma(x, x, -square);
  return exp(square) * (1 + rest) * erfc(x);
}

double reference_dawson(double x) {
  if (x > ASYMPTOTIC_FROM) return asymptotic_series(x, 1) / (2 * x);
  if (x < 0.25) {
    double sum = x, term = x;
    for (int k = 1; k < 20 && fabs(term) > 1e-18 * x; k++) {
      term *= -2 * x * x / (2 * k + 1);
      sum += term;
    }
    return sum;
  }
  /* Samples H apart leave an error of exp(-(pi / 2H)^2) = 7e-18; those beyond 6.5 from the peak are below 1e-18. */
  const double H = 0.25;
  double sum = 0;
  const int last = (int)((x + 6.5) / H) | 1;
  for (int n = last; n > 0; n -= 2) {
    const double near = x - n * H, far = x + n * H;
    sum += (exp(-near * near) - exp(-far * far)) / n;
  }
  return sum / SQRT_PI;
}
