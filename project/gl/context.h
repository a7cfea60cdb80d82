/* SPDX-License-Identifier: BSD-3-Clause
 * The seam between the renderers and whatever gives an OpenGL 4.1 core context. A backend is a struct of functions;
 * each lives in a file of its own (context_osmesa.c, context_egl.c, context_glfw.c). Private. */
#ifndef CELLIST_GL_CONTEXT_H
#define CELLIST_GL_CONTEXT_H

#include <cellist/gl.h>

#include "api.h"

typedef struct gl_backend {
  const char *name;
  /* Makes a context that is not yet current. Fails with GRAPHICS (and why) or OUT_OF_MEMORY. */
  cellist_result (*open)(cellist_context *context, void **state);
  /* Makes it current on the calling thread, and gives it up again. */
  bool (*enter)(void *state);
  void (*leave)(void *state);
  gl_procedure (*procedure)(void *state, const char *name);
  void (*close)(cellist_context *context, void *state);
} gl_backend;

/* The backend of that name that was built in; NULL and a recorded failure (UNSUPPORTED) if it was not. */
const gl_backend *gl_backend_find(cellist_context *context, cellist_gl_backend which);

#if CELLIST_HAVE_OSMESA
extern const gl_backend gl_backend_osmesa;
#endif
#if CELLIST_HAVE_EGL
extern const gl_backend gl_backend_egl;
/* Whether EGL lists a device that is not a software renderer; opens nothing. */
bool gl_egl_has_hardware(void);
#endif
#if CELLIST_HAVE_GLFW
extern const gl_backend gl_backend_glfw;
#endif

#endif
