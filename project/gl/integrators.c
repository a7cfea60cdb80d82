/* SPDX-License-Identifier: BSD-3-Clause
 * Integrators: texts that define gather(front, back, length, intervals, seen), the one thing that faces.frag calls.
 *
 * Those of the volume models with light by gradients at points define integrate(), which gives the moments that light
 * needs, and lit.glsl puts them together; without light the sums are simpler and have texts of their own. */
#include "integrators.h"

#include <stddef.h>

extern const char cellist_text_exact_glsl[], cellist_text_exact_lit_glsl[], cellist_text_emission_glsl[],
    cellist_text_maximum_glsl[], cellist_text_isosurfaces_glsl[], cellist_text_light_glsl[], cellist_text_lit_glsl[],
    cellist_text_part_glsl[];

gl_integrator gl_integrator_of(const cellist_optics *optics) {
  switch (optics->model) {
    case CELLIST_MODEL_EMISSION: return GL_INTEGRATOR_EMISSION;
    case CELLIST_MODEL_MAXIMUM: return GL_INTEGRATOR_MAXIMUM;
    case CELLIST_MODEL_ISOSURFACES: return GL_INTEGRATOR_ISOSURFACES;
    default: return GL_INTEGRATOR_EXACT;
  }
}

const char *gl_integrator_texts(gl_integrator integrator, bool lit, const char *texts[GL_INTEGRATOR_TEXTS]) {
  static const char *const plain[GL_INTEGRATOR_COUNT] = {
      [GL_INTEGRATOR_EXACT] = cellist_text_exact_glsl,
      [GL_INTEGRATOR_EMISSION] = cellist_text_emission_glsl,
      [GL_INTEGRATOR_MAXIMUM] = cellist_text_maximum_glsl,
      [GL_INTEGRATOR_ISOSURFACES] = cellist_text_isosurfaces_glsl,
  };
  static const char *const moments[GL_INTEGRATOR_COUNT] = {
      [GL_INTEGRATOR_EXACT] = cellist_text_exact_lit_glsl,
      [GL_INTEGRATOR_EMISSION] = cellist_text_exact_lit_glsl,
  };
  size_t count = 0;
  if (lit) texts[count++] = cellist_text_light_glsl;
  if (lit && moments[integrator] != NULL) {
    texts[count++] = cellist_text_part_glsl;
    texts[count++] = moments[integrator];
    texts[count++] = cellist_text_lit_glsl;
  } else {
    texts[count++] = plain[integrator];
  }
  texts[count] = NULL;
  if (!lit) return "";
  return integrator == GL_INTEGRATOR_EMISSION ? "#define LIT\n#define EMISSION\n" : "#define LIT\n";
}
