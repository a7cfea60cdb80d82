/* SPDX-License-Identifier: BSD-3-Clause
 * The fast caster against the reference on real meshes: cli.md's view and transfer functions. */
#include <cellist/raycast.h>
#include <math.h>
#include <stdlib.h>

#include "harness.h"

enum { SIZE = 64 };

/* The limit that holds for every sound mesh; rmse over covered pixels, linear premultiplied RGBA. */
static const double LIMIT = 2e-4;

static double rmse_of(cellist_raycaster *caster, cellist_context *context, const cellist_frame *frame,
                      const cellist_transfer *transfer) {
  const size_t count = (size_t)4 * SIZE * SIZE;
  double *rgba[2], sum = 0;
  size_t covered = 0;
  for (int i = 0; i < 2; i++) {
    rgba[i] = malloc(count * sizeof **rgba);
    const cellist_raycast_desc desc = {.precision = i ? CELLIST_PRECISION_REFERENCE : CELLIST_PRECISION_FAST};
    const cellist_raycast_output output = {.rgba = rgba[i]};
    assert_success(context, cellist_raycaster_render(caster, frame, transfer, &desc, &output, NULL));
  }
  for (size_t i = 0; i < count; i++) {
    sum += (rgba[0][i] - rgba[1][i]) * (rgba[0][i] - rgba[1][i]);
    covered += i % 4 == 3 && (rgba[0][i] > 0 || rgba[1][i] > 0);
  }
  for (int i = 0; i < 2; i++) free(rgba[i]);
  assert_true(covered > 100);
  return sqrt(sum / (4 * (double)covered));
}

static void check_mesh(const char *name) {
  const char *path = shared_data(name);
  cellist_context *context = harness_context(2);
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar;
  cellist_raycaster *caster = NULL;
  assert_success(context, cellist_mesh_read(context, path, NULL, &mesh));
  assert_success(context, cellist_scalar_select(context, mesh, NULL, &scalar));
  assert_success(context, cellist_raycaster_create(context, mesh, &scalar, NULL, &caster));
  const double *bounds = cellist_mesh_get_arrays(mesh)->bounds;
  const double diagonal = hypot(hypot(bounds[3] - bounds[0], bounds[4] - bounds[1]), bounds[5] - bounds[2]);
  const cellist_view view = cellist_view_orbit(bounds, 30.96, 34.45);
  cellist_frame frame;
  assert_success(context, cellist_frame_from_view(context, &view, SIZE, SIZE, &frame));
  const char *const sources[] = {"ramp", "dense", "spikes"};
  for (int i = 0; i < 3; i++) {
    const cellist_transfer_desc desc = {
        .source = sources[i], .range = {scalar.minimum, scalar.maximum}, .unit_distance = diagonal / 50};
    cellist_transfer transfer;
    assert_success(context, cellist_transfer_load(context, &desc, &transfer));
    const double rmse = rmse_of(caster, context, &frame, &transfer);
    if (!(rmse < LIMIT)) fail_msg("%s with %s: rmse %.3g", name, sources[i], rmse);
    cellist_transfer_release(context, &transfer);
  }
  cellist_raycaster_destroy(caster);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

TEST(spx)
{ check_mesh("spx.vtu"); }
TEST(bluntfin)
{ check_mesh("bluntfin.vtu"); }
TEST(post)
{ check_mesh("post.vtu"); }
TEST(impeller)
{ check_mesh("impeller.vtu"); }
TEST(sci_torso)
{ check_mesh("sci_torso.vtu"); }
TEST(gears_t)
{ check_mesh("gears_t.vtu"); }
TEST(disk_out_ref)
{ check_mesh("disk_out_ref.vtu"); }
TEST(fire)
{ check_mesh("fire.vtu"); }
TEST(bunny_in)
{ check_mesh("bunny_in.vtu"); }
TEST(octopus_low)
{ check_mesh("octopus_low.vtu"); }
TEST(torus_vt)
{ check_mesh("torus_vt.vtu"); }
TEST(bucky)
{ check_mesh("bucky.vtu"); }
