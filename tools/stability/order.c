/* SPDX-License-Identifier: BSD-3-Clause
 * Order: a case's cells sorted for its eye, verified along rays and as a permutation. */
#include <cellist/sort.h>
#include <cellist/sort_verify.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../clock.h"
#include "stability.h"

enum { RAYS = 400, SEED = 5 };

/* The points with each axis scaled by a power of two so that the mesh is about as wide along all of them, and the eye
 * with them: what lies in front of what stays so, no bit is lost, and rays can tell thin layers apart. The caller's to
 * free. */
static double *widen(cellist_context *context, const cellist_mesh_arrays *arrays, cellist_viewpoint *viewpoint) {
  double *points = cellist_allocate(context, arrays->point_count, 3 * sizeof *points);
  for (size_t k = 0; k < 3 && points != NULL; k++) {
    const double width = arrays->bounds[3 + k] - arrays->bounds[k];
    int exponent = 0;
    if (width > 0 && isfinite(width)) frexp(width, &exponent);
    for (size_t i = 0; i < arrays->point_count; i++) points[3 * i + k] = ldexp(arrays->positions[3 * i + k], -exponent);
    viewpoint->position[k] = ldexp(viewpoint->position[k], -exponent);
  }
  return points;
}

static void judge(const stability_case *which, const cellist_certificate *certificate, stability_order *found) {
  const bool is_flawed = which->expectation == STABILITY_FINITE;
  found->verdict = STABILITY_FAILS;
  if (found->unsorted > 0)
    snprintf(found->message, sizeof found->message, "%zu cells are not in the order", found->unsorted);
  else if (found->inversions > 0 && !is_flawed)
    snprintf(found->message, sizeof found->message, "%zu of %zu pairs along rays are the wrong way round",
             found->inversions, found->pairs);
  else if (certificate->violations > 0 && !is_flawed)
    snprintf(found->message, sizeof found->message, "%zu of %zu shared faces have the nearer cell first",
             certificate->violations, certificate->faces);
  else
    found->verdict = STABILITY_PASSES;
}

cellist_result stability_sort(cellist_context *context, const stability_case *which, const stability_scene *scene,
                              stability_order *found) {
  *found = (stability_order){0};
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(scene->mesh);
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  cellist_viewpoint viewpoint = {.parallel = scene->view.parallel_height > 0};
  for (int k = 0; k < 3; k++)
    viewpoint.position[k] = viewpoint.parallel ? scene->view.target[k] - scene->view.eye[k] : scene->view.eye[k];
  cellist_sorter *sorter = NULL;
  cellist_verifier *verifier = NULL;
  cellist_sort_stats stats = {0};
  cellist_certificate certificate = {0};
  cellist_verification verification = {0};
  uint32_t *order = cellist_allocate(context, arrays->tet_count, sizeof *order);
  const double begin = clock_seconds();
  cellist_result result = order != NULL ? cellist_sorter_create(context, &desc, &sorter) : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) result = cellist_sorter_sort(sorter, &viewpoint, order, &stats);
  found->seconds = clock_seconds() - begin;
  found->groups = stats.group_count;
  found->largest_group = stats.largest_group;
  const cellist_group *groups = NULL;
  size_t group_count = 0;
  if (result == CELLIST_SUCCESS) cellist_sorter_groups(sorter, &groups, &group_count);
  if (result == CELLIST_SUCCESS)
    result = cellist_order_certify(context, &desc, &viewpoint, order, groups, group_count, &certificate);
  cellist_sorter_desc widened = desc;
  double *points = NULL;
  if (result == CELLIST_SUCCESS) {
    widened.points = points = widen(context, arrays, &viewpoint);
    result = points != NULL ? cellist_verifier_create(context, &widened, &verifier) : CELLIST_ERROR_OUT_OF_MEMORY;
  }
  if (result == CELLIST_SUCCESS)
    result = cellist_verifier_check(verifier, &viewpoint, order, groups, group_count, RAYS, SEED, &verification);
  found->rays = verification.ray_count;
  found->pairs = verification.pairs;
  found->inversions = verification.inversions;
  found->group_pairs = verification.group_pairs;
  found->overlaps = verification.overlaps;
  if (result == CELLIST_SUCCESS) {
    judge(which, &certificate, found);
  } else if (result != CELLIST_ERROR_OUT_OF_MEMORY) { /* not even a permutation, or refused */
    found->verdict = STABILITY_FAILS;
    snprintf(found->message, sizeof found->message, "%s", cellist_context_take_error(context));
    result = CELLIST_SUCCESS;
  }
  cellist_verifier_destroy(verifier);
  cellist_deallocate(context, points);
  cellist_sorter_destroy(sorter);
  cellist_deallocate(context, order);
  return result;
}
