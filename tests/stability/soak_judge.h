/* SPDX-License-Identifier: BSD-3-Clause
 * Soak judge: whether a picture of a soak's scene is the reference's. */
#ifndef CELLIST_TESTS_SOAK_JUDGE_H
#define CELLIST_TESTS_SOAK_JUDGE_H

#include "soak_scene.h"

enum { SOAK_REASON = 512, SOAK_KIND = 40, SOAK_KINDS = 32 };

/* Pictures with one limit. */
typedef struct soak_kind {
  char name[SOAK_KIND];
  uint64_t scenes;
  /* In parts of a picture's largest value: how far a pixel may be off, and the largest that was found beyond what
   * moved rays and blending explain. */
  double limit, worst;
  double most_strays; /* largest share of a picture's pixels that were further off and may be */
} soak_kind;

/* What was looked at so far. */
typedef struct soak_totals {
  uint64_t scenes, failures, refused, repeated, pairs, pixels, shifted_pixels;
  size_t kind_count;
  soak_kind kinds[SOAK_KINDS];
} soak_totals;

/* Fills reason if `drawn` is not what `reference`, by `caster` for the same view, says within what the scene's settings
 * allow. The caster may be asked for more pictures. Errors: those of drawing. */
cellist_result soak_judge(cellist_context *context, cellist_pipeline *caster, const soak_scene *scene,
                          const cellist_view *view, const cellist_image *drawn, const cellist_image *reference,
                          soak_totals *totals, char reason[SOAK_REASON]);

/* Fills reason if two pictures differ in a bit. */
void soak_judge_same(const soak_scene *scene, const cellist_image *a, const cellist_image *b, char reason[SOAK_REASON]);

#endif
