/* SPDX-License-Identifier: BSD-3-Clause
 * Batches: the processor's threads write each cell's footprint and record straight into OpenGL's buffers; then it is
 * drawn in a few calls. */
#include "renderer.h"

/* Cuts the order into pieces: each small group is one, the cells between them are some. */
static cellist_result make_pieces(cellist_gl *gl, size_t count, const cellist_gl_group *groups, size_t group_count,
                                  size_t *piece_count) {
  const size_t most = count / GL_CELLS_GRAIN + 2 + 2 * group_count;
  if (most > gl->piece_capacity) {
    gl_piece *grown = cellist_reallocate(gl->context, gl->pieces, gl->piece_capacity, most, sizeof *grown);
    if (grown == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    gl->pieces = grown;
    gl->piece_capacity = most;
  }
  size_t made = 0, group = 0;
  for (size_t begin = 0; begin < count;) {
    const bool is_group = group < group_count && groups[group].begin == begin;
    size_t end = is_group ? begin + groups[group].count : group < group_count ? groups[group].begin : count;
    if (is_group)
      group++;
    else if (end - begin > GL_CELLS_GRAIN)
      end = begin + GL_CELLS_GRAIN;
    gl->pieces[made++] = (gl_piece){.begin = (uint32_t)begin, .count = (uint32_t)(end - begin), .is_group = is_group};
    begin = end;
  }
  *piece_count = made;
  return CELLIST_SUCCESS;
}

/* Room for so many bytes, to be written; NULL if there is none. */
static void *map_buffer(const gl_api *api, GLenum target, GLuint buffer, size_t bytes) {
  api->BindBuffer(target, buffer);
  api->BufferData(target, (GLsizeiptr)bytes, NULL, GL_STREAM_DRAW);
  return api->MapBufferRange(target, 0, (GLsizeiptr)bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
}

/* Whether the buffer was mapped and has kept what was written. */
static bool unmap_buffer(const gl_api *api, GLenum target, GLuint buffer, const void *mapped) {
  if (mapped == NULL) return false;
  api->BindBuffer(target, buffer);
  return api->UnmapBuffer(target);
}

cellist_result gl_batch_send(gl_drawing *drawing, const uint32_t *order, size_t count, const cellist_gl_group *groups,
                             size_t group_count, size_t *piece_count) {
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  const bool lit = drawing->cells.light.gradients != NULL;
  cellist_result result = make_pieces(gl, count, groups, group_count, piece_count);
  if (result != CELLIST_SUCCESS) return result;
  gl_cells_output output = {
      .records = map_buffer(api, GL_TEXTURE_BUFFER, gl->record_buffer, count * sizeof *output.records),
      .extras = map_buffer(api, GL_TEXTURE_BUFFER, gl->extra_buffer, count * sizeof *output.extras),
      .corners =
          map_buffer(api, GL_ARRAY_BUFFER, gl->corner_buffer, count * 3 * GL_CELLS_TRIANGLES * sizeof *output.corners)};
  if (lit) output.lights = map_buffer(api, GL_TEXTURE_BUFFER, gl->light_buffer, count * sizeof *output.lights);
  if (output.records != NULL && output.extras != NULL && output.corners != NULL && lit == (output.lights != NULL))
    gl_cells_prepare(&drawing->cells, order, gl->pieces, *piece_count, &output);
  bool kept = unmap_buffer(api, GL_TEXTURE_BUFFER, gl->record_buffer, output.records);
  kept = unmap_buffer(api, GL_TEXTURE_BUFFER, gl->extra_buffer, output.extras) && kept;
  kept = unmap_buffer(api, GL_ARRAY_BUFFER, gl->corner_buffer, output.corners) && kept;
  if (lit) kept = unmap_buffer(api, GL_TEXTURE_BUFFER, gl->light_buffer, output.lights) && kept;
  if (!kept) return cellist_fail(gl->context, CELLIST_ERROR_OUT_OF_MEMORY, "OpenGL has no buffer for %zu cells", count);
  for (size_t i = 0; i < *piece_count; i++) {
    drawing->stats.cell_count += gl->pieces[i].cell_count;
    drawing->stats.triangle_count += gl->pieces[i].corner_count / 3;
    drawing->stats.group_count += gl->pieces[i].is_group;
  }
  return CELLIST_SUCCESS;
}

cellist_result gl_batch_draw(gl_drawing *drawing, size_t piece_count, gl_stage stage) {
  enum { RUN = 64 };
  cellist_gl *gl = drawing->gl;
  GLint begins[RUN];
  GLsizei sizes[RUN];
  gl->api.BindVertexArray(gl->vertices);
  for (size_t i = 0; i < piece_count;) {
    const bool is_group = gl->pieces[i].is_group;
    GLsizei draws = 0;
    for (; i < piece_count && gl->pieces[i].is_group == is_group && draws < RUN; i++) {
      const gl_piece *piece = &gl->pieces[i];
      if (piece->corner_count == 0) continue;
      begins[draws] = (GLint)(piece->begin * 3 * GL_CELLS_TRIANGLES);
      sizes[draws++] = (GLsizei)piece->corner_count;
    }
    if (draws == 0) continue;
    const cellist_result result = gl_use_stage(drawing, is_group ? GL_STAGE_SMALL_GROUP : stage);
    if (result != CELLIST_SUCCESS) return result;
    gl->api.MultiDrawArrays(GL_TRIANGLES, begins, sizes, draws);
  }
  return CELLIST_SUCCESS;
}
