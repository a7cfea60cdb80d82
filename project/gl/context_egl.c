/* SPDX-License-Identifier: BSD-3-Clause
 * OpenGL without a window through EGL: a real device where EGL lists one, else Mesa's surfaceless platform, which
 * also renders in software. */
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <string.h>

#include "context.h"

enum { DEVICE_LIMIT = 16 }; /* devices looked at; a machine with more still works with the first ones */

struct egl_state {
  EGLDisplay display;
  EGLContext egl;
};

/* Whether name stands in a list of names between blanks. */
static bool has_word(const char *list, const char *name) {
  const size_t length = strlen(name);
  for (const char *at = list; at != NULL && (at = strstr(at, name)) != NULL; at += length)
    if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0')) return true;
  return false;
}

/* The first device that is not a software renderer, or EGL_NO_DEVICE_EXT. */
static EGLDeviceEXT find_hardware(void) {
  const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!has_word(extensions, "EGL_EXT_device_enumeration") || !has_word(extensions, "EGL_EXT_device_query") ||
      !has_word(extensions, "EGL_EXT_platform_device"))
    return EGL_NO_DEVICE_EXT;
  const PFNEGLQUERYDEVICESEXTPROC query_devices = (PFNEGLQUERYDEVICESEXTPROC)eglGetProcAddress("eglQueryDevicesEXT");
  const PFNEGLQUERYDEVICESTRINGEXTPROC query_string =
      (PFNEGLQUERYDEVICESTRINGEXTPROC)eglGetProcAddress("eglQueryDeviceStringEXT");
  EGLDeviceEXT devices[DEVICE_LIMIT];
  EGLint count = 0;
  if (query_devices == NULL || query_string == NULL || !query_devices(DEVICE_LIMIT, devices, &count))
    return EGL_NO_DEVICE_EXT;
  for (EGLint i = 0; i < count; i++)
    if (!has_word(query_string(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software")) return devices[i];
  return EGL_NO_DEVICE_EXT;
}

bool gl_egl_has_hardware(void) { return find_hardware() != EGL_NO_DEVICE_EXT; }

static EGLDisplay open_display(void) {
  const EGLDeviceEXT device = find_hardware();
  if (device != EGL_NO_DEVICE_EXT) {
    EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, device, NULL);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL)) return display;
  }
  EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
  if (display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL)) return display;
  return EGL_NO_DISPLAY;
}

/* The display belongs to the process (EGL gives the same one to every caller), so it is never terminated here:
 * another renderer may be using it. */
static void egl_close(cellist_context *context, void *state) {
  struct egl_state *egl = state;
  if (egl->egl != EGL_NO_CONTEXT) eglDestroyContext(egl->display, egl->egl);
  cellist_deallocate(context, egl);
}

static cellist_result egl_open(cellist_context *context, void **state) {
  static const EGLint attributes[] = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 1, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  struct egl_state *egl = cellist_allocate_zeroed(context, 1, sizeof *egl);
  if (egl == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  egl->egl = EGL_NO_CONTEXT;
  egl->display = open_display();
  if (egl->display != EGL_NO_DISPLAY && eglBindAPI(EGL_OPENGL_API))
    egl->egl = eglCreateContext(egl->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (egl->egl == EGL_NO_CONTEXT) {
    const EGLint code = eglGetError();
    egl_close(context, egl);
    return cellist_fail(context, CELLIST_ERROR_GRAPHICS,
                        "EGL gives no surfaceless OpenGL 4.1 core context (EGL error 0x%x)", (unsigned)code);
  }
  *state = egl;
  return CELLIST_SUCCESS;
}

static bool egl_enter(void *state) {
  struct egl_state *egl = state;
  /* Which API is bound is a property of the thread. */
  return eglBindAPI(EGL_OPENGL_API) && eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->egl);
}

static void egl_leave(void *state) {
  struct egl_state *egl = state;
  eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static gl_procedure egl_procedure(void *state, const char *name) {
  (void)state;
  return (gl_procedure)eglGetProcAddress(name);
}

const gl_backend gl_backend_egl = {"egl", egl_open, egl_enter, egl_leave, egl_procedure, egl_close};
