/* SPDX-License-Identifier: BSD-3-Clause
 * Costs: constants of every way to draw, fitted to what was measured on two cores of an AMD EPYC, OpenGL by llvmpipe.
 *
 * soft and fast cast: tests/bench/bench_soft on one thread, all shared meshes but can at 512 and 1024 pixels. The
 * others, and the errors: a report over the shared meshes at 512x512 (ramp, unit diagonal/50). On other machines the
 * seconds differ by a factor that is nearly the same for all, so the cheapest stays the cheapest. */
#include "costs.h"

static const draw_cost COSTS[] = {
    {"cast fast", CELLIST_RENDERER_CAST, CELLIST_PRECISION_FAST, false, false, 5e-6, 1e5, 16, 6.8, 42, 137},
    {"soft", CELLIST_RENDERER_SOFT, CELLIST_PRECISION_FAST, false, true, 5e-7, 1e5, 123, 9.5, 10.5, 0},
    {"faces", CELLIST_RENDERER_FACES, CELLIST_PRECISION_FAST, false, true, 5e-7, 20e6, 800, 60, 0, 0},
    {"cast reference", CELLIST_RENDERER_CAST, CELLIST_PRECISION_REFERENCE, false, true, 1e-12, 1e6, 10, 95, 0, 0},
    {"lit soft", CELLIST_RENDERER_SOFT, CELLIST_PRECISION_FAST, true, true, 1e-4, 1e6, 150, 30, 10.5, 0},
    {"lit faces", CELLIST_RENDERER_FACES, CELLIST_PRECISION_FAST, true, true, 5e-7, 20e6, 900, 90, 0, 0},
    {"lit cast reference", CELLIST_RENDERER_CAST, CELLIST_PRECISION_REFERENCE, true, true, 1e-10, 1e6, 10, 300, 0, 0},
};

/* Of a frame, whatever the number of threads: sorting tiles, merging, reading back. */
static const double SERIAL_PART = 0.1;

const draw_cost *draw_costs(size_t *count) {
  *count = sizeof COSTS / sizeof COSTS[0];
  return COSTS;
}

const draw_cost *draw_cost_of(cellist_renderer renderer, cellist_precision precision) {
  const draw_cost *cost = COSTS;
  while (cost->renderer != renderer || cost->precision != precision || cost->is_lit) cost++;
  return cost;
}

double draw_cost_seconds(const draw_cost *cost, const draw_counts *counts, unsigned threads) {
  const double one = cost->frame + cost->tet * counts->tets + cost->fragment * counts->fragments +
                     cost->pixel * counts->pixels + cost->boundary_face * counts->boundary_faces;
  return 1e-9 * one * (SERIAL_PART + (1 - SERIAL_PART) / (threads > 0 ? threads : 1));
}
