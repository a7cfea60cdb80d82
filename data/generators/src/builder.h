/* SPDX-License-Identifier: BSD-3-Clause
 * Builder: what every generator uses to put a mesh together. Private to the generators.
 *
 * Errors stick: after the first one all calls do nothing, and builder_finish reports it. So a generator is straight
 * code without checks. Every number comes from IEEE additions, products, quotients and square roots, never from
 * libm, so that a mesh is the same to the last bit on every machine. */
#ifndef CELLIST_BUILDER_H
#define CELLIST_BUILDER_H

#include <base/random.h>
#include <cellist/generate.h>

typedef struct mesh_builder {
  cellist_context *context;
  cellist_generate_desc desc; /* resolved: size and parts are not 0 unless the generator has no parts */
  random_state random;
  cellist_result result;
  size_t point_count, point_capacity;
  double *positions;
  size_t tet_count, tet_capacity;
  uint32_t *tets;
  uint32_t blind_point; /* its scalar is NaN; CELLIST_NONE: none */
  bool repair;          /* leave out cells that cannot be, instead of failing */
} mesh_builder;

/* The new point's id. */
uint32_t builder_point(mesh_builder *builder, double x, double y, double z);

/* A tet; its orientation is the caller's care. */
void builder_tet(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c, uint32_t d);

/* Zeroed ids for a generator's own use, NULL after an error; to be given to cellist_deallocate. */
uint32_t *builder_ids(mesh_builder *builder, size_t count);

/* A box of cells, each cut in Kuhn's six tets around the diagonal that grows along all three axes: neighbours agree
 * on the diagonals of their shared faces, across a closed axis too. */
typedef struct mesh_lattice {
  uint32_t size[3]; /* cells along each axis */
  bool closed[3];   /* the last nodes are the first ones again: a ring; the axis then has at least 3 cells */
  /* Is the cell there? NULL: all are. */
  bool (*has)(const void *shape, const uint32_t cell[3]);
  /* Where a node (0..size along each axis) lies. NULL: at its own indices. Must keep the orientation. */
  void (*place)(const void *shape, const uint32_t node[3], double position[3]);
  const void *shape;
} mesh_lattice;

/* Adds the lattice's cells, and points for the nodes that they use, in the order of nodes. */
void builder_lattice(mesh_builder *builder, const mesh_lattice *lattice);

/* Makes the mesh of what was added, with the scalar "wave", and frees the builder's arrays. */
cellist_result builder_finish(mesh_builder *builder, cellist_mesh **mesh);

/* Sine and cosine of an angle in full turns; exact at quarter turns. */
double sine_of_turns(double turns);
double cosine_of_turns(double turns);

/* The largest n >= 1 with n^2 or n^3 <= count (1 for count 0). */
uint32_t square_root_below(double count);
uint32_t cube_root_below(double count);

/* The n >= 1 whose n^3 is nearest to count. */
uint32_t cube_root_near(double count);

/* The generators, one for each name. */
void generate_ball(mesh_builder *builder);
void generate_cyclic(mesh_builder *builder);
void generate_flaws(mesh_builder *builder);
void generate_gears(mesh_builder *builder);
void generate_grid(mesh_builder *builder);
void generate_heat_sink(mesh_builder *builder);
void generate_l_shape(mesh_builder *builder);
void generate_plates(mesh_builder *builder);
void generate_shells(mesh_builder *builder);
void generate_slivers(mesh_builder *builder);
void generate_staircase(mesh_builder *builder);
void generate_swiss_cheese(mesh_builder *builder);
void generate_tapered_cylinder(mesh_builder *builder);
void generate_torus(mesh_builder *builder);
void generate_two_spheres(mesh_builder *builder);

#endif
