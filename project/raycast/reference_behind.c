/* SPDX-License-Identifier: BSD-3-Clause
 * Behind: the side tests of line.h, exact and displaced where they tie, on a surface's triangles: so a ray passes a
 * closed surface through faces only, an even number of times, and never slips through an edge. */
#include "reference_behind.h"

#include <math.h>
#include <string.h>
#include <surface/layer.h>

/* As cellist/surface.h promises for pictures without a light. */
static const double USUAL_AMBIENT = 0.2, USUAL_DIFFUSE = 0.8;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void normalise(double v[3]) {
  const double length = hypot(hypot(v[0], v[1]), v[2]);
  for (int k = 0; k < 3; k++) v[k] = length > 0 ? v[k] / length : 0;
}

cellist_result behind_begin(cellist_raycaster *caster, const cellist_surface *surface, const shade_scene *scene,
                            const cellist_frame *frame, behind_scene *behind) {
  *behind = (behind_scene){.ambient = USUAL_AMBIENT, .diffuse = USUAL_DIFFUSE, .shininess = 1};
  if (surface == NULL) return CELLIST_SUCCESS;
  const uint64_t checksum = surface_checksum(surface);
  const cellist_surface_arrays *arrays = cellist_surface_get_arrays(surface);
  if (!caster->has_surface_hierarchy || caster->surface_checksum != checksum) {
    hierarchy_release(caster->context, &caster->surface_hierarchy);
    caster->has_surface_hierarchy = false;
    const cellist_result result = hierarchy_build_triangles(caster->context, arrays->positions, arrays->triangles,
                                                            arrays->triangle_count, &caster->surface_hierarchy);
    if (result != CELLIST_SUCCESS) return result;
    caster->has_surface_hierarchy = true;
    caster->surface_checksum = checksum;
  }
  behind->surface = arrays;
  behind->hierarchy = &caster->surface_hierarchy;
  cellist_surface_bounds(surface, behind->bounds);
  const cellist_light *light = &scene->optics.light;
  if (light->enabled) {
    memcpy(behind->light, scene->light, sizeof behind->light);
    memcpy(behind->halfway, scene->halfway, sizeof behind->halfway);
    behind->ambient = light->ambient;
    behind->diffuse = light->diffuse;
    behind->specular = light->specular;
    behind->shininess = light->shininess;
  } else {
    for (int k = 0; k < 3; k++) behind->light[k] = behind->halfway[k] = -frame->forward[k];
  }
  return CELLIST_SUCCESS;
}

/* The search for the nearest triangle. */
struct search {
  const behind_scene *behind;
  ray_line line;
  walk_limits limits;
  uint32_t triangle; /* CELLIST_NONE: none yet */
  line_crossing at;
};

static bool look_at(void *user, const uint32_t *faces, size_t count) {
  struct search *search = user;
  for (size_t i = 0; i < count; i++) {
    const uint32_t *v = &search->behind->surface->triangles[3 * (size_t)faces[i]];
    line_point corner[3];
    bool is_tie[3];
    for (int c = 0; c < 3; c++) corner[c] = line_project(&search->line, v[c]);
    const int first = line_side(&search->line, &corner[0], &corner[1], &is_tie[0]);
    bool is_met = first != 0;
    for (int c = 1; c < 3 && is_met; c++)
      is_met = line_side(&search->line, &corner[c], &corner[(c + 1) % 3], &is_tie[c]) == first;
    if (!is_met) continue;
    const line_crossing at = line_cross_face(&search->line, corner, is_tie);
    if (!(at.depth >= search->limits.t[0] && at.depth <= search->limits.t[1])) continue;
    if (search->triangle != CELLIST_NONE && at.depth == search->at.depth && faces[i] > search->triangle) continue;
    search->triangle = faces[i];
    search->at = at;
    search->limits.t[1] = at.depth;
  }
  return true;
}

/* The points' normals, or where these are none, the triangle's own. */
static void find_normal(const struct search *search, double normal[3]) {
  const cellist_surface_arrays *surface = search->behind->surface;
  const uint32_t *v = &surface->triangles[3 * (size_t)search->triangle];
  memset(normal, 0, 3 * sizeof *normal);
  for (size_t k = 0; k < 3 && surface->normals != NULL; k++)
    for (int c = 0; c < 3; c++) normal[k] += search->at.weight[c] * surface->normals[3 * (size_t)v[c] + k];
  normalise(normal);
  if (dot(normal, normal) > 0) return;
  double u[3], w[3];
  for (size_t k = 0; k < 3; k++) {
    u[k] = surface->positions[3 * (size_t)v[1] + k] - surface->positions[3 * (size_t)v[0] + k];
    w[k] = surface->positions[3 * (size_t)v[2] + k] - surface->positions[3 * (size_t)v[0] + k];
  }
  normalise(u);
  normalise(w);
  for (int k = 0; k < 3; k++) normal[k] = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
  normalise(normal);
}

static void light_point(const struct search *search, double colour[3]) {
  const behind_scene *behind = search->behind;
  const uint32_t *v = &behind->surface->triangles[3 * (size_t)search->triangle];
  double normal[3];
  find_normal(search, normal);
  const double share = behind->ambient + behind->diffuse * fabs(dot(normal, behind->light));
  double highlight = 0;
  if (behind->specular != 0) highlight = behind->specular * pow(fabs(dot(normal, behind->halfway)), behind->shininess);
  for (size_t k = 0; k < 3; k++) {
    double own = 0;
    for (int c = 0; c < 3; c++) own += search->at.weight[c] * (double)behind->surface->colours[3 * (size_t)v[c] + k];
    colour[k] = own * share + highlight;
  }
}

behind_point behind_meet(const behind_scene *behind, const double origin[3], const double direction[3],
                         walk_limits *limits, uint64_t *retry_count) {
  behind_point point = {.is_met = false};
  if (behind->surface == NULL || !(limits->t[0] <= limits->t[1])) return point;
  struct search search = {.behind = behind, .limits = *limits, .triangle = CELLIST_NONE};
  line_begin(&search.line, behind->surface->positions, behind->bounds, origin, direction);
  hierarchy_query(behind->hierarchy, origin, direction, look_at, &search);
  *retry_count += search.line.retry_count;
  if (search.triangle == CELLIST_NONE) return point;
  point = (behind_point){.is_met = true, .t = search.at.depth, .t_error = search.at.depth_error};
  light_point(&search, point.colour);
  /* Of a mesh whose own boundary is shown nothing stands before it, however rounding puts the two. */
  limits->t[1] = point.t - 2 * point.t_error;
  limits->t_error[1] = 3 * point.t_error;
  return point;
}

void behind_add(const behind_point *point, shade_pixel *pixel) {
  if (!point->is_met) return;
  /* A maximum hides what is behind it without absorbing; else the transmittance has more digits than 1 - A. */
  const double through = pixel->alpha < 1 ? pixel->transmittance : 0;
  for (int k = 0; k < 3; k++) pixel->colour[k] += through * point->colour[k];
  pixel->transmittance = 0;
  pixel->alpha = 1;
  pixel->z = fmin(pixel->z, point->t);
  pixel->z_back = point->t;
  pixel->error = HUGE_VAL;
}
