/* SPDX-License-Identifier: BSD-3-Clause
 * Convexify: paper [C] section 6 from end to end. Where it differs: no epsilon anywhere (vertices are exact meets, not
 * moved onto planes), parts are told by what encloses them, not by connectivity alone, facets stay conforming, cutting
 * planes may also pass through two reflex edges, and neighbours whose union is convex are joined again. */
#include <cellist/convexify.h>

#include "work.h"

/* The volumes must agree to this fraction of the hull. Every decision before is exact, so a larger difference means an
 * input that deceived all checks (solids inside solids, say); a smaller limit would trip over rounding in sums. */
static const double VOLUME_TOLERANCE = 1e-9;

cellist_convexify_desc cellist_convexify_desc_default(void) { return (cellist_convexify_desc){.candidates = 20}; }

void work_release(work *w) {
  cellist_context *context = w->context;
  delaunay_release_work(w);
  for (size_t p = 0; p < w->pieces.count; p++) {
    set_release(w, &w->pieces.items[p].members);
    set_release(w, &w->pieces.items[p].reflex);
    set_release(w, &w->pieces.items[p].flat);
    cellist_deallocate(context, w->pieces.items[p].shells.items);
  }
  void *blocks[] = {w->limbs.items,        w->planes.items,       w->vertices.items,
                    w->offsets.items,      w->added_points.items, w->point_vertex.items,
                    w->boundary.items,     w->contacts.items,     w->hull.items,
                    w->edges.items,        w->uses.items,         w->facets.items,
                    w->pieces.items,       w->edge_table.items,   w->input_reflex_start.items,
                    w->input_reflex.items, w->touched.items,      w->ids.items,
                    w->split.items,        w->on_plane.items,     w->zeros.items,
                    w->near.items,         w->set_order.items,    w->set_boxes.items,
                    w->events.items,       w->cap_uses.items,     w->cap_loops.items,
                    w->cap_facets.items,   w->components.items,   w->nodes.items,
                    w->parts.items,        w->sorted.items,       w->hits.items,
                    w->box_scratch.items,  w->node_scratch.items, w->sides.on.items,
                    w->sides.start.items,  w->sides.chain.items,  w->sides.by_plane.items,
                    w->block_scratch,      w->side_scratch,       w->out.points.items,
                    w->out.vertices.items, w->out.planes.items,   w->out.facet_planes.items,
                    w->out.cells.items,    w->out.starts.items,   w->out.corners.items};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) cellist_deallocate(context, blocks[i]);
  cellist_deallocate(context, w);
}

void work_progress(work *w, int from, int to, double fraction) {
  const double reached = from + (to - from) * fmin(fmax(fraction, 0), 1);
  if (reached > w->progress) w->progress = reached;
  if (cellist_progress(w->context, "convexifying", w->progress / PROGRESS_END) != CELLIST_SUCCESS)
    work_fail(w, CELLIST_ERROR_CANCELLED);
}

static void make(work *w, cellist_complex **complex) {
  work_progress(w, PROGRESS_BOUNDARY, PROGRESS_CUT, 0);
  boundary_gather(w);
  if (w->boundary.count > 0) {
    boundary_check_embedded(w);
    if (w->desc.exterior == CELLIST_EXTERIOR_BOX)
      box_gather(w);
    else
      hull_gather(w);
    work_progress(w, PROGRESS_BOUNDARY, PROGRESS_CUT, 1);
    const bool delaunay = w->desc.exterior == CELLIST_EXTERIOR_DELAUNAY;
    if (!delaunay || !delaunay_build(w)) {
      if (delaunay) w->stats.exterior = CELLIST_EXTERIOR_HULL;
      exterior_build(w);
      if (w->desc.exterior == CELLIST_EXTERIOR_GRID) pieces_cut_by_grid(w);
      pieces_cut_all(w);
      /* A grid's cells are compact on purpose. */
      if (!w->desc.keep_unmerged && w->desc.exterior != CELLIST_EXTERIOR_GRID) pieces_merge(w);
    }
  }
  work_progress(w, PROGRESS_MERGE, PROGRESS_FINISH, 1);
  finish(w, complex);
  if (w->stats.volume_error <= VOLUME_TOLERANCE && w->stats.convexity_violations == 0) {
    if (cellist_progress(w->context, "convexifying", 1) == CELLIST_SUCCESS) return;
    cellist_complex_destroy(*complex);
    *complex = NULL;
    work_fail(w, CELLIST_ERROR_CANCELLED);
  }
  cellist_complex_destroy(*complex);
  *complex = NULL;
  work_stop(w, CELLIST_ERROR_GEOMETRY,
            "the mesh does not fill the volume that its boundary encloses (its tets overlap): off by %g of the hull",
            w->stats.volume_error);
}

static cellist_result attempt(cellist_context *context, const cellist_mesh *mesh, const cellist_convexify_desc *desc,
                              cellist_complex **complex, cellist_convexify_stats *stats, bool *retry) {
  work *w = cellist_allocate_zeroed(context, 1, sizeof *w);
  if (w == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  w->context = context;
  w->mesh = cellist_mesh_get_arrays(mesh);
  w->desc = *desc;
  w->random.state = w->desc.seed;
  w->flat = w->desc.flat_degrees * (PI / 180);
  w->stats.exterior = w->desc.exterior;
  cellist_complex *made = NULL;
  cellist_complex **target = &made;
  if (setjmp(w->failed) == 0) {
    make(w, target);
    *complex = made;
    *stats = w->stats;
  }
  const cellist_result result = w->result;
  *retry = w->retry_without_it;
  work_release(w);
  return result;
}

cellist_result cellist_convexify(cellist_context *context, const cellist_mesh *mesh, const cellist_convexify_desc *desc,
                                 cellist_complex **complex, cellist_convexify_stats *stats) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || complex == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_convexify: mesh or complex is NULL");
  cellist_convexify_desc own = desc != NULL ? *desc : cellist_convexify_desc_default();
  if (!(own.flat_degrees >= 0 && own.flat_degrees < 90))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "cellist_convexify: edges of %g degrees cannot count as flat (0 to below 90)",
                        own.flat_degrees);
  cellist_convexify_stats made;
  bool retry = false;
  cellist_result result = attempt(context, mesh, &own, complex, &made, &retry);
  if (retry) {
    cellist_log(context, CELLIST_LOG_WARNING,
                "edges of %g degrees are not left flat: cells would meet in facets with holes", own.flat_degrees);
    own.flat_degrees = 0;
    result = attempt(context, mesh, &own, complex, &made, &retry);
  }
  if (result == CELLIST_SUCCESS && stats != NULL) *stats = made;
  return result;
}
