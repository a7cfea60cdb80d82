/* SPDX-License-Identifier: BSD-3-Clause
 * Optics: from what the caller asks for to a transfer function in mesh units and a model without gaps. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pipeline.h"

static cellist_result copy_transfer(cellist_context *context, const cellist_transfer *function,
                                    cellist_transfer *copy) {
  const cellist_result result = cellist_transfer_check(context, function);
  if (result != CELLIST_SUCCESS) return result;
  copy->knots = cellist_allocate(context, function->knot_count, sizeof *copy->knots);
  if (copy->knots == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memcpy(copy->knots, function->knots, function->knot_count * sizeof *copy->knots);
  copy->knot_count = function->knot_count;
  return CELLIST_SUCCESS;
}

cellist_result pipeline_load_transfer(cellist_pipeline *pipeline) {
  const cellist_pipeline_optics *optics = &pipeline->desc.optics;
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(pipeline->mesh);
  if (optics->unit_distance > 0)
    pipeline->unit_distance = optics->unit_distance;
  else if (optics->unit_diagonal_fraction > 0)
    pipeline->unit_distance = pipeline_diagonal(pipeline) / optics->unit_diagonal_fraction;
  else
    pipeline->unit_distance =
        cellist_unit_distance_auto(arrays->bounds, cellist_mesh_get_facts(pipeline->mesh)->file_cell_count);
  if (!(pipeline->unit_distance > 0)) pipeline->unit_distance = 1; /* no extent: any unit will do */
  if (optics->function != NULL) return copy_transfer(pipeline->context, optics->function, &pipeline->transfer);
  /* A constant scalar takes the middle of the transfer function. */
  const double value = pipeline->scalar.minimum;
  const bool is_constant = value == pipeline->scalar.maximum;
  const double margin = is_constant ? (value != 0 ? 0.5 * fabs(value) : 0.5) : 0;
  cellist_transfer_desc desc = {.source = optics->transfer,
                                .range = {value - margin, pipeline->scalar.maximum + margin},
                                .unit_distance = pipeline->unit_distance,
                                .opacity_scale = optics->opacity_scale,
                                .convention = optics->convention,
                                .srgb_colours = optics->srgb_colours};
  if (optics->has_range) memcpy(desc.range, optics->range, sizeof desc.range);
  return cellist_transfer_load(pipeline->context, &desc, &pipeline->transfer);
}

/* Copies the isosurfaces and fills in the light's gradient unit. */
cellist_result pipeline_keep_model(cellist_pipeline *pipeline) {
  cellist_optics *model = &pipeline->desc.optics.model;
  if (model->iso_count > 0) {
    pipeline->isos = cellist_allocate(pipeline->context, model->iso_count, sizeof *pipeline->isos);
    if (pipeline->isos == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    memcpy(pipeline->isos, model->isos, model->iso_count * sizeof *pipeline->isos);
    model->isos = pipeline->isos;
  }
  if (model->light.enabled && model->light.gradient_unit == 0) {
    const double length = 0.1 * pipeline_diagonal(pipeline),
                 range = pipeline->scalar.maximum - pipeline->scalar.minimum;
    model->light.gradient_unit = length > 0 && range > 0 ? range / length : 1;
  }
  return CELLIST_SUCCESS;
}

bool pipeline_is_inexact(const cellist_pipeline *pipeline) {
  const cellist_optics *model = &pipeline->desc.optics.model;
  return model->integration != CELLIST_INTEGRATION_EXACT &&
         (model->model == CELLIST_MODEL_EMISSION_ABSORPTION || model->model == CELLIST_MODEL_ABSORPTION);
}

bool pipeline_is_narrow(const cellist_pipeline *pipeline) {
  return pipeline->desc.optics.model.model != CELLIST_MODEL_ISOSURFACES &&
         cellist_transfer_is_narrow(&pipeline->transfer, pipeline->scalar.minimum, pipeline->scalar.maximum);
}

const char *pipeline_name_method(cellist_pipeline *pipeline) {
  const cellist_optics *model = &pipeline->desc.optics.model;
  if (!pipeline_is_inexact(pipeline)) return "exact";
  if (model->integration == CELLIST_INTEGRATION_PSI) return "psi";
  const uint32_t scalars = model->table_size[0] != 0 ? model->table_size[0] : CELLIST_TABLE_SCALARS;
  const uint32_t lengths = model->table_size[1] != 0 ? model->table_size[1] : CELLIST_TABLE_LENGTHS;
  snprintf(pipeline->method, sizeof pipeline->method, "table %ux%ux%u", scalars, scalars, lengths);
  return pipeline->method;
}
