/* SPDX-License-Identifier: BSD-3-Clause
 * Larger meshes for the sorter's tests, and how their orders are judged: by rays and by certificate. */
#ifndef CELLIST_TESTS_SORT_JUDGE_H
#define CELLIST_TESTS_SORT_JUDGE_H

#include <cellist/generate.h>
#include <cellist/sort_verify.h>

#include "scene.h"

/* A view of what lies within bounds, of a kind as scene_view has them. */
static inline cellist_viewpoint bounds_view(const double bounds[6], unsigned kind) {
  random_state random = {kind};
  cellist_viewpoint view = scene_view(kind, 1, &random);
  for (int k = 0; k < 3 && !view.parallel; k++)
    view.position[k] = bounds[k] + view.position[k] * (bounds[3 + k] - bounds[k]);
  return view;
}

/* A sample; the case fails if it cannot be made. */
static inline cellist_mesh *judge_generate(cellist_context *context, const char *name, size_t size) {
  const cellist_generate_desc desc = {.size = size, .seed = 1};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_generate(context, name, &desc, &mesh));
  return mesh;
}

/* How a mesh's orders are judged. */
typedef struct judge_desc {
  unsigned view_count;
  size_t ray_count; /* in each view */
  bool groups_allowed;
} judge_desc;

/* Sorts by the desc's complex or without one, casts rays in each view and asks for a certificate; fails the case on an
 * inversion or a violation. */
static inline void judge_sorter(cellist_context *context, const cellist_sorter_desc *desc, const double bounds[6],
                                judge_desc how) {
  cellist_sorter *sorter = NULL;
  cellist_verifier *verifier = NULL;
  assert_success(context, cellist_sorter_create(context, desc, &sorter));
  assert_success(context, cellist_verifier_create(context, desc, &verifier));
  uint32_t *order = calloc(desc->tet_count + 1, sizeof *order);
  for (unsigned i = 0; i < how.view_count; i++) {
    const cellist_viewpoint view = bounds_view(bounds, i);
    cellist_sort_stats stats;
    assert_success(context, cellist_sorter_sort(sorter, &view, order, &stats));
    const cellist_group *groups = NULL;
    size_t group_count = 0;
    cellist_sorter_groups(sorter, &groups, &group_count);
    cellist_verification found;
    cellist_certificate certificate;
    assert_success(context,
                   cellist_verifier_check(verifier, &view, order, groups, group_count, how.ray_count, i, &found));
    assert_success(context, cellist_order_certify(context, desc, &view, order, groups, group_count, &certificate));
    assert_true(stats.exact && found.ray_count > how.ray_count / 2 && found.pairs > 0);
    assert_int_equal(found.inversions, 0);
    assert_int_equal(certificate.violations, 0);
    if (!how.groups_allowed) assert_int_equal(group_count, 0);
  }
  free(order);
  cellist_verifier_destroy(verifier);
  cellist_sorter_destroy(sorter);
}

/* What judges one mesh, in a way of its own. */
typedef void (*judge_mesh)(cellist_context *context, const cellist_mesh *mesh, judge_desc how);

/* Reads a mesh of the shared data (skips the case if it is not there) and judges it. */
static inline void judge_file(const char *name, judge_mesh judge, judge_desc how) {
  const char *path = shared_data(name);
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  judge(context, mesh, how);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

/* Judges every sample but that of flaws, whose cells fold and overlap on purpose. */
static inline void judge_samples(size_t size, judge_mesh judge, judge_desc how) {
  cellist_context *context = harness_context(2);
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    const char *name = cellist_generator_name(i);
    if (strcmp(name, "flaws") == 0) continue;
    cellist_mesh *mesh = judge_generate(context, name, size);
    print_message("%s\n", name);
    judge(context, mesh, how);
    cellist_mesh_destroy(mesh);
  }
  harness_context_destroy(context);
}

#endif
