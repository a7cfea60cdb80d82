/* SPDX-License-Identifier: BSD-3-Clause
 * Slopes: how fast the scalar can change in a cell, from its gradient by Cramer's rule and the rounding of it. */
#include "slopes.h"

#include <math.h>

static void cross(double out[3], const double a[3], const double b[3]) {
  for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Edges from corner 0, scalar differences along them, and six times the volume; false: nothing to take a gradient of.
 */
struct cell {
  double edge[3][3], rise[3], normal[3][3], volume;
};

static bool cell_begin(const cellist_mesh_arrays *mesh, const cellist_scalar *scalar, uint32_t tet, struct cell *cell) {
  if (scalar->association == CELLIST_ON_CELLS || (mesh->tet_flags[tet] & CELLIST_TET_FLAT) != 0) return false;
  const uint32_t *v = &mesh->tets[4 * (size_t)tet];
  for (int e = 0; e < 3; e++) {
    cell->rise[e] = scalar->values[v[e + 1]] - scalar->values[v[0]];
    if (!isfinite(cell->rise[e])) return false;
    for (int k = 0; k < 3; k++)
      cell->edge[e][k] =
          mesh->positions[3 * (size_t)v[e + 1] + (size_t)k] - mesh->positions[3 * (size_t)v[0] + (size_t)k];
  }
  for (int e = 0; e < 3; e++) cross(cell->normal[e], cell->edge[(e + 1) % 3], cell->edge[(e + 2) % 3]);
  cell->volume = 0;
  for (int k = 0; k < 3; k++) cell->volume += cell->edge[0][k] * cell->normal[0][k];
  return true;
}

struct job {
  const cellist_mesh_arrays *mesh;
  const cellist_scalar *scalar;
  float *slopes;
};

static double length_of(const double v[3]) { return hypot(hypot(v[0], v[1]), v[2]); }

static void fill_slopes(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  for (size_t t = begin; t < end; t++) {
    struct cell cell;
    job->slopes[t] = 0;
    if (!cell_begin(job->mesh, job->scalar, (uint32_t)t, &cell)) continue;
    double gradient[3] = {0}, terms = 0;
    for (int e = 0; e < 3; e++) {
      terms += fabs(cell.rise[e]) * length_of(cell.edge[(e + 1) % 3]) * length_of(cell.edge[(e + 2) % 3]);
      for (int k = 0; k < 3; k++) gradient[k] += cell.rise[e] * cell.normal[e][k];
    }
    /* Rounding: some 8 u of the terms, and of the volume; a volume that may be nothing but rounding bounds nothing. */
    const double doubt = 16 * 0x1p-53;
    const double box = length_of(cell.edge[0]) * length_of(cell.edge[1]) * length_of(cell.edge[2]);
    const double volume = cell.volume - doubt * box;
    const double slope = volume > 0 ? (length_of(gradient) + doubt * terms) / volume * (1 + 1e-6) : HUGE_VAL;
    job->slopes[t] = slope > 1e38 ? HUGE_VALF : slope > 0 ? (float)slope + 1e-37F : 0;
  }
}

void gradient_slopes(cellist_context *context, const cellist_mesh_arrays *mesh, const cellist_scalar *scalar,
                     float *slopes) {
  struct job job = {.mesh = mesh, .scalar = scalar, .slopes = slopes};
  cellist_parallel_for(context, mesh->tet_count, 4096, fill_slopes, &job);
}
