/* SPDX-License-Identifier: BSD-3-Clause
 * Gaps: concave meshes, contacts without shared faces, parts, cavities and true cycles, against brute force. */
#include "pile.h"

TEST(grids_with_holes_are_in_exact_order_from_everywhere)
{
  cellist_context *context = harness_context(1);
  for (unsigned kind = 0; kind < 120; kind++) {
    random_state random = {kind};
    cellist_mesh *mesh = scene_grid(context, 4, kind % 2 == 0 ? 0.1 : 0, 0.1 + 0.2 * (kind % 5), kind);
    const cellist_viewpoint view = scene_view(kind, 4, &random);
    cellist_sort_stats stats;
    const oracle_count count = sort_and_check(context, mesh, &view, 60, &stats);
    assert_true(stats.exact);
    assert_int_equal(count.inversions, 0);
    assert_true(count.pairs > 0);
    assert_int_equal(stats.cells_in_groups, 0); /* a grid's cells can be ordered from everywhere, holes or not */
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

/* Three blocks that touch face to face, with points of their own: two alike and one twice as fine. */
TEST(blocks_in_contact_are_in_exact_order)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *coarse = scene_grid(context, 2, 0, 0, 1), *fine = scene_grid(context, 4, 0.1, 0, 1);
  struct pile *pile = calloc(1, sizeof *pile);
  pile_add_mesh(pile, coarse, 1, (const double[]){0, 0, 0});
  pile_add_mesh(pile, coarse, 1, (const double[]){2, 0, 0});
  pile_add_mesh(pile, fine, 0.5, (const double[]){0, 2, 0.25});
  cellist_mesh *mesh = pile_mesh(context, pile);
  for (unsigned kind = 0; kind < 60; kind++) {
    random_state random = {kind};
    const cellist_viewpoint view = scene_view(kind, 4, &random);
    cellist_sort_stats stats;
    const oracle_count count = sort_and_check(context, mesh, &view, 60, &stats);
    assert_true(stats.exact);
    assert_int_equal(count.inversions, 0);
    assert_int_equal(stats.cells_in_groups, 0);
  }
  cellist_mesh_destroy(mesh);
  cellist_mesh_destroy(coarse);
  cellist_mesh_destroy(fine);
  free(pile);
  harness_context_destroy(context);
}

/* A soup of tets, each in a cube of its own so that none cut each other. */
TEST(scattered_tets_are_in_exact_order)
{
  cellist_context *context = harness_context(1);
  for (unsigned kind = 0; kind < 48; kind++) {
    random_state random = {kind};
    struct pile *pile = calloc(1, sizeof *pile);
    for (uint32_t cube = 0; cube < 125; cube++) {
      for (uint32_t c = 0; c < 4; c++) {
        const double corner[3] = {cube % 5, cube / 5 % 5, cube / 25};
        pile->tets[4 * pile->tet_count + c] = (uint32_t)pile->point_count;
        for (uint32_t k = 0; k < 3; k++) pile->points[3 * pile->point_count + k] = corner[k] + random_unit(&random);
        pile->point_count++;
      }
      pile->tet_count++;
    }
    cellist_mesh *mesh = pile_mesh(context, pile);
    const cellist_viewpoint view = scene_view(kind, 5, &random);
    cellist_sort_stats stats;
    const oracle_count count = sort_and_check(context, mesh, &view, 200, &stats);
    assert_true(stats.exact);
    assert_true(count.pairs > 20);
    assert_int_equal(count.inversions, 0);
    cellist_mesh_destroy(mesh);
    free(pile);
  }
  harness_context_destroy(context);
}

TEST(a_wheel_is_one_group_of_exactly_its_cells)
{
  cellist_context *context = harness_context(1);
  for (uint32_t n = 3; n <= WHEEL_LIMIT; n++) {
    cellist_mesh *mesh = make_wheel(context, n);
    const cellist_sorter_desc desc = sorter_desc_of(mesh);
    wheel_check(context, mesh, &desc);
    /* Seen from the side there is no circle. */
    const cellist_viewpoint side = {{1, 0.2, 0.01}, true};
    cellist_sort_stats stats;
    const oracle_count count = sort_and_check(context, mesh, &side, 20, &stats);
    assert_int_equal(count.inversions, 0);
    if (n > 8) assert_true(stats.largest_group < n);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

TEST(pairs_inside_a_wheel_are_told_apart)
{
  enum { N = 12 };
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = make_wheel(context, N);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  const uint32_t *origin = cellist_mesh_get_arrays(mesh)->tet_origin;
  uint32_t of_stick[N + 2];
  for (uint32_t i = 0; i < N + 2; i++) of_stick[origin[i]] = i;
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  for (int parallel = 0; parallel < 2; parallel++) {
    const cellist_viewpoint view = {{0, 0, parallel ? -1 : 100}, parallel};
    for (uint32_t i = 0; i < N; i++) {
      for (uint32_t j = 0; j < N; j++) {
        const int expected = j == (i + 1) % N ? -1 : i == (j + 1) % N ? 1 : 0;
        assert_int_equal(cellist_sorter_compare(sorter, &view, of_stick[i], of_stick[j]), expected);
      }
      assert_int_equal(cellist_sorter_compare(sorter, &view, of_stick[i], of_stick[N]), 1);
      assert_int_equal(cellist_sorter_compare(sorter, &view, of_stick[i], of_stick[N + 1]), -1);
    }
  }
  cellist_sorter_destroy(sorter);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* Every pair on a ray stands as compare says; a pair that compare orders is never the other way round. */
TEST(compare_agrees_with_brute_force)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 3, 0.1, 0.4, 8);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  struct oracle_interval *hits = calloc(desc.tet_count, sizeof *hits);
  for (unsigned kind = 0; kind < 24; kind++) {
    random_state random = {kind};
    const cellist_viewpoint view = scene_view(kind, 3, &random);
    for (int ray = 0; ray < 20; ray++) {
      double from[3], direction[3];
      oracle_ray(&desc, &view, &random, from, direction);
      size_t count = 0;
      for (uint32_t t = 0; t < desc.tet_count; t++) {
        hits[count].tet = t;
        count += oracle_cross(desc.points, &desc.tets[4 * t], from, direction, view.parallel, &hits[count]);
      }
      qsort(hits, count, sizeof *hits, oracle_compare);
      for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++) {
          assert_int_equal(cellist_sorter_compare(sorter, &view, hits[i].tet, hits[j].tet), 1);
          assert_int_equal(cellist_sorter_compare(sorter, &view, hits[j].tet, hits[i].tet), -1);
        }
    }
  }
  free(hits);
  cellist_sorter_destroy(sorter);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(all_pairs_at_once_are_what_each_pair_is)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 3, 0.1, 0.5, 8);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  enum { COUNT = 40 };
  uint32_t cells[COUNT];
  int8_t matrix[COUNT * COUNT];
  size_t ordered = 0;
  for (unsigned kind = 0; kind < 18; kind++) {
    random_state random = {kind};
    const cellist_viewpoint view = scene_view(kind, 3, &random);
    for (int i = 0; i < COUNT; i++) cells[i] = (uint32_t)random_below(&random, desc.tet_count);
    assert_success(context, cellist_sorter_compare_all(sorter, &view, cells, COUNT, matrix));
    for (int i = 0; i < COUNT; i++)
      for (int j = 0; j < COUNT; j++) {
        assert_int_equal(matrix[i * COUNT + j], cellist_sorter_compare(sorter, &view, cells[i], cells[j]));
        ordered += matrix[i * COUNT + j] > 0;
      }
  }
  assert_true(ordered > 500);
  const cellist_viewpoint view = {{9, 9, 9}, false};
  cells[3] = (uint32_t)desc.tet_count;
  assert_failure(context, cellist_sorter_compare_all(sorter, &view, cells, COUNT, matrix),
                 CELLIST_ERROR_INVALID_ARGUMENT, "cell ");
  cellist_sorter_destroy(sorter);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(any_number_of_workers_gives_the_same_order)
{
  cellist_mesh *mesh = NULL;
  uint32_t *first = NULL;
  size_t size = 0;
  for (unsigned workers = 1; workers <= 4; workers++) {
    cellist_context *context = harness_context(workers);
    mesh = scene_grid(context, 12, 0.1, 0.3, 9);
    const cellist_sorter_desc desc = sorter_desc_of(mesh);
    cellist_sorter *sorter = NULL;
    assert_success(context, cellist_sorter_create(context, &desc, &sorter));
    size = 4 * desc.tet_count * sizeof(uint32_t);
    uint32_t *orders = calloc(1, size);
    for (unsigned kind = 0; kind < 4; kind++) {
      random_state random = {77};
      const cellist_viewpoint view = scene_view(kind, 12, &random);
      assert_success(context, cellist_sorter_sort(sorter, &view, &orders[kind * desc.tet_count], NULL));
    }
    if (first == NULL) first = malloc(size), memcpy(first, orders, size);
    assert_memory_equal(first, orders, size);
    free(orders);
    cellist_sorter_destroy(sorter);
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
  free(first);
}
