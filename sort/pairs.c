/* SPDX-License-Identifier: BSD-3-Clause
 * Pairs: which of two cells is in front, by the same exact tests as gap arcs, from all faces instead of the boundary's:
 * one is in front of the other if a ray leaves the first through some face and enters the second one after that.
 * On any one ray disjoint convex cells have an order, so this relation orders a group's cells ray by ray, though
 * not as a whole. */
#include <math.h>
#include <string.h>

#include "gaps/overlap.h"
#include "sorter.h"

/* How much wider than computed a cell's box in the picture is taken, as a part of the picture: far more than rounding
 * can move a corner whose depth is no less than NEAREST of the largest one. Smaller, and pairs may be missed. */
static const double MARGIN = 1e-9, NEAREST = 1e-3;

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
      if (sort_leaves_before(scene, leaving, entering, NULL)) return true;
    }
  }
  return false;
}

int cellist_sorter_compare(const cellist_sorter *sorter, const cellist_viewpoint *viewpoint, uint32_t a, uint32_t b) {
  if (a == b) return 0;
  const sort_scene scene = {
      .eye = sort_eye_of(viewpoint), .positions = sorter->given.points, .around_eye = !viewpoint->parallel};
  struct faces of_a, of_b;
  fill_faces(&sorter->given, &scene.eye, a, &of_a);
  fill_faces(&sorter->given, &scene.eye, b, &of_b);
  return (int)is_before(&scene, &of_a, &of_b) - (int)is_before(&scene, &of_b, &of_a);
}

/* Where a cell lies in a picture of all the cells; only ever a filter. */
struct extent {
  double low[2], high[2];
};

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Fills in the cells' boxes; false if the eye lies among the cells, or too near for a picture of them all. */
static bool find_extents(const cellist_sorter_desc *mesh, const sort_eye *eye, const uint32_t *cells, size_t count,
                         struct extent *extents) {
  double middle[3] = {0, 0, 0}, towards[3], right[3], up[3], widest = 0, nearest = HUGE_VAL, farthest = 0;
  for (size_t i = 0; i < 4 * count; i++)
    for (size_t k = 0; k < 3; k++)
      middle[k] += mesh->points[3 * (size_t)mesh->tets[4 * (size_t)cells[i / 4] + i % 4] + k] / (4 * (double)count);
  for (int k = 0; k < 3; k++) towards[k] = eye->parallel ? eye->at[k] : eye->at[k] - middle[k];
  const double length = sqrt(dot(towards, towards));
  if (!(length > 0) || !isfinite(length)) return false;
  int smallest = 0;
  for (int k = 0; k < 3; k++) {
    towards[k] /= length;
    if (fabs(towards[k]) < fabs(towards[smallest])) smallest = k;
  }
  const double across = sqrt(1 - towards[smallest] * towards[smallest]);
  for (int k = 0; k < 3; k++) right[k] = ((k == smallest) - towards[smallest] * towards[k]) / across;
  for (int k = 0; k < 3; k++)
    up[k] = towards[(k + 1) % 3] * right[(k + 2) % 3] - towards[(k + 2) % 3] * right[(k + 1) % 3];
  for (size_t i = 0; i < count; i++) {
    extents[i] = (struct extent){{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    for (size_t c = 0; c < 4; c++) {
      const double *p = &mesh->points[3 * (size_t)mesh->tets[4 * (size_t)cells[i] + c]];
      double v[3];
      for (int k = 0; k < 3; k++) v[k] = p[k] - middle[k];
      const double depth = eye->parallel ? 1 : length - dot(v, towards);
      const double at[2] = {dot(v, right) / depth, dot(v, up) / depth};
      nearest = fmin(nearest, depth);
      farthest = fmax(farthest, depth);
      for (int k = 0; k < 2; k++) {
        widest = fmax(widest, fabs(at[k]));
        extents[i].low[k] = fmin(extents[i].low[k], at[k]);
        extents[i].high[k] = fmax(extents[i].high[k], at[k]);
      }
    }
  }
  if (!(nearest > NEAREST * farthest) || !isfinite(widest)) return false;
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 2; k++) {
      extents[i].low[k] -= MARGIN * widest;
      extents[i].high[k] += MARGIN * widest;
    }
  return true;
}

static bool are_apart(const struct extent *a, const struct extent *b) {
  return a->low[0] > b->high[0] || b->low[0] > a->high[0] || a->low[1] > b->high[1] || b->low[1] > a->high[1];
}

cellist_result cellist_sorter_compare_all(const cellist_sorter *sorter, const cellist_viewpoint *viewpoint,
                                          const uint32_t *cells, size_t count, int8_t *matrix) {
  if (sorter == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_context *context = sorter->context;
  if (viewpoint == NULL || ((cells == NULL || matrix == NULL) && count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_sorter_compare_all: NULL");
  for (size_t i = 0; i < count; i++)
    if (cells[i] >= sorter->given.tet_count)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cell %u of %zu", cells[i], sorter->given.tet_count);
  struct faces *faces = cellist_allocate(context, count, sizeof *faces);
  struct extent *extents = cellist_allocate(context, count, sizeof *extents);
  if (faces != NULL && extents != NULL) {
    const sort_scene scene = {
        .eye = sort_eye_of(viewpoint), .positions = sorter->given.points, .around_eye = !viewpoint->parallel};
    for (size_t i = 0; i < count; i++) fill_faces(&sorter->given, &scene.eye, cells[i], &faces[i]);
    const bool has_picture = find_extents(&sorter->given, &scene.eye, cells, count, extents);
    for (size_t i = 0; i < count; i++) {
      matrix[i * count + i] = 0;
      for (size_t j = 0; j < i; j++) {
        int8_t front = 0;
        if (!has_picture || !are_apart(&extents[i], &extents[j]))
          front = (int8_t)(is_before(&scene, &faces[i], &faces[j]) - is_before(&scene, &faces[j], &faces[i]));
        matrix[i * count + j] = front;
        matrix[j * count + i] = (int8_t)-front;
      }
    }
  }
  const bool ok = faces != NULL && extents != NULL;
  cellist_deallocate(context, faces);
  cellist_deallocate(context, extents);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}
