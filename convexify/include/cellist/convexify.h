/* SPDX-License-Identifier: BSD-3-Clause
 * Convexify: a concave mesh, in pieces, with cavities and tunnels, becomes a convex complex. */
#ifndef CELLIST_CONVEXIFY_H
#define CELLIST_CONVEXIFY_H

#include <cellist/complex.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What is added to the mesh, and how it is made convex. */
typedef enum cellist_exterior {
  CELLIST_EXTERIOR_HULL = 0, /* up to the convex hull, cut by planes: few cells */
  CELLIST_EXTERIOR_BOX,      /* up to a box somewhat larger than the mesh, cut by planes */
  CELLIST_EXTERIOR_GRID,     /* up to the convex hull, cut by a regular grid first: compact cells */
  CELLIST_EXTERIOR_DELAUNAY  /* up to the convex hull, a constrained Delaunay tetrahedralisation: the most compact
                                cells, which sort best; HULL where TetGen is absent or refuses the boundary */
} cellist_exterior;

typedef enum cellist_score {
  CELLIST_SCORE_OWN = 0, /* reflex edges that the plane splits less those that lie in it, then facets crossed */
  CELLIST_SCORE_PAPER    /* facets crossed: [C] section 6.2 */
} cellist_score;

/* {0} is valid and means the defaults. */
typedef struct cellist_convexify_desc {
  cellist_exterior exterior;
  uint32_t candidates; /* reflex edges whose planes compete for a cut; 0: 20. More than 20 sometimes hurts */
  cellist_score score;
  uint64_t seed;       /* of the random choice of candidates */
  bool keep_unmerged;  /* do not join neighbours whose union is convex */
  uint32_t grid_size;  /* grid: planes along the longest axis; 0: as many as suit the number of boundary faces */
  double flat_degrees; /* a reflex edge this flat or flatter counts as flat, as long as no vertex of a cell stands
                          farther beyond the plane of one of its facets than the angle's sine times the cell's diagonal.
                          Fewer cells, which are convex but for that: see flat_angle and flat_distance of the complex.
                          0: off (all cells are convex); below 90 */
} cellist_convexify_desc;

/* What convexifying did. */
typedef struct cellist_convexify_stats {
  cellist_exterior exterior; /* the one that was made; differs from the wanted one if Delaunay was refused */
  size_t imaginary_cells;
  size_t facets;
  size_t planes; /* distinct planes that facets lie in */
  size_t cuts;
  size_t merges;
  size_t exterior_facets;      /* triangles that enclosed the exterior before it was cut */
  size_t convexity_violations; /* edges at which an imaginary cell is reflex, by exact test; 0 */
  size_t flat_edges;           /* edges at which an imaginary cell is reflex but counts as flat */
  double flat_angle;           /* the largest angle there, in degrees, rounded up */
  double flat_distance;        /* how far a vertex of an imaginary cell stands beyond the plane of one of its facets */
  double hull_volume;          /* of the hull, or the box, in the mesh's unit cubed */
  double mesh_volume;          /* of the tets */
  double imaginary_volume;     /* of the imaginary cells, each summed by itself */
  double volume_error;         /* |imaginary - (hull - mesh)| / hull */
  bool cached;                 /* read from a file */
} cellist_convexify_stats;

/* The descriptor with every default filled in. Threads: any. */
CELLIST_API cellist_convexify_desc cellist_convexify_desc_default(void);

/* Makes a mesh convex. Every decision is exact on the coordinates as given.
 * Arrays: desc and stats may be NULL. *complex is the caller's, for cellist_complex_destroy.
 * Errors: INVALID_ARGUMENT (NULL, an angle out of range); GEOMETRY (tets that overlap, boundary faces that cross or
 * touch other than at shared vertices and edges, a flawed boundary: the message names cells by the ids of the user's
 * file); OUT_OF_MEMORY; CANCELLED; INTERNAL. Threads: one call per context at a time. The result depends on mesh and
 * desc only. Cost: see convexify/README.md. */
CELLIST_API cellist_result cellist_convexify(cellist_context *context, const cellist_mesh *mesh,
                                             const cellist_convexify_desc *desc, cellist_complex **complex,
                                             cellist_convexify_stats *stats);

/* As cellist_convexify, with a file (.cells) that keeps the result: it is read if it is whole and was made of the same
 * geometry with the same options, bit for bit what was written; otherwise the complex is made and the file (re)written,
 * whole or not at all. A damaged or stale file is no error.
 * Arrays: path is the file's name. The rest as above; stats->cached tells which it was.
 * Errors: as above, and IO (the file cannot be written).
 * Threads: one call per context at a time; several programs may share a file.
 * Cost: reading is linear in mesh and complex, mostly the hash of the mesh. */
CELLIST_API cellist_result cellist_convexify_cached(cellist_context *context, const cellist_mesh *mesh,
                                                    const cellist_convexify_desc *desc, const char *path,
                                                    cellist_complex **complex, cellist_convexify_stats *stats);

/* What a .cells file is kept under: a hash of everything that its content depends on. */
typedef struct cellist_cells_key {
  uint64_t value[2];
} cellist_cells_key;

/* The key of a mesh's geometry and the options (NULL: defaults). purpose: a number of the caller's, for files that hold
 * something else than cellist_convexify_cached keeps (0). Threads: any. Cost: one pass over the mesh. */
CELLIST_API cellist_cells_key cellist_cells_key_of(const cellist_mesh *mesh, const cellist_convexify_desc *desc,
                                                   uint64_t purpose);

/* A text in the file, for whoever reads it. */
enum { CELLIST_CELLS_NOTE = 256 };

/* Reads a .cells file that has this key.
 * Arrays: *complex is the caller's, NULL if the file holds a note only; stats and note may be NULL.
 * Errors: INVALID_ARGUMENT; NOT_FOUND (no file, a damaged one, or another key); OUT_OF_MEMORY.
 * Threads: one call per context at a time. Cost: linear in the file. */
CELLIST_API cellist_result cellist_cells_read(cellist_context *context, const char *path, cellist_cells_key key,
                                              cellist_complex **complex, cellist_convexify_stats *stats,
                                              char note[CELLIST_CELLS_NOTE]);

/* Writes one, whole or not at all.
 * Arrays: complex may be NULL, with stats; note may be NULL and is cut to fit.
 * Errors: INVALID_ARGUMENT; IO (the file cannot be written); OUT_OF_MEMORY.
 * Threads: one call per context at a time; several programs may write one file. Cost: linear in the complex. */
CELLIST_API cellist_result cellist_cells_write(cellist_context *context, const char *path, cellist_cells_key key,
                                               const cellist_complex *complex, const cellist_convexify_stats *stats,
                                               const char *note);

#ifdef __cplusplus
}
#endif
#endif
