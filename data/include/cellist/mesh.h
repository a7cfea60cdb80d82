/* SPDX-License-Identifier: BSD-3-Clause
 * Mesh: an immutable tetrahedral mesh, ready to be sorted and drawn.
 *
 * However it was made (from arrays, a file, a generator), a mesh has these properties:
 * - no tet has a negative volume: inverted ones were re-oriented (CELLIST_TET_INVERTED), flat ones are kept
 *   (CELLIST_TET_FLAT); both decided exactly;
 * - tets and points stand in Hilbert order; origins lead back to the ids of the user's file or arrays;
 * - adjacency is complete: two tets are neighbours if they share a face and lie on its two sides. */
#ifndef CELLIST_MESH_H
#define CELLIST_MESH_H

#include <cellist/context.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cellist_mesh cellist_mesh;

typedef enum cellist_association { CELLIST_ON_POINTS, CELLIST_ON_CELLS } cellist_association;

/* A named array of the user's. */
typedef struct cellist_field {
  const char *name;
  cellist_association association;
  uint32_t component_count; /* at least 1 */
  const double *values;     /* component_count values per point, or per tet */
} cellist_field;

/* Bits of tet_flags. */
enum {
  CELLIST_TET_INVERTED = 1, /* was given with negative volume; two of its vertices were exchanged */
  CELLIST_TET_FLAT = 2      /* volume exactly 0: takes part in the order, is never drawn */
};

/* The corners of the face opposite to corner k, counter-clockwise seen from outside the tet. */
static const uint8_t CELLIST_TET_FACE[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/* Everything a mesh holds. All pointers belong to the mesh. */
typedef struct cellist_mesh_arrays {
  size_t point_count;
  const double *positions;      /* [3 point_count] x y z, in the file's frame and units */
  const uint32_t *point_origin; /* [point_count] the user's point id, from 0 */
  size_t tet_count;
  const uint32_t *tets;       /* [4 tet_count] point ids, det[v1-v0, v2-v0, v3-v0] >= 0 */
  const uint32_t *neighbours; /* [4 tet_count] the tet across the face opposite to corner k, or CELLIST_NONE */
  const uint32_t *tet_origin; /* [tet_count] the user's cell id, from 0; several tets may share one (hexahedra) */
  const uint8_t *tet_flags;   /* [tet_count] CELLIST_TET_... */
  size_t field_count;
  const cellist_field *fields; /* [field_count] values in the mesh's order of points and tets */
  double bounds[6];            /* x y z of the lower corner, then of the upper one; of points that tets use */
} cellist_mesh_arrays;

enum { CELLIST_FACT_IDS = 10 };

/* What making the mesh found. Counts are of tets unless the name says otherwise. */
typedef struct cellist_mesh_facts {
  size_t file_cell_count;        /* cells in the user's file or arrays, of any dimension */
  size_t skipped_cell_count;     /* cells of lower dimension: left out */
  size_t hidden_cell_count;      /* ghost and blanked cells: left out */
  size_t infinite_cell_count;    /* cells with a NaN or infinite corner: left out */
  size_t collapsed_cell_count;   /* cells whose every tet would use a point twice: left out */
  size_t merged_point_count;     /* points that were joined with an earlier one */
  size_t coincident_point_count; /* points left whose coordinates equal an earlier one's (read from files only) */
  size_t inverted_count;         /* re-oriented */
  size_t inverted_cell_count;    /* cells of the file with a re-oriented tet: tet_origin of those flagged INVERTED */
  size_t flat_count;             /* of zero volume */
  size_t boundary_face_count;    /* faces with a tet on one side only */
  size_t folded_face_count;      /* faces with two tets on the same side: both count as boundary */
  size_t overfull_face_count;    /* faces of more than two tets: all count as boundary */
  size_t unused_point_count;     /* points that no tet uses */
  uint32_t infinite_cells[CELLIST_FACT_IDS];  /* the first of infinite_cell_count, the user's ids */
  uint32_t collapsed_cells[CELLIST_FACT_IDS]; /* the first of collapsed_cell_count */
} cellist_mesh_facts;

/* The user's own arrays. All are read during the call only. */
typedef struct cellist_mesh_desc {
  size_t point_count;
  const double *positions; /* [3 point_count], finite where a tet uses them */
  size_t tet_count;
  const uint32_t *tets;       /* [4 tet_count], each below point_count; either orientation */
  const uint32_t *tet_origin; /* [tet_count] or NULL: the tet's own index */
  size_t field_count;
  const cellist_field *fields; /* [field_count], values in the order of the arrays above */
} cellist_mesh_desc;

/* Makes a mesh from arrays.
 * Arrays: see cellist_mesh_desc; nothing is kept. *mesh is the caller's, for cellist_mesh_destroy.
 * Errors: INVALID_ARGUMENT (NULL arrays, a tet's point id out of range or used twice in one tet, 2^31 tets or
 *   more), GEOMETRY (an infinite or NaN coordinate that a tet uses), OUT_OF_MEMORY, CANCELLED.
 * Threads: one call per context at a time. The mesh may be read by any number of threads.
 * Cost: linear; some 150 bytes a tet at the peak. */
CELLIST_API cellist_result cellist_mesh_create(cellist_context *context, const cellist_mesh_desc *desc,
                                               cellist_mesh **mesh);

/* As cellist_mesh_create, but leaves out the tets that no mesh can hold: with an infinite or NaN corner, or a point
 * twice. facts count their cells and name the first ones; tet_origin tells those that stay. */
CELLIST_API cellist_result cellist_mesh_create_repaired(cellist_context *context, const cellist_mesh_desc *desc,
                                                        cellist_mesh **mesh);

/* Makes a mesh of some tets of a mesh, in the same order and with the same origins, without fields. Neighbours outside
 * the part become CELLIST_NONE; of the facts only the counts of tets and boundary faces are filled in.
 * Arrays: keep[tet_count] is not 0 for the tets of the part. *part is the caller's, for cellist_mesh_destroy. *points
 *   and *tets, either may be NULL, get each of the part's points' and tets' id in mesh; the caller's, for
 *   cellist_deallocate.
 * Errors: INVALID_ARGUMENT (NULL), OUT_OF_MEMORY.
 * Threads: one call per context at a time. Cost: linear in mesh; some 10 ns a tet. */
CELLIST_API cellist_result cellist_mesh_extract(cellist_context *context, const cellist_mesh *mesh, const uint8_t *keep,
                                                cellist_mesh **part, uint32_t **points, uint32_t **tets);

/* Frees the mesh; NULL is legal. The context that made it must still exist. */
CELLIST_API void cellist_mesh_destroy(cellist_mesh *mesh);

/* The mesh's arrays and facts; they live as long as the mesh. Threads: any. */
CELLIST_API const cellist_mesh_arrays *cellist_mesh_get_arrays(const cellist_mesh *mesh);
CELLIST_API const cellist_mesh_facts *cellist_mesh_get_facts(const cellist_mesh *mesh);

/* How cellist_mesh_read treats a file; {0} is the default. */
typedef struct cellist_mesh_read_desc {
  bool strict;           /* refuse what would otherwise be repaired or skipped with a warning */
  bool merge;            /* join points that coincide: exactly, or within merge_distance */
  double merge_distance; /* in the file's units, 0: equal coordinates only */
  const char *solution;  /* PLOT3D: the file of the variables; NULL: the one beside (NAMEq.bin of NAMExyz.bin, or .q) */
} cellist_mesh_read_desc;

/* Reads a mesh file; the format is told from the content, the name only breaks ties.
 * Arrays: path is a file, or "-" for standard input. desc may be NULL. *mesh is the caller's.
 * Errors: IO (cannot be opened or read), FORMAT (not a mesh file, cut, contradictory: with file, place and reason),
 *   UNSUPPORTED (a cell type or feature, with the cell's id), GEOMETRY, OUT_OF_MEMORY, CANCELLED.
 * Threads: one call per context at a time.
 * Cost: linear in the file's content; at most 200 bytes a tet at the peak, plus the file's fields. */
CELLIST_API cellist_result cellist_mesh_read(cellist_context *context, const char *path,
                                             const cellist_mesh_read_desc *desc, cellist_mesh **mesh);

/* Reads a mesh file that stands in memory. Formats of several files (PVTU, a PLOT3D solution, TetGen) need a path.
 * Arrays: bytes: size of them, read during the call only. name is for messages, and its ending breaks ties.
 * Errors, threads and cost as cellist_mesh_read. */
CELLIST_API cellist_result cellist_mesh_read_memory(cellist_context *context, const char *name, const void *bytes,
                                                    size_t size, const cellist_mesh_read_desc *desc,
                                                    cellist_mesh **mesh);

/* One scalar per point or per tet, chosen from the mesh's fields. */
typedef struct cellist_scalar {
  char *name;                      /* as chosen, e.g. "momentum:mag" */
  cellist_association association; /* on cells: constant in each tet */
  size_t count;                    /* points or tets */
  double *values;                  /* [count] in the mesh's order; may hold NaN */
  double minimum, maximum;         /* over the finite values that tets use; both 0 if there are none */
  size_t nan_cell_count;           /* tets with a NaN or infinite value: not to be drawn */
} cellist_scalar;

/* Chooses a scalar: "NAME" (the magnitude, if it is a vector), "NAME:mag", "NAME:INDEX" (a component, from 0);
 * NULL: the first array on points, else the first on cells, else (no arrays at all) the constant 0 named "none".
 * A name that is both on points and on cells means the one on points.
 * Arrays: scalar is filled, its arrays are the caller's, to be given to cellist_scalar_release.
 * Errors: NOT_FOUND (no such field or component; the message lists what there is), OUT_OF_MEMORY.
 * Threads: one call per context at a time. Cost: linear in the mesh. */
CELLIST_API cellist_result cellist_scalar_select(cellist_context *context, const cellist_mesh *mesh,
                                                 const char *selector, cellist_scalar *scalar);

/* Frees what select filled in and zeroes it; a zeroed scalar is legal. */
CELLIST_API void cellist_scalar_release(cellist_context *context, cellist_scalar *scalar);

#ifdef __cplusplus
}
#endif
#endif
