/* SPDX-License-Identifier: BSD-3-Clause
 * Links: facets that are not faces of cells with four neighbours. One sign for each plane, for however many facets. */
#include <math.h>
#include <string.h>

#include "complex.h"

/* A doubt below this may itself have lost digits. */
static const double UNDERFLOW_GUARD = 1e-290;

static void fill_plane(const cellist_sorter_complex *from, uint32_t number, sort_link_plane *plane) {
  const uint32_t *ids = &from->planes[3 * (size_t)number];
  *plane = (sort_link_plane){0};
  if (ids[0] == CELLIST_NONE) {
    plane->axis = ids[1];
    plane->offset = from->offsets[ids[2]];
    return;
  }
  for (int k = 0; k < 3; k++) plane->points[k] = &from->points[3 * (size_t)ids[k]];
  sort_face_plane_make(plane->points[0], plane->points[1], plane->points[2], &plane->quick);
}

/* Renumbers the planes that links use, and makes them. */
static cellist_result make_planes(cellist_context *context, const cellist_sorter_complex *from, sort_links *links) {
  uint32_t *number = cellist_allocate(context, from->plane_count, sizeof *number);
  if (number == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memset(number, 0xff, from->plane_count * sizeof *number);
  for (size_t f = 0; f < links->facet_count; f++) {
    uint32_t *own = &number[links->facet_planes[f]];
    if (*own == CELLIST_NONE) *own = (uint32_t)links->plane_count++;
  }
  links->planes = cellist_allocate(context, links->plane_count, sizeof *links->planes);
  links->plane_sides = cellist_allocate(context, links->plane_count, sizeof *links->plane_sides);
  const bool ok = links->planes != NULL && links->plane_sides != NULL;
  for (uint32_t p = 0; ok && p < from->plane_count; p++)
    if (number[p] != CELLIST_NONE) fill_plane(from, p, &links->planes[number[p]]);
  for (size_t f = 0; f < links->facet_count; f++) links->facet_planes[f] = number[links->facet_planes[f]];
  cellist_deallocate(context, number);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

cellist_result sort_links_create(cellist_context *context, const cellist_sorter_complex *from, size_t cell_count,
                                 sort_links *links) {
  /* Nodes come as cells (below cell_count) or as cell_count + large cell; rows are cells that occur. */
  links->cell_rows = cellist_allocate(context, cell_count, sizeof *links->cell_rows);
  if (links->cell_rows == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memset(links->cell_rows, 0xff, cell_count * sizeof *links->cell_rows);
  for (size_t i = 0; i < 2 * links->facet_count; i++)
    if (links->facet_nodes[i] < cell_count) links->cell_rows[links->facet_nodes[i]] = 0;
  for (size_t i = 0; i < cell_count; i++)
    if (links->cell_rows[i] == 0) links->cell_rows[i] = (uint32_t)links->row_count++;
  const size_t node_count = links->row_count + links->large_count;
  links->row_cells = cellist_allocate(context, links->row_count, sizeof *links->row_cells);
  links->starts = cellist_allocate_zeroed(context, node_count + 1, sizeof *links->starts);
  links->links = cellist_allocate(context, links->facet_count, 2 * sizeof *links->links);
  links->facet_sides = cellist_allocate(context, links->facet_count, sizeof *links->facet_sides);
  links->pending = cellist_allocate(context, node_count, sizeof *links->pending);
  links->ready = cellist_allocate(context, links->large_count, sizeof *links->ready);
  links->farthest = cellist_allocate(context, links->large_count, sizeof *links->farthest);
  if (links->row_cells == NULL || links->starts == NULL || links->links == NULL || links->facet_sides == NULL ||
      links->pending == NULL || links->ready == NULL || links->farthest == NULL)
    return CELLIST_ERROR_OUT_OF_MEMORY;
  for (uint32_t i = 0; i < cell_count; i++)
    if (links->cell_rows[i] != CELLIST_NONE) links->row_cells[links->cell_rows[i]] = i;
  for (size_t i = 0; i < 2 * links->facet_count; i++) {
    uint32_t *node = &links->facet_nodes[i];
    *node = *node < cell_count ? links->cell_rows[*node] : (uint32_t)(links->row_count + (*node - cell_count));
    links->starts[*node]++;
  }
  uint32_t sum = 0;
  for (size_t n = 0; n <= node_count; n++) { /* now each node's end; filling from behind makes it the start */
    sum += n < node_count ? links->starts[n] : 0;
    links->starts[n] = sum;
  }
  for (size_t i = 2 * links->facet_count; i-- > 0;) links->links[--links->starts[links->facet_nodes[i]]] = (uint32_t)i;
  return make_planes(context, from, links);
}

void sort_links_release(cellist_context *context, sort_links *links) {
  cellist_deallocate(context, links->row_cells);
  cellist_deallocate(context, links->cell_rows);
  cellist_deallocate(context, links->planes);
  cellist_deallocate(context, links->facet_planes);
  cellist_deallocate(context, links->facet_nodes);
  cellist_deallocate(context, links->starts);
  cellist_deallocate(context, links->links);
  cellist_deallocate(context, links->plane_sides);
  cellist_deallocate(context, links->facet_sides);
  cellist_deallocate(context, links->pending);
  cellist_deallocate(context, links->ready);
  cellist_deallocate(context, links->farthest);
  *links = (sort_links){0};
}

static int side_of(const sort_link_plane *plane, const sort_eye *eye) {
  if (plane->points[0] == NULL) {
    const double at = eye->at[plane->axis], offset = eye->parallel ? 0 : plane->offset;
    return (at > offset) - (at < offset);
  }
  const sort_face_plane *quick = &plane->quick;
  double height = 0, reach = 0;
  for (int k = 0; k < 3; k++) {
    const double along = eye->parallel ? eye->at[k] : eye->at[k] - quick->point[k];
    height += quick->normal[k] * along;
    reach += fabs(along);
  }
  const double doubt = quick->doubt * reach;
  if (doubt > UNDERFLOW_GUARD && fabs(height) > doubt) return height > 0 ? 1 : -1;
  return sort_eye_side(eye, plane->points[0], plane->points[1], plane->points[2]);
}

void sort_links_find(sort_links *links, const sort_eye *eye) {
  if (links->facet_count == 0) return; /* no complex: no arrays either */
  for (size_t p = 0; p < links->plane_count; p++) links->plane_sides[p] = (int8_t)side_of(&links->planes[p], eye);
  memset(links->pending, 0, (links->row_count + links->large_count) * sizeof *links->pending);
  for (size_t f = 0; f < links->facet_count; f++) {
    const int8_t side = links->plane_sides[links->facet_planes[f]];
    links->facet_sides[f] = side;
    if (side != 0) links->pending[links->facet_nodes[2 * f + (side < 0)]]++;
  }
}
