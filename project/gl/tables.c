/* SPDX-License-Identifier: BSD-3-Clause
 * Tables of the integrators: made when a frame first needs them, kept until the transfer function changes. */
#include <math.h>
#include <optics/psi.h>
#include <string.h>

#include "integrators.h"

static void set_sampling(const gl_api *api, GLenum target) {
  api->TexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  api->TexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  api->TexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  api->TexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  if (target == GL_TEXTURE_3D) api->TexParameteri(target, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
}

static cellist_result prepare_psi(cellist_context *context, const gl_api *api, gl_tables *tables) {
  if (tables->psi != 0) return CELLIST_SUCCESS;
  float *entries = cellist_allocate(context, PSI_FLOATS, sizeof *entries);
  if (entries == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  psi_table_fill(entries);
  api->GenTextures(1, &tables->psi);
  api->BindTexture(GL_TEXTURE_2D, tables->psi);
  set_sampling(api, GL_TEXTURE_2D);
  api->TexImage2D(GL_TEXTURE_2D, 0, GL_RG32F, PSI_DEPTHS, PSI_SHARES, 0, GL_RG, GL_FLOAT, entries);
  cellist_deallocate(context, entries);
  return CELLIST_SUCCESS;
}

static bool same_transfer(const cellist_transfer *a, const cellist_transfer *b) {
  return a->knot_count == b->knot_count && memcmp(a->knots, b->knots, a->knot_count * sizeof *a->knots) == 0;
}

static bool same_desc(const cellist_preintegration_desc *a, const cellist_preintegration_desc *b) {
  return a->minimum == b->minimum && a->maximum == b->maximum && a->length_unit == b->length_unit &&
         a->scalar_count == b->scalar_count && a->length_count == b->length_count && a->lit == b->lit;
}

static void upload(const gl_api *api, gl_tables *tables) {
  const cellist_preintegration_arrays arrays = cellist_preintegration_get_arrays(tables->made);
  const float *entries[3] = {arrays.ambient, arrays.front, arrays.back};
  for (int i = 0; i < 3; i++) {
    if (entries[i] == NULL) continue;
    if (tables->textures[i] == 0) api->GenTextures(1, &tables->textures[i]);
    api->BindTexture(GL_TEXTURE_3D, tables->textures[i]);
    set_sampling(api, GL_TEXTURE_3D);
    api->TexImage3D(GL_TEXTURE_3D, 0, GL_RGBA32F, (GLsizei)arrays.length_count, (GLsizei)arrays.scalar_count,
                    (GLsizei)arrays.scalar_count, 0, GL_RGBA, GL_FLOAT, entries[i]);
  }
}

static cellist_result check_size(cellist_context *context, const gl_api *api, const cellist_preintegration_desc *desc) {
  GLint limit = 0;
  api->GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
  if (desc->scalar_count <= (uint32_t)limit && desc->length_count <= (uint32_t)limit) return CELLIST_SUCCESS;
  return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "this OpenGL has tables of %d entries a side at most, not %u",
                      (int)limit, desc->scalar_count);
}

/* The scalars that gl_scale maps to -1..1, and lengths that no segment exceeds. */
static cellist_preintegration_desc desc_of(const gl_tables_use *use) {
  cellist_preintegration_desc desc = {.minimum = use->scale.offset - 1 / use->scale.factor,
                                      .maximum = use->scale.offset + 1 / use->scale.factor,
                                      .scalar_count = use->size[0] != 0 ? use->size[0] : CELLIST_TABLE_SCALARS,
                                      .length_count = use->size[1] != 0 ? use->size[1] : CELLIST_TABLE_LENGTHS,
                                      .lit = use->lit};
  if (desc.length_count > 2) desc.length_unit = use->longest / log2(desc.length_count - 1);
  if (!(desc.length_unit > 0)) desc.length_unit = 1;
  return desc;
}

/* Where extinction turns at a knot, linear interpolation between nodes is off by up to this share of the largest
 * extinction before a table is said to be too coarse. */
static const double COARSE = 0.05;

/* A spike or a step between two nodes is smeared over both. */
static bool is_too_coarse(const cellist_transfer *transfer, const cellist_preintegration_desc *desc) {
  const double step = (desc->maximum - desc->minimum) / (desc->scalar_count - 1);
  const cellist_transfer_knot *knots = transfer->knots;
  double largest = 0, turn = 0, last_slope = 0;
  for (size_t i = 0; i < transfer->knot_count; i++) {
    if (knots[i].value < desc->minimum || knots[i].value > desc->maximum) continue;
    const bool is_last = i + 1 == transfer->knot_count;
    const double rise = is_last ? 0 : knots[i + 1].extinction - knots[i].extinction;
    const double slope = rise == 0 ? 0 : rise / (knots[i + 1].value - knots[i].value);
    largest = fmax(largest, knots[i].extinction);
    turn = fmax(turn, fabs(slope - last_slope));
    last_slope = slope;
  }
  /* A turn of the slope in the middle between two nodes is cut by a quarter of it times their distance. */
  return 0.25 * turn * step > COARSE * largest;
}

static cellist_result prepare_preintegration(cellist_context *context, const gl_api *api, const gl_tables_use *use,
                                             gl_tables *tables) {
  const cellist_preintegration_desc desc = desc_of(use);
  cellist_result result = check_size(context, api, &desc);
  if (result != CELLIST_SUCCESS) return result;
  cellist_transfer transfer = {.knot_count = use->transfer->knot_count};
  transfer.knots = cellist_allocate(context, transfer.knot_count, sizeof *transfer.knots);
  if (transfer.knots == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memcpy(transfer.knots, use->transfer->knots, transfer.knot_count * sizeof *transfer.knots);
  for (size_t i = 0; i < transfer.knot_count && use->black; i++)
    memset(transfer.knots[i].colour, 0, sizeof transfer.knots[i].colour);
  const bool fits = tables->made != NULL && same_desc(&desc, &tables->desc);
  if (fits && same_transfer(&transfer, &tables->transfer)) {
    cellist_transfer_release(context, &transfer);
    return CELLIST_SUCCESS;
  }
  if (fits) {
    result = cellist_preintegration_update(tables->made, &transfer);
  } else {
    cellist_preintegration *made = NULL;
    result = cellist_preintegration_create(context, &desc, &transfer, &made);
    if (result == CELLIST_SUCCESS) {
      cellist_preintegration_destroy(tables->made);
      tables->made = made;
    }
  }
  if (result != CELLIST_SUCCESS) {
    cellist_transfer_release(context, &transfer);
    return result;
  }
  cellist_transfer_release(context, &tables->transfer);
  tables->transfer = transfer;
  tables->desc = desc;
  upload(api, tables);
  if (is_too_coarse(&transfer, &desc))
    cellist_log(context, CELLIST_LOG_WARNING,
                "the transfer function has spikes or steps within the distance of two of the tables' %u scalars, which "
                "smear them; exact and psi integration do not",
                desc.scalar_count);
  return CELLIST_SUCCESS;
}

cellist_result gl_tables_prepare(cellist_context *context, const gl_api *api, const gl_tables_use *use,
                                 gl_tables *tables) {
  if (use->integrator == GL_INTEGRATOR_PSI) return prepare_psi(context, api, tables);
  if (use->integrator == GL_INTEGRATOR_TABLE) return prepare_preintegration(context, api, use, tables);
  return CELLIST_SUCCESS;
}

void gl_tables_bind(const gl_api *api, const gl_tables *tables, gl_integrator integrator, double length_unit,
                    GLuint program, int first_unit) {
  if (integrator == GL_INTEGRATOR_PSI) {
    api->ActiveTexture(GL_TEXTURE0 + (GLenum)first_unit);
    api->BindTexture(GL_TEXTURE_2D, tables->psi);
    api->Uniform1i(api->GetUniformLocation(program, "psi"), first_unit);
  } else if (integrator == GL_INTEGRATOR_TABLE) {
    static const char *const names[3] = {"ambient_table", "front_table", "back_table"};
    for (int i = 0; i < (tables->desc.lit ? 3 : 1); i++) {
      api->ActiveTexture(GL_TEXTURE0 + (GLenum)(first_unit + i));
      api->BindTexture(GL_TEXTURE_3D, tables->textures[i]);
      api->Uniform1i(api->GetUniformLocation(program, names[i]), first_unit + i);
    }
    api->Uniform1f(api->GetUniformLocation(program, "per_length_unit"),
                   (float)(length_unit / tables->desc.length_unit));
  }
}

void gl_tables_release(cellist_context *context, const gl_api *api, gl_tables *tables) {
  cellist_preintegration_destroy(tables->made);
  cellist_transfer_release(context, &tables->transfer);
  if (api != NULL) {
    api->DeleteTextures(3, tables->textures);
    api->DeleteTextures(1, &tables->psi);
  }
  *tables = (gl_tables){0};
}
