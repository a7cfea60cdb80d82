/* SPDX-License-Identifier: BSD-3-Clause
 * Generate: meshes by name and size, the same bits on every machine. Shared by tests, benchmarks and the command. */
#ifndef CELLIST_GENERATE_H
#define CELLIST_GENERATE_H

#include <cellist/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What to generate; {0} means the generator's own defaults. */
typedef struct cellist_generate_desc {
  size_t size;    /* about this many cells (ball, grid: within 10 % from 100 cells on), at most 2^28; 0: the default */
  uint64_t seed;  /* of the generators that use random numbers (ball, a perturbed grid) */
  double perturb; /* grid: how far points move along each axis, in parts of the spacing, 0..0.5 */
  uint32_t parts; /* teeth, fins, steps, plates, ...: the number that the purpose names; 0: the default */
} cellist_generate_desc;

/* The name of generator i, or NULL from the last one on: for (i = 0; cellist_generator_name(i) != NULL; i++).
 * Threads: any. */
CELLIST_API const char *cellist_generator_name(size_t i);

/* One line on what generator i makes and which part of the program it exercises, or NULL as above. Threads: any. */
CELLIST_API const char *cellist_generator_purpose(size_t i);

/* Makes a mesh with one smooth scalar on points, "wave".
 * Arrays: name is one of the generators'. desc may be NULL. *mesh is the caller's, for cellist_mesh_destroy.
 * Errors: INVALID_ARGUMENT (NULL, size, perturb or parts out of range), NOT_FOUND (no such generator; the message
 *   lists them), OUT_OF_MEMORY, CANCELLED, INTERNAL (ball: CGAL failed).
 * Threads: one call per context at a time.
 * Cost: linear; ball a Delaunay triangulation of size / 6.5 points (a million cells: some seconds), for whose own
 *   memory CGAL uses the C++ allocator. */
CELLIST_API cellist_result cellist_generate(cellist_context *context, const char *name,
                                            const cellist_generate_desc *desc, cellist_mesh **mesh);

#ifdef __cplusplus
}
#endif
#endif
