/* SPDX-License-Identifier: BSD-3-Clause
 * Surface: triangles by the rasteriser, depths by the fragment program. The rasteriser moves corners to 1/256 pixel,
 * which decides about pixels at a silhouette only: a depth is that of the pixel's ray and the triangle's plane. */
#include "surface.h"

#include <math.h>
#include <string.h>

#include "program.h"

extern const char cellist_text_surface_vert[], cellist_text_surface_frag[];

/* Nothing is drawn nearer than this share of the surface's farthest depth. Larger: what is close to the eye is lost;
 * smaller: clipping against it loses its digits. */
static const double LEAST_SHARE = 1e-6;

enum { POINTS, NORMALS, COLOURS, TRIANGLES };

bool gl_surface_fits(const gl_api *api, const cellist_surface *surface) {
  const cellist_surface_arrays *arrays = cellist_surface_get_arrays(surface);
  GLint texels = 0;
  api->GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  return arrays->point_count <= (size_t)texels && 3 * arrays->triangle_count <= (size_t)texels;
}

void gl_surface_release(const gl_api *api, gl_surface *kept) {
  const GLuint textures[] = {kept->colour, kept->depth}; /* names of 0 are overlooked */
  api->DeleteFramebuffers(1, &kept->framebuffer);
  api->DeleteTextures(2, textures);
  api->DeleteTextures(4, kept->textures);
  api->DeleteBuffers(4, kept->buffers);
  for (int i = 0; i < 2; i++)
    if (kept->programs[i] != 0) api->DeleteProgram(kept->programs[i]);
  *kept = (gl_surface){0};
}

static void send_array(const gl_api *api, gl_surface *kept, int which, GLenum format, size_t bytes, const void *data) {
  if (kept->buffers[which] == 0) {
    api->GenBuffers(1, &kept->buffers[which]);
    api->GenTextures(1, &kept->textures[which]);
  }
  api->BindBuffer(GL_TEXTURE_BUFFER, kept->buffers[which]);
  api->BufferData(GL_TEXTURE_BUFFER, (GLsizeiptr)bytes, data, GL_STATIC_DRAW);
  api->BindTexture(GL_TEXTURE_BUFFER, kept->textures[which]);
  api->TexBuffer(GL_TEXTURE_BUFFER, format, kept->buffers[which]);
}

static cellist_result send(cellist_context *context, const gl_api *api, const cellist_surface *surface,
                           gl_surface *kept) {
  if (kept->sent && kept->checksum == surface_checksum(surface)) return CELLIST_SUCCESS;
  const cellist_surface_arrays *arrays = cellist_surface_get_arrays(surface);
  const size_t count = 3 * arrays->point_count, bytes = count * sizeof(float);
  float *numbers = cellist_allocate(context, arrays->point_count, 3 * sizeof *numbers);
  if (numbers == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  double bounds[6];
  cellist_surface_bounds(surface, bounds);
  kept->sent = false;
  kept->unit = 0;
  for (int k = 0; k < 3; k++) {
    kept->middle[k] = 0.5 * bounds[k] + 0.5 * bounds[3 + k];
    kept->unit = fmax(kept->unit, 0.5 * bounds[3 + k] - 0.5 * bounds[k]);
  }
  if (!(kept->unit > 0)) kept->unit = 1;
  for (size_t i = 0; i < count; i++) numbers[i] = (float)((arrays->positions[i] - kept->middle[i % 3]) / kept->unit);
  send_array(api, kept, POINTS, GL_RGB32F, bytes, numbers);
  for (size_t i = 0; i < count; i++) numbers[i] = arrays->normals != NULL ? (float)arrays->normals[i] : 0;
  send_array(api, kept, NORMALS, GL_RGB32F, arrays->normals != NULL ? bytes : 3 * sizeof(float), numbers);
  send_array(api, kept, COLOURS, GL_RGB32F, bytes, arrays->colours);
  send_array(api, kept, TRIANGLES, GL_R32UI, 3 * arrays->triangle_count * sizeof(uint32_t), arrays->triangles);
  cellist_deallocate(context, numbers);
  kept->checksum = surface_checksum(surface);
  kept->sent = true;
  return CELLIST_SUCCESS;
}

static GLuint make_texture(const gl_api *api, GLint inner, GLenum format, const cellist_frame *frame) {
  GLuint texture = 0;
  api->GenTextures(1, &texture);
  api->BindTexture(GL_TEXTURE_2D, texture);
  api->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  api->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  api->TexImage2D(GL_TEXTURE_2D, 0, inner, (GLsizei)frame->width, (GLsizei)frame->height, 0, format, GL_FLOAT, NULL);
  return texture;
}

/* The framebuffer of this frame, empty; the limits' second texture is where the new limits go. */
static cellist_result begin(cellist_context *context, const gl_api *api, const cellist_frame *frame, gl_surface *kept,
                            const gl_limits *limits) {
  static const GLenum attachments[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  static const GLfloat nothing[4] = {0, 0, 0, 0};
  if (kept->framebuffer == 0) api->GenFramebuffers(1, &kept->framebuffer);
  if (kept->width != frame->width || kept->height != frame->height) {
    const GLuint old[2] = {kept->colour, kept->depth};
    api->DeleteTextures(2, old);
    kept->colour = make_texture(api, GL_RGBA32F, GL_RGBA, frame);
    kept->depth = make_texture(api, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, frame);
    kept->width = frame->width;
    kept->height = frame->height;
  }
  api->BindFramebuffer(GL_FRAMEBUFFER, kept->framebuffer);
  api->FramebufferTexture2D(GL_FRAMEBUFFER, attachments[0], GL_TEXTURE_2D, kept->colour, 0);
  api->FramebufferTexture2D(GL_FRAMEBUFFER, attachments[1], GL_TEXTURE_2D, limits->behind, 0);
  api->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, kept->depth, 0);
  api->DrawBuffers(2, attachments);
  const GLenum status = api->CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    return cellist_fail(context, CELLIST_ERROR_GRAPHICS, "no framebuffer for a surface of %ux%u pixels (status 0x%x)",
                        frame->width, frame->height, status);
  const GLfloat farthest = 0;
  api->Viewport(0, 0, (GLsizei)frame->width, (GLsizei)frame->height);
  api->Disable(GL_BLEND);
  api->Disable(GL_CULL_FACE);
  api->Enable(GL_DEPTH_TEST);
  api->DepthFunc(GL_GREATER); /* gl_FragDepth grows towards the eye, where floats have their digits */
  api->ClearBufferfv(GL_COLOR, 0, nothing);
  api->ClearBufferfv(GL_DEPTH, 0, &farthest);
  return CELLIST_SUCCESS;
}

static void set_vector(const gl_api *api, GLuint program, const char *name, const double v[3]) {
  api->Uniform3f(api->GetUniformLocation(program, name), (float)v[0], (float)v[1], (float)v[2]);
}

/* range: nearest and farthest depth of the surface's bounds. */
static void set_uniforms(const gl_api *api, GLuint program, const cellist_surface *surface, const cellist_frame *frame,
                         double length_unit, const cellist_light *light, const gl_surface *kept, const double range[2],
                         unsigned first_unit) {
  static const char *const arrays[] = {"points", "normals", "colours", "triangles"};
  const double unit = kept->unit, size = frame->parallel ? unit : 1;
  const double least = fmax(frame->near_distance, LEAST_SHARE * range[1]);
  const surface_light lit = surface_light_of(light, frame);
  double eye[3];
  for (int k = 0; k < 3; k++) eye[k] = (frame->eye[k] - kept->middle[k]) / unit;
  for (unsigned i = 0; i < 4; i++) {
    api->Uniform1i(api->GetUniformLocation(program, arrays[i]), (GLint)(first_unit + i));
    api->ActiveTexture(GL_TEXTURE0 + first_unit + i);
    api->BindTexture(GL_TEXTURE_BUFFER, kept->textures[i]);
  }
  api->Uniform1i(api->GetUniformLocation(program, "limits"), (GLint)(first_unit + 4));
  set_vector(api, program, "right", frame->right);
  set_vector(api, program, "up", frame->up);
  set_vector(api, program, "forward", frame->forward);
  set_vector(api, program, "eye", eye);
  set_vector(api, program, "towards", lit.towards);
  set_vector(api, program, "halfway", lit.halfway);
  api->Uniform4f(api->GetUniformLocation(program, "shares"), (float)lit.ambient, (float)lit.diffuse,
                 (float)lit.specular, (float)lit.shininess);
  api->Uniform2f(api->GetUniformLocation(program, "scale"), (float)(size / frame->half_width),
                 (float)(size / frame->half_height));
  api->Uniform2f(api->GetUniformLocation(program, "centre"), 0.5f * (float)frame->width, 0.5f * (float)frame->height);
  api->Uniform2f(api->GetUniformLocation(program, "slope"), (float)(2 * frame->half_width / frame->width / size),
                 (float)(2 * frame->half_height / frame->height / size));
  api->Uniform1f(api->GetUniformLocation(program, "unit"), (float)(unit / length_unit));
  api->Uniform1f(api->GetUniformLocation(program, "least"), (float)(least / unit));
  const double span = range[1] > range[0] ? range[1] - range[0] : 1;
  if (frame->parallel)
    api->Uniform2f(api->GetUniformLocation(program, "nearness"), (float)((range[0] - 0.01 * span) / length_unit),
                   (float)(0.9 / (span / length_unit)));
  else
    api->Uniform2f(api->GetUniformLocation(program, "nearness"), (float)(least / length_unit), 0);
  api->Uniform1i(api->GetUniformLocation(program, "smooth_shaded"),
                 cellist_surface_get_arrays(surface)->normals != NULL);
}

static void find_range(const cellist_surface *surface, const cellist_frame *frame, double range[2]) {
  double bounds[6];
  cellist_surface_bounds(surface, bounds);
  range[0] = HUGE_VAL;
  range[1] = -HUGE_VAL;
  for (int c = 0; c < 8; c++) {
    double depth = 0;
    for (int k = 0; k < 3; k++) depth += (bounds[k + (c >> k & 1 ? 3 : 0)] - frame->eye[k]) * frame->forward[k];
    range[0] = fmin(range[0], depth);
    range[1] = fmax(range[1], depth);
  }
}

/* OpenGL's rows go up, a layer's go down. */
static cellist_result read_layer(cellist_context *context, const gl_api *api, const cellist_frame *frame,
                                 double length_unit, surface_layer *layer) {
  const size_t width = frame->width, height = frame->height;
  float *pixels = cellist_allocate(context, width * height, 4 * sizeof *pixels);
  surface_layer made = {.width = frame->width, .height = frame->height};
  made.depth = cellist_allocate(context, width * height, sizeof *made.depth);
  made.colours = cellist_allocate(context, width * height, 3 * sizeof *made.colours);
  if (pixels == NULL || made.depth == NULL || made.colours == NULL) {
    cellist_deallocate(context, pixels);
    surface_layer_release(context, &made);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  api->PixelStorei(GL_PACK_ALIGNMENT, 4);
  api->ReadBuffer(GL_COLOR_ATTACHMENT0);
  api->ReadPixels(0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA, GL_FLOAT, pixels);
  for (size_t y = 0; y < height; y++)
    for (size_t x = 0; x < width; x++) {
      const float *pixel = &pixels[4 * ((height - 1 - y) * width + x)];
      made.depth[y * width + x] = pixel[3] > 0 ? (double)pixel[3] * length_unit : HUGE_VAL; /* cleared to 0 */
      memcpy(&made.colours[3 * (y * width + x)], pixel, 3 * sizeof *pixel);
    }
  cellist_deallocate(context, pixels);
  *layer = made;
  return CELLIST_SUCCESS;
}

cellist_result gl_surface_draw(cellist_context *context, const gl_api *api, const cellist_surface *surface,
                               const cellist_frame *frame, double length_unit, const cellist_light *light,
                               GLuint vertices, unsigned first_unit, gl_limits *limits, gl_surface *kept,
                               surface_layer *layer) {
  GLuint *program = &kept->programs[frame->parallel];
  cellist_result result = CELLIST_SUCCESS;
  if (*program == 0) {
    const char *const vertex[] = {cellist_text_surface_vert, NULL}, *const fragment[] = {cellist_text_surface_frag,
                                                                                         NULL};
    result =
        gl_program_build(context, api, 410, frame->parallel ? "#define PARALLEL\n" : "", vertex, fragment, program);
  }
  api->ActiveTexture(GL_TEXTURE0 + first_unit);
  if (result == CELLIST_SUCCESS) result = send(context, api, surface, kept);
  if (result == CELLIST_SUCCESS) result = begin(context, api, frame, kept, limits);
  if (result != CELLIST_SUCCESS) return result;
  double range[2];
  find_range(surface, frame, range);
  const size_t count = cellist_surface_get_arrays(surface)->triangle_count;
  if (count > 0 && range[1] > 0) {
    api->UseProgram(*program);
    set_uniforms(api, *program, surface, frame, length_unit, light, kept, range, first_unit);
    api->ActiveTexture(GL_TEXTURE0 + first_unit + 4);
    api->BindTexture(GL_TEXTURE_2D, limits->texture);
    api->BindVertexArray(vertices);
    api->DrawArrays(GL_TRIANGLES, 0, (GLsizei)(3 * count));
  }
  api->Disable(GL_DEPTH_TEST);
  return read_layer(context, api, frame, length_unit, layer);
}
