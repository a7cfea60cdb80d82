/* SPDX-License-Identifier: BSD-3-Clause
 * A mesh's boundary faces, with what every view needs of them. Private to sort/. */
#ifndef CELLIST_SORT_BOUNDARY_H
#define CELLIST_SORT_BOUNDARY_H

#include <cellist/sort.h>

/* The plane of a boundary face for quick tests: height(x) = normal . (x - point), positive outside. Its error is at
 * most doubt times the sum of |x - point|'s coordinates. */
typedef struct sort_face_plane {
  double normal[3], point[3], doubt;
} sort_face_plane;

/* Fills plane from three points, counter-clockwise seen from outside. */
void sort_face_plane_make(const double *a, const double *b, const double *c, sort_face_plane *plane);

typedef struct sort_boundary {
  size_t vertex_count;
  double *positions; /* [3 vertex_count] of the points that boundary faces use, in the order of their ids */
  size_t face_count;
  uint32_t *faces;         /* [face_count] 4 tet + corner, ascending */
  uint32_t *corners;       /* [3 face_count] vertices, counter-clockwise seen from outside */
  uint32_t *mates;         /* [3 face_count] the face on the other side of each face's edge (corner k to k + 1), which
                              has it the other way round, and has this face there; CELLIST_NONE: there is none */
  uint32_t *rows;          /* [face_count] the row of the face's cell */
  sort_face_plane *planes; /* [face_count] */
  size_t row_count;
  uint32_t *row_faces; /* [row_count + 1] row r's faces are faces row_faces[r] to row_faces[r + 1] - 1 */
  uint32_t *row_tets;  /* [row_count] the cells that have boundary faces, ascending: row r is of tet row_tets[r] */
  uint32_t *tet_rows;  /* [tet_count] and back; CELLIST_NONE for cells without boundary faces */
} sort_boundary;

/* Fills a zeroed boundary. Errors: OUT_OF_MEMORY, UNSUPPORTED (2^32 / 3 faces or more); what is there can be released.
 * Cost: linear. */
cellist_result sort_boundary_create(cellist_context *context, const cellist_sorter_desc *mesh, sort_boundary *boundary);
void sort_boundary_release(cellist_context *context, sort_boundary *boundary);

#endif
