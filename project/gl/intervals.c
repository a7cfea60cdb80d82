/* SPDX-License-Identifier: BSD-3-Clause
 * Intervals of the transfer function. Outside the knots it is constant: the first and the last interval have equal
 * ends and a slope of 0, so the shaders need no special case. */
#include "intervals.h"

#include <math.h>
#include <string.h>

/* Knots further out than this many scalar ranges are as good as infinitely far, and their squares still fit a float. */
static const double FAR_VALUE = 1e18;
/* Per unit: nothing is seen through any of it, and what it is multiplied with fits a float. */
static const double MOST_EXTINCTION = 1e30;

gl_scale gl_scale_of(const cellist_scalar *scalar) {
  const double half_range = 0.5 * scalar->maximum - 0.5 * scalar->minimum;
  return (gl_scale){.offset = 0.5 * scalar->minimum + 0.5 * scalar->maximum,
                    .factor = half_range > 0 ? 1 / half_range : 1};
}

/* Isosurfaces lie this much of the scalar's half range lower: a region that holds their very value is above them then,
 * up to its rim, as in every renderer. Below rounding: it is above and below by turns; larger: surfaces move. */
static const float BELOW = 4e-7F;

void gl_intervals_release(cellist_context *context, gl_intervals *intervals) {
  cellist_deallocate(context, intervals->knots);
  cellist_deallocate(context, intervals->texels);
  cellist_deallocate(context, intervals->visible);
  *intervals = (gl_intervals){0};
}

static float scaled(gl_scale scale, double value) {
  return (float)fmax(fmin((value - scale.offset) * scale.factor, FAR_VALUE), -FAR_VALUE);
}

static void write_end(const cellist_transfer_knot *knot, bool black, double unit, float texel[4]) {
  for (int c = 0; c < 3; c++) texel[c] = black ? 0 : (float)knot->colour[c];
  texel[3] = (float)fmin(knot->extinction * unit, MOST_EXTINCTION);
}

static void write_intervals(const cellist_transfer *transfer, bool black, gl_scale scale, double unit,
                            gl_intervals *made) {
  const size_t count = transfer->knot_count;
  made->visible[0] = 0;
  for (size_t i = 0; i < count; i++) {
    made->knots[i] = scaled(scale, transfer->knots[i].value);
    made->visible[i + 1] = made->visible[i] + (transfer->knots[i].extinction > 0);
  }
  for (size_t i = 0; i <= count; i++) {
    float *texel = &made->texels[GL_INTERVAL_FLOATS * i];
    const size_t below = i > 0 ? i - 1 : 0, above = i < count ? i : count - 1;
    texel[0] = i > 0 ? made->knots[below] : -(float)FAR_VALUE;
    texel[1] = i < count ? made->knots[above] : (float)FAR_VALUE;
    texel[2] = below < above && texel[1] > texel[0] ? 1 / (texel[1] - texel[0]) : 0;
    texel[3] = 0;
    write_end(&transfer->knots[below], black, unit, &texel[4]);
    write_end(&transfer->knots[above], black, unit, &texel[8]);
  }
}

/* In ascending order of value; of equal ones in the caller's order. */
static cellist_result write_isosurfaces(cellist_context *context, const cellist_transfer *transfer,
                                        const cellist_optics *optics, gl_scale scale, gl_intervals *made) {
  for (size_t i = 0; i < optics->iso_count; i++) {
    const cellist_isosurface *iso = &optics->isos[i];
    if (!isfinite(iso->value) || !(iso->opacity >= 0 && iso->opacity <= 1))
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "isosurface %zu has the value %g and the opacity %g, which must lie in 0..1", i, iso->value,
                          iso->opacity);
    size_t at = i;
    const float value = scaled(scale, iso->value) - BELOW;
    for (; at > 0 && made->knots[at - 1] > value; at--) {
      made->knots[at] = made->knots[at - 1];
      memcpy(&made->texels[8 * at], &made->texels[8 * (at - 1)], 8 * sizeof(float));
    }
    double colour[3];
    cellist_transfer_evaluate(transfer, iso->value, colour);
    made->knots[at] = value;
    const float texels[8] = {value, 0, 0, 0, (float)colour[0], (float)colour[1], (float)colour[2], (float)iso->opacity};
    memcpy(&made->texels[8 * at], texels, sizeof texels);
  }
  return CELLIST_SUCCESS;
}

cellist_result gl_intervals_make(cellist_context *context, const cellist_transfer *transfer,
                                 const cellist_optics *optics, gl_scale scale, double unit, gl_intervals *intervals) {
  cellist_result result = cellist_transfer_check(context, transfer);
  if (result != CELLIST_SUCCESS) return result;
  const bool surfaces = optics->model == CELLIST_MODEL_ISOSURFACES;
  if (surfaces && optics->iso_count > 0 && optics->isos == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the isosurfaces are NULL");
  gl_intervals made = {.model = optics->model, .knot_count = surfaces ? optics->iso_count : transfer->knot_count};
  made.knots = cellist_allocate(context, made.knot_count, sizeof *made.knots);
  made.texels = cellist_allocate_zeroed(context, made.knot_count + 1, GL_INTERVAL_FLOATS * sizeof *made.texels);
  made.visible = cellist_allocate_zeroed(context, made.knot_count + 1, sizeof *made.visible);
  if (made.knots == NULL || made.texels == NULL || made.visible == NULL)
    result = CELLIST_ERROR_OUT_OF_MEMORY;
  else if (surfaces)
    result = write_isosurfaces(context, transfer, optics, scale, &made);
  else
    write_intervals(transfer, optics->model == CELLIST_MODEL_ABSORPTION, scale, unit, &made);
  if (result == CELLIST_SUCCESS)
    *intervals = made;
  else
    gl_intervals_release(context, &made);
  return result;
}
