/* SPDX-License-Identifier: BSD-3-Clause
 * VTU: pieces of an unstructured grid, from VTK's XML format. */
#include "xml.h"

#include <string.h>

/* offsets [cell_count + 1] from the file's array of ends. */
static cellist_result read_offsets(cellist_context *context, const struct source *source, struct xml_document *document,
                                   const struct xml_array *array, struct grid *grid) {
  size_t count = grid->cell_count;
  void *values = NULL;
  cellist_result result = xml_decode(context, source, document, array, ELEMENT_AS_SIZE, &count, &values);
  if (result != CELLIST_SUCCESS) return result;
  const size_t *ends = values;
  grid->offsets = cellist_allocate(context, count + 1, sizeof *grid->offsets);
  if (grid->offsets == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < count && result == CELLIST_SUCCESS; i++) {
    grid->offsets[0] = 0;
    grid->offsets[i + 1] = ends[i];
    if (ends[i] < grid->offsets[i] || ends[i] == SIZE_MAX)
      result = source_fail(context, source, "the end of cell %zu in 'offsets' lies before its begin", i);
  }
  cellist_deallocate(context, values);
  return result;
}

/* Where polyhedra have their faces: the file holds ends, or -1 for other cells; a cell's begin is the last end. */
static cellist_result read_faces(cellist_context *context, const struct source *source, struct xml_document *document,
                                 size_t piece, struct grid *grid) {
  const struct xml_array *faces = xml_find(document, piece, XML_CELLS, "faces");
  const struct xml_array *ends = xml_find(document, piece, XML_CELLS, "faceoffsets");
  if (faces == NULL || ends == NULL || memchr(grid->types, GRID_POLYHEDRON, grid->cell_count) == NULL)
    return CELLIST_SUCCESS;
  size_t count = SIZE_MAX;
  void *values = NULL;
  cellist_result result = xml_decode(context, source, document, faces, ELEMENT_AS_ID, &count, &values);
  grid->faces = values;
  grid->face_count = count;
  if (result != CELLIST_SUCCESS) return result;
  count = grid->cell_count;
  result = xml_decode(context, source, document, ends, ELEMENT_AS_SIZE, &count, &values);
  if (result != CELLIST_SUCCESS) return result;
  grid->face_starts = values;
  size_t begin = 0;
  for (size_t i = 0; i < count; i++) {
    const size_t end = grid->face_starts[i];
    if (end == SIZE_MAX) continue;
    grid->face_starts[i] = begin;
    begin = end;
  }
  return CELLIST_SUCCESS;
}

static cellist_result read_piece(cellist_context *context, const struct source *source, struct xml_document *document,
                                 size_t index, struct grid *grid) {
  const struct xml_piece *piece = &document->pieces[index];
  grid->file = source->name;
  grid->point_count = (size_t)piece->point_count;
  grid->cell_count = (size_t)piece->cell_count;
  cellist_result result = xml_read_points(context, source, document, index, grid->point_count, &grid->points);
  if (result != CELLIST_SUCCESS || grid->cell_count == 0) return result;
  const struct xml_array *offsets = xml_find(document, index, XML_CELLS, "offsets");
  const struct xml_array *types = xml_find(document, index, XML_CELLS, "types");
  const struct xml_array *connectivity = xml_find(document, index, XML_CELLS, "connectivity");
  if (offsets == NULL || types == NULL || connectivity == NULL)
    return source_fail(context, source, "piece %zu lacks connectivity, offsets or types", index);
  void *values = NULL;
  size_t count = grid->cell_count;
  result = xml_decode(context, source, document, types, ELEMENT_AS_BYTE, &count, &values);
  grid->types = values;
  if (result == CELLIST_SUCCESS) result = read_offsets(context, source, document, offsets, grid);
  if (result != CELLIST_SUCCESS) return result;
  count = grid->offsets[grid->cell_count];
  result = xml_decode(context, source, document, connectivity, ELEMENT_AS_ID, &count, &values);
  grid->connectivity = values;
  if (result == CELLIST_SUCCESS) result = read_faces(context, source, document, index, grid);
  return result;
}

cellist_result read_vtu(cellist_context *context, const struct source *source, struct xml_document *document,
                        struct grid *grid) {
  struct grid *pieces = cellist_allocate_zeroed(context, document->piece_count, sizeof *pieces);
  if (pieces == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < document->piece_count && result == CELLIST_SUCCESS; i++) {
    result = cellist_progress(context, "reading", (double)i / (double)document->piece_count);
    if (result == CELLIST_SUCCESS) result = read_piece(context, source, document, i, &pieces[i]);
    if (result == CELLIST_SUCCESS) result = xml_read_fields(context, source, document, i, &pieces[i]);
  }
  if (result == CELLIST_SUCCESS) result = grid_concatenate(context, document->piece_count, pieces, grid);
  for (size_t i = 0; i < document->piece_count; i++) grid_release(context, &pieces[i]);
  cellist_deallocate(context, pieces);
  return result;
}
