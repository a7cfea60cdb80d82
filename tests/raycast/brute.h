/* SPDX-License-Identifier: BSD-3-Clause
 * Brute force: every tet against every ray in 80-bit arithmetic, sorted by depth, Gauss-Kronrod quadrature of each
 * piece. Shares with the caster the mesh's arrays, the ray of a pixel and the transfer function's knots, and no code.
 */
#ifndef CELLIST_TESTS_RAYCAST_BRUTE_H
#define CELLIST_TESTS_RAYCAST_BRUTE_H

#include <cellist/mesh.h>
#include <cellist/optics.h>
#include <cellist/transfer.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle.h"

typedef struct brute_cell {
  real t[2], scalar[2], gradient[2][3];
  uint32_t tet;
} brute_cell;

typedef struct brute_force {
  const cellist_mesh_arrays *mesh;
  const cellist_scalar *scalar;
  const cellist_transfer *transfer;
  cellist_optics optics;
  real light[3], halfway[3];
  const real *gradients; /* [3 points] or NULL */
  double *spheres;       /* [4 tets] centre and squared radius, grown */
  brute_cell *cells;     /* of the ray */
  size_t cell_count;
} brute_force;

static inline void brute_begin(brute_force *brute, const cellist_mesh *mesh, const cellist_scalar *scalar,
                               const cellist_transfer *transfer) {
  *brute = (struct brute_force){.mesh = cellist_mesh_get_arrays(mesh), .scalar = scalar, .transfer = transfer};
  const cellist_mesh_arrays *m = brute->mesh;
  brute->spheres = malloc((4 * m->tet_count + 1) * sizeof *brute->spheres);
  brute->cells = malloc((m->tet_count + 1) * sizeof *brute->cells);
  for (size_t t = 0; t < m->tet_count; t++) {
    double *sphere = &brute->spheres[4 * t], radius = 0;
    for (size_t k = 0; k < 3; k++) {
      sphere[k] = 0;
      for (size_t c = 0; c < 4; c++) sphere[k] += 0.25 * m->positions[3 * (size_t)m->tets[4 * t + c] + k];
    }
    for (size_t c = 0; c < 4; c++) {
      double square = 0;
      for (size_t k = 0; k < 3; k++) square += pow(m->positions[3 * (size_t)m->tets[4 * t + c] + k] - sphere[k], 2);
      radius = fmax(radius, square);
    }
    sphere[3] = radius;
  }
}

static inline void brute_end(brute_force *brute) {
  free(brute->spheres);
  free(brute->cells);
}

/* The part of the ray inside a tet, by its barycentric coordinates: linear functions of t. */
static inline void brute_clip(brute_force *brute, uint32_t tet, const double origin[3], const double direction[3],
                              real near_distance) {
  const cellist_mesh_arrays *m = brute->mesh;
  if ((m->tet_flags[tet] & CELLIST_TET_FLAT) != 0) return;
  real p[4][3], value[4];
  for (int c = 0; c < 4; c++) {
    const uint32_t v = m->tets[4 * (size_t)tet + (size_t)c];
    for (size_t k = 0; k < 3; k++) p[c][k] = (real)m->positions[3 * (size_t)v + k] - origin[k];
    value[c] = brute->scalar->values[brute->scalar->association == CELLIST_ON_POINTS ? v : tet];
    if (!isfinite(value[c])) return;
  }
  brute_cell cell = {.t = {near_distance, HUGE_VALL}, .tet = tet};
  real base[4], slope[4];
  for (int c = 0; c < 4; c++) {
    /* Barycentric coordinate c: 0 on the opposite face, 1 at the corner. */
    const uint8_t *f = CELLIST_TET_FACE[c];
    real u[3], v[3], n[3], at_corner = 0;
    for (int k = 0; k < 3; k++) u[k] = p[f[1]][k] - p[f[0]][k], v[k] = p[f[2]][k] - p[f[0]][k];
    for (int k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    base[c] = slope[c] = 0;
    for (int k = 0; k < 3; k++) {
      base[c] -= n[k] * p[f[0]][k];
      slope[c] += n[k] * direction[k];
      at_corner += n[k] * (p[c][k] - p[f[0]][k]);
    }
    base[c] /= at_corner;
    slope[c] /= at_corner;
    if (slope[c] == 0 && base[c] < 0) return;
    if (slope[c] > 0) cell.t[0] = fmaxl(cell.t[0], -base[c] / slope[c]);
    if (slope[c] < 0) cell.t[1] = fminl(cell.t[1], -base[c] / slope[c]);
  }
  if (!(cell.t[0] < cell.t[1])) return;
  for (int end = 0; end < 2; end++)
    for (int c = 0; c < 4; c++) {
      const real weight = base[c] + slope[c] * cell.t[end];
      cell.scalar[end] += weight * (value[c] - value[0]); /* relative: weights add up to 1 only nearly */
      for (size_t k = 0; k < 3 && brute->gradients != NULL; k++)
        cell.gradient[end][k] += weight * brute->gradients[3 * (size_t)m->tets[4 * (size_t)tet + (size_t)c] + k];
    }
  for (int end = 0; end < 2; end++) cell.scalar[end] += value[0];
  if (brute->scalar->association == CELLIST_ON_CELLS) cell.scalar[0] = cell.scalar[1] = value[0];
  brute->cells[brute->cell_count++] = cell;
}

static inline int brute_compare(const void *a, const void *b) {
  const real x = ((const brute_cell *)a)->t[0] + ((const brute_cell *)a)->t[1];
  const real y = ((const brute_cell *)b)->t[0] + ((const brute_cell *)b)->t[1];
  return x < y ? -1 : x > y ? 1 : 0;
}

/* Fills brute->cells, from near to far. */
static inline void brute_collect(brute_force *brute, const double origin[3], const double direction[3],
                                 double near_distance) {
  brute->cell_count = 0;
  double square = 0;
  for (int k = 0; k < 3; k++) square += direction[k] * direction[k];
  for (size_t t = 0; t < brute->mesh->tet_count; t++) {
    const double *s = &brute->spheres[4 * t];
    const double x = s[0] - origin[0], y = s[1] - origin[1], z = s[2] - origin[2];
    const double along = x * direction[0] + y * direction[1] + z * direction[2];
    /* Squared distance from the line, with room for rounding. */
    if (x * x + y * y + z * z - along * along / square > s[3] * (1 + 1e-6) + 1e-12 * (x * x + y * y + z * z)) continue;
    brute_clip(brute, (uint32_t)t, origin, direction, near_distance);
  }
  qsort(brute->cells, brute->cell_count, sizeof *brute->cells, brute_compare);
}

/* Extinction, then colour, at a scalar that lies strictly between two knots or is held by the knot below it. */
static inline void brute_look_up(const cellist_transfer *transfer, real scalar, real middle, real out[4]) {
  size_t above = 0;
  while (above < transfer->knot_count && transfer->knots[above].value < middle) above++;
  const cellist_transfer_knot *a = &transfer->knots[above > 0 ? above - 1 : 0];
  const cellist_transfer_knot *b = &transfer->knots[above < transfer->knot_count ? above : above - 1];
  const real w = b->value > a->value ? (scalar - a->value) / ((real)b->value - a->value) : 1;
  out[0] = (1 - w) * a->extinction + w * b->extinction;
  for (int k = 0; k < 3; k++) out[1 + k] = (1 - w) * a->colour[k] + w * b->colour[k];
}

/* A piece between two knots. */
typedef struct brute_piece {
  const brute_force *brute;
  real extinction[2], colour[2][3], gradient[2][3], length;
} brute_piece;

/* Emitted light at w, attenuated from the piece's front. */
static inline void brute_integrand(const brute_piece *piece, real w, real out[3]) {
  const cellist_optics *optics = &piece->brute->optics;
  const real e0 = piece->extinction[0] * piece->length, e1 = piece->extinction[1] * piece->length;
  real emitted = e0 + (e1 - e0) * w;
  if (optics->model == CELLIST_MODEL_EMISSION_ABSORPTION) emitted *= expl(-(e0 * w + (e1 - e0) * w * w / 2));
  real share = 1, shine = 0;
  if (optics->light.enabled) {
    real facing = 0, half = 0, square = 0;
    for (int k = 0; k < 3; k++) {
      const real g = (1 - w) * piece->gradient[0][k] + w * piece->gradient[1][k];
      facing += g * piece->brute->light[k];
      half += g * piece->brute->halfway[k];
      square += g * g;
    }
    share = optics->light.ambient + optics->light.diffuse * fabsl(facing) / optics->light.gradient_unit;
    if (square > 0 && optics->light.specular > 0)
      shine = optics->light.specular * powl(fabsl(half) / sqrtl(square), optics->light.shininess);
  }
  for (int k = 0; k < 3; k++)
    out[k] = emitted * (((1 - w) * piece->colour[0][k] + w * piece->colour[1][k]) * share + shine);
}

/* Gauss-Kronrod 7-15 on 0..1, halved until the two rules agree to 1e-15. */
static inline void brute_quadrature(const brute_piece *piece, real low, real high, int depth, real out[3]) {
  static const real node[8] = {0.991455371120812639206854697526329L, 0.949107912342758524526189684047851L,
                               0.864864423359769072789712788640926L, 0.741531185599394439863864773280788L,
                               0.586087235467691130294144691258380L, 0.405845151377397166906606412076961L,
                               0.207784955007898467600689403773245L, 0};
  static const real kronrod[8] = {0.022935322010529224963732008058970L, 0.063092092629978553290700663189204L,
                                  0.104790010322250183839876322541518L, 0.140653259715525918745189590510238L,
                                  0.169004726639267902826583426598550L, 0.190350578064785409913256402421014L,
                                  0.204432940075298892414161999234649L, 0.209482141084727828012999174891714L};
  static const real gauss[4] = {0.129484966168869693270611432679082L, 0.279705391489276667901467771423780L,
                                0.381830050505118944950369775488975L, 0.417959183673469387755102040816327L};
  real fine[3] = {0}, coarse[3] = {0}, value[3], error = 0;
  for (int i = 0; i < 8; i++)
    for (int side = -1; side < (i == 7 ? 0 : 2); side += 2) {
      brute_integrand(piece, (low + high) / 2 + side * node[i] * (high - low) / 2, value);
      for (int k = 0; k < 3; k++) {
        fine[k] += kronrod[i] * value[k] * (high - low) / 2;
        if (i % 2 == 1) coarse[k] += gauss[i / 2] * value[k] * (high - low) / 2;
      }
    }
  for (int k = 0; k < 3; k++) error = fmaxl(error, fabsl(fine[k] - coarse[k]));
  if (error > 1e-15L && depth > 0) {
    real left[3], right[3];
    brute_quadrature(piece, low, (low + high) / 2, depth - 1, left);
    brute_quadrature(piece, (low + high) / 2, high, depth - 1, right);
    for (int k = 0; k < 3; k++) out[k] = left[k] + right[k];
    return;
  }
  memcpy(out, fine, 3 * sizeof out[0]);
}

/* The whole piece: first cut where the depth is 1, 2, ... 60, or a rule might find nothing but zeroes behind a peak. */
static inline void brute_piece_light(const brute_piece *piece, real out[3]) {
  const real a = piece->extinction[0] * piece->length, b = piece->extinction[1] * piece->length, depth = (a + b) / 2;
  const bool attenuated = piece->brute->optics.model == CELLIST_MODEL_EMISSION_ABSORPTION;
  memset(out, 0, 3 * sizeof out[0]);
  real low = 0;
  for (int panel = 1; low < 1 && panel <= 60; panel++) {
    real part[3], high = 1;
    if (attenuated && panel < depth) high = 2 * panel / (a + sqrtl(a * a + 2 * (b - a) * panel));
    brute_quadrature(piece, low, high, 30, part);
    for (int k = 0; k < 3; k++) out[k] += part[k];
    low = high;
  }
}

/* R G B A of a volume model along a ray whose cells have been collected. */
static inline void brute_shade(const brute_force *brute, const double direction[3], real rgba[4]) {
  const cellist_model model = brute->optics.model;
  const real length_per_t =
      sqrtl((real)direction[0] * direction[0] + (real)direction[1] * direction[1] + (real)direction[2] * direction[2]);
  real depth = 0;
  memset(rgba, 0, 4 * sizeof rgba[0]);
  for (size_t i = 0; i < brute->cell_count; i++) {
    const brute_cell *cell = &brute->cells[i];
    const real rise = cell->scalar[1] - cell->scalar[0];
    /* Cuts at the knots inside, in the direction of the ray, and where the light changes sides. */
    real at = 0, facing[2] = {0, 0};
    for (int k = 0; k < 3; k++)
      for (int end = 0; end < 2; end++) facing[end] += cell->gradient[end][k] * brute->light[k];
    const real turn = facing[0] * facing[1] < 0 ? facing[0] / (facing[0] - facing[1]) : 1;
    while (at < 1) {
      real next = turn > at ? turn : 1;
      for (size_t k = 0; k < brute->transfer->knot_count && rise != 0; k++) {
        const real w = (brute->transfer->knots[k].value - cell->scalar[0]) / rise;
        if (w > at + 1e-18L && w < next) next = w;
      }
      brute_piece piece = {.brute = brute, .length = (cell->t[1] - cell->t[0]) * (next - at) * length_per_t};
      for (int end = 0; end < 2; end++) {
        const real w = end == 0 ? at : next;
        real looked_up[4];
        brute_look_up(brute->transfer, cell->scalar[0] + w * rise, cell->scalar[0] + (at + next) / 2 * rise, looked_up);
        piece.extinction[end] = looked_up[0];
        for (int k = 0; k < 3; k++) {
          piece.colour[end][k] = looked_up[1 + k];
          piece.gradient[end][k] = (1 - w) * cell->gradient[0][k] + w * cell->gradient[1][k];
        }
      }
      real light[3] = {0};
      const real transmittance = model == CELLIST_MODEL_EMISSION ? 1 : expl(-depth);
      if (model != CELLIST_MODEL_ABSORPTION && transmittance > 1e-20L) brute_piece_light(&piece, light);
      for (int k = 0; k < 3; k++) rgba[k] += transmittance * light[k];
      if (model != CELLIST_MODEL_EMISSION) depth += (piece.extinction[0] + piece.extinction[1]) / 2 * piece.length;
      at = next;
    }
  }
  rgba[3] = -expm1l(-depth);
}

static inline void brute_volume(brute_force *brute, const double origin[3], const double direction[3],
                                double near_distance, real rgba[4]) {
  brute_collect(brute, origin, direction, near_distance);
  brute_shade(brute, direction, rgba);
}

#endif
