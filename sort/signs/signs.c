/* SPDX-License-Identifier: BSD-3-Clause
 * Signs: on which side of each shared face the eye lies, exact though most are found in 16-bit integers.
 *
 * A plane and an eye are four numbers each, whose product's sign is the answer. Both are scaled to a length just below
 * 2^15 and rounded: then the product is exact in 32 bits, and off by less than half the sum of all eight numbers'
 * magnitudes. What lies within that is decided by orient3d on the points as given: one face in ten thousand from a
 * general viewpoint. Where a parallel view along an axis looks along a regular grid's planes there would be two a tet;
 * these are known from the start, as faces whose normal has a coordinate that is exactly 0. */
#include "signs.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "../state.h"

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

/* Fewer groups are not worth waking another thread for: 0.1 ms. */
enum { PARALLEL_MINIMUM = 16384 };

struct job {
  const sort_cells *cells;
  sort_planes *planes;
  const sort_eye *eye;
  int16_t eye_numbers[4];
  int32_t doubt;
  uint8_t *states;
  const sort_ends *ends; /* or NULL */
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

static void quantise_face(const sort_planes *planes, const double *a, const double *b, const double *c,
                          int16_t out[4]) {
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

/* True only if coordinate k of the normal of a, b, c is exactly 0, for a reason that is quick to see: seen along axis k
 * two of the points are one, or all three stand in one row or column, or their line is found without rounding. */
static bool is_level(const double *a, const double *b, const double *c, int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const bool ab_i = a[i] == b[i], ab_j = a[j] == b[j], ac_i = a[i] == c[i], ac_j = a[j] == c[j];
  if ((ab_i && ab_j) || (ac_i && ac_j) || (b[i] == c[i] && b[j] == c[j])) return true;
  if ((ab_i && ac_i) || (ab_j && ac_j)) return true;
  const double u_i = b[i] - a[i], u_j = b[j] - a[j], w_i = c[i] - a[i], w_j = c[j] - a[j];
  return are_equal(u_i, w_j, u_j, w_i) && is_exact(b[i], a[i], u_i) && is_exact(b[j], a[j], u_j) &&
         is_exact(c[i], a[i], w_i) && is_exact(c[j], a[j], w_j);
}

static void quantise_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct job *job = user;
  for (size_t group = begin; group < end; group++) {
    int16_t *out = &job->planes->planes[64 * group];
    uint32_t inner = 0, level[3] = {0, 0, 0};
    memset(out, 0, 64 * sizeof *out);
    for (size_t i = 0; i < 4 && 4 * group + i < job->cells->count; i++) {
      const size_t cell = 4 * group + i;
      for (uint32_t k = 0; k < 4; k++) {
        if (job->cells->neighbours[4 * cell + k] == CELLIST_NONE) continue;
        const double *p[3];
        sort_cell_face(job->cells, cell, k, p);
        inner |= 1u << (4 * i + k);
        for (int c = 0; c < 3; c++) level[c] |= (uint32_t)is_level(p[0], p[1], p[2], c) << (4 * i + k);
        quantise_face(job->planes, p[0], p[1], p[2], &out[16 * i + 4 * k]);
      }
    }
    job->planes->inner[group] = (uint16_t)inner;
    for (int c = 0; c < 3; c++) job->planes->level[c][group] = (uint16_t)level[c];
  }
}

cellist_result sort_planes_create(cellist_context *context, const sort_cells *cells, sort_planes *planes) {
  planes->group_count = (cells->count + 3) / 4;
  planes->kernel = sort_has_avx2() ? sort_signs_avx2 : sort_signs_portable;
  planes->planes = cellist_allocate(context, planes->group_count, 64 * sizeof *planes->planes);
  planes->inner = cellist_allocate(context, planes->group_count, sizeof *planes->inner);
  if (planes->planes == NULL || planes->inner == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (int k = 0; k < 3; k++) {
    planes->level[k] = cellist_allocate(context, planes->group_count, sizeof *planes->level[k]);
    if (planes->level[k] == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  }
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
  for (int k = 0; k < 3; k++) cellist_deallocate(context, planes->level[k]);
  *planes = (sort_planes){0};
}

/* True only if the eye lies exactly in the plane of a, b, c, for a reason that is quick to see: in each coordinate, the
 * eye is level with a or the normal is 0. */
static bool is_in_plane(const sort_eye *eye, const double *a, const double *b, const double *c) {
  for (int k = 0; k < 3; k++)
    if (!(eye->parallel ? eye->at[k] == 0 : eye->at[k] == a[k]) && !is_level(a, b, c, k)) return false;
  return true;
}

static void decide(const struct job *job, size_t cell, uint32_t k) {
  const double *p[3];
  sort_cell_face(job->cells, cell, k, p);
  if (is_in_plane(job->eye, p[0], p[1], p[2])) return;
  const int side = sort_eye_side(job->eye, p[0], p[1], p[2]);
  job->states[cell] = (uint8_t)(job->states[cell] + (side > 0 ? 1 << k : side < 0 ? SORT_WAIT : 0));
  if (job->ends == NULL || !job->ends->is_near[cell / SORT_BLOCK]) return;
  uint8_t *mirrored = &job->ends->mirrored[cell];
  *mirrored = (uint8_t)(*mirrored + (side < 0 ? 1 << k : side > 0 ? SORT_WAIT : 0));
}

/* Faces in whose planes a parallel view's eye lies, since each coordinate is 0 in its direction or in their normals. */
static void drop_faces_along_the_view(const struct job *job, size_t begin, size_t end, uint16_t *undecided) {
  static const uint16_t all = UINT16_MAX;
  const uint16_t *level[3];
  size_t step[3];
  for (int k = 0; k < 3; k++) {
    step[k] = job->eye->at[k] != 0;
    level[k] = step[k] ? &job->planes->level[k][begin] : &all;
  }
  for (size_t i = 0; i < end - begin; i++)
    undecided[i] &= (uint16_t) ~(level[0][i * step[0]] & level[1][i * step[1]] & level[2][i * step[2]]);
}

static void find_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct job *job = user;
  const sort_planes *planes = job->planes;
  uint16_t undecided[CHUNK];
  const size_t step = job->ends != NULL ? SORT_BLOCK / 4 : CHUNK;
  for (size_t i = begin; i < end; i += step) {
    const size_t count = end - i < step ? end - i : step, block = 4 * i / SORT_BLOCK;
    const bool is_near = job->ends != NULL && job->ends->is_near[block];
    uint8_t *states = &job->states[4 * i], *mirrored = job->ends != NULL ? &job->ends->mirrored[4 * i] : NULL;
    planes->kernel(&planes->planes[64 * i], &planes->inner[i], job->eye_numbers, job->doubt, count, states,
                   is_near ? mirrored : NULL, &undecided[i - begin]);
    for (size_t cell = 0; cell < 4 * count && is_near; cell++) states[cell] = (uint8_t)(states[cell] + SORT_WAIT);
    if (mirrored != NULL && !is_near) memset(mirrored, SORT_HELD, 4 * count);
  }
  size_t count = 0;
  if (job->eye->parallel) drop_faces_along_the_view(job, begin, end, undecided);
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
                               const sort_eye *eye, uint8_t *states, const sort_ends *ends) {
  struct job job = {.cells = cells, .planes = (sort_planes *)planes, .eye = eye, .states = states, .ends = ends};
  double numbers[4] = {eye->at[0], eye->at[1], eye->at[2], 0};
  for (int k = 0; k < 3 && !eye->parallel; k++) numbers[k] = (eye->at[k] - planes->centre[k]) / planes->radius;
  if (!eye->parallel) numbers[3] = 1;
  quantise(numbers, job.eye_numbers);
  double sum = 0;
  for (int k = 0; k < 4; k++) sum += abs(job.eye_numbers[k]);
  /* A plane's four numbers, of length at most LENGTH + 1, add up to at most twice that. */
  job.doubt = (int32_t)ceil(ROUNDING * (sum + 2 * (LENGTH + 1)) + 4 * ROUNDING * ROUNDING);
  atomic_init(&job.undecided_count, 0);
  const size_t group_count = planes->group_count;
  if (group_count >= PARALLEL_MINIMUM)
    cellist_parallel_for(context, group_count, CHUNK, find_range, &job);
  else
    for (size_t i = 0; i < group_count; i += CHUNK)
      find_range(&job, i, group_count - i < CHUNK ? group_count : i + CHUNK, 0);
  return atomic_load(&job.undecided_count);
}
