/* SPDX-License-Identifier: BSD-3-Clause
 * Reorder: tets by the Hilbert index of their centroids, points by that of their positions.
 *
 * 20 bits a coordinate on a cube around the bounds; ties (and the order in general) are only a matter of speed, but
 * they are broken by the user's order, so the result is the same everywhere. Index by Skilling's transform
 * ("Programming the Hilbert curve", 2004). */
#include "mesh_private.h"

#include <cellist/radix.h>
#include <math.h>
#include <string.h>

/* 3 * 20 bits: eight radix passes. Fewer bits make ties in meshes of strongly graded size. */
enum { HILBERT_BITS = 20 };

static uint64_t hilbert_index(uint32_t x[3]) {
  const uint32_t top = 1u << (HILBERT_BITS - 1);
  for (uint32_t bit = top; bit > 1; bit >>= 1) {
    const uint32_t below = bit - 1;
    for (int k = 0; k < 3; k++) {
      if (x[k] & bit) {
        x[0] ^= below;
      } else {
        const uint32_t exchange = (x[0] ^ x[k]) & below;
        x[0] ^= exchange;
        x[k] ^= exchange;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  uint32_t gray = 0;
  for (uint32_t bit = top; bit > 1; bit >>= 1)
    if (x[2] & bit) gray ^= bit - 1;
  uint64_t index = 0;
  for (int b = HILBERT_BITS - 1; b >= 0; b--)
    for (int k = 0; k < 3; k++) index = index << 1 | (((x[k] ^ gray) >> b) & 1);
  return index;
}

struct key_job {
  const mesh_parts *parts;
  const double *bounds;
  double scale;
  bool of_points;
  uint64_t *keys;
  uint32_t *ids;
};

static void make_keys(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct key_job *job = user;
  const double *positions = job->parts->positions;
  for (size_t i = begin; i < end; i++) {
    uint32_t cell[3];
    for (int k = 0; k < 3; k++) {
      double at = 0; /* in halves of the extent, so that a sum over huge coordinates cannot overflow */
      if (job->of_points) {
        at = (0.5 * positions[3 * i + (size_t)k] - 0.5 * job->bounds[k]) * job->scale;
      } else {
        const uint32_t *v = &job->parts->tets[4 * i];
        for (int c = 0; c < 4; c++) {
          const double x = positions[3 * (size_t)v[c] + (size_t)k];
          at += 0.25 * ((0.5 * x - 0.5 * job->bounds[k]) * job->scale);
        }
      }
      /* Written so that NaN (an unused point) becomes 0. */
      const double last = (1u << HILBERT_BITS) - 1;
      cell[k] = at > 0 ? (uint32_t)(at < last ? at : last) : 0;
    }
    job->keys[i] = hilbert_index(cell);
    job->ids[i] = (uint32_t)i;
  }
}

/* order[new] = old, of points or of tets. */
static cellist_result hilbert_order(cellist_context *context, const mesh_parts *parts, const double bounds[6],
                                    bool of_points, uint32_t *order) {
  const size_t count = of_points ? parts->point_count : parts->tet_count;
  double extent = 0; /* half of it */
  for (int k = 0; k < 3; k++) extent = fmax(extent, 0.5 * bounds[3 + k] - 0.5 * bounds[k]);
  struct key_job job = {parts,     bounds, extent > 0 ? fmin((1u << HILBERT_BITS) / extent, 1e300) : 0,
                        of_points, NULL,   order};
  uint64_t *scratch_keys = cellist_allocate(context, count, sizeof *scratch_keys);
  uint32_t *scratch_ids = cellist_allocate(context, count, sizeof *scratch_ids);
  job.keys = cellist_allocate(context, count, sizeof *job.keys);
  const bool ok = scratch_keys != NULL && scratch_ids != NULL && job.keys != NULL;
  if (ok) {
    cellist_parallel_for(context, count, 4096, make_keys, &job);
    cellist_radix_sort(job.keys, order, count, scratch_keys, scratch_ids, 3 * HILBERT_BITS);
  }
  cellist_deallocate(context, scratch_keys);
  cellist_deallocate(context, scratch_ids);
  cellist_deallocate(context, job.keys);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

/* Replaces *array by itself in the new order. */
static cellist_result permute(cellist_context *context, void **array, const uint32_t *order, size_t count,
                              size_t size) {
  char *moved = cellist_allocate(context, count, size);
  if (moved == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  const char *from = *array;
  for (size_t i = 0; i < count; i++) memcpy(moved + i * size, from + order[i] * size, size);
  cellist_deallocate(context, *array);
  *array = moved;
  return CELLIST_SUCCESS;
}

static cellist_result permute_fields(cellist_context *context, mesh_parts *parts, cellist_association association,
                                     const uint32_t *order, size_t count) {
  for (size_t i = 0; i < parts->field_count; i++) {
    cellist_field *field = &parts->fields[i];
    if (field->association != association) continue;
    void *values = (void *)field->values;
    const cellist_result result =
        permute(context, &values, order, count, field->component_count * sizeof *field->values);
    field->values = values;
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

static cellist_result reorder_tets(cellist_context *context, mesh_parts *parts, uint8_t *tet_flags, uint32_t *order) {
  void *tets = parts->tets;
  cellist_result result = permute(context, &tets, order, parts->tet_count, 4 * sizeof *parts->tets);
  parts->tets = tets;
  if (result == CELLIST_SUCCESS) result = permute_fields(context, parts, CELLIST_ON_CELLS, order, parts->tet_count);
  if (result != CELLIST_SUCCESS) return result;
  uint8_t *flags = cellist_allocate(context, parts->tet_count, 1);
  if (flags == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < parts->tet_count; i++) flags[i] = tet_flags[order[i]];
  memcpy(tet_flags, flags, parts->tet_count);
  cellist_deallocate(context, flags);
  if (parts->tet_origin != NULL)
    for (size_t i = 0; i < parts->tet_count; i++) order[i] = parts->tet_origin[order[i]];
  return CELLIST_SUCCESS;
}

static cellist_result reorder_points(cellist_context *context, mesh_parts *parts, const uint32_t *order) {
  void *positions = parts->positions;
  cellist_result result = permute(context, &positions, order, parts->point_count, 3 * sizeof *parts->positions);
  parts->positions = positions;
  if (result == CELLIST_SUCCESS) result = permute_fields(context, parts, CELLIST_ON_POINTS, order, parts->point_count);
  if (result != CELLIST_SUCCESS) return result;
  uint32_t *renamed = cellist_allocate(context, parts->point_count, sizeof *renamed);
  if (renamed == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < parts->point_count; i++) renamed[order[i]] = (uint32_t)i;
  for (size_t i = 0; i < 4 * parts->tet_count; i++) parts->tets[i] = renamed[parts->tets[i]];
  cellist_deallocate(context, renamed);
  return CELLIST_SUCCESS;
}

cellist_result mesh_reorder(cellist_context *context, mesh_parts *parts, uint8_t *tet_flags, const double bounds[6],
                            uint32_t **point_origin) {
  uint32_t *tet_order = cellist_allocate(context, parts->tet_count, sizeof *tet_order);
  if (tet_order == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = hilbert_order(context, parts, bounds, false, tet_order);
  if (result == CELLIST_SUCCESS) result = reorder_tets(context, parts, tet_flags, tet_order);
  if (result != CELLIST_SUCCESS) {
    cellist_deallocate(context, tet_order);
    return result;
  }
  cellist_deallocate(context, parts->tet_origin);
  parts->tet_origin = tet_order;

  *point_origin = cellist_allocate(context, parts->point_count, sizeof **point_origin);
  if (*point_origin == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  result = hilbert_order(context, parts, bounds, true, *point_origin);
  if (result == CELLIST_SUCCESS) result = reorder_points(context, parts, *point_origin);
  if (result == CELLIST_SUCCESS && parts->point_origin != NULL)
    for (size_t i = 0; i < parts->point_count; i++) (*point_origin)[i] = parts->point_origin[(*point_origin)[i]];
  cellist_deallocate(context, parts->point_origin);
  parts->point_origin = NULL;
  return result;
}
