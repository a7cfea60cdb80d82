/* SPDX-License-Identifier: BSD-3-Clause
 * Budget: what reports measured, kept as constants, so that a choice repeats on any machine.
 *
 * Error: the worst root mean square of a setting over the sound real meshes of a report at 512x512 (ramp, unit
 * diagonal/50). Seconds of a frame on one thread: fixed + tets x tet + fragments x fragment, fitted to the same rows;
 * on n threads all but a tenth is shared. On other machines seconds differ by a factor that is nearly the same for all
 * settings, so the cheapest stays the cheapest; --time then means seconds of the machine that was measured (AMD EPYC,
 * OpenGL by llvmpipe). */
#include "budget.h"

#include <math.h>

struct figures {
  const char *name;
  cellist_renderer renderer;
  cellist_precision precision;
  bool is_lit, draws_every_model;
  double error, fixed, tet, fragment; /* seconds */
};

static const struct figures FIGURES[] = {
    {"cast fast", CELLIST_RENDERER_CAST, CELLIST_PRECISION_FAST, false, false, 5e-6, 2e-3, 15e-9, 9e-9},
    {"soft", CELLIST_RENDERER_SOFT, CELLIST_PRECISION_FAST, false, true, 5e-7, 1e-3, 120e-9, 12e-9},
    {"faces", CELLIST_RENDERER_FACES, CELLIST_PRECISION_FAST, false, true, 5e-7, 20e-3, 800e-9, 60e-9},
    {"cast reference", CELLIST_RENDERER_CAST, CELLIST_PRECISION_REFERENCE, false, true, 1e-12, 1e-3, 10e-9, 95e-9},
    {"lit faces", CELLIST_RENDERER_FACES, CELLIST_PRECISION_FAST, true, true, 5e-7, 20e-3, 900e-9, 90e-9},
    {"lit cast reference", CELLIST_RENDERER_CAST, CELLIST_PRECISION_REFERENCE, true, true, 1e-10, 1e-3, 10e-9, 300e-9},
};
enum { FIGURE_COUNT = sizeof FIGURES / sizeof FIGURES[0] };

static const double SERIAL_PART = 0.1; /* of a frame: sorting's traversal, merging tiles, reading back */

static double seconds_of(const struct figures *f, double tets, double fragments, unsigned threads) {
  const double one = f->fixed + f->tet * tets + f->fragment * fragments;
  return one * (SERIAL_PART + (1 - SERIAL_PART) / (threads > 0 ? threads : 1));
}

/* Whether a setting draws what the optics ask for, as the one that was measured. */
static bool draws(const struct figures *f, const cellist_optics *optics) {
  const bool is_usual = optics->model == CELLIST_MODEL_EMISSION_ABSORPTION || optics->model == CELLIST_MODEL_ABSORPTION;
  return f->is_lit == optics->light.enabled && (is_usual || f->draws_every_model);
}

bool budget_choose(const cellist_mesh *mesh, const cellist_frame *frame, double error, double seconds, unsigned threads,
                   cellist_pipeline_desc *desc, budget_choice *choice) {
  const double tets = (double)cellist_mesh_get_arrays(mesh)->tet_count;
  const double fragments = cellist_pipeline_estimate_fragments(mesh, frame);
  const struct figures *best = NULL, *closest = NULL, *fastest = NULL;
  for (size_t i = 0; i < FIGURE_COUNT; i++) {
    const struct figures *f = &FIGURES[i];
    if (!draws(f, &desc->optics.model)) continue;
    const double takes = seconds_of(f, tets, fragments, threads);
    if (closest == NULL || f->error < closest->error) closest = f;
    if (fastest == NULL || takes < seconds_of(fastest, tets, fragments, threads)) fastest = f;
    const bool is_allowed = error > 0 ? f->error <= error : takes <= seconds;
    if (!is_allowed) continue;
    const bool is_better =
        best == NULL || (error > 0 ? takes < seconds_of(best, tets, fragments, threads) : f->error < best->error);
    if (is_better) best = f;
  }
  const bool is_met = best != NULL;
  if (!is_met) best = error > 0 ? closest : fastest;
  desc->renderer = best->renderer;
  desc->precision = best->precision;
  desc->framebuffer = CELLIST_FRAMEBUFFER_32F;
  desc->optics.model.integration = CELLIST_INTEGRATION_EXACT;
  *choice = (budget_choice){best->name, best->error, seconds_of(best, tets, fragments, threads)};
  return is_met;
}
