/* SPDX-License-Identifier: BSD-3-Clause
 * Fast walk: the rays of one tile through the mesh, from the entries that were found for them. Private.
 *
 * A step: fetch the cell's apex as the ray sees it; three determinants say on which side of the ray the apex lies from
 * each of the entry face's corners; the ray leaves through the face that holds the apex and those two corners between
 * which the far side of the apex lies (algorithm 1 of [A], with all three signs instead of two); two of the
 * determinants and one from before are the weights of that face's corners, which give depth and scalar there.
 *
 * Of the eight combinations of three signs, two (all alike) have no exit: then rounding has moved the ray out of the
 * cell. That pixel is given up and cast by other means, as is one whose ray runs within a face. In all others there is
 * exactly one exit, and the edges of the exit face have just the signs that the next cell expects. So a walk enters and
 * leaves each cell at most once, as in reference_walk.c, and ends after as many steps as the mesh has cells, whatever
 * the mesh. */
#ifndef CELLIST_RAYCAST_FAST_WALK_H
#define CELLIST_RAYCAST_FAST_WALK_H

#include "fast_entries.h"

/* An entry nearer than the last exit by more than this (of half the bounds' diagonal, per unit of depth) shows that
 * cells overlap. Smaller: rounding is reported as a fold; larger: small folds are not. Only a count depends on it. */
#define FAST_FOLD_TOLERANCE 1e-4f

/* Fills the tile's pixels that have entries, lists those whose rays got lost, and counts. Never fails. */
typedef void (*fast_walk)(const fast_scene *scene, fast_tile *tile);

void fast_walk_portable(const fast_scene *scene, fast_tile *tile);

#if defined(CELLIST_FAST_AVX2)
/* Call only if __builtin_cpu_supports("avx2") and "fma". */
void fast_walk_avx2(const fast_scene *scene, fast_tile *tile);
#endif

#endif
