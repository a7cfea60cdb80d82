/* SPDX-License-Identifier: BSD-3-Clause
 * Complex: takes a convexified mesh's arrays apart into cells with four neighbours and links.
 *
 * Sorting asks one thing of a facet: on which side of its plane the eye lies. So an imaginary tet (a Delaunay
 * exterior's) goes through the same integer kernel and the same queue as a real one, and the exterior costs as many
 * tets more as it has. */
#include "complex.h"

#include <string.h>

enum { NO_FACE = 4 };

struct build {
  cellist_context *context;
  const cellist_sorter_desc *mesh;
  const cellist_sorter_complex *from;
  const uint8_t *cut;
  uint8_t *faces;    /* [2 facet_count] the tet's face there; NO_FACE for imaginary cells and the outside */
  uint8_t *uses;     /* [4 tet_count] how many facets a tet's face has, at most 255 */
  uint32_t *facets;  /* [imaginary cells] how many facets lead to another cell */
  uint32_t *numbers; /* [imaginary cells] cell, or cell_count + large cell */
  size_t cell_count; /* the tets, and the imaginary cells with at most four neighbours */
  size_t peeled;     /* tets' faces with a facet and, across it, a flat tet */
};

static cellist_result check_arrays(struct build *build) {
  const cellist_sorter_complex *from = build->from;
  cellist_context *context = build->context;
  const cellist_result invalid = CELLIST_ERROR_INVALID_ARGUMENT;
  if (from->cell_count < build->mesh->tet_count || from->cell_count > UINT32_MAX / 8 ||
      from->facet_count > UINT32_MAX / 4 || from->point_count < build->mesh->point_count)
    return cellist_fail(context, invalid, "a complex of %zu cells and %zu points for a mesh of %zu tets and %zu points",
                        from->cell_count, from->point_count, build->mesh->tet_count, build->mesh->point_count);
  if ((from->points == NULL && from->point_count > 0) || (from->offsets == NULL && from->offset_count > 0) ||
      (from->planes == NULL && from->plane_count > 0) ||
      ((from->facet_planes == NULL || from->facet_cells == NULL) && from->facet_count > 0))
    return cellist_fail(context, invalid, "an array of the complex is NULL");
  if (memcmp(from->points, build->mesh->points, build->mesh->point_count * 3 * sizeof(double)) != 0)
    return cellist_fail(context, invalid, "the complex is of other points than the mesh");
  for (size_t p = 0; p < from->plane_count; p++) {
    const uint32_t *ids = &from->planes[3 * p];
    const bool across_axis = ids[0] == CELLIST_NONE;
    bool known = across_axis ? ids[1] < 3 && ids[2] < from->offset_count : true;
    for (int k = 0; k < 3 && !across_axis; k++) known &= ids[k] < from->point_count;
    if (!known) return cellist_fail(context, invalid, "plane %zu of the complex is made of what is not there", p);
  }
  for (size_t f = 0; f < from->facet_count; f++) {
    const uint32_t *cells = &from->facet_cells[2 * f];
    if (from->facet_planes[f] >= from->plane_count || cells[0] == cells[1] ||
        (cells[0] != CELLIST_NONE && cells[0] >= from->cell_count) ||
        (cells[1] != CELLIST_NONE && cells[1] >= from->cell_count))
      return cellist_fail(context, invalid, "facet %zu of the complex (cells %u and %u, plane %u) is out of range", f,
                          cells[0], cells[1], from->facet_planes[f]);
  }
  return CELLIST_SUCCESS;
}

static bool same_place(const double *a, const double *b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

/* Whether face k of the tet lies in the plane of p, with the tet on the plane's side `sign`. */
static bool face_lies_in(const cellist_sorter_desc *mesh, uint32_t tet, uint32_t k, const double *p[3], int sign) {
  const uint32_t *v = &mesh->tets[4 * (size_t)tet];
  const double *apex = &mesh->points[3 * (size_t)v[k]];
  bool all = true;
  for (uint32_t c = 0; c < 3 && all; c++) {
    const double *x = &mesh->points[3 * (size_t)v[SORT_TET_FACE[k][c]]];
    bool found = false;
    for (int i = 0; i < 3; i++) found |= same_place(x, p[i]);
    all = found || cellist_orient3d(p[0], p[1], p[2], x) == 0;
  }
  return all && cellist_orient3d(p[0], p[1], p[2], apex) == sign;
}

static bool is_flat(const cellist_sorter_desc *mesh, uint32_t tet) {
  const double *p[4];
  for (size_t c = 0; c < 4; c++) p[c] = &mesh->points[3 * (size_t)mesh->tets[4 * (size_t)tet + c]];
  return cellist_orient3d(p[0], p[1], p[2], p[3]) == 0;
}

/* Finds the tets' faces that facets lie in. */
static cellist_result find_faces(struct build *build) {
  const cellist_sorter_complex *from = build->from;
  for (size_t i = 0; i < 2 * from->facet_count; i++) {
    const uint32_t tet = from->facet_cells[i];
    build->faces[i] = NO_FACE;
    if (tet == CELLIST_NONE || tet >= build->mesh->tet_count) continue;
    const uint32_t *ids = &from->planes[3 * (size_t)from->facet_planes[i / 2]];
    uint32_t k = 0;
    if (ids[0] == CELLIST_NONE) {
      const uint32_t *v = &build->mesh->tets[4 * (size_t)tet];
      for (; k < 4; k++) {
        bool level = true;
        for (uint32_t c = 0; c < 3; c++)
          level &= from->points[3 * (size_t)v[SORT_TET_FACE[k][c]] + ids[1]] == from->offsets[ids[2]];
        const double apex = from->points[3 * (size_t)v[k] + ids[1]] - from->offsets[ids[2]];
        if (level && (i % 2 == 0 ? apex > 0 : apex < 0)) break;
      }
    } else {
      const double *p[3];
      for (int c = 0; c < 3; c++) p[c] = &from->points[3 * (size_t)ids[c]];
      while (k < 4 && !face_lies_in(build->mesh, tet, k, p, i % 2 == 0 ? 1 : -1)) k++;
    }
    if (k == 4)
      return cellist_fail(build->context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "facet %zu of the complex lies in no face of tet %u", i / 2, tet);
    build->faces[i] = (uint8_t)k;
    uint8_t *uses = &build->uses[4 * (size_t)tet + k];
    const uint32_t other = build->mesh->neighbours[4 * (size_t)tet + k];
    if (other != CELLIST_NONE && *uses == 0) {
      if (!is_flat(build->mesh, other))
        return cellist_fail(build->context, CELLIST_ERROR_INVALID_ARGUMENT,
                            "facet %zu of the complex lies between tet %u and its neighbour %u", i / 2, tet, other);
      build->peeled++;
    }
    *uses = (uint8_t)(*uses < UINT8_MAX ? *uses + 1 : UINT8_MAX);
  }
  return CELLIST_SUCCESS;
}

/* Every boundary face must have a facet, flat tets' apart: no ray passes through these. */
static cellist_result check_cover(const struct build *build) {
  const cellist_sorter_desc *mesh = build->mesh;
  for (size_t i = 0; i < 4 * mesh->tet_count; i++) {
    if (mesh->neighbours[i] != CELLIST_NONE || build->uses[i] > 0) continue;
    if (build->cut != NULL && (build->cut[i / 4] >> (i % 4) & 1)) continue;
    if (!is_flat(mesh, (uint32_t)(i / 4)))
      return cellist_fail(build->context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "the complex has no facet at face %zu of tet %zu", i % 4, i / 4);
  }
  return CELLIST_SUCCESS;
}

/* Which imaginary cells have at most four neighbours, none across an axis plane. */
static void number_cells(struct build *build, size_t *large_count) {
  const cellist_sorter_complex *from = build->from;
  const size_t tet_count = build->mesh->tet_count, imaginary_count = from->cell_count - tet_count;
  for (size_t i = 0; i < 2 * from->facet_count; i++) {
    if (from->facet_cells[i ^ 1] == CELLIST_NONE || from->facet_cells[i] == CELLIST_NONE ||
        from->facet_cells[i] < tet_count)
      continue;
    uint32_t *count = &build->facets[from->facet_cells[i] - tet_count];
    *count += from->planes[3 * (size_t)from->facet_planes[i / 2]] == CELLIST_NONE ? 5 : 1;
  }
  build->cell_count = tet_count;
  for (size_t c = 0; c < imaginary_count; c++)
    if (build->facets[c] <= 4) build->numbers[c] = (uint32_t)build->cell_count++;
  for (size_t c = 0; c < imaginary_count; c++)
    if (build->facets[c] > 4) build->numbers[c] = (uint32_t)(build->cell_count + (*large_count)++);
}

static uint32_t number_of(const struct build *build, uint32_t cell) {
  return cell < build->mesh->tet_count ? cell : build->numbers[cell - build->mesh->tet_count];
}

/* Whether this side of the facet is a face that no other facet lies in. */
static bool is_face(const struct build *build, size_t i) {
  const uint32_t cell = build->from->facet_cells[i];
  if (cell >= build->mesh->tet_count) return number_of(build, cell) < build->cell_count;
  return build->uses[4 * (size_t)cell + build->faces[i]] == 1;
}

/* Enters one side of a facet among the cell's neighbours. */
static void add_neighbour(struct build *build, sort_complex *complex, size_t i) {
  const cellist_sorter_complex *from = build->from;
  const uint32_t cell = number_of(build, from->facet_cells[i]), other = number_of(build, from->facet_cells[i ^ 1]);
  uint32_t k = build->faces[i];
  if (cell >= build->mesh->tet_count) {
    for (k = 0; complex->neighbours[4 * (size_t)cell + k] != CELLIST_NONE;) k++;
    const uint32_t *ids = &from->planes[3 * (size_t)from->facet_planes[i / 2]];
    uint32_t *plane = &complex->planes[12 * (cell - build->mesh->tet_count) + 3 * k];
    plane[0] = ids[0];
    plane[1] = ids[i % 2 == 0 ? 2 : 1]; /* the cell lies on the positive side: outside is the negative one */
    plane[2] = ids[i % 2 == 0 ? 1 : 2];
  }
  complex->neighbours[4 * (size_t)cell + k] = other;
}

/* Flat tets on the boundary are no part of the complex, which has its facets beneath them: there the tets beneath are
 * cut off from them, and a link keeps both in order. Cuts both in `neighbours`. */
static void peel(struct build *build, uint32_t *neighbours, sort_links *links) {
  const cellist_sorter_complex *from = build->from;
  for (size_t i = 0; i < 2 * from->facet_count; i++) {
    if (build->faces[i] == NO_FACE) continue;
    const uint32_t tet = from->facet_cells[i];
    uint32_t *across = &neighbours[4 * (size_t)tet + build->faces[i]];
    const uint32_t flat = *across;
    if (flat == CELLIST_NONE) continue;
    *across = CELLIST_NONE;
    for (uint32_t k = 0; k < 4; k++)
      if (neighbours[4 * (size_t)flat + k] == tet) neighbours[4 * (size_t)flat + k] = CELLIST_NONE;
    links->facet_planes[links->facet_count] = from->facet_planes[i / 2];
    links->facet_nodes[2 * links->facet_count + i % 2] = tet;
    links->facet_nodes[2 * links->facet_count++ + 1 - i % 2] = flat;
  }
}

static cellist_result take_facets(struct build *build, sort_complex *complex) {
  const cellist_sorter_complex *from = build->from;
  const cellist_sorter_desc *mesh = build->mesh;
  cellist_context *context = build->context;
  sort_links *links = &complex->links;
  const size_t simple = build->cell_count - mesh->tet_count;
  size_t link_count = build->peeled;
  for (size_t f = 0; f < from->facet_count; f++)
    link_count += from->facet_cells[2 * f] != CELLIST_NONE && from->facet_cells[2 * f + 1] != CELLIST_NONE &&
                  !(is_face(build, 2 * f) && is_face(build, 2 * f + 1));
  complex->neighbours = cellist_allocate(context, build->cell_count, 4 * sizeof *complex->neighbours);
  complex->planes = cellist_allocate_zeroed(context, simple, 12 * sizeof *complex->planes);
  links->facet_planes = cellist_allocate(context, link_count, sizeof *links->facet_planes);
  links->facet_nodes = cellist_allocate(context, link_count, 2 * sizeof *links->facet_nodes);
  if (complex->neighbours == NULL || complex->planes == NULL || links->facet_planes == NULL ||
      links->facet_nodes == NULL)
    return CELLIST_ERROR_OUT_OF_MEMORY;
  memcpy(complex->neighbours, mesh->neighbours, mesh->tet_count * 4 * sizeof *complex->neighbours);
  memset(&complex->neighbours[4 * mesh->tet_count], 0xff, simple * 4 * sizeof *complex->neighbours);
  if (build->peeled > 0) {
    peel(build, complex->neighbours, links);
    complex->exposed = cellist_allocate(context, mesh->tet_count, 4 * sizeof *complex->exposed);
    if (complex->exposed == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    memcpy(complex->exposed, complex->neighbours, mesh->tet_count * 4 * sizeof *complex->exposed);
  }
  for (size_t f = 0; f < from->facet_count; f++) {
    const uint32_t *cells = &from->facet_cells[2 * f];
    if (cells[0] == CELLIST_NONE || cells[1] == CELLIST_NONE) continue;
    if (is_face(build, 2 * f) && is_face(build, 2 * f + 1)) {
      add_neighbour(build, complex, 2 * f);
      add_neighbour(build, complex, 2 * f + 1);
      continue;
    }
    links->facet_planes[links->facet_count] = from->facet_planes[f];
    for (size_t side = 0; side < 2; side++)
      links->facet_nodes[2 * links->facet_count + side] = number_of(build, cells[side]);
    links->facet_count++;
  }
  return sort_links_create(context, from, build->cell_count, links);
}

cellist_result sort_complex_create(cellist_context *context, const cellist_sorter_desc *mesh, const uint8_t *cut,
                                   sort_complex *complex, sort_cells *cells) {
  struct build build = {.context = context, .mesh = mesh, .cut = cut, .from = mesh->complex};
  cellist_result result = check_arrays(&build);
  if (result != CELLIST_SUCCESS) return result;
  const size_t imaginary_count = build.from->cell_count - mesh->tet_count;
  build.faces = cellist_allocate(context, build.from->facet_count, 2);
  build.uses = cellist_allocate_zeroed(context, mesh->tet_count, 4);
  build.facets = cellist_allocate_zeroed(context, imaginary_count, sizeof *build.facets);
  build.numbers = cellist_allocate(context, imaginary_count, sizeof *build.numbers);
  if (build.faces == NULL || build.uses == NULL || build.facets == NULL || build.numbers == NULL)
    result = CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) result = find_faces(&build);
  if (result == CELLIST_SUCCESS) result = check_cover(&build);
  if (result == CELLIST_SUCCESS) {
    complex->imaginary_count = imaginary_count;
    number_cells(&build, &complex->links.large_count);
    result = take_facets(&build, complex);
  }
  if (result == CELLIST_SUCCESS)
    *cells = (sort_cells){.tet_count = mesh->tet_count,
                          .count = build.cell_count,
                          .points = build.from->points,
                          .tets = mesh->tets,
                          .planes = complex->planes,
                          .neighbours = complex->neighbours};
  cellist_deallocate(context, build.faces);
  cellist_deallocate(context, build.uses);
  cellist_deallocate(context, build.facets);
  cellist_deallocate(context, build.numbers);
  return result;
}

void sort_complex_release(cellist_context *context, sort_complex *complex) {
  cellist_deallocate(context, complex->neighbours);
  cellist_deallocate(context, complex->planes);
  cellist_deallocate(context, complex->exposed);
  sort_links_release(context, &complex->links);
  *complex = (sort_complex){0};
}
