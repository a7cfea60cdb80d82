/* SPDX-License-Identifier: BSD-3-Clause
 * Fails a case whose complex has a fault that faults.h counts. */
#ifndef CELLIST_TESTS_CHECK_FAULTS_H
#define CELLIST_TESTS_CHECK_FAULTS_H

#include "faults.h"
#include "harness.h"

static inline void check_faults(const cellist_complex *complex, const cellist_mesh *mesh, int rays, uint64_t seed) {
  const ray_faults faults = count_ray_faults(complex, mesh, rays, seed);
  if (faults.gaps + faults.overlaps > 0)
    fail_msg("%d lines of seed %llu: %zu gaps, %zu overlaps, up to %g of the extent", rays, (unsigned long long)seed,
             faults.gaps, faults.overlaps, faults.largest);
  assert_true(faults.crossed > 0);
  const size_t facets = count_facet_faults(complex, mesh);
  if (facets > 0) fail_msg("%zu facets are not between two cells or on the hull", facets);
}

#endif
