/* SPDX-License-Identifier: BSD-3-Clause
 * Batches: the processor's threads write each cell's footprint and record straight into OpenGL's buffers; then it is
 * drawn in a few calls. */
#include "renderer.h"

/* Cuts the order into pieces: each small group is one, the cells between them are some. */
static cellist_result make_pieces(cellist_gl *gl, bool as_fans, size_t count, const cellist_gl_group *groups,
                                  size_t group_count, size_t *piece_count) {
  const size_t most = count / GL_CELLS_GRAIN + 2 + 2 * group_count;
  if (most > gl->piece_capacity) {
    gl_piece *grown = cellist_reallocate(gl->context, gl->pieces, gl->piece_capacity, most, sizeof *grown);
    if (grown == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    gl->pieces = grown;
    gl->piece_capacity = most;
  }
  if (gl->runs == NULL) gl->runs = cellist_allocate(gl->context, gl->chunk_cells, sizeof *gl->runs);
  if (gl->runs == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (gl->extras == NULL) gl->extras = cellist_allocate_zeroed(gl->context, gl->chunk_cells, sizeof *gl->extras);
  if (gl->extras == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  size_t made = 0, group = 0;
  for (size_t begin = 0; begin < count;) {
    const bool is_group = group < group_count && groups[group].begin == begin;
    size_t end = is_group ? begin + groups[group].count : group < group_count ? groups[group].begin : count;
    if (is_group)
      group++;
    else if (end - begin > GL_CELLS_GRAIN)
      end = begin + GL_CELLS_GRAIN;
    gl->pieces[made++] = (gl_piece){.begin = (uint32_t)begin,
                                    .count = (uint32_t)(end - begin),
                                    .is_group = is_group,
                                    .as_fans = as_fans && !is_group};
    begin = end;
  }
  *piece_count = made;
  return CELLIST_SUCCESS;
}

/* Room for so many bytes, to be written; NULL if there is none. */
static void *map_stream(const gl_api *api, GLenum target, gl_stream *stream, size_t bytes) {
  api->BindBuffer(target, stream->buffer);
  if (stream->bytes < bytes) api->BufferData(target, (GLsizeiptr)bytes, NULL, GL_STREAM_DRAW);
  void *mapped = api->MapBufferRange(target, 0, (GLsizeiptr)bytes, GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT);
  if (mapped == NULL)
    stream->bytes = 0;
  else if (stream->bytes < bytes)
    stream->bytes = bytes;
  return mapped;
}

/* Whether the buffer was mapped and has kept what was written. */
static bool unmap_stream(const gl_api *api, GLenum target, const gl_stream *stream, const void *mapped) {
  if (mapped == NULL) return false;
  api->BindBuffer(target, stream->buffer);
  return api->UnmapBuffer(target);
}

cellist_result gl_batch_send(gl_drawing *drawing, gl_stage stage, const uint32_t *order, size_t count,
                             const cellist_gl_group *groups, size_t group_count, size_t *piece_count) {
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  const bool lit = drawing->cells.light.gradients != NULL;
  const bool fans = stage == GL_STAGE_FAN;
  cellist_result result = make_pieces(gl, fans, count, groups, group_count, piece_count);
  if (result != CELLIST_SUCCESS) return result;
  gl_cells_output output = {.records = map_stream(api, GL_TEXTURE_BUFFER, &gl->records, count * sizeof *output.records),
                            .extras = gl->extras,
                            .corners = map_stream(api, GL_ARRAY_BUFFER, &gl->corners,
                                                  count * 3 * GL_CELLS_TRIANGLES * sizeof *output.corners),
                            .runs = gl->runs};
  if (lit) output.lights = map_stream(api, GL_TEXTURE_BUFFER, &gl->lights, count * sizeof *output.lights);
  if (fans)
    output.fan_corners =
        map_stream(api, GL_ARRAY_BUFFER, &gl->fan_corners, count * 3 * GL_FAN_TRIANGLES * sizeof *output.fan_corners);
  if (output.records != NULL && output.corners != NULL && lit == (output.lights != NULL) &&
      fans == (output.fan_corners != NULL))
    gl_cells_prepare(&drawing->cells, order, gl->pieces, *piece_count, &output);
  bool kept = unmap_stream(api, GL_TEXTURE_BUFFER, &gl->records, output.records);
  kept = unmap_stream(api, GL_ARRAY_BUFFER, &gl->corners, output.corners) && kept;
  if (lit) kept = unmap_stream(api, GL_TEXTURE_BUFFER, &gl->lights, output.lights) && kept;
  if (fans) kept = unmap_stream(api, GL_ARRAY_BUFFER, &gl->fan_corners, output.fan_corners) && kept;
  if (!kept) return cellist_fail(gl->context, CELLIST_ERROR_OUT_OF_MEMORY, "OpenGL has no buffer for %zu cells", count);
  bool with_extras = false; /* hardly ever */
  for (size_t i = 0; i < *piece_count; i++) {
    with_extras = with_extras || gl->pieces[i].has_extras;
    drawing->stats.cell_count += gl->pieces[i].cell_count;
    drawing->stats.triangle_count += gl->pieces[i].triangle_count;
    drawing->stats.left_count += gl->pieces[i].left_count;
    drawing->stats.group_count += gl->pieces[i].is_group;
  }
  if (with_extras) {
    api->BindBuffer(GL_TEXTURE_BUFFER, gl->extra_buffer);
    api->BufferData(GL_TEXTURE_BUFFER, (GLsizeiptr)(count * sizeof *gl->extras), gl->extras, GL_STREAM_DRAW);
  }
  return CELLIST_SUCCESS;
}

/* Runs that one call draws. */
struct call {
  gl_stage stage;
  gl_need need;
  GLint begins[64];
  GLsizei sizes[64], count;
};

static cellist_result flush(gl_drawing *drawing, struct call *call) {
  if (call->count == 0) return CELLIST_SUCCESS;
  const cellist_gl *gl = drawing->gl;
  const cellist_result result = gl_use_stage(drawing, call->stage, call->need);
  if (result != CELLIST_SUCCESS) return result;
  gl->api.BindVertexArray(call->stage == GL_STAGE_FAN ? gl->fan_vertices : gl->vertices);
  gl->api.MultiDrawArrays(GL_TRIANGLES, call->begins, call->sizes, call->count);
  call->count = 0;
  return CELLIST_SUCCESS;
}

cellist_result gl_batch_draw(gl_drawing *drawing, size_t piece_count, gl_stage stage) {
  const cellist_gl *gl = drawing->gl;
  struct call call = {.count = 0};
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < piece_count; i++)
    for (size_t k = 0; k < gl->pieces[i].run_count && result == CELLIST_SUCCESS; k++) {
      const gl_piece *piece = &gl->pieces[i];
      const gl_run *run = &gl->runs[piece->begin + k];
      const gl_stage wanted = piece->is_group         ? GL_STAGE_SMALL_GROUP
                              : run->is_fan           ? GL_STAGE_FAN
                              : stage == GL_STAGE_FAN ? GL_STAGE_BLEND
                                                      : stage;
      if (wanted != call.stage || run->need != call.need || call.count == 64) result = flush(drawing, &call);
      call.stage = wanted;
      call.need = run->need;
      call.begins[call.count] = (GLint)run->first;
      call.sizes[call.count++] = (GLsizei)run->count;
    }
  return result == CELLIST_SUCCESS ? flush(drawing, &call) : result;
}
