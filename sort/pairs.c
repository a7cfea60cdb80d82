/* SPDX-License-Identifier: BSD-3-Clause
 * Pairs: which of two cells is in front, by the same exact tests as gap arcs, from all faces instead of the boundary's:
 * one is in front of the other if a ray leaves the first through some face and enters the second one after that.
 * On any one ray disjoint convex cells have an order, so this relation orders a group's cells ray by ray, though
 * not as a whole. */
#include "gaps/overlap.h"
#include "sorter.h"

/* A tet's four faces as an eye sees them. */
struct faces {
  uint32_t corners[4][3];
  sort_face_plane planes[4];
  int sides[4]; /* 1: the eye is outside */
};

static void fill_faces(const cellist_sorter_desc *mesh, const sort_eye *eye, uint32_t tet, struct faces *faces) {
  for (int k = 0; k < 4; k++) {
    const double *p[3];
    for (int c = 0; c < 3; c++) {
      faces->corners[k][c] = mesh->tets[4 * (size_t)tet + SORT_TET_FACE[k][c]];
      p[c] = &mesh->points[3 * (size_t)faces->corners[k][c]];
    }
    sort_face_plane_make(p[0], p[1], p[2], &faces->planes[k]);
    faces->sides[k] = sort_eye_side(eye, p[0], p[1], p[2]);
  }
}

static bool is_before(const sort_scene *scene, const struct faces *near, const struct faces *far) {
  for (int i = 0; i < 4; i++) {
    if (near->sides[i] >= 0) continue;
    for (int j = 0; j < 4; j++) {
      if (far->sides[j] <= 0) continue;
      const sort_face leaving = {near->corners[i], &near->planes[i]}, entering = {far->corners[j], &far->planes[j]};
      if (sort_leaves_before(scene, leaving, entering)) return true;
    }
  }
  return false;
}

int cellist_sorter_compare(const cellist_sorter *sorter, const cellist_viewpoint *viewpoint, uint32_t a, uint32_t b) {
  if (a == b) return 0;
  const sort_scene scene = {
      .eye = sort_eye_of(viewpoint), .positions = sorter->mesh.points, .around_eye = !viewpoint->parallel};
  struct faces of_a, of_b;
  fill_faces(&sorter->mesh, &scene.eye, a, &of_a);
  fill_faces(&sorter->mesh, &scene.eye, b, &of_b);
  return (int)is_before(&scene, &of_a, &of_b) - (int)is_before(&scene, &of_b, &of_a);
}
