/* SPDX-License-Identifier: BSD-3-Clause
 * Cyclic: wheels of tets of which each lies over the next, seen along the wheel's axis. No order of theirs is right. */
#include "builder.h"

/* A tet is a stick along a chord of the unit circle, REACH wheel parts long, that rises by SLOPE of its length; its two
 * end edges, across and upright, are 2 WIDTH of its length long. Thicker or flatter sticks touch in wheels of three. */
static const double REACH = 1.25, SLOPE = 0.4, WIDTH = 0.06;
/* Between the middles of neighbouring wheels. */
static const double PITCH = 2.25;

static void add_stick(mesh_builder *builder, uint32_t parts, uint32_t i, const double middle[3], uint32_t axis) {
  const double from = (double)i / parts, to = from + REACH / parts;
  const double begin[2] = {cosine_of_turns(from), sine_of_turns(from)};
  const double end[2] = {cosine_of_turns(to), sine_of_turns(to)};
  const double length = 2 * sine_of_turns(0.5 * REACH / parts), up = 0.5 * SLOPE * length;
  const double across[2] = {WIDTH * (begin[1] - end[1]), WIDTH * (end[0] - begin[0])};
  const double corner[4][3] = {{begin[0] - across[0], begin[1] - across[1], -up},
                               {begin[0] + across[0], begin[1] + across[1], -up},
                               {end[0], end[1], up - WIDTH * length},
                               {end[0], end[1], up + WIDTH * length}};
  uint32_t v[4];
  for (int c = 0; c < 4; c++) {
    double p[3];
    for (uint32_t k = 0; k < 3; k++) p[(k + axis) % 3] = corner[c][k];
    v[c] = builder_point(builder, middle[0] + p[0], middle[1] + p[1], middle[2] + p[2]);
  }
  builder_tet(builder, v[0], v[1], v[3], v[2]);
}

void generate_cyclic(mesh_builder *builder) {
  const uint32_t parts = builder->desc.parts;
  const size_t wheels = builder->desc.size < parts ? 1 : builder->desc.size / parts;
  uint32_t side = cube_root_below((double)wheels);
  if ((double)side * side * side < (double)wheels) side++;
  for (size_t wheel = 0; wheel < wheels; wheel++) {
    const double middle[3] = {PITCH * (double)(wheel % side), PITCH * (double)(wheel / side % side),
                              PITCH * (double)(wheel / side / side)};
    for (uint32_t i = 0; i < parts; i++) add_stick(builder, parts, i, middle, (uint32_t)(wheel % 3));
  }
}
