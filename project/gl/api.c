/* SPDX-License-Identifier: BSD-3-Clause
 * OpenGL entry points: name, type and place of each, walked once. */
#include "api.h"

#include <string.h>

cellist_result gl_api_load(cellist_context *context, gl_procedure (*procedure)(void *state, const char *name),
                           void *state, gl_api *api) {
  static const struct {
    const char *name;
    size_t offset;
    bool required;
  } entries[] = {
#define GL_API_ENTRY(name, type) {"gl" #name, offsetof(gl_api, name), true},
      GL_API_LIST(GL_API_ENTRY)
#undef GL_API_ENTRY
#define GL_API_ENTRY(name, type) {"gl" #name, offsetof(gl_api, name), false},
          GL_API_LIST_43(GL_API_ENTRY)
#undef GL_API_ENTRY
  };
  for (size_t i = 0; i < sizeof entries / sizeof *entries; i++) {
    const gl_procedure found = procedure(state, entries[i].name);
    if (found == NULL && entries[i].required)
      return cellist_fail(context, CELLIST_ERROR_GRAPHICS, "this OpenGL has no %s; version 4.1 is needed",
                          entries[i].name);
    memcpy((char *)api + entries[i].offset, &found, sizeof found);
  }
  return CELLIST_SUCCESS;
}
