/* SPDX-License-Identifier: BSD-3-Clause
 * Movie: how the exterior of a mesh was cut, as a sequence of pictures ([C] section 11): the mesh in grey, and the
 * imaginary cells in the order in which cutting finished them, each in a colour of its own and a little smaller than it
 * is, so that one sees between them. Shrinking leaves convex cells apart, which pulling them asunder would not where
 * the mesh lies between. */
#include "movie.h"

#include <cellist/raycast.h>
#include <cellist/surface.h>
#include <cellist/transfer.h>
#include <cellist/view.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* Cells are drawn at this size, about the mean of their corners. */
static const double CELL_SIZE = 0.86;
/* Pictures besides the first, at most: two seconds of film; more cells appear several at a time. */
enum { MOST_PICTURES = 60, WIDTH = 800, HEIGHT = 600 };

/* The facets of the imaginary cells as triangles, cell by cell. */
typedef struct cell_triangles {
  size_t cell_count;
  size_t *point_end, *triangle_end; /* [cell_count] where each cell's end */
  double *positions;
  float *colours;
  uint32_t *triangles;
} cell_triangles;

static void release_triangles(cellist_context *context, cell_triangles *c) {
  cellist_deallocate(context, c->point_end);
  cellist_deallocate(context, c->triangle_end);
  cellist_deallocate(context, c->positions);
  cellist_deallocate(context, c->colours);
  cellist_deallocate(context, c->triangles);
}

/* Neighbouring numbers get hues far apart: steps of the golden ratio around the circle. */
static void colour_of(size_t cell, float colour[3]) {
  const double turns = 0.6180339887498949 * (double)cell;
  const double hue = 6 * (turns - floor(turns));
  for (int k = 0; k < 3; k++) {
    const double at = fmod(hue + 2 * k, 6); /* 0 and 6 are full, 3 is none */
    const double share = fmin(fmax(fabs(at - 3) - 1, 0), 1);
    colour[k] = (float)(0.08 + 0.75 * share);
  }
}

typedef struct cell_facet {
  uint32_t cell, facet, side;
} cell_facet;

/* The sides of facets that imaginary cells have, by cell (a counting sort). */
static cell_facet *facets_by_cell(cellist_context *context, const cellist_complex_arrays *a, size_t *count) {
  const size_t cells = a->cell_count - a->tet_count;
  size_t *start = cellist_allocate_zeroed(context, cells + 1, sizeof *start);
  cell_facet *sorted = cellist_allocate(context, 2 * a->facet_count, sizeof *sorted);
  *count = 0;
  for (int pass = 0; pass < 2 && start != NULL && sorted != NULL; pass++) {
    for (uint32_t f = 0; f < 2 * a->facet_count; f++) {
      const uint32_t cell = a->facet_cells[f];
      if (cell == CELLIST_NONE || cell < a->tet_count) continue;
      if (pass == 0) {
        start[cell - a->tet_count + 1]++;
        ++*count;
      } else {
        sorted[start[cell - a->tet_count]++] = (cell_facet){(uint32_t)(cell - a->tet_count), f / 2, f % 2};
      }
    }
    for (size_t i = 0; pass == 0 && i < cells; i++) start[i + 1] += start[i];
  }
  if (start == NULL) {
    cellist_deallocate(context, sorted);
    sorted = NULL;
  }
  cellist_deallocate(context, start);
  return sorted;
}

static void add_facet(cell_triangles *c, const cellist_complex_arrays *a, const cell_facet *f, const double centre[3],
                      size_t *point_count, size_t *triangle_count) {
  const uint32_t begin = a->facet_starts[f->facet], corners = a->facet_starts[f->facet + 1] - begin;
  const uint32_t first = (uint32_t)*point_count;
  for (uint32_t i = 0; i < corners; i++) {
    const double *v = &a->vertices[3 * (size_t)a->facet_vertices[begin + i]];
    for (size_t k = 0; k < 3; k++) c->positions[3 * *point_count + k] = centre[k] + CELL_SIZE * (v[k] - centre[k]);
    colour_of(f->cell, &c->colours[3 * *point_count]);
    ++*point_count;
  }
  for (uint32_t i = 1; i + 1 < corners; i++) {
    const uint32_t triangle[3] = {first, first + i, first + i + 1};
    memcpy(&c->triangles[3 * (*triangle_count)++], triangle, sizeof triangle);
  }
}

static cellist_result make_triangles(cellist_context *context, const cellist_complex_arrays *a, cell_triangles *c) {
  const size_t corners = 2 * (size_t)a->facet_starts[a->facet_count];
  *c = (cell_triangles){.cell_count = a->cell_count - a->tet_count};
  size_t count = 0;
  cell_facet *facets = facets_by_cell(context, a, &count);
  c->point_end = cellist_allocate(context, c->cell_count, sizeof *c->point_end);
  c->triangle_end = cellist_allocate(context, c->cell_count, sizeof *c->triangle_end);
  c->positions = cellist_allocate(context, corners, 3 * sizeof *c->positions);
  c->colours = cellist_allocate(context, corners, 3 * sizeof *c->colours);
  c->triangles = cellist_allocate(context, corners, 3 * sizeof *c->triangles);
  const bool ok = facets != NULL && c->point_end != NULL && c->triangle_end != NULL && c->positions != NULL &&
                  c->colours != NULL && c->triangles != NULL;
  size_t points = 0, triangles = 0;
  for (size_t begin = 0, end; ok && begin < count; begin = end) {
    double centre[3] = {0, 0, 0};
    size_t summed = 0;
    for (end = begin; end < count && facets[end].cell == facets[begin].cell; end++)
      for (uint32_t i = a->facet_starts[facets[end].facet]; i < a->facet_starts[facets[end].facet + 1]; i++, summed++)
        for (int k = 0; k < 3; k++) centre[k] += a->vertices[3 * (size_t)a->facet_vertices[i] + (size_t)k];
    for (int k = 0; k < 3; k++) centre[k] /= (double)summed;
    for (size_t i = begin; i < end; i++) add_facet(c, a, &facets[i], centre, &points, &triangles);
    c->point_end[facets[begin].cell] = points;
    c->triangle_end[facets[begin].cell] = triangles;
  }
  cellist_deallocate(context, facets);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

/* One picture: the mesh's boundary and the first cells. */
static cellist_result draw(cellist_context *context, cellist_raycaster *caster, const cellist_frame *frame,
                           const cellist_surface *body, const cell_triangles *c, size_t cells, const char *path) {
  static const char *const channels[] = {"R", "G", "B", "A"};
  static const double background[3] = {1, 1, 1};
  cellist_transfer_knot nothing = {0};
  const cellist_transfer clear = {.knot_count = 1, .knots = &nothing};
  cellist_surface *parts[2] = {NULL, NULL};
  cellist_image *image = NULL;
  const cellist_surface_arrays arrays = {.point_count = cells > 0 ? c->point_end[cells - 1] : 0,
                                         .positions = c->positions,
                                         .colours = c->colours,
                                         .triangle_count = cells > 0 ? c->triangle_end[cells - 1] : 0,
                                         .triangles = c->triangles};
  cellist_result result = cellist_surface_create(context, &arrays, &parts[0]);
  if (result == CELLIST_SUCCESS)
    result = cellist_surface_join(context, (const cellist_surface *const[]){body, parts[0]}, 2, &parts[1]);
  if (result == CELLIST_SUCCESS)
    result = cellist_image_create(context, frame->width, frame->height, channels, 4, &image);
  const cellist_raycast_desc desc = {.surface = parts[1]};
  if (result == CELLIST_SUCCESS)
    result = cellist_raycaster_render(caster, frame, &clear, &desc, &(cellist_raycast_output){.image = image}, NULL);
  if (result == CELLIST_SUCCESS) result = cellist_image_write(context, image, path, background);
  cellist_image_destroy(image);
  cellist_surface_destroy(parts[0]);
  cellist_surface_destroy(parts[1]);
  return result;
}

static cellist_result draw_all(cellist_context *context, const cellist_mesh *mesh, const cell_triangles *c,
                               const char *directory, size_t *pictures) {
  static const double grey[3] = {0.6, 0.6, 0.6};
  const double *bounds = cellist_mesh_get_arrays(mesh)->bounds;
  const cellist_view view = cellist_view_orbit(bounds, CELLIST_VIEW_AZIMUTH, CELLIST_VIEW_ELEVATION);
  const cellist_surface_cells boundary = {.mesh = mesh, .colour = grey};
  cellist_frame frame;
  cellist_scalar scalar = {0};
  cellist_raycaster *caster = NULL;
  cellist_surface *body = NULL;
  const size_t length = strlen(directory) + 32, steps = c->cell_count < MOST_PICTURES ? c->cell_count : MOST_PICTURES;
  char *path = cellist_allocate(context, length, 1);
  cellist_result result = path != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) result = cellist_frame_from_view(context, &view, WIDTH, HEIGHT, &frame);
  if (result == CELLIST_SUCCESS) result = cellist_scalar_select(context, mesh, NULL, &scalar);
  if (result == CELLIST_SUCCESS) result = cellist_raycaster_create(context, mesh, &scalar, NULL, &caster);
  if (result == CELLIST_SUCCESS) result = cellist_surface_from_cells(context, &boundary, &body);
  for (size_t i = 0; result == CELLIST_SUCCESS && i <= steps; i++) {
    result = cellist_progress(context, "drawing", (double)i / (double)(steps + 1));
    snprintf(path, length, "%s/%04zu.png", directory, i);
    const size_t cells = steps > 0 ? c->cell_count * i / steps : 0;
    if (result == CELLIST_SUCCESS) result = draw(context, caster, &frame, body, c, cells, path);
    *pictures += result == CELLIST_SUCCESS;
  }
  cellist_surface_destroy(body);
  cellist_raycaster_destroy(caster);
  cellist_scalar_release(context, &scalar);
  cellist_deallocate(context, path);
  return result;
}

cellist_result movie_write(cellist_context *context, const cellist_mesh *mesh, const cellist_complex *complex,
                           const char *directory, size_t *pictures) {
  *pictures = 0;
  if (mkdir(directory, 0777) != 0 && errno != EEXIST)
    return cellist_fail(context, CELLIST_ERROR_IO, "%s cannot be made: %s", directory, strerror(errno));
  cell_triangles triangles;
  cellist_result result = make_triangles(context, cellist_complex_get_arrays(complex), &triangles);
  if (result == CELLIST_SUCCESS) result = draw_all(context, mesh, &triangles, directory, pictures);
  release_triangles(context, &triangles);
  if (result == CELLIST_SUCCESS) result = cellist_progress(context, "drawing", 1);
  return result;
}
