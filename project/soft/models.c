/* SPDX-License-Identifier: BSD-3-Clause
 * Models: light and isosurfaces made ready for a frame's tiles. */
#include <math.h>
#include <surface/layer.h>

#include "scene.h"

/* Scaled scalars are rounded to some 1e-7: cells whose range comes this near to a surface are kept. */
static const double ISO_MARGIN = 1e-5;

static void sort_isos(soft_iso *isos, size_t count) {
  for (size_t i = 1; i < count; i++) {
    const soft_iso iso = isos[i];
    size_t j = i;
    for (; j > 0 && isos[j - 1].value > iso.value; j--) isos[j] = isos[j - 1];
    isos[j] = iso;
  }
}

static cellist_result make_isos(cellist_context *context, const cellist_optics *optics,
                                const cellist_transfer *transfer, const fast_transfer *table, soft_model *model) {
  model->isos = cellist_allocate(context, optics->iso_count, sizeof *model->isos);
  if (model->isos == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  model->iso_count = optics->iso_count;
  for (size_t i = 0; i < optics->iso_count; i++) {
    double colour[3];
    (void)cellist_transfer_evaluate(transfer, optics->isos[i].value, colour);
    model->isos[i] = (soft_iso){.value = fast_scalar(table, optics->isos[i].value),
                                .opacity = (float)optics->isos[i].opacity,
                                .colour = {(float)colour[0], (float)colour[1], (float)colour[2]}};
  }
  sort_isos(model->isos, model->iso_count);
  return CELLIST_SUCCESS;
}

static void turn(const cellist_frame *frame, const double world[3], double seen[3]) {
  const double *const axis[3] = {frame->right, frame->up, frame->forward};
  for (int k = 0; k < 3; k++) seen[k] = axis[k][0] * world[0] + axis[k][1] * world[1] + axis[k][2] * world[2];
}

struct turning {
  const cellist_frame *frame;
  const double *gradients;
  double factor;
  float (*made)[4];
};

static void turn_gradients(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct turning *turning = user;
  for (size_t i = begin; i < end; i++) {
    double seen[3];
    turn(turning->frame, &turning->gradients[3 * i], seen);
    for (int k = 0; k < 3; k++) turning->made[i][k] = (float)(seen[k] * turning->factor);
    turning->made[i][3] = 0;
  }
}

cellist_result soft_model_make(cellist_context *context, const cellist_optics *optics, const cellist_frame *frame,
                               const cellist_transfer *transfer, const fast_transfer *table, double unit,
                               const double *point_gradients, size_t point_count, soft_model *model) {
  const cellist_light *light = &optics->light;
  *model = (soft_model){.model = optics->model, .samples = optics->sample_count > 0 ? optics->sample_count : 1};
  if (optics->model == CELLIST_MODEL_ISOSURFACES) {
    const cellist_result result = make_isos(context, optics, transfer, table, model);
    if (result != CELLIST_SUCCESS) return result;
  }
  if (!light->enabled || optics->model == CELLIST_MODEL_ABSORPTION || optics->model == CELLIST_MODEL_MAXIMUM)
    return CELLIST_SUCCESS;
  const surface_light turned = surface_light_of(light, frame);
  turn(frame, turned.towards, model->light);
  turn(frame, turned.halfway, model->halfway);
  model->ambient = light->ambient;
  model->diffuse = light->diffuse;
  model->specular = light->specular;
  model->shininess = light->shininess;
  model->gradient_factor = 2 * table->scalar_half_range / unit / light->gradient_unit;
  model->gradients = point_gradients == NULL ? SOFT_CELL_GRADIENTS : SOFT_POINT_GRADIENTS;
  if (point_gradients == NULL) return CELLIST_SUCCESS;
  model->point_gradients = cellist_allocate(context, point_count, sizeof *model->point_gradients);
  if (model->point_gradients == NULL) {
    soft_model_release(context, model);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  struct turning turning = {frame, point_gradients, 1 / light->gradient_unit, model->point_gradients};
  cellist_parallel_for(context, point_count, 4096, turn_gradients, &turning);
  return CELLIST_SUCCESS;
}

void soft_model_release(cellist_context *context, soft_model *model) {
  cellist_deallocate(context, model->isos);
  cellist_deallocate(context, model->point_gradients);
  *model = (soft_model){0};
}

bool soft_model_meets_iso(const soft_model *model, double low, double high) {
  for (size_t i = 0; i < model->iso_count; i++)
    if (model->isos[i].value >= low - ISO_MARGIN && model->isos[i].value <= high + ISO_MARGIN) return true;
  return false;
}
