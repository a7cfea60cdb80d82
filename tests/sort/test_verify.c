/* SPDX-License-Identifier: BSD-3-Clause
 * Verification: passes right orders, catches wrong ones, refuses what is no order. */
#include <cellist/sort_verify.h>

#include "scene.h"

struct sorted {
  cellist_mesh *mesh;
  cellist_sorter_desc desc;
  cellist_sorter *sorter;
  uint32_t *order;
};

static struct sorted sort_scene(cellist_context *context, const cellist_viewpoint *view) {
  struct sorted sorted = {.mesh = scene_grid(context, 5, 0.1, 0.3, 4)};
  sorted.desc = sorter_desc_of(sorted.mesh);
  sorted.order = calloc(sorted.desc.tet_count, sizeof *sorted.order);
  assert_success(context, cellist_sorter_create(context, &sorted.desc, &sorted.sorter));
  assert_success(context, cellist_sorter_sort(sorted.sorter, view, sorted.order, NULL));
  return sorted;
}

static void release(struct sorted *sorted) {
  cellist_sorter_destroy(sorted->sorter);
  cellist_mesh_destroy(sorted->mesh);
  free(sorted->order);
}

TEST(right_orders_pass_and_reversed_ones_fail_everywhere)
{
  cellist_context *context = harness_context(2);
  for (unsigned kind = 0; kind < 6; kind++) {
    random_state random = {kind};
    const cellist_viewpoint view = scene_view(kind, 5, &random);
    struct sorted sorted = sort_scene(context, &view);
    const size_t n = sorted.desc.tet_count;
    cellist_verifier *verifier = NULL;
    assert_success(context, cellist_verifier_create(context, &sorted.desc, &verifier));
    cellist_verification found;
    cellist_certificate certificate;
    assert_success(context, cellist_verifier_check(verifier, &view, sorted.order, NULL, 0, 500, 1, &found));
    assert_success(context, cellist_order_certify(context, &sorted.desc, &view, sorted.order, NULL, 0, &certificate));
    assert_true(found.ray_count > 400 && found.pairs > 1000);
    assert_true(found.inversions == 0 && found.group_pairs == 0 && found.overlaps == 0);
    assert_true(certificate.faces > n / 2 && certificate.violations == 0);
    const cellist_verification right = found;
    for (size_t i = 0; i < n / 2; i++) {
      const uint32_t swap = sorted.order[i];
      sorted.order[i] = sorted.order[n - 1 - i];
      sorted.order[n - 1 - i] = swap;
    }
    assert_success(context, cellist_verifier_check(verifier, &view, sorted.order, NULL, 0, 500, 1, &found));
    assert_success(context, cellist_order_certify(context, &sorted.desc, &view, sorted.order, NULL, 0, &certificate));
    assert_true(found.pairs == right.pairs && found.inversions == right.pairs);
    assert_true(certificate.violations == certificate.faces);
    /* One group of everything is no order at all, and no wrong one either. */
    const cellist_group all = {0, n};
    assert_success(context, cellist_verifier_check(verifier, &view, sorted.order, &all, 1, 500, 1, &found));
    assert_true(found.pairs == 0 && found.group_pairs == right.pairs);
    cellist_verifier_destroy(verifier);
    release(&sorted);
  }
  harness_context_destroy(context);
}

TEST(what_is_no_order_is_refused)
{
  cellist_context *context = harness_context(1);
  const cellist_viewpoint view = {{7, 6.3, 2.2}, false};
  struct sorted sorted = sort_scene(context, &view);
  const cellist_result invalid = CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_verifier *verifier = NULL;
  assert_success(context, cellist_verifier_create(context, &sorted.desc, &verifier));
  cellist_verification found;
  cellist_certificate certificate;
  const cellist_group groups[2] = {{4, 3}, {6, 2}}, outside = {sorted.desc.tet_count, 1};
  assert_failure(context, cellist_verifier_check(verifier, &view, sorted.order, groups, 2, 1, 1, &found), invalid,
                 "group 1 (2 cells from place 6)");
  assert_failure(context, cellist_verifier_check(verifier, &view, sorted.order, &outside, 1, 1, 1, &found), invalid,
                 "group 0");
  sorted.order[3] = sorted.order[9];
  assert_failure(context, cellist_order_certify(context, &sorted.desc, &view, sorted.order, NULL, 0, &certificate),
                 invalid, "order[9]");
  sorted.order[3] = 1u << 30;
  assert_failure(context, cellist_verifier_check(verifier, &view, sorted.order, NULL, 0, 1, 1, &found), invalid,
                 "order[3] is 1073741824, which is no tet");
  assert_failure(context, cellist_verifier_check(verifier, NULL, sorted.order, NULL, 0, 1, 1, &found), invalid, "NULL");
  assert_failure(context, cellist_verifier_create(context, NULL, &verifier), invalid, "NULL");
  cellist_verifier_destroy(verifier);
  cellist_verifier_destroy(NULL);
  release(&sorted);
  harness_context_destroy(context);
}

static cellist_result verify_in(cellist_context *context, void *user) {
  struct sorted *sorted = user;
  const cellist_viewpoint view = {{7, 6.3, 2.2}, false};
  cellist_verifier *verifier = NULL;
  cellist_verification found;
  cellist_certificate certificate;
  cellist_result result = cellist_verifier_create(context, &sorted->desc, &verifier);
  if (result == CELLIST_SUCCESS)
    result = cellist_verifier_check(verifier, &view, sorted->order, NULL, 0, 10, 1, &found);
  cellist_verifier_destroy(verifier);
  if (result == CELLIST_SUCCESS)
    result = cellist_order_certify(context, &sorted->desc, &view, sorted->order, NULL, 0, &certificate);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  cellist_context *context = harness_context(1);
  const cellist_viewpoint view = {{7, 6.3, 2.2}, false};
  struct sorted sorted = sort_scene(context, &view);
  check_allocation_failures(verify_in, &sorted);
  release(&sorted);
  harness_context_destroy(context);
}
