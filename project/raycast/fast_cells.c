/* SPDX-License-Identifier: BSD-3-Clause
 * Fast cells: packs the mesh's cells into one of the layouts. */
#include "fast_cells.h"

struct pack {
  const cellist_mesh_arrays *mesh;
  const fast_cells *cells;
};

/* The vertex of tet `other` that is not a vertex of the face of tet opposite to its corner k. */
static uint32_t apex_behind(const cellist_mesh_arrays *mesh, size_t tet, int k, uint32_t other) {
  const uint32_t *v = &mesh->tets[4 * tet], *u = &mesh->tets[4 * (size_t)other];
  return u[0] ^ u[1] ^ u[2] ^ u[3] ^ v[0] ^ v[1] ^ v[2] ^ v[3] ^ v[k];
}

static void pack_one(const cellist_mesh_arrays *mesh, fast_layout layout, size_t tet, uint32_t *words) {
  const uint32_t *v = &mesh->tets[4 * tet], *neighbours = &mesh->neighbours[4 * tet];
  uint32_t sorted[4], apex[4]; /* neighbours and what lies behind them, by the rank of the vertex opposite */
  for (int k = 0; k < 4; k++) {
    const int rank = (v[0] < v[k]) + (v[1] < v[k]) + (v[2] < v[k]) + (v[3] < v[k]);
    sorted[rank] = neighbours[k];
    apex[rank] = neighbours[k] == CELLIST_NONE ? 0 : apex_behind(mesh, tet, k, neighbours[k]);
  }
  const uint32_t all = v[0] ^ v[1] ^ v[2] ^ v[3];
  switch (layout) {
    case FAST_RANKED:
      for (int r = 0; r < 4; r++) {
        words[2 * r] = sorted[r];
        words[2 * r + 1] = apex[r];
      }
      break;
    case FAST_TET32:
      for (int k = 0; k < 4; k++) {
        words[k] = k < 3 ? v[k] : all;
        words[4 + k] = neighbours[k];
      }
      break;
    case FAST_TET20:
      words[0] = all;
      for (int r = 0; r < 4; r++) words[1 + r] = sorted[r];
      break;
    default:
      words[0] = all;
      for (int r = 1; r < 4; r++) words[r] = sorted[0] ^ sorted[r];
  }
}

static void pack_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct pack *pack = user;
  const fast_layout layout = pack->cells->layout;
  for (size_t tet = begin; tet < end; tet++)
    pack_one(pack->mesh, layout, tet, &pack->cells->words[FAST_CELL_SIZE[layout] / 4 * tet]);
}

cellist_result fast_cells_create(cellist_context *context, const cellist_mesh_arrays *mesh, fast_layout layout,
                                 fast_cells *made) {
  fast_cells cells = {layout, mesh->tet_count, NULL};
  cells.words = cellist_allocate(context, mesh->tet_count, FAST_CELL_SIZE[layout]);
  if (cells.words == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  struct pack pack = {mesh, &cells};
  cellist_parallel_for(context, mesh->tet_count, 8192, pack_range, &pack);
  *made = cells;
  return CELLIST_SUCCESS;
}

void fast_cells_release(cellist_context *context, fast_cells *cells) {
  cellist_deallocate(context, cells->words);
  *cells = (fast_cells){0};
}
