/* SPDX-License-Identifier: BSD-3-Clause
 * Raycaster: the public calls; checks arguments and hands over to the precision that was asked for. */
#include "raycaster.h"

#include <math.h>

#include "fast.h"

cellist_result cellist_raycaster_create(cellist_context *context, const cellist_mesh *mesh,
                                        const cellist_scalar *scalar, const cellist_raycaster_desc *desc,
                                        cellist_raycaster **caster) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || scalar == NULL || caster == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a ray caster needs a mesh and a scalar");
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const size_t count = scalar->association == CELLIST_ON_POINTS ? arrays->point_count : arrays->tet_count;
  if (scalar->count != count || (scalar->values == NULL && count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the scalar has %zu values, the mesh needs %zu",
                        scalar->count, count);
  const uint32_t tets = desc != NULL ? desc->tets : 0;
  if (tets != 0 && tets != 32 && tets != 20 && tets != 16)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "there is no cell layout of %u bytes", tets);
  cellist_raycaster *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->mesh = mesh;
  created->scalar = scalar;
  created->desc.tets = tets;
  *caster = created;
  return CELLIST_SUCCESS;
}

void cellist_raycaster_destroy(cellist_raycaster *caster) {
  if (caster == NULL) return;
  fast_caster_destroy(caster->fast);
  hierarchy_release(caster->context, &caster->hierarchy);
  hierarchy_release(caster->context, &caster->surface_hierarchy);
  cellist_deallocate(caster->context, caster->shifted);
  cellist_deallocate(caster->context, caster->slopes);
  cellist_deallocate(caster->context, caster->point_gradients);
  cellist_deallocate(caster->context, caster->cell_gradients);
  cellist_deallocate(caster->context, caster);
}

cellist_result cellist_raycaster_render(cellist_raycaster *caster, const cellist_frame *frame,
                                        const cellist_transfer *transfer, const cellist_raycast_desc *desc,
                                        const cellist_raycast_output *output, cellist_raycast_stats *stats) {
  if (caster == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  cellist_context *context = caster->context;
  if (frame == NULL || output == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a picture needs a frame and somewhere to go");
  if (output->image != NULL &&
      (cellist_image_width(output->image) != frame->width || cellist_image_height(output->image) != frame->height))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the image is %ux%u, the frame %ux%u",
                        cellist_image_width(output->image), cellist_image_height(output->image), frame->width,
                        frame->height);
  const cellist_raycast_desc chosen = desc != NULL ? *desc : (cellist_raycast_desc){0};
  cellist_result result = cellist_transfer_check(context, transfer);
  if (result == CELLIST_SUCCESS) result = cellist_optics_check(context, &chosen.optics);
  if (result != CELLIST_SUCCESS) return result;
  cellist_raycast_stats found = {0};
  if (chosen.precision == CELLIST_PRECISION_REFERENCE)
    result = raycaster_render_reference(caster, frame, transfer, &chosen, output, &found);
  else
    result = raycaster_render_fast(caster, frame, transfer, &chosen, output, &found);
  if (result == CELLIST_SUCCESS && stats != NULL) *stats = found;
  return result;
}
