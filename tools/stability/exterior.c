/* SPDX-License-Identifier: BSD-3-Clause
 * Exterior: a case's mesh convexified in each way. What comes out is a valid complex, or an error that says which
 * cells are to blame. */
#include <stdio.h>
#include <string.h>

#include "../clock.h"
#include "stability.h"

#ifdef CELLIST_HAS_CONVEXIFY
#include <cellist/convexify.h>

/* Volumes are sums of doubles; whatever the cells, they may be off by some hundred roundings of the hull's volume, and
 * a mesh far from the origin by as many of its coordinates. A missing cell is more than this. */
static const double VOLUME_LIMIT = 1e-9;

const char *stability_exterior_name(unsigned exterior) {
  static const char *const names[STABILITY_EXTERIOR_COUNT] = {
      [CELLIST_EXTERIOR_HULL] = "hull",
      [CELLIST_EXTERIOR_BOX] = "box",
      [CELLIST_EXTERIOR_GRID] = "grid",
      [CELLIST_EXTERIOR_DELAUNAY] = "delaunay",
  };
  return exterior < STABILITY_EXTERIOR_COUNT ? names[exterior] : NULL;
}

cellist_result stability_convexify(cellist_context *context, const stability_scene *scene, unsigned exterior,
                                   stability_exterior *found) {
  *found = (stability_exterior){0};
  const cellist_convexify_desc desc = {.exterior = (cellist_exterior)exterior, .seed = 1};
  cellist_convexify_stats stats = {0};
  cellist_complex *complex = NULL;
  const double begin = clock_seconds();
  const cellist_result result = cellist_convexify(context, scene->mesh, &desc, &complex, &stats);
  found->seconds = clock_seconds() - begin;
  found->imaginary_cells = stats.imaginary_cells;
  found->volume_error = stats.volume_error;
  found->verdict = STABILITY_FAILS;
  if (result == CELLIST_ERROR_OUT_OF_MEMORY) return result;
  if (result != CELLIST_SUCCESS) {
    const char *message = cellist_context_take_error(context);
    snprintf(found->message, sizeof found->message, "%s", message);
    if (result == CELLIST_ERROR_GEOMETRY && strstr(message, "cell") != NULL) found->verdict = STABILITY_REFUSED;
    return CELLIST_SUCCESS;
  }
  if (stats.convexity_violations > 0)
    snprintf(found->message, sizeof found->message, "%zu reflex edges are left", stats.convexity_violations);
  else if (!(stats.volume_error <= VOLUME_LIMIT))
    snprintf(found->message, sizeof found->message, "volumes are off by %.1e of the hull", stats.volume_error);
  else if (!cellist_complex_is_valid(context, complex, scene->mesh))
    snprintf(found->message, sizeof found->message, "not valid: %s", cellist_context_take_error(context));
  else
    found->verdict = STABILITY_PASSES;
  cellist_complex_destroy(complex);
  return CELLIST_SUCCESS;
}

#else

const char *stability_exterior_name(unsigned exterior) {
  (void)exterior;
  return NULL;
}

cellist_result stability_convexify(cellist_context *context, const stability_scene *scene, unsigned exterior,
                                   stability_exterior *found) {
  (void)scene, (void)exterior;
  *found = (stability_exterior){.verdict = STABILITY_REFUSED};
  return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "this build has no convexifier");
}

#endif
