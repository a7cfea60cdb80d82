/* SPDX-License-Identifier: BSD-3-Clause
 * What the ray caster's tests compare with, in 80-bit arithmetic: quadrature along a ray, chords of convex bodies. */
#ifndef CELLIST_TESTS_RAYCAST_ORACLE_H
#define CELLIST_TESTS_RAYCAST_ORACLE_H

#include <cellist/transfer.h>
#include <math.h>
#include <stddef.h>

typedef long double real;

/* Gauss-Legendre with 20 points, nodes by Newton's method from Chebyshev's, once per program. */
static inline void oracle_gauss_rule(const real **nodes, const real **weights) {
  static real node[20], weight[20];
  *nodes = node;
  *weights = weight;
  if (weight[0] > 0) return;
  for (int i = 0; i < 20; i++) {
    real x = cosl(3.14159265358979323846L * (i + 0.75L) / 20.5L), slope = 1;
    for (int step = 0; step < 10; step++) {
      real before = 1, now = x;
      for (int k = 2; k <= 20; k++) {
        const real next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
        before = now;
        now = next;
      }
      slope = 20 * (x * now - before) / (x * x - 1);
      x -= now / slope;
    }
    node[i] = x;
    weight[i] = 2 / ((1 - x * x) * slope * slope);
  }
}

/* Weights of the front and the back colour of a piece of linear extinction from a to b (times its length): panels of
 * equal depth, at most 1/2 each, up to a depth of 80. */
static inline void oracle_weights(real a, real b, real *front, real *back) {
  const real *node, *weight;
  oracle_gauss_rule(&node, &weight);
  const real depth = (a + b) / 2, limit = depth < 80 ? depth : 80;
  const int panels = (int)(2 * limit) + 1;
  *front = *back = 0;
  real low = 0;
  for (int p = 1; p <= panels && depth > 0; p++) {
    /* Where the depth is y: the root of (b - a) w^2 / 2 + a w = y, written without cancellation. */
    const real y = limit * p / panels;
    const real high = p == panels && limit == depth ? 1 : 2 * y / (a + sqrtl(a * a + 2 * (b - a) * y));
    for (int i = 0; i < 20; i++) {
      const real w = low + (high - low) * (1 + node[i]) / 2;
      const real term = weight[i] * (high - low) / 2 * (a + (b - a) * w) * expl(-(a * w + (b - a) * w * w / 2));
      *front += term * (1 - w);
      *back += term * w;
    }
    low = high;
  }
}

/* Where the ray origin + t direction lies inside the convex body of the planes normal . p <= offset; false: nowhere. */
static inline int oracle_chord(size_t plane_count, const real (*normal)[3], const real *offset, const double origin[3],
                               const double direction[3], real chord[2]) {
  for (size_t i = 0; i < plane_count; i++) {
    real along = 0, distance = offset[i];
    for (int k = 0; k < 3; k++) {
      along += normal[i][k] * direction[k];
      distance -= normal[i][k] * origin[k];
    }
    if (along == 0 && distance < 0) return 0;
    if (along > 0) chord[1] = fminl(chord[1], distance / along);
    if (along < 0) chord[0] = fmaxl(chord[0], distance / along);
  }
  return chord[0] < chord[1];
}

#endif
