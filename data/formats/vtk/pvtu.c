/* SPDX-License-Identifier: BSD-3-Clause
 * PVTU: the pieces of a parallel file, each a VTU file beside it, one after the other. */
#include "xml.h"

#include <stdlib.h>
#include <string.h>

static int compare_files(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

/* A file that stands twice would put its cells in one place twice, and could make much of little. */
static cellist_result check_pieces_differ(cellist_context *context, const struct source *source,
                                          const struct xml_document *document) {
  char **files = cellist_allocate(context, document->piece_count, sizeof *files);
  if (files == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < document->piece_count; i++) files[i] = document->pieces[i].file;
  qsort(files, document->piece_count, sizeof *files, compare_files);
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 1; i < document->piece_count && result == CELLIST_SUCCESS; i++)
    if (strcmp(files[i - 1], files[i]) == 0)
      result = source_fail(context, source, "names the piece '%.128s' twice", files[i]);
  cellist_deallocate(context, files);
  return result;
}

static cellist_result read_piece(cellist_context *context, const struct source *source, const char *name,
                                 struct grid *grid) {
  struct source file;
  struct xml_document document;
  cellist_result result = source->open_beside(context, source, name, &file);
  if (result != CELLIST_SUCCESS) return result;
  result = xml_read(context, &file, &document);
  if (result == CELLIST_SUCCESS) {
    if (document.kind == XML_UNSTRUCTURED)
      result = read_vtu(context, &file, &document, grid);
    else
      result = source_fail(context, &file, "is a piece of %s, but no unstructured grid", source->name);
    xml_release(context, &document);
  }
  grid->file = source->name;
  source_close(context, &file);
  return result;
}

cellist_result read_pvtu(cellist_context *context, const struct source *source, struct xml_document *document,
                         struct grid *grid) {
  if (source->open_beside == NULL)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: names other files, which only a path leads to",
                        source->name);
  cellist_result result = check_pieces_differ(context, source, document);
  if (result != CELLIST_SUCCESS) return result;
  struct grid *pieces = cellist_allocate_zeroed(context, document->piece_count, sizeof *pieces);
  if (pieces == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < document->piece_count && result == CELLIST_SUCCESS; i++) {
    result = cellist_progress(context, "reading", (double)i / (double)document->piece_count);
    if (result == CELLIST_SUCCESS) result = read_piece(context, source, document->pieces[i].file, &pieces[i]);
  }
  if (result == CELLIST_SUCCESS) result = grid_concatenate(context, document->piece_count, pieces, grid);
  for (size_t i = 0; i < document->piece_count; i++) grid_release(context, &pieces[i]);
  cellist_deallocate(context, pieces);
  return result;
}
