/* SPDX-License-Identifier: BSD-3-Clause
 * What a ray gathers on one segment, by quadrature in double: the oracle of tables and their benchmark. It shares no
 * code with them: panels of seven Gauss points between knots, each at most a quarter deep. */
#ifndef CELLIST_TESTS_SEGMENT_H
#define CELLIST_TESTS_SEGMENT_H

#include <cellist/transfer.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

typedef struct segment {
  double colour[3], opacity; /* premultiplied */
  double front[3], back[3];  /* colour weighted by 1-w and w */
  double first, second;      /* moments of w of what is seen: their sums, not divided by the opacity */
} segment;

/* Between knots i-1 and i, whatever the scalar: as seen from inside that interval. */
static inline double segment_look_up(const cellist_transfer *transfer, size_t i, double value, double colour[3]) {
  const cellist_transfer_knot *knots = transfer->knots;
  const cellist_transfer_knot *low = &knots[i > 0 ? i - 1 : 0];
  const cellist_transfer_knot *high = &knots[i < transfer->knot_count ? i : transfer->knot_count - 1];
  const double part = low == high ? 0 : (value - low->value) / (high->value - low->value);
  for (int c = 0; c < 3; c++) colour[c] = low->colour[c] + part * (high->colour[c] - low->colour[c]);
  return low->extinction + part * (high->extinction - low->extinction);
}

/* From w = begin to end in interval i. */
static inline void segment_add(const cellist_transfer *transfer, size_t i, double front, double back, double length,
                               double begin, double end, double *depth, segment *sum) {
  static const double node[7] = {0.02544604382862073773, 0.12923440720030278006, 0.29707742431130141654, 0.5,
                                 0.70292257568869858345, 0.87076559279969721993, 0.97455395617137926226};
  static const double weight[7] = {0.06474248308443484663, 0.13985269574463833395, 0.19091502525255947247,
                                   0.20897959183673469387, 0.19091502525255947247, 0.13985269574463833395,
                                   0.06474248308443484663};
  double colour[3];
  const double a = segment_look_up(transfer, i, front + begin * (back - front), colour) * length;
  const double b = segment_look_up(transfer, i, front + end * (back - front), colour) * length;
  /* Extinction is linear: ever smaller steps where it is steep, to a depth of 60 behind which nothing is seen. */
  const double whole = 0.5 * (a + b) * (end - begin), limit = fmin(whole, 60);
  const int panels = 1 + (int)(4 * limit);
  double low = 0;
  for (int p = 1; p <= panels; p++) {
    const double y = limit * p / panels, A = a * (end - begin), B = b * (end - begin);
    const double high = p == panels && limit == whole ? 1 : 2 * y / (A + sqrt(fmax(0, A * A + 2 * (B - A) * y)));
    for (int g = 0; g < 7; g++) {
      const double u = low + (high - low) * node[g], w = begin + u * (end - begin);
      const double extinction = segment_look_up(transfer, i, front + w * (back - front), colour);
      const double emitted =
          extinction * length * (end - begin) * (high - low) * weight[g] * exp(-*depth - u * (A + 0.5 * (B - A) * u));
      sum->opacity += emitted;
      sum->first += emitted * w;
      sum->second += emitted * w * w;
      for (int c = 0; c < 3; c++) {
        sum->colour[c] += emitted * colour[c];
        sum->front[c] += emitted * colour[c] * (1 - w);
        sum->back[c] += emitted * colour[c] * w;
      }
    }
    low = high;
  }
  *depth += whole;
}

static inline segment segment_integrate(const cellist_transfer *transfer, double front, double back, double length) {
  segment sum = {.opacity = 0};
  const cellist_transfer_knot *knots = transfer->knots;
  const size_t count = transfer->knot_count;
  double depth = 0, begin = 0;
  const bool up = back > front;
  size_t i = 0; /* the interval that holds the front, seen in the direction of the back */
  while (i < count && (up ? knots[i].value <= front : knots[i].value < front)) i++;
  for (;;) {
    double end = 1;
    if (up && i < count) end = fmin(1, (knots[i].value - front) / (back - front));
    if (back < front && i > 0) end = fmin(1, (knots[i - 1].value - front) / (back - front));
    if (end > begin || back == front) segment_add(transfer, i, front, back, length, begin, end, &depth, &sum);
    if (end >= 1) break;
    begin = end;
    i = up ? i + 1 : i - 1;
  }
  sum.opacity = -expm1(-depth);
  return sum;
}

#endif
