/* SPDX-License-Identifier: BSD-3-Clause
 * Repeating: the same order for any number of threads and whatever was sorted before, and no allocation. */
#include <cellist/generate.h>

#include "scene.h"

struct counter {
  size_t made;
};

static void *counting_allocate(void *user, size_t size) {
  struct counter *counter = user;
  counter->made++;
  return aligned_alloc(64, (size + 63) / 64 * 64);
}

static void counting_deallocate(void *user, void *block) {
  (void)user;
  free(block);
}

static cellist_viewpoint view_of(const double bounds[6], unsigned kind) {
  random_state random = {kind};
  cellist_viewpoint view = scene_view(kind, 1, &random);
  for (int k = 0; k < 3 && !view.parallel; k++)
    view.position[k] = bounds[k] + view.position[k] * (bounds[3 + k] - bounds[k]);
  return view;
}

static cellist_mesh *generate(cellist_context *context, const char *name, size_t size) {
  const cellist_generate_desc desc = {.size = size, .seed = 1};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_generate(context, name, &desc, &mesh));
  return mesh;
}

TEST(the_order_is_the_same_for_any_number_of_threads)
{
  static const struct {
    const char *name;
    size_t size;
  } samples[] = {{"ball", 80000}, {"grid", 70000}, {"shells", 20000}, {"gears", 5000}};
  for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++) {
    cellist_context *context = harness_context(1);
    cellist_mesh *mesh = generate(context, samples[i].name, samples[i].size);
    const cellist_sorter_desc desc = sorter_desc_of(mesh);
    enum { VIEWS = 6 };
    uint32_t *first[VIEWS] = {0}, *order = calloc(desc.tet_count, sizeof *order);
    for (unsigned workers = 1; workers < 6; workers++) {
      cellist_context *other = harness_context(workers);
      cellist_sorter *sorter = NULL;
      assert_success(other, cellist_sorter_create(other, &desc, &sorter));
      for (unsigned v = 0; v < VIEWS; v++) {
        const unsigned kind = workers % 2 ? v : VIEWS - 1 - v; /* whatever came before */
        const cellist_viewpoint view = view_of(cellist_mesh_get_arrays(mesh)->bounds, kind);
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

/* Sorts from 24 kinds of view, twice; no sort after the first one allocates if is_fixed, none of the second
 * round does anyway. */
static void check_allocations(const cellist_mesh *mesh, unsigned workers, bool is_fixed) {
  enum { KINDS = 24 };
  struct counter counter = {0};
  const cellist_context_desc context_desc = {.allocator = {counting_allocate, counting_deallocate, &counter},
                                             .worker_count = workers};
  cellist_context *context = NULL;
  assert_int_equal(cellist_context_create(&context_desc, &context), CELLIST_SUCCESS);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  uint32_t *order = calloc(desc.tet_count + 1, sizeof *order);
  for (unsigned i = 0; i < 2 * KINDS; i++) {
    const cellist_viewpoint view = view_of(cellist_mesh_get_arrays(mesh)->bounds, i % KINDS);
    const size_t before = counter.made;
    assert_success(context, cellist_sorter_sort(sorter, &view, order, NULL));
    if (i >= (is_fixed ? 1 : KINDS)) assert_int_equal(counter.made, before);
  }
  free(order);
  cellist_sorter_destroy(sorter);
  cellist_context_destroy(context);
}

/* The eye outside, inside, on points, in planes, parallel, along axes. */
TEST(convex_meshes_are_sorted_without_allocation_after_the_first_view)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = generate(context, "ball", 70000);
  check_allocations(mesh, 1, true);
  check_allocations(mesh, 2, true);
  cellist_mesh_destroy(mesh);
  mesh = scene_grid(context, 6, 0, 0, 1);
  check_allocations(mesh, 2, true);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* How many gap arcs a view has is not known before; what the largest view needed is kept. */
TEST(meshes_with_gaps_are_sorted_without_allocation_from_where_they_were_sorted_before)
{
  cellist_context *context = harness_context(1);
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    cellist_mesh *mesh = generate(context, cellist_generator_name(i), 800);
    check_allocations(mesh, 1, false);
    cellist_mesh_destroy(mesh);
  }
  cellist_mesh *mesh = scene_grid(context, 6, 0.1, 0.4, 1);
  check_allocations(mesh, 1, false);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
