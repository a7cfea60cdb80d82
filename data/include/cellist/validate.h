/* SPDX-License-Identifier: BSD-3-Clause
 * Validate: what is wrong with a mesh, in words and ids that its user knows, and what kind of mesh it is.
 *
 * Every decision on shape (inverted, flat, reflex, crossing) is exact; only the needle's angle is a measure. */
#ifndef CELLIST_VALIDATE_H
#define CELLIST_VALIDATE_H

#include <cellist/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What may be found. The comments say which ids a finding holds and counts. */
typedef enum cellist_finding_kind {
  CELLIST_FINDING_INVERTED,   /* cells given with negative volume: re-oriented */
  CELLIST_FINDING_FLAT,       /* cells of exactly zero volume: kept in the order, never drawn */
  CELLIST_FINDING_NEEDLE,     /* cells with a dihedral angle under 0.1 degree */
  CELLIST_FINDING_DUPLICATE,  /* cells with the same four points as another */
  CELLIST_FINDING_FOLDED,     /* cells on the same side of a face as the other cell of that face */
  CELLIST_FINDING_OVERFULL,   /* cells that share a face with more than one other */
  CELLIST_FINDING_HANGING,    /* cells with a boundary face against others that it does not match: hanging nodes */
  CELLIST_FINDING_SEAM,       /* cells with a boundary face against one of equal coordinates but other points */
  CELLIST_FINDING_TOUCHING,   /* cells whose boundary face touches another in more than the points they share */
  CELLIST_FINDING_CROSSING,   /* cells whose boundary face runs through another */
  CELLIST_FINDING_INFINITE,   /* cells with a NaN or infinite coordinate: left out */
  CELLIST_FINDING_COLLAPSED,  /* cells that use a point twice: left out */
  CELLIST_FINDING_NAN_SCALAR, /* cells with a NaN or infinite value: not drawn in that scalar */
  CELLIST_FINDING_UNUSED,     /* points that no cell uses */
  CELLIST_FINDING_COINCIDENT, /* points with the coordinates of an earlier one */
  CELLIST_FINDING_COUNT
} cellist_finding_kind;

/* A note is no fault; a warning costs precision or speed; a flaw makes some view of the mesh wrong. */
typedef enum cellist_severity { CELLIST_NOTE, CELLIST_WARNING, CELLIST_FLAW } cellist_severity;

enum { CELLIST_FINDING_IDS = 10 };

typedef struct cellist_finding {
  size_t count;                      /* of distinct cells of the user's file (hexahedra, say), or of points */
  size_t id_count;                   /* the smaller of count and CELLIST_FINDING_IDS; 0 where ids are not known */
  uint32_t ids[CELLIST_FINDING_IDS]; /* the lowest ids, ascending, as in the user's file */
} cellist_finding;

typedef struct cellist_validate_desc {
  bool strict;          /* fail if there is a flaw */
  bool ignore_contacts; /* leave the boundary's contacts with itself untested: hanging, seam, touching, crossing */
} cellist_validate_desc;

typedef struct cellist_report {
  cellist_finding findings[CELLIST_FINDING_COUNT];
  size_t flaw_count, warning_count; /* kinds of that severity with a count above 0 */

  size_t component_count;          /* parts that are connected across faces */
  size_t cavity_count;             /* closed parts of the boundary that enclose no cells but a hole in them */
  bool is_convex;                  /* one part, no cavity, no reflex edge, sound */
  size_t boundary_face_count;      /* faces with a tet on one side only */
  size_t folded_face_count;        /* faces with two tets on the same side */
  size_t overfull_face_count;      /* faces of more than two tets */
  size_t reflex_edge_count;        /* boundary edges with more than 180 degrees of mesh around them */
  size_t nonmanifold_edge_count;   /* edges of more than two boundary faces */
  size_t nonmanifold_vertex_count; /* points where fans of boundary faces meet that share no edge there */
  size_t inverted_cell_count;      /* cells of the file: findings[CELLIST_FINDING_INVERTED].count */
  size_t degenerate_cell_count;    /* cells of the file: findings[CELLIST_FINDING_FLAT].count */
  size_t crossing_face_count;      /* boundary faces that run through others */
  size_t touching_face_count;      /* boundary faces that touch others, and cross none */
} cellist_report;

/* A finding's short name ("inverted"), what it means in a line, and how bad it is. NULL, NULL and NOTE for a kind that
 * does not exist. Threads: any. */
CELLIST_API const char *cellist_finding_name(cellist_finding_kind kind);
CELLIST_API const char *cellist_finding_description(cellist_finding_kind kind);
CELLIST_API cellist_severity cellist_finding_severity(cellist_finding_kind kind);

/* Checks a mesh.
 * Arrays: desc may be NULL ({0}). *report is filled, also where strict makes the call fail; it owns nothing.
 * Errors: INVALID_ARGUMENT (mesh or report NULL), GEOMETRY (strict and a flaw: the message names it and its cells),
 *   OUT_OF_MEMORY, CANCELLED.
 * Threads: one call per context at a time; the mesh may be read by others.
 * Cost: linear; the contacts n log n in boundary faces unless very many of them lie on top of each other. */
CELLIST_API cellist_result cellist_validate(cellist_context *context, const cellist_mesh *mesh,
                                            const cellist_validate_desc *desc, cellist_report *report);

#ifdef __cplusplus
}
#endif
#endif
