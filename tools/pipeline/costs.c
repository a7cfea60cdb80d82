/* SPDX-License-Identifier: BSD-3-Clause
 * Costs: constants of every way to draw, fitted to what was measured on two cores of an AMD EPYC, OpenGL by llvmpipe.
 *
 * soft and fast cast: one thread, all shared meshes but can at 512 and 1024 pixels, whole and windows of them. The
 * others, and the errors: a report over the shared meshes at 512x512 (ramp, unit diagonal/50; light with a highlight,
 * which the reference integrates adaptively). On other machines the
 * seconds differ by a factor that is nearly the same for all, so the cheapest stays the cheapest. */
#include "costs.h"

#define CAST .renderer = CELLIST_RENDERER_CAST
#define SOFT .renderer = CELLIST_RENDERER_SOFT
#define FACES .renderer = CELLIST_RENDERER_FACES
#define REFERENCE .precision = CELLIST_PRECISION_REFERENCE
#define EVERY .draws_every_model = true
#define SHARP .draws_narrow_peaks = true
#define LIT(count) .is_lit = true, .samples = (count)

static const draw_cost COSTS[] = {
    {"cast fast", CAST, .error = 5e-6, .frame = 1e5, .tet = 16, .fragment = 7.0, .pixel = 9.6, .entry = 74},
    {"soft", SOFT, EVERY, SHARP, .error = 5e-7, .frame = 1e5, .tet = 104, .fragment = 7.9, .pixel = 7.4},
    {"faces", FACES, EVERY, .error = 5e-7, .frame = 5e6, .tet = 900, .fragment = 22, .pixel = 30},
    {"cast reference", CAST, REFERENCE, EVERY, SHARP, .error = 1e-12, .fragment = 165, .pixel = 360, .entry = 2000},
    {"lit soft", SOFT, EVERY, SHARP, LIT(1), .error = 1.5e-3, .frame = 1e5, .tet = 120, .fragment = 12, .pixel = 10},
    {"lit soft, 4 samples", SOFT, EVERY, SHARP, LIT(4), .error = 1.5e-4, .frame = 1e5, .tet = 120, .fragment = 35,
     .pixel = 10},
    {"lit faces", FACES, EVERY, LIT(1), .error = 3e-4, .frame = 5e6, .tet = 1500, .fragment = 80, .pixel = 40},
    {"lit faces, 2 samples", FACES, EVERY, LIT(2), .error = 1e-4, .frame = 5e6, .tet = 1500, .fragment = 100,
     .pixel = 40},
    {"lit faces, 3 samples", FACES, EVERY, LIT(3), .error = 6e-5, .frame = 5e6, .tet = 1500, .fragment = 125,
     .pixel = 40},
    {"lit faces, 4 samples", FACES, EVERY, LIT(4), .error = 4e-5, .frame = 5e6, .tet = 1500, .fragment = 150,
     .pixel = 40},
    {"lit cast reference", CAST, REFERENCE, EVERY, SHARP, LIT(0), .error = 1e-10, .fragment = 3500, .pixel = 330,
     .entry = 2500},
};

/* Of a frame, whatever the number of threads: sorting tiles, merging, reading back, and what two threads of one core
 * take from each other. */
static const double SERIAL_PART = 0.3;

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
  /* A ray that goes from tet to tet enters anew behind each boundary face that it meets from outside. */
  const double entries = counts->tets > 0 ? counts->fragments * counts->boundary_faces / (4 * counts->tets) : 0;
  const double one = cost->frame + cost->tet * counts->tets + cost->fragment * counts->fragments +
                     cost->pixel * counts->pixels + cost->entry * entries;
  return 1e-9 * one * (SERIAL_PART + (1 - SERIAL_PART) / (threads > 0 ? threads : 1));
}
