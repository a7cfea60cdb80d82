/* SPDX-License-Identifier: BSD-3-Clause
 * Integrators: which shader texts gather what a ray sees in a cell, and the tables that they look up. Private. */
#ifndef CELLIST_GL_INTEGRATORS_H
#define CELLIST_GL_INTEGRATORS_H

#include <cellist/mesh.h>
#include <cellist/optics.h>
#include <cellist/preintegration.h>

#include "api.h"
#include "intervals.h"

/* Each has a shader text of its own. */
typedef enum gl_integrator {
  GL_INTEGRATOR_EXACT,
  GL_INTEGRATOR_PSI,
  GL_INTEGRATOR_TABLE,
  GL_INTEGRATOR_EMISSION,
  GL_INTEGRATOR_MAXIMUM,
  GL_INTEGRATOR_ISOSURFACES,
  GL_INTEGRATOR_COUNT
} gl_integrator;

gl_integrator gl_integrator_of(const cellist_optics *optics);

enum { GL_INTEGRATOR_TEXTS = 6 }; /* room for what gl_integrator_texts writes */

/* Writes the texts that define gather(), in order and then NULL, and returns the lines that must stand before them.
 * lit: by gradients at points. */
const char *gl_integrator_texts(gl_integrator integrator, bool lit, const char *texts[GL_INTEGRATOR_TEXTS]);

/* The tables of an OpenGL context; {0} has none. */
typedef struct gl_tables {
  cellist_preintegration *made; /* NULL: none yet */
  cellist_transfer transfer;    /* that it was made for */
  cellist_preintegration_desc desc;
  GLuint textures[3]; /* ambient, front, back */
  GLuint psi;
} gl_tables;

/* What a frame's tables are made for. */
typedef struct gl_tables_use {
  gl_integrator integrator;
  bool lit, black; /* black: absorption alone */
  const cellist_transfer *transfer;
  const uint32_t *size; /* [2] as cellist_optics */
  gl_scale scale;
  double longest; /* no segment is longer */
} gl_tables_use;

/* Makes and uploads what the integrator looks up, unless it is there already. The OpenGL context must be current.
 * Fails with OUT_OF_MEMORY, UNSUPPORTED (too large for this OpenGL), INVALID_ARGUMENT (a size out of range). */
cellist_result gl_tables_prepare(cellist_context *context, const gl_api *api, const gl_tables_use *use,
                                 gl_tables *tables);

/* Binds them to texture units from first_unit on, up to three, and tells the program. length_unit: of its lengths. */
void gl_tables_bind(const gl_api *api, const gl_tables *tables, gl_integrator integrator, double length_unit,
                    GLuint program, int first_unit);

/* With the OpenGL context current. */
void gl_tables_release(cellist_context *context, const gl_api *api, gl_tables *tables);

#endif
