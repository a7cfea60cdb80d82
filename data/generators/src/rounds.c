/* SPDX-License-Identifier: BSD-3-Clause
 * Rounds: generators with curved boundaries: torus, tapered cylinder, nested shells, two spheres. */
#include "builder.h"

#include <math.h>

/* ---- Torus ------------------------------------------------------------------------------------------- */

/* The tube's radius in parts of the ring's. */
static const double TUBE = 0.4;

struct torus {
  uint32_t across, around;
};

/* The tube's square cross-section becomes a disc (each line of the square an arc of an ellipse). */
static void place_on_torus(const void *shape, const uint32_t node[3], double position[3]) {
  const struct torus *torus = shape;
  const double u = 2.0 * node[0] / torus->across - 1, v = 2.0 * node[1] / torus->across - 1;
  const double radius = 1 + TUBE * v * sqrt(1 - 0.5 * u * u), turns = (double)node[2] / torus->around;
  position[0] = radius * cosine_of_turns(turns);
  position[1] = radius * sine_of_turns(turns);
  position[2] = TUBE * u * sqrt(1 - 0.5 * v * v);
}

void generate_torus(mesh_builder *builder) {
  /* The ring is some 2 pi / 0.8 times as long as the tube is wide. */
  struct torus torus = {.across = cube_root_below((double)builder->desc.size / (6 * 8))};
  if (torus.across < 2) torus.across = 2;
  torus.around = (uint32_t)((double)builder->desc.size / (6.0 * torus.across * torus.across) + 0.5);
  if (torus.around < 8) torus.around = 8;
  const mesh_lattice lattice = {.size = {torus.across, torus.across, torus.around},
                                .closed = {false, false, true},
                                .place = place_on_torus,
                                .shape = &torus};
  builder_lattice(builder, &lattice);
}

/* ---- Tapered cylinder ---------------------------------------------------------------------------------- */

/* The hole's radius at the bottom and at the top, in parts of the cylinder's, and its height. */
static const double HOLE_BOTTOM = 0.7, HOLE_TOP = 0.3, CYLINDER_HEIGHT = 1.5;
enum { CYLINDER_WALL = 2 };

struct cylinder {
  uint32_t around, height;
};

static void place_on_cylinder(const void *shape, const uint32_t node[3], double position[3]) {
  const struct cylinder *cylinder = shape;
  const double up = (double)node[2] / cylinder->height, turns = (double)node[1] / cylinder->around;
  const double hole = HOLE_BOTTOM + (HOLE_TOP - HOLE_BOTTOM) * up, out = (double)node[0] / CYLINDER_WALL;
  const double radius = node[0] == CYLINDER_WALL ? 1 : hole + (1 - hole) * out; /* the outside is exactly a prism */
  position[0] = radius * cosine_of_turns(turns);
  position[1] = radius * sine_of_turns(turns);
  position[2] = CYLINDER_HEIGHT * up;
}

void generate_tapered_cylinder(mesh_builder *builder) {
  /* Four cells around for three up. */
  const double size = (double)builder->desc.size / (6 * CYLINDER_WALL);
  struct cylinder cylinder = {.height = square_root_below(0.75 * size)};
  if (cylinder.height < 2) cylinder.height = 2;
  cylinder.around = (uint32_t)(size / cylinder.height + 0.5);
  if (cylinder.around < 6) cylinder.around = 6;
  const mesh_lattice lattice = {.size = {CYLINDER_WALL, cylinder.around, cylinder.height},
                                .closed = {false, true, false},
                                .place = place_on_cylinder,
                                .shape = &cylinder};
  builder_lattice(builder, &lattice);
}

/* ---- Shells -------------------------------------------------------------------------------------------- */

struct shells {
  uint32_t side, fine;
};

/* Cubes around the middle in layers, `fine` thick, every other of which is there; the innermost is solid. */
static bool is_in_shell(const void *shape, const uint32_t cell[3]) {
  const struct shells *shells = shape;
  uint32_t layer = 0;
  for (int k = 0; k < 3; k++) {
    const uint32_t half = shells->side / 2, from_middle = cell[k] < half ? half - 1 - cell[k] : cell[k] - half;
    if (from_middle > layer) layer = from_middle;
  }
  return layer / shells->fine % 2 == 0;
}

/* Half way from a cube to a ball, so that no edge of the shells is a right angle and none is flat. */
static void place_in_shells(const void *shape, const uint32_t node[3], double position[3]) {
  const struct shells *shells = shape;
  double most = 0, square = 0;
  for (int k = 0; k < 3; k++) {
    position[k] = 2.0 * node[k] / shells->side - 1;
    most = fabs(position[k]) > most ? fabs(position[k]) : most;
    square += position[k] * position[k];
  }
  if (square == 0) return;
  const double scale = 0.5 + 0.5 * most / sqrt(square);
  for (int k = 0; k < 3; k++) position[k] *= scale;
}

void generate_shells(mesh_builder *builder) {
  const uint32_t count = builder->desc.parts;
  double cubes = 0; /* of all shells together when fine is 1 */
  for (uint32_t i = 0; i < count; i++) {
    const double outer = 2 * (2.0 * i + 1), inner = i == 0 ? 0 : 2 * 2.0 * i;
    cubes += outer * outer * outer - inner * inner * inner;
  }
  struct shells shells = {.fine = cube_root_near((double)builder->desc.size / (6 * cubes))};
  shells.side = 2 * (2 * count - 1) * shells.fine;
  const mesh_lattice lattice = {
      .size = {shells.side, shells.side, shells.side}, .has = is_in_shell, .place = place_in_shells, .shape = &shells};
  builder_lattice(builder, &lattice);
}

/* ---- Two spheres --------------------------------------------------------------------------------------- */

/* The icosahedron's corners, all permutations of (0, +-1, +-golden ratio), and its faces, outwards. */
static const double GOLDEN = 1.618033988749895;
static const int8_t CORNER[12][3] = {{-1, 2, 0},  {1, 2, 0},  {-1, -2, 0}, {1, -2, 0}, {0, -1, 2},  {0, 1, 2},
                                     {0, -1, -2}, {0, 1, -2}, {2, 0, -1},  {2, 0, 1},  {-2, 0, -1}, {-2, 0, 1}};
static const uint8_t FACE[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};

struct sphere {
  double centre_x;
  uint32_t fine;    /* parts of an edge */
  uint32_t *points; /* ids + 1 by corner, edge (from its lower corner) and face, 0 where none is yet */
};

/* Where the point with these weights (summing to fine) stands in points. */
static size_t slot_of(const struct sphere *sphere, uint32_t face, const uint32_t weight[3]) {
  const uint32_t fine = sphere->fine;
  const uint8_t *corner = FACE[face];
  for (int i = 0; i < 3; i++) {
    if (weight[i] == fine) return corner[i];
    if (weight[i] != 0) continue;
    const uint32_t a = corner[(i + 1) % 3], b = corner[(i + 2) % 3];
    const uint32_t from_low = a < b ? weight[(i + 2) % 3] : weight[(i + 1) % 3];
    if (weight[(i + 1) % 3] == fine) return a;
    if (weight[(i + 2) % 3] == fine) return b;
    return 12 + (size_t)((a < b ? a : b) * 12 + (a < b ? b : a)) * fine + from_low;
  }
  return 12 + (size_t)144 * fine + ((size_t)face * fine + weight[0]) * fine + weight[1];
}

static uint32_t sphere_point(mesh_builder *builder, struct sphere *sphere, uint32_t face, uint32_t i, uint32_t j) {
  const uint32_t weight[3] = {i, j, sphere->fine - i - j};
  uint32_t *slot = &sphere->points[slot_of(sphere, face, weight)];
  if (*slot != 0) return *slot - 1;
  double p[3] = {0}, square = 0;
  for (int k = 0; k < 3; k++) {
    for (int c = 0; c < 3; c++) {
      const int8_t x = CORNER[FACE[face][c]][k];
      p[k] += weight[c] * (x == 2 ? GOLDEN : x == -2 ? -GOLDEN : x);
    }
    square += p[k] * p[k];
  }
  const double length = sqrt(square);
  const uint32_t id = builder_point(builder, sphere->centre_x + p[0] / length, p[1] / length, p[2] / length);
  *slot = id + 1;
  return id;
}

/* One tet for each triangle of the sphere, to its centre. */
static void add_sphere(mesh_builder *builder, double centre_x, uint32_t fine) {
  struct sphere sphere = {centre_x, fine, builder_ids(builder, 12 + (size_t)144 * fine + (size_t)20 * fine * fine)};
  if (sphere.points == NULL) return;
  const uint32_t centre = builder_point(builder, centre_x, 0, 0);
  for (uint32_t face = 0; face < 20; face++)
    for (uint32_t i = 0; i < fine; i++)
      for (uint32_t j = 0; i + j < fine; j++) {
        const uint32_t a = sphere_point(builder, &sphere, face, i, j);
        const uint32_t b = sphere_point(builder, &sphere, face, i + 1, j);
        const uint32_t c = sphere_point(builder, &sphere, face, i, j + 1);
        builder_tet(builder, centre, a, b, c);
        if (i + j + 2 > fine) continue;
        builder_tet(builder, centre, c, b, sphere_point(builder, &sphere, face, i + 1, j + 1));
      }
  cellist_deallocate(builder->context, sphere.points);
}

void generate_two_spheres(mesh_builder *builder) {
  const uint32_t fine = square_root_below((double)builder->desc.size / 40 + 0.5);
  add_sphere(builder, -1.5, fine);
  add_sphere(builder, 1.5, fine);
}
