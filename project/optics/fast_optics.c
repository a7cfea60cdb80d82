/* SPDX-License-Identifier: BSD-3-Clause
 * Fast optics: from the knots of a transfer function to intervals over scalars scaled to 0..1.
 *
 * Scaling by the mesh's own range keeps six digits of what the mesh holds, whatever its offset; slopes are worked out
 * from the rounded ends, so that neighbouring intervals agree at their common knot. */
#include "fast_optics.h"

#include <string.h>

/* The table's ends in scaled scalars. What a mesh holds lies in 0..1; knots beyond this would only overflow. */
static const double TABLE_LOW = -1, TABLE_HIGH = 2;

/* Ends of the outermost intervals: far beyond any scalar, near enough that differences stay finite. */
static const float BEYOND = 1e37f;

/* Extinction (per length unit) and colour at a place between two knots. */
struct sample {
  double at; /* scaled scalar */
  double extinction, colour[3];
};

static struct sample between(const struct sample *a, const struct sample *b, double at) {
  const double w = (at - a->at) / (b->at - a->at);
  struct sample made = {at, a->extinction + w * (b->extinction - a->extinction), {0}};
  for (int k = 0; k < 3; k++) made.colour[k] = a->colour[k] + w * (b->colour[k] - a->colour[k]);
  return made;
}

static void append(fast_transfer *made, const struct sample *a, const struct sample *b, float low, float high) {
  fast_interval *interval = &made->intervals[made->interval_count++];
  *interval = (fast_interval){.low = low, .high = high, .extinction = (float)a->extinction};
  const double width = (double)high - low;
  interval->extinction_slope = (float)((b->extinction - a->extinction) / width);
  for (int k = 0; k < 3; k++) {
    interval->colour[k] = (float)a->colour[k];
    interval->colour_slope[k] = (float)((b->colour[k] - a->colour[k]) / width);
  }
}

static struct sample sample_of(const fast_transfer *made, const cellist_transfer_knot *knot, double length_unit,
                               bool has_colour) {
  struct sample sample = {(0.5 * knot->value - 0.5 * made->scalar_low) / made->scalar_half_range,
                          fmin(knot->extinction * length_unit, FAST_EXTINCTION_LIMIT),
                          {0}};
  for (int k = 0; k < 3 && has_colour; k++) sample.colour[k] = knot->colour[k];
  return sample;
}

static void append_all(const cellist_transfer *transfer, double length_unit, bool has_colour, fast_transfer *made) {
  struct sample last = sample_of(made, &transfer->knots[0], length_unit, has_colour);
  float reached = -BEYOND;
  if (last.at > TABLE_LOW && last.at < TABLE_HIGH) {
    append(made, &last, &last, -BEYOND, (float)last.at);
    reached = (float)last.at;
  }
  for (size_t i = 1; i < transfer->knot_count; i++) {
    const struct sample next = sample_of(made, &transfer->knots[i], length_unit, has_colour);
    struct sample a = last, b = next;
    last = next;
    if (b.at <= TABLE_LOW || a.at >= TABLE_HIGH || !(b.at > a.at)) continue;
    if (a.at < TABLE_LOW) a = between(&a, &b, TABLE_LOW);
    if (b.at > TABLE_HIGH) b = between(&a, &b, TABLE_HIGH);
    const float low = made->interval_count == 0 ? (float)a.at : reached, high = (float)b.at;
    if (!(high > low)) continue;
    append(made, &a, &b, low, high);
    reached = high;
  }
  if (made->interval_count == 0) { /* no knot near 0..1: constant there */
    const struct sample first = sample_of(made, &transfer->knots[0], length_unit, has_colour);
    const struct sample *all = first.at >= TABLE_HIGH ? &first : &last;
    append(made, all, all, -BEYOND, BEYOND);
  } else if (last.at >= TABLE_HIGH) {
    /* No scalar comes where the table ends: a sloping interval may go on. */
    made->intervals[made->interval_count - 1].high = BEYOND;
  } else {
    append(made, &last, &last, reached, BEYOND);
  }
  if (made->intervals[0].low > -BEYOND) {
    /* The first one was cut at TABLE_LOW: likewise, but its values are measured from low, which must stay. */
    memmove(&made->intervals[1], &made->intervals[0], made->interval_count * sizeof *made->intervals);
    made->interval_count++;
    const fast_interval *first = &made->intervals[1];
    fast_interval below = {.low = -BEYOND, .high = first->low, .extinction = first->extinction};
    memcpy(below.colour, first->colour, sizeof below.colour);
    made->intervals[0] = below;
  }
}

cellist_result fast_transfer_create(cellist_context *context, const cellist_transfer *transfer, double minimum,
                                    double maximum, double length_unit, bool has_colour, fast_transfer *made) {
  fast_transfer created = {.scalar_low = minimum, .scalar_half_range = 0.5 * maximum - 0.5 * minimum};
  if (!(created.scalar_half_range > 0)) created.scalar_half_range = 0.5;
  created.intervals = cellist_allocate(context, transfer->knot_count + 2, sizeof *created.intervals);
  if (created.intervals == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  append_all(transfer, length_unit, has_colour, &created);
  double brightest = 1;
  for (size_t i = 0; i < transfer->knot_count && has_colour; i++)
    for (int k = 0; k < 3; k++) brightest = fmax(brightest, fabs(transfer->knots[i].colour[k]));
  created.opaque = (float)fmax(FAST_OPAQUE / brightest, 1e-30);
  uint32_t k = 0;
  for (uint32_t i = 0; i < FAST_BUCKET_COUNT; i++) {
    while (k + 1 < created.interval_count && (float)i / FAST_BUCKET_COUNT > created.intervals[k].high) k++;
    created.bucket[i] = k;
  }
  created.is_small = created.interval_count <= FAST_SMALL;
  for (uint32_t i = 0; i < FAST_SMALL; i++)
    for (uint32_t field = 0; field < FAST_FIELDS; field++) {
      const float *interval = &created.intervals[i < created.interval_count ? i : 0].low;
      created.small[field][i] = field == 0 && i >= created.interval_count ? INFINITY : interval[field];
    }
  *made = created;
  return CELLIST_SUCCESS;
}

double fast_transfer_peak(const cellist_transfer *transfer, double minimum, double maximum) {
  double colour[3], peak = fmax(cellist_transfer_evaluate(transfer, minimum, colour),
                                cellist_transfer_evaluate(transfer, maximum, colour));
  for (size_t i = 0; i < transfer->knot_count; i++)
    if (transfer->knots[i].value >= minimum && transfer->knots[i].value <= maximum)
      peak = fmax(peak, transfer->knots[i].extinction);
  return peak;
}

void fast_transfer_release(cellist_context *context, fast_transfer *transfer) {
  cellist_deallocate(context, transfer->intervals);
  *transfer = (fast_transfer){0};
}
