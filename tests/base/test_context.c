/* SPDX-License-Identifier: BSD-3-Clause
 * Context: errors, allocation, progress and workers. */
#include <stdatomic.h>
#include <string.h>

#include "harness.h"

TEST(first_error_wins_until_it_is_taken)
{
  cellist_context *context = harness_context(1);
  assert_string_equal(cellist_context_take_error(context), "");
  assert_int_equal(cellist_fail(context, CELLIST_ERROR_IO, "first %d", 1), CELLIST_ERROR_IO);
  cellist_fail(context, CELLIST_ERROR_FORMAT, "second");
  assert_string_equal(cellist_context_take_error(context), "first 1");
  assert_string_equal(cellist_context_take_error(context), "");
  cellist_fail(context, CELLIST_ERROR_FORMAT, "third");
  assert_string_equal(cellist_context_take_error(context), "third");
  harness_context_destroy(context);
}

TEST(half_an_allocator_is_refused)
{
  cellist_context_desc desc = cellist_context_desc_default();
  desc.allocator.deallocate = NULL;
  cellist_context *context = NULL;
  assert_int_equal(cellist_context_create(&desc, &context), CELLIST_ERROR_INVALID_ARGUMENT);
  assert_null(context);
}

TEST(sizes_that_overflow_are_out_of_memory)
{
  cellist_context *context = harness_context(1);
  assert_null(cellist_allocate(context, SIZE_MAX / 2, 3));
  assert_non_null(strstr(cellist_context_take_error(context), "out of memory"));
  void *empty = cellist_allocate(context, 0, 8);
  assert_non_null(empty);
  cellist_deallocate(context, empty);
  harness_context_destroy(context);
}

TEST(every_result_has_a_name)
{
  for (int result = CELLIST_SUCCESS; result <= CELLIST_ERROR_INTERNAL; result++)
    assert_string_not_equal(cellist_result_string((cellist_result)result), "unknown result");
}

static bool refuse(void *user, const char *stage, double fraction) {
  (void)user, (void)stage;
  return fraction < 0.5;
}

TEST(progress_can_cancel)
{
  cellist_context_desc desc = {.progress = refuse};
  cellist_context *context = NULL;
  assert_int_equal(cellist_context_create(&desc, &context), CELLIST_SUCCESS);
  assert_int_equal(cellist_progress(context, "reading", 0.25), CELLIST_SUCCESS);
  assert_int_equal(cellist_progress(context, "reading", 0.75), CELLIST_ERROR_CANCELLED);
  assert_string_equal(cellist_context_take_error(context), "reading was cancelled");
  cellist_context_destroy(context);
}

enum { COUNT = 100003, GRAIN = 64 };

struct tally {
  atomic_uint visits[COUNT];
  atomic_uint bad_ranges;
  cellist_context *context;
};

static void visit(void *user, size_t begin, size_t end, unsigned worker) {
  struct tally *tally = user;
  if (begin % GRAIN != 0 || end - begin > GRAIN || worker >= cellist_context_worker_count(tally->context))
    atomic_fetch_add(&tally->bad_ranges, 1);
  for (size_t i = begin; i < end; i++) atomic_fetch_add(&tally->visits[i], 1);
}

TEST(loops_visit_every_index_once_on_any_number_of_workers)
{
  static struct tally tally;
  for (unsigned workers = 1; workers <= 5; workers++) {
    memset(&tally, 0, sizeof tally);
    tally.context = harness_context(workers);
    for (int round = 0; round < 20; round++) cellist_parallel_for(tally.context, COUNT, GRAIN, visit, &tally);
    for (size_t i = 0; i < COUNT; i++) assert_int_equal(tally.visits[i], 20);
    assert_int_equal(tally.bad_ranges, 0);
    harness_context_destroy(tally.context);
  }
}

TEST(any_number_of_workers_is_taken_and_bounded)
{
  static struct tally tally;
  tally.context = harness_context(4000000000u);
  assert_true(cellist_context_worker_count(tally.context) >= 1 && cellist_context_worker_count(tally.context) <= 256);
  cellist_parallel_for(tally.context, COUNT, GRAIN, visit, &tally);
  for (size_t i = 0; i < COUNT; i++) assert_int_equal(tally.visits[i], 1);
  harness_context_destroy(tally.context);
}

static void nest(void *user, size_t begin, size_t end, unsigned worker) {
  struct tally *tally = user;
  (void)worker, (void)begin, (void)end;
  cellist_parallel_for(tally->context, COUNT, GRAIN, visit, tally);
}

TEST(nested_loops_run_serially)
{
  static struct tally tally;
  tally.context = harness_context(3);
  cellist_parallel_for(tally.context, 7, 1, nest, &tally);
  for (size_t i = 0; i < COUNT; i++) assert_int_equal(tally.visits[i], 7);
  harness_context_destroy(tally.context);
}
