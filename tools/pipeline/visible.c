/* SPDX-License-Identifier: BSD-3-Clause
 * Visible: which tets can show something, told from the range of their scalars alone, whatever the view.
 *
 * A tet's scalars fill the range between its least and its greatest corner. It shows nothing if that range misses the
 * support of the optics: where the extinction (and, for emission, the colour) is not 0, or the isosurfaces' values. The
 * support is kept closed, so a tet that merely touches it counts as visible: leaving the others out changes no pixel.
 */
#include <math.h>
#include <stdlib.h>

#include "pipeline.h"

typedef struct interval {
  double low, high;
} interval;

typedef struct support {
  interval *intervals; /* ascending, disjoint */
  size_t count;
} support;

static void add(support *s, double low, double high) {
  if (s->count > 0 && low <= s->intervals[s->count - 1].high)
    s->intervals[s->count - 1].high = fmax(high, s->intervals[s->count - 1].high);
  else
    s->intervals[s->count++] = (interval){low, high};
}

static bool shows(const cellist_transfer_knot *knot, cellist_model model) {
  return knot->extinction > 0 &&
         (model != CELLIST_MODEL_EMISSION || knot->colour[0] != 0 || knot->colour[1] != 0 || knot->colour[2] != 0);
}

static void add_transfer(support *s, const cellist_transfer *transfer, cellist_model model) {
  const cellist_transfer_knot *knots = transfer->knots;
  const size_t count = transfer->knot_count;
  if (shows(&knots[0], model)) add(s, -HUGE_VAL, knots[0].value);
  for (size_t i = 0; i + 1 < count; i++)
    if (shows(&knots[i], model) || shows(&knots[i + 1], model)) add(s, knots[i].value, knots[i + 1].value);
  if (shows(&knots[count - 1], model)) add(s, knots[count - 1].value, HUGE_VAL);
}

static int compare_lows(const void *a, const void *b) {
  const double x = ((const interval *)a)->low, y = ((const interval *)b)->low;
  return (x > y) - (x < y);
}

static void add_surfaces(support *s, const cellist_optics *model) {
  for (size_t i = 0; i < model->iso_count; i++)
    if (model->isos[i].opacity > 0) s->intervals[s->count++] = (interval){model->isos[i].value, model->isos[i].value};
  qsort(s->intervals, s->count, sizeof *s->intervals, compare_lows);
}

static bool meets(const support *s, double low, double high) {
  size_t begin = 0, end = s->count; /* the first interval that does not end below low */
  while (begin < end) {
    const size_t middle = begin + (end - begin) / 2;
    if (s->intervals[middle].high < low)
      begin = middle + 1;
    else
      end = middle;
  }
  return begin < s->count && s->intervals[begin].low <= high;
}

struct visible_job {
  const cellist_mesh_arrays *mesh;
  const cellist_scalar *scalar;
  const support *support;
  uint8_t *visible;
};

static void find_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct visible_job *job = user;
  const double *values = job->scalar->values;
  for (size_t i = begin; i < end; i++) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    bool finite = true;
    for (size_t k = 0; k < 4; k++) {
      const double value =
          values[job->scalar->association == CELLIST_ON_POINTS ? job->mesh->tets[4 * i + k] : (uint32_t)i];
      finite &= isfinite(value) != 0;
      low = fmin(low, value);
      high = fmax(high, value);
    }
    job->visible[i] = finite && (job->mesh->tet_flags[i] & CELLIST_TET_FLAT) == 0 && meets(job->support, low, high);
  }
}

cellist_result pipeline_find_visible(const cellist_pipeline *pipeline, uint8_t *visible, size_t *count) {
  const cellist_optics *model = &pipeline->desc.optics.model;
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(pipeline->mesh);
  support s = {
      cellist_allocate(pipeline->context, pipeline->transfer.knot_count + model->iso_count + 2, sizeof *s.intervals),
      0};
  if (s.intervals == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (model->model == CELLIST_MODEL_MAXIMUM)
    add(&s, -HUGE_VAL, HUGE_VAL); /* every cell counts, also without extinction */
  else if (model->model == CELLIST_MODEL_ISOSURFACES)
    add_surfaces(&s, model);
  else
    add_transfer(&s, &pipeline->transfer, model->model);
  struct visible_job job = {mesh, &pipeline->scalar, &s, visible};
  cellist_parallel_for(pipeline->context, mesh->tet_count, 8192, find_range, &job);
  cellist_deallocate(pipeline->context, s.intervals);
  *count = 0;
  for (size_t i = 0; i < mesh->tet_count; i++) *count += visible[i];
  return CELLIST_SUCCESS;
}

cellist_result pipeline_grow_visible(const cellist_pipeline *pipeline, uint8_t *visible, size_t *count) {
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(pipeline->mesh);
  uint8_t *marked = cellist_allocate_zeroed(pipeline->context, mesh->point_count, 1);
  if (marked == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < mesh->tet_count; i++)
    for (size_t k = 0; k < 4 && visible[i]; k++) marked[mesh->tets[4 * i + k]] = 1;
  for (size_t i = 0; i < mesh->tet_count; i++) {
    const uint32_t *v = &mesh->tets[4 * i];
    if (visible[i] || !(marked[v[0]] | marked[v[1]] | marked[v[2]] | marked[v[3]])) continue;
    visible[i] = 1;
    ++*count;
  }
  cellist_deallocate(pipeline->context, marked);
  return CELLIST_SUCCESS;
}
