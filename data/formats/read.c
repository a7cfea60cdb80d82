/* SPDX-License-Identifier: BSD-3-Clause
 * Reading: tells the format from the file's first bytes (the name only breaks ties) and makes the mesh. */
#include "read.h"

#include <string.h>

typedef cellist_result (*reader)(cellist_context *context, const struct source *source, struct grid *grid);

static bool begins_with(const struct source *source, size_t at, const char *text) {
  const size_t length = strlen(text);
  return source->size - at >= length && memcmp(source->bytes + at, text, length) == 0;
}

static reader find_reader(const struct source *source) {
  size_t at = 0;
  if (begins_with(source, 0, "\xEF\xBB\xBF")) at = 3; /* a byte order mark */
  while (at < source->size && (source->bytes[at] == ' ' || (source->bytes[at] >= '\t' && source->bytes[at] <= '\r')))
    at++;
  if (begins_with(source, at, "<?xml") || begins_with(source, at, "<VTKFile") || begins_with(source, at, "<!"))
    return read_vtk_xml;
  return NULL;
}

static cellist_result read_source(cellist_context *context, const struct source *source,
                                  const cellist_mesh_read_desc *desc, cellist_mesh **mesh) {
  if (source->size == 0) return source_fail(context, source, "is empty");
  const reader read = find_reader(source);
  if (read == NULL)
    return source_fail(context, source,
                       "is no mesh file that Cellist knows (VTU, PVTU, VTS, VTK, PLOT3D, TetGen, Gmsh, MEDIT, OFF)");
  cellist_result result = cellist_progress(context, "reading", 0);
  struct grid grid = {0};
  if (result == CELLIST_SUCCESS) result = read(context, source, &grid);
  if (result == CELLIST_SUCCESS) result = grid_to_mesh(context, &grid, desc, mesh);
  return result;
}

cellist_result cellist_mesh_read(cellist_context *context, const char *path, const cellist_mesh_read_desc *desc,
                                 cellist_mesh **mesh) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (path == NULL || mesh == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_mesh_read: path or mesh is NULL");
  struct source source;
  cellist_result result = source_open(context, path, &source);
  if (result == CELLIST_SUCCESS) result = read_source(context, &source, desc, mesh);
  source_close(context, &source);
  return result;
}

cellist_result cellist_mesh_read_memory(cellist_context *context, const char *name, const void *bytes, size_t size,
                                        const cellist_mesh_read_desc *desc, cellist_mesh **mesh) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (name == NULL || bytes == NULL || mesh == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_mesh_read_memory: an argument is NULL");
  const struct source source = source_of_memory(name, bytes, size);
  return read_source(context, &source, desc, mesh);
}
