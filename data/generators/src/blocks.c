/* SPDX-License-Identifier: BSD-3-Clause
 * Blocks: generators that are boxes of cubes with some left out, at exact coordinates.
 *
 * The spacing is a power of two, so every plane of theirs is exact and the exterior's best cut is known: one cell for
 * the L, one for each gap between fins. */
#include "builder.h"

/* A box of cubes with a rule for which are there, in units of `fine` cubes. */
struct block {
  uint32_t fine;
  uint32_t parts;
  uint32_t last[3]; /* the highest coordinate along each axis */
  double spacing[3];
};

static void place(const void *shape, const uint32_t node[3], double position[3]) {
  const struct block *block = shape;
  for (int k = 0; k < 3; k++) position[k] = node[k] * block->spacing[k];
}

/* A box whose rule does not ask for axis 1, along which it has as many cubes as bring the number of cells nearest to
 * the wanted one. units: the box in units; unit_cubes: cubes there when fine is 1. */
static struct block extruded_block(const mesh_builder *builder, const uint32_t units[3], double unit_cubes) {
  const double cubes = (double)builder->desc.size / 6;
  struct block block = {.fine = cube_root_below(cubes / unit_cubes), .parts = builder->desc.parts};
  double spacing = 1;
  for (int k = 0; k < 3; k++) {
    block.last[k] = units[k] * block.fine;
    while (spacing * block.last[k] > 2) spacing /= 2;
  }
  const double in_layer = unit_cubes / units[1] * block.fine * block.fine;
  block.last[1] = cubes < in_layer ? 1 : (uint32_t)(cubes / in_layer + 0.5);
  block.spacing[0] = block.spacing[2] = spacing;
  block.spacing[1] = spacing * units[1] * block.fine / block.last[1];
  return block;
}

static void block_build(mesh_builder *builder, const struct block *block,
                        bool (*has)(const void *shape, const uint32_t cell[3])) {
  const mesh_lattice lattice = {
      .size = {block->last[0], block->last[1], block->last[2]}, .has = has, .place = place, .shape = block};
  builder_lattice(builder, &lattice);
}

static bool is_in_l(const void *shape, const uint32_t cell[3]) {
  const struct block *block = shape;
  return cell[0] < block->fine || cell[2] < block->fine;
}

void generate_l_shape(mesh_builder *builder) {
  const uint32_t units[3] = {2, 1, 2};
  const struct block block = extruded_block(builder, units, 3);
  block_build(builder, &block, is_in_l);
}

static bool is_in_stairs(const void *shape, const uint32_t cell[3]) {
  const struct block *block = shape;
  return cell[2] / block->fine <= cell[0] / block->fine;
}

void generate_staircase(mesh_builder *builder) {
  const uint32_t steps = builder->desc.parts;
  const uint32_t units[3] = {steps, 3, steps};
  const struct block block = extruded_block(builder, units, 1.5 * steps * (steps + 1.0));
  block_build(builder, &block, is_in_stairs);
}

enum { SINK_DEPTH = 6, SINK_BASE = 2, SINK_FIN = 6 };

static bool is_in_sink(const void *shape, const uint32_t cell[3]) {
  const struct block *block = shape;
  return cell[2] < SINK_BASE * block->fine || cell[0] / block->fine % 2 == 0;
}

void generate_heat_sink(mesh_builder *builder) {
  const uint32_t fins = builder->desc.parts, width = 2 * fins - 1;
  const uint32_t units[3] = {width, SINK_DEPTH, SINK_BASE + SINK_FIN};
  const struct block block = extruded_block(builder, units, (double)SINK_DEPTH * (SINK_BASE * width + SINK_FIN * fins));
  block_build(builder, &block, is_in_sink);
}

static bool is_in_plates(const void *shape, const uint32_t cell[3]) {
  (void)shape;
  return cell[2] % 2 == 0;
}

void generate_plates(mesh_builder *builder) {
  const uint32_t plates = builder->desc.parts;
  struct block block = {.fine = square_root_below((double)builder->desc.size / (6.0 * plates)), .parts = plates};
  block.last[0] = block.last[1] = block.fine;
  block.last[2] = 2 * plates - 1;
  double spacing = 1;
  while (spacing * block.fine > 1) spacing /= 2;
  block.spacing[0] = block.spacing[1] = spacing;
  /* A cube, unless plates would become thinner than 1/64 of their cells' width: no needles. */
  for (block.spacing[2] = spacing; block.spacing[2] * block.last[2] > 1 && block.spacing[2] > spacing / 64;)
    block.spacing[2] /= 2;
  block_build(builder, &block, is_in_plates);
}

/* The diameter of a cavity in fifths of the way from one to the next, the least way in cubes (of fewer, no cavity is
 * round), and the share of the block that is there. */
enum { CHEESE_HOLE = 3, CHEESE_LEAST = 5 };
static const double CHEESE_SHARE = 0.88;

static bool is_in_cheese(const void *shape, const uint32_t cell[3]) {
  const struct block *block = shape;
  const int64_t pitch = block->fine;
  int64_t square = 0; /* of the distance to the middle of the nearest cavity, in half cubes */
  for (int k = 0; k < 3; k++) {
    const int64_t from_middle = 2 * (cell[k] % pitch) + 1 - pitch;
    square += from_middle * from_middle;
  }
  return 25 * square > CHEESE_HOLE * CHEESE_HOLE * pitch * pitch;
}

void generate_swiss_cheese(mesh_builder *builder) {
  const uint32_t holes = builder->desc.parts;
  const double cubes = (double)builder->desc.size / 6 / holes / holes / holes / CHEESE_SHARE;
  struct block block = {.fine = cube_root_near(cubes), .parts = holes};
  if (block.fine < CHEESE_LEAST) block.fine = CHEESE_LEAST;
  for (int k = 0; k < 3; k++) {
    block.last[k] = holes * block.fine;
    for (block.spacing[k] = 1; block.spacing[k] * block.last[k] > 2;) block.spacing[k] /= 2;
  }
  block_build(builder, &block, is_in_cheese);
}

/* The lowest layer's thickness is 2^-16 of its width at most: dihedrals down to 0.001 degree. */
enum { SLIVER_LAYERS = 16 };

static void place_graded(const void *shape, const uint32_t node[3], double position[3]) {
  place(shape, node, position);
  position[2] = node[2] == 0 ? 0 : (double)(1u << (node[2] - 1)) / (1u << (SLIVER_LAYERS - 1));
}

void generate_slivers(mesh_builder *builder) {
  struct block block = {.fine = square_root_below((double)builder->desc.size / (6.0 * SLIVER_LAYERS))};
  block.spacing[0] = block.spacing[1] = 1;
  while (block.spacing[0] * block.fine > 1) block.spacing[0] = block.spacing[1] = block.spacing[0] / 2;
  const mesh_lattice lattice = {
      .size = {block.fine, block.fine, SLIVER_LAYERS}, .place = place_graded, .shape = &block};
  builder_lattice(builder, &lattice);
}
