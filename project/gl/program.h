/* SPDX-License-Identifier: BSD-3-Clause
 * Shader programs from the texts in shaders/, one per variant, compiled when first asked for. Private. */
#ifndef CELLIST_GL_PROGRAM_H
#define CELLIST_GL_PROGRAM_H

#include "api.h"

enum { GL_PROGRAM_PARTS = 12 }; /* texts a shader may be put together from */

/* Compiles and links as GLSL of that version (410: OpenGL 4.1). defines: lines "#define NAME\n" or ""; both lists end
 * with NULL. Fails with GRAPHICS and the driver's words, or OUT_OF_MEMORY; the context must be current. */
cellist_result gl_program_build(cellist_context *context, const gl_api *api, int version, const char *defines,
                                const char *const *vertex, const char *const *fragment, GLuint *program);

#endif
