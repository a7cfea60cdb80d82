/* SPDX-License-Identifier: BSD-3-Clause
 * Mesh options: from --merge and --strict to how a file is read. */
#include "mesh_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void mesh_options_init(mesh_options *options, option_spec table[MESH_OPTION_COUNT]) {
  *options = (mesh_options){0};
  const option_spec filled[MESH_OPTION_COUNT] = {
      {"merge", "[=DISTANCE]", "join points that coincide (or lie within DISTANCE)", OPTION_OPTIONAL, &options->merge},
      {"strict", "", "refuse a mesh with flaws instead of repairing it", OPTION_FLAG, &options->strict},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  memcpy(table, filled, sizeof filled);
}

const char *mesh_options_resolve(const mesh_options *options, cellist_mesh_read_desc *desc) {
  *desc = (cellist_mesh_read_desc){.strict = options->strict, .merge = options->merge != NULL};
  if (options->merge == NULL || options->merge[0] == '\0') return NULL;
  char *end = NULL;
  desc->merge_distance = strtod(options->merge, &end);
  if (*end != '\0' || !(desc->merge_distance >= 0) || !isfinite(desc->merge_distance))
    return "--merge=DISTANCE needs a length of at least 0";
  return NULL;
}
