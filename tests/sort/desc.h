/* SPDX-License-Identifier: BSD-3-Clause
 * A mesh as the sorter takes it, for tests and benchmarks. */
#ifndef CELLIST_TESTS_SORT_DESC_H
#define CELLIST_TESTS_SORT_DESC_H

#include <cellist/mesh.h>
#include <cellist/sort.h>

/* The mesh must outlive what is made of it. */
static inline cellist_sorter_desc sorter_desc_of(const cellist_mesh *mesh) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  return (cellist_sorter_desc){.point_count = a->point_count,
                               .points = a->positions,
                               .tet_count = a->tet_count,
                               .tets = a->tets,
                               .neighbours = a->neighbours};
}

#endif
