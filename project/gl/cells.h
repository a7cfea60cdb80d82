/* SPDX-License-Identifier: BSD-3-Clause
 * Cells of one frame as the shaders of `faces` want them: a footprint and a record each. Free of OpenGL. Private. */
#ifndef CELLIST_GL_CELLS_H
#define CELLIST_GL_CELLS_H

#include <cellist/mesh.h>
#include <cellist/view.h>

#include "fan.h"
#include "footprint.h"
#include "intervals.h"
#include "light.h"

enum {
  GL_RECORD_FLOATS = 24, /* six texels a cell, see cell.glsl */
  GL_CELLS_GRAIN = 1024, /* cells of a piece, at most */
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

/* Of a point: beyond each side of the view, before the near plane; without a useful place in the picture. */
enum { GL_OUTSIDE_VIEW = 31, GL_OUTSIDE_NEAR = 16, GL_OUTSIDE_WILD = 32, GL_OUTSIDE_BITS = 6 };
/* Intervals that fit beside these bits. */
enum { GL_POINT_INTERVALS = 1 << 24 };

/* A point as a frame has it, in half a cache line. */
typedef struct gl_point {
  double at[3];     /* as gl_picture wants corners */
  float scalar;     /* scaled, if scalars are on points */
  uint32_t outside; /* GL_OUTSIDE bits; above them the scalar's interval, if all fit */
} gl_point;

/* The scaled scalars of a tet's corners and the transfer function's intervals that they touch. */
typedef struct gl_shown {
  float scalars[4];
  uint32_t first, last;
} gl_shown;

/* One frame. Lengths are in `unit`, so that single precision has their range whatever the mesh is measured in. */
typedef struct gl_cells {
  cellist_context *context;
  const gl_cells_mesh *mesh;
  cellist_frame frame; /* eye and axes as given; near_distance and the half sizes of a parallel view in units */
  double unit;         /* a power of two: gl_unit_of the mesh */
  const gl_intervals *intervals;
  gl_light light;
  gl_picture picture;
  int handedness;   /* of right, up, forward: 1 or -1 */
  gl_point *points; /* [point_count] */
} gl_cells;

/* What cells ask of the program that draws them: less is faster. */
typedef enum gl_need {
  GL_NEED_LITTLE,   /* two intervals of the transfer function at most, no segment deeper than 1 (exact.glsl) */
  GL_NEED_STEPS,    /* two intervals, no segment deeper than a few */
  GL_NEED_FEW,      /* four intervals, no segment deeper than a few */
  GL_NEED_DEPTH,    /* any intervals and depths */
  GL_NEED_ANYTHING, /* and an extra, a wild corner or one before the near plane */
  GL_NEED_COUNT
} gl_need;

/* Part of an order that is prepared and drawn together: cells from far to near, or a small group. */
typedef struct gl_piece {
  uint32_t begin, count; /* of the order that is prepared */
  bool is_group;
  bool as_fans; /* cells without wild corners are drawn as fans */
  /* Filled in by gl_cells_prepare: runs, triangles, cells that show something, those of them that as_fans left to
   * footprints, and where the footprints are (-1..1). */
  uint32_t run_count, triangle_count, cell_count, left_count;
  bool has_extras;
  float low[2], high[2];
} gl_piece;

/* Corners of triangles of one kind. */
typedef struct gl_run {
  uint32_t first, count;
  bool is_fan;
  gl_need need;
  float area; /* of its triangles, in pixels */
} gl_run;

/* What some records have beside them; written only where a record has faces seen edge-on or back faces alone, or lies
 * in a small group. lines: for each of three faces that is seen edge-on, the line of its picture: constant, change per
 * pixel in x and y from the image's centre, above 0 on the cell's side; and how much of that is in doubt, above 0 (0:
 * no line). The two cells that share the face have the same numbers but for their sign, so that one of them owns a
 * pixel on the line. */
typedef struct gl_extra {
  float lines[3][4];
  float first_record, member_count; /* of the small group */
  float only_backs, unused;
} gl_extra;

/* What gl_cells_prepare writes, one entry a cell of the order. */
typedef struct gl_cells_output {
  float (*records)[GL_RECORD_FLOATS];
  float (*lights)[GL_LIGHT_FLOATS]; /* if the light has gradients at points; else NULL */
  gl_extra *extras;
  gl_corner *corners;         /* three for each of GL_CELLS_TRIANGLES triangles */
  gl_fan_corner *fan_corners; /* three for each of GL_FAN_TRIANGLES triangles, if a piece wants fans */
  gl_run *runs;
} gl_cells_output;

cellist_result gl_cells_mesh_make(cellist_context *context, const cellist_mesh *mesh, const cellist_scalar *scalar,
                                  gl_cells_mesh *made);
void gl_cells_mesh_release(cellist_context *context, gl_cells_mesh *mesh);

/* A power of two near the mesh's size; 1 for a mesh without one. */
double gl_unit_of(const cellist_mesh_arrays *mesh);

/* Transforms the points. mesh, intervals and the light's gradients are borrowed until gl_cells_release; margin is
 * gl_picture's. */
cellist_result gl_cells_begin(cellist_context *context, const gl_cells_mesh *mesh, const cellist_frame *frame,
                              const gl_intervals *intervals, const gl_light *light, double margin, gl_cells *cells);
void gl_cells_release(gl_cells *cells);

/* What a tet of these points shows; false if nothing. */
bool gl_cells_find_shown(const gl_cells *cells, uint32_t tet, const gl_point *const points[4], gl_shown *shown);

/* Prepares the pieces of order: record i is that of order[i], if it shows anything; in a group the others get one of
 * which the last interval lies before the first one. The runs of a piece that begins at b stand from output->runs + b
 * on, its corners from output->corners + 3 GL_CELLS_TRIANGLES b and output->fan_corners + 3 GL_FAN_TRIANGLES b. */
void gl_cells_prepare(const gl_cells *cells, const uint32_t *order, gl_piece *pieces, size_t piece_count,
                      const gl_cells_output *output);

#endif
