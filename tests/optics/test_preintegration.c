/* SPDX-License-Identifier: BSD-3-Clause
 * Pre-integration: every entry against quadrature and closed forms, what lies between entries, and clean failures. */
#include <string.h>

#include "../../project/optics/preintegration_private.h"
#include "harness.h"
#include "segment.h"

static cellist_transfer_knot STEPS_AND_SPIKES[] = {
    {-0.5, 0.2, {0.1, 0.9, 0.3}}, {0.1, 0, {1, 0, 0}},    {0.303, 0, {0, 0, 1}},  {0.307, 40, {1, 1, 0}},
    {0.311, 0, {0, 1, 1}},        {0.62, 0.5, {0, 1, 0}}, {0.62, 3, {1, 0.5, 0}}, {0.7, 3, {0.2, 0.3, 0.9}},
    {0.7, 0, {0.5, 0.5, 0.5}},    {0.85, 0, {0, 0, 0.4}}, {1.7, 9, {0.3, 1, 0.2}}};
static const cellist_transfer STIFF = {sizeof STEPS_AND_SPIKES / sizeof *STEPS_AND_SPIKES, STEPS_AND_SPIKES};

static cellist_preintegration *make(cellist_context *context, uint32_t scalars, uint32_t lengths, double unit,
                                    const cellist_transfer *transfer) {
  const cellist_preintegration_desc desc = {0, 1, unit, scalars, lengths, true};
  cellist_preintegration *tables = NULL;
  assert_success(context, cellist_preintegration_create(context, &desc, transfer, &tables));
  return tables;
}

static double length_of_node(const cellist_preintegration_arrays *arrays, uint32_t k) {
  return -arrays->length_unit * log2(1 - (double)k / (arrays->length_count - 1));
}

static void expect(double found, double truth, double limit, const char *what) {
  if (!(fabs(found - truth) <= limit)) fail_msg("%s: %.9g instead of %.9g", what, found, truth);
}

/* Looked up at random nodes of finite length; limit: of everything that is seen. */
static void check_nodes(const cellist_preintegration *tables, const cellist_transfer *transfer, double limit) {
  const cellist_preintegration_arrays arrays = cellist_preintegration_get_arrays(tables);
  random_state random = {3};
  for (int i = 0; i < 4000; i++) {
    const double front = (double)random_below(&random, arrays.scalar_count) / (arrays.scalar_count - 1);
    const double back = (double)random_below(&random, arrays.scalar_count) / (arrays.scalar_count - 1);
    const double length = length_of_node(&arrays, (uint32_t)random_below(&random, arrays.length_count - 1));
    const segment truth = segment_integrate(transfer, front, back, length);
    cellist_preintegrated found;
    cellist_preintegration_look_up(tables, front, back, length, &found);
    expect(found.opacity, truth.opacity, limit, "opacity");
    for (int c = 0; c < 3; c++) {
      expect(found.colour[c], truth.colour[c], limit, "colour");
      expect(found.front[c], truth.front[c], limit, "front");
      expect(found.back[c], truth.back[c], limit, "back");
    }
    expect(found.opacity * found.centre, truth.first, limit, "centre");
    if (truth.opacity > 1e-3) {
      const double mean = truth.first / truth.opacity;
      expect(found.spread, sqrt(fmax(0, truth.second / truth.opacity - mean * mean)), 2e-3, "spread");
    }
  }
}

/* Each segment of an odd number of nodes and lengths, so that blocks of the window and groups of lengths are cut. */
TEST(entries_are_those_of_quadrature)
{
  cellist_context *context = harness_context(1);
  cellist_preintegration *tables = make(context, 29, 21, 0.3, &STIFF);
  check_nodes(tables, &STIFF, 3e-6);
  cellist_preintegration_destroy(tables);
  static const char *const names[] = {"ramp", "dense", "spikes", "viridis"};
  for (int i = 0; i < 4; i++) {
    const cellist_transfer_desc desc = {.source = names[i], .range = {0, 1}, .unit_distance = 0.7};
    cellist_transfer transfer;
    assert_success(context, cellist_transfer_load(context, &desc, &transfer));
    tables = make(context, 40, 16, 0.8, &transfer);
    check_nodes(tables, &transfer, 3e-6);
    cellist_preintegration_destroy(tables);
    cellist_transfer_release(context, &transfer);
  }
  harness_context_destroy(context);
}

/* Depths of thousands: panels, and what lies behind them is not seen. */
TEST(deep_entries_are_those_of_quadrature)
{
  cellist_context *context = harness_context(1);
  cellist_transfer_knot knots[] = {
      {0, 0, {1, 0, 0}}, {0.2, 3000, {0, 1, 0}}, {0.5, 0, {0, 0, 1}}, {0.8, 200, {1, 1, 1}}, {1, 1e5, {0, 1, 1}}};
  const cellist_transfer transfer = {5, knots};
  cellist_preintegration *tables = make(context, 24, 12, 1, &transfer);
  check_nodes(tables, &transfer, 2e-5);
  cellist_preintegration_destroy(tables);
  harness_context_destroy(context);
}

TEST(constant_extinction_has_its_closed_form)
{
  cellist_context *context = harness_context(1);
  cellist_transfer_knot knot = {0.4, 2.5, {0.2, 0.7, 1}};
  const cellist_transfer transfer = {1, &knot};
  cellist_preintegration *tables = make(context, 9, 17, 0.4, &transfer);
  const cellist_preintegration_arrays arrays = cellist_preintegration_get_arrays(tables);
  for (uint32_t b = 0; b < 9; b++)
    for (uint32_t f = 0; f < 9; f++)
      for (uint32_t k = 0; k < 16; k++) {
        const double length = length_of_node(&arrays, k), depth = knot.extinction * length;
        cellist_preintegrated found;
        cellist_preintegration_look_up(tables, f / 8.0, b / 8.0, length, &found);
        const double alpha = -expm1(-depth), at_back = k == 0 ? 0 : alpha / depth - (1 - alpha);
        expect(found.opacity, alpha, 1e-6, "opacity");
        for (int c = 0; c < 3; c++) {
          expect(found.colour[c], alpha * knot.colour[c], 1e-6, "colour");
          expect(found.back[c], at_back * knot.colour[c], 1e-6, "back");
        }
      }
  cellist_preintegration_destroy(tables);
  harness_context_destroy(context);
}

/* The first slice is emission alone: with extinction and colour equal to the scalar, the mean of its square over its
 * mean. */
TEST(the_first_slice_is_emission_alone)
{
  cellist_context *context = harness_context(1);
  cellist_transfer_knot knots[] = {{0, 0, {0, 0, 0}}, {1, 1, {1, 1, 1}}};
  const cellist_transfer transfer = {2, knots};
  cellist_preintegration *tables = make(context, 17, 8, 1, &transfer);
  const cellist_preintegration_arrays arrays = cellist_preintegration_get_arrays(tables);
  for (uint32_t b = 0; b < 17; b++)
    for (uint32_t f = 0; f < 17; f++) {
      if (f + b == 0) continue;
      const double F = f / 16.0, B = b / 16.0;
      const float *entry = &arrays.ambient[4 * ((size_t)(b * 17 + f) * 8)];
      expect(entry[0], 2.0 / 3 * (F * F + F * B + B * B) / (F + B), 2e-6, "colour");
      expect(entry[3], 0.5 * (F + B), 1e-6, "density");
    }
  cellist_preintegration_destroy(tables);
  harness_context_destroy(context);
}

/* [W]'s recurrence, at lengths that are nodes: 1 + 1 = 2 and 1 + 2 = 3 length units. */
TEST(entries_obey_the_recurrence)
{
  cellist_context *context = harness_context(1);
  cellist_preintegration *tables = make(context, 25, 9, 0.5, &STIFF);
  for (int f = 0; f < 25; f++)
    for (int b = 0; b < 25; b++)
      for (int rest = 1; rest <= 2; rest++) {
        if ((b - f) % (rest + 1) != 0) continue;
        const double front = f / 24.0, split = (f + (b - f) / (rest + 1)) / 24.0, back = b / 24.0;
        cellist_preintegrated first, second, whole;
        cellist_preintegration_look_up(tables, front, split, 0.5, &first);
        cellist_preintegration_look_up(tables, split, back, 0.5 * rest, &second);
        cellist_preintegration_look_up(tables, front, back, 0.5 * (1 + rest), &whole);
        const double through = 1 - first.opacity, h = 1.0 / (1 + rest);
        expect(whole.opacity, first.opacity + through * second.opacity, 2e-6, "opacity");
        for (int c = 0; c < 3; c++) {
          expect(whole.colour[c], first.colour[c] + through * second.colour[c], 3e-6, "colour");
          expect(whole.back[c], h * first.back[c] + through * (h * second.colour[c] + (1 - h) * second.back[c]), 3e-6,
                 "back");
        }
      }
  cellist_preintegration_destroy(tables);
  harness_context_destroy(context);
}

TEST(front_and_back_make_the_colour_in_every_entry)
{
  cellist_context *context = harness_context(1);
  cellist_preintegration *tables = make(context, 23, 13, 2, &STIFF);
  const cellist_preintegration_arrays arrays = cellist_preintegration_get_arrays(tables);
  for (size_t i = 0; i < 23 * 23 * 13; i++) {
    for (size_t c = 0; c < 3; c++) {
      expect(arrays.front[4 * i + c] + arrays.back[4 * i + c], arrays.ambient[4 * i + c], 1e-6, "sum");
      if (!(arrays.back[4 * i + c] >= 0 && arrays.ambient[4 * i + c] <= 1 + 1e-5))
        fail_msg("entry %zu: %.9g of %.9g", i, arrays.back[4 * i + c], arrays.ambient[4 * i + c]);
    }
    assert_true(arrays.ambient[4 * i + 3] >= 0);
    assert_true(arrays.front[4 * i + 3] >= 0 && arrays.front[4 * i + 3] <= 1 + 1e-6);
    assert_true(arrays.back[4 * i + 3] >= 0 && arrays.back[4 * i + 3] <= 0.51);
  }
  cellist_preintegration_destroy(tables);
  harness_context_destroy(context);
}

/* The last slice: the colour where the first extinction stands, whichever way the ray goes. */
TEST(infinite_segments_show_the_first_extinction)
{
  cellist_context *context = harness_context(1);
  cellist_transfer_knot knots[] = {{0.3, 0, {1, 0, 0}}, {0.4, 1, {0, 1, 0}}, {0.6, 1, {0, 1, 0}}, {0.6, 0, {0, 0, 1}}};
  const cellist_transfer transfer = {4, knots};
  cellist_preintegration *tables = make(context, 11, 8, 1, &transfer);
  static const double ENDS[][2] = {{0, 1}, {0.1, 0.5}, {0.5, 0.1}, {1, 0}, {0.5, 1}, {0.5, 0.5}, {0, 0.2}};
  static const double EXPECTED[][5] = {{1, 0, 0, 1, 0.3}, {1, 0, 0, 1, 0.5}, {0, 1, 0, 1, 0}, {0, 1, 0, 1, 0.4},
                                       {0, 1, 0, 1, 0},   {0, 1, 0, 1, 0},   {0, 0, 0, 0, 0}};
  for (int i = 0; i < 7; i++) {
    cellist_preintegrated found;
    cellist_preintegration_look_up(tables, ENDS[i][0], ENDS[i][1], 1e30, &found);
    for (int c = 0; c < 3; c++) expect(found.colour[c], EXPECTED[i][c], 1e-6, "colour");
    expect(found.opacity, EXPECTED[i][3], 1e-6, "opacity");
    if (found.opacity > 0) expect(found.centre, EXPECTED[i][4], 1e-6, "centre");
  }
  cellist_preintegration_destroy(tables);
  harness_context_destroy(context);
}

/* Between nodes a smooth transfer function errs with the square of the nodes' distance, a stiff one in proportion. */
TEST(errors_between_nodes_fall_with_the_size)
{
  cellist_context *context = harness_context(1);
  static const char *const names[] = {"ramp", "spikes"};
  static const double LIMIT[] = {1e-4, 1e-2}, RATIO[] = {2.5, 1.3};
  for (int n = 0; n < 2; n++) {
    const cellist_transfer_desc desc = {.source = names[n], .range = {0, 1}, .unit_distance = 1};
    cellist_transfer transfer;
    assert_success(context, cellist_transfer_load(context, &desc, &transfer));
    double last = LIMIT[n];
    for (uint32_t size = 32; size <= 128; size *= 2) {
      cellist_preintegration *tables = make(context, size, 32, 0.25, &transfer);
      random_state random = {9};
      double sum = 0, most = 0;
      enum { SEGMENTS = 4000 };
      for (int i = 0; i < SEGMENTS; i++) {
        const double front = random_unit(&random), length = random_unit(&random);
        const double back = fmin(1, fmax(0, front + random_between(&random, -1, 1) * length));
        const segment truth = segment_integrate(&transfer, front, back, length);
        cellist_preintegrated found;
        cellist_preintegration_look_up(tables, front, back, length, &found);
        for (int c = 0; c < 4; c++) {
          const double error = c < 3 ? found.colour[c] - truth.colour[c] : found.opacity - truth.opacity;
          sum += error * error;
          most = fmax(most, fabs(error));
        }
      }
      const double rmse = sqrt(sum / (4 * SEGMENTS));
      print_message("%s, %u nodes: rmse %.3g, most %.3g\n", names[n], size, rmse, most);
      if (!(rmse < last)) fail_msg("%s, %u nodes: rmse %g", names[n], size, rmse);
      last = rmse / RATIO[n];
      cellist_preintegration_destroy(tables);
    }
    cellist_transfer_release(context, &transfer);
  }
  harness_context_destroy(context);
}

static bool same_tables(const cellist_preintegration *a, const cellist_preintegration *b) {
  const cellist_preintegration_arrays x = cellist_preintegration_get_arrays(a),
                                      y = cellist_preintegration_get_arrays(b);
  const size_t bytes = (size_t)x.scalar_count * x.scalar_count * x.length_count * 4 * sizeof(float);
  return memcmp(x.ambient, y.ambient, bytes) == 0 && memcmp(x.front, y.front, bytes) == 0 &&
         memcmp(x.back, y.back, bytes) == 0;
}

TEST(updates_workers_and_kernels_change_no_bit)
{
  cellist_context *context = harness_context(1), *other = harness_context(3);
  cellist_transfer_knot knot = {0, 5, {1, 1, 1}};
  const cellist_transfer constant = {1, &knot};
  cellist_preintegration *expected = make(context, 31, 20, 0.7, &STIFF);
  cellist_preintegration *found = make(other, 31, 20, 0.7, &constant);
  assert_false(same_tables(expected, found));
  assert_success(other, cellist_preintegration_update(found, &STIFF));
  assert_true(same_tables(expected, found));
  assert_success(other, cellist_preintegration_update(found, &constant));
  preintegration_use_portable(found);
  assert_success(other, cellist_preintegration_update(found, &STIFF));
  assert_true(same_tables(expected, found));
  cellist_preintegration_destroy(found);
  cellist_preintegration_destroy(expected);
  harness_context_destroy(context);
  harness_context_destroy(other);
}

/* Wild but legal numbers give finite tables. */
TEST(wild_transfer_functions_give_finite_tables)
{
  cellist_context *context = harness_context(1);
  cellist_transfer_knot wild[] = {{-1e300, 1e300, {1, 0, 0}}, {0.2, 1e-300, {0, 1e3, 0}}, {0.2, 0, {0, 0, 1}},
                                  {0.5, 1e30, {1, 1, 1}},     {0.5000001, 0, {1, 0, 1}},  {1e308, 1, {0, 0, 0}}};
  const cellist_transfer transfers[] = {{6, wild}, {1, wild}, {1, &wild[2]}, {2, &wild[2]}};
  for (int i = 0; i < 4; i++) {
    cellist_preintegration *tables = make(context, 12, 10, 3, &transfers[i]);
    const cellist_preintegration_arrays arrays = cellist_preintegration_get_arrays(tables);
    for (size_t e = 0; e < (size_t)4 * 12 * 12 * 10; e++)
      assert_true(isfinite(arrays.ambient[e]) && isfinite(arrays.front[e]) && isfinite(arrays.back[e]));
    cellist_preintegrated found;
    cellist_preintegration_look_up(tables, -5, 7, 0, &found);
    assert_true(found.opacity == 0 && found.colour[1] == 0);
    cellist_preintegration_destroy(tables);
  }
  harness_context_destroy(context);
}

static cellist_result make_and_update(cellist_context *context, void *user) {
  (void)user;
  const cellist_preintegration_desc desc = {0, 1, 1, 6, 5, true};
  cellist_preintegration *tables = NULL;
  cellist_result result = cellist_preintegration_create(context, &desc, &STIFF, &tables);
  if (result == CELLIST_SUCCESS) result = cellist_preintegration_update(tables, &STIFF);
  cellist_preintegration_destroy(tables);
  return result;
}

TEST(preintegration_fails_cleanly_without_memory)
{ check_allocation_failures(make_and_update, NULL); }

TEST(bad_sizes_and_numbers_are_refused)
{
  cellist_context *context = harness_context(1);
  const cellist_preintegration_desc bad[] = {{.minimum = 1, .maximum = 1},      {.minimum = 0, .maximum = INFINITY},
                                             {.maximum = 1, .length_unit = -1}, {.maximum = 1, .scalar_count = 1},
                                             {.maximum = 1, .length_count = 2}, {.maximum = 1, .scalar_count = 4096}};
  cellist_preintegration *tables = NULL;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_failure(context, cellist_preintegration_create(context, &bad[i], &STIFF, &tables),
                   CELLIST_ERROR_INVALID_ARGUMENT, "tables");
  const cellist_preintegration_desc good = {.maximum = 1, .scalar_count = 8, .length_count = 8};
  cellist_transfer_knot knots[] = {{1, 1, {0}}, {0, 1, {0}}};
  const cellist_transfer disordered = {2, knots};
  assert_failure(context, cellist_preintegration_create(context, &good, &disordered, &tables),
                 CELLIST_ERROR_INVALID_ARGUMENT, "");
  assert_failure(context, cellist_preintegration_create(context, &good, NULL, &tables), CELLIST_ERROR_INVALID_ARGUMENT,
                 "NULL");
  assert_success(context, cellist_preintegration_create(context, &good, &STIFF, &tables));
  assert_null(cellist_preintegration_get_arrays(tables).front);
  cellist_preintegrated before, after;
  cellist_preintegration_look_up(tables, 0.2, 0.8, 1, &before);
  assert_failure(context, cellist_preintegration_update(tables, &disordered), CELLIST_ERROR_INVALID_ARGUMENT, "");
  cellist_preintegration_look_up(tables, 0.2, 0.8, 1, &after);
  assert_memory_equal(&before, &after, sizeof before);
  cellist_preintegration_destroy(tables);
  cellist_preintegration_destroy(NULL);
  harness_context_destroy(context);
}
