/* SPDX-License-Identifier: BSD-3-Clause
 * The options that say how a mesh file is read, the same for every subcommand. */
#ifndef CELLIST_TOOLS_MESH_OPTIONS_H
#define CELLIST_TOOLS_MESH_OPTIONS_H

#include <cellist/mesh.h>

#include "options.h"

typedef struct mesh_options {
  const char *merge;
  bool strict;
} mesh_options;

enum { MESH_OPTION_COUNT = 3 };

/* Sets the defaults and fills the table, which refers to options. */
void mesh_options_init(mesh_options *options, option_spec table[MESH_OPTION_COUNT]);

/* Fills the description. Returns NULL, or what is wrong with the options. */
const char *mesh_options_resolve(const mesh_options *options, cellist_mesh_read_desc *desc);

#endif
