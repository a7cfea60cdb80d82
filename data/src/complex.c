/* SPDX-License-Identifier: BSD-3-Clause
 * Complex: keeps the arrays of a convexified mesh (paper [C] section 6: "the exterior volume as imaginary cells") and
 * checks what can be checked without exact vertices. What needs them (convexity, volumes) convexify/ checks where it
 * still has them. */
#include <cellist/complex.h>
#include <cellist/predicates.h>
#include <math.h>
#include <string.h>

struct cellist_complex {
  cellist_context *context;
  cellist_complex_arrays arrays;
};

/* How far a rounded vertex may stand from where it is: a part of the extent, for what is computed in double, and one of
 * the largest coordinate, for the coordinates themselves (half a unit in the last place along each axis: 0.9 of this).
 * Smaller: sound complexes fail. */
static const double ROUNDING = 1e-13, COORDINATE_ROUNDING = 2 * 0x1p-53;

static cellist_result check_ids(cellist_context *context, const cellist_complex_arrays *a) {
  if (a->cell_count < a->tet_count || a->cell_count >= CELLIST_NONE || a->facet_count >= CELLIST_NONE)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "complex: %zu cells, %zu tets, %zu facets",
                        a->cell_count, a->tet_count, a->facet_count);
  for (size_t i = 0; i < a->plane_count; i++) {
    const uint32_t *p = &a->planes[3 * i];
    const bool ok = p[0] == CELLIST_NONE ? p[1] < 3 && p[2] < a->offset_count
                                         : p[0] < a->point_count && p[1] < a->point_count && p[2] < a->point_count;
    if (!ok) return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "complex: plane %zu is out of range", i);
  }
  if (!(a->flat_angle >= 0 && a->flat_angle < 1.6 && a->flat_distance >= 0 && isfinite(a->flat_distance)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "complex: a tolerance of %g and %g", a->flat_angle,
                        a->flat_distance);
  if (a->facet_starts[0] != 0)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "complex: corners do not start at 0");
  for (size_t f = 0; f < a->facet_count; f++) {
    const uint32_t *cells = &a->facet_cells[2 * f];
    bool ok = a->facet_planes[f] < a->plane_count && a->facet_starts[f + 1] >= (uint64_t)a->facet_starts[f] + 3;
    for (int s = 0; s < 2; s++) ok &= cells[s] < a->cell_count || cells[s] == CELLIST_NONE;
    ok &= cells[0] != cells[1];
    if (!ok) return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "complex: facet %zu is malformed", f);
  }
  for (size_t i = 0; i < a->facet_starts[a->facet_count]; i++)
    if (a->facet_vertices[i] >= a->vertex_count)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "complex: corner %zu is out of range", i);
  return CELLIST_SUCCESS;
}

static bool copy_array(cellist_context *context, const void *from, size_t count, size_t size, const void *to) {
  void *copy = cellist_allocate(context, count, size);
  if (copy == NULL) return false;
  if (count > 0) memcpy(copy, from, count * size);
  memcpy((void *)to, &copy, sizeof copy);
  return true;
}

cellist_result cellist_complex_create(cellist_context *context, const cellist_complex_arrays *arrays,
                                      cellist_complex **complex) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (arrays == NULL || complex == NULL || arrays->facet_starts == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_complex_create: an argument is NULL");
  const size_t corner_count = arrays->facet_starts[arrays->facet_count];
  if ((arrays->points == NULL && arrays->point_count > 0) || (arrays->offsets == NULL && arrays->offset_count > 0) ||
      (arrays->planes == NULL && arrays->plane_count > 0) || (arrays->vertices == NULL && arrays->vertex_count > 0) ||
      (arrays->facet_count > 0 && (arrays->facet_planes == NULL || arrays->facet_cells == NULL)) ||
      (arrays->facet_vertices == NULL && corner_count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_complex_create: an array is NULL");
  cellist_result result = check_ids(context, arrays);
  if (result != CELLIST_SUCCESS) return result;
  cellist_complex *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  cellist_complex_arrays *a = &created->arrays;
  a->tet_count = arrays->tet_count;
  a->cell_count = arrays->cell_count;
  a->point_count = arrays->point_count;
  a->offset_count = arrays->offset_count;
  a->plane_count = arrays->plane_count;
  a->facet_count = arrays->facet_count;
  a->vertex_count = arrays->vertex_count;
  a->flat_angle = arrays->flat_angle;
  a->flat_distance = arrays->flat_distance;
  const bool ok = copy_array(context, arrays->points, a->point_count, 3 * sizeof(double), &a->points) &&
                  copy_array(context, arrays->offsets, a->offset_count, sizeof(double), &a->offsets) &&
                  copy_array(context, arrays->planes, a->plane_count, 3 * sizeof(uint32_t), &a->planes) &&
                  copy_array(context, arrays->facet_planes, a->facet_count, sizeof(uint32_t), &a->facet_planes) &&
                  copy_array(context, arrays->facet_cells, a->facet_count, 2 * sizeof(uint32_t), &a->facet_cells) &&
                  copy_array(context, arrays->facet_starts, a->facet_count + 1, sizeof(uint32_t), &a->facet_starts) &&
                  copy_array(context, arrays->facet_vertices, corner_count, sizeof(uint32_t), &a->facet_vertices) &&
                  copy_array(context, arrays->vertices, a->vertex_count, 3 * sizeof(double), &a->vertices);
  if (!ok) {
    cellist_complex_destroy(created);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  *complex = created;
  return CELLIST_SUCCESS;
}

void cellist_complex_destroy(cellist_complex *complex) {
  if (complex == NULL) return;
  cellist_context *context = complex->context;
  cellist_complex_arrays *a = &complex->arrays;
  const void *blocks[] = {a->points,      a->offsets,      a->planes,         a->facet_planes,
                          a->facet_cells, a->facet_starts, a->facet_vertices, a->vertices};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) cellist_deallocate(context, (void *)blocks[i]);
  cellist_deallocate(context, complex);
}

const cellist_complex_arrays *cellist_complex_get_arrays(const cellist_complex *complex) { return &complex->arrays; }

/* ---- Validity -------------------------------------------------------------------------------------- */

struct frame {
  const double *origin; /* a vertex */
  double extent, largest;
};

struct plane {
  double normal[3], offset; /* unit normal towards the positive side: n.x - offset */
};

/* The plane in double, about a point of its own so that far offsets cancel. False: it spans nothing. */
static bool plane_of(const cellist_complex_arrays *a, uint32_t plane, const double origin[3], struct plane *out) {
  const uint32_t *id = &a->planes[3 * (size_t)plane];
  if (id[0] == CELLIST_NONE) {
    for (int k = 0; k < 3; k++) out->normal[k] = k == (int)id[1];
    out->offset = a->offsets[id[2]] - origin[id[1]];
    return true;
  }
  const double *p = &a->points[3 * (size_t)id[0]], *q = &a->points[3 * (size_t)id[1]],
               *r = &a->points[3 * (size_t)id[2]];
  double largest = 0, u[3], v[3];
  for (int k = 0; k < 3; k++) {
    u[k] = q[k] - p[k];
    v[k] = r[k] - p[k];
    largest = fmax(largest, fmax(fabs(u[k]), fabs(v[k])));
  }
  if (!(largest > 0)) return false;
  for (int k = 0; k < 3; k++) {
    u[k] /= largest;
    v[k] /= largest;
  }
  double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(length > 0)) return false;
  out->offset = 0;
  for (int k = 0; k < 3; k++) {
    out->normal[k] = n[k] / length;
    out->offset += out->normal[k] * (p[k] - origin[k]);
  }
  return true;
}

/* How much the plane's direction may be off, as a factor on ROUNDING: slender triples lose digits. */
static double slenderness(const cellist_complex_arrays *a, uint32_t plane, double extent) {
  const uint32_t *id = &a->planes[3 * (size_t)plane];
  if (id[0] == CELLIST_NONE) return 1;
  const double *p = &a->points[3 * (size_t)id[0]], *q = &a->points[3 * (size_t)id[1]],
               *r = &a->points[3 * (size_t)id[2]];
  double u[3], v[3], w[3], uu = 0, vv = 0, ww = 0;
  for (int k = 0; k < 3; k++) {
    u[k] = (q[k] - p[k]) / extent;
    v[k] = (r[k] - p[k]) / extent;
    w[k] = u[k] - v[k];
    uu += u[k] * u[k];
    vv += v[k] * v[k];
    ww += w[k] * w[k];
  }
  const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
  const double longest = sqrt(fmax(uu, fmax(vv, ww)));
  const double height = sqrt(x * x + y * y + z * z) / longest;
  return height > 0 ? 1 + 1 / fmin(height, 1) : HUGE_VAL;
}

/* How far a corner may stand from a plane that it lies in: planes are stored exactly, so only what is computed with
 * them suffers from slender triples. */
static double plane_tolerance(const cellist_complex_arrays *a, uint32_t plane, const struct frame *frame) {
  return ROUNDING * frame->extent * slenderness(a, plane, frame->extent) + COORDINATE_ROUNDING * frame->largest;
}

static bool reject(cellist_context *context, const char *what, size_t which) {
  cellist_fail(context, CELLIST_ERROR_GEOMETRY, "complex: %s %zu", what, which);
  return false;
}

/* Facets lie in their planes and are convex, seen from the positive side. */
static bool facets_fit(cellist_context *context, const cellist_complex_arrays *a, const struct frame *frame) {
  const double *origin = frame->origin;
  for (size_t f = 0; f < a->facet_count; f++) {
    struct plane plane;
    if (!plane_of(a, a->facet_planes[f], origin, &plane)) return reject(context, "no plane of facet", f);
    const double tolerance = plane_tolerance(a, a->facet_planes[f], frame);
    const uint32_t begin = a->facet_starts[f], count = a->facet_starts[f + 1] - begin;
    for (uint32_t i = 0; i < count; i++) {
      const double *p = &a->vertices[3 * (size_t)a->facet_vertices[begin + i]];
      const double *q = &a->vertices[3 * (size_t)a->facet_vertices[begin + (i + 1) % count]];
      const double *r = &a->vertices[3 * (size_t)a->facet_vertices[begin + (i + 2) % count]];
      double distance = -plane.offset, turn = 0, length = 0;
      for (int k = 0; k < 3; k++) {
        const int j = (k + 1) % 3, l = (k + 2) % 3;
        distance += plane.normal[k] * (p[k] - origin[k]);
        turn += plane.normal[k] * ((q[j] - p[j]) * (r[l] - q[l]) - (q[l] - p[l]) * (r[j] - q[j]));
        length = fmax(length, fmax(fabs(q[k] - p[k]), fabs(r[k] - q[k])));
      }
      if (fabs(distance) > tolerance) return reject(context, "a corner leaves the plane of facet", f);
      /* With a tolerance a facet's corners depend on the angles at which its cells' facets meet. */
      if (a->flat_distance == 0 && turn < -12 * tolerance * fmax(length, tolerance))
        return reject(context, "a corner turns inwards at facet", f);
    }
  }
  return true;
}

struct edge_use {
  uint32_t cell, from, to; /* from < to */
  int direction;
};

static int compare_edge_uses(const struct edge_use *x, const struct edge_use *y) {
  if (x->cell != y->cell) return x->cell < y->cell ? -1 : 1;
  if (x->from != y->from) return x->from < y->from ? -1 : 1;
  if (x->to != y->to) return x->to < y->to ? -1 : 1;
  return 0;
}

/* Heap sort: no stack, no allocation, no worst case. */
static void sort_edge_uses(struct edge_use *uses, size_t count) {
  for (size_t end = count, root = count / 2; end > 1;) {
    if (root > 0) {
      root--;
    } else {
      end--;
      const struct edge_use swap = uses[0];
      uses[0] = uses[end];
      uses[end] = swap;
    }
    const struct edge_use moving = uses[root];
    size_t at = root;
    for (size_t child; (child = 2 * at + 1) < end; at = child) {
      if (child + 1 < end && compare_edge_uses(&uses[child], &uses[child + 1]) < 0) child++;
      if (compare_edge_uses(&moving, &uses[child]) >= 0) break;
      uses[at] = uses[child];
    }
    uses[at] = moving;
  }
}

/* Every edge of an imaginary cell is used once in either direction, and every imaginary cell has facets. */
static bool cells_closed(cellist_context *context, const cellist_complex_arrays *a) {
  const size_t corner_count = a->facet_starts[a->facet_count], imaginary_count = a->cell_count - a->tet_count;
  struct edge_use *uses = cellist_allocate(context, 2 * corner_count, sizeof *uses);
  uint32_t *facets_of = cellist_allocate_zeroed(context, imaginary_count, sizeof *facets_of);
  bool ok = uses != NULL && facets_of != NULL;
  size_t count = 0;
  for (size_t f = 0; ok && f < a->facet_count; f++) {
    const uint32_t begin = a->facet_starts[f], end = a->facet_starts[f + 1];
    for (int side = 0; side < 2; side++) {
      const uint32_t cell = a->facet_cells[2 * f + (size_t)side];
      if (cell == CELLIST_NONE || cell < a->tet_count) continue;
      facets_of[cell - a->tet_count]++;
      for (uint32_t i = begin; i < end; i++) {
        const uint32_t u = a->facet_vertices[i], v = a->facet_vertices[i + 1 < end ? i + 1 : begin];
        uses[count++] = (struct edge_use){cell, u < v ? u : v, u < v ? v : u, (u < v) == (side == 0) ? 1 : -1};
      }
    }
  }
  for (size_t i = 0; ok && i < imaginary_count; i++)
    if (facets_of[i] < 4) ok = reject(context, "too few facets for imaginary cell", a->tet_count + i);
  if (ok) sort_edge_uses(uses, count);
  for (size_t i = 0; ok && i < count; i += 2)
    if (i + 1 >= count || compare_edge_uses(&uses[i], &uses[i + 1]) != 0 ||
        uses[i].direction + uses[i + 1].direction != 0 ||
        (i + 2 < count && compare_edge_uses(&uses[i], &uses[i + 2]) == 0))
      ok = reject(context, "an open edge on the surface of imaginary cell", uses[i].cell);
  cellist_deallocate(context, uses);
  cellist_deallocate(context, facets_of);
  return ok;
}

/* With closed surfaces it is enough that every facet's corners stay behind every neighbouring facet of the same cell;
 * all pairs would be quadratic, so each cell is tested against its own support points: the corner of the cell farthest
 * along a facet's outward normal, found by scanning cells of up to SCAN_LIMIT corners. Larger cells are convex by
 * convexify's own exact test, which this only repeats. */
enum { SCAN_LIMIT = 4096 };

static bool cells_convex(cellist_context *context, const cellist_complex_arrays *a, const struct frame *frame) {
  const double *origin = frame->origin;
  const size_t imaginary_count = a->cell_count - a->tet_count;
  uint32_t *start = cellist_allocate_zeroed(context, imaginary_count + 2, sizeof *start);
  uint32_t *facets = cellist_allocate(context, 2 * a->facet_count, sizeof *facets);
  bool ok = start != NULL && facets != NULL;
  for (int pass = 0; ok && pass < 2; pass++) {
    for (size_t f = 0; f < 2 * a->facet_count; f++) {
      const uint32_t cell = a->facet_cells[f];
      if (cell == CELLIST_NONE || cell < a->tet_count) continue;
      if (pass == 0)
        start[cell - a->tet_count + 2]++;
      else
        facets[start[cell - a->tet_count + 1]++] = (uint32_t)f;
    }
    for (size_t i = 2; pass == 0 && i < imaginary_count + 2; i++) start[i] += start[i - 1];
  }
  for (size_t c = 0; ok && c < imaginary_count; c++) {
    const uint32_t *own = &facets[start[c]];
    const uint32_t count = start[c + 1] - start[c];
    size_t corners = 0;
    for (uint32_t i = 0; i < count; i++) corners += a->facet_starts[own[i] / 2 + 1] - a->facet_starts[own[i] / 2];
    if (corners > SCAN_LIMIT) continue;
    for (uint32_t i = 0; ok && i < count; i++) {
      struct plane plane;
      ok = plane_of(a, a->facet_planes[own[i] / 2], origin, &plane);
      const double tolerance = plane_tolerance(a, a->facet_planes[own[i] / 2], frame);
      const double towards = own[i] % 2 == 0 ? 1 : -1;
      for (uint32_t j = 0; ok && j < count; j++) {
        for (uint32_t v = a->facet_starts[own[j] / 2]; v < a->facet_starts[own[j] / 2 + 1]; v++) {
          const double *p = &a->vertices[3 * (size_t)a->facet_vertices[v]];
          double distance = -plane.offset;
          for (int k = 0; k < 3; k++) distance += plane.normal[k] * (p[k] - origin[k]);
          if (towards * distance < -tolerance - a->flat_distance) {
            ok = reject(context, "not convex: imaginary cell", a->tet_count + c);
            break;
          }
        }
      }
    }
  }
  cellist_deallocate(context, start);
  cellist_deallocate(context, facets);
  return ok;
}

/* Twice the area of a polygon, and how much that may be off as its corners are rounded; lengths in extents. */
static double polygon_area(const cellist_complex_arrays *a, size_t facet, const struct frame *frame, double *error) {
  const double extent = frame->extent, unit = ROUNDING + COORDINATE_ROUNDING * frame->largest / extent;
  const uint32_t *corners = &a->facet_vertices[a->facet_starts[facet]];
  const uint32_t count = a->facet_starts[facet + 1] - a->facet_starts[facet];
  const double *o = &a->vertices[3 * (size_t)corners[0]];
  double sum[3] = {0, 0, 0}, outline = 0;
  for (uint32_t i = 0; i < count; i++) {
    const double *p = &a->vertices[3 * (size_t)corners[i]], *q = &a->vertices[3 * (size_t)corners[(i + 1) % count]];
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
      u[k] = (p[k] - o[k]) / extent;
      v[k] = (q[k] - o[k]) / extent;
      outline += fabs(v[k] - u[k]);
    }
    for (int k = 0; k < 3; k++) sum[k] += u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
  }
  *error = 2 * unit * (outline + count * unit);
  return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

static double face_area(const cellist_mesh_arrays *mesh, size_t tet, size_t face, double extent) {
  const uint8_t *corner = CELLIST_TET_FACE[face];
  const double *o = &mesh->positions[3 * (size_t)mesh->tets[4 * tet + corner[0]]];
  const double *p = &mesh->positions[3 * (size_t)mesh->tets[4 * tet + corner[1]]];
  const double *q = &mesh->positions[3 * (size_t)mesh->tets[4 * tet + corner[2]]];
  double square = 0;
  for (int k = 0; k < 3; k++) {
    const int j = (k + 1) % 3, l = (k + 2) % 3;
    const double n =
        (p[j] - o[j]) / extent * ((q[l] - o[l]) / extent) - (p[l] - o[l]) / extent * ((q[j] - o[j]) / extent);
    square += n * n;
  }
  return sqrt(square);
}

/* The facets of tets cover the mesh's boundary: compares area per tet, flat tets and their neighbours apart. */
static bool boundary_covered(cellist_context *context, const cellist_complex_arrays *a, const cellist_mesh_arrays *mesh,
                             const struct frame *frame) {
  double *missing = cellist_allocate_zeroed(context, a->tet_count, 2 * sizeof *missing);
  if (missing == NULL) return false;
  double *errors = missing + a->tet_count;
  for (size_t f = 0; f < a->facet_count; f++) {
    double error;
    const double area = polygon_area(a, f, frame, &error);
    for (int side = 0; side < 2; side++) {
      const uint32_t cell = a->facet_cells[2 * f + (size_t)side];
      if (cell >= a->tet_count) continue;
      missing[cell] -= area;
      errors[cell] += error;
    }
  }
  bool ok = true;
  for (size_t t = 0; ok && t < a->tet_count; t++) {
    bool judged = (mesh->tet_flags[t] & CELLIST_TET_FLAT) == 0;
    for (size_t face = 0; face < 4; face++) {
      const uint32_t next = mesh->neighbours[4 * t + face];
      if (next == CELLIST_NONE)
        missing[t] += face_area(mesh, t, face, frame->extent);
      else
        judged &= (mesh->tet_flags[next] & CELLIST_TET_FLAT) == 0;
    }
    if (judged && fabs(missing[t]) > errors[t]) ok = reject(context, "facets do not cover tet", t);
  }
  cellist_deallocate(context, missing);
  return ok;
}

/* Exactly, from stored points alone: planes span something, and a tet's facet lies in the plane of one of its faces,
 * with the rest of the tet on the side where the facet has it. */
static bool planes_exact(cellist_context *context, const cellist_complex_arrays *a, const cellist_mesh_arrays *mesh) {
  for (size_t i = 0; i < a->plane_count; i++) {
    const uint32_t *id = &a->planes[3 * i];
    bool spans = id[0] == CELLIST_NONE;
    for (int k = 0; k < 3 && !spans; k++) {
      double flat[3][2];
      for (int c = 0; c < 3; c++)
        for (int j = 0; j < 2; j++) flat[c][j] = a->points[3 * (size_t)id[c] + (size_t)((k + 1 + j) % 3)];
      spans = cellist_orient2d(flat[0], flat[1], flat[2]) != 0;
    }
    if (!spans) return reject(context, "three points on a line for plane", i);
  }
  for (size_t f = 0; f < a->facet_count; f++) {
    const uint32_t *id = &a->planes[3 * (size_t)a->facet_planes[f]];
    for (int side = 0; side < 2; side++) {
      const uint32_t cell = a->facet_cells[2 * f + (size_t)side];
      if (cell >= a->tet_count || (mesh->tet_flags[cell] & CELLIST_TET_FLAT) != 0) continue;
      int on = 0, within = 0;
      for (size_t c = 0; c < 4 && id[0] != CELLIST_NONE; c++) {
        const double *p = &mesh->positions[3 * (size_t)mesh->tets[4 * (size_t)cell + c]];
        const int sign = cellist_orient3d(&a->points[3 * (size_t)id[0]], &a->points[3 * (size_t)id[1]],
                                          &a->points[3 * (size_t)id[2]], p);
        on += sign == 0;
        within += sign == (side == 0 ? 1 : -1);
      }
      if (on != 3 || within != 1) return reject(context, "not in the plane of a face of its tet: facet", f);
    }
  }
  return true;
}

bool cellist_complex_is_valid(cellist_context *context, const cellist_complex *complex, const cellist_mesh *mesh) {
  if (context == NULL || complex == NULL || mesh == NULL) return false;
  const cellist_complex_arrays *a = &complex->arrays;
  const cellist_mesh_arrays *m = cellist_mesh_get_arrays(mesh);
  if (a->tet_count != m->tet_count || a->point_count < m->point_count)
    return reject(context, "made for another mesh, tets", a->tet_count);
  if (m->point_count > 0 && memcmp(a->points, m->positions, 3 * m->point_count * sizeof(double)) != 0)
    return reject(context, "other coordinates than the mesh's, points", a->point_count);
  if (a->facet_count == 0) {
    for (size_t t = 0; t < a->tet_count; t++)
      if ((m->tet_flags[t] & CELLIST_TET_FLAT) == 0) return reject(context, "no facets, yet there is tet", t);
    return a->cell_count == a->tet_count || reject(context, "no facets, cells", a->cell_count);
  }
  struct frame frame = {.origin = a->vertices};
  for (size_t i = 0; i < 3 * a->vertex_count; i++) {
    frame.largest = fmax(frame.largest, fabs(a->vertices[i]));
    frame.extent = fmax(frame.extent, fabs(a->vertices[i] - a->vertices[i % 3]));
  }
  return facets_fit(context, a, &frame) && cells_closed(context, a) && cells_convex(context, a, &frame) &&
         boundary_covered(context, a, m, &frame) && planes_exact(context, a, m);
}
