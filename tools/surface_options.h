/* SPDX-License-Identifier: BSD-3-Clause
 * From --surface to the pipeline's surfaces. */
#ifndef CELLIST_TOOLS_SURFACE_OPTIONS_H
#define CELLIST_TOOLS_SURFACE_OPTIONS_H

#include <cellist/pipeline.h>

#include "options.h"

typedef struct surface_options {
  text_list surfaces;
  char names[LIST_CAPACITY][4096]; /* without the colours */
} surface_options;

enum { SURFACE_OPTION_COUNT = 2 };

/* Sets the defaults and fills the table, which refers to options. */
void surface_options_init(surface_options *options, option_spec table[SURFACE_OPTION_COUNT]);

/* Fills surfaces, of LIST_CAPACITY entries that refer to options, and counts them. Returns NULL, or what is wrong with
 * the options. */
const char *surface_options_resolve(surface_options *options, cellist_pipeline_surface *surfaces, size_t *count);

#endif
