/* SPDX-License-Identifier: BSD-3-Clause
 * Shade: what a pixel gathers from the segments of its ray. Private to the reference caster. */
#ifndef CELLIST_RAYCAST_REFERENCE_SHADE_H
#define CELLIST_RAYCAST_REFERENCE_SHADE_H

#include <cellist/optics.h>
#include <cellist/transfer.h>
#include <cellist/view.h>
#include <optics/reference_integral.h>

#include "reference_walk.h"

/* The optics of one picture, ready for its pixels. */
typedef struct shade_scene {
  const cellist_transfer *transfer;
  cellist_optics optics;
  cellist_isosurface *isos;    /* [optics.iso_count] ascending; belongs to the scene */
  double light[3], halfway[3]; /* unit vectors; halfway is 0 if the light stands exactly behind the scene */
  double largest_colour;       /* of any knot, in any channel */
  bool has_steps;              /* two knots of one value */
} shade_scene;

cellist_result shade_begin(cellist_context *context, const cellist_optics *optics, const cellist_transfer *transfer,
                           const cellist_frame *frame, shade_scene *scene);
void shade_end(cellist_context *context, shade_scene *scene);

typedef struct shade_pixel {
  double colour[3]; /* premultiplied */
  double transmittance, alpha;
  double z, z_back;
  double error;           /* bound of colour and alpha; infinity if none is known */
  uint32_t segment_count; /* pieces that were integrated */
} shade_pixel;

/* segments: in order; length_per_t: |direction|. */
shade_pixel shade_segments(const shade_scene *scene, const walk_segment *segments, size_t count, double length_per_t);

/* ---- Between the files that shade ------------------------------------------------------------------- */

/* What has been gathered from the nearer segments. */
typedef struct shade_gathering {
  const shade_scene *scene;
  double length_per_t;
  shade_pixel pixel;
  reference_sum colour[3], depth; /* depth: optical */
  double transmittance;           /* exp(-depth); 1 if nothing is absorbed */
  double colour_error, depth_error;
} shade_gathering;

/* Notes that the segment contributes between two places, 0..1 along it. */
void shade_contribute(shade_gathering *gathering, const walk_segment *segment, double begin, double end);

/* Adds the light of one piece of a lit segment, seen through the transmittance of what lies before it. */
void shade_lit_piece(shade_gathering *gathering, const walk_segment *segment, const reference_piece *piece,
                     double length, double transmittance);

/* A surface's colour under the scene's light: normal is any vector along the gradient, 0 if there is none. */
void shade_lit_surface(const shade_scene *scene, const double normal[3], const double colour[3], double lit[3]);

void shade_isosurfaces(shade_gathering *gathering, const walk_segment *segments, size_t count);
void shade_maximum(shade_gathering *gathering, const walk_segment *segments, size_t count);

#endif
