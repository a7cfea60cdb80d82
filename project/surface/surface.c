/* SPDX-License-Identifier: BSD-3-Clause
 * Surface: from the caller's arrays to triangles along a space-filling curve (Morton 1966), checked, with all that
 * every renderer wants to know. */
#include <cellist/radix.h>
#include <math.h>
#include <string.h>

#include "surface_private.h"

static const float GREY = 0.8f;

/* Bits of a centre's place along each axis; three of them fill a key. */
enum { KEY_BITS = 21 };

static cellist_result check(cellist_context *context, const cellist_surface_arrays *arrays) {
  if (arrays->point_count >= 1u << 31 || arrays->triangle_count >= 1u << 31)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a surface may have 2^31 - 1 points and triangles");
  if ((arrays->positions == NULL && arrays->point_count > 0) ||
      (arrays->triangles == NULL && arrays->triangle_count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the surface's positions or triangles are NULL");
  for (size_t i = 0; i < arrays->point_count; i++) {
    bool finite = true;
    for (size_t k = 3 * i; k < 3 * i + 3; k++)
      finite = finite && isfinite(arrays->positions[k]) && (arrays->normals == NULL || isfinite(arrays->normals[k])) &&
               (arrays->colours == NULL || isfinite(arrays->colours[k]));
    if (!finite)
      return cellist_fail(context, CELLIST_ERROR_GEOMETRY, "the surface's point %zu is not finite (%g %g %g)", i,
                          arrays->positions[3 * i], arrays->positions[3 * i + 1], arrays->positions[3 * i + 2]);
  }
  for (size_t i = 0; i < 3 * arrays->triangle_count; i++)
    if (arrays->triangles[i] >= arrays->point_count)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "the surface's triangle %zu names point %u, but there are only %zu", i / 3,
                          arrays->triangles[i], arrays->point_count);
  return CELLIST_SUCCESS;
}

/* ---- Arrays ----------------------------------------------------------------------------------------- */

static void copy_normals(double *to, const double *from, size_t count) {
  for (size_t i = 0; i < count; i++) {
    const double *n = &from[3 * i];
    const double largest = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    double scaled[3] = {0, 0, 0}, length = 0;
    for (int k = 0; k < 3 && largest > 0; k++) {
      scaled[k] = n[k] / largest;
      length += scaled[k] * scaled[k];
    }
    for (int k = 0; k < 3; k++) to[3 * i + (size_t)k] = largest > 0 ? scaled[k] / sqrt(length) : 0;
  }
}

static cellist_result allocate(cellist_surface *surface, const cellist_surface_arrays *given) {
  cellist_context *context = surface->context;
  double *positions = cellist_allocate(context, given->point_count, 3 * sizeof *positions);
  float *colours = cellist_allocate(context, given->point_count, 3 * sizeof *colours);
  uint32_t *triangles = cellist_allocate(context, given->triangle_count, 3 * sizeof *triangles);
  double *normals = given->normals != NULL ? cellist_allocate(context, given->point_count, 3 * sizeof *normals) : NULL;
  surface->arrays =
      (cellist_surface_arrays){given->point_count, positions, normals, colours, given->triangle_count, triangles};
  if (positions == NULL || colours == NULL || triangles == NULL || (given->normals != NULL && normals == NULL))
    return CELLIST_ERROR_OUT_OF_MEMORY;
  if (given->point_count > 0) memcpy(positions, given->positions, 3 * given->point_count * sizeof *positions);
  for (size_t i = 0; i < 3 * given->point_count; i++) colours[i] = given->colours != NULL ? given->colours[i] : GREY;
  if (normals != NULL) copy_normals(normals, given->normals, given->point_count);
  return CELLIST_SUCCESS;
}

static void find_bounds(const cellist_surface_arrays *given, double bounds[6]) {
  for (int k = 0; k < 6; k++) bounds[k] = given->triangle_count == 0 ? 0 : k < 3 ? HUGE_VAL : -HUGE_VAL;
  for (size_t i = 0; i < 3 * given->triangle_count; i++) {
    const double *p = &given->positions[3 * (size_t)given->triangles[i]];
    for (int k = 0; k < 3; k++) {
      bounds[k] = fmin(bounds[k], p[k]);
      bounds[3 + k] = fmax(bounds[3 + k], p[k]);
    }
  }
}

static uint64_t spread(uint64_t bits) { /* two zeroes between any two of 21 bits */
  bits = (bits | bits << 32) & 0x001f00000000ffff;
  bits = (bits | bits << 16) & 0x001f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

static uint64_t key_of(const cellist_surface *surface, const double *positions, const uint32_t triangle[3]) {
  const double *b = surface->bounds;
  uint64_t key = 0;
  for (int k = 0; k < 3; k++) {
    double centre = 0; /* halves and thirds first: no sum of huge coordinates overflows */
    for (int c = 0; c < 3; c++) centre += positions[3 * (size_t)triangle[c] + (size_t)k] / 6 - b[k] / 6;
    const double extent = b[3 + k] / 2 - b[k] / 2, place = extent > 0 ? centre / extent : 0;
    const double scaled = fmin(fmax(place, 0), 1) * ((1 << KEY_BITS) - 1);
    key |= spread((uint64_t)scaled) << k;
  }
  return key;
}

/* Puts the triangles in the order of their centres' keys; equal ones stay as they were. */
static cellist_result sort_triangles(cellist_surface *surface, const cellist_surface_arrays *given,
                                     uint32_t *triangles) {
  cellist_context *context = surface->context;
  const size_t count = given->triangle_count;
  uint64_t *keys = cellist_allocate(context, 2 * count, sizeof *keys);
  uint32_t *values = cellist_allocate(context, 2 * count, sizeof *values);
  const bool ok = keys != NULL && values != NULL;
  if (ok) {
    for (size_t i = 0; i < count; i++) {
      keys[i] = key_of(surface, given->positions, &given->triangles[3 * i]);
      values[i] = (uint32_t)i;
    }
    cellist_radix_sort(keys, values, count, keys + count, values + count, 3 * KEY_BITS);
    for (size_t i = 0; i < count; i++)
      memcpy(&triangles[3 * i], &given->triangles[3 * (size_t)values[i]], 3 * sizeof *triangles);
  }
  cellist_deallocate(context, keys);
  cellist_deallocate(context, values);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

/* Tells surfaces apart that a renderer has seen before: FNV-1a over 32-bit words, widened. */
static uint64_t add_to_checksum(uint64_t checksum, const void *block, size_t size) {
  const unsigned char *bytes = block;
  for (size_t i = 0; block != NULL && i + 4 <= size; i += 4) {
    uint32_t word;
    memcpy(&word, bytes + i, sizeof word);
    checksum = (checksum ^ word) * 0x100000001b3u;
    checksum ^= checksum >> 32;
  }
  return checksum;
}

static uint64_t checksum_of(const cellist_surface_arrays *a) {
  uint64_t sum = 0xcbf29ce484222325u ^ a->point_count;
  sum = add_to_checksum(sum, a->positions, 3 * a->point_count * sizeof *a->positions);
  sum = add_to_checksum(sum, a->normals, 3 * a->point_count * sizeof *a->normals);
  sum = add_to_checksum(sum, a->colours, 3 * a->point_count * sizeof *a->colours);
  return add_to_checksum(sum, a->triangles, 3 * a->triangle_count * sizeof *a->triangles);
}

/* ---- Calls ------------------------------------------------------------------------------------------ */

cellist_result cellist_surface_create(cellist_context *context, const cellist_surface_arrays *arrays,
                                      cellist_surface **surface) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (arrays == NULL || surface == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_surface_create: arrays or surface is NULL");
  cellist_result result = check(context, arrays);
  if (result != CELLIST_SUCCESS) return result;
  cellist_surface *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  uint32_t *kept = NULL;
  cellist_surface_arrays distinct = *arrays;
  result = surface_keep_first(context, arrays, &kept, &distinct.triangle_count);
  distinct.triangles = kept;
  if (result == CELLIST_SUCCESS) result = allocate(created, &distinct);
  if (result == CELLIST_SUCCESS) {
    find_bounds(&distinct, created->bounds);
    /* What allocate made, and only this file knows not to be const. */
    result = sort_triangles(created, &distinct, (uint32_t *)(uintptr_t)created->arrays.triangles);
  }
  cellist_deallocate(context, kept);
  if (result == CELLIST_SUCCESS) result = surface_tree_build(context, &created->arrays, &created->tree);
  if (result != CELLIST_SUCCESS) {
    cellist_surface_destroy(created);
    return result;
  }
  created->checksum = checksum_of(&created->arrays);
  *surface = created;
  return CELLIST_SUCCESS;
}

static void deallocate(cellist_context *context, const void *block) {
  cellist_deallocate(context, (void *)(uintptr_t)block);
}

void cellist_surface_destroy(cellist_surface *surface) {
  if (surface == NULL) return;
  cellist_context *context = surface->context;
  deallocate(context, surface->arrays.positions);
  deallocate(context, surface->arrays.normals);
  deallocate(context, surface->arrays.colours);
  deallocate(context, surface->arrays.triangles);
  surface_tree_release(context, &surface->tree);
  cellist_deallocate(context, surface);
}

const cellist_surface_arrays *cellist_surface_get_arrays(const cellist_surface *surface) { return &surface->arrays; }

void cellist_surface_bounds(const cellist_surface *surface, double bounds[6]) {
  memcpy(bounds, surface->bounds, sizeof surface->bounds);
}

cellist_result cellist_surface_join(cellist_context *context, const cellist_surface *const *parts, size_t part_count,
                                    cellist_surface **surface) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if ((parts == NULL && part_count > 0) || surface == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_surface_join: parts or surface is NULL");
  size_t point_count = 0, triangle_count = 0;
  bool smooth = false;
  for (size_t i = 0; i < part_count; i++) {
    if (parts[i] == NULL)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_surface_join: part %zu is NULL", i);
    point_count += parts[i]->arrays.point_count;
    triangle_count += parts[i]->arrays.triangle_count;
    smooth = smooth || parts[i]->arrays.normals != NULL;
  }
  double *positions = cellist_allocate(context, point_count, 3 * sizeof *positions);
  double *normals = smooth ? cellist_allocate_zeroed(context, point_count, 3 * sizeof *normals) : NULL;
  float *colours = cellist_allocate(context, point_count, 3 * sizeof *colours);
  uint32_t *triangles = cellist_allocate(context, triangle_count, 3 * sizeof *triangles);
  cellist_result result = CELLIST_ERROR_OUT_OF_MEMORY;
  if (positions != NULL && colours != NULL && triangles != NULL && (normals != NULL || !smooth)) {
    size_t point = 0, corner = 0;
    for (size_t i = 0; i < part_count; i++) {
      const cellist_surface_arrays *a = &parts[i]->arrays;
      memcpy(&positions[3 * point], a->positions, 3 * a->point_count * sizeof *positions);
      memcpy(&colours[3 * point], a->colours, 3 * a->point_count * sizeof *colours);
      if (a->normals != NULL) memcpy(&normals[3 * point], a->normals, 3 * a->point_count * sizeof *normals);
      for (size_t k = 0; k < 3 * a->triangle_count; k++) triangles[corner++] = (uint32_t)(point + a->triangles[k]);
      point += a->point_count;
    }
    const cellist_surface_arrays all = {point_count, positions, normals, colours, triangle_count, triangles};
    result = cellist_surface_create(context, &all, surface);
  }
  cellist_deallocate(context, positions);
  cellist_deallocate(context, normals);
  cellist_deallocate(context, colours);
  cellist_deallocate(context, triangles);
  return result;
}
