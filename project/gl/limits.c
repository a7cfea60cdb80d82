/* SPDX-License-Identifier: BSD-3-Clause
 * Limits: what a frame's clip planes leave of every pixel's ray. The processor works them out, because it has the
 * doubles; next to drawing the cells a frame's worth of them costs nothing. */
#include "limits.h"

#include <math.h>

enum { ROW_GRAIN = 8 };

/* Instead of infinity, which not every shading language promises to compare. */
static const float FAR_OFF = 3e38f;

struct job {
  const cellist_frame *frame;
  double unit;
  const surface_layer *layer;
  float (*pixels)[2];
};

static float bounded(double value) { return (float)fmax(-FAR_OFF, fmin(FAR_OFF, value)); }

/* OpenGL's rows go up, a picture's go down. */
static void fill_rows(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  const cellist_frame *frame = job->frame;
  for (size_t y = begin; y < end; y++)
    for (size_t x = 0; x < frame->width; x++) {
      double origin[3], direction[3], seen[2];
      cellist_frame_ray(frame, (double)x + 0.5, (double)y + 0.5, origin, direction);
      cellist_frame_interval(frame, origin, direction, seen);
      if (job->layer->depth != NULL) seen[1] = fmin(seen[1], surface_layer_limit(job->layer, y * frame->width + x));
      for (int k = 0; k < 2; k++) seen[k] /= job->unit;
      float *pixel = job->pixels[(frame->height - 1 - y) * frame->width + x];
      if (frame->parallel) {
        pixel[0] = bounded(seen[0]);
        pixel[1] = bounded(seen[1]);
      } else if (seen[0] < seen[1]) {
        pixel[0] = bounded(1 / seen[0]);
        pixel[1] = bounded(1 / seen[1]);
      } else {
        pixel[0] = 0;
        pixel[1] = FAR_OFF;
      }
    }
}

static void send(const gl_api *api, const struct job *job, GLuint *texture) {
  if (*texture == 0) api->GenTextures(1, texture);
  api->BindTexture(GL_TEXTURE_2D, *texture);
  api->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  api->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  api->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  api->TexImage2D(GL_TEXTURE_2D, 0, GL_RG32F, (GLsizei)job->frame->width, (GLsizei)job->frame->height, 0, GL_RG,
                  GL_FLOAT, job->pixels);
}

cellist_result gl_limits_make(cellist_context *context, const gl_api *api, const cellist_frame *frame, double unit,
                              const surface_layer *layer, bool twice, gl_limits *limits) {
  struct job job = {.frame = frame, .unit = unit, .layer = layer};
  job.pixels = cellist_allocate(context, (size_t)frame->width * frame->height, sizeof *job.pixels);
  if (job.pixels == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_parallel_for(context, frame->height, ROW_GRAIN, fill_rows, &job);
  if (twice) send(api, &job, &limits->behind);
  send(api, &job, &limits->texture);
  limits->width = frame->width;
  limits->height = frame->height;
  cellist_deallocate(context, job.pixels);
  return CELLIST_SUCCESS;
}

void gl_limits_release(const gl_api *api, gl_limits *limits) {
  const GLuint textures[] = {limits->texture, limits->behind}; /* names of 0 are overlooked */
  api->DeleteTextures(2, textures);
  *limits = (gl_limits){0};
}
