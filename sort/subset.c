/* SPDX-License-Identifier: BSD-3-Clause
 * Subset: to order some of the cells it suffices to sort the cells that meet a convex region K which holds them.
 *
 * On a ray, let a and b be wanted cells with none between them. Between a point of the ray in a and one in b the ray
 * stays in K, as K is convex; so every cell that it crosses there meets K and is sorted, and the facets and gaps that
 * it crosses put a and b in order, one after the other. More cells than those that meet K do no harm: each of their
 * arcs is one of the whole mesh's. K is the smallest box around the wanted cells, and a cell may meet it if their boxes
 * meet: comparisons of coordinates as given, so nothing is rounded. */
#include "subset.h"

#include <math.h>
#include <string.h>

#include "view.h"

struct box {
  double low[3], high[3];
};

static struct box box_of(const cellist_sorter_desc *mesh, size_t tet) {
  struct box box = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  for (size_t c = 0; c < 4; c++)
    for (size_t k = 0; k < 3; k++) {
      const double x = mesh->points[3 * (size_t)mesh->tets[4 * tet + c] + k];
      if (x < box.low[k]) box.low[k] = x;
      if (x > box.high[k]) box.high[k] = x;
    }
  return box;
}

static bool meet(const struct box *a, const struct box *b) {
  for (int k = 0; k < 3; k++)
    if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) return false;
  return true;
}

/* A complex may have its facets beneath flat tets on the boundary: these stay, so that what is cut there is known. */
static bool is_flat(const cellist_sorter_desc *mesh, size_t tet) {
  const double *p[4];
  for (size_t c = 0; c < 4; c++) p[c] = &mesh->points[3 * (size_t)mesh->tets[4 * tet + c]];
  return cellist_orient3d(p[0], p[1], p[2], p[3]) == 0;
}

/* Numbers the tets that are sorted. */
static size_t number_tets(const cellist_sorter_desc *mesh, const uint8_t *wanted, uint32_t *numbers) {
  struct box region = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  for (size_t i = 0; i < mesh->tet_count; i++) {
    if (!wanted[i]) continue;
    const struct box box = box_of(mesh, i);
    for (int k = 0; k < 3; k++) {
      region.low[k] = fmin(region.low[k], box.low[k]);
      region.high[k] = fmax(region.high[k], box.high[k]);
    }
  }
  size_t count = 0;
  for (size_t i = 0; i < mesh->tet_count; i++) {
    const struct box box = box_of(mesh, i);
    const bool stays = meet(&box, &region) || (mesh->complex != NULL && is_flat(mesh, i));
    numbers[i] = stays ? (uint32_t)count++ : CELLIST_NONE;
  }
  return count;
}

static cellist_result take_complex(cellist_context *context, const cellist_sorter_desc *mesh, const uint32_t *numbers,
                                   sort_subset *subset) {
  const cellist_sorter_complex *from = mesh->complex;
  if (from->facet_count > 0 && (from->facet_planes == NULL || from->facet_cells == NULL))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "an array of the complex is NULL");
  if (from->cell_count < mesh->tet_count)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a complex of %zu cells for a mesh of %zu tets",
                        from->cell_count, mesh->tet_count);
  subset->complex = *from;
  subset->complex.cell_count = subset->tet_count + (from->cell_count - mesh->tet_count);
  subset->facet_planes = cellist_allocate(context, from->facet_count, sizeof *subset->facet_planes);
  subset->facet_cells = cellist_allocate(context, from->facet_count, 2 * sizeof *subset->facet_cells);
  if (subset->facet_planes == NULL || subset->facet_cells == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  size_t count = 0;
  for (size_t f = 0; f < from->facet_count; f++) {
    bool stays = true;
    for (size_t side = 0; side < 2; side++) {
      const uint32_t cell = from->facet_cells[2 * f + side];
      uint32_t number = cell;
      if (cell < mesh->tet_count)
        stays &= (number = numbers[cell]) != CELLIST_NONE;
      else if (cell != CELLIST_NONE)
        number = (uint32_t)(cell - mesh->tet_count + subset->tet_count);
      subset->facet_cells[2 * count + side] = number;
    }
    subset->facet_planes[count] = from->facet_planes[f];
    count += stays;
  }
  subset->complex.facet_count = count;
  subset->complex.facet_planes = subset->facet_planes;
  subset->complex.facet_cells = subset->facet_cells;
  return CELLIST_SUCCESS;
}

static void take_tets(const cellist_sorter_desc *mesh, const uint8_t *wanted, const uint32_t *numbers,
                      sort_subset *subset) {
  for (uint32_t i = 0; i < mesh->tet_count; i++) {
    const size_t number = numbers[i];
    if (number == CELLIST_NONE) continue;
    subset->ids[number] = i;
    subset->wanted[number] = wanted[i] != 0;
    subset->wanted_count += wanted[i] != 0;
    subset->cut[number] = 0;
    memcpy(&subset->tets[4 * number], &mesh->tets[4 * (size_t)i], 4 * sizeof *subset->tets);
    for (size_t k = 0; k < 4; k++) {
      const uint32_t other = mesh->neighbours[4 * (size_t)i + k];
      subset->neighbours[4 * number + k] = other == CELLIST_NONE ? CELLIST_NONE : numbers[other];
      if (other != CELLIST_NONE && numbers[other] == CELLIST_NONE)
        subset->cut[number] = (uint8_t)(subset->cut[number] | 1u << k);
    }
  }
}

cellist_result sort_subset_create(cellist_context *context, const uint8_t *wanted, cellist_sorter_desc *mesh,
                                  sort_subset *subset) {
  uint32_t *numbers = cellist_allocate(context, mesh->tet_count, sizeof *numbers);
  if (numbers == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  const size_t count = subset->tet_count = number_tets(mesh, wanted, numbers);
  subset->ids = cellist_allocate(context, count, sizeof *subset->ids);
  subset->wanted = cellist_allocate(context, count, 1);
  subset->cut = cellist_allocate(context, count, 1);
  subset->tets = cellist_allocate(context, count, 4 * sizeof *subset->tets);
  subset->neighbours = cellist_allocate(context, count, 4 * sizeof *subset->neighbours);
  subset->order = cellist_allocate(context, count, sizeof *subset->order);
  cellist_result result = CELLIST_SUCCESS;
  if (subset->ids == NULL || subset->wanted == NULL || subset->cut == NULL || subset->tets == NULL ||
      subset->neighbours == NULL || subset->order == NULL)
    result = CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) take_tets(mesh, wanted, numbers, subset);
  if (result == CELLIST_SUCCESS && mesh->complex != NULL) {
    result = take_complex(context, mesh, numbers, subset);
    mesh->complex = &subset->complex;
  }
  cellist_deallocate(context, numbers);
  mesh->tet_count = count;
  mesh->tets = subset->tets;
  mesh->neighbours = subset->neighbours;
  return result;
}

void sort_subset_release(cellist_context *context, sort_subset *subset) {
  cellist_deallocate(context, subset->ids);
  cellist_deallocate(context, subset->wanted);
  cellist_deallocate(context, subset->cut);
  cellist_deallocate(context, subset->tets);
  cellist_deallocate(context, subset->neighbours);
  cellist_deallocate(context, subset->order);
  cellist_deallocate(context, subset->facet_planes);
  cellist_deallocate(context, subset->facet_cells);
  *subset = (sort_subset){0};
}

void sort_subset_close_cuts(const sort_subset *subset, uint32_t *out) {
  for (uint32_t i = 0; i < subset->tet_count; i++)
    for (uint32_t k = 0; k < 4; k++)
      if (subset->cut[i] >> k & 1) out[4 * (size_t)i + k] = i;
}

size_t sort_subset_take(const sort_subset *subset, uint32_t *order, cellist_group *groups, size_t group_count) {
  size_t count = 0, left = 0, group = 0, begin = 0;
  for (size_t i = 0; i < subset->tet_count; i++) {
    if (group < group_count && groups[group].begin == i) begin = count;
    const uint32_t tet = subset->order[i];
    if (subset->wanted[tet]) order[count++] = subset->ids[tet];
    if (group < group_count && groups[group].begin + groups[group].count == i + 1) {
      if (count - begin > 1) groups[left++] = (cellist_group){begin, count - begin};
      group++;
    }
  }
  return left;
}
