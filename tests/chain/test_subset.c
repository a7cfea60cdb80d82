/* SPDX-License-Identifier: BSD-3-Clause
 * Subsets: some tets sorted alone are in the right order on every ray; and what views share is shared. */
#include "chain.h"

enum { NO_EXTERIOR = EXTERIORS };

/* Wanted tets: those with a point in a ball. */
static size_t choose(const cellist_sorter_desc *mesh, const double centre[3], double radius, uint8_t *wanted) {
  size_t count = 0;
  for (size_t t = 0; t < mesh->tet_count; t++) {
    wanted[t] = 0;
    for (size_t c = 0; c < 4; c++) {
      double squared = 0;
      for (size_t k = 0; k < 3; k++) {
        const double away = mesh->points[3 * (size_t)mesh->tets[4 * t + c] + k] - centre[k];
        squared += away * away;
      }
      if (squared < radius * radius) wanted[t] = 1;
    }
    count += wanted[t];
  }
  return count;
}

/* Looks at all pairs of wanted tets on rays; returns how many there are. Fails the case on one in the wrong order. */
static size_t check_rays(const cellist_sorter_desc *mesh, const cellist_viewpoint *view, const uint8_t *wanted,
                         const uint32_t *order, size_t count, const cellist_group *groups, size_t group_count,
                         uint64_t seed) {
  size_t *rank = calloc(mesh->tet_count + 1, sizeof *rank), pairs = 0;
  struct oracle_interval *hits = calloc(mesh->tet_count + 1, sizeof *hits);
  for (size_t i = 0; i < count; i++) {
    assert_true(order[i] < mesh->tet_count && wanted[order[i]] && rank[order[i]] == 0);
    rank[order[i]] = i + 1;
  }
  for (size_t g = 0; g < group_count; g++)
    for (size_t i = 0; i < groups[g].count; i++) rank[order[groups[g].begin + i]] = groups[g].begin + 1;
  random_state random = {seed};
  for (int ray = 0; ray < 80; ray++) {
    double from[3], direction[3];
    size_t hit_count = 0;
    oracle_ray(mesh, view, &random, from, direction);
    for (uint32_t t = 0; t < mesh->tet_count; t++) {
      if (!wanted[t]) continue;
      hits[hit_count].tet = t;
      hit_count += oracle_cross(mesh->points, &mesh->tets[4 * t], from, direction, view->parallel, &hits[hit_count]);
    }
    qsort(hits, hit_count, sizeof *hits, oracle_compare);
    for (size_t i = 0; i < hit_count; i++)
      for (size_t j = i + 1; j < hit_count; j++) {
        assert_true(rank[hits[i].tet] >= rank[hits[j].tet]);
        pairs++;
      }
  }
  free(rank);
  free(hits);
  return pairs;
}

TEST(wanted_tets_are_in_order_on_every_ray)
{
  cellist_context *context = harness_context(1);
  size_t pairs = 0, left_out = 0;
  for (unsigned kind = 0; kind < 48; kind++) {
    random_state random = {kind};
    cellist_mesh *mesh = scene_grid(context, 6, kind % 2 == 0 ? 0.1 : 0, kind % 8 == 0 ? 0 : 0.1 * (kind % 5), kind);
    cellist_complex *complex = NULL;
    cellist_sorter_complex arrays;
    cellist_sorter_desc desc = sorter_desc_of(mesh);
    const int exterior = (int)(kind % (EXTERIORS + 1));
    const cellist_convexify_desc how = {.exterior = (cellist_exterior)exterior};
    if (exterior != NO_EXTERIOR) {
      assert_success(context, cellist_convexify(context, mesh, &how, &complex, NULL));
      arrays = sorter_complex_of(complex);
      desc.complex = &arrays;
    }
    double centre[3];
    for (int k = 0; k < 3; k++) centre[k] = 6 * random_unit(&random);
    uint8_t *wanted = calloc(desc.tet_count + 1, 1);
    uint32_t *order = calloc(desc.tet_count + 1, sizeof *order);
    const size_t count = choose(&desc, centre, 1 + 1.5 * random_unit(&random), wanted);
    cellist_sorter *sorter = NULL;
    assert_success(context, cellist_sorter_create_subset(context, &desc, wanted, &sorter));
    assert_int_equal(cellist_sorter_order_size(sorter), count);
    for (unsigned i = 0; i < 6; i++) {
      const cellist_viewpoint view = scene_view(i, 6, &random);
      cellist_sort_stats stats;
      const cellist_group *groups = NULL;
      size_t group_count = 0;
      assert_success(context, cellist_sorter_sort(sorter, &view, order, &stats));
      cellist_sorter_groups(sorter, &groups, &group_count);
      assert_int_equal(group_count, 0);
      assert_true(stats.sorted_tet_count >= count && stats.sorted_tet_count <= desc.tet_count);
      left_out += desc.tet_count - stats.sorted_tet_count;
      pairs += check_rays(&desc, &view, wanted, order, count, groups, group_count, i);
    }
    cellist_sorter_destroy(sorter);
    cellist_complex_destroy(complex);
    cellist_mesh_destroy(mesh);
    free(wanted);
    free(order);
  }
  assert_true(pairs > 10000);
  assert_true(left_out > 10000);
  harness_context_destroy(context);
}

TEST(nothing_wanted_is_an_empty_order)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 3, 0.1, 0.3, 1);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  uint8_t *wanted = calloc(desc.tet_count, 1);
  cellist_sorter *sorter = NULL;
  const cellist_viewpoint view = {{9, 8, 7}, false};
  assert_success(context, cellist_sorter_create_subset(context, &desc, wanted, &sorter));
  assert_int_equal(cellist_sorter_order_size(sorter), 0);
  assert_success(context, cellist_sorter_sort(sorter, &view, NULL, NULL));
  assert_failure(context, cellist_sorter_create_subset(context, &desc, NULL, &sorter), CELLIST_ERROR_INVALID_ARGUMENT,
                 "wanted is NULL");
  cellist_sorter_destroy(sorter);
  cellist_mesh_destroy(mesh);
  free(wanted);
  harness_context_destroy(context);
}

static cellist_result sort_part(cellist_context *context, void *user) {
  const cellist_sorter_desc *desc = user;
  const cellist_viewpoint view = {{0.4, 9, 3}, false};
  uint8_t wanted[512];
  uint32_t order[512];
  for (size_t i = 0; i < desc->tet_count; i++) wanted[i] = i % 3 == 0;
  cellist_sorter *sorter = NULL;
  cellist_result result = cellist_sorter_create_subset(context, desc, wanted, &sorter);
  if (result == CELLIST_SUCCESS) result = cellist_sorter_sort(sorter, &view, order, NULL);
  cellist_sorter_destroy(sorter);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 4, 0.1, 0.3, 3);
  cellist_complex *complex = NULL;
  const cellist_convexify_desc how = {.exterior = CELLIST_EXTERIOR_HULL};
  assert_success(context, cellist_convexify(context, mesh, &how, &complex, NULL));
  const cellist_sorter_complex arrays = sorter_complex_of(complex);
  cellist_sorter_desc desc = sorter_desc_of(mesh);
  desc.complex = &arrays;
  check_allocation_failures(sort_part, &desc);
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(nothing_is_allocated_after_the_first_view)
{
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = scene_grid(context, 9, 0.1, 0.3, 4);
  for (int exterior = 0; exterior <= EXTERIORS; exterior++) {
    cellist_complex *complex = NULL;
    cellist_sorter_complex arrays;
    cellist_sorter_desc desc = sorter_desc_of(mesh);
    const cellist_convexify_desc how = {.exterior = (cellist_exterior)exterior};
    if (exterior != NO_EXTERIOR) {
      assert_success(context, cellist_convexify(context, mesh, &how, &complex, NULL));
      arrays = sorter_complex_of(complex);
      desc.complex = &arrays;
    }
    cellist_sorter *sorter = NULL;
    uint32_t *order = calloc(desc.tet_count, sizeof *order);
    assert_success(context, cellist_sorter_create(context, &desc, &sorter));
    for (unsigned i = 0; i < 24; i++) {
      random_state random = {i};
      const cellist_viewpoint view = scene_view(i, 9, &random);
      const size_t before = harness_allocation_count(context);
      assert_success(context, cellist_sorter_sort(sorter, &view, order, NULL));
      if (i > 0) assert_int_equal(harness_allocation_count(context), before);
    }
    free(order);
    cellist_sorter_destroy(sorter);
    cellist_complex_destroy(complex);
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(an_order_holds_while_the_eye_stays)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 3, 0.1, 0.3, 1);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_sorter *sorter = NULL;
  uint32_t *order = calloc(desc.tet_count, sizeof *order);
  cellist_viewpoint view = {{9, 8, 7}, false};
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  assert_false(cellist_sorter_is_current(sorter, &view));
  assert_success(context, cellist_sorter_sort(sorter, &view, order, NULL));
  assert_true(cellist_sorter_is_current(sorter, &view));
  const cellist_viewpoint other = {{9, 8, 7}, true}, moved = {{9, 8, 7.0000001}, false};
  assert_false(cellist_sorter_is_current(sorter, &other));
  assert_false(cellist_sorter_is_current(sorter, &moved));
  cellist_sorter_forget(sorter);
  assert_false(cellist_sorter_is_current(sorter, &view));
  free(order);
  cellist_sorter_destroy(sorter);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(any_number_of_workers_gives_the_same_order)
{
  uint32_t *first[EXTERIORS] = {0};
  for (unsigned workers = 1; workers <= 4; workers++) {
    cellist_context *context = harness_context(workers);
    cellist_mesh *mesh = scene_grid(context, 8, 0.1, 0.3, 9);
    for (int exterior = 0; exterior < EXTERIORS; exterior++) {
      chain *made = chain_create(context, mesh, exterior);
      const size_t size = 4 * made->desc.tet_count;
      uint32_t *orders = calloc(size, sizeof *orders);
      for (unsigned kind = 0; kind < 4; kind++) {
        random_state random = {77};
        const cellist_viewpoint view = scene_view(kind, 8, &random);
        assert_success(context, cellist_sorter_sort(made->sorter, &view, &orders[kind * made->desc.tet_count], NULL));
      }
      if (first[exterior] == NULL)
        first[exterior] = orders;
      else
        assert_memory_equal(first[exterior], orders, size * sizeof *orders);
      if (first[exterior] != orders) free(orders);
      chain_destroy(made);
    }
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
  for (int exterior = 0; exterior < EXTERIORS; exterior++) free(first[exterior]);
}

TEST(complexes_of_other_meshes_are_refused)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 3, 0.1, 0.4, 1), *other = scene_grid(context, 3, 0.1, 0.4, 2);
  const cellist_convexify_desc how = {.exterior = CELLIST_EXTERIOR_HULL};
  cellist_complex *complex = NULL;
  assert_success(context, cellist_convexify(context, other, &how, &complex, NULL));
  cellist_sorter_complex arrays = sorter_complex_of(complex);
  cellist_sorter_desc desc = sorter_desc_of(mesh);
  desc.complex = &arrays;
  cellist_sorter *sorter = NULL;
  const cellist_result invalid = CELLIST_ERROR_INVALID_ARGUMENT;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), invalid, "");
  /* The right mesh, with facets missing, and with cells that are not there. */
  desc = sorter_desc_of(other);
  desc.complex = &arrays;
  arrays.facet_count /= 2;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), invalid, "has no facet at face");
  arrays = sorter_complex_of(complex);
  arrays.cell_count = desc.tet_count;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), invalid, "out of range");
  arrays = sorter_complex_of(complex);
  uint32_t *cells = malloc(2 * arrays.facet_count * sizeof *cells);
  for (size_t f = 0; f < arrays.facet_count; f++) { /* the two sides change places */
    cells[2 * f] = arrays.facet_cells[2 * f + 1];
    cells[2 * f + 1] = arrays.facet_cells[2 * f];
  }
  arrays.facet_cells = cells;
  assert_failure(context, cellist_sorter_create(context, &desc, &sorter), invalid, "lies in no face of tet");
  assert_null(sorter);
  free(cells);
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  cellist_mesh_destroy(other);
  harness_context_destroy(context);
}
