/* SPDX-License-Identifier: BSD-3-Clause
 * Walk: the segments of one ray through the mesh, from near to far. Private to the reference caster. */
#ifndef CELLIST_RAYCAST_REFERENCE_WALK_H
#define CELLIST_RAYCAST_REFERENCE_WALK_H

#include <cellist/mesh.h>

#include "hierarchy.h"
#include "line.h"

/* The part of a ray that is seen: from the near plane or a clip plane on, up to a clip plane or a surface. */
typedef struct walk_limits {
  double t[2];       /* the ray's parameter; t[0] > t[1]: nothing is seen */
  double t_error[2]; /* how far they may be off */
} walk_limits;

/* The part of a ray that lies in one cell, within the limits. The scalar is linear between its ends. */
typedef struct walk_segment {
  double t[2];       /* the ray's parameter at the front and at the back */
  double t_error[2]; /* how far they may be off */
  double scalar[2];
  double scalar_error;   /* how far the scalar may be off anywhere on the segment */
  double gradient[2][3]; /* filled if the walker has gradients */
  uint32_t tet;
} walk_segment;

typedef struct walk_entry {
  double t;
  uint32_t face; /* 4 * tet + corner */
} walk_entry;

/* What a walk reads, and its scratch; one per worker. */
typedef struct ray_walker {
  cellist_context *context;
  const cellist_mesh_arrays *mesh;
  const cellist_scalar *scalar;
  const face_hierarchy *hierarchy;
  const double *point_gradients; /* [3 points] or NULL */
  const double *cell_gradients;  /* [3 tets] or NULL */
  const float *slopes;           /* [tets] at least the length of the scalar's gradient; NULL: 0 */

  ray_line line;
  walk_entry *entries;
  size_t entry_count, entry_capacity;
  walk_segment *segments;
  size_t segment_count, segment_capacity;

  uint64_t ray_count, total_entries, step_count, retry_count, fold_ray_count; /* over all rays so far */
  uint32_t ray_steps;                                                         /* cells of this ray within the limits */
} ray_walker;

/* Fills segments for the ray; segments of zero length and cells without a finite scalar are left out. Returns false if
 * there was no memory. */
bool walk_ray(ray_walker *walker, const double origin[3], const double direction[3], const walk_limits *limits);

void walk_release(ray_walker *walker);

#endif
