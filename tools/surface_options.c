/* SPDX-License-Identifier: BSD-3-Clause
 * Surface options: what --surface names, and the colour behind it. */
#include "surface_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void surface_options_init(surface_options *options, option_spec table[SURFACE_OPTION_COUNT]) {
  options->surfaces.count = 0;
  const option_spec filled[SURFACE_OPTION_COUNT] = {
      {"surface", "FILE[,R,G,B]",
       "an opaque surface: STL, OBJ or PLY; or boundary, cells:SCALAR=LO..HI, ids:3+7..20; may be repeated",
       OPTION_TEXTS, &options->surfaces},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  memcpy(table, filled, sizeof filled);
}

/* Cuts three numbers off the end of the name, each behind a comma; leaves the name alone if they are not there. */
static bool cut_colour(char *name, double colour[3]) {
  char *at = name + strlen(name);
  for (int k = 2; k >= 0; k--) {
    const char *end_of_number = at;
    while (at > name && at[-1] != ',') at--;
    if (at == name) return false;
    char *end = NULL;
    colour[k] = strtod(at, &end);
    if (end == at || end != end_of_number) return false;
    at--; /* the comma */
  }
  if (at == name) return false;
  *at = '\0';
  return true;
}

const char *surface_options_resolve(surface_options *options, cellist_pipeline_surface *surfaces, size_t *count) {
  *count = options->surfaces.count;
  for (size_t i = 0; i < *count; i++) {
    const char *text = options->surfaces.value[i];
    if (strlen(text) >= sizeof options->names[i]) return "--surface has too long a name";
    strcpy(options->names[i], text);
    surfaces[i] = (cellist_pipeline_surface){.source = options->names[i]};
    surfaces[i].has_colour = cut_colour(options->names[i], surfaces[i].colour);
    if (options->names[i][0] == '\0') return "--surface needs a file, boundary, cells:SCALAR=LO..HI or ids:LIST";
    for (int k = 0; k < 3 && surfaces[i].has_colour; k++)
      if (!(surfaces[i].colour[k] >= 0 && isfinite(surfaces[i].colour[k])))
        return "--surface FILE,R,G,B needs colours of at least 0";
  }
  return NULL;
}
