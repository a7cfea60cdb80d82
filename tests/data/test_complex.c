/* SPDX-License-Identifier: BSD-3-Clause
 * Complex: two tets that touch along an edge, with the two imaginary tets that fill their hull, by hand. */
#include <cellist/complex.h>
#include <string.h>

#include "harness.h"

/* An octahedron without its points: the axis 0-1, and 2 3 4 5 around it. Tets 0123 and 0145 are real. */
static const double POINTS[] = {0, 0, -1, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0};
static const uint32_t CELLS[4][4] = {{0, 1, 2, 3}, {0, 1, 4, 5}, {0, 1, 3, 4}, {0, 1, 5, 2}};

struct model {
  uint32_t planes[36], facet_planes[12], facet_cells[24], starts[13], corners[36];
  cellist_complex_arrays arrays;
};

static void add_facet(struct model *model, uint32_t a, uint32_t b, uint32_t c, uint32_t front, uint32_t back) {
  const uint32_t f = (uint32_t)model->arrays.facet_count++;
  const uint32_t ids[3] = {a, b, c};
  memcpy(&model->planes[3 * f], ids, sizeof ids);
  memcpy(&model->corners[3 * f], ids, sizeof ids);
  model->facet_planes[f] = f;
  model->facet_cells[2 * f] = front;
  model->facet_cells[2 * f + 1] = back;
  model->starts[f + 1] = 3 * f + 3;
}

/* Cell ids of the mesh follow its own order: first tells which of the two given tets the mesh calls 0. */
static void build(struct model *model, const cellist_mesh *mesh) {
  memset(model, 0, sizeof *model);
  const cellist_mesh_arrays *m = cellist_mesh_get_arrays(mesh);
  uint32_t id[6], cell[4] = {0, 1, 2, 3};
  for (uint32_t i = 0; i < 6; i++) id[m->point_origin[i]] = i;
  cell[m->tet_origin[0]] = 0;
  cell[m->tet_origin[1]] = 1;
  for (int i = 0; i < 4; i++) {
    const uint32_t *v = CELLS[i];
    add_facet(model, id[0], id[v[3]], id[v[2]], CELLIST_NONE, cell[i]);
    add_facet(model, id[1], id[v[2]], id[v[3]], CELLIST_NONE, cell[i]);
  }
  static const uint32_t inner[4][3] = {{3, 0, 2}, {4, 2, 1}, {5, 1, 3}, {2, 3, 0}};
  for (int i = 0; i < 4; i++) /* seen from the first cell, 0 1 p turn counter-clockwise */
    add_facet(model, id[0], id[1], id[inner[i][0]], cell[inner[i][2]], cell[inner[i][1]]);
  model->arrays.tet_count = 2;
  model->arrays.cell_count = 4;
  model->arrays.point_count = model->arrays.vertex_count = 6;
  model->arrays.points = model->arrays.vertices = m->positions;
  model->arrays.plane_count = 12;
  model->arrays.planes = model->planes;
  model->arrays.facet_planes = model->facet_planes;
  model->arrays.facet_cells = model->facet_cells;
  model->arrays.facet_starts = model->starts;
  model->arrays.facet_vertices = model->corners;
}

static cellist_result make_mesh(cellist_context *context, cellist_mesh **mesh) {
  const cellist_mesh_desc desc = {.point_count = 6, .positions = POINTS, .tet_count = 2, .tets = CELLS[0]};
  return cellist_mesh_create(context, &desc, mesh);
}

static cellist_result create_and_check(cellist_context *context, void *user) {
  (void)user;
  cellist_mesh *mesh = NULL;
  cellist_complex *complex = NULL;
  cellist_result result = make_mesh(context, &mesh);
  if (result != CELLIST_SUCCESS) return result;
  struct model model;
  build(&model, mesh);
  result = cellist_complex_create(context, &model.arrays, &complex);
  if (result == CELLIST_SUCCESS && !cellist_complex_is_valid(context, complex, mesh))
    result = CELLIST_ERROR_OUT_OF_MEMORY; /* the model is valid: only memory can fail here */
  cellist_complex_destroy(complex);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(a_sound_complex_is_valid)
{
  cellist_context *context = harness_context(1);
  assert_success(context, create_and_check(context, NULL));
  harness_context_destroy(context);
}

TEST(every_failed_allocation_is_reported)
{ check_allocation_failures(create_and_check, NULL); }

TEST(each_broken_promise_is_found)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, make_mesh(context, &mesh));
  static const char *const reason[] = {
      "corner leaves the plane", "too few facets", "not convex", "do not cover", "another mesh", "other coordinates"};
  for (int flaw = 0; flaw < 6; flaw++) {
    struct model model;
    build(&model, mesh);
    double moved[18];
    memcpy(moved, POINTS, sizeof moved);
    if (flaw == 0) {
      const uint32_t other = model.corners[0]; /* a corner of facet 0 that plane 1 does not hold */
      model.corners[3] = other;
    } else if (flaw == 1) {
      model.facet_cells[2 * 4 + 1] = model.facet_cells[2 * 6 + 1]; /* a hull facet of the other imaginary cell */
    } else if (flaw == 2) {
      for (int f = 4; f < 12; f++) /* all imaginary facets given to one cell: closed, yet not convex */
        for (int s = 0; s < 2; s++)
          if (model.facet_cells[2 * f + s] == 3) model.facet_cells[2 * f + s] = 2;
      model.arrays.cell_count = 3;
    } else if (flaw == 3) {
      model.facet_cells[1] = 1 - model.facet_cells[1]; /* the other tet's */
    } else if (flaw == 4) {
      model.arrays.tet_count = 1;
    } else {
      moved[0] += 1e-3;
      model.arrays.points = moved;
    }
    cellist_complex *complex = NULL;
    assert_success(context, cellist_complex_create(context, &model.arrays, &complex));
    assert_false(cellist_complex_is_valid(context, complex, mesh));
    const char *message = cellist_context_take_error(context);
    if (flaw == 2) /* the edge 0-1 is shared by four facets then */
      assert_true(strstr(message, "open edge") != NULL || strstr(message, "not convex") != NULL);
    else
      assert_non_null(strstr(message, reason[flaw]));
    cellist_complex_destroy(complex);
  }
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(ids_out_of_range_are_refused)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, make_mesh(context, &mesh));
  struct model model;
  cellist_complex *complex = NULL;
  build(&model, mesh);
  model.facet_planes[5] = 12;
  assert_failure(context, cellist_complex_create(context, &model.arrays, &complex), CELLIST_ERROR_INVALID_ARGUMENT,
                 "facet 5");
  build(&model, mesh);
  model.planes[4] = 6;
  assert_failure(context, cellist_complex_create(context, &model.arrays, &complex), CELLIST_ERROR_INVALID_ARGUMENT,
                 "plane 1");
  build(&model, mesh);
  model.corners[7] = 6;
  assert_failure(context, cellist_complex_create(context, &model.arrays, &complex), CELLIST_ERROR_INVALID_ARGUMENT,
                 "corner 7");
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
