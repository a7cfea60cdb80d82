/* SPDX-License-Identifier: BSD-3-Clause
 * Signs: on which side of each shared face the eye lies, exact though most are found in 16-bit integers.
 *
 * A plane and an eye are four numbers each, whose product's sign is the answer. Both are scaled to a length just below
 * 2^15 and rounded: then the product is exact in 32 bits, and off by less than half the sum of all eight numbers'
 * magnitudes. What lies within that is decided by orient3d on the points as given: one face in ten thousand from a
 * general viewpoint, and many where an axis-aligned view looks along a regular grid's planes; for these a
 * quick test finds most exact zeros. */
#include "signs.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Just below 2^15: rounding adds at most 1 to the length. */
static const double LENGTH = 32766;

/* Rounding to integers moves a number by 0.5; the rest is room for the rounding of doubles before it (see FLATTEST).
 * Less, and a sign may be wrong. */
static const double ROUNDING = 0.51;

/* A face whose normal is shorter than this part of its edges' product has too few right digits for 16 bits: it always
 * goes to the exact test. At 1e-8, doubles move a plane's number by 32766 * 4 * 1.1e-16 / 1e-8 = 0.0015, well below
 * 0.01. */
static const double FLATTEST = 1e-8;

enum { CHUNK = 1024 }; /* groups a range: so many masks stand on the stack */

struct job {
  const sort_cells *cells;
  sort_planes *planes;
  const sort_eye *eye;
  int16_t eye_numbers[4];
  int32_t doubt;
  uint8_t *states;
  atomic_size_t undecided_count;
};

static void quantise(const double numbers[4], int16_t out[4]) {
  double largest = 0, squared = 0;
  for (int k = 0; k < 4; k++) largest = fmax(largest, fabs(numbers[k]));
  memset(out, 0, 4 * sizeof *out);
  if (!(largest > 0) || !isfinite(largest)) return;
  for (int k = 0; k < 4; k++) squared += numbers[k] / largest * (numbers[k] / largest);
  const double scale = LENGTH / sqrt(squared);
  for (int k = 0; k < 4; k++) out[k] = (int16_t)lrint(numbers[k] / largest * scale);
}

static void quantise_face(const sort_cells *cells, const sort_planes *planes, size_t cell, uint32_t k, int16_t out[4]) {
  const double *p[3];
  sort_cell_face(cells, cell, k, p);
  const double *a = p[0], *b = p[1], *c = p[2];
  double u[3], w[3], numbers[4] = {0, 0, 0, 0}, u_sum = 0, w_sum = 0, length = 0;
  for (int i = 0; i < 3; i++) {
    u[i] = (b[i] - a[i]) / planes->radius;
    w[i] = (c[i] - a[i]) / planes->radius;
    u_sum += fabs(u[i]);
    w_sum += fabs(w[i]);
  }
  for (int i = 0; i < 3; i++) {
    numbers[i] = u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
    numbers[3] -= numbers[i] * ((a[i] - planes->centre[i]) / planes->radius);
    length = fmax(length, fabs(numbers[i]));
  }
  /* The second condition: products that may have lost digits below the smallest normal number. */
  if (!(length > FLATTEST * u_sum * w_sum) || !(length > 1e-290)) memset(numbers, 0, sizeof numbers);
  quantise(numbers, out);
}

static void quantise_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct job *job = user;
  for (size_t group = begin; group < end; group++) {
    int16_t *out = &job->planes->planes[64 * group];
    uint32_t inner = 0;
    memset(out, 0, 64 * sizeof *out);
    for (size_t i = 0; i < 4 && 4 * group + i < job->cells->count; i++) {
      const size_t cell = 4 * group + i;
      for (uint32_t k = 0; k < 4; k++) {
        if (job->cells->neighbours[4 * cell + k] == CELLIST_NONE) continue;
        inner |= 1u << (4 * i + k);
        quantise_face(job->cells, job->planes, cell, k, &out[16 * i + 4 * k]);
      }
    }
    job->planes->inner[group] = (uint16_t)inner;
  }
}

cellist_result sort_planes_create(cellist_context *context, const sort_cells *cells, sort_planes *planes) {
  planes->group_count = (cells->count + 3) / 4;
  planes->kernel = sort_has_avx2() ? sort_signs_avx2 : sort_signs_portable;
  planes->planes = cellist_allocate(context, planes->group_count, 64 * sizeof *planes->planes);
  planes->inner = cellist_allocate(context, planes->group_count, sizeof *planes->inner);
  if (planes->planes == NULL || planes->inner == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < 4 * cells->tet_count; i++) {
    const double *p = &cells->points[3 * (size_t)cells->tets[i]];
    for (int k = 0; k < 3; k++) {
      low[k] = p[k] < low[k] ? p[k] : low[k];
      high[k] = p[k] > high[k] ? p[k] : high[k];
    }
  }
  for (int k = 0; k < 3; k++) {
    planes->centre[k] = 0.5 * low[k] + 0.5 * high[k];
    planes->radius = fmax(planes->radius, 0.5 * high[k] - 0.5 * low[k]);
  }
  struct job job = {.cells = cells, .planes = planes};
  cellist_parallel_for(context, planes->group_count, CHUNK, quantise_range, &job);
  return CELLIST_SUCCESS;
}

void sort_planes_release(cellist_context *context, sort_planes *planes) {
  cellist_deallocate(context, planes->planes);
  cellist_deallocate(context, planes->inner);
  *planes = (sort_planes){0};
}

/* Is a - b exactly `difference`? (Knuth's two-sum.) */
static bool is_exact(double a, double b, double difference) {
  const double b_back = a - difference, a_back = difference + b_back;
  return (a - a_back) + (b_back - b) == 0;
}

/* Are the two products certainly equal? Their factors are exact. */
static bool are_equal(double a, double b, double c, double d) {
  const double left = a * b, right = c * d;
  if (left != right) return false;
  if (left == 0) return (a == 0 || b == 0) && (c == 0 || d == 0); /* not by underflow */
  return fabs(left) > 1e-250 && fma(a, b, -left) == fma(c, d, -right);
}

/* True only if the eye lies exactly in the plane of a, b, c, for a reason that is quick to see: in each coordinate, the
 * eye is level with a or the normal is 0. That finds the ties of views along a regular grid's planes. */
static bool is_in_plane(const sort_eye *eye, const double *a, const double *b, const double *c) {
  double u[3], w[3];
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    w[k] = c[k] - a[k];
    if (!is_exact(b[k], a[k], u[k]) || !is_exact(c[k], a[k], w[k])) return false;
  }
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    if (eye->parallel ? eye->at[k] == 0 : eye->at[k] == a[k]) continue;
    if (!are_equal(u[i], w[j], u[j], w[i])) return false;
  }
  return true;
}

static void decide(const struct job *job, size_t cell, uint32_t k) {
  const double *p[3];
  sort_cell_face(job->cells, cell, k, p);
  if (is_in_plane(job->eye, p[0], p[1], p[2])) return;
  const int side = sort_eye_side(job->eye, p[0], p[1], p[2]);
  job->states[cell] = (uint8_t)(job->states[cell] + (side > 0 ? 1 << k : side < 0 ? 16 : 0));
}

static void find_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct job *job = user;
  const sort_planes *planes = job->planes;
  uint16_t undecided[CHUNK];
  planes->kernel(&planes->planes[64 * begin], &planes->inner[begin], job->eye_numbers, job->doubt, end - begin,
                 &job->states[4 * begin], undecided);
  size_t count = 0;
  for (size_t i = 0; i < end - begin; i++) {
    for (uint32_t left = undecided[i]; left != 0; left &= left - 1) {
      const uint32_t bit = (uint32_t)__builtin_ctz(left);
      decide(job, 4 * (begin + i) + bit / 4, bit % 4);
      count++;
    }
  }
  atomic_fetch_add(&job->undecided_count, count);
}

size_t sort_planes_find_states(cellist_context *context, const sort_cells *cells, const sort_planes *planes,
                               const sort_eye *eye, uint8_t *states) {
  struct job job = {.cells = cells, .planes = (sort_planes *)planes, .eye = eye, .states = states};
  double numbers[4] = {eye->at[0], eye->at[1], eye->at[2], 0};
  for (int k = 0; k < 3 && !eye->parallel; k++) numbers[k] = (eye->at[k] - planes->centre[k]) / planes->radius;
  if (!eye->parallel) numbers[3] = 1;
  quantise(numbers, job.eye_numbers);
  double sum = 0;
  for (int k = 0; k < 4; k++) sum += abs(job.eye_numbers[k]);
  /* A plane's four numbers, of length at most LENGTH + 1, add up to at most twice that. */
  job.doubt = (int32_t)ceil(ROUNDING * (sum + 2 * (LENGTH + 1)) + 4 * ROUNDING * ROUNDING);
  atomic_init(&job.undecided_count, 0);
  cellist_parallel_for(context, planes->group_count, CHUNK, find_range, &job);
  return atomic_load(&job.undecided_count);
}
