/* SPDX-License-Identifier: BSD-3-Clause
 * Load: where a pipeline's mesh comes from, a file or a generator. */
#include <cellist/generate.h>
#include <cellist/pipeline.h>
#include <cellist/validate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One of ",seed=N", ",perturb=P", ",parts=N"; their ranges are the generator's affair. */
static bool read_setting(const char *text, cellist_generate_desc *desc) {
  char *end = NULL;
  if (strncmp(text, "seed=", 5) == 0)
    desc->seed = strtoull(text += 5, &end, 10);
  else if (strncmp(text, "perturb=", 8) == 0)
    desc->perturb = strtod(text += 8, &end);
  else if (strncmp(text, "parts=", 6) == 0)
    desc->parts = (uint32_t)strtoul(text += 6, &end, 10);
  else
    return false;
  return end != text && *text != '-' && (*end == '\0' || *end == ',');
}

/* begin: the source after its prefix, NAME[:SIZE][,KEY=VALUE]... */
static cellist_result generate(cellist_context *context, const char *source, const char *begin, cellist_mesh **mesh) {
  char name[64];
  const size_t length = strcspn(begin, ":,");
  cellist_generate_desc desc = {0};
  const char *at = begin + length;
  if (*at == ':') {
    char *end = NULL;
    const double size = strtod(at + 1, &end);
    if (end == at + 1 || (*end != '\0' && *end != ',') || !(size >= 1 && size <= 1e9))
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "%s: the size must lie between 1 and 1e9", source);
    desc.size = (size_t)size;
    at = end;
  }
  for (; *at == ','; at += strcspn(at, ","))
    if (!read_setting(++at, &desc))
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "%s: after the size only seed=N, perturb=P and parts=N may follow", source);
  snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1), begin);
  return cellist_generate(context, name, &desc, mesh);
}

cellist_result cellist_pipeline_load(cellist_context *context, const char *source, const cellist_mesh_read_desc *desc,
                                     cellist_mesh **mesh) {
  static const char prefix[] = "sample:";
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (source == NULL || mesh == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_pipeline_load: source or mesh is NULL");
  cellist_mesh *loaded = NULL;
  cellist_result result = strncmp(source, prefix, sizeof prefix - 1) == 0
                              ? generate(context, source, source + sizeof prefix - 1, &loaded)
                              : cellist_mesh_read(context, source, desc, &loaded);
  if (result == CELLIST_SUCCESS && desc != NULL && desc->strict) {
    const cellist_validate_desc validate = {.strict = true};
    cellist_report report;
    result = cellist_validate(context, loaded, &validate, &report);
  }
  if (result == CELLIST_SUCCESS)
    *mesh = loaded;
  else
    cellist_mesh_destroy(loaded);
  return result;
}
