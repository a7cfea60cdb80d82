/* SPDX-License-Identifier: BSD-3-Clause
 * Optics options: from --tf, --unit and the like to what the pipeline draws with. */
#include "optics_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void optics_options_init(optics_options *options, option_spec table[OPTICS_OPTION_COUNT]) {
  *options = (optics_options){.transfer = "ramp", .unit = "auto", .convention = "unstructured", .opacity_scale = 1};
  options->range.expected = 2;
  const option_spec filled[OPTICS_OPTION_COUNT] = {
      {"scalar", "NAME|NAME:mag|NAME:INDEX", "what to show (the first point array, else the first cell array)",
       OPTION_TEXT, &options->scalar},
      {"tf", "FILE.json|NAME", "transfer function: ParaView JSON or built in, e.g. dense, viridis (ramp)", OPTION_TEXT,
       &options->transfer},
      {"range", "LO,HI", "scalar range that the transfer function covers (the scalar's own)", OPTION_NUMBERS,
       &options->range},
      {"opacity-scale", "S", "multiplies extinction (1)", OPTION_NUMBER, &options->opacity_scale},
      {"unit", "D|diagonal/N|auto", "length at which opacities hold (auto: as ParaView)", OPTION_TEXT, &options->unit},
      {"opacity-convention", "unstructured|image", "1 - exp(-a d/u) or 1 - (1-a)^(d/u)", OPTION_CHOICE,
       &options->convention},
      {"tf-colours", "linear|srgb", "what the file's colours are (linear; built-in maps know their own)", OPTION_CHOICE,
       &options->colours},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  memcpy(table, filled, sizeof filled);
}

static bool parse_positive(const char *text, double *value) {
  char *end = NULL;
  *value = strtod(text, &end);
  return end != text && *end == '\0' && isfinite(*value) && *value > 0;
}

const char *optics_options_resolve(const optics_options *options, cellist_pipeline_optics *optics) {
  *optics = (cellist_pipeline_optics){.scalar = options->scalar, .transfer = options->transfer};
  static const char diagonal[] = "diagonal/";
  if (strncmp(options->unit, diagonal, sizeof diagonal - 1) == 0) {
    if (!parse_positive(options->unit + sizeof diagonal - 1, &optics->unit_diagonal_fraction))
      return "--unit diagonal/N needs a number above 0";
  } else if (strcmp(options->unit, "auto") != 0 && !parse_positive(options->unit, &optics->unit_distance)) {
    return "--unit needs a length above 0, diagonal/N or auto";
  }
  if (!(options->opacity_scale > 0)) return "--opacity-scale must be above 0";
  optics->opacity_scale = options->opacity_scale;
  optics->convention = strcmp(options->convention, "image") == 0 ? CELLIST_OPACITY_IMAGE : CELLIST_OPACITY_UNSTRUCTURED;
  optics->srgb_colours = options->colours != NULL && strcmp(options->colours, "srgb") == 0;
  if (options->range.count == 2) {
    if (options->range.value[0] > options->range.value[1]) return "--range needs LO,HI with LO at most HI";
    optics->has_range = true;
    optics->range[0] = options->range.value[0];
    optics->range[1] = options->range.value[1];
  }
  return NULL;
}
