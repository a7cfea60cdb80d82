/* SPDX-License-Identifier: BSD-3-Clause
 * Order options: from --exterior, --gaps and --cache to what an order is made with. */
#include "order_options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void order_options_init(order_options *options, option_spec table[ORDER_OPTION_COUNT]) {
  *options = (order_options){.gaps = "auto"};
  const option_spec filled[ORDER_OPTION_COUNT] = {
      {"exterior", "auto|none|hull|box|grid|delaunay",
       "what fills a concave mesh for sorting (auto: what sorts fastest)", OPTION_CHOICE, &options->exterior},
      {"gaps", "auto|complex|overlap", "order cells across gaps by an exterior, or by where their faces overlap (auto)",
       OPTION_CHOICE, &options->gaps},
      {"cache", "DIR", "keep exteriors there (XDG_CACHE_HOME/cellist)", OPTION_TEXT, &options->cache},
      {"no-cache", "", "keep no exterior and use none that is kept", OPTION_FLAG, &options->no_cache},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  memcpy(table, filled, sizeof filled);
}

/* Where caches go unless told otherwise; an empty text: nowhere. */
static void find_directory(char *directory, size_t size) {
  const char *base = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  int length = 0;
  /* A relative XDG_CACHE_HOME is to be ignored, says the XDG specification. */
  if (base != NULL && base[0] == '/')
    length = snprintf(directory, size, "%s/cellist", base);
  else if (home != NULL && home[0] == '/')
    length = snprintf(directory, size, "%s/.cache/cellist", home);
  if (length <= 0 || (size_t)length >= size) directory[0] = '\0';
}

const char *order_options_resolve(order_options *options, cellist_order_desc *desc) {
  static const char *const names[] = {"auto", "none", "hull", "box", "grid", "delaunay"};
  *desc = (cellist_order_desc){0};
  for (size_t i = 0; options->exterior != NULL && i < sizeof names / sizeof names[0]; i++)
    if (strcmp(options->exterior, names[i]) == 0) desc->exterior = (cellist_order_exterior)i;
  if (strcmp(options->gaps, "overlap") == 0) {
    if (desc->exterior > CELLIST_ORDER_NONE) return "--gaps overlap needs no --exterior";
    desc->exterior = CELLIST_ORDER_NONE;
  }
  if (strcmp(options->gaps, "complex") == 0) {
    if (desc->exterior == CELLIST_ORDER_NONE) return "--gaps complex needs an exterior";
    desc->needs_complex = true;
  }
  if (options->no_cache) return options->cache != NULL ? "--cache and --no-cache exclude each other" : NULL;
  if (options->cache != NULL && options->cache[0] == '\0') return "--cache needs a directory";
  if (options->cache != NULL) {
    desc->cache_directory = options->cache;
    return NULL;
  }
  find_directory(options->directory, sizeof options->directory);
  if (options->directory[0] != '\0') desc->cache_directory = options->directory;
  return NULL;
}
