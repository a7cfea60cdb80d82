/* SPDX-License-Identifier: BSD-3-Clause
 * Split: hexahedra, wedges, pyramids, voxels and prisms into tets whose faces agree with the neighbours'.
 *
 * Every quadrilateral is cut by the diagonal through its smallest point id, so both of its cells cut it alike
 * (Dompierre, Labbe, Vallet, Camarero, "How to subdivide pyramids, prisms and hexahedra into tetrahedra", 1999). The
 * inside is filled from the cell's smallest id to the faces that do not hold it, which is theirs for pyramids (2),
 * prisms (3) and hexahedra with a long diagonal (6); the paper fills a hexahedron without one by 5 tets, we by 6: the
 * same faces, and one rule for every convex cell (polygonal prisms too).
 * Cells with corners that coincide lose the tets that would use a point twice; their faces still agree. */
#include "grid.h"

/* Faces with their corners counter-clockwise seen from outside a right-handed cell. */
struct shape {
  uint8_t corner_count, face_count;
  uint8_t sizes[8];
  uint8_t faces[8][6];
};

static const struct shape HEXAHEDRON = {
    8, 6, {4, 4, 4, 4, 4, 4}, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
static const struct shape VOXEL = {
    8, 6, {4, 4, 4, 4, 4, 4}, {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}}};
static const struct shape WEDGE = {
    6, 5, {3, 3, 4, 4, 4}, {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
static const struct shape PYRAMID = {5, 5, {4, 3, 3, 3, 3}, {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
static const struct shape PENTAGONAL_PRISM = {
    10,
    7,
    {5, 5, 4, 4, 4, 4, 4},
    {{0, 4, 3, 2, 1}, {5, 6, 7, 8, 9}, {0, 1, 6, 5}, {1, 2, 7, 6}, {2, 3, 8, 7}, {3, 4, 9, 8}, {4, 0, 5, 9}}};
static const struct shape HEXAGONAL_PRISM = {12,
                                             8,
                                             {6, 6, 4, 4, 4, 4, 4, 4},
                                             {{0, 5, 4, 3, 2, 1},
                                              {6, 7, 8, 9, 10, 11},
                                              {0, 1, 7, 6},
                                              {1, 2, 8, 7},
                                              {2, 3, 9, 8},
                                              {3, 4, 10, 9},
                                              {4, 5, 11, 10},
                                              {5, 0, 6, 11}}};
static const struct shape TETRA = {4, 4, {3, 3, 3, 3}, {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/* VTK's cell types: quadratic, Lagrange and Bezier cells list their corners first. */
static const struct shape *shape_of(uint8_t type) {
  switch (type) {
    case 10:
    case 24:
    case 71:
    case 78: return &TETRA;
    case 11: return &VOXEL;
    case 12:
    case 25:
    case 29:
    case 33:
    case 72:
    case 79: return &HEXAHEDRON;
    case 13:
    case 26:
    case 31:
    case 32:
    case 73:
    case 80: return &WEDGE;
    case 14:
    case 27:
    case 37:
    case 74:
    case 81: return &PYRAMID;
    case 15: return &PENTAGONAL_PRISM;
    case 16: return &HEXAGONAL_PRISM;
    default: return NULL;
  }
}

int grid_cell_corners(uint8_t type, bool *is_simplified) {
  const struct shape *shape = shape_of(type);
  *is_simplified = shape != NULL && type > 16;
  if (shape != NULL) return shape->corner_count;
  const bool is_lower = type <= 9 || (type >= 21 && type <= 23) || type == 28 || type == 30 ||
                        (type >= 34 && type <= 36) || (type >= 68 && type <= 70) || (type >= 75 && type <= 77);
  return is_lower ? 0 : -1;
}

static bool uses_a_point_twice(const uint32_t v[4]) {
  return v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] || v[2] == v[3];
}

size_t grid_split_cell(uint8_t type, const uint32_t *ids, uint32_t tets[][4]) {
  const struct shape *shape = shape_of(type);
  if (shape == &TETRA) { /* keeps the file's order of corners */
    for (int k = 0; k < 4; k++) tets[0][k] = ids[k];
    return !uses_a_point_twice(ids);
  }
  uint8_t apex = 0;
  for (uint8_t i = 1; i < shape->corner_count; i++)
    if (ids[i] < ids[apex]) apex = i;
  size_t count = 0;
  for (uint8_t f = 0; f < shape->face_count; f++) {
    const uint8_t size = shape->sizes[f], *face = shape->faces[f];
    uint8_t first = 0;
    bool has_apex = false;
    for (uint8_t i = 0; i < size; i++) {
      has_apex |= face[i] == apex;
      if (ids[face[i]] < ids[face[first]]) first = i;
    }
    if (has_apex) continue;
    for (uint8_t i = 1; i + 1 < size; i++) {
      uint32_t *v = tets[count];
      v[0] = ids[face[first]];
      v[1] = ids[face[(first + i + 1) % size]];
      v[2] = ids[face[(first + i) % size]];
      v[3] = ids[apex];
      count += !uses_a_point_twice(v);
    }
  }
  return count;
}
