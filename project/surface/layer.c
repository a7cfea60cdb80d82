/* SPDX-License-Identifier: BSD-3-Clause
 * Layer: one ray a pixel to the nearest triangle, lit there. */
#include "layer.h"

#include <math.h>
#include <string.h>

#include "surface_private.h"

/* Without a light of the picture's own: from the camera, so that shapes show. */
static const double USUAL_AMBIENT = 0.2, USUAL_DIFFUSE = 0.8;

enum { ROW_GRAIN = 4 };

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void normalise(double v[3]) {
  const double length = hypot(hypot(v[0], v[1]), v[2]);
  for (int k = 0; k < 3; k++) v[k] = length > 0 ? v[k] / length : 0;
}

surface_light surface_light_of(const cellist_light *light, const cellist_frame *frame) {
  surface_light made = {.ambient = USUAL_AMBIENT, .diffuse = USUAL_DIFFUSE, .shininess = 1};
  if (light != NULL && light->enabled) {
    memcpy(made.towards, light->direction, sizeof made.towards);
    made.ambient = light->ambient;
    made.diffuse = light->diffuse;
    made.specular = light->specular;
    made.shininess = light->shininess;
  }
  normalise(made.towards);
  const bool from_camera = made.towards[0] == 0 && made.towards[1] == 0 && made.towards[2] == 0;
  for (int k = 0; k < 3; k++) {
    if (from_camera) made.towards[k] = -frame->forward[k];
    made.halfway[k] = made.towards[k] - frame->forward[k];
  }
  normalise(made.halfway);
  return made;
}

uint64_t surface_checksum(const cellist_surface *surface) { return surface->checksum; }

/* The unit normal at a hit: the points' where they have one, else the triangle's. */
static void normal_at(const cellist_surface_arrays *arrays, const surface_hit *hit, double normal[3]) {
  const uint32_t *v = &arrays->triangles[3 * (size_t)hit->triangle];
  for (int k = 0; k < 3; k++) normal[k] = 0;
  for (int c = 0; c < 3 && arrays->normals != NULL; c++)
    for (int k = 0; k < 3; k++) normal[k] += hit->weight[c] * arrays->normals[3 * (size_t)v[c] + (size_t)k];
  normalise(normal);
  if (dot(normal, normal) > 0) return;
  double edge[2][3];
  for (int e = 0; e < 2; e++) {
    for (int k = 0; k < 3; k++)
      edge[e][k] =
          arrays->positions[3 * (size_t)v[e + 1] + (size_t)k] - arrays->positions[3 * (size_t)v[0] + (size_t)k];
    normalise(edge[e]);
  }
  for (int k = 0; k < 3; k++)
    normal[k] = edge[0][(k + 1) % 3] * edge[1][(k + 2) % 3] - edge[0][(k + 2) % 3] * edge[1][(k + 1) % 3];
  normalise(normal);
}

static void shade(const cellist_surface_arrays *arrays, const surface_light *light, const surface_hit *hit,
                  float colour[3]) {
  const uint32_t *v = &arrays->triangles[3 * (size_t)hit->triangle];
  double normal[3];
  normal_at(arrays, hit, normal);
  const double share = light->ambient + light->diffuse * fabs(dot(normal, light->towards));
  const double shine =
      light->specular != 0 ? light->specular * pow(fabs(dot(normal, light->halfway)), light->shininess) : 0;
  for (int k = 0; k < 3; k++) {
    double own = 0;
    for (int c = 0; c < 3; c++) own += hit->weight[c] * (double)arrays->colours[3 * (size_t)v[c] + (size_t)k];
    colour[k] = (float)(own * share + shine);
  }
}

struct job {
  const cellist_surface *surface;
  const cellist_frame *frame;
  surface_light light;
  surface_layer *layer;
};

static void cast_rows(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  for (size_t y = begin; y < end; y++)
    for (size_t x = 0; x < job->frame->width; x++) {
      const size_t at = y * job->frame->width + x;
      double origin[3], direction[3], interval[2];
      cellist_frame_ray(job->frame, (double)x + 0.5, (double)y + 0.5, origin, direction);
      cellist_frame_interval(job->frame, origin, direction, interval);
      surface_hit hit;
      job->layer->depth[at] = HUGE_VAL;
      memset(&job->layer->colours[3 * at], 0, 3 * sizeof *job->layer->colours);
      if (!surface_tree_nearest(&job->surface->tree, &job->surface->arrays, origin, direction, interval, &hit))
        continue;
      job->layer->depth[at] = hit.t;
      shade(&job->surface->arrays, &job->light, &hit, &job->layer->colours[3 * at]);
    }
}

/* Of depths: a few roundings of single precision. Smaller: slivers of cells show through surfaces that are their own
 * faces, all of their colour where a ray takes its largest scalar; larger: what stands just before a surface is cut. */
static const double MARGIN = 4e-7;

static double margin_of(const surface_layer *layer) {
  if (!layer->parallel) return MARGIN;
  double most = 0;
  for (size_t i = 0; i < (size_t)layer->width * layer->height; i++)
    if (layer->depth[i] < HUGE_VAL) most = fmax(most, fabs(layer->depth[i]));
  return MARGIN * most;
}

cellist_result surface_layer_make(cellist_context *context, const cellist_surface *surface, const cellist_frame *frame,
                                  const cellist_light *light, surface_layer *layer) {
  *layer = (surface_layer){0};
  if (surface == NULL) return CELLIST_SUCCESS;
  const size_t count = (size_t)frame->width * frame->height;
  surface_layer made = {.width = frame->width, .height = frame->height, .parallel = frame->parallel};
  made.depth = cellist_allocate(context, count, sizeof *made.depth);
  made.colours = cellist_allocate(context, count, 3 * sizeof *made.colours);
  if (made.depth == NULL || made.colours == NULL) {
    surface_layer_release(context, &made);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  struct job job = {surface, frame, surface_light_of(light, frame), &made};
  cellist_parallel_for(context, frame->height, ROW_GRAIN, cast_rows, &job);
  made.margin = margin_of(&made);
  *layer = made;
  return CELLIST_SUCCESS;
}

void surface_layer_release(cellist_context *context, surface_layer *layer) {
  cellist_deallocate(context, layer->depth);
  cellist_deallocate(context, layer->colours);
  *layer = (surface_layer){0};
}
