/* SPDX-License-Identifier: BSD-3-Clause
 * Frames: far from the origin and at any scale a sound complex is valid, and a damaged one is not. */
#include <cellist/convexify.h>
#include <cellist/generate.h>
#include <string.h>

#include "check_faults.h"

typedef struct frame {
  double scale, offset[3];
} frame;

/* Coordinates at 1e12 are multiples of 2^-13: the features there are some thousand of these, or hundreds. */
static const frame FRAMES[] = {
    {1, {0, 0, 0}},    {1, {1e12, -1e12, 1e12}}, {0.03, {0, 1e12, 0}}, {1e-3, {1e7, -1e7, 1e7}}, {1e-20, {0, 0, 0}},
    {1e20, {0, 0, 0}}, {1e-100, {0, 0, 0}},      {1e100, {0, 0, 0}},   {1e-20, {1e-8, 0, 0}},    {1e20, {0, -1e32, 0}},
};
enum { FRAME_COUNT = sizeof FRAMES / sizeof FRAMES[0] };

static cellist_mesh *framed(cellist_context *context, const char *name, size_t size, const frame *f) {
  const cellist_generate_desc generate = {.size = size};
  cellist_mesh *mesh = NULL, *moved = NULL;
  assert_success(context, cellist_generate(context, name, &generate, &mesh));
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  double *points = malloc(3 * a->point_count * sizeof *points);
  for (size_t i = 0; i < 3 * a->point_count; i++) points[i] = f->offset[i % 3] + f->scale * a->positions[i];
  const cellist_mesh_desc desc = {
      .point_count = a->point_count, .positions = points, .tet_count = a->tet_count, .tets = a->tets};
  assert_success(context, cellist_mesh_create(context, &desc, &moved));
  free(points);
  cellist_mesh_destroy(mesh);
  return moved;
}

static cellist_complex *convexified(cellist_context *context, const cellist_mesh *mesh, cellist_exterior exterior) {
  const cellist_convexify_desc desc = {.exterior = exterior, .seed = 1};
  cellist_complex *complex = NULL;
  cellist_convexify_stats stats;
  assert_success(context, cellist_convexify(context, mesh, &desc, &complex, &stats));
  assert_true(stats.volume_error <= 1e-12);
  assert_int_equal(stats.convexity_violations, 0);
  return complex;
}

TEST(a_sound_complex_is_valid_in_any_frame)
{
  static const char *const names[] = {"l-shape", "gears", "swiss-cheese"};
  cellist_context *context = harness_context(1);
  for (int n = 0; n < 3; n++)
    for (int i = 0; i < FRAME_COUNT; i++)
      for (int exterior = 0; exterior < (i == 1 || i == 3 ? 4 : 1); exterior++) {
        cellist_mesh *mesh = framed(context, names[n], 300, &FRAMES[i]);
        cellist_complex *complex = convexified(context, mesh, (cellist_exterior)exterior);
        if (!cellist_complex_is_valid(context, complex, mesh))
          fail_msg("%s in frame %d, exterior %d: %s", names[n], i, exterior, cellist_context_take_error(context));
        check_faults(complex, mesh, 5, 1);
        cellist_complex_destroy(complex);
        cellist_mesh_destroy(mesh);
      }
  harness_context_destroy(context);
}

enum { BEND, SWAP_TETS, LOSE_FACET, TURN_FACET, UNITE, DAMAGES };

/* Damages the facet; false: it is none that this damage suits. */
static bool damage(cellist_complex_arrays *a, int kind, size_t facet, double extent, double *vertices, uint32_t *cells,
                   uint32_t *starts) {
  uint32_t *own = &cells[2 * facet];
  const bool imaginary[2] = {own[0] != CELLIST_NONE && own[0] >= a->tet_count,
                             own[1] != CELLIST_NONE && own[1] >= a->tet_count};
  switch (kind) {
    case BEND: { /* a corner moves a twentieth of the mesh */
      double *p = &vertices[3 * (size_t)a->facet_vertices[a->facet_starts[facet]]];
      for (int k = 0; k < 3; k++) p[k] += 0.05 * extent * (k + 1);
      return true;
    }
    case SWAP_TETS: { /* it becomes another tet's */
      const int side = own[0] < a->tet_count ? 0 : 1;
      if (own[side] >= a->tet_count) return false;
      own[side] = own[side] > 0 ? own[side] - 1 : 1;
      return true;
    }
    case LOSE_FACET: /* the last one is not there */
      if (facet + 1 != a->facet_count) return false;
      a->facet_count--;
      starts[a->facet_count] = a->facet_starts[facet];
      return true;
    case TURN_FACET: { /* its sides change places */
      const uint32_t swap = own[0];
      own[0] = own[1];
      own[1] = swap;
      return true;
    }
    default: /* two imaginary cells become one, which is not convex, or one too few */
      if (!imaginary[0] || !imaginary[1]) return false;
      for (size_t i = 0; i < 2 * a->facet_count; i++)
        if (cells[i] == own[1] && i / 2 != facet) cells[i] = own[0];
      own[1] = CELLIST_NONE;
      return true;
  }
}

TEST(a_damaged_complex_is_not_valid_in_any_frame)
{
  cellist_context *context = harness_context(1);
  random_state random = {11};
  size_t tried[DAMAGES] = {0}, seen = 0;
  for (int i = 0; i < FRAME_COUNT; i++) {
    cellist_mesh *mesh = framed(context, "gears", 300, &FRAMES[i]);
    cellist_complex *complex = convexified(context, mesh, CELLIST_EXTERIOR_HULL);
    const cellist_complex_arrays *sound = cellist_complex_get_arrays(complex);
    const double *bounds = cellist_mesh_get_arrays(mesh)->bounds;
    const double extent = bounds[3] - bounds[0];
    const size_t sizes[] = {3 * sound->vertex_count * sizeof(double), 2 * sound->facet_count * sizeof(uint32_t),
                            (sound->facet_count + 1) * sizeof(uint32_t)};
    double *vertices = malloc(sizes[0]);
    uint32_t *cells = malloc(sizes[1]), *starts = malloc(sizes[2]);
    for (int kind = 0; kind < DAMAGES; kind++)
      for (int draw = 0; draw < 12; draw++) {
        cellist_complex_arrays a = *sound;
        memcpy(vertices, sound->vertices, sizes[0]);
        memcpy(cells, sound->facet_cells, sizes[1]);
        memcpy(starts, sound->facet_starts, sizes[2]);
        const size_t facet =
            kind == LOSE_FACET ? sound->facet_count - 1 : (size_t)random_below(&random, sound->facet_count);
        a.vertices = vertices;
        a.facet_cells = cells;
        a.facet_starts = starts;
        if (!damage(&a, kind, facet, extent, vertices, cells, starts)) continue;
        tried[kind]++;
        cellist_complex *bad = NULL;
        assert_success(context, cellist_complex_create(context, &a, &bad));
        if (cellist_complex_is_valid(context, bad, mesh))
          fail_msg("damage %d of facet %zu in frame %d is not seen", kind, facet, i);
        cellist_context_take_error(context);
        /* What the oracle counts, it sees too. */
        if (kind == LOSE_FACET || kind == TURN_FACET) assert_true(count_facet_faults(bad, mesh) > 0);
        if (kind == UNITE) {
          const ray_faults faults = count_ray_faults(bad, mesh, 20, (uint64_t)draw);
          seen += faults.gaps + faults.overlaps;
        }
        cellist_complex_destroy(bad);
      }
    free(vertices);
    free(cells);
    free(starts);
    cellist_complex_destroy(complex);
    cellist_mesh_destroy(mesh);
  }
  assert_true(seen > tried[UNITE]);
  for (int kind = 0; kind < DAMAGES; kind++)
    if (tried[kind] < FRAME_COUNT) fail_msg("damage %d tried %zu times", kind, tried[kind]);
  harness_context_destroy(context);
}
