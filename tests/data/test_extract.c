/* SPDX-License-Identifier: BSD-3-Clause
 * Extract: a part of a mesh is what the same tets make as a mesh of their own. */
#include <cellist/mesh.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"

enum { N = 6, POINTS = (N + 1) * (N + 1) * (N + 1), TETS = 6 * N * N * N };

/* Six tets to each of N^3 cubes (Kuhn), points moved a little. */
static cellist_mesh *make_grid(cellist_context *context, random_state *random) {
  static const uint8_t path[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  static double points[3 * POINTS];
  static uint32_t tets[4 * TETS];
  const uint32_t step[3] = {1, N + 1, (N + 1) * (N + 1)};
  for (uint32_t i = 0; i < POINTS; i++)
    for (uint32_t k = 0; k < 3; k++) points[3 * i + k] = i / step[k] % (N + 1) + random_between(random, -0.1, 0.1);
  for (uint32_t t = 0; t < TETS; t++) {
    const uint32_t cube = t / 6;
    uint32_t at = cube % N * step[0] + cube / N % N * step[1] + cube / N / N * step[2];
    for (uint32_t c = 0; c < 4; c++) {
      tets[4 * t + c] = at;
      if (c < 3) at += step[path[t % 6][c]];
    }
  }
  const cellist_mesh_desc desc = {.point_count = POINTS, .positions = points, .tet_count = TETS, .tets = tets};
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_create(context, &desc, &mesh));
  return mesh;
}

TEST(a_part_is_the_mesh_of_its_tets)
{
  cellist_context *context = harness_context(2);
  random_state random = {11};
  cellist_mesh *whole = make_grid(context, &random);
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(whole);
  for (int round = 0; round < 8; round++) {
    static uint8_t keep[TETS];
    const uint32_t percent = round == 0 ? 0 : round == 1 ? 100 : random_below(&random, 100);
    size_t kept = 0;
    for (size_t i = 0; i < TETS; i++) kept += keep[i] = random_below(&random, 100) < percent;
    cellist_mesh *part = NULL;
    uint32_t *points = NULL, *tets = NULL;
    assert_success(context, cellist_mesh_extract(context, whole, keep, &part, &points, &tets));
    const cellist_mesh_arrays *b = cellist_mesh_get_arrays(part);
    assert_int_equal(b->tet_count, kept);

    /* The same tets as a mesh of their own, told apart by their origin. */
    uint32_t *chosen = malloc(4 * kept * sizeof *chosen + 1), *origin = malloc(kept * sizeof *origin + 1);
    static uint32_t rank[TETS]; /* of a tet of the user's, in the mesh made anew */
    size_t count = 0;
    for (size_t i = 0; i < TETS; i++) {
      if (!keep[i]) continue;
      memcpy(&chosen[4 * count], &a->tets[4 * i], 4 * sizeof *chosen);
      origin[count++] = a->tet_origin[i];
    }
    const cellist_mesh_desc desc = {a->point_count, a->positions, kept, chosen, origin, 0, NULL};
    cellist_mesh *anew = NULL;
    assert_success(context, cellist_mesh_create(context, &desc, &anew));
    const cellist_mesh_arrays *c = cellist_mesh_get_arrays(anew);
    assert_int_equal(cellist_mesh_get_facts(part)->boundary_face_count,
                     cellist_mesh_get_facts(anew)->boundary_face_count);
    for (uint32_t i = 0; i < kept; i++) rank[c->tet_origin[i]] = i;
    for (size_t i = 0; i < kept; i++) {
      const uint32_t old = tets[i];
      assert_true(keep[old] && (i == 0 || old > tets[i - 1]));
      assert_int_equal(b->tet_origin[i], a->tet_origin[old]);
      assert_int_equal(b->tet_flags[i], a->tet_flags[old]);
      uint32_t around_part = 0,
               around_anew = 0; /* sums of 1 + the neighbours' origins: the corners' order may differ */
      for (size_t k = 0; k < 4; k++) {
        assert_int_equal(points[b->tets[4 * i + k]], a->tets[4 * old + k]);
        assert_memory_equal(&b->positions[3 * (size_t)b->tets[4 * i + k]],
                            &a->positions[3 * (size_t)a->tets[4 * old + k]], 3 * sizeof(double));
        const uint32_t n = b->neighbours[4 * i + k], m = c->neighbours[4 * (size_t)rank[b->tet_origin[i]] + k];
        around_part += n == CELLIST_NONE ? 0 : 1 + b->tet_origin[n];
        around_anew += m == CELLIST_NONE ? 0 : 1 + c->tet_origin[m];
      }
      assert_int_equal(around_part, around_anew);
    }
    assert_memory_equal(b->bounds, c->bounds, sizeof b->bounds);
    free(chosen);
    free(origin);
    cellist_deallocate(context, points);
    cellist_deallocate(context, tets);
    cellist_mesh_destroy(part);
    cellist_mesh_destroy(anew);
  }
  cellist_mesh_destroy(whole);
  harness_context_destroy(context);
}

static cellist_result extract_all(cellist_context *context, void *user) {
  static uint8_t keep[2] = {1, 0};
  static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1};
  static const uint32_t tets[] = {0, 1, 2, 3, 0, 2, 1, 4};
  const cellist_mesh_desc desc = {.point_count = 5, .positions = points, .tet_count = 2, .tets = tets};
  cellist_mesh *mesh = NULL, *part = NULL;
  uint32_t *ids = NULL;
  (void)user;
  cellist_result result = cellist_mesh_create(context, &desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_mesh_extract(context, mesh, keep, &part, &ids, NULL);
  cellist_deallocate(context, ids);
  cellist_mesh_destroy(part);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(failed_allocations_leak_nothing)
{ check_allocation_failures(extract_all, NULL); }
