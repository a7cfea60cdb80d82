/* SPDX-License-Identifier: BSD-3-Clause
 * Generate: the table of generators, and the call that runs one. */
#include "builder.h"

#include <stdio.h>
#include <string.h>

/* Four times this many face ids fit 32 bits with room; lattices may overshoot the wanted size somewhat. */
enum { SIZE_LIMIT = 1 << 28 };

struct generator {
  const char *name, *purpose;
  void (*generate)(mesh_builder *builder);
  size_t size;                             /* the default */
  uint32_t parts, least_parts, most_parts; /* all 0: the generator has no such number */
};

static const struct generator GENERATORS[] = {
    {"gears", "two interleaving rings with slanted teeth (parts): cyclic orders, many reflex edges", generate_gears,
     8640, 12, 5, 64},
    {"grid", "a box of cubes (Kuhn), points moved on request: a convex mesh, ties in axis-aligned views", generate_grid,
     6000, 0, 0, 0},
    {"ball", "Delaunay triangulation of random points: a convex mesh without order, for benchmarks", generate_ball,
     10000, 0, 0, 0},
};
enum { GENERATOR_COUNT = sizeof GENERATORS / sizeof GENERATORS[0] };

const char *cellist_generator_name(size_t i) { return i < GENERATOR_COUNT ? GENERATORS[i].name : NULL; }
const char *cellist_generator_purpose(size_t i) { return i < GENERATOR_COUNT ? GENERATORS[i].purpose : NULL; }

static cellist_result fail_not_found(cellist_context *context, const char *name) {
  char list[512] = "";
  size_t length = 0;
  for (size_t i = 0; i < GENERATOR_COUNT && length < sizeof list - 1; i++)
    length += (size_t)snprintf(list + length, sizeof list - length, "%s%s", i > 0 ? ", " : "", GENERATORS[i].name);
  return cellist_fail(context, CELLIST_ERROR_NOT_FOUND, "no generator '%s'; there are: %s", name, list);
}

/* Fills in the defaults and checks the ranges. */
static cellist_result resolve(cellist_context *context, const struct generator *generator,
                              cellist_generate_desc *desc) {
  if (desc->size == 0) desc->size = generator->size;
  if (desc->parts == 0) desc->parts = generator->parts;
  if (desc->size > SIZE_LIMIT)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "%s: %zu cells are more than %d", generator->name,
                        desc->size, SIZE_LIMIT);
  if (!(desc->perturb >= 0 && desc->perturb <= 0.5))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "%s: perturb is %g, not in 0..0.5", generator->name,
                        desc->perturb);
  if (desc->parts < generator->least_parts || desc->parts > generator->most_parts)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "%s: parts is %u, not in %u..%u", generator->name,
                        desc->parts, generator->least_parts, generator->most_parts);
  return CELLIST_SUCCESS;
}

cellist_result cellist_generate(cellist_context *context, const char *name, const cellist_generate_desc *desc,
                                cellist_mesh **mesh) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (name == NULL || mesh == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_generate: name or mesh is NULL");
  const struct generator *generator = NULL;
  for (size_t i = 0; i < GENERATOR_COUNT; i++)
    if (strcmp(GENERATORS[i].name, name) == 0) generator = &GENERATORS[i];
  if (generator == NULL) return fail_not_found(context, name);
  mesh_builder builder = {.context = context};
  if (desc != NULL) builder.desc = *desc;
  cellist_result result = resolve(context, generator, &builder.desc);
  if (result == CELLIST_SUCCESS) result = cellist_progress(context, "generating", 0);
  if (result != CELLIST_SUCCESS) return result;
  builder.random.state = builder.desc.seed;
  generator->generate(&builder);
  return builder_finish(&builder, mesh);
}
