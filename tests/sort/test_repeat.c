/* SPDX-License-Identifier: BSD-3-Clause
 * Repeating: the same order for any number of threads and whatever was sorted before, and no allocation. */
#include "judge.h"
#include "pile.h"

TEST(the_order_is_the_same_for_any_number_of_threads)
{
  static const struct {
    const char *name;
    size_t size;
  } samples[] = {{"ball", 80000}, {"grid", 70000}, {"shells", 20000}, {"gears", 5000}};
  for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++) {
    cellist_context *context = harness_context(1);
    cellist_mesh *mesh = judge_generate(context, samples[i].name, samples[i].size);
    const cellist_sorter_desc desc = sorter_desc_of(mesh);
    enum { VIEWS = 6 };
    uint32_t *first[VIEWS] = {0}, *order = calloc(desc.tet_count, sizeof *order);
    for (unsigned workers = 1; workers < 6; workers++) {
      cellist_context *other = harness_context(workers);
      cellist_sorter *sorter = NULL;
      assert_success(other, cellist_sorter_create(other, &desc, &sorter));
      for (unsigned v = 0; v < VIEWS; v++) {
        const unsigned kind = workers % 2 ? v : VIEWS - 1 - v; /* whatever came before */
        const cellist_viewpoint view = bounds_view(cellist_mesh_get_arrays(mesh)->bounds, kind);
        assert_success(other, cellist_sorter_sort(sorter, &view, order, NULL));
        if (first[kind] == NULL) {
          first[kind] = calloc(desc.tet_count, sizeof *order);
          memcpy(first[kind], order, desc.tet_count * sizeof *order);
        }
        assert_memory_equal(first[kind], order, desc.tet_count * sizeof *order);
      }
      cellist_sorter_destroy(sorter);
      harness_context_destroy(other);
    }
    for (unsigned v = 0; v < VIEWS; v++) free(first[v]);
    free(order);
    cellist_mesh_destroy(mesh);
    harness_context_destroy(context);
  }
}

/* Sorts from view_count views, twice, and returns how many sorts of the first round allocate after the first one; none
 * of the second round does. */
static size_t check_allocations(const cellist_mesh *mesh, unsigned workers, unsigned view_count) {
  cellist_context *context = harness_context(workers);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  uint32_t *order = calloc(desc.tet_count + 1, sizeof *order);
  size_t later = 0;
  for (unsigned i = 0; i < 2 * view_count; i++) {
    const cellist_viewpoint view = bounds_view(cellist_mesh_get_arrays(mesh)->bounds, i % view_count);
    const size_t before = harness_allocation_count(context);
    assert_success(context, cellist_sorter_sort(sorter, &view, order, NULL));
    const size_t made = harness_allocation_count(context) - before;
    later += i > 0 && made > 0;
    if (i >= view_count) assert_int_equal(made, 0);
  }
  free(order);
  cellist_sorter_destroy(sorter);
  harness_context_destroy(context);
  return later;
}

/* The eye outside, inside, on points, in planes, parallel, along axes. */
TEST(convex_meshes_are_sorted_without_allocation_after_the_first_view)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = judge_generate(context, "ball", 70000);
  assert_int_equal(check_allocations(mesh, 1, 24), 0);
  assert_int_equal(check_allocations(mesh, 2, 24), 0);
  cellist_mesh_destroy(mesh);
  mesh = scene_grid(context, 6, 0, 0, 1);
  assert_int_equal(check_allocations(mesh, 2, 24), 0);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* How many gap arcs a view has is not known before it is sorted; what was needed is kept, with room to spare. Samples
 * of one part behind the other, such as plates, have most. */
TEST(meshes_with_gaps_are_sorted_without_allocation_after_the_first_view)
{
  cellist_context *context = harness_context(1);
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    cellist_mesh *mesh = judge_generate(context, cellist_generator_name(i), 800);
    for (unsigned workers = 1; workers < 4; workers++) {
      print_message("%s, %u workers\n", cellist_generator_name(i), workers);
      assert_int_equal(check_allocations(mesh, workers, 60), 0);
    }
    cellist_mesh_destroy(mesh);
  }
  cellist_mesh *mesh = scene_grid(context, 6, 0.1, 0.4, 1);
  assert_int_equal(check_allocations(mesh, 2, 60), 0);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* Layers of needles across each other, of which each covers all of the others: seen from the side first, then from
 * above. Then there is room for some more, and the order is right where what was found first did not fit. */
TEST(a_view_with_many_more_gap_arcs_allocates_once)
{
  enum { NEEDLES = 150 };
  cellist_context *context = harness_context(3);
  struct pile *pile = calloc(1, sizeof *pile);
  for (uint32_t i = 0; i < 2 * NEEDLES; i++) {
    const double at = i % NEEDLES, z = i < NEEDLES ? 0 : 3;
    const double corners[4][3] = {{0, at, z}, {0, at + 0.5, z}, {NEEDLES, at + 0.25, z}, {0, at + 0.25, z + 0.5}};
    for (uint32_t c = 0; c < 4; c++) {
      for (uint32_t k = 0; k < 2; k++) pile->points[3 * (size_t)(4 * i + c) + k] = corners[c][i < NEEDLES ? k : 1 - k];
      pile->points[3 * (size_t)(4 * i + c) + 2] = corners[c][2];
      pile->tets[4 * i + c] = 4 * i + c;
    }
  }
  pile->tet_count = 2 * NEEDLES;
  pile->point_count = 4 * pile->tet_count;
  cellist_mesh *mesh = pile_mesh(context, pile);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  static const cellist_viewpoint views[] = {{{1, 0.3, 0}, true},  {{0, 0, -1}, true},   {{75, 75, 400}, false},
                                            {{0.1, 0, -1}, true}, {{75, 75, 2}, false}, {{0, 0.1, 1}, true}};
  uint32_t *order = calloc(desc.tet_count, sizeof *order);
  for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
    cellist_sort_stats stats;
    const size_t before = harness_allocation_count(context);
    assert_success(context, cellist_sorter_sort(sorter, &views[i], order, &stats));
    assert_true((harness_allocation_count(context) > before) == (i == 1));
    if (i == 1) assert_true(stats.gap_arc_count > 32 * 4 * desc.tet_count);
    const oracle_count count = oracle_check(&desc, &views[i], order, NULL, 0, 60, i);
    assert_int_equal(stats.group_count, 0);
    assert_int_equal(count.inversions, 0);
  }
  free(order);
  cellist_sorter_destroy(sorter);
  cellist_mesh_destroy(mesh);
  free(pile);
  harness_context_destroy(context);
}
