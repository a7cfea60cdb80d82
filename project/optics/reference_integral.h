/* SPDX-License-Identifier: BSD-3-Clause
 * The reference caster's own integrator: what a ray gathers along a segment on which the scalar is linear, for a
 * piecewise linear transfer function. Private; shares no code with the optics that it judges. */
#ifndef CELLIST_REFERENCE_INTEGRAL_H
#define CELLIST_REFERENCE_INTEGRAL_H

#include <cellist/transfer.h>

/* A sum with the rounding of its additions kept apart (Neumaier). */
typedef struct reference_sum {
  double sum, rest;
} reference_sum;

void reference_sum_add(reference_sum *sum, double term);
static inline double reference_sum_value(const reference_sum *sum) { return sum->sum + sum->rest; }

/* The part of the light that a ray gathers from a piece of linear extinction e, of optical depth a at its front end and
 * b at its back end if these held along all of it, and of linear colour:
 *   front = integral of e (1-w) exp(-depth(w)), back = integral of e w exp(-depth(w)); colour = front c_f + back c_b.
 * a, b: at least 0, infinity excluded. Returns the optical depth (a + b) / 2. Each of the three is exact to some
 * 1e-15 relative, whatever a and b. */
double reference_piece_weights(double a, double b, double *front, double *back);

/* The same by quadrature only, for tests where the two methods meet. */
double reference_piece_weights_by_quadrature(double a, double b, double *front, double *back);

/* For light that varies along a piece: calls visit with places w in 0..1 and weights such that the sum of f(w) weight
 * is the integral of e f exp(-depth) (of e f, if not attenuated), exact to rounding for f of degree 12 on each panel.
 * Panels are at most 1 deep, cut into `parts` equal ones; what lies deeper than 50 is left out. */
typedef void (*reference_node)(void *user, double w, double weight);
void reference_piece_nodes(double a, double b, int attenuated, int parts, reference_node visit, void *user);

/* A piece of a segment between two knots: extinction and colour are linear on it. */
typedef struct reference_piece {
  double begin, end;    /* where it lies on the segment, 0..1, in the direction of the ray */
  double share;         /* end - begin without its cancellation */
  double scalar[2];     /* at its ends */
  double extinction[2]; /* at its ends, as seen from inside it */
  double colour[2][3];
  size_t interval; /* between which knots: interval - 1 and interval; 0 and knot_count: outside */
} reference_piece;

/* Walks the pieces of a segment from scalar `front` to scalar `back`. */
typedef struct reference_pieces {
  const cellist_transfer *transfer;
  double front, back;
  size_t interval;
  double at; /* the scalar reached */
  double position;
  int direction; /* 1: ascending, -1: descending, 0: constant */
  int done;
} reference_pieces;

void reference_pieces_begin(reference_pieces *pieces, const cellist_transfer *transfer, double front, double back);

/* The next piece; returns 0 after the last one. A segment of n crossed knots has n + 1 pieces at most. */
int reference_pieces_next(reference_pieces *pieces, reference_piece *piece);

#endif
