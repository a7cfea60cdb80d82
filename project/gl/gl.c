/* SPDX-License-Identifier: BSD-3-Clause
 * Renderer through OpenGL: context, mesh and frame. A frame goes through in chunks of cells (batch.c); groups too large
 * for a chunk's own program stand between them (groups.c). */
#include <cellist/gl.h>
#include <cellist/gradients.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "renderer.h"

static cellist_result enter(cellist_gl *gl) {
  if (gl->backend->enter(gl->state)) return CELLIST_SUCCESS;
  return cellist_fail(gl->context, CELLIST_ERROR_GRAPHICS, "the OpenGL context of %s cannot be made current",
                      gl->backend->name);
}

cellist_result gl_check_errors(cellist_gl *gl, const char *what) {
  const GLenum code = gl->api.GetError();
  if (code == GL_NO_ERROR) return CELLIST_SUCCESS;
  while (gl->api.GetError() != GL_NO_ERROR) continue;
  if (code == GL_OUT_OF_MEMORY)
    return cellist_fail(gl->context, CELLIST_ERROR_OUT_OF_MEMORY, "OpenGL is out of memory (%s)", what);
  return cellist_fail(gl->context, CELLIST_ERROR_GRAPHICS, "OpenGL error 0x%x (%s)", code, what);
}

static void make_texture_buffer(cellist_gl *gl, GLuint *buffer, GLuint *texture) {
  const gl_api *api = &gl->api;
  api->GenBuffers(1, buffer);
  api->BindBuffer(GL_TEXTURE_BUFFER, *buffer);
  api->GenTextures(1, texture);
  api->BindTexture(GL_TEXTURE_BUFFER, *texture);
  api->TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, *buffer);
}

static cellist_result set_up(cellist_gl *gl) {
  gl_api *api = &gl->api;
  cellist_result result = gl_api_load(gl->context, gl->backend->procedure, gl->state, api);
  if (result != CELLIST_SUCCESS) return result;
  const char *name = (const char *)api->GetString(GL_RENDERER);
  if (name == NULL) name = "unknown";
  gl->device_name = cellist_allocate(gl->context, strlen(name) + 1, 1);
  if (gl->device_name == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  strcpy(gl->device_name, name);

  GLint texels = 0;
  api->GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  const size_t texels_per_cell = GL_RECORD_FLOATS / 4;
  gl->chunk_cells = (size_t)texels / texels_per_cell / GL_CELLS_GRAIN * GL_CELLS_GRAIN;
  if (gl->chunk_cells > GL_CHUNK_CELLS) gl->chunk_cells = GL_CHUNK_CELLS;

  GLint major = 0, minor = 0;
  api->GetIntegerv(GL_MAJOR_VERSION, &major);
  api->GetIntegerv(GL_MINOR_VERSION, &minor);
  gl->has_lists =
      (major > 4 || (major == 4 && minor >= 3)) && api->ClearBufferData != NULL && api->MemoryBarrier != NULL;

  GLint subpixel_bits = 0;
  api->GetIntegerv(GL_SUBPIXEL_BITS, &subpixel_bits);
  gl->subpixel = ldexp(1, -subpixel_bits);

  api->GenQueries(1, &gl->query);
  make_texture_buffer(gl, &gl->records.buffer, &gl->record_texture);
  make_texture_buffer(gl, &gl->extra_buffer, &gl->extra_texture);
  make_texture_buffer(gl, &gl->interval_buffer, &gl->interval_texture);
  make_texture_buffer(gl, &gl->lights.buffer, &gl->light_texture);
  api->GenVertexArrays(1, &gl->no_vertices);
  api->GenVertexArrays(1, &gl->vertices);
  api->BindVertexArray(gl->vertices);
  api->GenBuffers(1, &gl->corners.buffer);
  api->BindBuffer(GL_ARRAY_BUFFER, gl->corners.buffer);
  api->EnableVertexAttribArray(0);
  api->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
  api->GenVertexArrays(1, &gl->fan_vertices);
  api->BindVertexArray(gl->fan_vertices);
  api->GenBuffers(1, &gl->fan_corners.buffer);
  api->BindBuffer(GL_ARRAY_BUFFER, gl->fan_corners.buffer);
  static const struct {
    GLint size;
    size_t offset;
  } attributes[] = {{3, 0}, {4, offsetof(gl_fan_corner, front)}, {1, offsetof(gl_fan_corner, thickness)}};
  for (GLuint i = 0; i < 3; i++) {
    api->EnableVertexAttribArray(i);
    api->VertexAttribPointer(i, attributes[i].size, GL_FLOAT, GL_FALSE, sizeof(gl_fan_corner),
                             (const void *)attributes[i].offset);
  }
  return gl_check_errors(gl, "setting up");
}

cellist_result cellist_gl_create(cellist_context *context, const cellist_gl_desc *desc, cellist_gl **gl) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (gl == NULL) return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_gl_create: gl is NULL");
  const gl_backend *backend = gl_backend_find(context, desc != NULL ? desc->backend : CELLIST_GL_AUTO);
  if (backend == NULL) return CELLIST_ERROR_UNSUPPORTED;
  cellist_gl *created = cellist_allocate_zeroed(context, 1, sizeof *created);
  if (created == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  created->context = context;
  created->backend = backend;
  created->list_bytes = desc != NULL ? desc->list_bytes : 0;
  cellist_result result = backend->open(context, &created->state);
  if (result == CELLIST_SUCCESS) result = enter(created);
  if (result == CELLIST_SUCCESS) {
    result = set_up(created);
    backend->leave(created->state);
  }
  if (result == CELLIST_SUCCESS)
    *gl = created;
  else
    cellist_gl_destroy(created);
  return result;
}

/* Only with the context current, and only if set_up came as far as loading the table. */
static void release_objects(cellist_gl *gl) {
  const gl_api *api = &gl->api;
  gl_target_release(gl->context, api, &gl->target);
  gl_limits_release(api, &gl->limits);
  gl_surface_release(api, &gl->surface);
  gl_tables_release(gl->context, api, &gl->tables);
  gl_groups_release(gl);
  const gl_program *programs = &gl->programs[0][0][0];
  for (size_t i = 0; i < sizeof gl->programs / sizeof *programs; i++)
    if (programs[i].name != 0) api->DeleteProgram(programs[i].name);
  const GLuint textures[] = {gl->record_texture, gl->extra_texture, gl->interval_texture, gl->light_texture};
  const GLuint buffers[] = {gl->records.buffer, gl->extra_buffer,   gl->interval_buffer,
                            gl->lights.buffer,  gl->corners.buffer, gl->fan_corners.buffer};
  const GLuint arrays[] = {gl->vertices, gl->fan_vertices, gl->no_vertices};
  api->DeleteTextures(sizeof textures / sizeof *textures, textures);
  api->DeleteVertexArrays(sizeof arrays / sizeof *arrays, arrays);
  api->DeleteBuffers(sizeof buffers / sizeof *buffers, buffers);
  api->DeleteQueries(1, &gl->query);
}

void cellist_gl_destroy(cellist_gl *gl) {
  if (gl == NULL) return;
  if (gl->state != NULL) {
    if (gl->device_name != NULL && gl->backend->enter(gl->state)) {
      release_objects(gl);
      gl->backend->leave(gl->state);
    }
    gl->backend->close(gl->context, gl->state);
  }
  gl_tables_release(gl->context, NULL, &gl->tables);
  gl_target_release(gl->context, NULL, &gl->target);
  gl_cells_mesh_release(gl->context, &gl->mesh);
  cellist_deallocate(gl->context, gl->gradients);
  cellist_deallocate(gl->context, gl->pieces);
  cellist_deallocate(gl->context, gl->runs);
  cellist_deallocate(gl->context, gl->extras);
  cellist_deallocate(gl->context, gl->device_name);
  cellist_deallocate(gl->context, gl);
}

const char *cellist_gl_backend_name(const cellist_gl *gl) { return gl->backend->name; }
const char *cellist_gl_device_name(const cellist_gl *gl) { return gl->device_name; }

cellist_result cellist_gl_upload(cellist_gl *gl, const cellist_mesh *mesh, const cellist_scalar *scalar) {
  if (gl == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || scalar == NULL)
    return cellist_fail(gl->context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_gl_upload: mesh or scalar is NULL");
  gl_cells_mesh made;
  const cellist_result result = gl_cells_mesh_make(gl->context, mesh, scalar, &made);
  if (result != CELLIST_SUCCESS) return result;
  gl_cells_mesh_release(gl->context, &gl->mesh);
  cellist_deallocate(gl->context, gl->gradients);
  gl->gradients = NULL;
  gl->mesh = made;
  gl->source = mesh;
  gl->scalar = scalar;
  gl->longest = -1;
  gl->scale = gl_scale_of(scalar);
  return CELLIST_SUCCESS;
}

static cellist_result check_groups(cellist_gl *gl, size_t order_count, const cellist_gl_settings *settings) {
  if (settings->group_count > 0 && settings->groups == NULL)
    return cellist_fail(gl->context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_gl_render: groups is NULL");
  size_t end = 0;
  for (size_t i = 0; i < settings->group_count; i++) {
    const cellist_gl_group *group = &settings->groups[i];
    if (group->begin < end || group->begin > order_count || group->count > order_count - group->begin)
      return cellist_fail(gl->context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "group %zu lies beyond the order or overlaps the one before", i);
    end = group->begin + group->count;
  }
  if ((unsigned)settings->group_method > CELLIST_GL_GROUPS_LAYERS)
    return cellist_fail(gl->context, CELLIST_ERROR_INVALID_ARGUMENT, "no way to draw groups has the number %d",
                        (int)settings->group_method);
  if (settings->group_method == CELLIST_GL_GROUPS_LISTS && !gl->has_lists)
    return cellist_fail(gl->context, CELLIST_ERROR_UNSUPPORTED, "per-pixel lists need OpenGL 4.3");
  return CELLIST_SUCCESS;
}

static cellist_result check_arguments(cellist_gl *gl, const cellist_frame *frame, const uint32_t *order,
                                      size_t order_count, const cellist_gl_settings *settings,
                                      const cellist_image *image) {
  cellist_context *context = gl->context;
  if (gl->mesh.arrays == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_gl_render: no mesh was uploaded");
  if (frame == NULL || image == NULL || (order == NULL && order_count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_gl_render: frame, order or image is NULL");
  if (cellist_image_width(image) != frame->width || cellist_image_height(image) != frame->height)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the image has %ux%u pixels, the frame %ux%u",
                        cellist_image_width(image), cellist_image_height(image), frame->width, frame->height);
  for (size_t i = 0; i < order_count; i++)
    if (order[i] >= gl->mesh.arrays->tet_count)
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the order names tet %u, but there are only %zu",
                          order[i], gl->mesh.arrays->tet_count);
  if ((unsigned)settings->optics.model > CELLIST_MODEL_ISOSURFACES)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "no model has the number %d",
                        (int)settings->optics.model);
  const cellist_light *light = &settings->optics.light;
  if (light->enabled && !(light->gradient_unit > 0 && isfinite(light->gradient_unit)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the light's gradient unit must be above 0");
  if ((unsigned)settings->optics.integration > CELLIST_INTEGRATION_TABLE)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "no integration has the number %d",
                        (int)settings->optics.integration);
  if (settings->optics.sample_count > 4)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a segment has 1 to 4 samples, not %u",
                        settings->optics.sample_count);
  if ((unsigned)settings->method > CELLIST_GL_FAN)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "no method has the number %d", (int)settings->method);
  if ((unsigned)settings->framebuffer > CELLIST_FRAMEBUFFER_8)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "no framebuffer has the number %d",
                        (int)settings->framebuffer);
  return check_groups(gl, order_count, settings);
}

enum { GL_CHUNK_GROUPS = 1024 }; /* small groups of a chunk, at most */

/* Fans have no gradients at points: what is lit by them is left to faces. */
static bool draws_fans(const gl_drawing *drawing) {
  return drawing->settings->method == CELLIST_GL_FAN && drawing->cells.light.gradients == NULL;
}

/* Draws order[begin..end) with the small groups in it. */
static cellist_result draw_range(gl_drawing *drawing, const uint32_t *order, size_t begin, size_t end,
                                 const cellist_gl_group *groups, size_t group_count) {
  cellist_gl *gl = drawing->gl;
  cellist_gl_group inside[GL_CHUNK_GROUPS];
  while (begin < end) {
    size_t to = end - begin > gl->chunk_cells ? begin + gl->chunk_cells : end, used = 0, pieces = 0;
    for (; used < group_count && groups[used].begin < to; used++) {
      if (used == GL_CHUNK_GROUPS || groups[used].begin + groups[used].count > to) {
        to = groups[used].begin;
        break;
      }
      inside[used] = (cellist_gl_group){groups[used].begin - begin, groups[used].count};
    }
    const gl_stage stage = draws_fans(drawing) ? GL_STAGE_FAN : GL_STAGE_BLEND;
    cellist_result result = gl_batch_send(drawing, stage, order + begin, to - begin, inside, used, &pieces);
    if (result == CELLIST_SUCCESS) result = gl_batch_draw(drawing, pieces, stage);
    if (result == CELLIST_SUCCESS)
      result = cellist_progress(gl->context, "projecting", (double)begin / (double)drawing->order_count);
    if (result != CELLIST_SUCCESS) return result;
    groups += used;
    group_count -= used;
    begin = to;
  }
  return CELLIST_SUCCESS;
}

/* The same with its fragments counted. */
static cellist_result draw_counted(gl_drawing *drawing, const uint32_t *order, size_t begin, size_t end,
                                   const cellist_gl_group *groups, size_t group_count) {
  const gl_api *api = &drawing->gl->api;
  GLuint64 fragments = 0;
  if (begin == end) return CELLIST_SUCCESS;
  api->BeginQuery(GL_SAMPLES_PASSED, drawing->gl->query);
  const cellist_result result = draw_range(drawing, order, begin, end, groups, group_count);
  api->EndQuery(GL_SAMPLES_PASSED);
  api->GetQueryObjectui64v(drawing->gl->query, GL_QUERY_RESULT, &fragments);
  drawing->stats.fragment_count += fragments;
  return result;
}

/* Draws the order: what lies between two large groups is drawn together. */
static cellist_result draw_order(gl_drawing *drawing, const uint32_t *order) {
  const cellist_gl_settings *settings = drawing->settings;
  const cellist_model model = settings->optics.model;
  const bool commutes = model == CELLIST_MODEL_EMISSION || model == CELLIST_MODEL_ABSORPTION ||
                        model == CELLIST_MODEL_MAXIMUM; /* then any order is right, in groups too */
  const size_t group_count = commutes ? 0 : settings->group_count;
  size_t begin = 0, first = 0;
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < group_count && result == CELLIST_SUCCESS; i++) {
    const cellist_gl_group *group = &settings->groups[i];
    if (gl_group_is_small(drawing, group)) continue;
    result = draw_counted(drawing, order, begin, group->begin, settings->groups + first, i - first);
    if (result == CELLIST_SUCCESS) result = gl_group_draw(drawing, order + group->begin, group->count);
    begin = group->begin + group->count;
    first = i + 1;
  }
  if (result != CELLIST_SUCCESS) return result;
  return draw_counted(drawing, order, begin, drawing->order_count, group_count > 0 ? settings->groups + first : NULL,
                      group_count - first);
}

static void bind_buffers(gl_drawing *drawing) {
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  const GLuint textures[] = {[GL_UNIT_RECORDS] = gl->record_texture,
                             [GL_UNIT_INTERVALS] = gl->interval_texture,
                             [GL_UNIT_EXTRAS] = gl->extra_texture,
                             [GL_UNIT_LIGHTS] = gl->light_texture};
  api->BindBuffer(GL_TEXTURE_BUFFER, gl->interval_buffer);
  api->BufferData(GL_TEXTURE_BUFFER,
                  (GLsizeiptr)((drawing->intervals.knot_count + 1) * GL_INTERVAL_FLOATS * sizeof(float)),
                  drawing->intervals.texels, GL_STREAM_DRAW);
  for (GLenum i = 0; i < sizeof textures / sizeof textures[0]; i++) {
    api->ActiveTexture(GL_TEXTURE0 + i);
    api->BindTexture(GL_TEXTURE_BUFFER, textures[i]);
  }
}

/* No segment in a cell is longer than its longest edge. */
static double longest_edge(const cellist_mesh_arrays *mesh) {
  static const uint8_t ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  double longest = 0;
  for (size_t i = 0; i < 6 * mesh->tet_count; i++) {
    const uint32_t *v = &mesh->tets[4 * (i / 6)];
    const double *a = &mesh->positions[3 * (size_t)v[ends[i % 6][0]]];
    const double *b = &mesh->positions[3 * (size_t)v[ends[i % 6][1]]];
    longest = fmax(longest, hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]));
  }
  return longest;
}

/* What the integrator looks up; kept from frame to frame. */
static cellist_result prepare_tables(const gl_drawing *drawing) {
  cellist_gl *gl = drawing->gl;
  const cellist_optics *optics = &drawing->settings->optics;
  const gl_integrator integrator = gl_integrator_of(optics);
  if (integrator == GL_INTEGRATOR_TABLE && gl->longest < 0) gl->longest = longest_edge(gl->mesh.arrays);
  const gl_tables_use use = {.integrator = integrator,
                             .lit = drawing->cells.light.gradients != NULL,
                             .black = optics->model == CELLIST_MODEL_ABSORPTION,
                             .transfer = drawing->transfer,
                             .size = optics->table_size,
                             .scale = gl->scale,
                             .longest = gl->longest};
  gl->api.ActiveTexture(GL_TEXTURE0 + GL_UNIT_TABLES);
  return gl_tables_prepare(gl->context, &gl->api, &use, &gl->tables);
}

/* What ends the rays of cells: the surface, drawn first, and clip planes. */
static cellist_result draw_surface(gl_drawing *drawing) {
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  const cellist_surface *surface = drawing->settings->surface;
  const cellist_light *light = &drawing->settings->optics.light;
  drawing->with_limits = drawing->frame->clip_count > 0 || surface != NULL;
  if (!drawing->with_limits) return CELLIST_SUCCESS;
  const bool by_gl = surface != NULL && gl_surface_fits(api, surface);
  cellist_result result = CELLIST_SUCCESS;
  if (!by_gl) result = surface_layer_make(gl->context, surface, drawing->frame, light, &drawing->layer);
  api->ActiveTexture(GL_TEXTURE0 + GL_UNIT_LIMITS);
  if (result == CELLIST_SUCCESS)
    result = gl_limits_make(gl->context, api, drawing->frame, drawing->cells.unit, &drawing->layer, by_gl, &gl->limits);
  if (result != CELLIST_SUCCESS || !by_gl) return result;
  result = gl_surface_draw(gl->context, api, surface, drawing->frame, drawing->cells.unit, light, gl->no_vertices,
                           GL_UNIT_SURFACE, &gl->limits, &gl->surface, &drawing->layer);
  api->ActiveTexture(GL_TEXTURE0 + GL_UNIT_LIMITS);
  api->BindTexture(GL_TEXTURE_2D, gl->limits.behind);
  return result;
}

/* With the OpenGL context current. */
static cellist_result draw(gl_drawing *drawing, const uint32_t *order, cellist_image *image) {
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  const cellist_frame *frame = drawing->frame;
  const bool maximum = drawing->settings->optics.model == CELLIST_MODEL_MAXIMUM;
  drawing->with_depth = cellist_image_channel(image, "Z") != NULL || cellist_image_channel(image, "ZBack") != NULL;
  cellist_result result =
      gl_target_begin(gl->context, api, &gl->target, frame->width, frame->height,
                      maximum ? CELLIST_FRAMEBUFFER_32F : drawing->settings->framebuffer, drawing->with_depth, maximum);
  if (result != CELLIST_SUCCESS) return result;
  result = draw_surface(drawing);
  if (result != CELLIST_SUCCESS) return result;
  gl_target_use(api, &gl->target, maximum);
  bind_buffers(drawing);
  result = prepare_tables(drawing);
  if (result == CELLIST_SUCCESS) result = draw_order(drawing, order);
  if (result == CELLIST_SUCCESS) result = gl_check_errors(gl, "drawing");
  if (result == CELLIST_SUCCESS)
    result = gl_target_read(gl->context, api, &gl->target, maximum ? drawing->transfer : NULL, gl->scale,
                            drawing->cells.unit, &drawing->layer, image);
  return result;
}

/* The frame's light; gradients at points are made when first asked for. */
static cellist_result make_light(cellist_gl *gl, const cellist_frame *frame, const cellist_optics *optics,
                                 gl_light *light) {
  *light = gl_light_of_frame(optics, frame);
  if (!light->enabled || light->light.cell_gradients) return CELLIST_SUCCESS;
  if (gl->gradients == NULL) {
    double *made = cellist_allocate(gl->context, gl->mesh.arrays->point_count, 3 * sizeof *made);
    if (made == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    const cellist_result result = cellist_gradients_at_points(gl->context, gl->source, gl->scalar, made);
    if (result != CELLIST_SUCCESS) {
      cellist_deallocate(gl->context, made);
      return result;
    }
    gl->gradients = made;
  }
  light->gradients = gl->gradients;
  return CELLIST_SUCCESS;
}

cellist_result cellist_gl_render(cellist_gl *gl, const cellist_frame *frame, const cellist_transfer *transfer,
                                 const uint32_t *order, size_t order_count, const cellist_gl_settings *settings,
                                 cellist_image *image, cellist_gl_stats *stats) {
  if (gl == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  static const cellist_gl_settings defaults = {0};
  if (settings == NULL) settings = &defaults;
  cellist_context *context = gl->context;
  cellist_result result = check_arguments(gl, frame, order, order_count, settings, image);
  if (result != CELLIST_SUCCESS) return result;

  gl->frame_count++;
  gl_drawing drawing = {
      .gl = gl, .frame = frame, .transfer = transfer, .settings = settings, .order_count = order_count};
  gl_light light;
  result = make_light(gl, frame, &settings->optics, &light);
  if (result != CELLIST_SUCCESS) return result;
  result = gl_intervals_make(context, transfer, &settings->optics, gl->scale, gl_unit_of(gl->mesh.arrays),
                             &drawing.intervals);
  if (result != CELLIST_SUCCESS) return result;
  /* Corners are moved by half a step each way, and have float's digits before. */
  const double margin = gl->subpixel + fmax(frame->width, frame->height) * FLT_EPSILON;
  result = gl_cells_begin(context, &gl->mesh, frame, &drawing.intervals, &light, margin, &drawing.cells);
  if (result == CELLIST_SUCCESS) {
    result = enter(gl);
    if (result == CELLIST_SUCCESS) {
      result = draw(&drawing, order, image);
      gl->backend->leave(gl->state);
    }
    surface_layer_release(context, &drawing.layer);
    gl_cells_release(&drawing.cells);
  }
  gl_intervals_release(context, &drawing.intervals);
  if (settings->method == CELLIST_GL_FAN && light.gradients != NULL)
    drawing.stats.left_count = drawing.stats.cell_count;
  if (result == CELLIST_SUCCESS && stats != NULL) *stats = drawing.stats;
  return result;
}
