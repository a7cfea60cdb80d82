/* SPDX-License-Identifier: BSD-3-Clause
 * Light [C 8]. On one gradient a cell the lit share and the highlight are constant in the cell, so what it gathers is
 * multiplied by one and increased by the other times its opacity; no samples are needed. Gradients at points go to the
 * shader (light.glsl). */
#include "light.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* In the light's unit, gradients beyond this are cut off: their squares fit a float, and they are all white or black.
 */
static const double STEEP = 1e15;

static void normalise(double v[3]) {
  const double length = hypot(hypot(v[0], v[1]), v[2]);
  for (int k = 0; k < 3 && length > 0; k++) v[k] /= length;
}

gl_light gl_light_of_frame(const cellist_optics *optics, const cellist_frame *frame) {
  gl_light made = {.light = optics->light};
  made.enabled =
      optics->light.enabled && optics->model != CELLIST_MODEL_ABSORPTION && optics->model != CELLIST_MODEL_MAXIMUM;
  made.on_surfaces = optics->model == CELLIST_MODEL_ISOSURFACES;
  memcpy(made.towards, optics->light.direction, sizeof made.towards);
  normalise(made.towards);
  if (!(dot(made.towards, made.towards) > 0))
    for (int k = 0; k < 3; k++) made.towards[k] = -frame->forward[k];
  for (int k = 0; k < 3; k++) made.halfway[k] = made.towards[k] - frame->forward[k];
  normalise(made.halfway);
  return made;
}

void gl_light_of_cell(const gl_light *light, const double *const corners[4], const double scalars[4], float out[2]) {
  double edges[3][3], gradient[3] = {0, 0, 0}, volume = 0;
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) edges[i][k] = corners[i + 1][k] - corners[0][k];
  for (int i = 0; i < 3; i++) {
    const double *u = edges[(i + 1) % 3], *v = edges[(i + 2) % 3];
    const double normal[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    if (i == 0) volume = dot(edges[0], normal);
    for (int k = 0; k < 3; k++) gradient[k] += (scalars[i + 1] - scalars[0]) * normal[k];
  }
  for (int k = 0; k < 3; k++) gradient[k] /= volume;
  const double length = hypot(hypot(gradient[0], gradient[1]), gradient[2]);
  out[0] = (float)light->light.ambient;
  out[1] = 0;
  if (!(length > 0) || !isfinite(length)) return;
  const double unit = light->on_surfaces ? length : light->light.gradient_unit;
  out[0] = (float)(light->light.ambient + light->light.diffuse * fabs(dot(gradient, light->towards)) / unit);
  if (light->light.specular != 0)
    out[1] = (float)(light->light.specular * pow(fabs(dot(gradient, light->halfway)) / length, light->light.shininess));
}

void gl_light_of_points(const gl_light *light, const uint32_t points[4], double out[4][3]) {
  for (int c = 0; c < 4; c++) {
    const double *gradient = &light->gradients[3 * (size_t)points[c]];
    const double largest = fmax(fmax(fabs(gradient[0]), fabs(gradient[1])), fabs(gradient[2]));
    const double unit = fmax(light->light.gradient_unit, largest / STEEP);
    for (int k = 0; k < 3; k++) out[c][k] = gradient[k] / unit;
  }
}
