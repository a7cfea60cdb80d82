/* SPDX-License-Identifier: BSD-3-Clause
 * Transfer function: from a scalar to extinction and colour, piecewise linear. */
#ifndef CELLIST_TRANSFER_H
#define CELLIST_TRANSFER_H

#include <cellist/context.h>

#ifdef __cplusplus
extern "C" {
#endif

/* At scalar value: extinction per unit length (of the mesh's own units) and emitted colour, not premultiplied: along
 * a length l of constant scalar the colour is colour * (1 - exp(-extinction l)). */
typedef struct cellist_transfer_knot {
  double value;
  double extinction;
  double colour[3]; /* linear R G B */
} cellist_transfer_knot;

/* Knots in ascending order of value; between two, extinction and colour are linear in the scalar; before the first
 * and after the last they are constant. Two knots of the same value make a step: the first holds below and at the
 * value, the second above it. A transfer function always has at least one knot. */
typedef struct cellist_transfer {
  size_t knot_count;
  cellist_transfer_knot *knots; /* [knot_count] from the context's allocator */
} cellist_transfer;

/* How opacity becomes extinction. */
typedef enum cellist_opacity_convention {
  CELLIST_OPACITY_UNSTRUCTURED, /* extinction = opacity / unit: VTK's unstructured mappers, 1 - exp(-a d/u) */
  CELLIST_OPACITY_IMAGE         /* extinction = -log(1 - opacity) / unit: VTK's image mappers, 1 - (1-a)^(d/u) */
} cellist_opacity_convention;

typedef struct cellist_transfer_desc {
  const char *source; /* a built-in name or the path of a ParaView JSON file; NULL: "ramp" */
  double range[2];    /* the function is stretched to this scalar range; low == high: a step at that value.
                         Both 0 with keep_range: the file's own values are kept */
  bool keep_range;
  double unit_distance; /* the length at which an opacity is the file's, in mesh units, above 0 */
  double opacity_scale; /* multiplies extinction; 0 means 1 */
  cellist_opacity_convention convention;
  bool srgb_colours; /* the file's colours are sRGB and are made linear; false: they are linear as given.
                        Built-in maps know their own space */
} cellist_transfer_desc;

/* Makes a transfer function from a built-in one (ramp, dense, spikes; the colour maps of cellist_transfer_name, with
 * ramp's opacity) or a ParaView JSON file (RGBPoints, Points with midpoint and sharpness, ColorSpace RGB, HSV, Lab,
 * Diverging, Step). Curves that are not piecewise linear become so with an error below 1/1024 of their range.
 * Arrays: transfer is filled; its knots are the caller's, for cellist_transfer_release.
 * Errors: NOT_FOUND (neither a name nor a file), IO, FORMAT (not JSON, with the line; not a transfer function),
 *   INVALID_ARGUMENT (a number out of range), OUT_OF_MEMORY. Threads: one call per context at a time. */
CELLIST_API cellist_result cellist_transfer_load(cellist_context *context, const cellist_transfer_desc *desc,
                                                 cellist_transfer *transfer);

/* Checks what a caller made himself: at least one knot, ascending values, all finite, no negative extinction.
 * Errors: INVALID_ARGUMENT (the message names the knot). Threads: one call per context at a time. Cost: linear. */
CELLIST_API cellist_result cellist_transfer_check(cellist_context *context, const cellist_transfer *transfer);

/* Frees the knots; a zeroed transfer function is legal. */
CELLIST_API void cellist_transfer_release(cellist_context *context, cellist_transfer *transfer);

/* The built-in names, index 0 on; NULL after the last. */
CELLIST_API const char *cellist_transfer_name(size_t index);

/* Extinction and colour at one scalar value, as the knots say. colour: 3 doubles, filled. Threads: any. */
CELLIST_API double cellist_transfer_evaluate(const cellist_transfer *transfer, double value, double colour[3]);

/* Whether some gap between knots is too narrow for scalars in single precision, below 6e-5 of the range from minimum to
 * maximum, where something absorbs beside it: renderers that keep scalars in single precision draw it wrong. Threads:
 * any. Cost: linear. */
CELLIST_API bool cellist_transfer_is_narrow(const cellist_transfer *transfer, double minimum, double maximum);

/* The same of the one gap from `below` to the knot after it. */
CELLIST_API bool cellist_transfer_is_narrow_gap(const cellist_transfer_knot *below, double minimum, double maximum);

/* ParaView's default unit distance: the bounds' diagonal / cube root of the number of cells in the user's file. */
CELLIST_API double cellist_unit_distance_auto(const double bounds[6], size_t file_cell_count);

#ifdef __cplusplus
}
#endif
#endif
