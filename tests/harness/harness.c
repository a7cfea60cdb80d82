/* SPDX-License-Identifier: BSD-3-Clause
 * Harness: runs the case named on the command line (all without one); exit 77 if it was skipped. */
#include "harness.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MAX_CASES = 512, EXIT_SKIPPED = 77 };

static struct CMUnitTest cases[MAX_CASES];
static size_t case_count;
static int was_skipped;

void harness_register(const char *name, CMUnitTestFunction function) {
  if (case_count == MAX_CASES) abort();
  cases[case_count++] = (struct CMUnitTest){.name = name, .test_func = function};
}

void harness_skip(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  printf("skipped: ");
  vprintf(format, arguments);
  printf("\n");
  va_end(arguments);
  was_skipped = 1;
  skip();
}

/* Counts blocks, and fails one allocation on demand. Locked: workers allocate too. */
struct counting {
  pthread_mutex_t lock;
  size_t live, made, fail_at; /* fail_at: the number of the allocation to refuse, from 1; 0: none */
};

static void *counting_allocate(void *user, size_t size) {
  struct counting *counting = user;
  pthread_mutex_lock(&counting->lock);
  const int refuse = ++counting->made == counting->fail_at;
  counting->live += !refuse;
  pthread_mutex_unlock(&counting->lock);
  if (refuse) return NULL;
  void *block = aligned_alloc(64, (size + 63) / 64 * 64);
  if (block == NULL) abort();
  memset(block, 0xA5, size); /* reading what was not written shows */
  return block;
}

static void counting_deallocate(void *user, void *block) {
  struct counting *counting = user;
  pthread_mutex_lock(&counting->lock);
  counting->live--;
  pthread_mutex_unlock(&counting->lock);
  free(block);
}

enum { MAX_CONTEXTS = 16 };
static struct {
  cellist_context *context;
  struct counting *counting;
} contexts[MAX_CONTEXTS];

cellist_context *harness_context(unsigned worker_count) {
  struct counting *counting = calloc(1, sizeof *counting);
  assert_non_null(counting);
  pthread_mutex_init(&counting->lock, NULL);
  cellist_context_desc desc = {.allocator = {counting_allocate, counting_deallocate, counting},
                               .worker_count = worker_count};
  cellist_context *context = NULL;
  assert_int_equal(cellist_context_create(&desc, &context), CELLIST_SUCCESS);
  for (int i = 0; i < MAX_CONTEXTS; i++)
    if (contexts[i].context == NULL) {
      contexts[i].context = context;
      contexts[i].counting = counting;
      return context;
    }
  fail_msg("more than %d contexts in one case", MAX_CONTEXTS);
  return NULL;
}

size_t harness_allocation_count(const cellist_context *context) {
  int i = 0;
  while (i < MAX_CONTEXTS && contexts[i].context != context) i++;
  assert_true(i < MAX_CONTEXTS);
  return contexts[i].counting->made;
}

void harness_context_destroy(cellist_context *context) {
  for (int i = 0; i < MAX_CONTEXTS; i++) {
    if (contexts[i].context != context) continue;
    cellist_context_destroy(context);
    const size_t leaked = contexts[i].counting->live;
    pthread_mutex_destroy(&contexts[i].counting->lock);
    free(contexts[i].counting);
    contexts[i].context = NULL;
    if (leaked > 0) fail_msg("%zu blocks were not given back", leaked);
    return;
  }
  fail_msg("not a context of the harness");
}

void assert_success(cellist_context *context, cellist_result result) {
  if (result == CELLIST_SUCCESS) return;
  fail_msg("%s: %s", cellist_result_string(result), cellist_context_take_error(context));
}

void assert_failure(cellist_context *context, cellist_result result, cellist_result expected, const char *part) {
  const char *message = cellist_context_take_error(context);
  if (result != expected)
    fail_msg("got '%s' (%s) instead of '%s'", cellist_result_string(result), message, cellist_result_string(expected));
  if (strstr(message, part) == NULL) fail_msg("the message '%s' does not say '%s'", message, part);
}

void check_allocation_failures(harness_body body, void *user) {
  for (size_t fail_at = 1;; fail_at++) {
    struct counting counting = {.fail_at = 0};
    pthread_mutex_init(&counting.lock, NULL);
    cellist_context_desc desc = {.allocator = {counting_allocate, counting_deallocate, &counting}, .worker_count = 1};
    cellist_context *context = NULL;
    assert_int_equal(cellist_context_create(&desc, &context), CELLIST_SUCCESS);
    counting.fail_at = counting.made + fail_at;
    const cellist_result result = body(context, user);
    const int refused = counting.made >= counting.fail_at;
    const char *message = cellist_context_take_error(context);
    if (refused && result != CELLIST_ERROR_OUT_OF_MEMORY)
      fail_msg("allocation %zu failed, but the call said '%s' (%s)", fail_at, cellist_result_string(result), message);
    if (refused && message[0] == '\0') fail_msg("allocation %zu failed without a message", fail_at);
    if (!refused && result != CELLIST_SUCCESS)
      fail_msg("no allocation failed, but the call said '%s' (%s)", cellist_result_string(result), message);
    cellist_context_destroy(context);
    pthread_mutex_destroy(&counting.lock);
    if (counting.live > 0) fail_msg("allocation %zu failed and %zu blocks leaked", fail_at, counting.live);
    if (!refused) return;
  }
}

const char *shared_data(const char *name) {
  static char path[4096];
  snprintf(path, sizeof path, "%s/data/%s", CELLIST_SHARED_DIR, name);
  if (access(path, R_OK) != 0) harness_skip("%s is not there", path);
  return path;
}

int main(int argc, char **argv) {
  size_t failed = 0, run = 0;
  for (size_t i = 0; i < case_count; i++) {
    if (argc > 1 && strcmp(argv[1], cases[i].name) != 0) continue;
    run++;
    failed += _cmocka_run_group_tests(cases[i].name, &cases[i], 1, NULL, NULL) != 0;
  }
  if (run == 0) {
    fprintf(stderr, "no case '%s'\n", argc > 1 ? argv[1] : "");
    return EXIT_FAILURE;
  }
  return failed > 0 ? EXIT_FAILURE : was_skipped ? EXIT_SKIPPED : EXIT_SUCCESS;
}
