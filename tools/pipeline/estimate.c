/* SPDX-License-Identifier: BSD-3-Clause
 * Estimate: how many segments a frame will draw, counted rather than tried, for whoever has to choose how to draw it.
 *
 * The shadow of a tet along a direction d is half the sum of |n.d| over its faces, n their area vectors; seen from an
 * eye at depth z and angle a off the axis, it covers shadow / (z^2 cos a) of an image at depth 1. Summed over at most
 * SAMPLES tets, evenly spread; exact for small tets within the picture. Tets whose centre is outside the picture do not
 * count, those that reach beyond it count whole. */
#include <math.h>

#include "costs.h"

enum { SAMPLES = 20000 };

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* |n.d| of the triangle's area vector n. */
static double shadow_of(const double *a, const double *b, const double *c, const double direction[3]) {
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  return 0.5 * fabs(dot(n, direction));
}

/* Fragments of one tet; 0 if its centre is outside the picture. */
static double fragments_of(const cellist_mesh_arrays *mesh, const cellist_frame *frame, size_t tet) {
  const double *p[4];
  double centre[3] = {-frame->eye[0], -frame->eye[1], -frame->eye[2]};
  for (size_t k = 0; k < 4; k++) {
    p[k] = &mesh->positions[3 * (size_t)mesh->tets[4 * tet + k]];
    for (int i = 0; i < 3; i++) centre[i] += 0.25 * p[k][i];
  }
  const double depth = dot(centre, frame->forward), scale = frame->parallel ? 1 : depth;
  if (!(depth > frame->near_distance) || fabs(dot(centre, frame->right)) > frame->half_width * scale ||
      fabs(dot(centre, frame->up)) > frame->half_height * scale)
    return 0;
  const double *along = frame->parallel ? frame->forward : centre; /* cos a = depth / |centre| */
  double shadow = 0;                                               /* times |along| */
  for (size_t k = 0; k < 4; k++)
    shadow += shadow_of(p[CELLIST_TET_FACE[k][0]], p[CELLIST_TET_FACE[k][1]], p[CELLIST_TET_FACE[k][2]], along) / 2;
  const double pixel = 2 * frame->half_height * scale / frame->height;
  return fmin(shadow / scale / (pixel * pixel), (double)frame->width * frame->height);
}

double cellist_pipeline_estimate_fragments(const cellist_mesh *mesh, const cellist_frame *frame) {
  return draw_counts_of(mesh, frame, NULL).fragments;
}

draw_counts draw_counts_of(const cellist_mesh *mesh, const cellist_frame *frame, const uint8_t *visible) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  draw_counts counts = {.tets = (double)arrays->tet_count,
                        .pixels = (double)frame->width * frame->height,
                        .boundary_faces = (double)cellist_mesh_get_facts(mesh)->boundary_face_count};
  size_t count = arrays->tet_count;
  if (visible != NULL) {
    count = 0;
    for (size_t i = 0; i < arrays->tet_count; i++) count += visible[i];
    counts.tets = (double)count;
    counts.boundary_faces = (double)plan_count_boundary(arrays, visible);
  }
  const size_t stride = count / SAMPLES + 1;
  for (size_t i = 0, seen = 0; i < arrays->tet_count; i++) {
    if (visible != NULL && !visible[i]) continue;
    if (seen++ % stride == 0) counts.fragments += (double)stride * fragments_of(arrays, frame, i);
  }
  return counts;
}
