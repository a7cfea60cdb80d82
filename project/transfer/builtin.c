/* SPDX-License-Identifier: BSD-3-Clause
 * Built-in transfer functions: three for comparisons (ramp, dense, spikes) and the usual colour maps with ramp's
 * opacity.
 *
 * viridis, inferno, plasma, magma (matplotlib; van der Walt, Smith), cividis (Nunez, Anderton, Renslow 2018) and turbo
 * (Mikhailov, Google 2019) are given at ten evenly spaced positions, as sRGB bytes; between them they are within 2 % of
 * the published tables. cool-warm is Moreland's diverging map (2009), jet and black-body are ParaView's presets. */
#include <string.h>

#include "transfer_private.h"

enum { MAX_NODES = 24 };

struct builtin {
  const char *name;
  colour_space space;
  bool srgb;
  size_t colour_count, opacity_count; /* 0 opacities: ramp's */
  double colours[MAX_NODES][4];       /* x r g b */
  double opacities[MAX_NODES][2];     /* x opacity; linear between */
};

#define HEX(i, rgb) \
  { (i) / 9.0, ((rgb) >> 16) / 255.0, (((rgb) >> 8) & 255) / 255.0, ((rgb)&255) / 255.0 }
#define TEN(a, b, c, d, e, f, g, h, i, j) \
  { HEX(0, a), HEX(1, b), HEX(2, c), HEX(3, d), HEX(4, e), HEX(5, f), HEX(6, g), HEX(7, h), HEX(8, i), HEX(9, j) }
#define RAINBOW                                                                    \
  {                                                                                \
    {0, 0, 0, 1}, {0.25, 0, 1, 1}, {0.5, 0, 1, 0}, {0.75, 1, 1, 0}, { 1, 1, 0, 0 } \
  }

static const struct builtin BUILTINS[] = {
    {"ramp", COLOUR_RGB, false, 5, 2, RAINBOW, {{0, 0}, {1, 0.4}}},
    {"dense", COLOUR_RGB, false, 5, 3, RAINBOW, {{0, 0}, {0.2, 0.3}, {1, 0.95}}},
    {"spikes",
     COLOUR_RGB,
     false,
     5,
     20,
     RAINBOW,
     {{0, 0},      {0.146, 0},  {0.15, 0.9}, {0.154, 0},  {0.326, 0},
      {0.33, 0.9}, {0.334, 0},  {0.336, 0},  {0.34, 0.9}, {0.34400000000000003, 0},
      {0.516, 0},  {0.52, 0.9}, {0.524, 0},  {0.706, 0},  {0.71, 0.9},
      {0.714, 0},  {0.896, 0},  {0.9, 0.9},  {0.904, 0},  {1, 0}}},
    {"viridis",
     COLOUR_RGB,
     true,
     10,
     0,
     TEN(0x440154, 0x482878, 0x3e4989, 0x31688e, 0x26828e, 0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725),
     {{0}}},
    {"inferno",
     COLOUR_RGB,
     true,
     10,
     0,
     TEN(0x000004, 0x1b0c41, 0x4a0c6b, 0x781c6d, 0xa52c60, 0xcf4446, 0xed6925, 0xfb9b06, 0xf7d13d, 0xfcffa4),
     {{0}}},
    {"plasma",
     COLOUR_RGB,
     true,
     10,
     0,
     TEN(0x0d0887, 0x46039f, 0x7201a8, 0x9c179e, 0xbd3786, 0xd8576b, 0xed7953, 0xfb9f3a, 0xfdca26, 0xf0f921),
     {{0}}},
    {"magma",
     COLOUR_RGB,
     true,
     10,
     0,
     TEN(0x000004, 0x180f3d, 0x440f76, 0x721f81, 0x9e2f7f, 0xcd4071, 0xf1605d, 0xfd9668, 0xfeca8d, 0xfcfdbf),
     {{0}}},
    {"cividis",
     COLOUR_RGB,
     true,
     10,
     0,
     TEN(0x00204d, 0x00336f, 0x39486b, 0x575d6d, 0x707173, 0x8a8779, 0xa69d75, 0xc4b56c, 0xe4cf5b, 0xffea46),
     {{0}}},
    {"turbo",
     COLOUR_RGB,
     true,
     10,
     0,
     TEN(0x30123b, 0x4662d7, 0x36aaf9, 0x1ae4b6, 0x72fe5e, 0xc7ef34, 0xfaba39, 0xf66b19, 0xcb2a04, 0x7a0403),
     {{0}}},
    {"cool-warm", COLOUR_DIVERGING, true, 2, 0, {{0, 0.230, 0.299, 0.754}, {1, 0.706, 0.016, 0.150}}, {{0}}},
    {"jet",
     COLOUR_RGB,
     true,
     7,
     0,
     {{0, 0, 0, 0.5625},
      {0.111111, 0, 0, 1},
      {0.365079, 0, 1, 1},
      {0.507937, 0.5, 1, 0.5},
      {0.650794, 1, 1, 0},
      {0.904762, 1, 0, 0},
      {1, 0.5, 0, 0}},
     {{0}}},
    {"rainbow", COLOUR_HSV, true, 2, 0, {{0, 0, 0, 1}, {1, 1, 0, 0}}, {{0}}},
    {"black-body", COLOUR_RGB, true, 4, 0, {{0, 0, 0, 0}, {0.4, 0.9, 0, 0}, {0.8, 0.9, 0.9, 0}, {1, 1, 1, 1}}, {{0}}},
    {"gray", COLOUR_RGB, true, 2, 0, {{0, 0, 0, 0}, {1, 1, 1, 1}}, {{0}}},
};
enum { BUILTIN_COUNT = sizeof BUILTINS / sizeof BUILTINS[0] };

const char *cellist_transfer_name(size_t index) { return index < BUILTIN_COUNT ? BUILTINS[index].name : NULL; }

cellist_result transfer_read_builtin(cellist_context *context, const char *name, transfer_curve *curve) {
  const struct builtin *found = NULL;
  for (size_t i = 0; i < BUILTIN_COUNT; i++)
    if (strcmp(BUILTINS[i].name, name) == 0) found = &BUILTINS[i];
  if (found == NULL) return CELLIST_ERROR_NOT_FOUND;
  const struct builtin *opacity = found->opacity_count > 0 ? found : &BUILTINS[0];
  curve->space = found->space;
  curve->srgb = found->srgb;
  curve->colours = cellist_allocate(context, found->colour_count, sizeof *curve->colours);
  curve->opacities = cellist_allocate(context, opacity->opacity_count, sizeof *curve->opacities);
  if (curve->colours == NULL || curve->opacities == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < found->colour_count; i++) {
    const double *c = found->colours[i];
    curve->colours[curve->colour_count++] = (colour_node){c[0], {c[1], c[2], c[3]}};
  }
  for (size_t i = 0; i < opacity->opacity_count; i++) {
    const double *o = opacity->opacities[i];
    curve->opacities[curve->opacity_count++] = (opacity_node){o[0], o[1], 0.5, 0};
  }
  return CELLIST_SUCCESS;
}
