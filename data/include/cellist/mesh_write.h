/* SPDX-License-Identifier: BSD-3-Clause
 * Writing meshes to files that other programs read. */
#ifndef CELLIST_MESH_WRITE_H
#define CELLIST_MESH_WRITE_H

#include <cellist/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum cellist_mesh_format {
  CELLIST_MESH_FORMAT_BY_NAME, /* .vtk: legacy VTK; else VTU */
  CELLIST_MESH_FORMAT_VTU,     /* VTK's XML format: appended raw data, zlib, little-endian */
  CELLIST_MESH_FORMAT_VTK      /* VTK's legacy format 3.0, binary */
} cellist_mesh_format;

/* {0} is the default. */
typedef struct cellist_mesh_write_desc {
  cellist_mesh_format format;
} cellist_mesh_write_desc;

/* Writes a mesh: its tets, points and all fields, in the order of the user's ids, in float where that loses nothing.
 * Arrays: path is a file, written whole or not at all, or "-" for standard output. desc may be NULL.
 * Errors: IO (cannot be written, with the system's reason), OUT_OF_MEMORY, CANCELLED.
 * Threads: one call per context at a time; blocks are compressed by the context's workers, alike for any number.
 * Cost: linear; the compressed arrays are held in memory. */
CELLIST_API cellist_result cellist_mesh_write(cellist_context *context, const cellist_mesh *mesh, const char *path,
                                              const cellist_mesh_write_desc *desc);

#ifdef __cplusplus
}
#endif
#endif
