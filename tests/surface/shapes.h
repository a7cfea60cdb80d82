/* SPDX-License-Identifier: BSD-3-Clause
 * Surfaces for tests: planes and spheres. */
#ifndef CELLIST_TESTS_SURFACE_SHAPES_H
#define CELLIST_TESTS_SURFACE_SHAPES_H

#include <cellist/surface.h>
#include <math.h>
#include <stdlib.h>

#include "harness.h"

/* A parallelogram around a point, cut into n x n x 2 triangles, of one colour. */
static inline cellist_surface *shape_plane(cellist_context *context, const double centre[3], const double u[3],
                                           const double v[3], uint32_t n, const float colour[3]) {
  const size_t point_count = (size_t)(n + 1) * (n + 1), triangle_count = 2 * (size_t)n * n;
  double *points = malloc(3 * point_count * sizeof *points);
  float *colours = malloc(3 * point_count * sizeof *colours);
  uint32_t *triangles = malloc(3 * triangle_count * sizeof *triangles), *next = triangles;
  for (size_t i = 0; i < point_count; i++)
    for (int k = 0; k < 3; k++) {
      points[3 * i + (size_t)k] =
          centre[k] + u[k] * (2.0 * (double)(i % (n + 1)) / n - 1) + v[k] * (2.0 * (double)(i / (n + 1)) / n - 1);
      colours[3 * i + (size_t)k] = colour[k];
    }
  for (uint32_t y = 0; y < n; y++)
    for (uint32_t x = 0; x < n; x++) {
      const uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      const uint32_t two[6] = {a, b, d, a, d, c};
      for (int k = 0; k < 6; k++) *next++ = two[k];
    }
  const cellist_surface_arrays arrays = {point_count, points, NULL, colours, triangle_count, triangles};
  cellist_surface *surface = NULL;
  assert_success(context, cellist_surface_create(context, &arrays, &surface));
  free(points);
  free(colours);
  free(triangles);
  return surface;
}

/* A sphere of n rings and 2 n sectors, smooth or flat, its colour changing from pole to pole. */
static inline cellist_surface *shape_sphere(cellist_context *context, const double centre[3], double radius, uint32_t n,
                                            bool smooth) {
  const uint32_t sectors = 2 * n;
  const size_t point_count = 2 + (size_t)(n - 1) * sectors;
  double *points = malloc(3 * point_count * sizeof *points), *normals = malloc(3 * point_count * sizeof *normals);
  float *colours = malloc(3 * point_count * sizeof *colours);
  uint32_t *triangles = malloc(6 * (size_t)n * sectors * sizeof *triangles);
  size_t corner = 0;
  for (size_t i = 0; i < point_count; i++) {
    double theta = 0, phi = 0;
    if (i == 1) theta = 3.14159265358979323846;
    if (i > 1) {
      theta = 3.14159265358979323846 * (double)(1 + (i - 2) / sectors) / n;
      phi = 2 * 3.14159265358979323846 * (double)((i - 2) % sectors) / sectors;
    }
    const double way[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
    for (int k = 0; k < 3; k++) {
      points[3 * i + (size_t)k] = centre[k] + radius * way[k];
      normals[3 * i + (size_t)k] = 3 * way[k];
      colours[3 * i + (size_t)k] = (float)(0.5 + 0.4 * way[2] * (k - 1));
    }
  }
  for (uint32_t ring = 0; ring < n; ring++)
    for (uint32_t s = 0; s < sectors; s++) {
      const uint32_t t = (s + 1) % sectors, above = 2 + (ring - 1) * sectors, below = 2 + ring * sectors;
      if (ring + 1 < n) {
        triangles[corner++] = ring == 0 ? 0 : above + s;
        triangles[corner++] = below + s;
        triangles[corner++] = below + t;
      }
      if (ring > 0) {
        triangles[corner++] = above + s;
        triangles[corner++] = ring + 1 < n ? below + t : 1;
        triangles[corner++] = above + t;
      }
    }
  const cellist_surface_arrays arrays = {point_count, points, smooth ? normals : NULL, colours, corner / 3, triangles};
  cellist_surface *surface = NULL;
  assert_success(context, cellist_surface_create(context, &arrays, &surface));
  free(points);
  free(normals);
  free(colours);
  free(triangles);
  return surface;
}

#endif
