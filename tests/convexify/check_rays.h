/* SPDX-License-Identifier: BSD-3-Clause
 * An oracle for complexes: along random lines the cells must follow one another without gap or overlap. Each cell is
 * clipped by itself, tets by their corners, imaginary cells by their facets' planes; no adjacency is used. */
#ifndef CELLIST_TESTS_CHECK_RAYS_H
#define CELLIST_TESTS_CHECK_RAYS_H

#include <cellist/complex.h>
#include <math.h>
#include <stdlib.h>

#include "harness.h"

typedef struct ray_interval {
  double enter, leave;
} ray_interval;

static inline int compare_intervals(const void *a, const void *b) {
  const ray_interval *x = a, *y = b;
  return x->enter < y->enter ? -1 : x->enter > y->enter;
}

static inline void clip_by_plane(ray_interval *i, const double *p, const double *q, const double *r, int keep,
                                 const double origin[3], const double direction[3]) {
  double n[3], along = 0, distance = 0;
  for (int k = 0; k < 3; k++) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    n[k] = (q[a] - p[a]) * (r[b] - p[b]) - (q[b] - p[b]) * (r[a] - p[a]);
  }
  for (int k = 0; k < 3; k++) {
    along += keep * n[k] * direction[k];
    distance += keep * n[k] * (origin[k] - p[k]);
  }
  if (along > 0)
    i->enter = fmax(i->enter, -distance / along);
  else if (along < 0)
    i->leave = fmin(i->leave, -distance / along);
  else if (distance < 0)
    i->leave = -HUGE_VAL;
}

/* Fails the case unless rays lines through the middle of the bounds cross cells end to end. tolerance: of the extent.
 */
static inline void check_rays(const cellist_complex *complex, const cellist_mesh *mesh, int rays, uint64_t seed,
                              double tolerance) {
  const cellist_complex_arrays *a = cellist_complex_get_arrays(complex);
  const cellist_mesh_arrays *m = cellist_mesh_get_arrays(mesh);
  random_state random = {seed};
  double extent = 0;
  for (int k = 0; k < 3; k++) extent = fmax(extent, m->bounds[3 + k] - m->bounds[k]);
  ray_interval *clipped = malloc(a->cell_count * sizeof *clipped);
  size_t crossed = 0;
  for (int ray = 0; ray < rays; ray++) {
    double origin[3], direction[3];
    for (int k = 0; k < 3; k++) {
      const double from = random_between(&random, m->bounds[k], m->bounds[3 + k]);
      direction[k] = (random_between(&random, m->bounds[k], m->bounds[3 + k]) - from) / extent;
      origin[k] = from;
    }
    for (size_t c = 0; c < a->cell_count; c++) clipped[c] = (ray_interval){-HUGE_VAL, HUGE_VAL};
    for (size_t t = 0; t < a->tet_count; t++)
      for (int f = 0; f < 4; f++) {
        const uint32_t *v = &m->tets[4 * t];
        const uint8_t *corner = CELLIST_TET_FACE[f];
        clip_by_plane(&clipped[t], &m->positions[3 * v[corner[0]]], &m->positions[3 * v[corner[1]]],
                      &m->positions[3 * v[corner[2]]], -1, origin, direction);
      }
    for (size_t f = 0; f < a->facet_count; f++)
      for (int side = 0; side < 2; side++) {
        const uint32_t cell = a->facet_cells[2 * f + (size_t)side];
        if (cell == CELLIST_NONE || cell < a->tet_count) continue;
        const uint32_t *id = &a->planes[3 * a->facet_planes[f]];
        double axis_points[9];
        const double *p = axis_points, *q = axis_points + 3, *r = axis_points + 6;
        if (id[0] == CELLIST_NONE) {
          for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) axis_points[3 * c + k] = k == (int)id[1] ? a->offsets[id[2]] : 0;
          axis_points[3 + (id[1] + 1) % 3] = extent;
          axis_points[6 + (id[1] + 2) % 3] = extent;
        } else {
          p = &a->points[3 * id[0]];
          q = &a->points[3 * id[1]];
          r = &a->points[3 * id[2]];
        }
        clip_by_plane(&clipped[cell], p, q, r, side == 0 ? 1 : -1, origin, direction);
      }
    size_t count = 0;
    for (size_t c = 0; c < a->cell_count; c++)
      if (clipped[c].leave - clipped[c].enter > tolerance) clipped[count++] = clipped[c];
    qsort(clipped, count, sizeof *clipped, compare_intervals);
    crossed += count;
    for (size_t c = 0; c + 1 < count; c++)
      if (fabs(clipped[c].leave - clipped[c + 1].enter) > 1000 * tolerance)
        fail_msg("ray %d of seed %llu: a cell ends at %.15g, the next begins at %.15g", ray, (unsigned long long)seed,
                 clipped[c].leave, clipped[c + 1].enter);
  }
  assert_true(crossed > 0);
  free(clipped);
}

#endif
