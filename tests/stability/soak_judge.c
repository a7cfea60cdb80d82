/* SPDX-License-Identifier: BSD-3-Clause
 * Soak judge: pixel by pixel, within what each setting promises.
 *
 * A pixel that is further off is right all the same if the reference takes on its value within a small shift: rays that
 * graze an edge, cut a corner or run in a face see something else there. */
#include "soak_judge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Single precision in a few hundred cells of any opacity; smaller: rounding alone would fail; larger: a wrong cell in a
 * faint medium would pass. */
static const double LIMIT = 2e-4;
/* Pictures that are fainter are judged as if they were this bright: errors of A do not shrink with it. */
static const double FAINT = 0.05;
/* In pixels: some twenty times what rounding moves a corner by, and four times what OpenGL does along either axis. */
static const double ROUNDING_SHIFT = 1e-4, CORNER_SHIFT = 1.0 / 128;

/* A share of the depth: a facet at an edge lies as deep as the edge but for its slope over CORNER_SHIFT. */
static const double EDGE_DEPTH = 1e-2;

/* Light by gradients at points, which is taken at 1 to 4 places of a segment: the highlight by faces, all of it by
 * soft. Of meshes of fewer than COARSE tets, which have long segments, and of others. */
enum { COARSE = 500 };
static const double LIT_FACES[2][4] = {{0.1, 0.05, 0.05, 0.05}, {0.1, 0.03, 0.03, 0.02}};
static const double LIT_SOFT[2][4] = {{0.25, 0.1, 0.08, 0.08}, {0.15, 0.08, 0.05, 0.05}};
/* Tables know the transfer function at their nodes only: where a medium is opaque between two of them, its colour is
 * off by up to twice what colours change by from node to node; those of `dense` change by 4 over the range. Psi is held
 * to single precision. */
static const double TABLE_SLOPE = 10;
/* OpenGL moves a fan's corners, and cells gain or lose what that is of them. In pictures of few pixels and dense media,
 * in which cells are smaller than pixels, and where the largest scalar is a sliver's, this share of a picture may be
 * off by more. */
static const double FAN = 3e-3, FAN_STRAYS = 0.01, FAN_STRAY = 0.05;
/* Roundings of a blend, to 11 bits or to bytes: of what is added, of what is left through, and of their sum. */
static const double BLEND_16F = 3 * 0x1p-12, BLEND_8 = 3 * 0.5 / 255;

/* Eight directions, as far as the shift and a quarter as far: what is seen may be narrower than it. */
enum { DIRECTIONS = 8, SHIFTS = 2 * DIRECTIONS };
/* The reference moved as far as rounding moves a ray, and as far as OpenGL moves a corner. */
enum { BY_ROUNDING, BY_CORNERS, RINGS };

static const char *const CHANNELS[] = {"R", "G", "B", "A"};

/* How far a pixel may be off. */
typedef struct allowance {
  double plain;       /* in parts of the picture's largest value */
  double per_cell;    /* more for each cell on the ray, in parts of it or of 1 if that is larger */
  int first;          /* channel that is compared */
  bool moves_corners; /* OpenGL: of fans, or of a surface */
  bool is_fan;
  bool has_edges;       /* OpenGL may show another facet at an edge of the surface */
  bool is_either;       /* rays may lie in facets, and show one or the other; or only touch cells, which then count for
                           the largest scalar or not */
  double strays, stray; /* a share of the pixels that may be off by more, and by how much, as `plain` */
  bool is_finite;       /* nothing else is known */
  char kind[SOAK_KIND]; /* of picture, for the totals */
} allowance;

static allowance allowance_of(const soak_scene *scene, size_t tet_count, double peak) {
  const cellist_pipeline_desc *desc = &scene->desc;
  const cellist_optics *model = &desc->optics.model;
  const bool is_faces = desc->renderer == CELLIST_RENDERER_FACES, is_fan = desc->renderer == CELLIST_RENDERER_FAN;
  const bool is_gl = is_faces || is_fan;
  const bool is_volume = model->model == CELLIST_MODEL_EMISSION_ABSORPTION || model->model == CELLIST_MODEL_ABSORPTION;
  const char *renderer = is_faces                                  ? "faces"
                         : is_fan                                  ? "fan"
                         : desc->renderer == CELLIST_RENDERER_SOFT ? "soft"
                                                                   : "cast";
  allowance made = {.plain = LIMIT, .is_finite = scene->is_flawed};
  snprintf(made.kind, sizeof made.kind, "%s", renderer);
  const bool is_lit = model->light.enabled &&
                      (model->model == CELLIST_MODEL_EMISSION_ABSORPTION || model->model == CELLIST_MODEL_EMISSION);
  const uint32_t samples = model->sample_count > 0 ? model->sample_count : 1;
  if (is_lit && desc->renderer != CELLIST_RENDERER_CAST) {
    const bool is_coarse = tet_count < COARSE;
    made.plain = (is_gl ? LIT_FACES : LIT_SOFT)[!is_coarse][samples - 1];
    snprintf(made.kind, sizeof made.kind, "%s, lit %u%s", is_gl ? "faces" : "soft", samples,
             is_coarse ? " coarse" : "");
  }
  if (is_faces && is_volume && model->integration == CELLIST_INTEGRATION_TABLE) {
    made.plain = fmax(made.plain, TABLE_SLOPE / model->table_size[0]);
    snprintf(made.kind, sizeof made.kind, "faces, table %u", model->table_size[0]);
    /* README's limits: spikes are smeared, and so is what a narrow range makes of any function. */
    made.is_finite = made.is_finite || desc->optics.has_range || strcmp(desc->optics.transfer, "spikes") == 0;
  }
  if (is_fan && !is_lit) {
    made.is_fan = true;
    made.strays = FAN_STRAYS;
    made.stray = FAN_STRAY;
    made.plain = FAN;
  }
  made.has_edges = is_gl && desc->surface_count > 0;
  made.moves_corners = made.is_fan || made.has_edges;
  made.is_either = (desc->surface_count > 0 && scene->is_along) || model->model == CELLIST_MODEL_MAXIMUM;
  const bool is_float = desc->framebuffer == CELLIST_FRAMEBUFFER_32F || model->model == CELLIST_MODEL_MAXIMUM;
  if (is_gl && !is_float) {
    made.per_cell = desc->framebuffer == CELLIST_FRAMEBUFFER_16F ? BLEND_16F : BLEND_8;
    if (desc->framebuffer == CELLIST_FRAMEBUFFER_8 && peak > 1) made.first = 3; /* colours end at 1 */
  }
  return made;
}

/* The view moved by a part of a pixel. */
static bool shifted(cellist_context *context, const cellist_view *view, const unsigned size[2], double shift, int step,
                    cellist_view *moved) {
  cellist_frame frame;
  if (cellist_frame_from_view(context, view, size[0], size[1], &frame) != CELLIST_SUCCESS) return false;
  static const int ways[DIRECTIONS][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}};
  if (step >= DIRECTIONS) shift /= 4;
  double distance = 0;
  for (int k = 0; k < 3; k++) distance = hypot(distance, view->target[k] - view->eye[k]);
  const double unit = frame.parallel ? 1 : distance;
  const double x = shift * ways[step % DIRECTIONS][0] * 2 * frame.half_width / size[0] * unit;
  const double y = shift * ways[step % DIRECTIONS][1] * 2 * frame.half_height / size[1] * unit;
  *moved = *view;
  for (int k = 0; k < 3; k++) {
    const double by = x * frame.right[k] + y * frame.up[k];
    moved->target[k] += by;
    if (frame.parallel) moved->eye[k] += by;
  }
  return true;
}

/* The reference by rays that are moved, each way. */
struct ring {
  cellist_image *moved[SHIFTS];
  size_t count;
};

struct pictures {
  const cellist_image *drawn, *reference;
  struct ring rings[RINGS];
};

static double value_of(const cellist_image *image, int channel, size_t pixel) {
  return (double)cellist_image_channel(image, CHANNELS[channel])[pixel];
}

/* A point's picture, in pixels from the centre of pixel x, y, and its depth; false if it does not lie before the eye.
 */
static bool project(const cellist_frame *frame, const double point[3], size_t x, size_t y, double at[3]) {
  double across = 0, up = 0;
  at[2] = 0;
  for (int k = 0; k < 3; k++) {
    const double d = point[k] - frame->eye[k];
    across += d * frame->right[k];
    up += d * frame->up[k];
    at[2] += d * frame->forward[k];
  }
  const double w = frame->parallel ? 1 : at[2];
  if (!(w > 0)) return false;
  at[0] = 0.5 * frame->width * (1 + across / w / frame->half_width) - ((double)x + 0.5);
  at[1] = 0.5 * frame->height * (1 - up / w / frame->half_height) - ((double)y + 0.5);
  return true;
}

/* How far the pixel's centre lies from an edge's picture, and how deep the edge is there. */
static double distance_to_edge(const cellist_frame *frame, const double a[3], const double b[3], double *depth) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], length = dx * dx + dy * dy;
  const double t = length > 0 ? fmax(0, fmin(1, -(a[0] * dx + a[1] * dy) / length)) : 0;
  *depth = frame->parallel ? a[2] + t * (b[2] - a[2]) : 1 / ((1 - t) / a[2] + t / b[2]);
  return hypot(a[0] + t * dx, a[1] + t * dy);
}

/* The height of a triangle's picture over its longest edge. */
static double height_of(const double a[3], const double b[3], const double c[3]) {
  const double longest =
      fmax(hypot(b[0] - a[0], b[1] - a[1]), fmax(hypot(c[0] - b[0], c[1] - b[1]), hypot(a[0] - c[0], a[1] - c[1])));
  const double area = fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
  return longest > 0 ? area / longest : 0;
}

/* Whether the pixel's centre lies within CORNER_SHIFT of an edge of a face
 * - as deep as the surface that is seen or should be: OpenGL shows either side of it, or a facet that is hidden there;
 * - of a fan, if the face is seen edge-on up to what OpenGL moves its corners by: cells on both sides of it may show
 *   all of their extent there, or none.
 * Surfaces consist of the mesh's faces. */
static bool is_at_edge(const cellist_mesh_arrays *mesh, const cellist_frame *frame, const struct pictures *pictures,
                       size_t pixel, bool of_surface, bool of_fan) {
  const size_t x = pixel % frame->width, y = pixel / frame->width;
  const double seen[2] = {(double)cellist_image_channel(pictures->drawn, "ZBack")[pixel],
                          (double)cellist_image_channel(pictures->reference, "ZBack")[pixel]};
  for (size_t i = 0; i < 4 * mesh->tet_count; i++) {
    double at[3][3], depth;
    bool is_before = true;
    for (int c = 0; c < 3 && is_before; c++) {
      const uint32_t point = mesh->tets[i / 4 * 4 + CELLIST_TET_FACE[i % 4][c]];
      is_before = project(frame, &mesh->positions[3 * (size_t)point], x, y, at[c]);
    }
    if (!is_before) continue;
    for (int c = 0; c < 3; c++) {
      if (!(distance_to_edge(frame, at[c], at[(c + 1) % 3], &depth) <= CORNER_SHIFT)) continue;
      if (of_fan && height_of(at[0], at[1], at[2]) <= 2 * CORNER_SHIFT) return true;
      for (int k = 0; k < 2 && of_surface; k++)
        if (fabs(depth - seen[k]) <= EDGE_DEPTH * fabs(depth)) return true;
    }
  }
  return false;
}

static void widen(const struct ring *ring, int channel, size_t pixel, double *low, double *high) {
  for (size_t i = 0; i < ring->count; i++) {
    const double value = value_of(ring->moved[i], channel, pixel);
    *low = fmin(*low, value);
    *high = fmax(*high, value);
  }
}

/* By how much the pixel is not what the reference takes on nearby. */
static double miss_of(const struct pictures *pictures, size_t pixel, double tolerance, const allowance *allowed) {
  double miss = 0;
  for (int k = allowed->first; k < 4; k++) {
    double low = value_of(pictures->reference, k, pixel), high = low;
    widen(&pictures->rings[BY_ROUNDING], k, pixel, &low, &high);
    if (allowed->is_either && high - low > tolerance) return 0;
    widen(&pictures->rings[BY_CORNERS], k, pixel, &low, &high);
    const double value = value_of(pictures->drawn, k, pixel);
    miss = fmax(miss, fmax(low - value, value - high));
  }
  return miss;
}

/* The largest value of the reference; fills reason if a value is none. */
static double find_peak(const soak_scene *scene, const struct pictures *pictures, char *reason) {
  const size_t count = (size_t)scene->size[0] * scene->size[1];
  double peak = 0;
  for (int k = 0; k < 4; k++)
    for (size_t i = 0; i < count; i++) {
      const double d = value_of(pictures->drawn, k, i), r = value_of(pictures->reference, k, i);
      if (!isfinite(d) || !isfinite(r)) {
        snprintf(reason, SOAK_REASON, "pixel %zu,%zu: %s is %g, the reference %g", i % scene->size[0],
                 i / scene->size[0], CHANNELS[k], d, r);
        return 0;
      }
      peak = fmax(peak, fabs(r));
    }
  return peak;
}

/* Draws a ring if it is not yet. */
static cellist_result draw_ring(cellist_context *context, cellist_pipeline *caster, const soak_scene *scene,
                                const cellist_view *view, double shift, struct ring *ring) {
  for (int s = (int)ring->count; s < SHIFTS; s++) {
    cellist_view moved;
    if (!shifted(context, view, scene->size, shift, s, &moved)) break;
    const cellist_result result =
        cellist_pipeline_draw(caster, &moved, scene->size[0], scene->size[1], &ring->moved[ring->count], NULL);
    if (result != CELLIST_SUCCESS) return result;
    ring->count++;
  }
  return CELLIST_SUCCESS;
}

static cellist_result draw_rings(cellist_context *context, cellist_pipeline *caster, const soak_scene *scene,
                                 const cellist_view *view, const allowance *allowed, struct pictures *pictures) {
  cellist_result result = draw_ring(context, caster, scene, view, ROUNDING_SHIFT, &pictures->rings[BY_ROUNDING]);
  if (result == CELLIST_SUCCESS && allowed->moves_corners)
    result = draw_ring(context, caster, scene, view, CORNER_SHIFT, &pictures->rings[BY_CORNERS]);
  return result;
}

static void say_wrong(const soak_scene *scene, const struct pictures *pictures, size_t wrong, size_t pixel,
                      char *reason) {
  double d[4], r[4];
  for (int k = 0; k < 4; k++) {
    d[k] = value_of(pictures->drawn, k, pixel);
    r[k] = value_of(pictures->reference, k, pixel);
  }
  snprintf(reason, SOAK_REASON,
           "%zu of %u pixels are wrong; %zu,%zu is %.6g %.6g %.6g %.6g instead of %.6g %.6g %.6g %.6g", wrong,
           scene->size[0] * scene->size[1], pixel % scene->size[0], pixel / scene->size[0], d[0], d[1], d[2], d[3],
           r[0], r[1], r[2], r[3]);
}

static soak_kind *find_kind(soak_totals *totals, const allowance *allowed) {
  size_t i = 0;
  while (i < totals->kind_count && strcmp(totals->kinds[i].name, allowed->kind) != 0) i++;
  soak_kind *kind = &totals->kinds[i];
  if (i == totals->kind_count) {
    if (i == SOAK_KINDS) abort();
    totals->kind_count++;
    strcpy(kind->name, allowed->kind);
    kind->limit = allowed->plain;
  }
  return kind;
}

static cellist_result compare(cellist_context *context, cellist_pipeline *caster, const soak_scene *scene,
                              const cellist_view *view, struct pictures *pictures, soak_totals *totals, char *reason) {
  const size_t count = (size_t)scene->size[0] * scene->size[1];
  const double peak = find_peak(scene, pictures, reason), scale = fmax(peak, FAINT);
  totals->pixels += count;
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(cellist_pipeline_mesh(caster));
  const allowance allowed = allowance_of(scene, mesh->tet_count, peak);
  if (reason[0] != '\0' || allowed.is_finite) return CELLIST_SUCCESS;
  cellist_frame frame;
  const cellist_result framed = cellist_frame_from_view(context, view, scene->size[0], scene->size[1], &frame);
  if (framed != CELLIST_SUCCESS) return framed;
  const float *cells = cellist_image_channel(pictures->reference, "cells.Y");
  soak_kind *kind = find_kind(totals, &allowed);
  kind->scenes++;
  size_t wrong = 0, strays = 0, first = 0;
  double worst = 0;
  for (size_t i = 0; i < count; i++) {
    const double blended = allowed.per_cell * (cells[i] + 2) * fmax(peak, 1);
    const double tolerance = allowed.plain * scale + blended;
    double miss = 0;
    for (int k = allowed.first; k < 4; k++)
      miss = fmax(miss, fabs(value_of(pictures->drawn, k, i) - value_of(pictures->reference, k, i)));
    if (miss > tolerance) {
      const cellist_result result = draw_rings(context, caster, scene, view, &allowed, pictures);
      if (result != CELLIST_SUCCESS) return result;
      miss = miss_of(pictures, i, tolerance, &allowed);
      if (miss > tolerance && allowed.moves_corners &&
          is_at_edge(mesh, &frame, pictures, i, allowed.has_edges, allowed.is_fan))
        miss = 0;
      totals->shifted_pixels += miss <= tolerance;
    }
    if (miss > tolerance && miss <= allowed.stray * scale) {
      strays++;
      continue;
    }
    kind->worst = fmax(kind->worst, (miss - blended) / scale);
    if (!(miss > tolerance)) continue;
    if (miss > worst) worst = miss, first = i;
    wrong++;
  }
  kind->most_strays = fmax(kind->most_strays, (double)strays / (double)count);
  if ((double)strays > allowed.strays * (double)count) wrong += strays;
  if (wrong > 0) say_wrong(scene, pictures, wrong, first, reason);
  return CELLIST_SUCCESS;
}

cellist_result soak_judge(cellist_context *context, cellist_pipeline *caster, const soak_scene *scene,
                          const cellist_view *view, const cellist_image *drawn, const cellist_image *reference,
                          soak_totals *totals, char reason[SOAK_REASON]) {
  struct pictures pictures = {.drawn = drawn, .reference = reference};
  const cellist_result result = compare(context, caster, scene, view, &pictures, totals, reason);
  for (int r = 0; r < RINGS; r++)
    for (size_t i = 0; i < pictures.rings[r].count; i++) cellist_image_destroy(pictures.rings[r].moved[i]);
  return result;
}

void soak_judge_same(const soak_scene *scene, const cellist_image *a, const cellist_image *b,
                     char reason[SOAK_REASON]) {
  const size_t count = (size_t)scene->size[0] * scene->size[1];
  for (int k = 0; k < 4; k++)
    for (size_t i = 0; i < count; i++)
      if (value_of(a, k, i) != value_of(b, k, i)) {
        snprintf(reason, SOAK_REASON, "pixel %zu,%zu: %s is %.9g with one number of threads and %.9g with another",
                 i % scene->size[0], i / scene->size[0], CHANNELS[k], value_of(a, k, i), value_of(b, k, i));
        return;
      }
}
