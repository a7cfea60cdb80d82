/* SPDX-License-Identifier: BSD-3-Clause
 * Boundary: faces with a cell on one side only, their vertices packed together (a view reads them many times), and
 * their planes in double with a bound on the error. */
#include "boundary.h"

#include <cellist/radix.h>
#include <math.h>

#include "../view.h"

/* The sum of a few roundings' relative errors: each of the normal's coordinates is off by at most 4 units of the
 * product sums, and a height by 4 more; twice that is asked for. A smaller one lets rounding decide. */
static const double PLANE_DOUBT = 16 * 0x1p-53;

void sort_face_plane_make(const double *a, const double *b, const double *c, sort_face_plane *plane) {
  double u[3], w[3], u_sum = 0, w_sum = 0;
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    w[k] = c[k] - a[k];
    u_sum += fabs(u[k]);
    w_sum += fabs(w[k]);
    plane->point[k] = a[k];
  }
  for (int k = 0; k < 3; k++) plane->normal[k] = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
  plane->doubt = PLANE_DOUBT * u_sum * w_sum;
}

static void fill(const cellist_sorter_desc *mesh, const uint32_t *vertex_of, sort_boundary *boundary) {
  size_t face_count = 0, row_count = 0;
  for (uint32_t tet = 0; tet < mesh->tet_count; tet++) {
    boundary->tet_rows[tet] = CELLIST_NONE;
    for (uint32_t k = 0; k < 4; k++) {
      if (mesh->neighbours[4 * (size_t)tet + k] != CELLIST_NONE) continue;
      if (boundary->tet_rows[tet] == CELLIST_NONE) {
        boundary->row_faces[row_count] = (uint32_t)face_count;
        boundary->row_tets[row_count] = tet;
        boundary->tet_rows[tet] = (uint32_t)row_count++;
      }
      boundary->faces[face_count] = 4 * tet + k;
      boundary->rows[face_count] = boundary->tet_rows[tet];
      const double *p[3];
      for (uint32_t c = 0; c < 3; c++) {
        const uint32_t point = mesh->tets[4 * (size_t)tet + SORT_TET_FACE[k][c]];
        boundary->corners[3 * face_count + c] = vertex_of[point];
        p[c] = &mesh->points[3 * (size_t)point];
      }
      sort_face_plane_make(p[0], p[1], p[2], &boundary->planes[face_count++]);
    }
  }
  boundary->row_faces[row_count] = (uint32_t)face_count;
}

/* Pairs edges that two faces have in opposite directions; of more faces at one edge, any two that do. */
static cellist_result find_mates(cellist_context *context, sort_boundary *boundary) {
  const size_t count = 3 * boundary->face_count;
  uint64_t *keys = cellist_allocate(context, count, 2 * sizeof *keys);
  uint32_t *edges = cellist_allocate(context, count, 2 * sizeof *edges);
  if (keys == NULL || edges == NULL) {
    cellist_deallocate(context, keys);
    cellist_deallocate(context, edges);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    const uint64_t a = boundary->corners[i], b = boundary->corners[i - i % 3 + (i + 1) % 3];
    keys[i] = a < b ? a << 32 | b : b << 32 | a;
    edges[i] = (uint32_t)i;
    boundary->mates[i] = CELLIST_NONE;
  }
  cellist_radix_sort(keys, edges, count, &keys[count], &edges[count], 64);
  for (size_t i = 0; i < count; i++) {
    const uint32_t first = edges[i];
    for (size_t j = i + 1; boundary->mates[first] == CELLIST_NONE && j < count && keys[j] == keys[i]; j++) {
      const uint32_t second = edges[j];
      if (boundary->mates[second] != CELLIST_NONE || boundary->corners[first] == boundary->corners[second]) continue;
      boundary->mates[first] = second / 3;
      boundary->mates[second] = first / 3;
    }
  }
  cellist_deallocate(context, keys);
  cellist_deallocate(context, edges);
  return CELLIST_SUCCESS;
}

cellist_result sort_boundary_create(cellist_context *context, const cellist_sorter_desc *mesh,
                                    sort_boundary *boundary) {
  uint32_t *vertex_of = cellist_allocate_zeroed(context, mesh->point_count, sizeof *vertex_of);
  if (vertex_of == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (uint32_t tet = 0; tet < mesh->tet_count; tet++) {
    bool on_boundary = false;
    for (uint32_t k = 0; k < 4; k++) {
      if (mesh->neighbours[4 * (size_t)tet + k] != CELLIST_NONE) continue;
      on_boundary = true;
      boundary->face_count++;
      for (uint32_t c = 0; c < 3; c++) vertex_of[mesh->tets[4 * (size_t)tet + SORT_TET_FACE[k][c]]] = 1;
    }
    boundary->row_count += on_boundary;
  }
  const size_t faces = boundary->face_count;
  if (faces > UINT32_MAX / 3) {
    cellist_deallocate(context, vertex_of);
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%zu boundary faces are more than 32-bit ids allow", faces);
  }
  for (size_t i = 0; i < mesh->point_count; i++) boundary->vertex_count += vertex_of[i];
  boundary->positions = cellist_allocate(context, boundary->vertex_count, 3 * sizeof *boundary->positions);
  boundary->faces = cellist_allocate(context, faces, sizeof *boundary->faces);
  boundary->corners = cellist_allocate(context, faces, 3 * sizeof *boundary->corners);
  boundary->mates = cellist_allocate(context, faces, 3 * sizeof *boundary->mates);
  boundary->rows = cellist_allocate(context, faces, sizeof *boundary->rows);
  boundary->planes = cellist_allocate(context, faces, sizeof *boundary->planes);
  boundary->row_faces = cellist_allocate(context, boundary->row_count + 1, sizeof *boundary->row_faces);
  boundary->row_tets = cellist_allocate(context, boundary->row_count, sizeof *boundary->row_tets);
  boundary->tet_rows = cellist_allocate(context, mesh->tet_count, sizeof *boundary->tet_rows);
  const bool ok = boundary->positions != NULL && boundary->faces != NULL && boundary->corners != NULL &&
                  boundary->mates != NULL && boundary->rows != NULL && boundary->planes != NULL &&
                  boundary->row_faces != NULL && boundary->row_tets != NULL && boundary->tet_rows != NULL;
  if (ok) {
    uint32_t next = 0;
    for (size_t i = 0; i < mesh->point_count; i++) {
      if (vertex_of[i] == 0) continue;
      for (size_t k = 0; k < 3; k++) boundary->positions[3 * (size_t)next + k] = mesh->points[3 * i + k];
      vertex_of[i] = next++;
    }
    fill(mesh, vertex_of, boundary);
  }
  cellist_deallocate(context, vertex_of);
  return ok ? find_mates(context, boundary) : CELLIST_ERROR_OUT_OF_MEMORY;
}

void sort_boundary_release(cellist_context *context, sort_boundary *boundary) {
  cellist_deallocate(context, boundary->positions);
  cellist_deallocate(context, boundary->faces);
  cellist_deallocate(context, boundary->corners);
  cellist_deallocate(context, boundary->mates);
  cellist_deallocate(context, boundary->rows);
  cellist_deallocate(context, boundary->planes);
  cellist_deallocate(context, boundary->row_faces);
  cellist_deallocate(context, boundary->row_tets);
  cellist_deallocate(context, boundary->tet_rows);
  *boundary = (sort_boundary){0};
}
