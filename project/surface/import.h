/* SPDX-License-Identifier: BSD-3-Clause
 * The seam to the library that knows the formats of triangle files. Private to project/surface/. */
#ifndef CELLIST_SURFACE_IMPORT_H
#define CELLIST_SURFACE_IMPORT_H

#include <cellist/surface.h>

#if CELLIST_HAVE_ASSIMP
/* Reads bytes[size] in the format of that file ending ("stl", "obj", "ply"), with their own normals if wanted. name:
 * for messages. colour: NULL or 3 values for all of it. Fails as cellist_surface_read. */
cellist_result surface_import(cellist_context *context, const char *name, const char *format, const void *bytes,
                              size_t size, bool with_normals, const double colour[3], cellist_surface **surface);
#endif

#endif
