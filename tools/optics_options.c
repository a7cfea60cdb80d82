/* SPDX-License-Identifier: BSD-3-Clause
 * Optics options: from --tf, --unit and the like to what the pipeline draws with. */
#include "optics_options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void optics_options_init(optics_options *options, option_spec table[OPTICS_OPTION_COUNT]) {
  *options = (optics_options){.transfer = "ramp",
                              .unit = "auto",
                              .convention = "unstructured",
                              .light = "off",
                              .integration = "exact",
                              .opacity_scale = 1};
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
      {"model", "emission-absorption|absorption|emission|mip|iso",
       "what a ray gathers (emission-absorption; iso with "
       "--iso)",
       OPTION_CHOICE, &options->model},
      {"iso", "V[,V...]", "isosurfaces at these scalars", OPTION_NUMBERS, &options->isos},
      {"iso-opacity", "A[,A...]", "opacity of all isosurfaces, or of each, 0..1 (1)", OPTION_NUMBERS,
       &options->iso_opacities},
      {"light", "X,Y,Z|headlight|off", "direction towards the light, or from the camera (off)", OPTION_TEXT,
       &options->light},
      {"samples", "1..4",
       "faces, soft: parts of a cell's segment that are lit one by one (1; with --error or --time, what they take)",
       OPTION_COUNT, &options->samples},
      {"integration", "exact|psi|table[:SIZE]",
       "faces: how a segment is integrated; SIZE: N scalars or NxL, L lengths (exact; table:128x32)", OPTION_TEXT,
       &options->integration},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  memcpy(table, filled, sizeof filled);
}

static bool parse_positive(const char *text, double *value) {
  char *end = NULL;
  *value = strtod(text, &end);
  return end != text && *end == '\0' && isfinite(*value) && *value > 0;
}

/* Shares of the colour and a highlight that show shape without hiding the transfer function's colours. */
static const cellist_light USUAL_LIGHT = {
    .enabled = true, .ambient = 0.35, .diffuse = 0.65, .specular = 0.2, .shininess = 20};

static const char *resolve_model(const optics_options *options, cellist_isosurface *isos, cellist_optics *model) {
  static const struct {
    const char *name;
    cellist_model model;
  } names[] = {{"emission-absorption", CELLIST_MODEL_EMISSION_ABSORPTION},
               {"absorption", CELLIST_MODEL_ABSORPTION},
               {"emission", CELLIST_MODEL_EMISSION},
               {"mip", CELLIST_MODEL_MAXIMUM},
               {"iso", CELLIST_MODEL_ISOSURFACES}};
  const char *name = options->model != NULL ? options->model : options->isos.count > 0 ? "iso" : names[0].name;
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
    if (strcmp(name, names[i].name) == 0) model->model = names[i].model;
  if ((model->model == CELLIST_MODEL_ISOSURFACES) != (options->isos.count > 0))
    return "--model iso and --iso V need each other";
  const size_t opacity_count = options->iso_opacities.count;
  if (opacity_count > 1 && opacity_count != options->isos.count)
    return "--iso-opacity needs one opacity, or one for each --iso";
  if (opacity_count > 0 && options->isos.count == 0) return "--iso-opacity needs --iso";
  for (size_t i = 0; i < options->isos.count; i++) {
    const double opacity = opacity_count == 0 ? 1 : options->iso_opacities.value[opacity_count == 1 ? 0 : i];
    if (!(opacity >= 0 && opacity <= 1)) return "--iso-opacity needs opacities in 0..1";
    isos[i] = (cellist_isosurface){options->isos.value[i], opacity};
  }
  model->isos = isos;
  model->iso_count = options->isos.count;

  if (strcmp(options->light, "off") == 0) return NULL;
  model->light = USUAL_LIGHT;
  if (strcmp(options->light, "headlight") == 0) return NULL;
  double *d = model->light.direction;
  int end = 0;
  if (sscanf(options->light, "%lf,%lf,%lf%n", &d[0], &d[1], &d[2], &end) != 3 || options->light[end] != '\0' ||
      !isfinite(d[0] + d[1] + d[2]) || (d[0] == 0 && d[1] == 0 && d[2] == 0))
    return "--light needs a direction X,Y,Z, headlight or off";
  return NULL;
}

/* "N", "NxL" or "NxNxL" of a table's size; false if it is none. */
static bool parse_table_size(const char *text, uint32_t size[2]) {
  unsigned count[3] = {0, 0, 0};
  int end = 0, parts = 0;
  for (const char *at = text; parts < 3; at += end + 1) {
    end = 0;
    if (*at < '0' || *at > '9' || sscanf(at, "%5u%n", &count[parts], &end) != 1) return false;
    parts++;
    if (at[end] == '\0') break;
    if (at[end] != 'x' || parts == 3) return false;
  }
  if (parts == 3 && count[0] != count[1]) return false;
  size[0] = count[0];
  size[1] = count[parts - 1];
  return size[0] >= 2 && size[0] <= 1024 && size[1] >= 3 && size[1] <= 1024;
}

static const char *resolve_integration(const optics_options *options, cellist_optics *model) {
  static const char table[] = "table:";
  const char *name = options->integration;
  if (options->samples > 4) return "--samples needs 1 to 4";
  model->sample_count = options->samples;
  if (strcmp(name, "exact") == 0) return NULL;
  model->integration = strcmp(name, "psi") == 0 ? CELLIST_INTEGRATION_PSI : CELLIST_INTEGRATION_TABLE;
  if (strcmp(name, "psi") == 0 || strcmp(name, "table") == 0) return NULL;
  if (strncmp(name, table, sizeof table - 1) == 0 && parse_table_size(name + sizeof table - 1, model->table_size))
    return NULL;
  return "--integration needs exact, psi, table or table:SIZE, with SIZE N, NxL or NxNxL, N from 2 and L from 3 to "
         "1024";
}

const char *optics_options_resolve(const optics_options *options, cellist_isosurface *isos,
                                   cellist_pipeline_optics *optics) {
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
  const char *wrong = resolve_model(options, isos, &optics->model);
  if (wrong == NULL) wrong = resolve_integration(options, &optics->model);
  if (wrong != NULL) return wrong;
  if (options->range.count == 2) {
    if (options->range.value[0] > options->range.value[1]) return "--range needs LO,HI with LO at most HI";
    optics->has_range = true;
    optics->range[0] = options->range.value[0];
    optics->range[1] = options->range.value[1];
  }
  return NULL;
}
