/* SPDX-License-Identifier: BSD-3-Clause
 * Fast optics against quadrature in 80-bit arithmetic: pieces, segments over many knots, deep and shallow ones. */
#include <stdlib.h>
#include <string.h>

#include "../../project/optics/fast_lanes.h"
#include "../raycast/oracle.h"
#include "harness.h"

TEST(a_piece_is_exact_to_single_precision)
{
  for (int i = 0; i <= 100; i++)
    for (int j = 0; j <= 40; j++) {
      const real sum = 2.0L * i / 100, a = sum * j / 40, b = sum - a;
      real front, back;
      oracle_weights(a, b, &front, &back);
      assert_true(fabsl((real)fast_alpha((float)(sum / 2)) - (front + back)) <= 2e-7L * (front + back));
      if (i > 0)
        assert_true(fabsl((real)fast_q((float)(sum / 2), 1 - 2 * (float)j / 40) - front / (front + back)) < 6e-7L);
    }
}

/* Knots at multiples of 1/256, so that they are the same in single precision. */
static cellist_transfer random_transfer(random_state *random, cellist_transfer_knot *knots, size_t count) {
  for (size_t i = 0; i < count; i++) {
    knots[i].value = (double)random_below(random, 257) / 256;
    knots[i].extinction = random_below(random, 4) == 0 ? 0 : pow(10, random_between(random, -2, 2));
    for (int k = 0; k < 3; k++) knots[i].colour[k] = random_unit(random);
  }
  for (size_t i = 1; i < count; i++)
    for (size_t j = i; j > 0 && knots[j].value < knots[j - 1].value; j--) {
      const cellist_transfer_knot swap = knots[j];
      knots[j] = knots[j - 1];
      knots[j - 1] = swap;
    }
  return (cellist_transfer){count, knots};
}

/* The transfer function on the side of `toward`, extrapolated from the interval that holds `middle`. */
static void sample(const cellist_transfer *transfer, double middle, double at, real value[4]) {
  const cellist_transfer_knot *knots = transfer->knots;
  size_t i = 0;
  while (i < transfer->knot_count && knots[i].value < middle) i++;
  const cellist_transfer_knot *a = &knots[i > 0 ? i - 1 : 0], *b = &knots[i < transfer->knot_count ? i : i - 1];
  const real w = a->value == b->value ? 0 : ((real)at - a->value) / ((real)b->value - a->value);
  value[3] = a->extinction + w * ((real)b->extinction - a->extinction);
  for (int k = 0; k < 3; k++) value[k] = a->colour[k] + w * ((real)b->colour[k] - a->colour[k]);
}

static void exact_segment(const cellist_transfer *transfer, double from, double to, double length, real light[4]) {
  double at = from;
  for (;;) {
    double end = to;
    for (size_t i = 0; i < transfer->knot_count; i++) {
      const double v = transfer->knots[i].value;
      if ((v > at && v < end) || (v < at && v > end)) end = v;
    }
    const real part = from == to ? (real)length : (real)length * ((real)end - at) / ((real)to - from);
    real f[4], b[4], front, back;
    sample(transfer, 0.5 * at + 0.5 * end, at, f);
    sample(transfer, 0.5 * at + 0.5 * end, end, b);
    oracle_weights(f[3] * part, b[3] * part, &front, &back);
    for (int k = 0; k < 3; k++) light[k] += light[3] * (front * f[k] + back * b[k]);
    light[3] *= expl(-(f[3] + b[3]) * part / 2);
    if (end == to) return;
    at = end;
  }
}

TEST(rays_of_many_segments_agree_with_quadrature)
{
  cellist_context *context = harness_context(1);
  random_state random = {7};
  for (int round = 0; round < 400; round++) {
    cellist_transfer_knot knots[12];
    const cellist_transfer transfer = random_transfer(&random, knots, 1 + random_below(&random, 12));
    fast_transfer table;
    assert_success(context, fast_transfer_create(context, &transfer, 0, 1, 1, true, &table));
    fast_light light = {{0}, 1, 0};
    real exact[4] = {0, 0, 0, 1};
    float at = (float)random_unit(&random);
    uint32_t interval = fast_find_interval(&table, at), pieces = 0;
    const double scale = pow(10, random_between(&random, -5, 2));
    for (int i = 0; i < 40 && light.transmittance >= table.opaque; i++) {
      float to =
          random_below(&random, 2) ? (float)random_unit(&random) : at + 0.01f * (float)(random_unit(&random) - 0.5);
      to = random_below(&random, 8) == 0 ? at : fminf(fmaxf(to, 0), 1);
      const float length = (float)(scale * random_unit(&random));
      interval = fast_add_segment(&table, interval, at, to, length, &light, &pieces, NULL);
      exact_segment(&transfer, at, to, length, exact);
      at = to;
    }
    const double tolerance = 3e-6 + (light.transmittance < table.opaque ? table.opaque : 0);
    for (int k = 0; k < 3; k++)
      if (!(fabsl(light.colour[k] - exact[k]) < tolerance))
        fail_msg("round %d colour %d: %.9g, exactly %.9Lg", round, k, (double)light.colour[k], exact[k]);
    assert_true(fabsl(light.transmittance - exact[3]) < tolerance);
    fast_transfer_release(context, &table);
  }
  harness_context_destroy(context);
}

TEST(stiff_and_odd_transfer_functions_stay_finite)
{
  cellist_context *context = harness_context(1);
  const double ranges[][2] = {{0, 1}, {-1e30, 1e30}, {1e-30, 3e-30}, {5, 5}, {-1.7e308, 1.7e308}, {1e9, 1e9 + 1}};
  for (size_t r = 0; r < sizeof ranges / sizeof *ranges; r++)
    for (int exponent = -12; exponent <= 30; exponent += 3) {
      const double low = ranges[r][0], high = ranges[r][1], middle = 0.5 * low + 0.5 * high, e = pow(10, exponent);
      cellist_transfer_knot knots[] = {{low, 0, {1, 0, 0}},
                                       {middle, e, {0, 1, 0}},
                                       {middle, 0, {0, 0, 1}},
                                       {middle, 0, {0, 0, 1}},
                                       {high, e, {1, 1, 1}}};
      const cellist_transfer transfer = {5, knots};
      fast_transfer table;
      assert_success(context, fast_transfer_create(context, &transfer, low, high, 1, true, &table));
      for (int i = 0; i < 25; i++) {
        const double w[2] = {0.25 * (i % 5), 0.25 * (i / 5)};
        const double from = low * (1 - w[0]) + high * w[0], to = low * (1 - w[1]) + high * w[1];
        const float a = fast_scalar(&table, from), b = fast_scalar(&table, to);
        assert_true(a >= 0 && a <= 1 && b >= 0 && b <= 1);
        fast_light light = {{0}, 1, 0};
        uint32_t pieces = 0;
        fast_add_segment(&table, fast_find_interval(&table, a), a, b, 1, &light, &pieces, NULL);
        for (int k = 0; k < 3; k++) assert_true(light.colour[k] >= 0 && light.colour[k] <= 1.00001f);
        assert_true(light.transmittance >= -1e-6f && light.transmittance <= 1 && pieces < 10);
      }
      fast_transfer_release(context, &table);
    }
  harness_context_destroy(context);
}

TEST(knots_far_outside_the_scalars_are_extended_or_interpolated)
{
  cellist_context *context = harness_context(1);
  const struct {
    double value[2], expected;
  } cases[] = {{{-90, -80}, 2}, {{80, 90}, 1}, {{-99.5, 100.5}, 1.5}, {{-1e300, 1e300}, 1.5}, {{0.5, 1e30}, 1}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    cellist_transfer_knot knots[] = {{cases[i].value[0], 1, {1, 1, 1}}, {cases[i].value[1], 2, {1, 1, 1}}};
    const cellist_transfer transfer = {2, knots};
    fast_transfer table;
    assert_success(context, fast_transfer_create(context, &transfer, 0, 1, 1, true, &table));
    fast_light light = {{0}, 1, 0};
    uint32_t pieces = 0;
    fast_add_segment(&table, fast_find_interval(&table, 0.5f), 0.5f, 0.5f, 1, &light, &pieces, NULL);
    assert_true(fabs(-log(light.transmittance) - cases[i].expected) < 1e-5);
    fast_transfer_release(context, &table);
  }
  harness_context_destroy(context);
}

/* Lanes do not change each other: a faint piece keeps its opacity and its centre beside pieces that are cut. */
TEST(a_faint_piece_beside_deep_ones_keeps_its_digits)
{
  cellist_context *context = harness_context(1);
  cellist_transfer_knot knots[] = {{0, 1, {0, 0, 0}}, {1, 1, {1, 1, 1}}};
  const cellist_transfer transfer = {2, knots};
  fast_transfer table;
  assert_success(context, fast_transfer_create(context, &transfer, 0, 1, 1, true, &table));
  const float from[8] = {0.25f, 0.25f, 0.5f, 0.5f, 0.25f, 0.25f, 0.25f, 0.25f};
  const float to[8] = {0.75f, 0.75f, 0.5000002f, 0.7f, 0.75f, 0.75f, 0.75f, 0.75f};
  const float length[8] = {50, 1e-12f, 1e-12f, 1e-20f, 3, 1e-3f, 0.5f, 1e-30f};
  const fast_band8 band = fast_band8_at(&table, fast_find8(&table, f8_load(from)));
  fast_gain8 gain;
  fast_gain8_of(&table, &band, f8_load(from), f8_load(to), f8_load(length), &gain);
  float alpha[8], place[8], red[8];
  f8_store(alpha, gain.alpha);
  f8_store(place, gain.place);
  f8_store(red, gain.colour[0]);
  for (int i = 0; i < 8; i++) {
    const double expected = -expm1(-(double)length[i]);
    assert_true(fabs((double)alpha[i] - expected) <= 1e-5 * expected);
    assert_true(place[i] >= 0 && place[i] <= 1);
    assert_true(red[i] >= 0.24f * alpha[i] && red[i] <= 0.76f * alpha[i]);
  }
  assert_true(fabsf(place[1] - 0.5f) < 1e-5f && fabsf(place[3] - 0.5f) < 1e-5f);
  fast_transfer_release(context, &table);
  harness_context_destroy(context);
}

static cellist_result create_table(cellist_context *context, void *user) {
  fast_transfer table;
  const cellist_result result = fast_transfer_create(context, user, 0, 1, 1, true, &table);
  if (result == CELLIST_SUCCESS) fast_transfer_release(context, &table);
  return result;
}

TEST(a_failed_allocation_is_reported)
{
  cellist_transfer_knot knot = {0.5, 1, {1, 1, 1}};
  cellist_transfer transfer = {1, &knot};
  check_allocation_failures(create_table, &transfer);
}
