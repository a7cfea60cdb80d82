/* SPDX-License-Identifier: BSD-3-Clause
 * The transfer function as the shaders read it: a table of the intervals between its knots. Private. */
#ifndef CELLIST_GL_INTERVALS_H
#define CELLIST_GL_INTERVALS_H

#include <cellist/mesh.h>
#include <cellist/optics.h>
#include <cellist/transfer.h>

enum { GL_INTERVAL_FLOATS = 12 };

/* Scalars are shifted and scaled so that those of the mesh lie in -1..1: then float has the digits. */
typedef struct gl_scale {
  double offset, factor; /* scaled = (value - offset) * factor */
} gl_scale;

/* Interval i lies below knot i, above knot i-1; there is one more than knots. Isosurfaces take the place of knots. */
typedef struct gl_intervals {
  cellist_model model;
  size_t knot_count;
  float *knots;      /* [knot_count] scaled values */
  float *texels;     /* [GL_INTERVAL_FLOATS (knot_count + 1)] see exact.glsl and isosurfaces.glsl */
  uint32_t *visible; /* [knot_count + 1] how many of the knots before this one have extinction */
} gl_intervals;

gl_scale gl_scale_of(const cellist_scalar *scalar);

/* unit: of lengths (gl_cells). Fails with INVALID_ARGUMENT (no knots, out of order, not finite, negative extinction, an
 * isosurface's opacity out of range) or OUT_OF_MEMORY. */
cellist_result gl_intervals_make(cellist_context *context, const cellist_transfer *transfer,
                                 const cellist_optics *optics, gl_scale scale, double unit, gl_intervals *intervals);
void gl_intervals_release(cellist_context *context, gl_intervals *intervals);

/* The interval of a scaled value: a knot's own value belongs to the interval below it. */
static inline uint32_t gl_interval_of(const gl_intervals *intervals, float value) {
  size_t low = 0, high = intervals->knot_count;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (intervals->knots[middle] < value)
      low = middle + 1;
    else
      high = middle;
  }
  return (uint32_t)low;
}

/* Extinction, per unit, of a scaled value by the function that holds in an interval, and on to its ends outside. */
static inline float gl_intervals_extinction(const gl_intervals *intervals, uint32_t interval, float value) {
  const float *texel = &intervals->texels[GL_INTERVAL_FLOATS * (size_t)interval];
  const float at = (value - texel[0]) * texel[2];
  return texel[7] + (at > 0 ? at < 1 ? at : 1 : 0) * (texel[11] - texel[7]);
}

/* Whether anything of the scalars in the intervals first..last can be seen. */
static inline bool gl_intervals_show(const gl_intervals *intervals, uint32_t first, uint32_t last) {
  if (intervals->model == CELLIST_MODEL_MAXIMUM) return true;
  if (intervals->model == CELLIST_MODEL_ISOSURFACES) return first < last;
  const size_t begin = first > 0 ? first - 1 : 0;
  const size_t end = last < intervals->knot_count ? last + 1 : intervals->knot_count;
  return intervals->visible[end] > intervals->visible[begin];
}

#endif
