/* SPDX-License-Identifier: BSD-3-Clause
 * What every test file uses. TEST(name) { ... } is one case and one CTest entry; assertions are cmocka's. */
#ifndef CELLIST_TESTS_HARNESS_H
#define CELLIST_TESTS_HARNESS_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <base/random.h>
#include <cellist/context.h>

#define TEST(name)                                                                                  \
  static void name(void **state);                                                                   \
  __attribute__((constructor)) static void register_##name(void) { harness_register(#name, name); } \
  static void name(void **state __attribute__((unused)))

/* Ends the case as skipped; CTest shows it as such. */
#define SKIP(...) harness_skip(__VA_ARGS__)

void harness_register(const char *name, CMUnitTestFunction function);
void harness_skip(const char *format, ...) CELLIST_PRINTF(1, 2);

/* A context with default settings and this many workers, whose allocations are counted: destroying it with
 * harness_context_destroy fails the case if a block is still allocated. */
cellist_context *harness_context(unsigned worker_count);
void harness_context_destroy(cellist_context *context);

/* How many allocations a harness context has made so far. */
size_t harness_allocation_count(const cellist_context *context);

/* Fails the case with the context's message unless result is SUCCESS. */
void assert_success(cellist_context *context, cellist_result result);

/* Fails the case unless result is expected and the context's message contains part. */
void assert_failure(cellist_context *context, cellist_result result, cellist_result expected, const char *part);

/* Calls body with a fresh context whose Nth allocation fails, N = 1, 2, ..., until it succeeds. Each failing call must
 * return OUT_OF_MEMORY, leave a message and leak nothing. body destroys what it made. */
typedef cellist_result (*harness_body)(cellist_context *context, void *user);
void check_allocation_failures(harness_body body, void *user);

/* The path of a real mesh in the shared data folder (static buffer); skips the case if it is not there. */
const char *shared_data(const char *name);

#endif
