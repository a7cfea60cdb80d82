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
     8640, 12, 5, 32},
    {"grid", "a box of cubes (Kuhn), points moved on request: a convex mesh, ties in axis-aligned views", generate_grid,
     6000, 0, 0, 0},
    {"ball", "Delaunay triangulation of random points: a convex mesh without order, for benchmarks", generate_ball,
     10000, 0, 0, 0},
    {"tapered-cylinder", "a cylinder with a conical hole: reflex edges that are flat but for rounding",
     generate_tapered_cylinder, 9216, 0, 0, 0},
    {"heat-sink", "a plate with fins (parts): exact planes, one imaginary cell for each gap", generate_heat_sink, 2808,
     8, 2, 200},
    {"torus", "a ring: a hole through a smooth, saddle-shaped boundary", generate_torus, 9216, 0, 0, 0},
    {"two-spheres", "two balls, half of the cells' count of triangles on each: the convexifier's hardest growth",
     generate_two_spheres, 2560, 0, 0, 0},
    {"swiss-cheese", "a block with cavities (parts along each axis): boundaries that no ray from outside meets first",
     generate_swiss_cheese, 17172, 3, 1, 40},
    {"shells", "closed shells (parts), each inside the next: parts and cavities that alternate along a ray",
     generate_shells, 3888, 3, 1, 20},
    {"l-shape", "an L: the simplest concave mesh, one imaginary cell", generate_l_shape, 1152, 0, 0, 0},
    {"staircase", "steps (parts): many reflex edges in parallel planes", generate_staircase, 3024, 6, 2, 200},
    {"plates", "plates (parts) over each other, apart: deep stacks of parts with nothing but gaps between",
     generate_plates, 9600, 100, 2, 10000},
    {"slivers", "layers that grow from 2^-15 to a half in height: needles, for precision (warnings only)",
     generate_slivers, 6144, 0, 0, 0},
    {"cyclic", "wheels of tets (parts) that overlap each other in a circle: orders that do not exist", generate_cyclic,
     3, 3, 3, 1000},
    {"flaws", "each flaw that validation names, a few cells for each (size is ignored)", generate_flaws, 24, 0, 0, 0},
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
  mesh_builder builder = {.context = context, .blind_point = CELLIST_NONE};
  if (desc != NULL) builder.desc = *desc;
  cellist_result result = resolve(context, generator, &builder.desc);
  if (result == CELLIST_SUCCESS) result = cellist_progress(context, "generating", 0);
  if (result != CELLIST_SUCCESS) return result;
  builder.random.state = builder.desc.seed;
  generator->generate(&builder);
  return builder_finish(&builder, mesh);
}
