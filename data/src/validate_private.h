/* SPDX-License-Identifier: BSD-3-Clause
 * What the parts of validation share. Private to data/. */
#ifndef CELLIST_VALIDATE_PRIVATE_H
#define CELLIST_VALIDATE_PRIVATE_H

#include <cellist/validate.h>

/* One validation under way. marks[tet] has bit 1 << kind for each finding about cells. */
typedef struct validation {
  cellist_context *context;
  const cellist_mesh_arrays *mesh;
  const cellist_mesh_facts *facts;
  cellist_report *report;
  uint16_t *marks;
  uint32_t *place;   /* [point_count] the point of lowest origin with the same coordinates */
  size_t face_count; /* boundary faces */
  uint32_t *faces;   /* [face_count] 4 * tet + the corner opposite to the face, ascending: in Hilbert order */
} validation;

static inline void mark(validation *run, size_t tet, cellist_finding_kind kind) {
  run->marks[tet] |= (uint16_t)(1u << kind);
}

/* Corner c (0..2) of a face, as a point id; outward faces are counter-clockwise. */
static inline uint32_t face_corner(const cellist_mesh_arrays *mesh, uint32_t face, int c) {
  return mesh->tets[(face & ~3u) + CELLIST_TET_FACE[face & 3][c]];
}

static inline const double *point_of(const cellist_mesh_arrays *mesh, uint32_t point) {
  return &mesh->positions[3 * (size_t)point];
}

/* Sets of ids that grow together (Tarjan); the root of a set is its lowest id. */
static inline uint32_t set_root(uint32_t *parent, uint32_t id) {
  while (parent[id] != id) id = parent[id] = parent[parent[id]];
  return id;
}

static inline void set_join(uint32_t *parent, uint32_t a, uint32_t b) {
  a = set_root(parent, a);
  b = set_root(parent, b);
  if (a < b)
    parent[b] = a;
  else
    parent[a] = b;
}

/* A new array with each id a set of its own, or NULL. */
uint32_t *set_create(cellist_context *context, size_t count);

/* Adds an id to the lowest ones of a finding, whose count is the caller's; ids must not repeat. */
void finding_keep(cellist_finding *finding, uint32_t id);

/* validate_cells.c: marks inverted, flat, needle and NaN cells; counts parts. */
cellist_result validate_cells(validation *run);
/* validate_points.c: unused and coincident points; fills place. */
cellist_result validate_points(validation *run);
/* validate_boundary.c: fills faces; folded, overfull and duplicate cells; edges, vertices, cavities, convexity. */
cellist_result validate_boundary(validation *run);
/* validate_contacts.c: boundary faces that meet others. */
cellist_result validate_contacts(validation *run);

#endif
