/* SPDX-License-Identifier: BSD-3-Clause
 * Validation of the boundary as a surface: faces of the wrong number or side, edges and points where it is no manifold,
 * reflex edges, and the closed shells it falls into, of which those that face inwards are cavities.
 *
 * Around an edge, two boundary faces belong together if nothing but outside lies between them. Where an edge has more
 * than two, they are sorted by angle with exact signs, so that a cavity that touches the outer boundary along an edge
 * (sci_torso has one such) remains a shell of its own. */
#include "validate_private.h"

#include <cellist/predicates.h>
#include <cellist/radix.h>
#include <string.h>

/* Boundary faces at one edge that are sorted by angle; the shells of more stay apart there. Keeps the time linear. */
enum { WEDGE_LIMIT = 64 };

uint32_t *set_create(cellist_context *context, size_t count) {
  uint32_t *parent = cellist_allocate(context, count, sizeof *parent);
  for (size_t i = 0; i < count && parent != NULL; i++) parent[i] = (uint32_t)i;
  return parent;
}

static cellist_result list_faces(validation *run) {
  const size_t face_count = 4 * run->mesh->tet_count;
  for (size_t f = 0; f < face_count; f++) run->face_count += run->mesh->neighbours[f] == CELLIST_NONE;
  run->report->boundary_face_count = run->face_count;
  if (run->face_count > UINT32_MAX / 3)
    return cellist_fail(run->context, CELLIST_ERROR_UNSUPPORTED, "%zu boundary faces are more than 32-bit ids allow",
                        run->face_count);
  run->faces = cellist_allocate(run->context, run->face_count, sizeof *run->faces);
  if (run->faces == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  size_t count = 0;
  for (size_t f = 0; f < face_count; f++)
    if (run->mesh->neighbours[f] == CELLIST_NONE) run->faces[count++] = (uint32_t)f;
  return CELLIST_SUCCESS;
}

/* Keys and values to sort, with the scratch that the sort needs. */
struct sorting {
  uint64_t *keys;
  uint32_t *values;
  size_t count;
};

static cellist_result sorting_create(cellist_context *context, size_t count, struct sorting *sorting) {
  *sorting = (struct sorting){cellist_allocate(context, count, 2 * sizeof(uint64_t)),
                              cellist_allocate(context, count, 2 * sizeof(uint32_t)), count};
  return sorting->keys != NULL && sorting->values != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

static void sorting_release(cellist_context *context, struct sorting *sorting) {
  cellist_deallocate(context, sorting->keys);
  cellist_deallocate(context, sorting->values);
}

static void sorting_run(struct sorting *sorting) {
  cellist_radix_sort(sorting->keys, sorting->values, sorting->count, sorting->keys + sorting->count,
                     sorting->values + sorting->count, 64);
}

/* ---- Faces of more than one tet -------------------------------------------------------------------- */

/* A face's points in ascending order, and the tet's fourth. */
static void sorted_points(const cellist_mesh_arrays *mesh, uint32_t face, uint32_t v[4]) {
  for (int c = 0; c < 3; c++) {
    const uint32_t point = face_corner(mesh, face, c);
    int to = c;
    for (; to > 0 && v[to - 1] > point; to--) v[to] = v[to - 1];
    v[to] = point;
  }
  v[3] = mesh->tets[face];
}

/* Faces that stand in one group: same three points. Within it, tets with the same fourth point follow each other. */
static void judge_group(validation *run, const uint32_t *faces, size_t count) {
  size_t distinct = 1;
  for (size_t i = 1; i < count; i++) {
    if (run->mesh->tets[faces[i]] == run->mesh->tets[faces[i - 1]]) {
      mark(run, faces[i] / 4, CELLIST_FINDING_DUPLICATE);
      mark(run, faces[i - 1] / 4, CELLIST_FINDING_DUPLICATE);
    } else {
      distinct++;
    }
  }
  if (distinct == 1) return; /* copies of one cell: that says it all */
  for (size_t i = 0; i < count; i++)
    mark(run, faces[i] / 4, distinct == 2 ? CELLIST_FINDING_FOLDED : CELLIST_FINDING_OVERFULL);
}

/* Boundary faces by their points: radix sorts of the fourth point and the highest, then of the two lowest. */
static cellist_result judge_shared_faces(validation *run) {
  struct sorting sorting;
  cellist_result result = sorting_create(run->context, run->face_count, &sorting);
  if (result == CELLIST_SUCCESS) {
    uint32_t v[4];
    for (size_t i = 0; i < run->face_count; i++) {
      sorted_points(run->mesh, run->faces[i], v);
      sorting.keys[i] = (uint64_t)v[2] << 32 | v[3];
      sorting.values[i] = run->faces[i];
    }
    sorting_run(&sorting);
    for (size_t i = 0; i < run->face_count; i++) {
      sorted_points(run->mesh, sorting.values[i], v);
      sorting.keys[i] = (uint64_t)v[0] << 32 | v[1];
    }
    sorting_run(&sorting);
    for (size_t begin = 0, end; begin < run->face_count; begin = end) {
      sorted_points(run->mesh, sorting.values[begin], v);
      for (end = begin + 1; end < run->face_count; end++) {
        uint32_t other[4];
        sorted_points(run->mesh, sorting.values[end], other);
        if (memcmp(v, other, 3 * sizeof *v) != 0) break;
      }
      if (end - begin > 1) judge_group(run, &sorting.values[begin], end - begin);
    }
  }
  sorting_release(run->context, &sorting);
  return result;
}

/* Copies of a flat tet may pass for its neighbours: the face between two flat cells has no sides to compare. */
static void judge_flat_copies(validation *run) {
  const cellist_mesh_arrays *mesh = run->mesh;
  for (size_t t = 0; t < mesh->tet_count; t++) {
    if ((mesh->tet_flags[t] & CELLIST_TET_FLAT) == 0) continue;
    for (size_t k = 0; k < 4; k++) {
      const uint32_t other = mesh->neighbours[4 * t + k];
      if (other == CELLIST_NONE) continue;
      int shared = 0;
      for (size_t i = 0; i < 16; i++) shared += mesh->tets[4 * t + i / 4] == mesh->tets[4 * (size_t)other + i % 4];
      if (shared == 4) mark(run, t, CELLIST_FINDING_DUPLICATE);
    }
  }
}

/* ---- Edges ----------------------------------------------------------------------------------------- */

/* A boundary face at an edge from low to high (point ids): 3 * its index in faces + the corner opposite to the edge. */
typedef uint32_t edge_use;

struct surface {
  validation *run;
  uint32_t *shell; /* sets of faces that outside connects */
  uint32_t *fan;   /* [3 face_count] sets of face corners that share an edge at their point */
};

static uint32_t use_corner(const validation *run, edge_use use, uint32_t step) {
  return face_corner(run->mesh, run->faces[use / 3], (int)((use + step - use / 3 * 3) % 3));
}

static const double *use_apex(const validation *run, edge_use use) {
  return point_of(run->mesh, use_corner(run, use, 0));
}

/* Does the face go round from low to high? Then its outside lies on the side of growing angles around that axis. */
static bool is_forward(const validation *run, edge_use use) {
  return use_corner(run, use, 1) < use_corner(run, use, 2);
}

/* Are a and b on the same side of the line low high, all in one plane? */
static bool is_same_side(const double *low, const double *high, const double *a, const double *b) {
  for (int axis = 0; axis < 3; axis++) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double flat[4][2] = {{low[i], low[j]}, {high[i], high[j]}, {a[i], a[j]}, {b[i], b[j]}};
    const int side = cellist_orient2d(flat[0], flat[1], flat[2]);
    if (side != 0) return side == cellist_orient2d(flat[0], flat[1], flat[3]);
  }
  return false;
}

/* Less than 180 degrees of outside between two faces that it connects. */
static bool is_reflex(const validation *run, edge_use a, edge_use b) {
  const double *first = point_of(run->mesh, use_corner(run, a, 1)),
               *second = point_of(run->mesh, use_corner(run, a, 2));
  const int side = cellist_orient3d(first, second, use_apex(run, a), use_apex(run, b));
  return side > 0 || (side == 0 && is_same_side(first, second, use_apex(run, a), use_apex(run, b)));
}

static void connect(struct surface *surface, edge_use a, edge_use b) {
  set_join(surface->shell, a / 3, b / 3);
  surface->run->report->reflex_edge_count += is_reflex(surface->run, a, b);
}

/* Where b stands on the way round from a: 0 same angle, 1 before 180 degrees, 2 opposite, 3 beyond. */
static int quadrant(const double *low, const double *high, const double *a, const double *b) {
  const int side = cellist_orient3d(low, high, a, b);
  if (side != 0) return side > 0 ? 1 : 3;
  return is_same_side(low, high, a, b) ? 0 : 2;
}

/* Sorts by angle from the first face on; at equal angles the one that ends an outside comes first. */
static void sort_around(const validation *run, const double *low, const double *high, edge_use *uses, size_t count) {
  const double *zero = use_apex(run, uses[0]);
  int turn[WEDGE_LIMIT];
  for (size_t i = 0; i < count; i++) {
    const edge_use use = uses[i];
    const double *apex = use_apex(run, use);
    const int own = quadrant(low, high, zero, apex);
    size_t to = i;
    for (; to > 0; to--) {
      if (turn[to - 1] < own) break;
      if (turn[to - 1] == own) {
        const int side = cellist_orient3d(low, high, use_apex(run, uses[to - 1]), apex);
        if (side > 0 || (side == 0 && (!is_forward(run, uses[to - 1]) || is_forward(run, use)))) break;
      }
      turn[to] = turn[to - 1];
      uses[to] = uses[to - 1];
    }
    turn[to] = own;
    uses[to] = use;
  }
}

static void judge_edge(struct surface *surface, edge_use *uses, size_t count) {
  validation *run = surface->run;
  for (size_t i = 1; i < count; i++) /* of each face the corners 1 and 2 after the apex, in either order */
    for (uint32_t step = 1; step <= 2; step++) {
      const uint32_t first = uses[0] / 3 * 3 + (uses[0] + step) % 3;
      const uint32_t other_step = is_forward(run, uses[0]) == is_forward(run, uses[i]) ? step : 3 - step;
      set_join(surface->fan, first, uses[i] / 3 * 3 + (uses[i] + other_step) % 3);
    }
  if (count == 2) {
    connect(surface, uses[0], uses[1]);
    return;
  }
  run->report->nonmanifold_edge_count++;
  if (count > WEDGE_LIMIT) return;
  const uint32_t a = use_corner(run, uses[0], 1), b = use_corner(run, uses[0], 2);
  sort_around(run, point_of(run->mesh, a < b ? a : b), point_of(run->mesh, a < b ? b : a), uses, count);
  for (size_t i = 0; i < count; i++) {
    const edge_use next = uses[(i + 1) % count];
    if (is_forward(run, uses[i]) && !is_forward(run, next)) connect(surface, uses[i], next);
  }
}

static cellist_result judge_edges(struct surface *surface) {
  const validation *run = surface->run;
  struct sorting sorting;
  cellist_result result = sorting_create(run->context, 3 * run->face_count, &sorting);
  if (result == CELLIST_SUCCESS) {
    for (edge_use use = 0; use < 3 * run->face_count; use++) {
      const uint32_t a = use_corner(run, use, 1), b = use_corner(run, use, 2);
      sorting.keys[use] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
      sorting.values[use] = use;
    }
    sorting_run(&sorting);
    for (size_t begin = 0, end; begin < sorting.count; begin = end) {
      for (end = begin + 1; end < sorting.count && sorting.keys[end] == sorting.keys[begin];) end++;
      judge_edge(surface, &sorting.values[begin], end - begin);
    }
  }
  sorting_release(run->context, &sorting);
  return result;
}

/* ---- Points and shells ----------------------------------------------------------------------------- */

static cellist_result judge_vertices(const struct surface *surface) {
  const validation *run = surface->run;
  uint8_t *fans = cellist_allocate_zeroed(run->context, run->mesh->point_count, 1);
  if (fans == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (uint32_t corner = 0; corner < 3 * run->face_count; corner++) {
    uint8_t *count = &fans[face_corner(run->mesh, run->faces[corner / 3], (int)(corner % 3))];
    if (surface->fan[corner] == corner && ++*count == 2) run->report->nonmanifold_vertex_count++;
    if (*count > 2) *count = 2;
  }
  cellist_deallocate(run->context, fans);
  return CELLIST_SUCCESS;
}

/* Shells of negative volume; those of flat cells alone have none, however it rounds. */
static cellist_result count_cavities(const struct surface *surface) {
  const validation *run = surface->run;
  double *volume = cellist_allocate_zeroed(run->context, run->face_count, sizeof *volume);
  uint8_t *is_solid = cellist_allocate_zeroed(run->context, run->face_count, 1);
  const bool ok = volume != NULL && is_solid != NULL;
  for (uint32_t i = 0; i < run->face_count && ok; i++) {
    const uint32_t root = set_root(surface->shell, i);
    const double *p[4] = {point_of(run->mesh, face_corner(run->mesh, run->faces[root], 0))};
    double e[3][3];
    for (int c = 0; c < 3; c++) {
      p[c + 1] = point_of(run->mesh, face_corner(run->mesh, run->faces[i], c));
      for (int k = 0; k < 3; k++) e[c][k] = p[c + 1][k] - p[0][k];
    }
    volume[root] += e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                    e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    is_solid[root] |= (run->mesh->tet_flags[run->faces[i] / 4] & CELLIST_TET_FLAT) == 0;
  }
  for (size_t i = 0; i < run->face_count && ok; i++) run->report->cavity_count += is_solid[i] && volume[i] < 0;
  cellist_deallocate(run->context, volume);
  cellist_deallocate(run->context, is_solid);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

cellist_result validate_boundary(validation *run) {
  cellist_report *report = run->report;
  report->folded_face_count = run->facts->folded_face_count;
  report->overfull_face_count = run->facts->overfull_face_count;
  cellist_result result = list_faces(run);
  if (result == CELLIST_SUCCESS && report->folded_face_count + report->overfull_face_count > 0)
    result = judge_shared_faces(run);
  if (result == CELLIST_SUCCESS && run->facts->flat_count > 0) judge_flat_copies(run);
  struct surface surface = {.run = run};
  if (result == CELLIST_SUCCESS) {
    surface.shell = set_create(run->context, run->face_count);
    surface.fan = set_create(run->context, 3 * run->face_count);
    if (surface.shell == NULL || surface.fan == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  }
  if (result == CELLIST_SUCCESS) result = judge_edges(&surface);
  if (result == CELLIST_SUCCESS) result = judge_vertices(&surface);
  if (result == CELLIST_SUCCESS) result = count_cavities(&surface);
  cellist_deallocate(run->context, surface.shell);
  cellist_deallocate(run->context, surface.fan);
  report->is_convex = report->component_count == 1 && report->cavity_count == 0 && report->reflex_edge_count == 0 &&
                      report->nonmanifold_edge_count == 0 && report->nonmanifold_vertex_count == 0 &&
                      report->folded_face_count == 0 && report->overfull_face_count == 0;
  return result;
}
