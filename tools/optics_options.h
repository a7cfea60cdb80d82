/* SPDX-License-Identifier: BSD-3-Clause
 * The options that say what the mesh looks like, the same for every subcommand. */
#ifndef CELLIST_TOOLS_OPTICS_OPTIONS_H
#define CELLIST_TOOLS_OPTICS_OPTIONS_H

#include <cellist/pipeline.h>

#include "options.h"

typedef struct optics_options {
  const char *scalar, *transfer, *unit, *convention, *colours;
  const char *model, *light, *integration;
  number_list range, isos, iso_opacities;
  double opacity_scale;
  unsigned samples;
} optics_options;

enum { OPTICS_OPTION_COUNT = 14 };

/* Sets the defaults and fills the table, which refers to options. */
void optics_options_init(optics_options *options, option_spec table[OPTICS_OPTION_COUNT]);

/* Fills the optics part of the description; isos has room for LIST_CAPACITY surfaces, which optics then refers to.
 * Returns NULL, or what is wrong with the options. */
const char *optics_options_resolve(const optics_options *options, cellist_isosurface *isos,
                                   cellist_pipeline_optics *optics);

#endif
