/* SPDX-License-Identifier: BSD-3-Clause
 * Stability, pictures: every case of the table by every renderer, each within its limit of the reference. Prints the
 * table. A case that the table lists as failing may fail, but must be finite all the same. */
#include <stdio.h>

#include "harness.h"
#include "stability.h"

static void print(const stability_case *which, stability_renderer renderer, const stability_picture *found) {
  printf("%-22s %-6s %-8s rmse %.1e max %.1e of %.1e, %zu of %zu pixels over, bound %.0e, %.3f s %s\n", which->name,
         stability_renderer_name(renderer), stability_verdict_name(found->verdict), found->rmse, found->max,
         found->peak, found->over, found->covered, found->bound, found->seconds, found->message);
  fflush(stdout);
}

static void run(stability_group group, stability_renderer renderer) {
  size_t run = 0, failed = 0;
  for (size_t i = 0; stability_case_at(i) != NULL; i++) {
    const stability_case *which = stability_case_at(i);
    if (which->group != group) continue;
    cellist_context *context = harness_context(2);
    stability_scene scene;
    stability_picture found;
    assert_success(context, stability_build(context, which, &scene));
    assert_success(context, stability_draw(context, which, &scene, renderer, &found));
    print(which, renderer, &found);
    run++;
    failed += found.verdict == STABILITY_FAILS;
    stability_scene_release(&scene);
    harness_context_destroy(context);
  }
  assert_true(run > 5);
  if (failed > 0) fail_msg("%zu of %zu cases fail", failed, run);
}

TEST(stiff_by_cast)
{ run(STABILITY_STIFF, STABILITY_CAST); }
TEST(stiff_by_soft)
{ run(STABILITY_STIFF, STABILITY_SOFT); }
TEST(stiff_by_faces)
{ run(STABILITY_STIFF, STABILITY_FACES); }
TEST(stiff_by_fan)
{ run(STABILITY_STIFF, STABILITY_FAN); }
TEST(shapes_by_cast)
{ run(STABILITY_SHAPE, STABILITY_CAST); }
TEST(shapes_by_soft)
{ run(STABILITY_SHAPE, STABILITY_SOFT); }
TEST(shapes_by_faces)
{ run(STABILITY_SHAPE, STABILITY_FACES); }
TEST(shapes_by_fan)
{ run(STABILITY_SHAPE, STABILITY_FAN); }
TEST(frames_by_cast)
{ run(STABILITY_FRAME, STABILITY_CAST); }
TEST(frames_by_soft)
{ run(STABILITY_FRAME, STABILITY_SOFT); }
TEST(frames_by_faces)
{ run(STABILITY_FRAME, STABILITY_FACES); }
TEST(frames_by_fan)
{ run(STABILITY_FRAME, STABILITY_FAN); }
TEST(views_by_cast)
{ run(STABILITY_VIEW, STABILITY_CAST); }
TEST(views_by_soft)
{ run(STABILITY_VIEW, STABILITY_SOFT); }
TEST(views_by_faces)
{ run(STABILITY_VIEW, STABILITY_FACES); }
TEST(views_by_fan)
{ run(STABILITY_VIEW, STABILITY_FAN); }
