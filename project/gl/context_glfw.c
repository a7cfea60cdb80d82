/* SPDX-License-Identifier: BSD-3-Clause
 * OpenGL of the desktop through a hidden GLFW window. GLFW must be used from the program's main thread; initialising
 * it a second time does nothing, so a program that has windows of its own keeps them. */
#include <string.h>

#include "context.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

enum { WINDOW_SIZE = 16 }; /* pixels a side of the window that is never shown */

static void glfw_close(cellist_context *context, void *state) {
  (void)context;
  glfwDestroyWindow(state);
}

static cellist_result glfw_open(cellist_context *context, void **state) {
  const char *reason = NULL;
  if (glfwInit()) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 1);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    *state = glfwCreateWindow(WINDOW_SIZE, WINDOW_SIZE, "cellist", NULL, NULL);
    glfwDefaultWindowHints();
    if (*state != NULL) return CELLIST_SUCCESS;
  }
  glfwGetError(&reason);
  return cellist_fail(context, CELLIST_ERROR_GRAPHICS, "GLFW gives no OpenGL 4.1 core context: %s",
                      reason != NULL ? reason : "no reason given");
}

static bool glfw_enter(void *state) {
  glfwMakeContextCurrent(state);
  return glfwGetCurrentContext() == state;
}

static void glfw_leave(void *state) {
  (void)state;
  glfwMakeContextCurrent(NULL);
}

static gl_procedure glfw_procedure(void *state, const char *name) {
  (void)state;
  return (gl_procedure)glfwGetProcAddress(name);
}

const gl_backend gl_backend_glfw = {"glfw", glfw_open, glfw_enter, glfw_leave, glfw_procedure, glfw_close};
