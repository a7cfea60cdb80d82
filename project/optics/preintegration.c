/* SPDX-License-Identifier: BSD-3-Clause
 * Pre-integration after [C], section 8, and [W], section 4: tables over (s_f, s_b, l'), l' = 1 - 2^(-l/l0).
 *
 * Where it differs, and why. The entries are exact to float, not to the table's resolution: preintegration_kernel.h
 * says how. Stored are colours as they are seen, not premultiplied, and the density for a unit of length: both change
 * little with the length, so what is interpolated is nearly linear, and the opacity, which depends on the length most,
 * is exact in it. The last slice, l' = 1, is the limit: the colour where the first extinction stands. */
#if defined(__linux__) && !defined(_DEFAULT_SOURCE)
#define _DEFAULT_SOURCE /* madvise */
#endif
#include <cellist/preintegration.h>
#include <string.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "preintegration_private.h"

enum { SIZE_LIMIT = 1024 };

/* Extinctions per length unit are cut off here, so that the squares of depths fit a float. */
static const double EXTINCTION_LIMIT = 1e12;
/* Added to every extinction, as a share of the largest one, where colours are weighed: so transparent segments have a
 * colour, that of the range. Larger tints what is seen through long transparent stretches. */
static const double EXTINCTION_FLOOR = 1e-9;
/* The depth that stands for 0 in the first slice, whose colours are limits; the colours then err by half of it. */
static const double THIN_DEPTH = 1e-6;
/* Knots further out than this many ranges are as good as infinitely far. */
static const double FAR_PLACE = 1e200;

struct cellist_preintegration {
  cellist_context *context;
  uint32_t scalar_count, length_count;
  double minimum, maximum, length_unit;
  preintegration_kernel kernel;
  float *ambient, *front, *back;
};

/* The transfer function in one direction along the scalar. */
struct direction {
  preintegration_job job;
  preintegration_piece *pieces;
  uint32_t *piece_begin;
  double *depths;
  double *place;           /* [scalar_count] of the first extinction at or beyond a node; infinite if there is none */
  const float **colour;    /* [scalar_count] there */
  double *true_extinction; /* [2 pieces] without the floor */
};

static preintegration_kernel best_kernel(void) {
#ifdef CELLIST_PREINTEGRATION_AVX2
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return preintegration_fill_avx2;
#endif
  return preintegration_fill_portable;
}

static void direction_release(cellist_context *context, struct direction *direction) {
  cellist_deallocate(context, direction->pieces);
  cellist_deallocate(context, direction->piece_begin);
  cellist_deallocate(context, direction->depths);
  cellist_deallocate(context, direction->place);
  cellist_deallocate(context, (void *)direction->colour);
  cellist_deallocate(context, direction->true_extinction);
}

static bool direction_allocate(cellist_context *context, size_t nodes, size_t pieces, struct direction *direction) {
  direction->pieces = cellist_allocate(context, pieces, sizeof *direction->pieces);
  direction->piece_begin = cellist_allocate(context, nodes, sizeof *direction->piece_begin);
  direction->depths = cellist_allocate(context, nodes, sizeof *direction->depths);
  direction->place = cellist_allocate(context, nodes, sizeof *direction->place);
  direction->colour = cellist_allocate(context, nodes, sizeof *direction->colour);
  direction->true_extinction = cellist_allocate(context, pieces, 2 * sizeof *direction->true_extinction);
  return direction->pieces != NULL && direction->piece_begin != NULL && direction->depths != NULL &&
         direction->place != NULL && direction->colour != NULL && direction->true_extinction != NULL;
}

static double place_of(const cellist_preintegration *tables, double value) {
  const double share = (0.5 * value - 0.5 * tables->minimum) / (0.5 * tables->maximum - 0.5 * tables->minimum);
  return fmax(-FAR_PLACE, fmin(FAR_PLACE, share * (tables->scalar_count - 1)));
}

static double extinction_of(const cellist_preintegration *tables, const cellist_transfer_knot *knot) {
  return fmin(knot->extinction * tables->length_unit, EXTINCTION_LIMIT);
}

static double largest_extinction(const cellist_preintegration *tables, const cellist_transfer *transfer) {
  double largest = 0;
  for (size_t i = 0; i < transfer->knot_count; i++) largest = fmax(largest, extinction_of(tables, &transfer->knots[i]));
  return largest;
}

static double floor_of(double largest) { return largest > 0 ? fmax(EXTINCTION_FLOOR * largest, 1e-25) : 1; }

/* The transfer function cut at its knots and at the nodes, upwards. */
static void cut_into_pieces(const cellist_preintegration *tables, const cellist_transfer *transfer,
                            struct direction *up) {
  const uint32_t elements = tables->scalar_count - 1;
  const double floor_extinction = floor_of(largest_extinction(tables, transfer));
  const cellist_transfer_knot *knots = transfer->knots;
  uint32_t count = 0, begun = 0; /* elements that have their first piece */
  for (size_t i = 0; i <= transfer->knot_count; i++) {
    const cellist_transfer_knot *below = &knots[i > 0 ? i - 1 : 0];
    const cellist_transfer_knot *above = &knots[i < transfer->knot_count ? i : transfer->knot_count - 1];
    const double low = i > 0 ? place_of(tables, below->value) : -HUGE_VAL;
    const double high = i < transfer->knot_count ? place_of(tables, above->value) : HUGE_VAL;
    const bool is_constant = i == 0 || i == transfer->knot_count;
    double at = fmax(low, 0);
    const double until = fmin(high, elements);
    while (at < until) {
      const uint32_t element = (uint32_t)at;
      const double end = fmin(until, element + 1.0);
      while (begun <= element) up->piece_begin[begun++] = count;
      preintegration_piece *piece = &up->pieces[count];
      piece->place = (float)(at - element);
      piece->width = (float)(end - at);
      for (int e = 0; e < 2; e++) {
        const double w = is_constant ? 0 : ((e == 0 ? at : end) - low) / (high - low);
        const double extinction = (1 - w) * extinction_of(tables, below) + w * extinction_of(tables, above);
        up->true_extinction[2 * count + (uint32_t)e] = extinction;
        piece->extinction[e] = (float)(extinction + floor_extinction);
        for (int c = 0; c < 3; c++) piece->colour[e][c] = (float)((1 - w) * below->colour[c] + w * above->colour[c]);
      }
      count++;
      at = end;
    }
  }
  while (begun <= elements) up->piece_begin[begun++] = count;
}

static void reverse(const struct direction *up, struct direction *down) {
  const uint32_t elements = up->job.scalar_count - 1, count = up->piece_begin[elements];
  for (uint32_t i = 0; i <= elements; i++) down->piece_begin[i] = count - up->piece_begin[elements - i];
  for (uint32_t i = 0; i < count; i++) {
    const preintegration_piece *from = &up->pieces[count - 1 - i];
    preintegration_piece *to = &down->pieces[i];
    to->place = fmaxf(0, 1 - from->place - from->width);
    to->width = from->width;
    for (int e = 0; e < 2; e++) {
      to->extinction[e] = from->extinction[1 - e];
      down->true_extinction[2 * i + (uint32_t)e] = up->true_extinction[2 * (count - 1 - i) + (uint32_t)(1 - e)];
      memcpy(to->colour[e], from->colour[1 - e], sizeof to->colour[e]);
    }
  }
}

/* Depths up to each node, and where the first extinction beyond it stands. */
static void look_ahead(struct direction *direction) {
  const uint32_t elements = direction->job.scalar_count - 1;
  direction->depths[0] = 0;
  for (uint32_t i = 0; i < elements; i++) {
    double depth = 0;
    for (uint32_t p = direction->piece_begin[i]; p < direction->piece_begin[i + 1]; p++)
      depth += 0.5 * direction->pieces[p].width *
               (direction->true_extinction[2 * p] + direction->true_extinction[2 * p + 1]);
    direction->depths[i + 1] = direction->depths[i] + depth;
  }
  direction->place[elements] = HUGE_VAL;
  direction->colour[elements] = NULL;
  for (uint32_t i = elements; i-- > 0;) {
    direction->place[i] = direction->place[i + 1];
    direction->colour[i] = direction->colour[i + 1];
    for (uint32_t p = direction->piece_begin[i + 1]; p-- > direction->piece_begin[i];) {
      if (!(direction->true_extinction[2 * p] + direction->true_extinction[2 * p + 1] > 0)) continue;
      direction->place[i] = i + (double)direction->pieces[p].place;
      direction->colour[i] = direction->pieces[p].colour[0];
    }
  }
}

struct build {
  const cellist_preintegration *tables;
  const struct direction *directions; /* [2] */
  float *scratch;
  size_t scratch_floats; /* of each worker */
};

/* The limit of infinite length of the pairs `step` nodes apart. */
static void fill_infinite(const struct direction *direction, uint32_t step) {
  const preintegration_job *job = &direction->job;
  const uint32_t last = job->scalar_count - 1;
  for (uint32_t start = 0; start + step <= last; start++) {
    const uint32_t front = job->descending ? last - start : start;
    const uint32_t back = job->descending ? front - step : front + step;
    const size_t at = 4 * ((((size_t)back * job->scalar_count + front) * job->length_count) + job->length_count - 1);
    const bool is_seen = direction->place[start] < start + (double)step;
    memcpy(&job->ambient[at], &job->ambient[at - 4], 4 * sizeof(float));
    if (is_seen) memcpy(&job->ambient[at], direction->colour[start], 3 * sizeof(float));
    if (job->front == NULL) continue;
    memcpy(&job->front[at], &job->front[at - 4], 4 * sizeof(float));
    memcpy(&job->back[at], &job->back[at - 4], 4 * sizeof(float));
    if (!is_seen) continue;
    const float w = (float)((direction->place[start] - start) / step);
    for (int c = 0; c < 3; c++) {
      job->back[at + (size_t)c] = w * direction->colour[start][c];
      job->front[at + (size_t)c] = direction->colour[start][c] - job->back[at + (size_t)c];
    }
    job->front[at + 3] = w;
    job->back[at + 3] = 0;
  }
}

static void fill_range(void *user, size_t begin, size_t end, unsigned worker) {
  const struct build *build = user;
  float *scratch = build->scratch + worker * build->scratch_floats;
  for (size_t i = begin; i < end; i++) {
    const struct direction *direction = &build->directions[i % 2];
    const uint32_t step = (uint32_t)(i / 2) + 1;
    build->tables->kernel(&direction->job, step, scratch);
    fill_infinite(direction, step);
  }
}

/* Mean and standard deviation of w, weighted by exp(-depth w) over 0..1. */
static void moments_of_constant(double depth, double *centre, double *spread) {
  double second;
  if (depth < 0.5) { /* Bernoulli series; the rest is below 1e-7 */
    *centre = 0.5 - depth / 12 * (1 - depth * depth / 60);
    const double variance = 1.0 / 12 * (1 - depth * depth / 20 * (1 - 5 * depth * depth / 126));
    second = variance + *centre * *centre;
  } else {
    const double behind = depth < 700 ? 1 / expm1(depth) : 0;
    *centre = 1 / depth - behind;
    second = 2 / depth * *centre - behind;
  }
  *spread = sqrt(fmax(0, second - *centre * *centre));
}

/* Segments of one scalar. */
static void fill_diagonal(const cellist_preintegration *tables, const cellist_transfer *transfer,
                          const float *lengths) {
  const uint32_t n = tables->scalar_count, lengths_count = tables->length_count;
  for (uint32_t i = 0; i < n; i++) {
    const double share = (double)i / (n - 1);
    double colour[3];
    double extinction =
        cellist_transfer_evaluate(transfer, (1 - share) * tables->minimum + share * tables->maximum, colour);
    extinction = fmin(extinction * tables->length_unit, EXTINCTION_LIMIT);
    for (uint32_t k = 0; k < lengths_count; k++) {
      const size_t at = 4 * (((size_t)i * n + i) * lengths_count + k);
      for (size_t c = 0; c < 3; c++) tables->ambient[at + c] = (float)colour[c];
      tables->ambient[at + 3] = (float)extinction;
      if (tables->front == NULL) continue;
      const bool is_infinite = k == lengths_count - 1;
      double centre = 0, spread = 0;
      if (!is_infinite || !(extinction > 0))
        moments_of_constant(is_infinite ? 0 : extinction * lengths[k], &centre, &spread);
      for (size_t c = 0; c < 3; c++) {
        tables->back[at + c] = (float)(centre * colour[c]);
        tables->front[at + c] = (float)colour[c] - tables->back[at + c];
      }
      tables->front[at + 3] = (float)centre;
      tables->back[at + 3] = (float)spread;
    }
  }
}

static void fill_lengths(const cellist_preintegration *tables, double largest, float *lengths) {
  const uint32_t count = tables->length_count;
  for (uint32_t k = 0; k < count + 7; k++) lengths[k] = k + 1 < count ? (float)-log2(1 - (double)k / (count - 1)) : 1;
  lengths[0] = (float)fmin(lengths[1], THIN_DEPTH / fmax(largest, 1e-20));
}

cellist_result cellist_preintegration_update(cellist_preintegration *tables, const cellist_transfer *transfer) {
  if (tables == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_context *context = tables->context;
  cellist_result result = cellist_transfer_check(context, transfer);
  if (result != CELLIST_SUCCESS) return result;
  const size_t nodes = tables->scalar_count, piece_limit = nodes + transfer->knot_count + 1;
  const unsigned workers = cellist_context_worker_count(context);
  struct direction directions[2] = {{.job = {.descending = false}}, {.job = {.descending = true}}};
  struct build build = {.tables = tables, .directions = directions, .scratch_floats = nodes * PREINTEGRATION_SCRATCH};
  float *lengths = cellist_allocate(context, tables->length_count + 7, sizeof *lengths);
  /* Room to begin at a multiple of 32 bytes. */
  float *scratch = cellist_allocate(context, workers * build.scratch_floats + 8, sizeof *scratch);
  if (lengths == NULL || scratch == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  for (int d = 0; d < 2 && result == CELLIST_SUCCESS; d++)
    if (!direction_allocate(context, nodes, piece_limit, &directions[d])) result = CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) {
    build.scratch = scratch + (32 - (uintptr_t)scratch % 32) % 32 / sizeof *scratch;
    fill_lengths(tables, largest_extinction(tables, transfer), lengths);
    for (int d = 0; d < 2; d++) {
      preintegration_job *job = &directions[d].job;
      job->scalar_count = tables->scalar_count;
      job->length_count = tables->length_count;
      job->pieces = directions[d].pieces;
      job->piece_begin = directions[d].piece_begin;
      job->depths = directions[d].depths;
      job->lengths = lengths;
      job->ambient = tables->ambient;
      job->front = tables->front;
      job->back = tables->back;
    }
    cut_into_pieces(tables, transfer, &directions[0]);
    reverse(&directions[0], &directions[1]);
    for (int d = 0; d < 2; d++) look_ahead(&directions[d]);
    fill_diagonal(tables, transfer, lengths);
    cellist_parallel_for(context, 2 * (nodes - 1), 1, fill_range, &build);
  }
  for (int d = 0; d < 2; d++) direction_release(context, &directions[d]);
  cellist_deallocate(context, scratch);
  cellist_deallocate(context, lengths);
  return result;
}

/* One array of the tables. The first touch of 67 MB in small pages takes longer than to fill them, so the system is
 * asked for large ones; it may decline. */
static float *allocate_entries(cellist_context *context, size_t entries) {
  float *made = cellist_allocate(context, entries, 4 * sizeof *made);
#ifdef MADV_HUGEPAGE
  const uintptr_t page = 4096, begin = ((uintptr_t)made + page - 1) / page * page;
  const uintptr_t end = ((uintptr_t)made + entries * 4 * sizeof *made) / page * page;
  if (made != NULL && end > begin) (void)madvise((void *)begin, end - begin, MADV_HUGEPAGE);
#endif
  return made;
}

static cellist_result check_desc(cellist_context *context, const cellist_preintegration_desc *desc) {
  const uint32_t scalars = desc->scalar_count, lengths = desc->length_count;
  if (!(desc->minimum < desc->maximum) || !isfinite(desc->minimum) || !isfinite(desc->maximum))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "tables need finite scalars minimum < maximum");
  if (!(desc->length_unit >= 0) || !isfinite(desc->length_unit))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the tables' length unit must be finite and above 0");
  if ((scalars != 0 && (scalars < 2 || scalars > SIZE_LIMIT)) ||
      (lengths != 0 && (lengths < 3 || lengths > SIZE_LIMIT)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "tables have 2 to %d scalars and 3 to %d lengths, not %u and %u", SIZE_LIMIT, SIZE_LIMIT,
                        scalars, lengths);
  return CELLIST_SUCCESS;
}

cellist_result cellist_preintegration_create(cellist_context *context, const cellist_preintegration_desc *desc,
                                             const cellist_transfer *transfer, cellist_preintegration **made) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (desc == NULL || transfer == NULL || made == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "cellist_preintegration_create: desc, transfer or made is NULL");
  cellist_result result = check_desc(context, desc);
  if (result != CELLIST_SUCCESS) return result;
  cellist_preintegration *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->scalar_count = desc->scalar_count != 0 ? desc->scalar_count : CELLIST_TABLE_SCALARS;
  created->length_count = desc->length_count != 0 ? desc->length_count : CELLIST_TABLE_LENGTHS;
  created->minimum = desc->minimum;
  created->maximum = desc->maximum;
  created->length_unit = desc->length_unit > 0 ? desc->length_unit : 1;
  created->kernel = best_kernel();
  const size_t entries = (size_t)created->scalar_count * created->scalar_count * created->length_count;
  created->ambient = allocate_entries(context, entries);
  if (desc->lit) created->front = allocate_entries(context, entries);
  if (desc->lit) created->back = allocate_entries(context, entries);
  if (created->ambient == NULL || (desc->lit && (created->front == NULL || created->back == NULL)))
    result = CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) result = cellist_preintegration_update(created, transfer);
  if (result == CELLIST_SUCCESS)
    *made = created;
  else
    cellist_preintegration_destroy(created);
  return result;
}

void cellist_preintegration_destroy(cellist_preintegration *tables) {
  if (tables == NULL) return;
  cellist_context *context = tables->context;
  cellist_deallocate(context, tables->ambient);
  cellist_deallocate(context, tables->front);
  cellist_deallocate(context, tables->back);
  cellist_deallocate(context, tables);
}

void preintegration_use_portable(cellist_preintegration *tables) { tables->kernel = preintegration_fill_portable; }

cellist_preintegration_arrays cellist_preintegration_get_arrays(const cellist_preintegration *tables) {
  return (cellist_preintegration_arrays){tables->scalar_count, tables->length_count, tables->minimum, tables->maximum,
                                         tables->length_unit,  tables->ambient,      tables->front,   tables->back};
}

/* The node below a place along an axis of n nodes, and how far beyond it the place lies. */
static uint32_t node_below(double place, uint32_t n, double *beyond) {
  const double cut = fmax(0, fmin(place, n - 1.0));
  uint32_t node = (uint32_t)cut;
  if (node > n - 2) node = n - 2;
  *beyond = cut - node;
  return node;
}

void cellist_preintegration_look_up(const cellist_preintegration *tables, double front, double back, double length,
                                    cellist_preintegrated *found) {
  const uint32_t n = tables->scalar_count, lengths = tables->length_count;
  const double scaled = length / tables->length_unit;
  double f, b, l;
  const uint32_t front_node = node_below(place_of(tables, front), n, &f);
  const uint32_t back_node = node_below(place_of(tables, back), n, &b);
  const uint32_t length_node = node_below((1 - exp2(-scaled)) * (lengths - 1), lengths, &l);
  const float *arrays[3] = {tables->ambient, tables->front, tables->back};
  double sum[3][4] = {{0}};
  for (uint32_t corner = 0; corner < 8; corner++) {
    const uint32_t i = front_node + (corner & 1), j = back_node + (corner >> 1 & 1), k = length_node + (corner >> 2);
    const double weight = (corner & 1 ? f : 1 - f) * (corner & 2 ? b : 1 - b) * (corner & 4 ? l : 1 - l);
    const size_t at = 4 * (((size_t)j * n + i) * lengths + k);
    for (int a = 0; a < 3; a++)
      for (size_t c = 0; c < 4 && arrays[a] != NULL; c++) sum[a][c] += weight * arrays[a][at + c];
  }
  *found = (cellist_preintegrated){.opacity = -expm1(-sum[0][3] * scaled), .centre = sum[1][3], .spread = sum[2][3]};
  for (int c = 0; c < 3; c++) {
    found->colour[c] = found->opacity * sum[0][c];
    found->front[c] = found->opacity * sum[1][c];
    found->back[c] = found->opacity * sum[2][c];
  }
}
