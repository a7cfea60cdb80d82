/* SPDX-License-Identifier: BSD-3-Clause
 * Check: what callers say of optics, in one place for every renderer. */
#include <cellist/optics.h>
#include <math.h>

static cellist_result check_light(cellist_context *context, const cellist_light *light) {
  bool finite = true;
  for (int k = 0; k < 3; k++) finite = finite && isfinite(light->direction[k]);
  if (!finite) return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the light's direction is not finite");
  if (!(light->ambient >= 0 && light->diffuse >= 0 && light->specular >= 0) || !isfinite(light->ambient) ||
      !isfinite(light->diffuse) || !isfinite(light->specular))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "the light's ambient, diffuse and specular shares must be finite and at least 0");
  if (light->specular > 0 && !(light->shininess >= 1 && isfinite(light->shininess)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "the highlight's exponent is %g; it must be at least 1", light->shininess);
  if (!(light->gradient_unit > 0 && isfinite(light->gradient_unit)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the light's unit of gradients must be above 0");
  return CELLIST_SUCCESS;
}

cellist_result cellist_optics_check(cellist_context *context, const cellist_optics *optics) {
  if ((unsigned)optics->model > CELLIST_MODEL_ISOSURFACES)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "there is no optical model %d", (int)optics->model);
  if (optics->sample_count > 4)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "%u samples a segment are more than 4",
                        optics->sample_count);
  if (optics->model == CELLIST_MODEL_ISOSURFACES) {
    if (optics->iso_count > 0 && optics->isos == NULL)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the isosurfaces are NULL");
    for (size_t i = 0; i < optics->iso_count; i++)
      if (!isfinite(optics->isos[i].value) || !(optics->isos[i].opacity >= 0 && optics->isos[i].opacity <= 1))
        return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                            "isosurface %zu has value %g and opacity %g; the opacity must lie between 0 and 1", i,
                            optics->isos[i].value, optics->isos[i].opacity);
  }
  return optics->light.enabled ? check_light(context, &optics->light) : CELLIST_SUCCESS;
}
