/* SPDX-License-Identifier: BSD-3-Clause
 * How data/'s own files make meshes. Private to data/. */
#ifndef CELLIST_MESH_PRIVATE_H
#define CELLIST_MESH_PRIVATE_H

#include <cellist/mesh.h>

struct cellist_mesh {
  cellist_context *context;
  cellist_mesh_arrays arrays;
  cellist_mesh_facts facts;
};

/* The parts of a mesh before it is one. Every array is from the context's allocator and owned by the parts until
 * mesh_assemble takes it; field names and values too. Values of fields on cells stand per tet already. */
typedef struct mesh_parts {
  size_t point_count;
  double *positions;
  size_t tet_count;
  uint32_t *tets;
  uint32_t *tet_origin;   /* NULL: the tet's own index; tets of one cell stand together */
  uint32_t *point_origin; /* NULL: the point's own index */
  size_t field_count;
  cellist_field *fields;
  bool repair;              /* leave out tets that no mesh can hold */
  cellist_mesh_facts facts; /* what came before: file_cell_count, cells left out, merged points */
} mesh_parts;

/* Frees what the parts own and zeroes them. */
void mesh_parts_release(cellist_context *context, mesh_parts *parts);

/* Counts a cell that is left out, and keeps its id if it is one of the first. */
static inline void mesh_note_cell(uint32_t ids[CELLIST_FACT_IDS], size_t *count, uint32_t cell) {
  if (*count < CELLIST_FACT_IDS) ids[*count] = cell;
  ++*count;
}

/* leave_out.c: drops tets that use a point twice or an infinite one, and notes their cells. */
cellist_result mesh_leave_out(cellist_context *context, mesh_parts *parts);

/* Makes a mesh of the parts (checks, orientation, Hilbert order, adjacency), which it empties, failing or not. */
cellist_result mesh_assemble(cellist_context *context, mesh_parts *parts, cellist_mesh **mesh);

/* reorder.c: permutes points and tets (and all that stands per point or tet) into Hilbert order. Fills
 * point_origin and a non-NULL tet_origin. */
cellist_result mesh_reorder(cellist_context *context, mesh_parts *parts, uint8_t *tet_flags, const double bounds[6],
                            uint32_t **point_origin);

/* adjacency.c: neighbours[4 tet_count] and the facts about faces; may exchange two corners of flat tets, whose
 * orientation only their neighbours tell. */
cellist_result mesh_link_neighbours(cellist_context *context, size_t point_count, size_t tet_count, uint32_t *tets,
                                    const uint8_t *tet_flags, uint32_t *neighbours, cellist_mesh_facts *facts);

#endif
