/* SPDX-License-Identifier: BSD-3-Clause
 * The options that say how gaps are sorted and where exteriors are kept, the same for every subcommand. */
#ifndef CELLIST_TOOLS_ORDER_OPTIONS_H
#define CELLIST_TOOLS_ORDER_OPTIONS_H

#include <cellist/order.h>

#include "options.h"

typedef struct order_options {
  const char *exterior, *gaps, *cache;
  bool no_cache;
  char directory[4096]; /* what the description refers to */
} order_options;

enum { ORDER_OPTION_COUNT = 5 };

/* Sets the defaults and fills the table, which refers to options. */
void order_options_init(order_options *options, option_spec table[ORDER_OPTION_COUNT]);

/* Fills the description, which refers to options; the cache's usual place is the environment's (XDG_CACHE_HOME, or
 * HOME). Returns NULL, or what is wrong with the options. */
const char *order_options_resolve(order_options *options, cellist_order_desc *desc);

#endif
