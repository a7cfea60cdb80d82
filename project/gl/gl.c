/* SPDX-License-Identifier: BSD-3-Clause
 * Renderer through OpenGL: context, mesh and frame. A frame goes through in chunks of cells: the processor's threads
 * write each cell's footprint and record straight into OpenGL's buffers, then the chunk is drawn. */
#include <cellist/gl.h>
#include <cellist/gradients.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cells.h"
#include "context.h"
#include "integrators.h"
#include "program.h"
#include "target.h"

extern const char cellist_text_faces_vert[], cellist_text_faces_frag[];

/* Cells a chunk: 184 bytes each (232 with gradients) then stay below 8 MB, and the chunks are few. */
enum { CHUNK_CELLS = 32768, CHUNK_GRAINS = CHUNK_CELLS / GL_CELLS_GRAIN };

/* A program for each projection, with and without depth, with and without light by gradients at points, and each
 * integrator. */
enum {
  VARIANT_PARALLEL = 1,
  VARIANT_DEPTH = 2,
  VARIANT_LIT = 4,
  VARIANT_INTEGRATOR = 8,
  VARIANT_COUNT = VARIANT_INTEGRATOR * GL_INTEGRATOR_COUNT
};
/* Texture units. */
enum { UNIT_RECORDS, UNIT_INTERVALS, UNIT_LIGHTS };

struct cellist_gl {
  cellist_context *context;
  const gl_backend *backend;
  void *state;
  gl_api api;
  char *device_name;
  size_t chunk_cells;
  double subpixel;    /* step of the grid that corners are moved to, in pixels */
  gl_cells_mesh mesh; /* arrays NULL: nothing uploaded */
  const cellist_mesh *source;
  const cellist_scalar *scalar;
  double *gradients; /* [3 points] once a frame was lit by them */
  gl_scale scale;
  gl_target target;
  GLuint programs[VARIANT_COUNT];
  GLuint query, vertices;
  GLuint corner_buffer;
  GLuint record_buffer, record_texture;
  GLuint interval_buffer, interval_texture;
  GLuint light_buffer, light_texture;
};

static cellist_result enter(cellist_gl *gl) {
  if (gl->backend->enter(gl->state)) return CELLIST_SUCCESS;
  return cellist_fail(gl->context, CELLIST_ERROR_GRAPHICS, "the OpenGL context of %s cannot be made current",
                      gl->backend->name);
}

/* The first error of a whole call; out-of-memory has its own result. */
static cellist_result check_errors(cellist_gl *gl, const char *what) {
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
  if (gl->chunk_cells > CHUNK_CELLS) gl->chunk_cells = CHUNK_CELLS;

  GLint subpixel_bits = 0;
  api->GetIntegerv(GL_SUBPIXEL_BITS, &subpixel_bits);
  gl->subpixel = ldexp(1, -subpixel_bits);

  api->GenQueries(1, &gl->query);
  make_texture_buffer(gl, &gl->record_buffer, &gl->record_texture);
  make_texture_buffer(gl, &gl->interval_buffer, &gl->interval_texture);
  make_texture_buffer(gl, &gl->light_buffer, &gl->light_texture);
  api->GenVertexArrays(1, &gl->vertices);
  api->BindVertexArray(gl->vertices);
  api->GenBuffers(1, &gl->corner_buffer);
  api->BindBuffer(GL_ARRAY_BUFFER, gl->corner_buffer);
  api->EnableVertexAttribArray(0);
  api->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
  return check_errors(gl, "setting up");
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
  gl_target_release(api, &gl->target);
  for (int i = 0; i < VARIANT_COUNT; i++)
    if (gl->programs[i] != 0) api->DeleteProgram(gl->programs[i]);
  const GLuint textures[] = {gl->record_texture, gl->interval_texture, gl->light_texture};
  const GLuint buffers[] = {gl->record_buffer, gl->interval_buffer, gl->light_buffer, gl->corner_buffer};
  api->DeleteTextures(sizeof textures / sizeof *textures, textures);
  api->DeleteVertexArrays(1, &gl->vertices);
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
  gl_cells_mesh_release(gl->context, &gl->mesh);
  cellist_deallocate(gl->context, gl->gradients);
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
  gl->scale = gl_scale_of(scalar);
  return CELLIST_SUCCESS;
}

/* One call to render. */
struct drawing {
  cellist_gl *gl;
  const cellist_frame *frame;
  const cellist_transfer *transfer;
  const cellist_optics *optics;
  const uint32_t *order;
  size_t order_count;
  gl_intervals intervals;
  gl_cells cells;
  cellist_gl_stats stats;
};

static cellist_result check_arguments(const cellist_gl *gl, const cellist_frame *frame, const uint32_t *order,
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
  if (settings->optics.sample_count > 4)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a segment has 1 to 4 samples, not %u",
                        settings->optics.sample_count);
  if ((unsigned)settings->framebuffer > CELLIST_FRAMEBUFFER_8)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "no framebuffer has the number %d",
                        (int)settings->framebuffer);
  return CELLIST_SUCCESS;
}

static cellist_result build_program(cellist_gl *gl, unsigned variant) {
  static const char *const vertex[] = {cellist_text_faces_vert, NULL};
  const char *fragment[GL_INTEGRATOR_TEXTS + 1];
  const char *before =
      gl_integrator_texts((gl_integrator)(variant / VARIANT_INTEGRATOR), variant & VARIANT_LIT, fragment);
  size_t count = 0;
  while (fragment[count] != NULL) count++;
  fragment[count++] = cellist_text_faces_frag;
  fragment[count] = NULL;
  char defines[256];
  snprintf(defines, sizeof defines, "%s%s%s", before, variant & VARIANT_PARALLEL ? "#define PARALLEL\n" : "",
           variant & VARIANT_DEPTH ? "#define WITH_DEPTH\n" : "");
  return gl_program_build(gl->context, &gl->api, defines, vertex, fragment, &gl->programs[variant]);
}

static void set_light(cellist_gl *gl, GLuint program, const gl_light *light, uint32_t sample_count) {
  const gl_api *api = &gl->api;
  const double *l = light->towards, *h = light->halfway;
  api->Uniform1i(api->GetUniformLocation(program, "lights"), UNIT_LIGHTS);
  api->Uniform1i(api->GetUniformLocation(program, "samples"), sample_count > 0 ? (GLint)sample_count : 1);
  api->Uniform3f(api->GetUniformLocation(program, "towards"), (float)l[0], (float)l[1], (float)l[2]);
  api->Uniform3f(api->GetUniformLocation(program, "halfway"), (float)h[0], (float)h[1], (float)h[2]);
  api->Uniform4f(api->GetUniformLocation(program, "shares"), (float)light->light.ambient, (float)light->light.diffuse,
                 (float)light->light.specular, (float)light->light.shininess);
}

static cellist_result use_program(cellist_gl *gl, unsigned variant, const struct drawing *drawing) {
  const gl_api *api = &gl->api;
  const cellist_frame *frame = drawing->frame;
  if (gl->programs[variant] == 0) {
    const cellist_result result = build_program(gl, variant);
    if (result != CELLIST_SUCCESS) return result;
  }
  const GLuint program = gl->programs[variant];
  api->UseProgram(program);
  api->Uniform1i(api->GetUniformLocation(program, "records"), UNIT_RECORDS);
  api->Uniform1i(api->GetUniformLocation(program, "intervals"), UNIT_INTERVALS);
  api->Uniform1f(api->GetUniformLocation(program, "near_distance"), (float)frame->near_distance);
  api->Uniform2f(api->GetUniformLocation(program, "centre"), 0.5f * (float)frame->width, 0.5f * (float)frame->height);
  api->Uniform2f(api->GetUniformLocation(program, "slope"), (float)(2 * frame->half_width / frame->width),
                 (float)(2 * frame->half_height / frame->height));
  if (variant & VARIANT_LIT) set_light(gl, program, &drawing->cells.light, drawing->optics->sample_count);
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

static cellist_result draw_chunk(struct drawing *drawing, const uint32_t *order, size_t count) {
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  const bool lit = drawing->cells.light.gradients != NULL;
  gl_cells_output output = {NULL, NULL, NULL};
  output.records = map_buffer(api, GL_TEXTURE_BUFFER, gl->record_buffer, count * sizeof *output.records);
  if (lit) output.lights = map_buffer(api, GL_TEXTURE_BUFFER, gl->light_buffer, count * sizeof *output.lights);
  output.corners =
      map_buffer(api, GL_ARRAY_BUFFER, gl->corner_buffer, count * 3 * GL_CELLS_TRIANGLES * sizeof *output.corners);
  gl_cells_count counts[CHUNK_GRAINS];
  if (output.records != NULL && output.corners != NULL && lit == (output.lights != NULL))
    gl_cells_prepare(&drawing->cells, order, count, &output, counts);
  bool kept = unmap_buffer(api, GL_TEXTURE_BUFFER, gl->record_buffer, output.records);
  if (lit) kept = unmap_buffer(api, GL_TEXTURE_BUFFER, gl->light_buffer, output.lights) && kept;
  kept = unmap_buffer(api, GL_ARRAY_BUFFER, gl->corner_buffer, output.corners) && kept;
  if (!kept) return cellist_fail(gl->context, CELLIST_ERROR_OUT_OF_MEMORY, "OpenGL has no buffer for %zu cells", count);
  GLint begins[CHUNK_GRAINS];
  GLsizei sizes[CHUNK_GRAINS], draws = 0;
  for (size_t i = 0; i * GL_CELLS_GRAIN < count; i++) {
    drawing->stats.cell_count += counts[i].cells;
    drawing->stats.triangle_count += counts[i].corners / 3;
    if (counts[i].corners == 0) continue;
    begins[draws] = (GLint)(i * 3 * GL_CELLS_TRIANGLES * GL_CELLS_GRAIN);
    sizes[draws++] = (GLsizei)counts[i].corners;
  }
  if (draws > 0) api->MultiDrawArrays(GL_TRIANGLES, begins, sizes, draws);
  return CELLIST_SUCCESS;
}

/* With the OpenGL context current. */
static cellist_result draw(struct drawing *drawing, const cellist_gl_settings *settings, cellist_image *image) {
  cellist_gl *gl = drawing->gl;
  const gl_api *api = &gl->api;
  const cellist_frame *frame = drawing->frame;
  const bool maximum = settings->optics.model == CELLIST_MODEL_MAXIMUM;
  const bool with_depth = cellist_image_channel(image, "Z") != NULL || cellist_image_channel(image, "ZBack") != NULL;
  cellist_result result =
      gl_target_begin(gl->context, api, &gl->target, frame->width, frame->height,
                      maximum ? CELLIST_FRAMEBUFFER_32F : settings->framebuffer, with_depth, maximum);
  if (result == CELLIST_SUCCESS)
    result = use_program(gl,
                         (frame->parallel ? VARIANT_PARALLEL : 0) | (with_depth ? VARIANT_DEPTH : 0) |
                             (drawing->cells.light.gradients != NULL ? VARIANT_LIT : 0) |
                             VARIANT_INTEGRATOR * (unsigned)gl_integrator_of(&settings->optics),
                         drawing);
  if (result != CELLIST_SUCCESS) return result;

  api->BindVertexArray(gl->vertices);
  api->BindBuffer(GL_ARRAY_BUFFER, gl->corner_buffer);
  api->BindBuffer(GL_TEXTURE_BUFFER, gl->interval_buffer);
  api->BufferData(GL_TEXTURE_BUFFER,
                  (GLsizeiptr)((drawing->intervals.knot_count + 1) * GL_INTERVAL_FLOATS * sizeof(float)),
                  drawing->intervals.texels, GL_STREAM_DRAW);
  api->ActiveTexture(GL_TEXTURE0 + UNIT_RECORDS);
  api->BindTexture(GL_TEXTURE_BUFFER, gl->record_texture);
  api->ActiveTexture(GL_TEXTURE0 + UNIT_INTERVALS);
  api->BindTexture(GL_TEXTURE_BUFFER, gl->interval_texture);
  api->ActiveTexture(GL_TEXTURE0 + UNIT_LIGHTS);
  api->BindTexture(GL_TEXTURE_BUFFER, gl->light_texture);

  api->BeginQuery(GL_SAMPLES_PASSED, gl->query);
  for (size_t begin = 0; begin < drawing->order_count && result == CELLIST_SUCCESS; begin += gl->chunk_cells) {
    const size_t left = drawing->order_count - begin;
    result = draw_chunk(drawing, drawing->order + begin, left < gl->chunk_cells ? left : gl->chunk_cells);
    if (result == CELLIST_SUCCESS)
      result = cellist_progress(gl->context, "drawing", (double)begin / (double)drawing->order_count);
  }
  api->EndQuery(GL_SAMPLES_PASSED);
  if (result != CELLIST_SUCCESS) return result;
  api->GetQueryObjectui64v(gl->query, GL_QUERY_RESULT, &drawing->stats.fragment_count);
  result = check_errors(gl, "drawing");
  if (result == CELLIST_SUCCESS)
    result = gl_target_read(gl->context, api, &gl->target, maximum ? drawing->transfer : NULL, gl->scale, image);
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

  struct drawing drawing = {.gl = gl,
                            .frame = frame,
                            .transfer = transfer,
                            .optics = &settings->optics,
                            .order = order,
                            .order_count = order_count};
  gl_light light;
  result = make_light(gl, frame, &settings->optics, &light);
  if (result != CELLIST_SUCCESS) return result;
  result = gl_intervals_make(context, transfer, &settings->optics, gl->scale, &drawing.intervals);
  if (result != CELLIST_SUCCESS) return result;
  /* Corners are moved by half a step each way, and have float's digits before. */
  const double margin = gl->subpixel + fmax(frame->width, frame->height) * FLT_EPSILON;
  result = gl_cells_begin(context, &gl->mesh, frame, &drawing.intervals, &light, margin, &drawing.cells);
  if (result == CELLIST_SUCCESS) {
    result = enter(gl);
    if (result == CELLIST_SUCCESS) {
      result = draw(&drawing, settings, image);
      gl->backend->leave(gl->state);
    }
    gl_cells_release(&drawing.cells);
  }
  gl_intervals_release(context, &drawing.intervals);
  if (result == CELLIST_SUCCESS && stats != NULL) *stats = drawing.stats;
  return result;
}
