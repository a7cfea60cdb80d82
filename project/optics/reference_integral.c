/* SPDX-License-Identifier: BSD-3-Clause
 * Exact integration of the density-emitter model (Moreland and Angel; W. and M. Kraus in [W]) on pieces of linear
 * extinction and colour, and the split of a segment into such pieces at the knots of the transfer function.
 *
 * Integrating by parts, front = 1 - psi and back = psi - zeta with psi the integral of the transmittance and zeta its
 * last value. Where the depth exceeds QUADRATURE_UP_TO these have closed forms in erfcx (growing extinction) and
 * Dawson's function (falling), and the two differences lose less than a digit: psi is at most 0.75 there, and zeta at
 * most 0.69 psi. Nearly constant extinction is no special case, both functions decay like 1/x and the roots cancel.
 * Below it the differences would cancel, but the integrand is so smooth that a Gauss rule of ten points or fewer is
 * exact to rounding (the remainder of n points is that of the series of exp from its term 2n - 2 on, integrated); all
 * terms are positive, so even a depth of 1e-300 keeps its digits. */
#include "reference_integral.h"

#include <math.h>

#include "reference_integral_special.h"

/* Where quadrature hands over to the closed forms; both are good to 1e-15 between 0.5 and 2. */
static const double QUADRATURE_UP_TO = 1;
/* Up to these depths rules of so many points leave less than 3e-16 of a weight; the error grows with the 4th and 6th
 * power beyond. */
static const double FIVE_POINTS_UP_TO = 0x1p-8;
static const double SEVEN_POINTS_UP_TO = 0x1p-4;

/* Beyond this depth every transmittance is 0 in double; keeps sums of two such depths finite. */
static const double DEPTH_LIMIT = 1e300;

/* Gauss-Legendre on 0..1. */
static const double NODE5[5] = {0.046910077030668003601, 0.23076534494715845448, 0.5, 0.76923465505284154552,
                                0.9530899229693319964};
static const double WEIGHT5[5] = {0.11846344252809454376, 0.23931433524968323402, 0.28444444444444444444,
                                  0.23931433524968323402, 0.11846344252809454376};
static const double NODE7[7] = {0.02544604382862073773, 0.12923440720030278006, 0.29707742431130141654, 0.5,
                                0.70292257568869858345, 0.87076559279969721993, 0.97455395617137926226};
static const double WEIGHT7[7] = {0.06474248308443484663, 0.13985269574463833395, 0.19091502525255947247,
                                  0.20897959183673469387, 0.19091502525255947247, 0.13985269574463833395,
                                  0.06474248308443484663};
static const double NODE10[10] = {0.01304673574141413996, 0.067468316655507744634, 0.16029521585048779688,
                                  0.2833023029353764046,  0.42556283050918439456,  0.57443716949081560544,
                                  0.7166976970646235954,  0.83970478414951220312,  0.93253168334449225537,
                                  0.98695326425858586004};
static const double WEIGHT10[10] = {0.033335672154344068797, 0.074725674575290296573, 0.109543181257991022,
                                    0.13463335965499817755,  0.14776211235737643509,  0.14776211235737643509,
                                    0.13463335965499817755,  0.109543181257991022,    0.074725674575290296573,
                                    0.033335672154344068797};

void reference_sum_add(reference_sum *sum, double term) {
  const double total = sum->sum + term;
  sum->rest += fabs(sum->sum) >= fabs(term) ? (sum->sum - total) + term : (term - total) + sum->sum;
  sum->sum = total;
}

/* exp(-x) for 0 <= x <= SEVEN_POINTS_UP_TO: the series up to x^9, the rest is below 1e-18. Three times as fast as the
 * library's, and most pieces of a picture are that thin. */
static double exp_of_minus(double x) {
  const double y = -x;
  return 1 +
         y * (1 + y * (0.5 +
                       y * (1.0 / 6 +
                            y * (1.0 / 24 +
                                 y * (1.0 / 120 +
                                      y * (1.0 / 720 + y * (1.0 / 5040 + y * (1.0 / 40320 + y * (1.0 / 362880)))))))));
}

double reference_piece_weights_by_quadrature(double a, double b, double *front, double *back) {
  const double depth = 0.5 * a + 0.5 * b;
  const int count = depth <= FIVE_POINTS_UP_TO ? 5 : depth <= SEVEN_POINTS_UP_TO ? 7 : 10;
  const double *node = count == 5 ? NODE5 : count == 7 ? NODE7 : NODE10;
  const double *weight = count == 5 ? WEIGHT5 : count == 7 ? WEIGHT7 : WEIGHT10;
  *front = *back = 0;
  for (int i = 0; i < count; i++) {
    const double w = node[i], v = node[count - 1 - i];
    const double so_far = w * (a * (1 - 0.5 * w) + b * 0.5 * w);
    const double emitted = weight[i] * (a * v + b * w) * (count < 10 ? exp_of_minus(so_far) : exp(-so_far));
    *front += emitted * v;
    *back += emitted * w;
  }
  return depth;
}

double reference_piece_weights(double a, double b, double *front, double *back) {
  a = a < DEPTH_LIMIT ? a : DEPTH_LIMIT;
  b = b < DEPTH_LIMIT ? b : DEPTH_LIMIT;
  const double depth = 0.5 * a + 0.5 * b;
  if (depth <= QUADRATURE_UP_TO) return reference_piece_weights_by_quadrature(a, b, front, back);
  const double zeta = exp(-depth), difference = fabs(b - a);
  double psi;
  if (difference <= 1e-17 * depth) { /* then D / a^2, the next term of the series, is below 1e-17 too */
    psi = (1 - zeta) / depth;
  } else {
    const double root = sqrt(2 * difference), u_front = a / root, u_back = b / root;
    if (b > a)
      psi = 1.7724538509055160273 / root * (reference_erfcx(u_front) - zeta * reference_erfcx(u_back));
    else
      psi = 2 / root * (reference_dawson(u_front) - zeta * reference_dawson(u_back));
  }
  *front = 1 - psi;
  *back = psi - zeta;
  return depth;
}

/* exp(-50) is 2e-22: nothing behind that shows beside 1. */
static const double VISIBLE_DEPTH = 50;

void reference_piece_nodes(double a, double b, int attenuated, int parts, reference_node visit, void *user) {
  a = fmin(a, DEPTH_LIMIT);
  b = fmin(b, DEPTH_LIMIT);
  const double depth = 0.5 * a + 0.5 * b, limit = attenuated ? fmin(depth, VISIBLE_DEPTH) : 0;
  const int panels = limit > 1 ? (int)ceil(limit) : 1;
  double low = 0;
  for (int p = 1; p <= panels; p++) {
    /* Where the depth is y: the root of (b - a) w^2 / 2 + a w = y, written without cancellation. */
    const double y = limit * p / panels;
    const bool is_end = p == panels && !(attenuated && depth > VISIBLE_DEPTH);
    const double high = is_end ? 1 : 2 * y / (a + sqrt(fmax(0, a * a + 2 * (b - a) * y)));
    for (int part = 0; part < parts; part++) {
      const double width = (high - low) / parts, begin = low + part * width;
      for (int i = 0; i < 10; i++) {
        const double w = begin + width * NODE10[i];
        const double so_far = attenuated ? w * (a * (1 - 0.5 * w) + b * 0.5 * w) : 0;
        visit(user, w, width * WEIGHT10[i] * (a * (1 - w) + b * w) * exp(-so_far));
      }
    }
    low = high;
  }
}

/* The number of knots that lie before the scalar, so that the scalar lies between knots interval - 1 and interval. Of
 * knots at the scalar itself, those count if `ascending`: the piece that begins there lies above them. */
static size_t interval_of(const cellist_transfer *transfer, double scalar, int above) {
  size_t low = 0, high = transfer->knot_count;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    const double value = transfer->knots[middle].value;
    if (value < scalar || (above && value == scalar))
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void evaluate(const cellist_transfer *transfer, size_t interval, double scalar, double *extinction,
                     double colour[3]) {
  const cellist_transfer_knot *knots = transfer->knots;
  if (interval == 0 || interval == transfer->knot_count) {
    const cellist_transfer_knot *knot = &knots[interval == 0 ? 0 : interval - 1];
    *extinction = knot->extinction;
    for (int k = 0; k < 3; k++) colour[k] = knot->colour[k];
    return;
  }
  const cellist_transfer_knot *below = &knots[interval - 1], *above = &knots[interval];
  /* Halves, so that knots at both ends of the range of doubles have a finite distance. */
  const double width = 0.5 * above->value - 0.5 * below->value;
  double up = (0.5 * scalar - 0.5 * below->value) / width, down = (0.5 * above->value - 0.5 * scalar) / width;
  /* Subnormal knots: their halves may be equal. */
  if (!(width > 0)) up = down = 0.5;
  *extinction = down * below->extinction + up * above->extinction;
  for (int k = 0; k < 3; k++) colour[k] = down * below->colour[k] + up * above->colour[k];
}

void reference_pieces_begin(reference_pieces *pieces, const cellist_transfer *transfer, double front, double back) {
  pieces->transfer = transfer;
  pieces->front = front;
  pieces->back = back;
  const double half_span = 0.5 * back - 0.5 * front; /* 0 for neighbouring subnormals too */
  pieces->direction = half_span > 0 ? 1 : half_span < 0 ? -1 : 0;
  pieces->interval = interval_of(transfer, front, pieces->direction > 0);
  pieces->at = front;
  pieces->position = 0;
  pieces->done = 0;
}

int reference_pieces_next(reference_pieces *pieces, reference_piece *piece) {
  if (pieces->done) return 0;
  const cellist_transfer *transfer = pieces->transfer;
  const size_t interval = pieces->interval;
  double reached = pieces->back;
  pieces->done = 1;
  if (pieces->direction > 0 && interval < transfer->knot_count && transfer->knots[interval].value < pieces->back) {
    reached = transfer->knots[interval].value;
    pieces->done = 0;
    while (pieces->interval < transfer->knot_count && transfer->knots[pieces->interval].value == reached)
      pieces->interval++;
  } else if (pieces->direction < 0 && interval > 0 && transfer->knots[interval - 1].value > pieces->back) {
    reached = transfer->knots[interval - 1].value;
    pieces->done = 0;
    while (pieces->interval > 0 && transfer->knots[pieces->interval - 1].value == reached) pieces->interval--;
  }
  const double whole = 0.5 * pieces->back - 0.5 * pieces->front;
  piece->interval = interval;
  piece->begin = pieces->position;
  /* Halves of differences, as in evaluate(). A constant segment is one piece. */
  piece->end = pieces->done ? 1 : fmin(1, (0.5 * reached - 0.5 * pieces->front) / whole);
  piece->share = whole == 0 ? 1 : (0.5 * reached - 0.5 * pieces->at) / whole;
  piece->scalar[0] = pieces->at;
  piece->scalar[1] = reached;
  for (int end = 0; end < 2; end++)
    evaluate(transfer, interval, piece->scalar[end], &piece->extinction[end], piece->colour[end]);
  pieces->at = reached;
  pieces->position = piece->end;
  return 1;
}
