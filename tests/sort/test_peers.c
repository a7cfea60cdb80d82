/* SPDX-License-Identifier: BSD-3-Clause
 * Peers: orders that are permutations, right where their papers say so, wrong where they must be. */
#include <cellist/generate.h>
#include <cellist/sort_peers.h>
#include <cellist/sort_verify.h>

#include "scene.h"

static cellist_verification run(cellist_context *context, const cellist_mesh *mesh, const char *name,
                                const cellist_viewpoint *view) {
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_peer *peer = NULL;
  cellist_verifier *verifier = NULL;
  uint32_t *order = calloc(desc.tet_count, sizeof *order);
  cellist_verification found;
  assert_success(context, cellist_peer_create(context, &desc, name, &peer));
  assert_success(context, cellist_verifier_create(context, &desc, &verifier));
  assert_success(context, cellist_peer_sort(peer, view, order));
  assert_success(context, cellist_verifier_check(verifier, view, order, NULL, 0, 500, 3, &found));
  cellist_verifier_destroy(verifier);
  cellist_peer_destroy(peer);
  free(order);
  return found;
}

TEST(every_peer_puts_out_each_cell_once)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 8, 0.1, 0.3, 5);
  for (size_t i = 0; cellist_peer_name(i) != NULL; i++) {
    for (unsigned kind = 0; kind < 6; kind++) {
      random_state random = {kind};
      const cellist_viewpoint view = scene_view(kind, 8, &random);
      const cellist_verification found = run(context, mesh, cellist_peer_name(i), &view); /* fails if no permutation */
      assert_true(found.pairs > 500 && found.inversions < found.pairs / 2);
    }
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* A convex mesh has no gaps, so MPVO is right up to its float planes; a centroid sort is not. */
TEST(mpvo_nc_orders_convex_meshes_and_centroids_do_not)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 8, 0.1, 0, 5);
  const cellist_viewpoint view = {{20, 13, 17}, false};
  assert_int_equal(run(context, mesh, "mpvo_nc", &view).inversions, 0);
  const cellist_verification radix = run(context, mesh, "centroid", &view);
  assert_true(radix.inversions > 0);
  const cellist_verification compare = run(context, mesh, "centroid_compare", &view);
  assert_int_equal(radix.inversions, compare.inversions);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(power_orders_a_delaunay_mesh)
{
  cellist_context *context = harness_context(1);
  const cellist_generate_desc desc = {.size = 5000, .seed = 1};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_generate(context, "ball", &desc, &mesh));
  const cellist_viewpoint view = {{5, 3, 4}, false};
  const cellist_verification power = run(context, mesh, "power", &view);
  /* Right but for rounding: keys are floats. */
  assert_true(power.inversions * 1000 < power.pairs);
  assert_true(run(context, mesh, "centroid", &view).inversions > 10 * (power.inversions + 1));
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* Holes, pieces, cavities; the eye outside, inside, on points, in planes: as exact as the sorter, by brute force. */
TEST(bsp_xmpvo_orders_meshes_with_gaps)
{
  cellist_context *context = harness_context(1);
  for (unsigned kind = 0; kind < 36; kind++) {
    random_state random = {kind};
    cellist_mesh *mesh = scene_grid(context, 4, kind % 2 == 0 ? 0.1 : 0, 0.4, kind);
    const cellist_sorter_desc desc = sorter_desc_of(mesh);
    const cellist_viewpoint view = scene_view(kind, 4, &random);
    cellist_peer *peer = NULL;
    uint32_t *order = calloc(desc.tet_count, sizeof *order);
    assert_success(context, cellist_peer_create(context, &desc, "bsp_xmpvo", &peer));
    for (int repeat = 0; repeat < 2; repeat++) {
      assert_success(context, cellist_peer_sort(peer, &view, order));
      const oracle_count count = oracle_check(&desc, &view, order, NULL, 0, 60, 5);
      assert_true(count.pairs > 100);
      assert_int_equal(count.inversions, 0);
    }
    cellist_peer_destroy(peer);
    free(order);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

struct task {
  const cellist_sorter_desc *desc;
  const char *name;
};

static cellist_result sort_in(cellist_context *context, void *user) {
  const struct task *task = user;
  uint32_t order[384];
  cellist_peer *peer = NULL;
  const cellist_viewpoint view = {{20, 13, 17}, false};
  cellist_result result = cellist_peer_create(context, task->desc, task->name, &peer);
  if (result == CELLIST_SUCCESS) result = cellist_peer_sort(peer, &view, order);
  cellist_peer_destroy(peer);
  return result;
}

TEST(failures_are_reported)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 3, 0.1, 0.3, 5);
  cellist_sorter_desc desc = sorter_desc_of(mesh);
  cellist_peer *peer = NULL;
  assert_failure(context, cellist_peer_create(context, &desc, "bubble", &peer), CELLIST_ERROR_NOT_FOUND,
                 "no peer 'bubble'");
  for (size_t i = 0; cellist_peer_name(i) != NULL; i++)
    check_allocation_failures(sort_in, &(struct task){&desc, cellist_peer_name(i)});
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
