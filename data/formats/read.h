/* SPDX-License-Identifier: BSD-3-Clause
 * The readers, one for each format: they fill a zeroed grid, or release it and fail. Private to data/. */
#ifndef CELLIST_FORMATS_READ_H
#define CELLIST_FORMATS_READ_H

#include "source.h"

cellist_result read_vtk_xml(cellist_context *context, const struct source *source, struct grid *grid);

#endif
