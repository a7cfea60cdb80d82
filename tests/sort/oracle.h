/* SPDX-License-Identifier: BSD-3-Clause
 * What the sorter's tests judge by: brute force over all tets for each ray, in long double, with no use of adjacency,
 * planes or predicates. Every pair of cells on a ray is looked at, not only those that touch. */
#ifndef CELLIST_TESTS_SORT_ORACLE_H
#define CELLIST_TESTS_SORT_ORACLE_H

#include <cellist/mesh.h>
#include <cellist/sort.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "desc.h"
#include "harness.h"

typedef struct oracle_count {
  size_t pairs, inversions, group_pairs;
} oracle_count;

struct oracle_interval {
  long double enter, leave;
  uint32_t tet;
};

static int oracle_compare(const void *a, const void *b) {
  const struct oracle_interval *p = a, *q = b;
  const long double x = p->enter + p->leave, y = q->enter + q->leave;
  return x < y ? -1 : x > y;
}

/* Shorter stretches than this, as a part of the ray's direction, are taken for a touch: rounding could invent them. */
static const long double ORACLE_TOUCH = 1e-9L;

/* Where the half-line (line, if parallel) crosses the tet; false if it does not or only touches it. */
static bool oracle_cross(const double *points, const uint32_t *v, const double *from, const double *direction,
                         bool line, struct oracle_interval *interval) {
  interval->enter = line ? -1e18L : 0;
  interval->leave = 1e18L;
  for (int k = 0; k < 4; k++) {
    const double *a = &points[3 * v[(k + 1) & 3]], *b = &points[3 * v[(k + 2) & 3]], *c = &points[3 * v[(k + 3) & 3]];
    const double *inside = &points[3 * v[k]];
    long double u[3], w[3], n[3], height = 0, speed = 0, depth = 0;
    for (int i = 0; i < 3; i++) {
      u[i] = (long double)b[i] - a[i];
      w[i] = (long double)c[i] - a[i];
    }
    for (int i = 0; i < 3; i++) n[i] = u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
    for (int i = 0; i < 3; i++) {
      height += n[i] * ((long double)from[i] - a[i]);
      speed += n[i] * direction[i];
      depth += n[i] * ((long double)inside[i] - a[i]);
    }
    if (depth == 0) return false; /* flat */
    if (depth < 0) height = -height, speed = -speed;
    if (speed == 0) {
      if (height <= 0) return false;
    } else if (speed > 0) {
      interval->enter = fmaxl(interval->enter, -height / speed);
    } else {
      interval->leave = fminl(interval->leave, -height / speed);
    }
  }
  return interval->leave - interval->enter > ORACLE_TOUCH;
}

static double oracle_random(random_state *random) { return random_between(random, -1, 1); }

/* A ray of the view through a random place of a random tet. */
static void oracle_ray(const cellist_sorter_desc *mesh, const cellist_viewpoint *view, random_state *random,
                       double from[3], double direction[3]) {
  const uint32_t *v = &mesh->tets[4 * random_below(random, mesh->tet_count)];
  double weight[4], sum = 0, through[3] = {0, 0, 0};
  for (int c = 0; c < 4; c++) sum += weight[c] = 0.01 + random_unit(random);
  for (int c = 0; c < 4; c++)
    for (int k = 0; k < 3; k++) through[k] += weight[c] / sum * mesh->points[3 * v[c] + (uint32_t)k];
  for (int k = 0; k < 3; k++) {
    from[k] = view->parallel ? through[k] : view->position[k];
    direction[k] = view->parallel ? view->position[k] : through[k] - view->position[k];
  }
}

/* Looks at every pair of cells on ray_count random rays of the view. Fails the case if order is no permutation. */
static oracle_count oracle_check(const cellist_sorter_desc *mesh, const cellist_viewpoint *view, const uint32_t *order,
                                 const cellist_group *groups, size_t group_count, size_t ray_count, uint64_t seed) {
  random_state random = {seed};
  oracle_count count = {0, 0, 0};
  struct oracle_interval *hits = calloc(mesh->tet_count + 1, sizeof *hits);
  size_t *rank = calloc(mesh->tet_count + 1, sizeof *rank);
  for (size_t i = 0; i < mesh->tet_count; i++) {
    assert_true(order[i] < mesh->tet_count && rank[order[i]] == 0);
    rank[order[i]] = i + 1;
  }
  /* Cells of one group get one rank. */
  for (size_t g = 0; g < group_count; g++)
    for (size_t i = 0; i < groups[g].count; i++) rank[order[groups[g].begin + i]] = groups[g].begin + 1;
  for (size_t r = 0; r < ray_count; r++) {
    double from[3], direction[3];
    oracle_ray(mesh, view, &random, from, direction);
    size_t hit_count = 0;
    for (uint32_t t = 0; t < mesh->tet_count; t++) {
      hits[hit_count].tet = t;
      hit_count += oracle_cross(mesh->points, &mesh->tets[4 * t], from, direction, view->parallel, &hits[hit_count]);
    }
    qsort(hits, hit_count, sizeof *hits, oracle_compare);
    for (size_t i = 0; i < hit_count; i++) {
      for (size_t j = i + 1; j < hit_count; j++) {
        const size_t near = rank[hits[i].tet], far = rank[hits[j].tet];
        count.pairs += near != far;
        count.group_pairs += near == far;
        count.inversions += near < far;
      }
    }
  }
  free(hits);
  free(rank);
  return count;
}

#endif
