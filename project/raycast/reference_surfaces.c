/* SPDX-License-Identifier: BSD-3-Clause
 * Surfaces: sharp isosurfaces and the maximum along a ray; both ask for the scalar at single places, not for integrals.
 *
 * A segment crosses an isosurface where one of its ends is below the value and the other is not. Neighbouring segments
 * share that end, so a surface through a vertex, an edge or a face is met once. A scalar per cell has no isosurfaces.
 */
#include <math.h>

#include "reference_shade.h"

/* Rounding of a colour looked up, lit, attenuated and added: 16 u. */
static const double COLOUR_ROUNDING = 16 * 0x1p-53;

/* Colour at a scalar, and how far it may be off if the scalar is. */
static double colour_at(const cellist_transfer *transfer, double scalar, double scalar_error, double colour[3]) {
  reference_pieces pieces;
  reference_piece piece;
  reference_pieces_begin(&pieces, transfer, scalar, scalar);
  (void)reference_pieces_next(&pieces, &piece);
  for (int k = 0; k < 3; k++) colour[k] = piece.colour[0][k];
  if (scalar_error == 0) return 0;
  double error = 0;
  reference_pieces_begin(&pieces, transfer, scalar - scalar_error, scalar + scalar_error);
  while (reference_pieces_next(&pieces, &piece))
    for (int k = 0; k < 3; k++)
      error = fmax(error, fmax(fabs(piece.colour[0][k] - colour[k]), fabs(piece.colour[1][k] - colour[k])));
  return error;
}

static void add_surface(shade_gathering *gathering, const walk_segment *segment, const cellist_isosurface *iso) {
  const shade_scene *scene = gathering->scene;
  const double *s = segment->scalar, w = (iso->value - s[0]) / (s[1] - s[0]);
  double colour[3], normal[3];
  (void)colour_at(scene->transfer, iso->value, 0, colour);
  if (scene->optics.light.enabled) {
    for (int k = 0; k < 3; k++) normal[k] = (1 - w) * segment->gradient[0][k] + w * segment->gradient[1][k];
    shade_lit_surface(scene, normal, colour, colour);
  }
  shade_pixel *pixel = &gathering->pixel;
  for (int k = 0; k < 3; k++) reference_sum_add(&gathering->colour[k], pixel->transmittance * iso->opacity * colour[k]);
  pixel->transmittance *= 1 - iso->opacity;
  gathering->colour_error += COLOUR_ROUNDING * scene->largest_colour;
  if (iso->opacity > 0) shade_contribute(gathering, segment, w, w);
}

/* A vertex of the scalar along the ray that rounding may have put on the wrong side of a surface, without the ray
 * passing it anyway: the surface may or may not be there. */
static void doubt_turn(shade_gathering *gathering, const walk_segment *segments, size_t count, size_t at) {
  for (int end = 0; end < 2; end++) {
    const walk_segment *segment = &segments[at];
    const double here = segment->scalar[end], error = segment->scalar_error;
    const size_t beyond = end == 0 ? at - 1 : at + 1;
    const bool is_alone = end == 0 ? at == 0 : beyond == count;
    const double inner = segment->scalar[1 - end], outer = is_alone ? inner : segments[beyond].scalar[end];
    if ((inner < here) != (outer < here)) continue; /* it rises or falls through */
    for (size_t i = 0; i < gathering->scene->optics.iso_count; i++)
      if (fabs(gathering->scene->isos[i].value - here) <= error)
        gathering->colour_error += gathering->scene->isos[i].opacity * fmax(1, gathering->scene->largest_colour);
  }
}

void shade_isosurfaces(shade_gathering *gathering, const walk_segment *segments, size_t count) {
  const shade_scene *scene = gathering->scene;
  const size_t iso_count = scene->optics.iso_count;
  for (size_t i = 0; i < count && gathering->pixel.transmittance > 0; i++) {
    const double *s = segments[i].scalar;
    gathering->pixel.segment_count++;
    doubt_turn(gathering, segments, count, i);
    for (size_t j = 0; j < iso_count; j++) {
      const cellist_isosurface *iso = &scene->isos[s[0] < s[1] ? j : iso_count - 1 - j];
      if ((s[0] < iso->value) != (s[1] < iso->value)) add_surface(gathering, &segments[i], iso);
    }
  }
  gathering->pixel.alpha = 1 - gathering->pixel.transmittance;
}

void shade_maximum(shade_gathering *gathering, const walk_segment *segments, size_t count) {
  double largest = -HUGE_VAL, error = 0, colour[3];
  for (size_t i = 0; i < count; i++) {
    gathering->pixel.segment_count++;
    for (int end = 0; end < 2; end++)
      if (segments[i].scalar[end] > largest) {
        largest = segments[i].scalar[end];
        gathering->pixel.z = gathering->pixel.z_back = segments[i].t[end];
      }
    error = fmax(error, segments[i].scalar_error);
  }
  if (count == 0) return;
  gathering->colour_error = colour_at(gathering->scene->transfer, largest, error, colour) +
                            COLOUR_ROUNDING * gathering->scene->largest_colour;
  for (int k = 0; k < 3; k++) reference_sum_add(&gathering->colour[k], colour[k]);
  gathering->pixel.alpha = 1;
}
