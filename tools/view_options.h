/* SPDX-License-Identifier: BSD-3-Clause
 * The options that say where the camera is, the same for every subcommand. */
#ifndef CELLIST_TOOLS_VIEW_OPTIONS_H
#define CELLIST_TOOLS_VIEW_OPTIONS_H

#include <cellist/view.h>

#include "options.h"

typedef struct view_options {
  number_list eye, target, up, orbit;
  double fovy, near_distance;
  double parallel; /* NaN: perspective */
  text_list clips;
} view_options;

enum { VIEW_OPTION_COUNT = 9 };

/* Sets the defaults and fills the table, which refers to options. */
void view_options_init(view_options *options, option_spec table[VIEW_OPTION_COUNT]);

/* The view for a mesh of these bounds (lower corner, upper corner). Returns NULL, or what is wrong with the options. */
const char *view_options_resolve(const view_options *options, const double bounds[6], cellist_view *view);

/* The view turned about its target and up vector by a fraction (0..1) of a full turn. */
cellist_view view_turned(const cellist_view *view, double fraction);

#endif
