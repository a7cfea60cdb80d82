/* SPDX-License-Identifier: BSD-3-Clause
 * Ball: the Delaunay triangulation of random points in a ball, which is unique but for its order; so tets are brought
 * into an order of their own and the mesh does not depend on how CGAL works.
 *
 * Its hull is its boundary. Delaunay triangulations of random points hold slivers: large balls have some needles. */
#include "delaunay_cgal.h"

#include <cellist/radix.h>
#include <math.h>
#include <string.h>

/* Even permutation that puts the lowest id first and the second lowest second, where the parity allows. */
static void canonicalise(uint32_t v[4]) {
  for (int i = 0; i < 3; i++) {
    int low = i;
    for (int j = i + 1; j < 4; j++)
      if (v[j] < v[low]) low = j;
    if (low == i || i == 2) continue;
    /* A cycle of three is even: v[i], v[low] and one of those after them. */
    const int third = low == 3 ? 2 : 3;
    const uint32_t old = v[i];
    v[i] = v[low];
    v[low] = v[third];
    v[third] = old;
  }
}

static bool is_before(const uint32_t a[4], const uint32_t b[4]) { return a[2] != b[2] ? a[2] < b[2] : a[3] < b[3]; }

/* Sorts tets by their ids: by the first two with a radix sort, the few that share these by insertion. */
static cellist_result sort_tets(cellist_context *context, uint32_t *tets, size_t count) {
  uint64_t *keys = cellist_allocate(context, count, 2 * sizeof *keys);
  uint32_t *order = cellist_allocate(context, count, 2 * sizeof *order);
  uint32_t *copy = cellist_allocate(context, count, 4 * sizeof *copy);
  const bool ok = keys != NULL && order != NULL && copy != NULL;
  if (ok) {
    memcpy(copy, tets, count * 4 * sizeof *tets);
    for (size_t i = 0; i < count; i++) {
      canonicalise(&copy[4 * i]);
      keys[i] = (uint64_t)copy[4 * i] << 32 | copy[4 * i + 1];
      order[i] = (uint32_t)i;
    }
    cellist_radix_sort(keys, order, count, keys + count, order + count, 64);
    for (size_t i = 0; i < count; i++) {
      const uint32_t *v = &copy[4 * (size_t)order[i]];
      size_t to = i;
      for (; to > 0 && keys[to - 1] == keys[i] && is_before(v, &tets[4 * (to - 1)]); to--)
        memcpy(&tets[4 * to], &tets[4 * (to - 1)], 4 * sizeof *tets);
      memcpy(&tets[4 * to], v, 4 * sizeof *tets);
    }
  }
  cellist_deallocate(context, keys);
  cellist_deallocate(context, order);
  cellist_deallocate(context, copy);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

/* How many points make that many tets: 6.77 each inside, fewer at the hull (fitted to 100 to 8 million tets). */
static size_t points_for(double tets) {
  const double root = sqrt(tets);
  return (size_t)(tets / 6.77 + 1.05 * root + 4);
}

void generate_ball(mesh_builder *builder) {
  const size_t point_count = points_for((double)builder->desc.size);
  while (builder->point_count < point_count && builder->result == CELLIST_SUCCESS) {
    const double x = random_between(&builder->random, -1, 1);
    const double y = random_between(&builder->random, -1, 1);
    const double z = random_between(&builder->random, -1, 1);
    if (x * x + y * y + z * z <= 1) builder_point(builder, x, y, z);
  }
  if (builder->result != CELLIST_SUCCESS) return;
  builder->result =
      delaunay_cgal(builder->context, point_count, builder->positions, &builder->tets, &builder->tet_count);
  builder->tet_capacity = builder->tet_count;
  if (builder->result == CELLIST_SUCCESS)
    builder->result = sort_tets(builder->context, builder->tets, builder->tet_count);
}
