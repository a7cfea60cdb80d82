/* SPDX-License-Identifier: BSD-3-Clause
 * Terminal: how the command talks. Results on standard output; progress (on a terminal only), warnings and errors on
 * standard error. */
#ifndef CELLIST_TOOLS_TERMINAL_H
#define CELLIST_TOOLS_TERMINAL_H

#include <cellist/context.h>
#include <jansson.h>

/* A context that shows progress and warnings on standard error. threads 0: one per processor. NULL (and a message)
 * when there is no memory. */
cellist_context *terminal_context(unsigned threads);

/* Says what went wrong (the context's message); returns exit status 1, for return terminal_failure(...). */
int terminal_failure(cellist_context *context, cellist_result result);

/* Clears the progress line before other output. */
void terminal_clear_progress(void);

/* Prints the object on standard output, one line, and frees it; exit status 0, or 1 if that fails. */
int terminal_print_json(json_t *object);

/* JSON is UTF-8: in other texts each byte beyond ASCII becomes a question mark. */
json_t *terminal_text(const char *text);

/* JSON has no infinity and no NaN: they become null. */
json_t *terminal_number(double value);

/* Ends standard output; exit status 1 and a message if anything written there was lost. */
int terminal_finish(void);

/* The median of count values, which it sorts; 0 of none. */
double terminal_median(double *values, size_t count);

#endif
