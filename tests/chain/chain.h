/* SPDX-License-Identifier: BSD-3-Clause
 * Meshes with complexes of every exterior, for the tests of the whole chain. */
#ifndef CELLIST_TESTS_CHAIN_H
#define CELLIST_TESTS_CHAIN_H

#include "../sort/judge.h"
#include "complex.h"

enum { EXTERIORS = 4 };

/* A sorter of a mesh with a complex, which both live as long as this. */
typedef struct chain {
  cellist_complex *complex;
  cellist_sorter_complex arrays;
  cellist_sorter_desc desc;
  cellist_sorter *sorter;
} chain;

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

#endif
