/* SPDX-License-Identifier: BSD-3-Clause
 * Shade: the volume models over a ray's segments, each piece between two knots in closed form, and how far the result
 * may be from the exact one.
 *
 * The bound follows, to first order and doubled for the rest, what can be off: rounding of each piece's depth and
 * colour; the scalar, by the distance between the computed points and the ray times the scalar's slope (walk_segment);
 * the place of a jump of the extinction, where a chain of cells begins or ends, between cells of constant scalar, and
 * at steps of the transfer function. Errors of the depth change all that lies behind. */
#include "reference_shade.h"

#include <math.h>
#include <string.h>

/* Rounding of a piece's depth, weights, colours and their sum, relative: 32 u. */
static const double PIECE_ROUNDING = 32 * 0x1p-53;

/* fmax is a call into the mathematical library. */
static double larger(double a, double b) { return a > b ? a : b; }

static void normalise(double v[3]) {
  const double length = hypot(hypot(v[0], v[1]), v[2]);
  for (int k = 0; k < 3; k++) v[k] = length > 0 ? v[k] / length : 0;
}

static void sort_isos(cellist_isosurface *isos, size_t count) {
  for (size_t i = 1; i < count; i++) {
    const cellist_isosurface iso = isos[i];
    size_t j = i;
    for (; j > 0 && isos[j - 1].value > iso.value; j--) isos[j] = isos[j - 1];
    isos[j] = iso;
  }
}

cellist_result shade_begin(cellist_context *context, const cellist_optics *optics, const cellist_transfer *transfer,
                           const cellist_frame *frame, shade_scene *scene) {
  *scene = (shade_scene){.transfer = transfer, .optics = *optics};
  if (optics->model == CELLIST_MODEL_ISOSURFACES) {
    scene->isos = cellist_allocate(context, optics->iso_count, sizeof *scene->isos);
    if (scene->isos == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    if (optics->iso_count > 0) memcpy(scene->isos, optics->isos, optics->iso_count * sizeof *scene->isos);
    sort_isos(scene->isos, optics->iso_count);
  }
  memcpy(scene->light, optics->light.direction, sizeof scene->light);
  normalise(scene->light);
  const double *light = scene->light;
  const bool is_headlight = light[0] == 0 && light[1] == 0 && light[2] == 0;
  for (int k = 0; k < 3; k++) {
    if (is_headlight) scene->light[k] = -frame->forward[k];
    scene->halfway[k] = scene->light[k] - frame->forward[k];
  }
  normalise(scene->light);
  normalise(scene->halfway);
  for (size_t i = 0; i < transfer->knot_count; i++) {
    scene->has_steps = scene->has_steps || (i > 0 && transfer->knots[i].value == transfer->knots[i - 1].value);
    for (int k = 0; k < 3; k++) scene->largest_colour = fmax(scene->largest_colour, fabs(transfer->knots[i].colour[k]));
  }
  return CELLIST_SUCCESS;
}

void shade_end(cellist_context *context, shade_scene *scene) {
  cellist_deallocate(context, scene->isos);
  scene->isos = NULL;
}

void shade_contribute(shade_gathering *gathering, const walk_segment *segment, double begin, double end) {
  const double extent = segment->t[1] - segment->t[0];
  if (isinf(gathering->pixel.z)) gathering->pixel.z = segment->t[0] + begin * extent;
  gathering->pixel.z_back = segment->t[0] + end * extent;
}

/* A shift of `length` in where the extinction changes from one value to another, at a given transmittance. */
static void doubt_place(shade_gathering *gathering, double from, double to, double length, double transmittance) {
  if (!(length > 0)) return;
  gathering->depth_error += fabs(to - from) * length;
  gathering->colour_error += transmittance * gathering->scene->largest_colour * larger(from, to) * length;
}

/* Steps of the transfer function that the segment passes, or may pass if its scalar is a little off. */
static void doubt_steps(shade_gathering *gathering, const walk_segment *segment, double transmittance) {
  const cellist_transfer *transfer = gathering->scene->transfer;
  const double error = segment->scalar_error, *s = segment->scalar;
  if (!gathering->scene->has_steps || !(error > 0)) return;
  const double length = (segment->t[1] - segment->t[0]) * gathering->length_per_t;
  const double shift = length * fmin(1, 2 * error / fabs(s[1] - s[0]));
  for (size_t i = 1; i < transfer->knot_count; i++) {
    const cellist_transfer_knot *below = &transfer->knots[i - 1], *above = &transfer->knots[i];
    if (below->value == above->value && below->value >= fmin(s[0], s[1]) - error &&
        below->value <= fmax(s[0], s[1]) + error)
      doubt_place(gathering, below->extinction, above->extinction, shift > 0 ? shift : length, transmittance);
  }
}

/* How fast extinction and colour change with the scalar in a piece. */
static void piece_slopes(const cellist_transfer *transfer, const reference_piece *piece, double *extinction,
                         double *colour) {
  *extinction = *colour = 0;
  if (piece->interval == 0 || piece->interval == transfer->knot_count) return;
  const cellist_transfer_knot *below = &transfer->knots[piece->interval - 1],
                              *above = &transfer->knots[piece->interval];
  const double width = above->value - below->value;
  *extinction = fabs(above->extinction - below->extinction) / width;
  for (int k = 0; k < 3; k++) *colour = larger(*colour, fabs(above->colour[k] - below->colour[k]) / width);
}

static void doubt_piece(shade_gathering *gathering, const walk_segment *segment, const reference_piece *piece,
                        double length, double depth, double transmittance) {
  double extinction_slope, colour_slope;
  piece_slopes(gathering->scene->transfer, piece, &extinction_slope, &colour_slope);
  const bool attenuated = gathering->scene->optics.model != CELLIST_MODEL_EMISSION;
  const double alpha = attenuated && depth > 1 ? 1 : depth, colour = gathering->scene->largest_colour;
  const double depth_error = extinction_slope * segment->scalar_error * length + PIECE_ROUNDING * depth;
  gathering->colour_error +=
      transmittance * (2 * colour * depth_error + alpha * colour_slope * segment->scalar_error +
                       alpha * colour * (PIECE_ROUNDING + (attenuated ? gathering->depth_error : 0)));
  gathering->depth_error += depth_error;
}

/* The integral of the product of two linear functions. */
static void add_emission(shade_gathering *gathering, const reference_piece *piece, double length) {
  const double a = piece->extinction[0] * length, b = piece->extinction[1] * length;
  for (int k = 0; k < 3; k++) {
    const double c = piece->colour[0][k], d = piece->colour[1][k];
    reference_sum_add(&gathering->colour[k], (a * (2 * c + d) + b * (c + 2 * d)) / 6);
  }
}

static void gather_piece(shade_gathering *gathering, const walk_segment *segment, const reference_piece *piece,
                         double length) {
  const cellist_optics *optics = &gathering->scene->optics;
  if (!(gathering->transmittance > 0)) return;
  const bool attenuated = optics->model != CELLIST_MODEL_EMISSION;
  const double transmittance = gathering->transmittance;
  double front, back;
  const double depth =
      reference_piece_weights(piece->extinction[0] * length, piece->extinction[1] * length, &front, &back);
  if (!(depth > 0)) return;
  doubt_piece(gathering, segment, piece, length, depth, transmittance);
  if (optics->light.enabled && optics->model != CELLIST_MODEL_ABSORPTION)
    shade_lit_piece(gathering, segment, piece, length, transmittance);
  else if (!attenuated)
    add_emission(gathering, piece, length);
  else if (optics->model == CELLIST_MODEL_EMISSION_ABSORPTION)
    for (int k = 0; k < 3; k++)
      reference_sum_add(&gathering->colour[k],
                        transmittance * (front * piece->colour[0][k] + back * piece->colour[1][k]));
  if (attenuated) {
    reference_sum_add(&gathering->depth, depth);
    gathering->transmittance = exp(-reference_sum_value(&gathering->depth));
  }
  shade_contribute(gathering, segment, piece->begin, piece->end);
}

static void shade_volume(shade_gathering *gathering, const walk_segment *segments, size_t count) {
  double extinction_before = 0; /* where the last segment ended */
  for (size_t i = 0; i < count; i++) {
    const walk_segment *segment = &segments[i], *before = i > 0 ? &segments[i - 1] : NULL;
    const double transmittance = gathering->transmittance;
    reference_pieces pieces;
    reference_piece piece;
    reference_pieces_begin(&pieces, gathering->scene->transfer, segment->scalar[0], segment->scalar[1]);
    for (bool first = true; reference_pieces_next(&pieces, &piece); first = false) {
      if (first) {
        const bool meets = before != NULL && before->t[1] == segment->t[0];
        if (before != NULL && !meets)
          doubt_place(gathering, extinction_before, 0, before->t_error[1] * gathering->length_per_t, transmittance);
        if (!meets || extinction_before != piece.extinction[0])
          doubt_place(gathering, meets ? extinction_before : 0, piece.extinction[0],
                      segment->t_error[0] * gathering->length_per_t, transmittance);
        doubt_steps(gathering, segment, transmittance);
      }
      const double length = (segment->t[1] - segment->t[0]) * gathering->length_per_t * piece.share;
      gathering->pixel.segment_count++;
      gather_piece(gathering, segment, &piece, length);
      extinction_before = piece.extinction[1];
    }
  }
  const double depth = reference_sum_value(&gathering->depth);
  if (count > 0)
    doubt_place(gathering, extinction_before, 0, segments[count - 1].t_error[1] * gathering->length_per_t,
                gathering->transmittance);
  if (gathering->scene->optics.model == CELLIST_MODEL_EMISSION) return;
  gathering->pixel.transmittance = gathering->transmittance;
  gathering->pixel.alpha = -expm1(-depth);
}

/* NaN, of an infinity that was multiplied by 0, counts as infinity. */
static double at_most(double error, double limit) { return error <= limit ? error : limit; }

shade_pixel shade_segments(const shade_scene *scene, const walk_segment *segments, size_t count, double length_per_t) {
  shade_gathering gathering = {
      .scene = scene, .length_per_t = length_per_t, .transmittance = 1, .pixel = {.z = HUGE_VAL, .transmittance = 1}};
  const cellist_model model = scene->optics.model;
  if (model == CELLIST_MODEL_ISOSURFACES)
    shade_isosurfaces(&gathering, segments, count);
  else if (model == CELLIST_MODEL_MAXIMUM)
    shade_maximum(&gathering, segments, count);
  else
    shade_volume(&gathering, segments, count);
  shade_pixel *pixel = &gathering.pixel;
  for (int k = 0; k < 3; k++) pixel->colour[k] = reference_sum_value(&gathering.colour[k]);
  const double alpha_error = at_most(pixel->transmittance * gathering.depth_error + 4 * 0x1p-53, 0.5);
  /* Mixtures of the transfer function's colours differ by no more than twice the largest; what nothing absorbs has no
   * such limit. */
  const double mixed = model == CELLIST_MODEL_EMISSION ? HUGE_VAL : scene->largest_colour;
  const double colour_error = model == CELLIST_MODEL_ABSORPTION ? 0 : at_most(gathering.colour_error, mixed);
  pixel->error = count > 0 ? 2 * fmax(alpha_error, colour_error) : 0;
  if (scene->optics.light.enabled && model != CELLIST_MODEL_ABSORPTION && model != CELLIST_MODEL_MAXIMUM && count > 0)
    pixel->error = HUGE_VAL;
  return *pixel;
}
