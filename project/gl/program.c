/* SPDX-License-Identifier: BSD-3-Clause
 * Shader programs: compile, link, and say in the driver's words what is wrong. */
#include "program.h"

#include <stdio.h>

enum { LOG_CAPACITY = 768 }; /* of the driver's message; the context's own messages end at 1024 */

static cellist_result compile(cellist_context *context, const gl_api *api, GLenum kind, int version,
                              const char *defines, const char *const *parts, GLuint *shader) {
  char first[32];
  snprintf(first, sizeof first, "#version %d core\n", version);
  const char *texts[GL_PROGRAM_PARTS + 2] = {first, defines};
  GLsizei count = 2;
  for (; *parts != NULL; parts++) texts[count++] = *parts;
  *shader = api->CreateShader(kind);
  api->ShaderSource(*shader, count, texts, NULL);
  api->CompileShader(*shader);
  GLint compiled = 0;
  api->GetShaderiv(*shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) return CELLIST_SUCCESS;
  char message[LOG_CAPACITY] = "";
  api->GetShaderInfoLog(*shader, sizeof message, NULL, message);
  return cellist_fail(context, CELLIST_ERROR_GRAPHICS, "a shader does not compile: %s", message);
}

cellist_result gl_program_build(cellist_context *context, const gl_api *api, int version, const char *defines,
                                const char *const *vertex, const char *const *fragment, GLuint *program) {
  GLuint shaders[2] = {0, 0};
  cellist_result result = compile(context, api, GL_VERTEX_SHADER, version, defines, vertex, &shaders[0]);
  if (result == CELLIST_SUCCESS)
    result = compile(context, api, GL_FRAGMENT_SHADER, version, defines, fragment, &shaders[1]);
  GLuint made = 0;
  if (result == CELLIST_SUCCESS) {
    made = api->CreateProgram();
    api->AttachShader(made, shaders[0]);
    api->AttachShader(made, shaders[1]);
    api->LinkProgram(made);
    GLint linked = 0;
    api->GetProgramiv(made, GL_LINK_STATUS, &linked);
    if (!linked) {
      char message[LOG_CAPACITY] = "";
      api->GetProgramInfoLog(made, sizeof message, NULL, message);
      result = cellist_fail(context, CELLIST_ERROR_GRAPHICS, "shaders do not link: %s", message);
      api->DeleteProgram(made);
    }
  }
  if (shaders[0] != 0) api->DeleteShader(shaders[0]);
  if (shaders[1] != 0) api->DeleteShader(shaders[1]);
  if (result == CELLIST_SUCCESS) *program = made;
  return result;
}
