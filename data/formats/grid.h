/* SPDX-License-Identifier: BSD-3-Clause
 * Grid: what a reader makes of a file, before it is a mesh. Private to data/.
 *
 * Cells of any kind keep the file's order and ids; grid_to_mesh.c alone knows how these become tets. */
#ifndef CELLIST_FORMATS_GRID_H
#define CELLIST_FORMATS_GRID_H

#include <src/mesh_private.h>

/* Cell kinds, named as VTK numbers them. */
enum grid_cell_type {
  GRID_TRIANGLE = 5,
  GRID_TETRA = 10,
  GRID_VOXEL = 11,
  GRID_HEXAHEDRON = 12,
  GRID_WEDGE = 13,
  GRID_PYRAMID = 14,
  GRID_POLYHEDRON = 42
};

/* All arrays are from the context's allocator and owned by the grid. */
struct grid {
  const char *file; /* for messages; lives longer than the grid */
  size_t point_count;
  double *points; /* [3 point_count] */
  size_t cell_count;
  uint8_t *types;         /* [cell_count] VTK's numbers */
  size_t *offsets;        /* [cell_count + 1] cell i's points are connectivity[offsets[i] .. offsets[i + 1] - 1] */
  uint32_t *connectivity; /* [offsets[cell_count]] point ids, not yet checked against point_count */
  uint32_t *faces;        /* polyhedra: per cell the number of faces, then per face its size and its points; or NULL */
  size_t face_count;      /* numbers in faces */
  size_t *face_starts;    /* [cell_count] where a polyhedron's numbers begin in faces; or NULL */
  uint32_t *cell_origin;  /* [cell_count] ids in the file, or NULL: the cell's own index; may repeat (polyhedra) */
  size_t skipped_cell_count; /* cells of lower dimension that the reader has not kept */
  uint8_t *hidden_points;    /* [point_count] or NULL; not 0: cells that use the point are left out */
  uint8_t *hidden_cells;     /* [cell_count] or NULL; not 0: ghost or blanked, left out */
  size_t field_count;
  cellist_field *fields; /* values per point, or per cell */
};

/* Frees what the grid owns and zeroes it. */
void grid_release(cellist_context *context, struct grid *grid);

/* Adds a field; the name is copied, values (component_count per point or cell) are the grid's from now on, failing or
 * not. A second field of the same name and association is dropped. */
cellist_result grid_add_field(cellist_context *context, struct grid *grid, const char *name,
                              cellist_association association, size_t component_count, double *values);

/* offsets, types and connectivity of cell_count cells that all have the same type and corner_count. connectivity may
 * be taken over (not NULL) or is allocated. */
cellist_result grid_make_uniform(cellist_context *context, struct grid *grid, size_t cell_count, uint8_t type,
                                 size_t corner_count, uint32_t *connectivity);

/* Makes the hexahedra of blocks of nx x ny x nz points (x fastest, blocks one after the other in points, which must be
 * there). A block may be left-handed as a whole: that is how it was numbered, and no flaw. */
struct grid_block {
  size_t size[3];
};
cellist_result grid_make_structured(cellist_context *context, struct grid *grid, size_t block_count,
                                    const struct grid_block *blocks);

/* Joins pieces one after the other into grid (zeroed); the pieces are emptied, failing or not. Fields that a piece
 * lacks (or has with other components) are left out, with a warning. */
cellist_result grid_concatenate(cellist_context *context, size_t piece_count, struct grid *pieces, struct grid *grid);

/* Hides cells (points) by a vtkGhostType array: bits of duplicates and blanked ones. */
cellist_result grid_hide_by_ghost_type(cellist_context *context, struct grid *grid, cellist_association association,
                                       const double *ghost_types, bool are_levels);

/* merge.c: joins points with equal coordinates, or within distance > 0 of the first of them; removes the joined ones
 * from points and fields. *point_origin: the grid's old ids. */
cellist_result grid_merge_points(cellist_context *context, struct grid *grid, double distance, uint32_t **point_origin,
                                 size_t *merged_count);

/* merge.c: points whose coordinates equal those of an earlier point. */
cellist_result grid_count_coincident_points(cellist_context *context, const struct grid *grid, size_t *count);

/* split.c: the corner count of a three-dimensional cell type, 0 for a lower dimension or an empty cell, -1 for what
 * Cellist does not handle. is_simplified: more than corners are in the file (a quadratic cell). */
int grid_cell_corners(uint8_t type, bool *is_simplified);

/* split.c: the tets of one cell with corners ids (not a polyhedron): at most SPLIT_LIMIT, positive if the cell is
 * right-handed; tets that use a point twice are left out. */
enum { SPLIT_LIMIT = 12 };
size_t grid_split_cell(uint8_t type, const uint32_t *ids, uint32_t tets[][4]);

/* polyhedron.c: replaces polyhedra by tets; cell_origin leads back. Points are added after the grid's own.
 * Errors: UNSUPPORTED with the cell's id (not closed, not convex). */
cellist_result grid_split_polyhedra(cellist_context *context, struct grid *grid);

/* grid_to_mesh.c: makes the mesh and empties the grid, failing or not. desc may be NULL. */
cellist_result grid_to_mesh(cellist_context *context, struct grid *grid, const cellist_mesh_read_desc *desc,
                            cellist_mesh **mesh);

#endif
