/* SPDX-License-Identifier: BSD-3-Clause
 * OpenGL in memory through OSMesa: no display, no device, the same on every machine. OSMesa wants a colour buffer to
 * bind; it is a token, since every picture is drawn into a framebuffer object. */
#include "context.h" /* before osmesa.h, whose gl.h would hide the types of glcorearb.h */

#include <GL/osmesa.h>

enum { TOKEN_SIZE = 16 }; /* pixels a side of the buffer that nothing is drawn to */

struct osmesa_state {
  OSMesaContext mesa;
  unsigned char *token;
};

static void osmesa_close(cellist_context *context, void *state) {
  struct osmesa_state *osmesa = state;
  if (osmesa->mesa != NULL) OSMesaDestroyContext(osmesa->mesa);
  cellist_deallocate(context, osmesa->token);
  cellist_deallocate(context, osmesa);
}

static cellist_result osmesa_open(cellist_context *context, void **state) {
  static const int attributes[] = {OSMESA_FORMAT,
                                   OSMESA_RGBA,
                                   OSMESA_PROFILE,
                                   OSMESA_CORE_PROFILE,
                                   OSMESA_CONTEXT_MAJOR_VERSION,
                                   4,
                                   OSMESA_CONTEXT_MINOR_VERSION,
                                   1,
                                   0};
  struct osmesa_state *osmesa = cellist_allocate_zeroed(context, 1, sizeof *osmesa);
  if (osmesa == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  osmesa->token = cellist_allocate(context, (size_t)TOKEN_SIZE * TOKEN_SIZE, 4);
  if (osmesa->token == NULL) {
    osmesa_close(context, osmesa);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  osmesa->mesa = OSMesaCreateContextAttribs(attributes, NULL);
  if (osmesa->mesa == NULL) {
    osmesa_close(context, osmesa);
    return cellist_fail(context, CELLIST_ERROR_GRAPHICS, "OSMesa gives no OpenGL 4.1 core context");
  }
  *state = osmesa;
  return CELLIST_SUCCESS;
}

static bool osmesa_enter(void *state) {
  struct osmesa_state *osmesa = state;
  return OSMesaMakeCurrent(osmesa->mesa, osmesa->token, GL_UNSIGNED_BYTE, TOKEN_SIZE, TOKEN_SIZE) == GL_TRUE;
}

static void osmesa_leave(void *state) {
  (void)state;
  OSMesaMakeCurrent(NULL, NULL, GL_UNSIGNED_BYTE, 0, 0);
}

static gl_procedure osmesa_procedure(void *state, const char *name) {
  (void)state;
  return (gl_procedure)OSMesaGetProcAddress(name);
}

const gl_backend gl_backend_osmesa = {"osmesa",     osmesa_open,      osmesa_enter,
                                      osmesa_leave, osmesa_procedure, osmesa_close};

#if CELLIST_LEAK_CHECK
/* OSMesa (22.3) never frees what OSMesaMakeCurrent allocates: some 200 bytes a context, and its screen. For builds with
 * the address sanitizer only, which asks this function what to overlook. */
CELLIST_API const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) { return "leak:OSMesaMakeCurrent\nleak:libOSMesa.so\n"; }
#endif
