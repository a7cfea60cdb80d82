/* SPDX-License-Identifier: BSD-3-Clause
 * Ends: a topological sort from both ends puts out what a plain one does, whatever the parting and the graph. */
#include "../../sort/mpvo.h"
#include "scene.h"

/* Cells with ranks; each face's arc leads from the lower rank to the higher one, but `turned` of them the other way
 * round, and `flat` of them nowhere. is_behind[4 cell + k]: the arc there leads to the cell. */
static void make_graph(const sort_cells *cells, random_state *random, double turned, double flat, uint8_t *is_front,
                       uint8_t *is_behind) {
  uint64_t *ranks = calloc(cells->count, sizeof *ranks);
  for (size_t i = 0; i < cells->count; i++) ranks[i] = random_bits(random) % 4 == 0 ? random_bits(random) : i << 53;
  memset(is_front, 0, 4 * cells->count);
  memset(is_behind, 0, 4 * cells->count);
  for (uint32_t i = 0; i < 4 * cells->count; i++) {
    const uint32_t other = cells->neighbours[i];
    if (other == CELLIST_NONE || other < i / 4 || random_unit(random) < flat) continue;
    uint32_t back = 0;
    while (cells->neighbours[4 * other + back] != i / 4) back++;
    const bool front = (ranks[i / 4] < ranks[other]) != (random_unit(random) < turned);
    (front ? is_front : is_behind)[i] = 1;
    (front ? is_behind : is_front)[4 * other + back] = 1;
  }
  free(ranks);
}

/* Checks that order[0..done) is what can come out, in an order that no arc contradicts. */
static void check_order(const sort_cells *cells, const uint8_t *is_behind, const uint32_t *order, size_t done) {
  uint8_t *is_out = calloc(cells->count, 1);
  for (size_t i = 0; i < done; i++) {
    assert_true(order[i] < cells->count && !is_out[order[i]]);
    for (uint32_t k = 0; k < 4; k++)
      if (is_behind[4 * order[i] + k]) assert_true(is_out[cells->neighbours[4 * order[i] + k]]);
    is_out[order[i]] = 1;
  }
  for (uint32_t i = 0; i < cells->count; i++) {
    bool waits = false;
    for (uint32_t k = 0; k < 4; k++) waits |= is_behind[4 * i + k] && !is_out[cells->neighbours[4 * i + k]];
    assert_true(is_out[i] || waits);
  }
  free(is_out);
}

TEST(both_ends_put_out_all_that_can_come_out)
{
  cellist_context *context = harness_context(2);
  size_t whole = 0, cyclic = 0;
  for (uint64_t seed = 0; seed < 60; seed++) {
    random_state random = {seed};
    cellist_mesh *mesh = scene_grid(context, 3 + (uint32_t)seed % 6, 0, 0.1, seed);
    const cellist_sorter_desc desc = sorter_desc_of(mesh);
    cellist_sorter sorter = {.context = context, .cells = sort_cells_of_mesh(&desc), .convex = true, .uses_ends = true};
    const sort_cells *cells = &sorter.cells;
    assert_success(context, sort_ends_create(context, cells, &sorter.ends));
    sorter.state = calloc(cells->count + 16, 1);
    uint8_t *is_front = calloc(cells->count, 4), *is_behind = calloc(cells->count, 4);
    uint32_t *order = calloc(cells->count, sizeof *order);
    static const double turned[] = {0, 0, 0.002, 0.02, 0.3};
    make_graph(cells, &random, turned[seed % 5], seed % 3 == 0 ? 0.2 : 0, is_front, is_behind);
    size_t near = 0;
    for (size_t block = 0; block < sorter.ends.block_count; block++) {
      const bool wanted = random_bits(&random) % 2 && near < sorter.ends.block_count / 2;
      sorter.ends.is_near[block] = wanted;
      near += wanted;
    }
    for (size_t i = 0; i < cells->count; i++) {
      const bool is_near = sorter.ends.is_near[i / SORT_BLOCK];
      unsigned plain = SORT_READY + (is_near ? SORT_WAIT : 0), mirrored = SORT_READY;
      for (size_t k = 0; k < 4; k++) {
        plain += ((unsigned)is_front[4 * i + k] << k) + SORT_WAIT * is_behind[4 * i + k];
        mirrored += ((unsigned)is_behind[4 * i + k] << k) + SORT_WAIT * is_front[4 * i + k];
      }
      sorter.state[i] = (uint8_t)plain;
      sorter.ends.mirrored[i] = (uint8_t)(is_near ? mirrored : SORT_HELD);
    }
    const size_t done = sort_topologically(&sorter, order);
    check_order(cells, is_behind, order, done);
    whole += done == cells->count;
    cyclic += done < cells->count;
    sort_ends_release(context, &sorter.ends);
    free(order);
    free(is_behind);
    free(is_front);
    free(sorter.state);
    cellist_mesh_destroy(mesh);
  }
  assert_true(whole > 10 && cyclic > 10);
  harness_context_destroy(context);
}

/* The parting of a view: about one half, the nearer one; none where nothing tells near from far. */
TEST(halves_are_parted_by_distance)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = scene_grid(context, 12, 0, 0, 1);
  const cellist_sorter_desc desc = sorter_desc_of(mesh);
  const sort_cells cells = sort_cells_of_mesh(&desc);
  sort_ends ends = {0};
  assert_success(context, sort_ends_create(context, &cells, &ends));
  for (unsigned kind = 0; kind < 24; kind++) {
    random_state random = {kind};
    const cellist_viewpoint view = scene_view(kind, 12, &random);
    const sort_eye eye = sort_eye_of(&view);
    sort_ends_choose(&ends, &eye);
    float nearest_far = HUGE_VALF, farthest_near = -HUGE_VALF;
    size_t near = 0;
    for (size_t i = 0; i < ends.block_count; i++) {
      near += ends.is_near[i];
      if (ends.is_near[i])
        farthest_near = fmaxf(farthest_near, ends.depths[i]);
      else
        nearest_far = fminf(nearest_far, ends.depths[i]);
    }
    assert_true(near <= ends.block_count / 2 && near > ends.block_count / 4);
    assert_true(farthest_near <= nearest_far);
  }
  const cellist_viewpoint vast = {{1e300, 0, 0}, false};
  const sort_eye eye = sort_eye_of(&vast);
  sort_ends_choose(&ends, &eye);
  for (size_t i = 0; i < ends.block_count; i++) assert_false(ends.is_near[i]);
  sort_ends_release(context, &ends);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
