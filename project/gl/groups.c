/* SPDX-License-Identifier: BSD-3-Clause
 * Groups of cells that lie in front of each other in a circle [C 4]. On one ray, convex cells that do not overlap have
 * an order, so a group is composited on each pixel by the depths there; which of two is in front needs no test of
 * planes. A few cells: each fragment looks at all of them (small_groups.frag). More: per-pixel lists (OpenGL 4.3), or
 * layers from the far side, one pass over the group each (depth peeling).
 *
 * The memory of lists is bounded: where it does not suffice for a part of the picture, that is drawn in halves. */
#include <math.h>

#include "renderer.h"

/* Nodes that lists begin with; they grow to what a group needs. */
enum { FIRST_CAPACITY = 1 << 16, NODE_BYTES = 48, HEADER_BYTES = 16 };

/* A rectangle of pixels, from the lower left. */
struct part {
  GLint x, y, width, height;
};

struct group {
  gl_drawing *drawing;
  const uint32_t *members;
  size_t count, piece_count;
  bool counted; /* its cells are in the statistics */
};

bool gl_group_is_small(const gl_drawing *drawing, const cellist_gl_group *group) {
  return drawing->settings->group_method == CELLIST_GL_GROUPS_AUTO && group->count <= GL_SMALL_GROUP;
}

void gl_groups_release(cellist_gl *gl) {
  const gl_api *api = &gl->api;
  gl_lists *lists = &gl->lists;
  gl_layers *layers = &gl->layers;
  const GLuint buffers[] = {lists->nodes, lists->heads};
  const GLuint textures[] = {layers->colour, layers->placed[0], layers->placed[1], layers->depth};
  api->DeleteBuffers(2, buffers); /* names of 0 are overlooked */
  api->DeleteFramebuffers(2, layers->framebuffers);
  api->DeleteTextures(4, textures);
  *lists = (gl_lists){0};
  *layers = (gl_layers){0};
}

static cellist_result send(struct group *group, size_t begin, size_t count) {
  return gl_batch_send(group->drawing, GL_STAGE_BLEND, group->members + begin, count, NULL, 0, &group->piece_count);
}

/* Draws every member; a group that is one batch was sent before. */
static cellist_result draw_members(struct group *group, gl_stage stage) {
  gl_drawing *drawing = group->drawing;
  const gl_api *api = &drawing->gl->api;
  const size_t step = drawing->gl->chunk_cells;
  const cellist_gl_stats stats = drawing->stats;
  cellist_result result = CELLIST_SUCCESS;
  for (size_t begin = 0; begin < group->count && result == CELLIST_SUCCESS; begin += step) {
    const size_t left = group->count - begin;
    if (group->count > step) result = send(group, begin, left < step ? left : step);
    if (result == CELLIST_SUCCESS) result = gl_use_stage(drawing, stage, GL_NEED_ANYTHING);
    if (result != CELLIST_SUCCESS) break;
    api->Uniform1i(api->GetUniformLocation(drawing->program, "first_record"), (GLint)begin);
    result = gl_batch_draw(drawing, group->piece_count, stage);
  }
  if (group->counted) drawing->stats = stats;
  group->counted = true;
  return result;
}

static cellist_result resolve(gl_drawing *drawing, gl_stage stage) {
  const gl_api *api = &drawing->gl->api;
  const cellist_result result = gl_use_stage(drawing, stage, GL_NEED_ANYTHING);
  if (result != CELLIST_SUCCESS) return result;
  api->BindVertexArray(drawing->gl->no_vertices);
  api->DrawArrays(GL_TRIANGLES, 0, 3);
  return CELLIST_SUCCESS;
}

/* Pixels around what was sent. */
static struct part part_of(const struct group *group) {
  const gl_drawing *drawing = group->drawing;
  const gl_piece *pieces = drawing->gl->pieces;
  const double size[2] = {drawing->frame->width, drawing->frame->height};
  struct part part = {0, 0, (GLint)drawing->frame->width, (GLint)drawing->frame->height};
  if (group->count > drawing->gl->chunk_cells) return part;
  GLint low[2], high[2];
  for (int k = 0; k < 2; k++) {
    double least = 1, most = -1;
    for (size_t i = 0; i < group->piece_count; i++) {
      least = fmin(least, pieces[i].low[k]);
      most = fmax(most, pieces[i].high[k]);
    }
    low[k] = (GLint)fmax(0, floor((0.5 + 0.5 * least) * size[k]) - 1);
    high[k] = (GLint)fmin(size[k], ceil((0.5 + 0.5 * most) * size[k]) + 1);
    if (high[k] < low[k]) high[k] = low[k];
  }
  return (struct part){low[0], low[1], high[0] - low[0], high[1] - low[1]};
}

static void reserve_nodes(cellist_gl *gl, size_t capacity) {
  gl->api.BindBuffer(GL_SHADER_STORAGE_BUFFER, gl->lists.nodes);
  gl->api.BufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)(HEADER_BYTES + capacity * NODE_BYTES), NULL,
                     GL_DYNAMIC_DRAW);
  gl->lists.capacity = capacity;
}

static size_t most_nodes(const cellist_gl *gl) {
  GLint limit = 0;
  gl->api.GetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  size_t bytes = (size_t)limit;
  if (gl->list_bytes > 0 && gl->list_bytes < bytes) bytes = gl->list_bytes;
  return bytes > HEADER_BYTES + NODE_BYTES ? (bytes - HEADER_BYTES) / NODE_BYTES : 1;
}

/* Heads of every list, all empty. */
static void clear_heads(cellist_gl *gl, const cellist_frame *frame) {
  const gl_api *api = &gl->api;
  gl_lists *lists = &gl->lists;
  api->BindBuffer(GL_SHADER_STORAGE_BUFFER, lists->heads);
  if (lists->width != frame->width || lists->height != frame->height)
    api->BufferData(GL_SHADER_STORAGE_BUFFER, (GLsizeiptr)((size_t)frame->width * frame->height * sizeof(uint32_t)),
                    NULL, GL_DYNAMIC_DRAW);
  api->ClearBufferData(GL_SHADER_STORAGE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
  lists->width = frame->width;
  lists->height = frame->height;
}

static void prepare_lists(cellist_gl *gl, const cellist_frame *frame) {
  gl_lists *lists = &gl->lists;
  if (lists->nodes == 0) {
    gl->api.GenBuffers(1, &lists->nodes);
    gl->api.GenBuffers(1, &lists->heads);
    reserve_nodes(gl, most_nodes(gl) < FIRST_CAPACITY ? most_nodes(gl) : FIRST_CAPACITY);
  }
  if (lists->width != frame->width || lists->height != frame->height) clear_heads(gl, frame);
  gl->api.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, lists->nodes);
  gl->api.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, lists->heads);
}

/* Gathers the lists of one part of the picture. taken: nodes that they need. */
static cellist_result gather_lists(struct group *group, const struct part *part, size_t *taken) {
  gl_drawing *drawing = group->drawing;
  const gl_api *api = &drawing->gl->api;
  GLuint used = 0;
  api->BindBuffer(GL_SHADER_STORAGE_BUFFER, drawing->gl->lists.nodes);
  api->BufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof used, &used);
  api->Scissor(part->x, part->y, part->width, part->height);
  api->ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  const cellist_result result = draw_members(group, GL_STAGE_LIST);
  api->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  api->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  api->BindBuffer(GL_SHADER_STORAGE_BUFFER, drawing->gl->lists.nodes);
  api->GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof used, &used);
  *taken = used;
  return result;
}

static cellist_result draw_lists(struct group *group, const struct part *part) {
  gl_drawing *drawing = group->drawing;
  cellist_gl *gl = drawing->gl;
  if (part->width == 0 || part->height == 0) return CELLIST_SUCCESS;
  for (;;) {
    size_t taken = 0;
    cellist_result result = gather_lists(group, part, &taken);
    if (result != CELLIST_SUCCESS) return result;
    if (taken <= gl->lists.capacity) {
      drawing->stats.fragment_count += taken;
      result = resolve(drawing, GL_STAGE_LIST_RESOLVE);
      gl->api.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
      return result;
    }
    clear_heads(gl, drawing->frame);
    const size_t most = most_nodes(gl);
    if (gl->lists.capacity < most) {
      reserve_nodes(gl, taken < most ? taken : most);
      result = gl_check_errors(gl, "making room for per-pixel lists");
      if (result != CELLIST_SUCCESS) return result;
      continue;
    }
    struct part halves[2] = {*part, *part};
    if (part->width > 1) {
      halves[0].width = part->width / 2;
      halves[1].x += halves[0].width;
      halves[1].width -= halves[0].width;
    } else if (part->height > 1) {
      halves[0].height = part->height / 2;
      halves[1].y += halves[0].height;
      halves[1].height -= halves[0].height;
    } else {
      return cellist_fail(gl->context, CELLIST_ERROR_OUT_OF_MEMORY, "OpenGL has no memory for a list of %zu cells",
                          taken);
    }
    result = draw_lists(group, &halves[0]);
    return result == CELLIST_SUCCESS ? draw_lists(group, &halves[1]) : result;
  }
}

static GLuint make_texture(const gl_api *api, GLenum format, GLenum components, const cellist_frame *frame) {
  GLuint texture = 0;
  api->GenTextures(1, &texture);
  api->BindTexture(GL_TEXTURE_2D, texture);
  api->TexImage2D(GL_TEXTURE_2D, 0, (GLint)format, (GLsizei)frame->width, (GLsizei)frame->height, 0, components,
                  GL_FLOAT, NULL);
  api->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  api->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

static cellist_result prepare_layers(cellist_gl *gl, const cellist_frame *frame) {
  static const GLenum attachments[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  const gl_api *api = &gl->api;
  gl_layers *layers = &gl->layers;
  if (layers->width == frame->width && layers->height == frame->height) return CELLIST_SUCCESS;
  gl_groups_release(gl);
  api->ActiveTexture(GL_TEXTURE0 + GL_UNIT_LAST_LAYER);
  layers->colour = make_texture(api, GL_RGBA32F, GL_RGBA, frame);
  layers->depth = make_texture(api, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, frame);
  api->GenFramebuffers(2, layers->framebuffers);
  for (int i = 0; i < 2; i++) {
    layers->placed[i] = make_texture(api, GL_RGBA32F, GL_RGBA, frame);
    api->BindFramebuffer(GL_FRAMEBUFFER, layers->framebuffers[i]);
    api->FramebufferTexture2D(GL_FRAMEBUFFER, attachments[0], GL_TEXTURE_2D, layers->colour, 0);
    api->FramebufferTexture2D(GL_FRAMEBUFFER, attachments[1], GL_TEXTURE_2D, layers->placed[i], 0);
    api->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, layers->depth, 0);
    api->DrawBuffers(2, attachments);
    const GLenum status = api->CheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
      gl_groups_release(gl);
      return cellist_fail(gl->context, CELLIST_ERROR_GRAPHICS,
                          "no framebuffer for layers of %ux%u pixels (status 0x%x)", frame->width, frame->height,
                          status);
    }
  }
  layers->width = frame->width;
  layers->height = frame->height;
  return CELLIST_SUCCESS;
}

/* 2^-n above all depths of the mesh. */
static float place_scale(const gl_drawing *drawing) {
  double most = 1;
  for (size_t i = 0; i < drawing->gl->mesh.arrays->point_count; i++) most = fmax(most, drawing->cells.points[i].at[2]);
  return (float)ldexp(1, -ilogb(most) - 2);
}

static void bind_texture(const gl_api *api, GLint unit, GLuint texture) {
  api->ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
  api->BindTexture(GL_TEXTURE_2D, texture);
}

static void begin_layer(const gl_drawing *drawing, int into) {
  static const GLfloat nothing[4] = {0, 0, 0, 0}, none = 0;
  const gl_api *api = &drawing->gl->api;
  api->BindFramebuffer(GL_FRAMEBUFFER, drawing->gl->layers.framebuffers[into]);
  api->Disable(GL_BLEND);
  api->Enable(GL_DEPTH_TEST);
  api->DepthFunc(GL_GREATER);
  api->ClearBufferfv(GL_COLOR, 1, nothing);
  api->ClearBufferfv(GL_DEPTH, 0, &none);
  bind_texture(api, GL_UNIT_LAST_LAYER, drawing->gl->layers.placed[1 - into]);
}

static cellist_result draw_layers(struct group *group, const struct part *part) {
  static const GLfloat beyond[4] = {INFINITY, 0, 0, 0};
  gl_drawing *drawing = group->drawing;
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  const gl_layers *layers = &gl->layers;
  cellist_result result = prepare_layers(gl, drawing->frame);
  if (result != CELLIST_SUCCESS) return result;
  const float scale = place_scale(drawing);
  bind_texture(api, GL_UNIT_LAYER_COLOUR, layers->colour);
  api->Scissor(part->x, part->y, part->width, part->height);
  api->BindFramebuffer(GL_FRAMEBUFFER, layers->framebuffers[1]);
  api->ClearBufferfv(GL_COLOR, 1, beyond);
  for (int into = 0; result == CELLIST_SUCCESS; into = 1 - into) {
    begin_layer(drawing, into);
    result = gl_use_stage(drawing, GL_STAGE_LAYER, GL_NEED_ANYTHING);
    if (result != CELLIST_SUCCESS) break;
    api->Uniform1f(api->GetUniformLocation(drawing->program, "place_scale"), scale);
    GLuint64 found = 0;
    api->BeginQuery(GL_SAMPLES_PASSED, gl->query);
    result = draw_members(group, GL_STAGE_LAYER);
    api->EndQuery(GL_SAMPLES_PASSED);
    api->GetQueryObjectui64v(gl->query, GL_QUERY_RESULT, &found);
    gl_target_use(api, &gl->target, false);
    if (found == 0 || result != CELLIST_SUCCESS) break;
    drawing->stats.fragment_count += found;
    bind_texture(api, GL_UNIT_LAST_LAYER, layers->placed[into]);
    result = resolve(drawing, GL_STAGE_LAYER_RESOLVE);
    if (result == CELLIST_SUCCESS) result = cellist_progress(gl->context, "projecting", 0.5);
  }
  gl_target_use(api, &gl->target, false);
  return result;
}

cellist_result gl_group_draw(gl_drawing *drawing, const uint32_t *members, size_t count) {
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  struct group group = {drawing, members, count, 0, count <= gl->chunk_cells};
  cellist_result result = count <= gl->chunk_cells ? send(&group, 0, count) : CELLIST_SUCCESS;
  if (result != CELLIST_SUCCESS) return result;
  const struct part part = part_of(&group);
  if (part.width == 0 || part.height == 0) return CELLIST_SUCCESS;
  const bool lists = gl->has_lists && drawing->settings->group_method != CELLIST_GL_GROUPS_LAYERS;
  api->Enable(GL_SCISSOR_TEST);
  if (lists) {
    prepare_lists(gl, drawing->frame);
    result = draw_lists(&group, &part);
  } else {
    result = draw_layers(&group, &part);
  }
  api->Disable(GL_SCISSOR_TEST);
  drawing->stats.group_count++;
  return result;
}
