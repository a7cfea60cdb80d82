/* SPDX-License-Identifier: BSD-3-Clause
 * Records: what the shader of `faces` reads of a cell, in double until it is written. Private. */
#ifndef CELLIST_GL_RECORDS_H
#define CELLIST_GL_RECORDS_H

#include "cells.h"

/* Pixels. A face whose picture is thinner is a line: single precision cannot tell on which side of it, or in it, a
 * pixel lies. Larger: pixels in a face's picture lose the crossing from one cell to the other. Smaller: both cells at a
 * face, or neither, may draw a pixel. */
#define GL_THIN_FACE (1.0 / 4096)

/* Everything that a cell has in OpenGL's buffers beside its triangles. */
typedef struct gl_record {
  float floats[GL_RECORD_FLOATS];
  float lights[GL_LIGHT_FLOATS]; /* if the frame's light has gradients at points */
  gl_extra extra;
  bool has_extra, only_backs; /* only_backs: no other face than back ones ends a ray */
} gl_record;

/* sides: bit k is set if the face opposite to corner k is a back face, bit 4 + k if it is a front face, exactly; wild:
 * a corner has no useful place in the picture. extra is written where has_extra is set. */
void gl_record_write(const gl_cells *cells, uint32_t tet, const gl_shown *shown, unsigned sides, bool wild,
                     gl_record *out);

/* The last texel alone: light by one gradient. */
void gl_record_light(const gl_cells *cells, uint32_t tet, float record[GL_RECORD_FLOATS]);

#endif
