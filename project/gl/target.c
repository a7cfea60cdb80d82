/* SPDX-License-Identifier: BSD-3-Clause
 * Target: renderbuffers for colour and, if the image wants it, depth. Depth is blended by its maximum (of -front and
 * of back), so it does not depend on the order. */
#include "target.h"

#include <math.h>

static const GLfloat EMPTY[4] = {0, 0, 0, 0};
static const GLfloat LEAST[4] = {-INFINITY, 0, 0, 0};
static const GLfloat NO_DEPTH[4] = {-INFINITY, 0, 0, 0};

void gl_target_release(cellist_context *context, const gl_api *api, gl_target *target) {
  cellist_deallocate(context, target->pixels);
  target->pixels = NULL;
  if (api == NULL) return;
  if (target->framebuffer != 0) api->DeleteFramebuffers(1, &target->framebuffer);
  if (target->colour != 0) api->DeleteRenderbuffers(1, &target->colour);
  if (target->depth != 0) api->DeleteRenderbuffers(1, &target->depth);
  *target = (gl_target){0};
}

static GLenum internal_format(cellist_framebuffer format) {
  switch (format) {
    case CELLIST_FRAMEBUFFER_32F: return GL_RGBA32F;
    case CELLIST_FRAMEBUFFER_16F: return GL_RGBA16F;
    case CELLIST_FRAMEBUFFER_8: return GL_RGBA8;
  }
  return GL_RGBA32F;
}

static void attach(const gl_api *api, GLuint *buffer, GLenum attachment, GLenum format, uint32_t width,
                   uint32_t height) {
  api->GenRenderbuffers(1, buffer);
  api->BindRenderbuffer(GL_RENDERBUFFER, *buffer);
  api->RenderbufferStorage(GL_RENDERBUFFER, format, (GLsizei)width, (GLsizei)height);
  api->FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, *buffer);
}

static cellist_result make(cellist_context *context, const gl_api *api, gl_target *target, uint32_t width,
                           uint32_t height, cellist_framebuffer format, bool with_depth) {
  static const GLenum attachments[2] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  GLint limit = 0;
  api->GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  if (width > (uint32_t)limit || height > (uint32_t)limit)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "this OpenGL draws at most %d pixels a side, not %ux%u",
                        (int)limit, width, height);
  gl_target_release(context, api, target);
  api->GenFramebuffers(1, &target->framebuffer);
  api->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
  attach(api, &target->colour, attachments[0], internal_format(format), width, height);
  if (with_depth) attach(api, &target->depth, attachments[1], GL_RG32F, width, height);
  api->DrawBuffers(with_depth ? 2 : 1, attachments);
  const GLenum status = api->CheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    gl_target_release(context, api, target);
    return cellist_fail(context, CELLIST_ERROR_GRAPHICS, "no framebuffer of %ux%u pixels (status 0x%x)", width, height,
                        status);
  }
  target->width = width;
  target->height = height;
  target->format = format;
  target->with_depth = with_depth;
  return CELLIST_SUCCESS;
}

void gl_target_use(const gl_api *api, const gl_target *target, bool maximum) {
  api->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
  api->Viewport(0, 0, (GLsizei)target->width, (GLsizei)target->height);
  api->Disable(GL_DEPTH_TEST);
  api->Disable(GL_CULL_FACE);
  api->Enable(GL_BLEND);
  api->BlendEquationi(0, maximum ? GL_MAX : GL_FUNC_ADD);
  api->BlendFuncSeparatei(0, GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  if (!target->with_depth) return;
  api->BlendEquationi(1, GL_MAX);
  api->BlendFuncSeparatei(1, GL_ONE, GL_ONE, GL_ONE, GL_ONE);
}

cellist_result gl_target_begin(cellist_context *context, const gl_api *api, gl_target *target, uint32_t width,
                               uint32_t height, cellist_framebuffer format, bool with_depth, bool maximum) {
  if (target->framebuffer == 0 || target->width != width || target->height != height || target->format != format ||
      target->with_depth != with_depth) {
    const cellist_result result = make(context, api, target, width, height, format, with_depth);
    if (result != CELLIST_SUCCESS) return result;
  }
  gl_target_use(api, target, maximum);
  api->ClearBufferfv(GL_COLOR, 0, maximum ? LEAST : EMPTY);
  if (with_depth) api->ClearBufferfv(GL_COLOR, 1, NO_DEPTH);
  return CELLIST_SUCCESS;
}

/* OpenGL's rows go up, an image's go down. factors: NULL, all are 1. */
static void copy_channels(const gl_target *target, size_t count, const char *const *names, const double *factors,
                          cellist_image *image) {
  float *planes[4];
  for (size_t c = 0; c < count; c++) planes[c] = cellist_image_channel(image, names[c]);
  for (size_t y = 0; y < target->height; y++) {
    const float *row = target->pixels + (target->height - 1 - y) * target->width * count;
    for (size_t c = 0; c < count; c++) {
      if (planes[c] == NULL) continue;
      float *out = planes[c] + y * target->width;
      if (factors == NULL)
        for (size_t x = 0; x < target->width; x++) out[x] = row[x * count + c];
      else
        for (size_t x = 0; x < target->width; x++) out[x] = (float)(factors[c] * (double)row[x * count + c]);
    }
  }
}

static void put_depth_behind(const surface_layer *layer, cellist_image *image) {
  float *z = cellist_image_channel(image, "Z"), *z_back = cellist_image_channel(image, "ZBack");
  for (size_t i = 0; layer->depth != NULL && i < (size_t)layer->width * layer->height; i++) {
    if (!(layer->depth[i] < HUGE_VAL)) continue;
    if (z != NULL) z[i] = fminf(z[i], (float)layer->depth[i]);
    if (z_back != NULL) z_back[i] = (float)layer->depth[i];
  }
}

cellist_result gl_target_read(cellist_context *context, const gl_api *api, gl_target *target,
                              const cellist_transfer *transfer, gl_scale scale, double unit, const surface_layer *layer,
                              cellist_image *image) {
  static const char *const names[4] = {"R", "G", "B", "A"}, *const depth_names[2] = {"Z", "ZBack"};
  if (target->pixels == NULL)
    target->pixels = cellist_allocate(context, (size_t)target->width * target->height, 4 * sizeof *target->pixels);
  float *pixels = target->pixels;
  if (pixels == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  api->PixelStorei(GL_PACK_ALIGNMENT, 4);
  api->ReadBuffer(GL_COLOR_ATTACHMENT0);
  api->ReadPixels(0, 0, (GLsizei)target->width, (GLsizei)target->height, GL_RGBA, GL_FLOAT, pixels);
  for (size_t i = 0; transfer != NULL && i < (size_t)target->width * target->height; i++) {
    double colour[3] = {0, 0, 0};
    float *pixel = &pixels[4 * i];
    if (pixel[3] > 0) cellist_transfer_evaluate(transfer, (double)pixel[0] / scale.factor + scale.offset, colour);
    for (int c = 0; c < 3; c++) pixel[c] = (float)colour[c];
  }
  for (size_t i = 0; layer->depth != NULL && i < (size_t)target->width * target->height; i++) {
    const size_t y = target->height - 1 - i / target->width, x = i % target->width;
    float *pixel = &pixels[4 * i], z = 0, z_back = 0;
    surface_layer_put_behind(layer, y * target->width + x, pixel, &pixel[3], &z, &z_back);
  }
  copy_channels(target, 4, names, NULL, image);
  if (target->with_depth) {
    api->ReadBuffer(GL_COLOR_ATTACHMENT1);
    api->ReadPixels(0, 0, (GLsizei)target->width, (GLsizei)target->height, GL_RG, GL_FLOAT, pixels);
    copy_channels(target, 2, depth_names, (const double[2]){-unit, unit}, image);
    put_depth_behind(layer, image);
  }
  return CELLIST_SUCCESS;
}
