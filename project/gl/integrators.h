/* SPDX-License-Identifier: BSD-3-Clause
 * Integrators: which shader texts gather what a ray sees in a cell. Private. */
#ifndef CELLIST_GL_INTEGRATORS_H
#define CELLIST_GL_INTEGRATORS_H

#include <cellist/optics.h>

/* Each has a shader text of its own. */
typedef enum gl_integrator {
  GL_INTEGRATOR_EXACT,
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

#endif
