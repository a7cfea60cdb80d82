/* SPDX-License-Identifier: BSD-3-Clause
 * Merge: joins points that coincide.
 *
 * Equal coordinates: three stable radix sorts bring equal points together. Within a distance d: in the order of their
 * ids, a point joins the first point kept so far that is within d, or is kept. Kept points lie more than d apart, so
 * few of them share one cube of side d, and the 27 cubes around a point hold a bounded number of them, whatever the
 * input; cubes are found by binary search in their sorted list. Time is n log n, with no hash to attack. */
#include "grid.h"

#include <cellist/radix.h>
#include <math.h>
#include <string.h>

/* Beyond it neighbouring cubes of doubles would get the same number. */
static const double CUBE_LIMIT = 0x1p50;

static bool is_finite_point(const double *p) { return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]); }

/* A key that sorts as the number does; both zeros are one. */
static uint64_t key_of_double(double value) {
  const double plain = value + 0.0;
  uint64_t bits;
  memcpy(&bits, &plain, sizeof bits);
  return bits >> 63 ? ~bits : bits | (uint64_t)1 << 63;
}

struct sort_space {
  uint64_t *keys, *scratch_keys;
  uint32_t *order, *scratch;
};

static void release_space(cellist_context *context, struct sort_space *space) {
  cellist_deallocate(context, space->keys);
  cellist_deallocate(context, space->scratch_keys);
  cellist_deallocate(context, space->order);
  cellist_deallocate(context, space->scratch);
}

/* order: points by (x, y, z) of their keys (per_point of distance 0: coordinates; else cubes), then by id. */
static cellist_result sort_points(cellist_context *context, const struct grid *grid, double distance,
                                  struct sort_space *space) {
  const size_t count = grid->point_count;
  space->keys = cellist_allocate(context, count, sizeof *space->keys);
  space->scratch_keys = cellist_allocate(context, count, sizeof *space->scratch_keys);
  space->order = cellist_allocate(context, count, sizeof *space->order);
  space->scratch = cellist_allocate(context, count, sizeof *space->scratch);
  if (space->keys == NULL || space->scratch_keys == NULL || space->order == NULL || space->scratch == NULL)
    return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < count; i++) space->order[i] = (uint32_t)i;
  for (size_t axis = 3; axis-- > 0;) {
    for (size_t i = 0; i < count; i++) {
      const double x = grid->points[3 * (size_t)space->order[i] + axis];
      space->keys[i] = key_of_double(distance > 0 ? floor(x / distance) : x);
    }
    cellist_radix_sort(space->keys, space->order, count, space->scratch_keys, space->scratch, 64);
  }
  return CELLIST_SUCCESS;
}

static bool are_equal(const double *a, const double *b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

/* kept[i] = the lowest id with i's coordinates. */
static cellist_result find_equal(cellist_context *context, const struct grid *grid, uint32_t *kept) {
  struct sort_space space = {0};
  const cellist_result result = sort_points(context, grid, 0, &space);
  if (result == CELLIST_SUCCESS)
    for (size_t i = 0; i < grid->point_count; i++) {
      const uint32_t id = space.order[i], before = i > 0 ? space.order[i - 1] : id;
      kept[id] =
          i > 0 && are_equal(&grid->points[3 * (size_t)id], &grid->points[3 * (size_t)before]) ? kept[before] : id;
    }
  release_space(context, &space);
  return result;
}

/* The sorted cubes that hold points, and in each a list of the points kept so far. */
struct cubes {
  size_t count;
  double *at;        /* [3 count] */
  uint32_t *head;    /* [count] a kept point or CELLIST_NONE */
  uint32_t *next;    /* [point_count] */
  uint32_t *cube_of; /* [point_count] */
};

static void release_cubes(cellist_context *context, struct cubes *cubes) {
  cellist_deallocate(context, cubes->at);
  cellist_deallocate(context, cubes->head);
  cellist_deallocate(context, cubes->next);
  cellist_deallocate(context, cubes->cube_of);
}

static cellist_result make_cubes(cellist_context *context, const struct grid *grid, double distance,
                                 struct cubes *cubes) {
  const size_t count = grid->point_count;
  cubes->at = cellist_allocate(context, count, 3 * sizeof *cubes->at);
  cubes->head = cellist_allocate(context, count, sizeof *cubes->head);
  cubes->next = cellist_allocate(context, count, sizeof *cubes->next);
  cubes->cube_of = cellist_allocate(context, count, sizeof *cubes->cube_of);
  if (cubes->at == NULL || cubes->head == NULL || cubes->next == NULL || cubes->cube_of == NULL)
    return CELLIST_ERROR_OUT_OF_MEMORY;
  struct sort_space space = {0};
  const cellist_result result = sort_points(context, grid, distance, &space);
  for (size_t i = 0; i < count && result == CELLIST_SUCCESS; i++) {
    const double *p = &grid->points[3 * (size_t)space.order[i]];
    const double cube[3] = {floor(p[0] / distance), floor(p[1] / distance), floor(p[2] / distance)};
    if (cubes->count == 0 || !are_equal(cube, &cubes->at[3 * (cubes->count - 1)])) {
      memcpy(&cubes->at[3 * cubes->count], cube, sizeof cube);
      cubes->head[cubes->count++] = CELLIST_NONE;
    }
    cubes->cube_of[space.order[i]] = (uint32_t)(cubes->count - 1);
  }
  release_space(context, &space);
  return result;
}

/* The first cube not before at. */
static size_t lower_bound(const struct cubes *cubes, const double at[3]) {
  size_t low = 0, high = cubes->count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    const double *c = &cubes->at[3 * middle];
    const bool before = c[0] != at[0] ? c[0] < at[0] : c[1] != at[1] ? c[1] < at[1] : c[2] < at[2];
    if (before)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The lowest kept point within distance of point, or CELLIST_NONE. */
static uint32_t nearest_kept(const struct grid *grid, const struct cubes *cubes, double distance, size_t point) {
  const double *p = &grid->points[3 * point], *own = &cubes->at[3 * (size_t)cubes->cube_of[point]];
  uint32_t found = CELLIST_NONE;
  for (int row = 0; row < 9; row++) {
    const double from[3] = {own[0] + row / 3 - 1, own[1] + row % 3 - 1, own[2] - 1};
    for (size_t c = lower_bound(cubes, from); c < cubes->count; c++) {
      const double *cube = &cubes->at[3 * c];
      if (cube[0] != from[0] || cube[1] != from[1] || cube[2] > own[2] + 1) break;
      for (uint32_t kept = cubes->head[c]; kept != CELLIST_NONE; kept = cubes->next[kept]) {
        const double *q = &grid->points[3 * (size_t)kept];
        if (kept < found && hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]) <= distance) found = kept;
      }
    }
  }
  return found;
}

static cellist_result find_near(cellist_context *context, const struct grid *grid, double distance, uint32_t *kept) {
  for (size_t i = 0; i < 3 * grid->point_count; i++)
    if (isfinite(grid->points[i]) && fabs(grid->points[i]) / distance > CUBE_LIMIT)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "%s: the merge distance %g is too small for a coordinate of %g", grid->file, distance,
                          grid->points[i]);
  struct cubes cubes = {0};
  const cellist_result result = make_cubes(context, grid, distance, &cubes);
  for (size_t i = 0; i < grid->point_count && result == CELLIST_SUCCESS; i++) {
    kept[i] = (uint32_t)i;
    if (!is_finite_point(&grid->points[3 * i])) continue;
    const uint32_t found = nearest_kept(grid, &cubes, distance, i);
    if (found != CELLIST_NONE) {
      kept[i] = found;
    } else {
      cubes.next[i] = cubes.head[cubes.cube_of[i]];
      cubes.head[cubes.cube_of[i]] = (uint32_t)i;
    }
  }
  release_cubes(context, &cubes);
  return result;
}

cellist_result grid_count_coincident_points(cellist_context *context, const struct grid *grid, size_t *count) {
  uint32_t *kept = cellist_allocate(context, grid->point_count, sizeof *kept);
  if (kept == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  const cellist_result result = find_equal(context, grid, kept);
  *count = 0;
  for (size_t i = 0; i < grid->point_count && result == CELLIST_SUCCESS; i++) *count += kept[i] != i;
  cellist_deallocate(context, kept);
  return result;
}

/* Moves what is kept to the front, in the order of ids. */
static void compact(struct grid *grid, const uint32_t *kept, uint32_t *renamed, uint32_t *point_origin) {
  size_t count = 0;
  for (size_t i = 0; i < grid->point_count; i++) {
    renamed[i] = kept[i] == i ? (uint32_t)count : renamed[kept[i]];
    if (kept[i] != i) {
      /* A cell that uses the hidden one of two joined points stays hidden. */
      if (grid->hidden_points != NULL) grid->hidden_points[renamed[i]] |= grid->hidden_points[i];
      continue;
    }
    memmove(&grid->points[3 * count], &grid->points[3 * i], 3 * sizeof *grid->points);
    if (grid->hidden_points != NULL) grid->hidden_points[count] = grid->hidden_points[i];
    point_origin[count++] = (uint32_t)i;
  }
  for (size_t f = 0; f < grid->field_count; f++) {
    if (grid->fields[f].association != CELLIST_ON_POINTS) continue;
    const size_t width = grid->fields[f].component_count;
    double *values = (double *)grid->fields[f].values;
    for (size_t i = 0; i < count; i++)
      memmove(&values[width * i], &values[width * point_origin[i]], width * sizeof *values);
  }
  grid->point_count = count;
}

/* Polyhedra keep point ids in faces, between the faces' sizes. */
static void rename_faces(struct grid *grid, size_t old_point_count, const uint32_t *renamed) {
  for (size_t cell = 0; cell < grid->cell_count; cell++) {
    size_t at = grid->face_starts[cell];
    if (at >= grid->face_count) continue;
    for (size_t left = grid->faces[at++]; left > 0 && at < grid->face_count; left--)
      for (size_t corners = grid->faces[at++]; corners > 0 && at < grid->face_count; corners--, at++)
        if (grid->faces[at] < old_point_count) grid->faces[at] = renamed[grid->faces[at]];
  }
}

cellist_result grid_merge_points(cellist_context *context, struct grid *grid, double distance, uint32_t **point_origin,
                                 size_t *merged_count) {
  if (!(distance >= 0 && isfinite(distance)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the merge distance is %g", distance);
  const size_t old_count = grid->point_count;
  uint32_t *kept = cellist_allocate(context, old_count, sizeof *kept);
  uint32_t *renamed = cellist_allocate(context, old_count, sizeof *renamed);
  uint32_t *origin = cellist_allocate(context, old_count, sizeof *origin);
  cellist_result result =
      kept != NULL && renamed != NULL && origin != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS)
    result = distance > 0 ? find_near(context, grid, distance, kept) : find_equal(context, grid, kept);
  if (result == CELLIST_SUCCESS) {
    compact(grid, kept, renamed, origin);
    const size_t count = grid->cell_count > 0 ? grid->offsets[grid->cell_count] : 0;
    for (size_t i = 0; i < count; i++)
      if (grid->connectivity[i] < old_count)
        grid->connectivity[i] = renamed[grid->connectivity[i]];
      else
        grid->connectivity[i] = CELLIST_NONE; /* must not become a valid id */
    if (grid->face_starts != NULL) rename_faces(grid, old_count, renamed);
    *merged_count = old_count - grid->point_count;
    *point_origin = origin;
    origin = NULL;
  }
  cellist_deallocate(context, kept);
  cellist_deallocate(context, renamed);
  cellist_deallocate(context, origin);
  return result;
}
