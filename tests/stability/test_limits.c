/* SPDX-License-Identifier: BSD-3-Clause
 * Stability, limits: whatever the table excuses stands in README's limits. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "stability.h"

/* README's limits with each run of white space as one blank; to be freed. */
static char *read_limits(void) {
  FILE *file = fopen(CELLIST_SOURCE_DIR "/README.md", "r");
  assert_non_null(file);
  char *text = malloc(1 << 16);
  assert_non_null(text);
  size_t length = 0;
  for (int c; (c = fgetc(file)) != EOF;) {
    assert_true(length + 1 < 1 << 16);
    const char next = isspace(c) ? ' ' : (char)c;
    if (next != ' ' || length == 0 || text[length - 1] != ' ') text[length++] = next;
  }
  text[length] = '\0';
  fclose(file);
  char *begin = strstr(text, "## Limits"), *end = strstr(text, "## Licence");
  assert_true(begin != NULL && end != NULL && begin < end);
  *end = '\0';
  memmove(text, begin, strlen(begin) + 1);
  return text;
}

static size_t check(const char *limits, const char *name, const stability_excuse *excuse) {
  if (excuse == NULL) return 0;
  assert_true(excuse->why != NULL && excuse->listed != NULL && excuse->listed[0] != '\0');
  if (strstr(limits, excuse->listed) == NULL) fail_msg("%s: README's limits do not list \"%s\"", name, excuse->listed);
  return 1;
}

TEST(what_the_table_excuses_is_listed)
{
  char *limits = read_limits();
  size_t excuses = check(limits, "fan", &STABILITY_FAN_EXCUSE);
  for (size_t i = 0; stability_case_at(i) != NULL; i++) {
    const stability_case *which = stability_case_at(i);
    excuses += check(limits, which->name, which->reason) + check(limits, which->name, which->stray_reason);
    for (int r = 0; r < STABILITY_RENDERER_COUNT; r++) excuses += check(limits, which->name, which->fails[r]);
    /* Nothing is excused without a reason. */
    if (which->limit > STABILITY_LIMIT) assert_non_null(which->reason);
    if (which->strays > 0) assert_non_null(which->stray_reason);
  }
  assert_true(excuses > 5);
  free(limits);
}
