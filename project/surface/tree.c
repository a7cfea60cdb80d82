/* SPDX-License-Identifier: BSD-3-Clause
 * Tree: the triangles stand along a space-filling curve (surface.c), so halving their list again and again makes good
 * boxes (Lauterbach et al. 2009). A ray is tested with the triangles after a shear that lets it run along one axis
 * (Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", 2013): an edge's function changes only its sign if its
 * ends change places, so that of two triangles at an edge at least one has the ray. Double precision throughout. */
#include "tree.h"

#include <math.h>

/* Triangles of a leaf. Fewer: more boxes; more: triangles tested in vain. */
enum { LEAF = 4, MOST_DEPTH = 64 };

/* By what a box's ends may be off, relative: difference, product and reciprocal round once each. Less, and a ray along
 * a flat box may miss it. */
static const double BOX_ROUNDING = 8 * 0x1p-53;

static void include_triangle(surface_node *node, const cellist_surface_arrays *arrays, size_t triangle) {
  for (size_t c = 0; c < 3; c++) {
    const double *p = &arrays->positions[3 * (size_t)arrays->triangles[3 * triangle + c]];
    for (int k = 0; k < 3; k++) {
      node->low[k] = p[k] < node->low[k] ? p[k] : node->low[k];
      node->high[k] = p[k] > node->high[k] ? p[k] : node->high[k];
    }
  }
}

/* Makes the node over triangles begin to end - 1, and those below it, from tree->node_count on. */
static void build_range(const cellist_surface_arrays *arrays, size_t begin, size_t end, surface_tree *tree) {
  surface_node *node = &tree->nodes[tree->node_count++];
  *node = (surface_node){.low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  if (end - begin <= LEAF) {
    node->first = (uint32_t)begin;
    node->count = (uint32_t)(end - begin);
    for (size_t i = begin; i < end; i++) include_triangle(node, arrays, i);
    return;
  }
  const size_t middle = begin + (end - begin) / 2;
  const surface_node *below[2] = {node + 1, NULL};
  build_range(arrays, begin, middle, tree);
  node->first = (uint32_t)tree->node_count;
  below[1] = &tree->nodes[node->first];
  build_range(arrays, middle, end, tree);
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++) {
      node->low[k] = fmin(node->low[k], below[i]->low[k]);
      node->high[k] = fmax(node->high[k], below[i]->high[k]);
    }
}

cellist_result surface_tree_build(cellist_context *context, const cellist_surface_arrays *arrays, surface_tree *tree) {
  *tree = (surface_tree){0};
  if (arrays->triangle_count == 0) return CELLIST_SUCCESS;
  /* Halves of more than LEAF triangles have at least LEAF / 2: so many leaves at most. */
  const size_t leaves = (arrays->triangle_count + LEAF / 2 - 1) / (LEAF / 2);
  tree->nodes = cellist_allocate(context, 2 * leaves, sizeof *tree->nodes);
  if (tree->nodes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  build_range(arrays, 0, arrays->triangle_count, tree);
  return CELLIST_SUCCESS;
}

void surface_tree_release(cellist_context *context, surface_tree *tree) {
  cellist_deallocate(context, tree->nodes);
  *tree = (surface_tree){0};
}

/* A ray as its tests want it. */
struct ray {
  double origin[3], inverse[3];
  int x, y, z;
  double shear_x, shear_y, t_per_z;
};

static struct ray begin_ray(const double origin[3], const double direction[3]) {
  struct ray ray = {.z = 0};
  for (int k = 0; k < 3; k++) {
    ray.origin[k] = origin[k];
    ray.inverse[k] = 1 / direction[k];
    if (fabs(direction[k]) > fabs(direction[ray.z])) ray.z = k;
  }
  ray.x = (ray.z + 1) % 3;
  ray.y = (ray.z + 2) % 3;
  ray.shear_x = direction[ray.x] / direction[ray.z];
  ray.shear_y = direction[ray.y] / direction[ray.z];
  ray.t_per_z = 1 / direction[ray.z];
  return ray;
}

/* Where the ray enters the box, or infinity if it misses it between from and to. Comparisons are such that a NaN (the
 * ray lies in a side's plane: 0 times infinity) counts as inside. */
static double enter_box(const struct ray *ray, const surface_node *node, double from, double to) {
  for (int k = 0; k < 3; k++) {
    const double a = (node->low[k] - ray->origin[k]) * ray->inverse[k];
    const double b = (node->high[k] - ray->origin[k]) * ray->inverse[k];
    const double near = ray->inverse[k] < 0 ? b : a, far = ray->inverse[k] < 0 ? a : b;
    const double sure_near = near - fabs(near) * BOX_ROUNDING, sure_far = far + fabs(far) * BOX_ROUNDING;
    if (sure_near > from) from = sure_near;
    if (sure_far < to) to = sure_far;
  }
  return from <= to ? from : HUGE_VAL;
}

static void meet_triangle(const struct ray *ray, const cellist_surface_arrays *arrays, uint32_t triangle, double from,
                          surface_hit *hit) {
  double x[3], y[3], z[3], w[3];
  for (size_t c = 0; c < 3; c++) {
    const double *p = &arrays->positions[3 * (size_t)arrays->triangles[3 * (size_t)triangle + c]];
    z[c] = p[ray->z] - ray->origin[ray->z];
    x[c] = (p[ray->x] - ray->origin[ray->x]) - ray->shear_x * z[c];
    y[c] = (p[ray->y] - ray->origin[ray->y]) - ray->shear_y * z[c];
  }
  for (int c = 0; c < 3; c++) {
    const int i = (c + 1) % 3, j = (c + 2) % 3;
    w[c] = x[i] * y[j] - y[i] * x[j];
  }
  if ((w[0] < 0 || w[1] < 0 || w[2] < 0) && (w[0] > 0 || w[1] > 0 || w[2] > 0)) return;
  const double sum = w[0] + w[1] + w[2];
  if (!(sum != 0) || !isfinite(sum)) return;
  double depth = 0;
  for (int c = 0; c < 3; c++) depth += w[c] / sum * z[c];
  const double t = depth * ray->t_per_z;
  if (!(t >= from && (t < hit->t || (t == hit->t && triangle < hit->triangle)))) return;
  *hit = (surface_hit){t, triangle, {w[0] / sum, w[1] / sum, w[2] / sum}};
}

bool surface_tree_nearest(const surface_tree *tree, const cellist_surface_arrays *arrays, const double origin[3],
                          const double direction[3], const double interval[2], surface_hit *hit) {
  if (tree->node_count == 0 || !(interval[0] <= interval[1])) return false;
  const struct ray ray = begin_ray(origin, direction);
  /* No triangle has the number CELLIST_NONE: one at the interval's very end counts. */
  surface_hit best = {.t = interval[1], .triangle = CELLIST_NONE};
  struct {
    uint32_t node;
    double enters;
  } stack[MOST_DEPTH];
  size_t depth = 0;
  stack[depth].node = 0;
  stack[depth++].enters = enter_box(&ray, &tree->nodes[0], interval[0], best.t);
  while (depth > 0) {
    depth--;
    if (!(stack[depth].enters <= best.t) || isinf(stack[depth].enters)) continue;
    const surface_node *node = &tree->nodes[stack[depth].node];
    if (node->count > 0) {
      for (uint32_t i = 0; i < node->count; i++) meet_triangle(&ray, arrays, node->first + i, interval[0], &best);
      continue;
    }
    const uint32_t below[2] = {stack[depth].node + 1, node->first};
    double enters[2];
    for (int i = 0; i < 2; i++) enters[i] = enter_box(&ray, &tree->nodes[below[i]], interval[0], best.t);
    const int near = enters[1] < enters[0];
    for (int i = 0; i < 2; i++) { /* the nearer one on top */
      const int which = i == 0 ? 1 - near : near;
      stack[depth].node = below[which];
      stack[depth++].enters = enters[which];
    }
  }
  if (best.triangle == CELLIST_NONE) return false;
  *hit = best;
  return true;
}
