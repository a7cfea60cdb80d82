/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes with complexes of every exterior, for the tests of the whole chain. */
#ifndef CELLIST_TESTS_CHAIN_H
#define CELLIST_TESTS_CHAIN_H

#include <cellist/convexify.h>
#include <cellist/generate.h>
#include <cellist/sort_verify.h>

#include "../sort/scene.h"

enum { EXTERIORS = 4 };

/* A sorter of a mesh with a complex, which both live as long as this. */
typedef struct chain {
  cellist_complex *complex;
  cellist_sorter_complex arrays;
  cellist_sorter_desc desc;
  cellist_sorter *sorter;
} chain;

static inline cellist_sorter_complex sorter_complex_of(const cellist_complex *complex) {
  const cellist_complex_arrays *c = cellist_complex_get_arrays(complex);
  return (cellist_sorter_complex){c->cell_count,  c->point_count, c->points,      c->offset_count, c->offsets,
                                  c->plane_count, c->planes,      c->facet_count, c->facet_planes, c->facet_cells};
}

static inline chain *chain_create(cellist_context *context, const cellist_mesh *mesh, int exterior) {
  chain *made = calloc(1, sizeof *made);
  const cellist_convexify_desc desc = {.exterior = (cellist_exterior)exterior};
  assert_success(context, cellist_convexify(context, mesh, &desc, &made->complex, NULL));
  made->arrays = sorter_complex_of(made->complex);
  made->desc = sorter_desc_of(mesh);
  made->desc.complex = &made->arrays;
  assert_success(context, cellist_sorter_create(context, &made->desc, &made->sorter));
  return made;
}

static inline void chain_destroy(chain *made) {
  cellist_sorter_destroy(made->sorter);
  cellist_complex_destroy(made->complex);
  free(made);
}

/* A view of a mesh: of kind 0 to 5 as scene_view. */
static inline cellist_viewpoint bounds_view(const double bounds[6], unsigned i) {
  random_state random = {i};
  cellist_viewpoint view = scene_view(i, 1, &random);
  for (int k = 0; k < 3 && !view.parallel; k++)
    view.position[k] = bounds[k] + view.position[k] * (bounds[3 + k] - bounds[k]);
  return view;
}

/* Sorts from view_count views and casts rays in each; fails the case on an inversion. */
static inline void chain_check(cellist_context *context, const cellist_mesh *mesh, int exterior, unsigned view_count,
                               size_t ray_count, bool groups_allowed) {
  chain *made = chain_create(context, mesh, exterior);
  cellist_verifier *verifier = NULL;
  assert_success(context, cellist_verifier_create(context, &made->desc, &verifier));
  uint32_t *order = calloc(made->desc.tet_count + 1, sizeof *order);
  for (unsigned i = 0; i < view_count; i++) {
    const cellist_viewpoint view = bounds_view(cellist_mesh_get_arrays(mesh)->bounds, i);
    cellist_sort_stats stats;
    assert_success(context, cellist_sorter_sort(made->sorter, &view, order, &stats));
    const cellist_group *groups = NULL;
    size_t group_count = 0;
    cellist_sorter_groups(made->sorter, &groups, &group_count);
    cellist_verification found;
    cellist_certificate certificate;
    assert_success(context, cellist_verifier_check(verifier, &view, order, groups, group_count, ray_count, i, &found));
    assert_success(context,
                   cellist_order_certify(context, &made->desc, &view, order, groups, group_count, &certificate));
    assert_true(stats.exact && found.ray_count > ray_count / 2);
    assert_int_equal(found.inversions, 0);
    assert_int_equal(certificate.violations, 0);
    if (!groups_allowed) assert_int_equal(group_count, 0);
  }
  free(order);
  cellist_verifier_destroy(verifier);
  chain_destroy(made);
}

#endif
