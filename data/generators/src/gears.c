/* SPDX-License-Identifier: BSD-3-Clause
 * Gears: two rings whose slanted teeth interleave without touching.
 *
 * Each ring is a lattice of radius, angle and height, closed around the angle; above the root radius only the cells of
 * teeth are there. Teeth are narrower at the tip, and turn with the height, one ring left and one ring right, so that
 * they mesh at every height. Slanted teeth overlap in circles in most views: this is the mesh for cyclic orders, and
 * for a convexifier that has to cut around many reflex edges. */
#include "builder.h"

enum { DEFAULT_TEETH = 12 };

/* In parts of the tip radius; between the rings remains GAP. */
static const double HOLE = 0.55, ROOT = 0.8, GAP = 0.03, HEIGHT = 0.5;
/* The share of its angle that a tooth loses on each side at the tip, the turn over the full height in teeth, and the
 * share of a pitch that is tooth at the root. More tooth or less taper makes the rings touch. */
static const double TAPER = 0.2, SLANT = 0.75, TOOTH = 0.42;

struct ring {
  uint32_t teeth, fine;         /* fine: cells along half a tooth */
  uint32_t body, depth, height; /* cells: radius of ring and of teeth, height */
  double centre, phase, turn;
};

static bool has(const void *shape, const uint32_t cell[3]) {
  const struct ring *ring = shape;
  return cell[0] < ring->body || cell[1] % (4 * ring->fine) < 2 * ring->fine;
}

static void place(const void *shape, const uint32_t node[3], double position[3]) {
  const struct ring *ring = shape;
  const uint32_t pitch = 4 * ring->fine, at = node[1] % pitch;
  /* Within a pitch of width 1: the tooth around 0, from -TOOTH/2 to TOOTH/2 at the root, then the gap. */
  const double half = 0.5 * TOOTH, fine = 2.0 * ring->fine;
  const bool in_tooth = at <= 2 * ring->fine;
  double angle = in_tooth ? -half + TOOTH * (at / fine) : half + (1 - TOOTH) * ((at - fine) / fine);
  double radius = HOLE + (ROOT - HOLE) * ((double)node[0] / ring->body);
  if (node[0] > ring->body) {
    const double up = (double)(node[0] - ring->body) / ring->depth;
    radius = ROOT + (1 - ROOT) * up;
    angle *= 1 - 2 * TAPER * up; /* only teeth have nodes up here, and angle is 0 in their middle */
  }
  const double up = (double)node[2] / ring->height;
  const double turns = (node[1] / pitch + angle + ring->turn * SLANT * up) / ring->teeth + ring->phase;
  position[0] = ring->centre + radius * cosine_of_turns(turns);
  position[1] = radius * sine_of_turns(turns);
  position[2] = HEIGHT * up;
}

void generate_gears(mesh_builder *builder) {
  const uint32_t teeth = builder->desc.parts;
  struct ring ring = {.teeth = teeth};
  /* Cells of a ring: 6 teeth (4 fine body + 2 fine depth) height; with all but fine in proportion to it. */
  const double unit = 2 * 6.0 * teeth * (4 * 2 + 2 * 1);
  for (ring.fine = 1;
       unit * 3 * (ring.fine + 1.0) * (ring.fine + 1.0) * (ring.fine + 1.0) <= (double)builder->desc.size;)
    ring.fine++;
  ring.body = 2 * ring.fine;
  ring.depth = ring.fine;
  ring.height = (uint32_t)((double)builder->desc.size / (unit * ring.fine * ring.fine) + 0.5);
  if (ring.height < 2) ring.height = 2;
  const mesh_lattice lattice = {.size = {ring.body + ring.depth, 4 * ring.fine * teeth, ring.height},
                                .closed = {false, true, false},
                                .has = has,
                                .place = place,
                                .shape = &ring};
  ring.centre = 0;
  ring.phase = 0;
  ring.turn = 1;
  builder_lattice(builder, &lattice);
  ring.centre = 1 + ROOT + GAP;
  ring.phase = 0.5 + 0.5 / teeth; /* a gap of the second ring faces a tooth of the first */
  ring.turn = -1;
  builder_lattice(builder, &lattice);
}
