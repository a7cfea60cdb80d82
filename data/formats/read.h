/* SPDX-License-Identifier: BSD-3-Clause
 * The readers, one for each format: they fill a grid, or leave it zeroed and fail. Private to data/. */
#ifndef CELLIST_FORMATS_READ_H
#define CELLIST_FORMATS_READ_H

#include "source.h"

cellist_result read_gmsh(cellist_context *context, const struct source *source, struct grid *grid);
cellist_result read_medit(cellist_context *context, const struct source *source, struct grid *grid);
cellist_result read_off(cellist_context *context, const struct source *source, struct grid *grid);
cellist_result read_plot3d(cellist_context *context, const struct source *source, struct grid *grid);
cellist_result read_tetgen(cellist_context *context, const struct source *source, struct grid *grid);
cellist_result read_vtk_legacy(cellist_context *context, const struct source *source, struct grid *grid);
cellist_result read_vtk_xml(cellist_context *context, const struct source *source, struct grid *grid);

/* Whether the bytes fit any variant of a PLOT3D grid. */
bool plot3d_is_grid(const struct source *source);

#endif
