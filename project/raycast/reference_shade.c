/* SPDX-License-Identifier: BSD-3-Clause
 * Shade: the optical models over a ray's segments, each piece between two knots in closed form. */
#include "reference_shade.h"

#include <math.h>
#include <optics/reference_integral.h>

/* exp(-x) is 0 in double from 746 on: what lies behind cannot show. */
static const double OPAQUE_DEPTH = 750;

struct gathering {
  shade_pixel pixel;
  reference_sum colour[3], depth; /* depth: optical */
};

static void contribute(struct gathering *gathering, const walk_segment *segment, const reference_piece *piece) {
  const double extent = segment->t[1] - segment->t[0];
  if (isinf(gathering->pixel.z)) gathering->pixel.z = segment->t[0] + piece->begin * extent;
  gathering->pixel.z_back = segment->t[0] + piece->end * extent;
}

static void gather_attenuated(struct gathering *gathering, const walk_segment *segment, const reference_piece *piece,
                              double length, bool emits) {
  const double so_far = reference_sum_value(&gathering->depth);
  if (so_far > OPAQUE_DEPTH) return;
  double front, back;
  const double depth =
      reference_piece_weights(piece->extinction[0] * length, piece->extinction[1] * length, &front, &back);
  if (!(depth > 0)) return;
  const double transmittance = exp(-so_far);
  for (int k = 0; k < 3 && emits; k++)
    reference_sum_add(&gathering->colour[k],
                      transmittance * (front * piece->colour[0][k] + back * piece->colour[1][k]));
  reference_sum_add(&gathering->depth, depth);
  contribute(gathering, segment, piece);
}

/* The integral of the product of two linear functions. */
static void gather_emission(struct gathering *gathering, const walk_segment *segment, const reference_piece *piece,
                            double length) {
  const double a = piece->extinction[0] * length, b = piece->extinction[1] * length;
  if (!(a + b > 0)) return;
  for (int k = 0; k < 3; k++) {
    const double c = piece->colour[0][k], d = piece->colour[1][k];
    reference_sum_add(&gathering->colour[k], (a * (2 * c + d) + b * (c + 2 * d)) / 6);
  }
  contribute(gathering, segment, piece);
}

shade_pixel shade_segments(const cellist_optics *optics, const cellist_transfer *transfer, const walk_segment *segments,
                           size_t count, double length_per_t) {
  struct gathering gathering = {.pixel = {.z = HUGE_VAL}};
  for (size_t i = 0; i < count; i++) {
    const walk_segment *segment = &segments[i];
    reference_pieces pieces;
    reference_piece piece;
    reference_pieces_begin(&pieces, transfer, segment->scalar[0], segment->scalar[1]);
    while (reference_pieces_next(&pieces, &piece)) {
      const double length = (segment->t[1] - segment->t[0]) * length_per_t * piece.share;
      gathering.pixel.segment_count++;
      if (optics->model == CELLIST_MODEL_EMISSION)
        gather_emission(&gathering, segment, &piece, length);
      else
        gather_attenuated(&gathering, segment, &piece, length, optics->model != CELLIST_MODEL_ABSORPTION);
    }
  }
  const double depth = reference_sum_value(&gathering.depth);
  gathering.pixel.transmittance = exp(-depth);
  gathering.pixel.alpha = -expm1(-depth);
  for (int k = 0; k < 3; k++) gathering.pixel.colour[k] = reference_sum_value(&gathering.colour[k]);
  return gathering.pixel;
}
