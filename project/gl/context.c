/* SPDX-License-Identifier: BSD-3-Clause
 * Which OpenGL: the backend that was asked for, or for `auto` EGL where it has a real device, else OSMesa, else EGL's
 * software renderer. A window system is never opened unasked: `glfw` must be named. */
#include "context.h"

static const gl_backend *choose(cellist_gl_backend which) {
  switch (which) {
    case CELLIST_GL_AUTO:
#if CELLIST_HAVE_EGL
      if (gl_egl_has_hardware()) return &gl_backend_egl;
#endif
#if CELLIST_HAVE_OSMESA
      return &gl_backend_osmesa;
#elif CELLIST_HAVE_EGL
      return &gl_backend_egl;
#else
      return NULL;
#endif
    case CELLIST_GL_OSMESA:
#if CELLIST_HAVE_OSMESA
      return &gl_backend_osmesa;
#else
      return NULL;
#endif
    case CELLIST_GL_EGL:
#if CELLIST_HAVE_EGL
      return &gl_backend_egl;
#else
      return NULL;
#endif
    case CELLIST_GL_GLFW:
#if CELLIST_HAVE_GLFW
      return &gl_backend_glfw;
#else
      return NULL;
#endif
  }
  return NULL;
}

const gl_backend *gl_backend_find(cellist_context *context, cellist_gl_backend which) {
  static const char *const names[] = {"auto", "osmesa", "egl", "glfw"};
  if ((unsigned)which >= sizeof names / sizeof *names) {
    cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "no OpenGL backend has the number %d", (int)which);
    return NULL;
  }
  const gl_backend *backend = choose(which);
  if (backend == NULL)
    cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "OpenGL through %s was not built in", names[which]);
  return backend;
}
