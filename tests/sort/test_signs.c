/* SPDX-License-Identifier: BSD-3-Clause
 * Signs: every kernel gives the same bits, and states are those that exact predicates give. */
#include "../../sort/arcs.h"
#include "../../sort/signs/signs.h"
#include "../../sort/state.h"

#include "scene.h"

TEST(kernels_agree_bit_by_bit)
{
  if (!sort_has_avx2()) SKIP("this machine has no AVX2");
  enum { GROUPS = 500 };
  random_state random = {11};
  int16_t planes[64 * GROUPS];
  uint16_t inner[GROUPS], undecided[2][GROUPS];
  uint8_t states[2][4 * GROUPS], mirrored[2][4 * GROUPS];
  for (int round = 0; round < 40; round++) {
    /* Lengths up to 2^14.9, as the sorter's; small ones too, so that many are undecided. */
    const double reach = round % 4 == 0 ? 16000 : round % 4 == 1 ? 300 : round % 4 == 2 ? 3 : 1000;
    int16_t eye[4];
    for (int i = 0; i < 4; i++) eye[i] = (int16_t)(16000 * oracle_random(&random));
    for (int i = 0; i < 64 * GROUPS; i++) planes[i] = (int16_t)(reach * oracle_random(&random));
    for (int i = 0; i < GROUPS; i++) inner[i] = (uint16_t)random_bits(&random);
    const int32_t doubt = round % 2 == 0 ? 60000 : 3;
    sort_signs_portable(planes, inner, eye, doubt, GROUPS, states[0], mirrored[0], undecided[0]);
    sort_signs_avx2(planes, inner, eye, doubt, GROUPS, states[1], mirrored[1], undecided[1]);
    assert_memory_equal(states[0], states[1], sizeof states[0]);
    assert_memory_equal(mirrored[0], mirrored[1], sizeof mirrored[0]);
    assert_memory_equal(undecided[0], undecided[1], sizeof undecided[0]);
  }
}

TEST(arc_kernels_agree_and_list_the_faces_in_front)
{
  if (!sort_has_avx2()) SKIP("this machine has no AVX2");
  enum { TETS = 1000, BATCH = 64 };
  random_state random = {12};
  uint32_t neighbours[4 * TETS], tets[BATCH], arcs[2][4 * BATCH + 4], seen[2];
  uint8_t cell_states[TETS];
  for (int i = 0; i < 4 * TETS; i++) neighbours[i] = random_below(&random, 9) == 0 ? CELLIST_NONE : (uint32_t)i;
  for (int i = 0; i < TETS; i++) cell_states[i] = (uint8_t)random_bits(&random);
  for (int round = 0; round < 300; round++) {
    const size_t count = random_below(&random, BATCH + 1);
    for (size_t i = 0; i < count; i++) tets[i] = (uint32_t)random_below(&random, TETS);
    const size_t arc_count = sort_list_arcs_portable(neighbours, cell_states, tets, count, tets, arcs[0], &seen[0]);
    assert_int_equal(sort_list_arcs_avx2(neighbours, cell_states, tets, count, tets, arcs[1], &seen[1]), arc_count);
    assert_int_equal(seen[0], seen[1]);
    size_t expected = 0;
    uint32_t all = 0;
    for (size_t i = 0; i < count; i++) {
      all |= cell_states[tets[i]];
      for (unsigned k = 0; k < 4; k++) {
        if ((cell_states[tets[i]] >> k & 1) == 0) continue;
        assert_int_equal(arcs[0][expected], neighbours[4 * tets[i] + k]);
        assert_int_equal(arcs[1][expected++], neighbours[4 * tets[i] + k]);
      }
    }
    assert_int_equal(expected, arc_count);
    assert_int_equal(all, seen[0]);
  }
}

/* Points of a grid, stretched, shifted and scaled, so that planes lose digits in several ways. */
static void check_states(cellist_context *context, uint64_t seed, double scale, double shift, double flatten) {
  cellist_mesh *mesh = scene_grid(context, 4, seed % 2 ? 0.1 : 0, 0.2, seed);
  const cellist_sorter_desc from = sorter_desc_of(mesh);
  double *points = calloc(3 * from.point_count, sizeof *points);
  for (size_t i = 0; i < 3 * from.point_count; i++)
    points[i] = scale * (from.points[i] * (i % 3 == 2 ? flatten : 1) + shift);
  cellist_sorter_desc desc = from;
  desc.points = points;
  const sort_cells cells = sort_cells_of_mesh(&desc);
  sort_planes planes = {0};
  assert_success(context, sort_planes_create(context, &cells, &planes));
  uint8_t *states = calloc(4 * planes.group_count, 1);
  for (unsigned kind = 0; kind < 24; kind++) {
    random_state random = {kind};
    cellist_viewpoint view = scene_view(kind, 4, &random);
    for (int k = 0; k < 3 && !view.parallel; k++) view.position[k] = scale * (view.position[k] + shift);
    const sort_eye eye = sort_eye_of(&view);
    for (int portable = 0; portable < 2; portable++) {
      if (portable) planes.kernel = sort_signs_portable;
      sort_planes_find_states(context, &cells, &planes, &eye, states, NULL);
      for (size_t tet = 0; tet < desc.tet_count; tet++) {
        unsigned state = SORT_READY;
        for (size_t k = 0; k < 4; k++) {
          if (desc.neighbours[4 * tet + k] == CELLIST_NONE) continue;
          const double *p[3];
          for (int c = 0; c < 3; c++) p[c] = &points[3 * desc.tets[4 * tet + SORT_TET_FACE[k][c]]];
          const int side = sort_eye_side(&eye, p[0], p[1], p[2]);
          state += side > 0 ? 1u << k : side < 0 ? SORT_WAIT : 0;
        }
        assert_int_equal(states[tet], state % 256);
      }
    }
  }
  free(states);
  free(points);
  sort_planes_release(context, &planes);
  cellist_mesh_destroy(mesh);
}

TEST(states_are_exact_for_coordinates_of_any_size_and_shape)
{
  cellist_context *context = harness_context(1);
  for (uint64_t seed = 0; seed < 4; seed++) {
    check_states(context, seed, 1, 0, 1);
    check_states(context, seed, 1.0 / 3, 1e6 / 7, 1);
    check_states(context, seed, 1, 0.1, 1e-7);
    check_states(context, seed, 1e-160, 0, 1);
    check_states(context, seed, 1e150, 3, 1);
  }
  harness_context_destroy(context);
}

/* A view along an axis looks along two faces of each tet of a grid; they are known to be in line with it. */
TEST(views_along_the_axes_of_a_grid_need_no_exact_tests)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 6, 0, 0.2, 1);
  const cellist_sorter_desc from = sorter_desc_of(mesh);
  double *points = calloc(3 * from.point_count, sizeof *points);
  for (size_t i = 0; i < 3 * from.point_count; i++) points[i] = from.points[i] / 3 - 0.7; /* rounded */
  cellist_sorter_desc desc = from;
  desc.points = points;
  cellist_sorter *sorter = NULL;
  assert_success(context, cellist_sorter_create(context, &desc, &sorter));
  uint32_t *order = calloc(desc.tet_count, sizeof *order);
  for (int k = 0; k < 6; k++) {
    cellist_viewpoint view = {{0, 0, 0}, true};
    view.position[k / 2] = k % 2 ? 1 : -3;
    cellist_sort_stats stats;
    assert_success(context, cellist_sorter_sort(sorter, &view, order, &stats));
    assert_int_equal(stats.exact_sign_count, 0);
    assert_int_equal(oracle_check(&desc, &view, order, NULL, 0, 40, 5).inversions, 0);
  }
  free(order);
  free(points);
  cellist_sorter_destroy(sorter);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
