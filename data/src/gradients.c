/* SPDX-License-Identifier: BSD-3-Clause
 * Gradients: of cells by Cramer's rule, at points by least squares over the edges.
 *
 * The edges of a sound tet span space, so the normal equations of a point are regular; where they are not to working
 * precision (points that only flat cells use), the directions that the edges do not reach get no slope. */
#include <cellist/gradients.h>
#include <cellist/radix.h>
#include <math.h>
#include <string.h>

/* A pivot below this share of the first one is rounding: its direction is taken as not reached. Larger loses slopes
 * across slivers, smaller turns noise into slopes. */
static const double PIVOT_TOLERANCE = 1e-14;

static cellist_result check(cellist_context *context, const cellist_mesh *mesh, const cellist_scalar *scalar,
                            const double *gradients) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || scalar == NULL || gradients == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "gradients: mesh, scalar or gradients is NULL");
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const bool on_cells = scalar->association == CELLIST_ON_CELLS;
  if (scalar->count != (on_cells ? arrays->tet_count : arrays->point_count))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the scalar has %zu values, the mesh %zu %s",
                        scalar->count, on_cells ? arrays->tet_count : arrays->point_count,
                        on_cells ? "tets" : "points");
  return CELLIST_SUCCESS;
}

static void cross(double out[3], const double a[3], const double b[3]) {
  for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void gradient_of_cell(const cellist_mesh_arrays *mesh, const cellist_scalar *scalar, size_t tet,
                             double gradient[3]) {
  gradient[0] = gradient[1] = gradient[2] = 0;
  if (scalar->association == CELLIST_ON_CELLS || (mesh->tet_flags[tet] & CELLIST_TET_FLAT) != 0) return;
  const uint32_t *v = &mesh->tets[4 * tet];
  double edge[3][3], rise[3], normal[3][3], volume = 0;
  for (int e = 0; e < 3; e++) {
    rise[e] = scalar->values[v[e + 1]] - scalar->values[v[0]];
    if (!isfinite(rise[e])) return;
    for (size_t k = 0; k < 3; k++)
      edge[e][k] = mesh->positions[3 * (size_t)v[e + 1] + k] - mesh->positions[3 * (size_t)v[0] + k];
  }
  for (int e = 0; e < 3; e++) cross(normal[e], edge[(e + 1) % 3], edge[(e + 2) % 3]);
  for (int k = 0; k < 3; k++) volume += edge[0][k] * normal[0][k];
  if (!(volume > 0)) return;
  for (int k = 0; k < 3; k++)
    for (int e = 0; e < 3; e++) gradient[k] += rise[e] * normal[e][k] / volume;
}

struct job {
  const cellist_mesh_arrays *mesh;
  const cellist_scalar *scalar;
  double *gradients;
};

static void fill_cells(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  for (size_t t = begin; t < end; t++) gradient_of_cell(job->mesh, job->scalar, t, &job->gradients[3 * t]);
}

cellist_result cellist_gradients_of_cells(cellist_context *context, const cellist_mesh *mesh,
                                          const cellist_scalar *scalar, double *gradients) {
  const cellist_result wrong = check(context, mesh, scalar, gradients);
  if (wrong != CELLIST_SUCCESS) return wrong;
  struct job job = {cellist_mesh_get_arrays(mesh), scalar, gradients};
  cellist_parallel_for(context, job.mesh->tet_count, 4096, fill_cells, &job);
  return CELLIST_SUCCESS;
}

/* The normal equations of one point: the sums of d d^T (upper triangle) and of d times the scalar difference. */
struct normal_equations {
  double matrix[3][3], right[3];
};

/* Symmetric elimination with the largest diagonal element as pivot. */
static void solve(struct normal_equations *equations, double gradient[3]) {
  double(*m)[3] = equations->matrix, *r = equations->right;
  int order[3] = {0, 1, 2}, rank = 0;
  double first = 0;
  for (; rank < 3; rank++) {
    int best = rank;
    for (int i = rank + 1; i < 3; i++)
      if (m[order[i]][order[i]] > m[order[best]][order[best]]) best = i;
    const int swap = order[rank];
    order[rank] = order[best];
    order[best] = swap;
    const int p = order[rank];
    if (rank == 0) first = m[p][p];
    if (!(m[p][p] > PIVOT_TOLERANCE * first)) break;
    for (int i = rank + 1; i < 3; i++) {
      const int row = order[i];
      const double factor = m[row][p] / m[p][p];
      for (int j = rank + 1; j < 3; j++) m[row][order[j]] -= factor * m[p][order[j]];
      r[row] -= factor * r[p];
    }
  }
  gradient[0] = gradient[1] = gradient[2] = 0;
  for (int i = rank; i-- > 0;) {
    const int p = order[i];
    double value = r[p];
    for (int j = i + 1; j < rank; j++) value -= m[p][order[j]] * gradient[order[j]];
    gradient[p] = value / m[p][p];
  }
}

static void add_edge(const cellist_mesh_arrays *mesh, const cellist_scalar *scalar, uint64_t edge,
                     struct normal_equations *equations) {
  const size_t a = (size_t)(edge >> 32), b = (size_t)(edge & UINT32_MAX);
  const double rise = scalar->values[b] - scalar->values[a];
  if (!isfinite(rise)) return;
  double d[3];
  for (size_t k = 0; k < 3; k++) d[k] = mesh->positions[3 * b + k] - mesh->positions[3 * a + k];
  /* Both ends see the same product of differences: their signs cancel. */
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      equations[a].matrix[i][j] += d[i] * d[j];
      equations[b].matrix[i][j] += d[i] * d[j];
    }
    equations[a].right[i] += d[i] * rise;
    equations[b].right[i] += d[i] * rise;
  }
}

cellist_result cellist_gradients_at_points(cellist_context *context, const cellist_mesh *whole,
                                           const cellist_scalar *scalar, double *gradients) {
  const cellist_result wrong = check(context, whole, scalar, gradients);
  if (wrong != CELLIST_SUCCESS) return wrong;
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(whole);
  memset(gradients, 0, 3 * mesh->point_count * sizeof *gradients);
  if (scalar->association == CELLIST_ON_CELLS) return CELLIST_SUCCESS;
  const size_t count = 6 * mesh->tet_count;
  uint64_t *edges = cellist_allocate(context, count, sizeof *edges);
  uint64_t *scratch = cellist_allocate(context, count, sizeof *scratch);
  uint32_t *unused = cellist_allocate(context, count, 2 * sizeof *unused);
  struct normal_equations *equations = cellist_allocate_zeroed(context, mesh->point_count, sizeof *equations);
  const bool ok = edges != NULL && scratch != NULL && unused != NULL && equations != NULL;
  if (ok) {
    static const uint8_t ENDS[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    for (size_t i = 0; i < count; i++) {
      const uint32_t *v = &mesh->tets[4 * (i / 6)];
      const uint32_t a = v[ENDS[i % 6][0]], b = v[ENDS[i % 6][1]];
      edges[i] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
      unused[i] = 0;
    }
    cellist_radix_sort(edges, unused, count, scratch, &unused[count], 64);
    for (size_t i = 0; i < count; i++)
      if (i == 0 || edges[i] != edges[i - 1]) add_edge(mesh, scalar, edges[i], equations);
    for (size_t p = 0; p < mesh->point_count; p++) solve(&equations[p], &gradients[3 * p]);
  }
  cellist_deallocate(context, edges);
  cellist_deallocate(context, scratch);
  cellist_deallocate(context, unused);
  cellist_deallocate(context, equations);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}
