/* SPDX-License-Identifier: BSD-3-Clause
 * Reading: tells the format from the file's first bytes (the name only breaks ties) and makes the mesh. */
#include "read.h"

#include <string.h>

#include "text.h"

typedef cellist_result (*reader)(cellist_context *context, const struct source *source, struct grid *grid);

static bool begins_with(const struct source *source, size_t at, const char *text) {
  const size_t length = strlen(text);
  return source->size - at >= length && memcmp(source->bytes + at, text, length) == 0;
}

/* The numbers of the first line that has any, if they are integers: at most four; 0 if it is no such line. */
static size_t first_integers(const struct source *source, int64_t numbers[4]) {
  struct text text = text_of(source, '#');
  text_next_word(&text);
  if (text.at == text.end) return 0;
  text = text_of(source, '#');
  size_t count = 0;
  for (struct text_word word = text_next_word(&text); word.length > 0; word = text_next_word_in_line(&text)) {
    if (count == 4 || !text_word_to_integer(word, &numbers[count])) return 0;
    count++;
  }
  return count;
}

/* Text files without a magic word: their first line tells. */
static reader find_bare_text_reader(const struct source *source) {
  int64_t numbers[4] = {0};
  const size_t count = first_integers(source, numbers);
  if (source_has_suffix(source, ".node") || source_has_suffix(source, ".ele") || source_has_suffix(source, ".face"))
    return read_tetgen;
  if (source_has_suffix(source, ".off")) return read_off;
  if ((count == 4 && numbers[1] == 3) || (count == 3 && (numbers[1] == 4 || numbers[1] == 10))) return read_tetgen;
  return count == 2 ? read_off : NULL;
}

static reader find_reader(const struct source *source) {
  size_t at = 0;
  if (begins_with(source, 0, "\xEF\xBB\xBF")) at = 3; /* a byte order mark */
  while (at < source->size && (source->bytes[at] == ' ' || (source->bytes[at] >= '\t' && source->bytes[at] <= '\r')))
    at++;
  if (begins_with(source, at, "<?xml") || begins_with(source, at, "<VTKFile") || begins_with(source, at, "<!"))
    return read_vtk_xml;
  if (begins_with(source, 0, "# vtk DataFile")) return read_vtk_legacy;
  if (begins_with(source, at, "$MeshFormat") || begins_with(source, at, "$Comments")) return read_gmsh;
  struct text text = text_of(source, '#');
  const struct text_word first = text_next_word(&text);
  if (text_word_is(first, "MeshVersionFormatted")) return read_medit;
  if (text_word_is(first, "OFF")) return read_off;
  /* Sizes in binary never look like a first line of numbers: their bytes are mostly zeros. */
  return plot3d_is_grid(source) ? read_plot3d : find_bare_text_reader(source);
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
  if (desc != NULL) source.solution = desc->solution;
  if (result == CELLIST_SUCCESS) result = read_source(context, &source, desc, mesh);
  source_close(context, &source);
  return result;
}

cellist_result cellist_mesh_read_memory(cellist_context *context, const char *name, const void *bytes, size_t size,
                                        const cellist_mesh_read_desc *desc, cellist_mesh **mesh) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (name == NULL || bytes == NULL || mesh == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_mesh_read_memory: an argument is NULL");
  struct source source = source_of_memory(name, bytes, size);
  if (desc != NULL) source.solution = desc->solution;
  return read_source(context, &source, desc, mesh);
}
