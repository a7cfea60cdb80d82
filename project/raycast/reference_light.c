/* SPDX-License-Identifier: BSD-3-Clause
 * Light: pieces and surfaces lit by the scalar's gradient, [C] section 8, without its approximation: the gradient is
 * linear along a segment, so is its product with the light, and the integral over a piece is taken exactly, cut where
 * that product changes sign. The highlight is no polynomial: its panels are halved until nothing changes any more. */
#include <math.h>

#include "reference_shade.h"

/* When two refinements of the highlight agree to this, relative to the light gathered, the finer one is taken. */
static const double HIGHLIGHT_TOLERANCE = 1e-13;
enum { MAX_PARTS = 256 };

/* A piece's light as its nodes are visited. */
struct lit_piece {
  const shade_scene *scene;
  double gradient[2][3]; /* at its ends */
  double diffuse[2];     /* gradient . light / unit */
  double colour[2][3];
  double sum[3];
};

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static double highlight(const shade_scene *scene, const double normal[3]) {
  const cellist_light *light = &scene->optics.light;
  const double length = hypot(hypot(normal[0], normal[1]), normal[2]);
  if (light->specular == 0 || !(length > 0)) return 0;
  return light->specular * pow(fabs(dot(normal, scene->halfway)) / length, light->shininess);
}

static void add_node(void *user, double w, double weight) {
  struct lit_piece *piece = user;
  const cellist_light *light = &piece->scene->optics.light;
  const double v = 1 - w;
  double normal[3];
  for (int k = 0; k < 3; k++) normal[k] = v * piece->gradient[0][k] + w * piece->gradient[1][k];
  const double share = light->ambient + light->diffuse * fabs(v * piece->diffuse[0] + w * piece->diffuse[1]);
  const double shine = highlight(piece->scene, normal);
  for (int k = 0; k < 3; k++)
    piece->sum[k] += weight * ((v * piece->colour[0][k] + w * piece->colour[1][k]) * share + shine);
}

/* Integrates; refines until the highlight has settled. */
static void integrate(struct lit_piece *piece, double a, double b, bool attenuated) {
  double last[3] = {0};
  for (int parts = 1; parts <= MAX_PARTS; parts *= 2) {
    for (int k = 0; k < 3; k++) piece->sum[k] = 0;
    reference_piece_nodes(a, b, attenuated, parts, add_node, piece);
    bool settled = parts > 1;
    for (int k = 0; k < 3; k++) {
      settled = settled && fabs(piece->sum[k] - last[k]) <= HIGHLIGHT_TOLERANCE * fabs(piece->sum[k]);
      last[k] = piece->sum[k];
    }
    if (settled || piece->scene->optics.light.specular == 0) return;
  }
}

static double between(const double ends[2], double w) { return (1 - w) * ends[0] + w * ends[1]; }

void shade_lit_piece(shade_gathering *gathering, const walk_segment *segment, const reference_piece *piece,
                     double length, double transmittance) {
  const shade_scene *scene = gathering->scene;
  const bool attenuated = scene->optics.model == CELLIST_MODEL_EMISSION_ABSORPTION;
  double gradient[2][3], diffuse[2];
  for (int end = 0; end < 2; end++) {
    const double at = end == 0 ? piece->begin : piece->end;
    for (int k = 0; k < 3; k++) gradient[end][k] = (1 - at) * segment->gradient[0][k] + at * segment->gradient[1][k];
    diffuse[end] = dot(gradient[end], scene->light) / scene->optics.light.gradient_unit;
  }
  const bool turns = diffuse[0] * diffuse[1] < 0;
  const double cuts[3] = {0, turns ? diffuse[0] / (diffuse[0] - diffuse[1]) : 1, 1};
  for (int part = 0; part < (turns ? 2 : 1); part++) {
    struct lit_piece lit = {.scene = scene};
    double depth[2];
    for (int end = 0; end < 2; end++) {
      const double w = cuts[part + end];
      for (int k = 0; k < 3; k++) {
        lit.gradient[end][k] = (1 - w) * gradient[0][k] + w * gradient[1][k];
        lit.colour[end][k] = (1 - w) * piece->colour[0][k] + w * piece->colour[1][k];
      }
      lit.diffuse[end] = turns && part != end ? 0 : between(diffuse, w);
      depth[end] = between(piece->extinction, w) * length * (cuts[part + 1] - cuts[part]);
    }
    integrate(&lit, depth[0], depth[1], attenuated);
    for (int k = 0; k < 3; k++) reference_sum_add(&gathering->colour[k], transmittance * lit.sum[k]);
    if (attenuated) transmittance *= exp(-0.5 * (depth[0] + depth[1]));
  }
}

void shade_lit_surface(const shade_scene *scene, const double normal[3], const double colour[3], double lit[3]) {
  const cellist_light *light = &scene->optics.light;
  const double length = hypot(hypot(normal[0], normal[1]), normal[2]);
  const double facing = length > 0 ? fabs(dot(normal, scene->light)) / length : 0;
  for (int k = 0; k < 3; k++)
    lit[k] = colour[k] * (light->ambient + light->diffuse * facing) + highlight(scene, normal);
}
