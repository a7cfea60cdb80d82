/* SPDX-License-Identifier: BSD-3-Clause
 * A complex as the sorter takes it, for tests and benchmarks. */
#ifndef CELLIST_TESTS_CHAIN_COMPLEX_H
#define CELLIST_TESTS_CHAIN_COMPLEX_H

#include <cellist/convexify.h>
#include <cellist/sort.h>

static inline cellist_sorter_complex sorter_complex_of(const cellist_complex *complex) {
  const cellist_complex_arrays *c = cellist_complex_get_arrays(complex);
  return (cellist_sorter_complex){c->cell_count,  c->point_count, c->points,      c->offset_count, c->offsets,
                                  c->plane_count, c->planes,      c->facet_count, c->facet_planes, c->facet_cells};
}

#endif
