/* SPDX-License-Identifier: BSD-3-Clause
 * An oracle for complexes: counts what is wrong with one, for tests and benchmarks. Along random lines the cells must
 * follow one another without gap or overlap, from where the line enters the outer surface to where it leaves: each cell
 * is clipped by itself, tets by their corners, imaginary cells by their facets' planes, in long double; no adjacency is
 * used. Facets with a cell on one side only must lie on the hull, exactly, and each edge of an imaginary cell must be
 * used once in either direction. */
#ifndef CELLIST_TESTS_FAULTS_H
#define CELLIST_TESTS_FAULTS_H

#include <base/random.h>
#include <cellist/complex.h>
#include <cellist/predicates.h>
#include <math.h>
#include <stdlib.h>

/* In units of the mesh's extent. A cell on a line for less than SLIVER may come before or after its neighbours, so it
 * is left out; what is left then does not quite meet. Rounded lines and planes that slender triples span err by less.
 */
#define FAULT_SLIVER 1e-12
#define FAULT_LIMIT 1e-9

typedef struct ray_faults {
  size_t crossed; /* cells that lines pass through */
  size_t gaps, overlaps;
  double largest; /* of all distances from one cell's end to the next one's beginning, in extents */
} ray_faults;

typedef struct ray_interval {
  long double enter, leave;
} ray_interval;

static inline int compare_intervals(const void *a, const void *b) {
  const ray_interval *x = a, *y = b;
  return x->enter < y->enter ? -1 : x->enter > y->enter;
}

/* Keeps what is on the positive (keep 1) or negative (-1) side of the plane through three points. */
static inline void clip_by_plane(ray_interval *i, const double *p, const double *q, const double *r, int keep,
                                 const double origin[3], const double direction[3]) {
  long double along = 0, distance = 0;
  for (int k = 0; k < 3; k++) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    const long double n = ((long double)q[a] - p[a]) * ((long double)r[b] - p[b]) -
                          ((long double)q[b] - p[b]) * ((long double)r[a] - p[a]);
    along += keep * n * direction[k];
    distance += keep * n * ((long double)origin[k] - p[k]);
  }
  if (along > 0)
    i->enter = fmaxl(i->enter, -distance / along);
  else if (along < 0)
    i->leave = fminl(i->leave, -distance / along);
  else if (distance < 0)
    i->leave = -HUGE_VALL;
}

static inline void clip_by_facet(ray_interval *i, const cellist_complex_arrays *a, size_t facet, int side,
                                 double extent, const double origin[3], const double direction[3]) {
  const uint32_t *id = &a->planes[3 * a->facet_planes[facet]];
  double axis_points[9];
  const double *p = axis_points, *q = axis_points + 3, *r = axis_points + 6;
  if (id[0] == CELLIST_NONE) {
    for (int c = 0; c < 9; c++) axis_points[c] = c % 3 == (int)id[1] ? a->offsets[id[2]] : 0;
    axis_points[3 + (id[1] + 1) % 3] = extent;
    axis_points[6 + (id[1] + 2) % 3] = extent;
  } else {
    p = &a->points[3 * id[0]];
    q = &a->points[3 * id[1]];
    r = &a->points[3 * id[2]];
  }
  clip_by_plane(i, p, q, r, side == 0 ? 1 : -1, origin, direction);
}

static inline void judge_contact(ray_faults *faults, long double leave, long double enter) {
  const double gap = (double)(enter - leave);
  faults->largest = fmax(faults->largest, fabs(gap));
  faults->gaps += gap > FAULT_LIMIT;
  faults->overlaps += gap < -FAULT_LIMIT;
}

/* Along lines through pairs of random points in the mesh's bounds. */
static inline ray_faults count_ray_faults(const cellist_complex *complex, const cellist_mesh *mesh, int rays,
                                          uint64_t seed) {
  const cellist_complex_arrays *a = cellist_complex_get_arrays(complex);
  const cellist_mesh_arrays *m = cellist_mesh_get_arrays(mesh);
  ray_faults faults = {0};
  random_state random = {seed};
  double extent = 0;
  for (int k = 0; k < 3; k++) extent = fmax(extent, m->bounds[3 + k] - m->bounds[k]);
  ray_interval *clipped = malloc((a->cell_count + 1) * sizeof *clipped);
  for (int ray = 0; ray < rays && clipped != NULL; ray++) {
    double origin[3], direction[3]; /* one extent long, so that distances are in extents */
    double length = 0;
    for (int k = 0; k < 3; k++) {
      origin[k] = random_between(&random, m->bounds[k], m->bounds[3 + k]);
      direction[k] = random_between(&random, m->bounds[k], m->bounds[3 + k]) - origin[k];
      length = hypot(length, direction[k]);
    }
    for (int k = 0; k < 3; k++) direction[k] *= extent / length;
    for (size_t c = 0; c < a->cell_count; c++) clipped[c] = (ray_interval){-HUGE_VALL, HUGE_VALL};
    for (size_t t = 0; t < a->tet_count; t++)
      for (int f = 0; f < 4; f++) {
        const uint32_t *v = &m->tets[4 * t];
        const uint8_t *corner = CELLIST_TET_FACE[f];
        clip_by_plane(&clipped[t], &m->positions[3 * v[corner[0]]], &m->positions[3 * v[corner[1]]],
                      &m->positions[3 * v[corner[2]]], -1, origin, direction);
      }
    ray_interval outer = {-HUGE_VALL, HUGE_VALL};
    for (size_t f = 0; f < a->facet_count; f++)
      for (int side = 0; side < 2; side++) {
        const uint32_t cell = a->facet_cells[2 * f + (size_t)side];
        if (cell != CELLIST_NONE && cell >= a->tet_count)
          clip_by_facet(&clipped[cell], a, f, side, extent, origin, direction);
        else if (cell == CELLIST_NONE)
          clip_by_facet(&outer, a, f, 1 - side, extent, origin, direction);
      }
    size_t count = 0;
    for (size_t c = 0; c < a->cell_count; c++)
      if (clipped[c].leave - clipped[c].enter > FAULT_SLIVER) clipped[count++] = clipped[c];
    qsort(clipped, count, sizeof *clipped, compare_intervals);
    faults.crossed += count;
    if (count == 0) continue;
    judge_contact(&faults, outer.enter, clipped[0].enter);
    for (size_t c = 0; c + 1 < count; c++) judge_contact(&faults, clipped[c].leave, clipped[c + 1].enter);
    judge_contact(&faults, clipped[count - 1].leave, outer.leave);
  }
  free(clipped);
  return faults;
}

typedef struct fault_edge {
  uint32_t cell, low, high;
  int direction;
} fault_edge;

static inline int compare_fault_edges(const void *a, const void *b) {
  const fault_edge *x = a, *y = b;
  if (x->cell != y->cell) return x->cell < y->cell ? -1 : 1;
  if (x->low != y->low) return x->low < y->low ? -1 : 1;
  if (x->high != y->high) return x->high < y->high ? -1 : 1;
  return x->direction - y->direction;
}

/* Edges of imaginary cells that are not used once in either direction. */
static inline size_t count_open_edges(const cellist_complex_arrays *a) {
  fault_edge *edges = malloc((2 * (size_t)a->facet_starts[a->facet_count] + 1) * sizeof *edges);
  size_t count = 0, open = 0;
  for (size_t f = 0; f < a->facet_count && edges != NULL; f++)
    for (int side = 0; side < 2; side++) {
      const uint32_t cell = a->facet_cells[2 * f + (size_t)side], begin = a->facet_starts[f];
      const uint32_t corners = a->facet_starts[f + 1] - begin;
      if (cell == CELLIST_NONE || cell < a->tet_count) continue;
      for (uint32_t i = 0; i < corners; i++) {
        const uint32_t u = a->facet_vertices[begin + i], v = a->facet_vertices[begin + (i + 1) % corners];
        edges[count++] = (fault_edge){cell, u < v ? u : v, u < v ? v : u, (u < v) == (side == 0) ? 1 : -1};
      }
    }
  qsort(edges, count, sizeof *edges, compare_fault_edges);
  for (size_t begin = 0, end; begin < count; begin = end) {
    const fault_edge *e = &edges[begin];
    for (end = begin + 1;
         end < count && edges[end].cell == e->cell && edges[end].low == e->low && edges[end].high == e->high;)
      end++;
    open += end - begin != 2 || e[0].direction + e[1].direction != 0;
  }
  free(edges);
  return open;
}

/* Planes of facets with nothing on one side that have a boundary point of the mesh on that side, exactly. */
static inline size_t count_facets_off_hull(const cellist_complex_arrays *a, const cellist_mesh_arrays *m) {
  enum { FRONT = 1, BACK = 2 };
  uint8_t *outside = calloc(a->plane_count + 1, 1), *judged = calloc(m->point_count + 1, 1);
  uint32_t *points = malloc((m->point_count + 1) * sizeof *points);
  size_t count = 0, off = 0;
  for (size_t t = 0; t < m->tet_count; t++)
    for (size_t face = 0; face < 4; face++)
      for (int c = 0; c < 3 && m->neighbours[4 * t + face] == CELLIST_NONE; c++) {
        const uint32_t point = m->tets[4 * t + CELLIST_TET_FACE[face][c]];
        if (!judged[point]) points[count++] = point;
        judged[point] = 1;
      }
  for (size_t f = 0; f < a->facet_count; f++)
    for (int side = 0; side < 2; side++)
      if (a->facet_cells[2 * f + (size_t)side] == CELLIST_NONE) outside[a->facet_planes[f]] |= side == 0 ? FRONT : BACK;
  for (size_t plane = 0; plane < a->plane_count; plane++) {
    const uint32_t *id = &a->planes[3 * plane];
    bool is_off = outside[plane] == (FRONT | BACK) || (outside[plane] != 0 && id[0] == CELLIST_NONE);
    for (size_t i = 0; i < count && outside[plane] != 0 && !is_off; i++) {
      const int sign = cellist_orient3d(&a->points[3 * (size_t)id[0]], &a->points[3 * (size_t)id[1]],
                                        &a->points[3 * (size_t)id[2]], &m->positions[3 * (size_t)points[i]]);
      is_off = sign == (outside[plane] == FRONT ? 1 : -1);
    }
    off += is_off;
  }
  free(outside);
  free(judged);
  free(points);
  return off;
}

/* Facets that are not between two cells, or between a cell and what is outside of the hull. */
static inline size_t count_facet_faults(const cellist_complex *complex, const cellist_mesh *mesh) {
  const cellist_complex_arrays *a = cellist_complex_get_arrays(complex);
  return count_open_edges(a) + count_facets_off_hull(a, cellist_mesh_get_arrays(mesh));
}

#endif
