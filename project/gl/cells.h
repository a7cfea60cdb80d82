/* SPDX-License-Identifier: BSD-3-Clause
 * Cells of one frame as the shaders of `faces` want them: a footprint and a record each. Free of OpenGL. Private. */
#ifndef CELLIST_GL_CELLS_H
#define CELLIST_GL_CELLS_H

#include <cellist/mesh.h>
#include <cellist/view.h>

#include "footprint.h"
#include "intervals.h"
#include "light.h"

enum {
  GL_RECORD_FLOATS = 28, /* seven texels a cell, see faces.frag */
  GL_CELLS_GRAIN = 1024, /* cells that are prepared and drawn together */
  GL_CELLS_TRIANGLES = 2 /* at most, of a cell */
};

/* Corner of a triangle: where in the picture (-1..1), and the record of its cell. */
typedef struct gl_corner {
  float x, y, record;
} gl_corner;

/* What stays from frame to frame: the mesh's arrays and its scalar, scaled. */
typedef struct gl_cells_mesh {
  const cellist_mesh_arrays *arrays; /* the mesh's */
  bool on_cells;
  const double *values; /* the scalar's: per point or per tet */
  float *scalars;       /* the same, scaled; NaN where not finite */
} gl_cells_mesh;

/* One frame. */
typedef struct gl_cells {
  cellist_context *context;
  const gl_cells_mesh *mesh;
  cellist_frame frame;
  const gl_intervals *intervals;
  gl_light light;
  gl_picture picture;
  double (*corners)[3]; /* [point_count] as gl_picture wants them */
  uint8_t *outside;     /* [point_count] OUTSIDE bits of cells.c */
} gl_cells;

/* What gl_cells_prepare writes, one entry a cell of the order. */
typedef struct gl_cells_output {
  float (*records)[GL_RECORD_FLOATS];
  float (*lights)[GL_LIGHT_FLOATS]; /* if the light has gradients at points; else NULL */
  gl_corner *corners;               /* three for each of GL_CELLS_TRIANGLES triangles */
} gl_cells_output;

cellist_result gl_cells_mesh_make(cellist_context *context, const cellist_mesh *mesh, const cellist_scalar *scalar,
                                  gl_cells_mesh *made);
void gl_cells_mesh_release(cellist_context *context, gl_cells_mesh *mesh);

/* Transforms the points. mesh, intervals and the light's gradients are borrowed until gl_cells_release; margin is
 * gl_picture's. */
cellist_result gl_cells_begin(cellist_context *context, const gl_cells_mesh *mesh, const cellist_frame *frame,
                              const gl_intervals *intervals, const gl_light *light, double margin, gl_cells *cells);
void gl_cells_release(gl_cells *cells);

/* Prepares the tets order[0..count): record i is that of order[i], if it shows anything. The triangles of the cells
 * that start at a multiple g of the grain go to output->corners + 3 GL_CELLS_TRIANGLES g; their numbers of corners and
 * of cells to counts[g / GL_CELLS_GRAIN]. */
typedef struct gl_cells_count {
  uint32_t corners, cells;
} gl_cells_count;
void gl_cells_prepare(const gl_cells *cells, const uint32_t *order, size_t count, const gl_cells_output *output,
                      gl_cells_count *counts);

#endif
