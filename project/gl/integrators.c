/* SPDX-License-Identifier: BSD-3-Clause
 * Integrators: texts that define gather(front, back, length, intervals, seen), the one thing that faces.frag calls.
 *
 * Most define integrate(), which gives what light by gradients at points needs too; lit.glsl or unlit.glsl make
 * gather() of it. Exact integration without light is simpler and has texts of its own. */
#include "integrators.h"

#include <stddef.h>

extern const char cellist_text_exact_glsl[], cellist_text_exact_lit_glsl[], cellist_text_emission_glsl[],
    cellist_text_maximum_glsl[], cellist_text_isosurfaces_glsl[], cellist_text_light_glsl[], cellist_text_lit_glsl[],
    cellist_text_part_glsl[], cellist_text_psi_glsl[], cellist_text_table_glsl[], cellist_text_unlit_glsl[];

gl_integrator gl_integrator_of(const cellist_optics *optics) {
  switch (optics->model) {
    case CELLIST_MODEL_EMISSION: return GL_INTEGRATOR_EMISSION;
    case CELLIST_MODEL_MAXIMUM: return GL_INTEGRATOR_MAXIMUM;
    case CELLIST_MODEL_ISOSURFACES: return GL_INTEGRATOR_ISOSURFACES;
    default: break;
  }
  switch (optics->integration) {
    case CELLIST_INTEGRATION_PSI: return GL_INTEGRATOR_PSI;
    case CELLIST_INTEGRATION_TABLE: return GL_INTEGRATOR_TABLE;
    default: return GL_INTEGRATOR_EXACT;
  }
}

const char *gl_integrator_texts(gl_integrator integrator, bool lit, const char *texts[GL_INTEGRATOR_TEXTS]) {
  static const char *const gathers[GL_INTEGRATOR_COUNT] = {
      [GL_INTEGRATOR_EXACT] = cellist_text_exact_glsl,
      [GL_INTEGRATOR_EMISSION] = cellist_text_emission_glsl,
      [GL_INTEGRATOR_MAXIMUM] = cellist_text_maximum_glsl,
      [GL_INTEGRATOR_ISOSURFACES] = cellist_text_isosurfaces_glsl,
  };
  static const char *const integrates[GL_INTEGRATOR_COUNT] = {
      [GL_INTEGRATOR_EXACT] = cellist_text_exact_lit_glsl,
      [GL_INTEGRATOR_EMISSION] = cellist_text_exact_lit_glsl,
      [GL_INTEGRATOR_PSI] = cellist_text_psi_glsl,
      [GL_INTEGRATOR_TABLE] = cellist_text_table_glsl,
  };
  const bool has_parts = integrates[integrator] != NULL && (lit || gathers[integrator] == NULL);
  size_t count = 0;
  if (lit) texts[count++] = cellist_text_light_glsl;
  if (has_parts) {
    texts[count++] = cellist_text_part_glsl;
    texts[count++] = integrates[integrator];
    texts[count++] = lit ? cellist_text_lit_glsl : cellist_text_unlit_glsl;
  } else {
    texts[count++] = gathers[integrator];
  }
  texts[count] = NULL;
  if (!lit) return "";
  return integrator == GL_INTEGRATOR_EMISSION ? "#define LIT\n#define EMISSION\n" : "#define LIT\n";
}
