/* SPDX-License-Identifier: BSD-3-Clause
 * Surface: opaque triangles that stand in a picture. What lies behind them is hidden, the volume in front of them
 * attenuates them, and cells are cut where they stand. Clip planes and the near plane cut surfaces, too.
 *
 * Every renderer takes one surface (several are joined into one) and shows it alike. Along a ray, the volume counts up
 * to the nearest point of the surface, by whatever model; then the surface's colour, of opacity 1, is put behind it:
 * colour + (1 - A) * surface, and A becomes 1. So under emission, which absorbs nothing, the surface's colour is added
 * whole; under maximum intensity it shows where no cell is met in front of it.
 *
 * The picture's light lights the surface by its normal N, both sides alike, as it lights isosurfaces:
 *   colour (ambient + diffuse |N . L|) + specular |N . H|^shininess.
 * Without a light (cellist_light.enabled false) the surface is lit from the camera, ambient 0.2 and diffuse 0.8. */
#ifndef CELLIST_SURFACE_H
#define CELLIST_SURFACE_H

#include <cellist/mesh.h>
#include <cellist/transfer.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cellist_surface cellist_surface;

/* Triangles in the mesh's frame and units; {0} is a surface without any. A triangle without an area is never seen; of
 * triangles with the same three corners the first one is kept, so that every renderer shows the same. */
typedef struct cellist_surface_arrays {
  size_t point_count;
  const double *positions; /* [3 point_count] x y z, finite */
  const double *normals;   /* [3 point_count] of any length, for smooth shading; 0 0 0: none there; NULL: triangles are
                              shaded flat, as is a point whose normals cancel out */
  const float *colours;    /* [3 point_count] linear R G B; NULL: light grey, 0.8 */
  size_t triangle_count;
  const uint32_t *triangles; /* [3 triangle_count] each below point_count */
} cellist_surface_arrays;

/* Makes a surface from arrays.
 * Arrays: read during the call only. *surface is the caller's, for cellist_surface_destroy.
 * Errors: INVALID_ARGUMENT (NULL arrays, 2^31 triangles or points or more, a point id out of range), GEOMETRY (a
 *   coordinate, normal or colour that is not finite; the message names the point), OUT_OF_MEMORY.
 * Threads: one call per context at a time. The surface may be read by any number of threads.
 * Cost: linear; some 100 bytes a triangle. */
CELLIST_API cellist_result cellist_surface_create(cellist_context *context, const cellist_surface_arrays *arrays,
                                                  cellist_surface **surface);

/* Makes one surface of several. Flat shaded parts stay flat. Where parts coincide the first one is seen.
 * Arrays: parts[part_count]; they are copied. Errors, threads and cost as cellist_surface_create. */
CELLIST_API cellist_result cellist_surface_join(cellist_context *context, const cellist_surface *const *parts,
                                                size_t part_count, cellist_surface **surface);

/* Frees the surface; NULL is legal. The context that made it must still exist. */
CELLIST_API void cellist_surface_destroy(cellist_surface *surface);

/* What the surface holds, triangles in an order of its own; normals are of length 1 or 0, or NULL; colours are never
 * NULL. The arrays live as long as the surface. Threads: any. */
CELLIST_API const cellist_surface_arrays *cellist_surface_get_arrays(const cellist_surface *surface);

/* Lower corner, then upper corner of the points that triangles use; zeroes if there are none. Threads: any. */
CELLIST_API void cellist_surface_bounds(const cellist_surface *surface, double bounds[6]);

/* Reads the triangles of an STL, OBJ or PLY file (told apart by the name's ending); polygons are split.
 * Arrays: colour is NULL (the file's colours at points, taken as sRGB, else grey) or 3 linear values for all of it.
 *   *surface is the caller's. Normals are used where OBJ or PLY has them. Materials are not read.
 * Errors: IO, FORMAT (not such a file, cut, no triangle in it), GEOMETRY (a NaN or infinite coordinate: the message
 *   names the file and the vertex), UNSUPPORTED (another ending; a build without assimp; 4 GB or more), OUT_OF_MEMORY.
 * Threads: one call per context at a time; calls of different contexts wait for one another.
 * Cost: linear in the file. assimp's own memory, which does not come from the context's allocator, is some ten times
 *   the file. Coordinates pass through single precision. */
CELLIST_API cellist_result cellist_surface_read(cellist_context *context, const char *path, const double colour[3],
                                                cellist_surface **surface);

/* The same for a file that stands in memory: bytes[size], read during the call only; the name's ending tells the
 * format. */
CELLIST_API cellist_result cellist_surface_read_memory(cellist_context *context, const char *name, const void *bytes,
                                                       size_t size, const double colour[3], cellist_surface **surface);

/* Cells to be shown as an opaque solid. */
typedef struct cellist_surface_cells {
  const cellist_mesh *mesh;
  const uint8_t *chosen;            /* [tets] not 0: shown; NULL: all, which is the mesh's own boundary */
  const double *colour;             /* 3 linear values; NULL: by scalar, else grey */
  const cellist_scalar *scalar;     /* of the mesh; NULL: no colours by scalar */
  const cellist_transfer *transfer; /* the colours; must not be NULL if scalar is not */
} cellist_surface_cells;

/* Makes the surface around chosen cells: their faces towards cells that are not chosen, or towards none. Colours by
 * scalar are linear between a face's corners, or one a face if the scalar is on cells; grey where it is not finite.
 * Arrays: cells and what it refers to are read during the call only. *surface is the caller's.
 * Errors: INVALID_ARGUMENT (NULL, a scalar that is not of this mesh), OUT_OF_MEMORY.
 * Threads: one call per context at a time. Cost: linear in tets. */
CELLIST_API cellist_result cellist_surface_from_cells(cellist_context *context, const cellist_surface_cells *cells,
                                                      cellist_surface **surface);

#ifdef __cplusplus
}
#endif
#endif
