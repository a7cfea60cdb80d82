/* SPDX-License-Identifier: BSD-3-Clause
 * Grid: a box of cubes, six tets each (Kuhn), with points moved at random on request.
 *
 * The spacing is a power of two, so that every plane of the unperturbed grid is exact. Points of a face of the box move
 * in that face and those of an edge along it: the box stays convex, its hull exactly its boundary. */
#include "builder.h"

#include <math.h>

/* The least volume that a moved tet keeps, in parts of its own. Smaller values let needles (dihedrals below 0.1 degree)
 * appear, which validation warns of; larger ones move points less. */
static const double KEPT_VOLUME = 0.15;

struct grid {
  uint32_t size[3];
  double spacing;
};

static void place(const void *shape, const uint32_t node[3], double position[3]) {
  const struct grid *grid = shape;
  for (int k = 0; k < 3; k++) position[k] = node[k] * grid->spacing;
}

/* The box of nearly equal edges whose number of cubes is nearest to the wanted one. */
static struct grid choose(double cubes) {
  struct grid best = {{1, 1, 1}, 1};
  const uint32_t n = cube_root_below(cubes);
  double nearest = HUGE_VAL;
  for (uint32_t b = n > 1 ? n - 1 : 1; b <= n + 1; b++)
    for (uint32_t c = b > 1 ? b - 1 : 1; c <= b; c++) {
      const double exact = cubes / b / c;
      const uint32_t a = exact < 1 ? 1 : (uint32_t)(exact + 0.5);
      const double miss = fabs((double)a * b * c - cubes);
      if (miss >= nearest) continue;
      nearest = miss;
      best = (struct grid){{a, b, c}, 1};
    }
  while (best.spacing * best.size[0] > 1) best.spacing /= 2;
  return best;
}

/* Six times the volume of tet t. */
static double volume_of(const mesh_builder *builder, size_t t) {
  const uint32_t *v = &builder->tets[4 * t];
  double e[3][3];
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      e[i][k] = builder->positions[3 * (size_t)v[i + 1] + (size_t)k] - builder->positions[3 * (size_t)v[0] + (size_t)k];
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/* Do all tets of the cubes around a node keep their volume? Cubes hold six consecutive tets. */
static bool is_sound_around(const mesh_builder *builder, const struct grid *grid, const uint32_t node[3]) {
  const double least = KEPT_VOLUME * grid->spacing * grid->spacing * grid->spacing;
  for (unsigned corner = 0; corner < 8; corner++) {
    uint32_t cube[3];
    bool inside = true;
    for (int k = 0; k < 3; k++) {
      cube[k] = node[k] - (corner >> k & 1); /* wraps below 0, and is then no cube */
      inside &= cube[k] < grid->size[k];
    }
    if (!inside) continue;
    const size_t first = 6 * (((size_t)cube[2] * grid->size[1] + cube[1]) * grid->size[0] + cube[0]);
    for (size_t t = first; t < first + 6; t++)
      if (volume_of(builder, t) < least) return false;
  }
  return true;
}

static void perturb(mesh_builder *builder, const struct grid *grid) {
  for (size_t i = 0; i < builder->point_count; i++) {
    const uint32_t *size = grid->size;
    const uint32_t node[3] = {(uint32_t)(i % (size[0] + 1)), (uint32_t)(i / (size[0] + 1) % (size[1] + 1)),
                              (uint32_t)(i / (size[0] + 1) / (size[1] + 1))};
    double *p = &builder->positions[3 * i], moved[3];
    for (int k = 0; k < 3; k++) {
      const double step = builder->desc.perturb * grid->spacing * random_between(&builder->random, -1, 1);
      moved[k] = node[k] == 0 || node[k] == size[k] ? 0 : step;
    }
    const double old[3] = {p[0], p[1], p[2]};
    /* The points before this one have moved, those after it have not: there is always room for a small step. */
    for (double part = 1;; part /= 2) {
      for (int k = 0; k < 3; k++) p[k] = old[k] + part * moved[k];
      if (is_sound_around(builder, grid, node)) break;
    }
  }
}

void generate_grid(mesh_builder *builder) {
  const struct grid grid = choose((double)builder->desc.size / 6);
  const mesh_lattice lattice = {.size = {grid.size[0], grid.size[1], grid.size[2]}, .place = place, .shape = &grid};
  builder_lattice(builder, &lattice);
  if (builder->result == CELLIST_SUCCESS && builder->desc.perturb > 0) perturb(builder, &grid);
}
