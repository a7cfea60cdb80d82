/* SPDX-License-Identifier: BSD-3-Clause
 * A transfer function as its author wrote it, before it becomes piecewise linear. Private to this folder. */
#ifndef CELLIST_TRANSFER_PRIVATE_H
#define CELLIST_TRANSFER_PRIVATE_H

#include <cellist/transfer.h>

typedef enum colour_space { COLOUR_RGB, COLOUR_HSV, COLOUR_LAB, COLOUR_DIVERGING, COLOUR_STEP } colour_space;

typedef struct colour_node {
  double x, colour[3];
} colour_node;

/* Between two nodes the curve reaches its average at midpoint (0..1 of the way) with a sharpness from 0 (linear) to
 * 1 (a step), as VTK's piecewise functions define them; both belong to the interval that the node begins. */
typedef struct opacity_node {
  double x, opacity, midpoint, sharpness;
} opacity_node;

/* Both lists ascend in x and have at least one node. */
typedef struct transfer_curve {
  size_t colour_count, opacity_count;
  colour_node *colours;
  opacity_node *opacities;
  colour_space space;
  bool srgb; /* colours are to be made linear */
} transfer_curve;

void transfer_curve_release(cellist_context *context, transfer_curve *curve);

/* Fills the curve from a built-in name; NOT_FOUND (without a message) if there is none of that name. */
cellist_result transfer_read_builtin(cellist_context *context, const char *name, transfer_curve *curve);

/* Fills the curve from a ParaView JSON file; srgb is left false. */
cellist_result transfer_read_paraview(cellist_context *context, const char *path, transfer_curve *curve);

/* The colour at a share s (0..1) of the way between two nodes of that space. */
void colour_mix(colour_space space, const double from[3], const double to[3], double s, double mixed[3]);

#endif
