/* SPDX-License-Identifier: BSD-3-Clause
 * Validation of cells one by one, and how many parts they form. */
#include "validate_private.h"

#include <math.h>

/* sin^2 of 0.1 degree. A larger angle warns of more cells; nothing but the warning depends on it. */
static const double NEEDLE_SINE_SQUARED = 3.046174e-6;

static void normal_of(const double *a, const double *b, const double *c, double n[3]) {
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  n[0] = u[1] * v[2] - u[2] * v[1];
  n[1] = u[2] * v[0] - u[0] * v[2];
  n[2] = u[0] * v[1] - u[1] * v[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Is a dihedral angle below 0.1 degree? With outward normals m and n of two faces (lengths: twice the areas) and their
 * edge e, m x n = 6 V e, so sin = 6 V |e| / (|m| |n|), and cos = - m.n / (|m| |n|): no cancellation in small angles. */
static bool is_needle(const double *const p[4]) {
  double normal[4][3], length[4];
  for (int f = 0; f < 4; f++) {
    const uint8_t *corner = CELLIST_TET_FACE[f];
    normal_of(p[corner[0]], p[corner[1]], p[corner[2]], normal[f]);
    length[f] = dot(normal[f], normal[f]);
  }
  const double height[3] = {p[3][0] - p[0][0], p[3][1] - p[0][1], p[3][2] - p[0][2]};
  const double volume = dot(normal[3], height); /* negative: the normal is outward; only its square is used */
  for (int f = 0; f < 3; f++)
    for (int g = f + 1; g < 4; g++) {
      if (dot(normal[f], normal[g]) >= 0) continue;
      const int a = f == 0 ? (g == 1 ? 2 : 1) : 0, b = 6 - f - g - a; /* the corners that are in both faces */
      const double e[3] = {p[b][0] - p[a][0], p[b][1] - p[a][1], p[b][2] - p[a][2]};
      if (volume * volume * dot(e, e) < NEEDLE_SINE_SQUARED * length[f] * length[g]) return true;
    }
  return false;
}

static void check_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  validation *run = user;
  const cellist_mesh_arrays *mesh = run->mesh;
  for (size_t t = begin; t < end; t++) {
    if (mesh->tet_flags[t] & CELLIST_TET_INVERTED) mark(run, t, CELLIST_FINDING_INVERTED);
    if (mesh->tet_flags[t] & CELLIST_TET_FLAT) {
      mark(run, t, CELLIST_FINDING_FLAT);
      continue;
    }
    const double *p[4];
    for (int c = 0; c < 4; c++) p[c] = point_of(mesh, mesh->tets[4 * t + (size_t)c]);
    if (is_needle(p)) mark(run, t, CELLIST_FINDING_NEEDLE);
  }
}

struct field_job {
  validation *run;
  const cellist_field *field;
};

static bool is_finite_at(const cellist_field *field, size_t i) {
  for (uint32_t k = 0; k < field->component_count; k++)
    if (!isfinite(field->values[i * field->component_count + k])) return false;
  return true;
}

static void check_field(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct field_job *job = user;
  for (size_t t = begin; t < end; t++) {
    bool is_finite = true;
    if (job->field->association == CELLIST_ON_CELLS)
      is_finite = is_finite_at(job->field, t);
    else
      for (size_t c = 0; c < 4; c++) is_finite &= is_finite_at(job->field, job->run->mesh->tets[4 * t + c]);
    if (!is_finite) mark(job->run, t, CELLIST_FINDING_NAN_SCALAR);
  }
}

/* Most fields are finite throughout, so cells are asked only where a value is not. */
static void check_fields(validation *run) {
  const cellist_mesh_arrays *mesh = run->mesh;
  for (size_t f = 0; f < mesh->field_count; f++) {
    const cellist_field *field = &mesh->fields[f];
    const size_t count = field->association == CELLIST_ON_POINTS ? mesh->point_count : mesh->tet_count;
    bool all_finite = true;
    for (size_t i = 0; i < count && all_finite; i++) all_finite = is_finite_at(field, i);
    struct field_job job = {run, field};
    if (!all_finite) cellist_parallel_for(run->context, mesh->tet_count, 4096, check_field, &job);
  }
}

static cellist_result count_components(validation *run) {
  const cellist_mesh_arrays *mesh = run->mesh;
  uint32_t *parent = set_create(run->context, mesh->tet_count);
  if (parent == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t f = 0; f < 4 * mesh->tet_count; f++)
    if (mesh->neighbours[f] < f / 4) set_join(parent, (uint32_t)(f / 4), mesh->neighbours[f]);
  for (size_t t = 0; t < mesh->tet_count; t++) run->report->component_count += parent[t] == t;
  cellist_deallocate(run->context, parent);
  return CELLIST_SUCCESS;
}

cellist_result validate_cells(validation *run) {
  cellist_parallel_for(run->context, run->mesh->tet_count, 4096, check_range, run);
  check_fields(run);
  return count_components(run);
}
