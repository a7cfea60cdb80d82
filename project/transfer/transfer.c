/* SPDX-License-Identifier: BSD-3-Clause
 * Transfer function: an author's curves made piecewise linear in extinction and linear light.
 *
 * Intervals between the nodes of colour and opacity are halved until the curve is within TOLERANCE of its chord at
 * three inner points: what is linear stays as it is, knot for knot. Steps become two knots of the same value. */
#include <cellist/transfer.h>

#include <base/srgb.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "transfer_private.h"

/* Of colour (0..1) and of the largest extinction; a larger one shows as bands in smooth maps. */
static const double TOLERANCE = 1.0 / 2048;
/* 4096 pieces an interval; fewer would break the tolerance where VTK's sharpness nears a step. */
enum { MAX_DEPTH = 12 };
/* -log(2^-53): what the image convention gives for the last opacity below 1, and for 1 itself, which has no finite one.
 * A larger value lets neighbours of an opaque knot overflow. */
static const double IMAGE_OPAQUE = 36.7368005696771;
/* As in VTK: above this sharpness a curve is a step, below the other it is linear. */
static const double SHARP_STEP = 0.99, SHARP_LINEAR = 0.01;

struct builder {
  cellist_context *context;
  const transfer_curve *curve;
  const cellist_transfer_desc *desc;
  double first, last; /* of the nodes */
  double largest_extinction;
  cellist_transfer *transfer;
  size_t capacity;
  bool failed;
};

/* One smooth piece: between two neighbouring breaks, the colour and opacity intervals that it lies in. */
struct piece {
  double begin, end;
  size_t colour, opacity; /* index of the node that begins the interval, or of the first one */
};

struct sample {
  double x, extinction, colour[3];
};

void transfer_curve_release(cellist_context *context, transfer_curve *curve) {
  cellist_deallocate(context, curve->colours);
  cellist_deallocate(context, curve->opacities);
  *curve = (transfer_curve){0};
}

/* VTK's piecewise function between two nodes, at a share s of the way; upper: the side of the midpoint. */
static double opacity_between(const opacity_node *a, const opacity_node *b, double s, bool upper) {
  if (a->sharpness > SHARP_STEP) return upper ? b->opacity : a->opacity;
  if (s < a->midpoint)
    s = 0.5 * s / a->midpoint;
  else
    s = a->midpoint < 1 ? 0.5 + 0.5 * (s - a->midpoint) / (1 - a->midpoint) : 1;
  if (a->sharpness < SHARP_LINEAR) return (1 - s) * a->opacity + s * b->opacity;
  const double power = 1 + 10 * a->sharpness;
  s = s < 0.5 ? 0.5 * pow(2 * s, power) : 1 - 0.5 * pow(2 * (1 - s), power);
  const double slope = (1 - a->sharpness) * (b->opacity - a->opacity);
  const double s2 = s * s, s3 = s2 * s;
  const double value = (2 * s3 - 3 * s2 + 1) * a->opacity + (3 * s2 - 2 * s3) * b->opacity + (s3 - 2 * s2 + s) * slope +
                       (s3 - s2) * slope;
  return fmin(fmax(value, fmin(a->opacity, b->opacity)), fmax(a->opacity, b->opacity));
}

static double extinction_of(const struct builder *builder, double opacity) {
  const cellist_transfer_desc *desc = builder->desc;
  const double scale = desc->opacity_scale != 0 ? desc->opacity_scale : 1;
  if (desc->convention == CELLIST_OPACITY_IMAGE)
    opacity = opacity < 1 ? fmin(-log1p(-opacity), IMAGE_OPAQUE) : IMAGE_OPAQUE;
  return opacity * scale / desc->unit_distance;
}

static struct sample sample_at(const struct builder *builder, const struct piece *piece, double x) {
  const transfer_curve *curve = builder->curve;
  struct sample sample = {.x = x};
  const opacity_node *a = &curve->opacities[piece->opacity];
  double opacity = a->opacity;
  if (piece->opacity + 1 < curve->opacity_count && x >= a->x) {
    const double length = a[1].x - a->x, middle = 0.5 * piece->begin + 0.5 * piece->end;
    opacity = opacity_between(a, a + 1, fmin(1, (x - a->x) / length), (middle - a->x) / length > a->midpoint);
  }
  sample.extinction = extinction_of(builder, opacity);
  const colour_node *from = &curve->colours[piece->colour];
  memcpy(sample.colour, from->colour, sizeof sample.colour);
  if (piece->colour + 1 < curve->colour_count && x >= from->x)
    colour_mix(curve->space, from->colour, from[1].colour, fmin(1, (x - from->x) / (from[1].x - from->x)),
               sample.colour);
  if (curve->srgb)
    for (int k = 0; k < 3; k++) sample.colour[k] = linear_from_srgb(sample.colour[k]);
  return sample;
}

static void append(struct builder *builder, const struct sample *sample) {
  cellist_transfer *transfer = builder->transfer;
  if (builder->failed) return;
  const cellist_transfer_desc *desc = builder->desc;
  double value = sample->x;
  if (!desc->keep_range) {
    const double extent = builder->last - builder->first;
    const double t = extent > 0 ? (sample->x - builder->first) / extent : 0;
    value = t <= 0 ? desc->range[0] : t >= 1 ? desc->range[1] : (1 - t) * desc->range[0] + t * desc->range[1];
  }
  cellist_transfer_knot knot = {value, sample->extinction, {sample->colour[0], sample->colour[1], sample->colour[2]}};
  const size_t count = transfer->knot_count;
  if (count > 0) {
    cellist_transfer_knot *last = &transfer->knots[count - 1];
    if (knot.value < last->value) knot.value = last->value; /* rounding of a range that is tiny beside its offset */
    if (memcmp(last, &knot, sizeof knot) == 0) return;
    /* Of several knots of one value only the first and the last count. */
    if (count > 1 && last->value == knot.value && transfer->knots[count - 2].value == knot.value) {
      *last = knot;
      return;
    }
  }
  if (count == builder->capacity) {
    const size_t capacity = 2 * builder->capacity + 16;
    cellist_transfer_knot *grown =
        cellist_reallocate(builder->context, transfer->knots, count, capacity, sizeof *grown);
    builder->failed = grown == NULL;
    if (builder->failed) return;
    transfer->knots = grown;
    builder->capacity = capacity;
  }
  transfer->knots[transfer->knot_count++] = knot;
}

static bool is_close_to_chord(const struct builder *builder, const struct sample *a, const struct sample *b,
                              const struct sample *m) {
  const double s = (m->x - a->x) / (b->x - a->x);
  const double chord = (1 - s) * a->extinction + s * b->extinction;
  if (fabs(m->extinction - chord) > TOLERANCE * builder->largest_extinction) return false;
  for (int k = 0; k < 3; k++)
    if (fabs(m->colour[k] - ((1 - s) * a->colour[k] + s * b->colour[k])) > TOLERANCE) return false;
  return true;
}

/* Appends what lies between a and b, then b. */
static void subdivide(struct builder *builder, const struct piece *piece, const struct sample *a,
                      const struct sample *b, int depth) {
  bool close = true;
  for (int i = 1; i < 4 && close && depth < MAX_DEPTH; i++) {
    const struct sample inner = sample_at(builder, piece, a->x + 0.25 * i * (b->x - a->x));
    close = is_close_to_chord(builder, a, b, &inner);
  }
  if (close) {
    append(builder, b);
    return;
  }
  const struct sample middle = sample_at(builder, piece, 0.5 * (a->x + b->x));
  subdivide(builder, piece, a, &middle, depth + 1);
  subdivide(builder, piece, &middle, b, depth + 1);
}

static int compare_doubles(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The nodes of both curves and the midpoints of opacity, ascending. */
static size_t collect_breaks(const transfer_curve *curve, double *breaks) {
  size_t count = 0;
  for (size_t i = 0; i < curve->colour_count; i++) breaks[count++] = curve->colours[i].x;
  for (size_t i = 0; i < curve->opacity_count; i++) {
    const opacity_node *node = &curve->opacities[i];
    breaks[count++] = node->x;
    if (i + 1 < curve->opacity_count && (node->midpoint != 0.5 || node->sharpness >= SHARP_LINEAR))
      breaks[count++] = node->x + node->midpoint * (node[1].x - node->x);
  }
  qsort(breaks, count, sizeof *breaks, compare_doubles);
  return count;
}

/* Moves the piece on to what lies between begin and end; pieces come in ascending order. */
static void move_piece(const transfer_curve *curve, struct piece *piece, double begin, double end) {
  const double middle = 0.5 * begin + 0.5 * end;
  piece->begin = begin;
  piece->end = end;
  while (piece->colour + 1 < curve->colour_count && curve->colours[piece->colour + 1].x <= middle) piece->colour++;
  while (piece->opacity + 1 < curve->opacity_count && curve->opacities[piece->opacity + 1].x <= middle)
    piece->opacity++;
}

static cellist_result build(struct builder *builder) {
  const transfer_curve *curve = builder->curve;
  double *breaks = cellist_allocate(builder->context, curve->colour_count + 2 * curve->opacity_count, sizeof *breaks);
  if (breaks == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  const size_t count = collect_breaks(curve, breaks);
  builder->first = breaks[0];
  builder->last = breaks[count - 1];
  for (size_t i = 0; i < curve->opacity_count; i++)
    builder->largest_extinction =
        fmax(builder->largest_extinction, extinction_of(builder, curve->opacities[i].opacity));
  struct piece piece = {0};
  for (size_t i = 0; i + 1 < count; i++) {
    if (breaks[i] == breaks[i + 1]) continue;
    move_piece(curve, &piece, breaks[i], breaks[i + 1]);
    const struct sample begin = sample_at(builder, &piece, piece.begin), end = sample_at(builder, &piece, piece.end);
    append(builder, &begin);
    subdivide(builder, &piece, &begin, &end, 0);
  }
  if (builder->transfer->knot_count == 0) { /* all nodes at one place */
    piece = (struct piece){builder->first, builder->last, curve->colour_count - 1, curve->opacity_count - 1};
    const struct sample only = sample_at(builder, &piece, builder->first);
    append(builder, &only);
  }
  cellist_deallocate(builder->context, breaks);
  return builder->failed ? CELLIST_ERROR_OUT_OF_MEMORY : CELLIST_SUCCESS;
}

static const char *check(const cellist_transfer_desc *desc) {
  if (!desc->keep_range && !(isfinite(desc->range[0]) && isfinite(desc->range[1]) && desc->range[0] <= desc->range[1]))
    return "a transfer function's range must be finite and ascend";
  if (!(desc->unit_distance > 0 && isfinite(desc->unit_distance))) return "the unit distance must be above 0";
  if (!(desc->opacity_scale >= 0 && isfinite(desc->opacity_scale))) return "the opacity scale must not be negative";
  return NULL;
}

cellist_result cellist_transfer_load(cellist_context *context, const cellist_transfer_desc *desc,
                                     cellist_transfer *transfer) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  const char *wrong = desc != NULL && transfer != NULL ? check(desc) : "cellist_transfer_load: an argument is NULL";
  if (wrong != NULL) return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "%s", wrong);
  transfer_curve curve = {0};
  const char *source = desc->source != NULL ? desc->source : "ramp";
  cellist_result result = transfer_read_builtin(context, source, &curve);
  if (result == CELLIST_ERROR_NOT_FOUND) {
    curve.srgb = desc->srgb_colours;
    result = transfer_read_paraview(context, source, &curve);
  }
  cellist_transfer made = {0};
  if (result == CELLIST_SUCCESS) {
    struct builder builder = {.context = context, .curve = &curve, .desc = desc, .transfer = &made};
    result = build(&builder);
  }
  transfer_curve_release(context, &curve);
  if (result == CELLIST_SUCCESS)
    *transfer = made;
  else
    cellist_transfer_release(context, &made);
  return result;
}

cellist_result cellist_transfer_check(cellist_context *context, const cellist_transfer *transfer) {
  if (transfer == NULL || transfer->knot_count == 0 || transfer->knots == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "the transfer function has no knots; it needs a knot at least");
  for (size_t i = 0; i < transfer->knot_count; i++) {
    const cellist_transfer_knot *knot = &transfer->knots[i];
    bool finite = isfinite(knot->value) && isfinite(knot->extinction) && knot->extinction >= 0;
    for (int k = 0; k < 3; k++) finite = finite && isfinite(knot->colour[k]);
    if (!finite)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "knot %zu of the transfer function is not finite, or its extinction negative", i);
    if (i > 0 && knot->value < transfer->knots[i - 1].value)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "knot %zu of the transfer function is out of order",
                          i);
  }
  return CELLIST_SUCCESS;
}

void cellist_transfer_release(cellist_context *context, cellist_transfer *transfer) {
  cellist_deallocate(context, transfer->knots);
  *transfer = (cellist_transfer){0};
}

double cellist_transfer_evaluate(const cellist_transfer *transfer, double value, double colour[3]) {
  const cellist_transfer_knot *knots = transfer->knots;
  size_t low = 0, high = transfer->knot_count; /* the number of knots with a value below */
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (knots[middle].value < value)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == 0 || low == transfer->knot_count || knots[low].value == value) {
    const cellist_transfer_knot *knot = &knots[low < transfer->knot_count ? low : low - 1];
    memcpy(colour, knot->colour, sizeof knot->colour);
    return knot->extinction;
  }
  const cellist_transfer_knot *a = &knots[low - 1], *b = &knots[low];
  const double s = (0.5 * value - 0.5 * a->value) / (0.5 * b->value - 0.5 * a->value);
  for (int k = 0; k < 3; k++) colour[k] = (1 - s) * a->colour[k] + s * b->colour[k];
  return (1 - s) * a->extinction + s * b->extinction;
}

/* Gaps below this share of the scalar's range: rounding of 6e-8 of the range moves a peak's flanks by that much.
 * Smaller: peaks are off by more than a thousandth; larger: more transfer functions are drawn in double precision,
 * which is slower. */
static const double NARROW = 6e-5;

bool cellist_transfer_is_narrow_gap(const cellist_transfer_knot *below, double minimum, double maximum) {
  const cellist_transfer_knot *above = below + 1;
  const double gap = 0.5 * above->value - 0.5 * below->value, range = 0.5 * maximum - 0.5 * minimum;
  return gap > 0 && gap < NARROW * range && (below->extinction > 0 || above->extinction > 0) &&
         above->value >= minimum && below->value <= maximum;
}

bool cellist_transfer_is_narrow(const cellist_transfer *transfer, double minimum, double maximum) {
  for (size_t i = 1; i < transfer->knot_count; i++)
    if (cellist_transfer_is_narrow_gap(&transfer->knots[i - 1], minimum, maximum)) return true;
  return false;
}

double cellist_unit_distance_auto(const double bounds[6], size_t file_cell_count) {
  const double diagonal = hypot(hypot(bounds[3] - bounds[0], bounds[4] - bounds[1]), bounds[5] - bounds[2]);
  return file_cell_count > 0 ? diagonal / cbrt((double)file_cell_count) : diagonal;
}
