/* SPDX-License-Identifier: BSD-3-Clause
 * An oracle for pictures of one cell, in long double and by other means than the renderers: the segment by clipping
 * the ray with four planes, the integral by Gauss quadrature between knots. */
#ifndef CELLIST_TESTS_SINGLE_CELL_H
#define CELLIST_TESTS_SINGLE_CELL_H

#include <cellist/gl.h>
#include <math.h>
#include <stdbool.h>

typedef struct oracle_cell {
  long double corner[4][3];
  long double scalar[4];
} oracle_cell;

typedef struct oracle_pixel {
  long double rgba[4];
  long double front, back; /* depth along forward; front >= back: the ray misses */
} oracle_pixel;

static inline long double oracle_dot(const long double a[3], const long double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void oracle_plane(const oracle_cell *cell, int k, long double normal[3], long double *offset) {
  const uint8_t *f = CELLIST_TET_FACE[k];
  long double u[3], v[3];
  for (int i = 0; i < 3; i++) {
    u[i] = cell->corner[f[1]][i] - cell->corner[f[0]][i];
    v[i] = cell->corner[f[2]][i] - cell->corner[f[0]][i];
  }
  for (int i = 0; i < 3; i++) normal[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
  *offset = oracle_dot(normal, cell->corner[f[0]]);
}

/* The scalar at a point, by barycentric coordinates. */
static inline long double oracle_scalar(const oracle_cell *cell, const long double point[3]) {
  long double sum = 0, weights = 0;
  for (int k = 0; k < 4; k++) {
    long double normal[3], offset;
    oracle_plane(cell, k, normal, &offset);
    const long double weight = (offset - oracle_dot(normal, point)) / (offset - oracle_dot(normal, cell->corner[k]));
    sum += weight * cell->scalar[k];
    weights += weight;
  }
  return sum / weights;
}

static inline void oracle_look_up(const cellist_transfer *transfer, long double value, long double out[4]) {
  const cellist_transfer_knot *knots = transfer->knots;
  size_t i = 0;
  while (i < transfer->knot_count && (long double)knots[i].value < value) i++;
  const cellist_transfer_knot *low = &knots[i > 0 ? i - 1 : 0];
  const cellist_transfer_knot *high = &knots[i < transfer->knot_count ? i : transfer->knot_count - 1];
  const long double width = (long double)high->value - (long double)low->value;
  const long double part = i > 0 && width > 0 ? fminl(1, (value - (long double)low->value) / width) : 1;
  for (int c = 0; c < 3; c++) out[c] = low->colour[c] + part * ((long double)high->colour[c] - low->colour[c]);
  out[3] = low->extinction + part * ((long double)high->extinction - low->extinction);
}

/* Emission and absorption from scalar front to back over a length; panels of five Gauss points between knots. */
static inline void oracle_integrate(const cellist_transfer *transfer, long double front, long double back,
                                    long double length, long double rgba[4]) {
  static const long double node[5] = {0.046910077030668003601L, 0.230765344947158454482L, 0.5L,
                                      0.769234655052841545518L, 0.953089922969331996399L};
  static const long double weight[5] = {0.118463442528094543757L, 0.239314335249683234021L, 0.284444444444444444444L,
                                        0.239314335249683234021L, 0.118463442528094543757L};
  enum { MAX_CUTS = 64, PANELS = 8 };
  long double cuts[MAX_CUTS];
  int count = 0;
  cuts[count++] = 0;
  for (size_t i = 0; i < transfer->knot_count && count < MAX_CUTS - 1; i++) {
    const size_t at = back > front ? i : transfer->knot_count - 1 - i;
    const long double w = (transfer->knots[at].value - front) / (back - front);
    if (w > cuts[count - 1] && w < 1) cuts[count++] = w;
  }
  cuts[count++] = 1;
  for (int c = 0; c < 4; c++) rgba[c] = 0;
  long double depth = 0;
  for (int piece = 0; piece + 1 < count; piece++) {
    long double ends[2][4], coarse = 0;
    const long double width = cuts[piece + 1] - cuts[piece];
    for (int e = 0; e < 2; e++) {
      oracle_look_up(transfer, front + (cuts[piece] + (e ? 1 - 1e-12L : 1e-12L) * width) * (back - front), ends[e]);
      coarse = fmaxl(coarse, ends[e][3] * width * length);
    }
    const int panels = PANELS + (coarse < 4000 ? (int)coarse : 4000); /* each of depth 1 or so */
    for (int panel = 0; panel < panels; panel++) {
      const long double step = 1.0L / panels;
      for (int g = 0; g < 5; g++) {
        const long double w = (panel + node[g]) * step; /* extinction is linear: its integral is a parabola */
        const long double here = ends[0][3] + w * (ends[1][3] - ends[0][3]);
        const long double so_far = depth + width * length * w * 0.5L * (ends[0][3] + here);
        for (int c = 0; c < 3; c++)
          rgba[c] +=
              weight[g] * step * width * length * here * (ends[0][c] + w * (ends[1][c] - ends[0][c])) * expl(-so_far);
      }
    }
    depth += 0.5L * (ends[0][3] + ends[1][3]) * width * length;
  }
  rgba[3] = -expm1l(-depth);
}

static inline oracle_pixel oracle_trace(const oracle_cell *cell, const cellist_frame *frame,
                                        const cellist_transfer *transfer, double x, double y) {
  double origin_[3], direction_[3];
  cellist_frame_ray(frame, x, y, origin_, direction_);
  long double origin[3], direction[3];
  for (int k = 0; k < 3; k++) {
    origin[k] = origin_[k];
    direction[k] = direction_[k];
  }
  oracle_pixel pixel = {.front = frame->near_distance, .back = INFINITY};
  for (int k = 0; k < 4; k++) {
    long double normal[3], offset;
    oracle_plane(cell, k, normal, &offset);
    const long double speed = oracle_dot(normal, direction), start = offset - oracle_dot(normal, origin);
    if (speed > 0)
      pixel.back = fminl(pixel.back, start / speed);
    else if (speed < 0)
      pixel.front = fmaxl(pixel.front, start / speed);
    else if (start < 0)
      pixel.back = -INFINITY;
  }
  if (!(pixel.front < pixel.back)) return pixel;
  long double near_point[3], far_point[3];
  for (int k = 0; k < 3; k++) {
    near_point[k] = origin[k] + pixel.front * direction[k];
    far_point[k] = origin[k] + pixel.back * direction[k];
  }
  oracle_integrate(transfer, oracle_scalar(cell, near_point), oracle_scalar(cell, far_point),
                   (pixel.back - pixel.front) * sqrtl(oracle_dot(direction, direction)), pixel.rgba);
  return pixel;
}

#endif
