/* SPDX-License-Identifier: BSD-3-Clause
 * Records: what the shader of `faces` reads of a cell (cell.glsl), and of its faces seen edge-on. */
#include "records.h"

#include <cellist/mesh.h>
#include <math.h>
#include <string.h>

/* What an exact sign leaves of a number that rounding made 0 or of the other sign: its size does not matter, as the
 * face is seen edge-on to the last digit. 0 itself would make a back face's cell infinitely long. */
static const double TINY_COORDINATE = 1e-12;
/* Pixels. A face whose picture is thinner is a line: single precision cannot tell on which side of it, or in it, a
 * pixel lies. Larger: pixels in a face's picture lose the crossing from one cell to the other. Smaller: both cells at a
 * face, or neither, may draw a pixel. */
static const double THIN_FACE = 1.0 / 4096;
static void cross(double out[3], const double a[3], const double b[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* A pixel corner near the tet's picture, measured from the image's centre. Any is right, a near one loses no digits. */
static void choose_reference(const gl_cells *cells, const double *const corner[4], double reference[2]) {
  const bool parallel = cells->frame.parallel;
  const double limit[2] = {0.5 * cells->frame.width, 0.5 * cells->frame.height};
  bool in_front = true;
  for (int k = 0; k < 4; k++) in_front = in_front && (parallel || corner[k][2] > cells->picture.least_depth);
  for (int axis = 0; axis < 2; axis++) {
    double sum = 0;
    for (int k = 0; k < 4 && in_front; k++) sum += parallel ? corner[k][axis] : corner[k][axis] / corner[k][2];
    /* floor(+ limit) - limit keeps whole pixels of the window, whose centre may lie on half ones */
    reference[axis] = floor(fmax(-limit[axis], fmin(limit[axis], 0.25 * sum)) + limit[axis]) - limit[axis];
  }
}

/* The eye's barycentric coordinates (parallel: their change per unit towards the eye), of the exact signs. */
static void eye_coordinates(double p[4][3], bool parallel, uint8_t sides, double eye[4]) {
  double edges[3][3], gradients[4][3];
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) edges[i][k] = p[i + 1][k] - p[0][k];
  cross(gradients[1], edges[1], edges[2]);
  cross(gradients[2], edges[2], edges[0]);
  cross(gradients[3], edges[0], edges[1]);
  for (int k = 0; k < 3; k++) gradients[0][k] = -(gradients[1][k] + gradients[2][k] + gradients[3][k]);
  const double volume = dot(edges[0], gradients[1]);
  for (int k = 0; k < 4; k++) {
    double value = parallel ? -gradients[k][2] : -dot(gradients[k], p[k == 0 ? 1 : 0]);
    value /= volume;
    if (sides & 1 << k)
      value = value > TINY_COORDINATE ? value : TINY_COORDINATE;
    else if (sides & 16 << k)
      value = value < -TINY_COORDINATE ? value : -TINY_COORDINATE;
    else
      value = 0;
    eye[k] = value;
  }
}

/* The back face that the others are measured from: the one with the largest picture; for a wild tet, where pictures
 * say nothing, the one whose plane is farthest from the eye. p: as write_record. */
static unsigned choose_face(const gl_cells *cells, double p[4][3], unsigned sides, bool wild) {
  unsigned best = 0;
  double most = -1;
  for (unsigned k = 0; k < 4; k++) {
    if (!(sides & 1u << k)) continue;
    const uint8_t *face = CELLIST_TET_FACE[k];
    double u[3], v[3], normal[3], merit;
    for (int i = 0; i < 3; i++) {
      u[i] = p[face[1]][i] - p[face[0]][i];
      v[i] = p[face[2]][i] - p[face[0]][i];
    }
    cross(normal, u, v);
    if (cells->frame.parallel)
      merit = fabs(normal[2]);
    else if (wild)
      merit = fabs(dot(normal, p[face[0]])) / sqrt(dot(normal, normal));
    else
      merit = fabs(dot(normal, p[face[0]])) / (p[face[0]][2] * p[face[1]][2] * p[face[2]][2]);
    if (!(merit > most)) continue;
    most = merit;
    best = k;
  }
  return best;
}

/* p: the corners, sheared so that the reference pixel lies at 0. */
static void write_record(const gl_cells *cells, double p[4][3], const double eye[4], const gl_shown *shown,
                         const double reference[2], unsigned k, float record[]) {
  const uint8_t *face = CELLIST_TET_FACE[k];
  double w[3];
  for (int i = 0; i < 3; i++) w[i] = cells->frame.parallel ? 1 : p[face[i]][2];
  record[0] = (float)(reference[0] + 0.5 * cells->frame.width);
  record[1] = (float)(reference[1] + 0.5 * cells->frame.height);
  record[2] = (float)shown->first;
  record[3] = (float)shown->last;
  double edge[3][3]; /* constant, x, y of each corner's edge function: 0 on the edge between the other two */
  for (int i = 0; i < 3; i++) {
    const int m = (i + 1) % 3, n = (i + 2) % 3;
    const double *b = p[face[m]], *c = p[face[n]];
    edge[i][0] = b[0] * c[1] - b[1] * c[0];
    edge[i][1] = b[1] * w[n] - w[m] * c[1];
    edge[i][2] = w[m] * c[0] - b[0] * w[n];
  }
  const double determinant = w[0] * edge[0][0] + p[face[0]][0] * edge[0][1] + p[face[0]][1] * edge[0][2];
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) record[4 + 4 * i + j] = (float)(edge[i][j] / determinant);
    record[7 + 4 * i] = (float)eye[face[i]];
    record[16 + i] = shown->scalars[face[i]];
    record[20 + i] = (float)p[face[i]][2];
  }
  record[19] = shown->scalars[k];
  record[23] = (float)eye[k];
}

void gl_record_light(const gl_cells *cells, uint32_t tet, float record[GL_RECORD_FLOATS]) {
  record[24] = 1;
  record[25] = record[26] = record[27] = 0;
  if (!cells->light.enabled || cells->light.gradients != NULL) return;
  const cellist_mesh_arrays *arrays = cells->mesh->arrays;
  const uint32_t *v = &arrays->tets[4 * (size_t)tet];
  const double *corners[4];
  double scalars[4];
  for (int k = 0; k < 4; k++) {
    corners[k] = &arrays->positions[3 * (size_t)v[k]];
    scalars[k] = cells->mesh->values[cells->mesh->on_cells ? tet : v[k]];
  }
  gl_light_of_cell(&cells->light, corners, scalars, &record[24]);
}

/* How far, in pixels, the pictures of points in a plane lie from the line in which the plane is seen edge-on: HUGE_VAL
 * if it is not. p: three of them; n: the plane's normal. */
static double distance_from_line(const double *const p[3], const double n[3], bool parallel) {
  double most = 0;
  for (int i = 0; i < 3; i++)
    most = fmax(most, parallel ? fabs(n[2] * (p[i][2] - p[0][2])) : fabs(dot(n, p[0])) / p[i][2]);
  const double slope = hypot(n[0], n[1]);
  return slope > 0 ? most / slope : HUGE_VAL;
}

/* If a face is seen edge-on, up to what single precision can tell, the line that it is in the picture. Worked out from
 * the face's points in the order of their ids, so that both cells at the face find the same; on which side the cell
 * lies is told by the order in which it names them. */
static bool find_line(const gl_cells *cells, uint32_t tet, unsigned face, bool is_exact, bool wild, float line[4]) {
  uint32_t id[3];
  int side = -cells->handedness; /* of a face counter-clockwise from outside: 1 where its normal points inwards */
  for (int i = 0; i < 3; i++) id[i] = cells->mesh->arrays->tets[4 * (size_t)tet + CELLIST_TET_FACE[face][i]];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 2; j++)
      if (id[j] > id[j + 1]) {
        const uint32_t kept = id[j];
        id[j] = id[j + 1];
        id[j + 1] = kept;
        side = -side;
      }
  const double *const p[3] = {cells->corners[id[0]], cells->corners[id[1]], cells->corners[id[2]]};
  double u[3], v[3], n[3];
  for (int k = 0; k < 3; k++) {
    u[k] = p[1][k] - p[0][k];
    v[k] = p[2][k] - p[0][k];
  }
  cross(n, u, v);
  if (!is_exact && (wild || !(distance_from_line(p, n, cells->frame.parallel) < THIN_FACE))) return false;
  if (cells->frame.parallel) n[2] = -(n[0] * p[0][0] + n[1] * p[0][1]);
  const double size =
      fmax(fmax(fabs(n[0]) * cells->picture.half_width, fabs(n[1]) * cells->picture.half_height), fabs(n[2]));
  const double scale = size > 0 ? side / size : 0;
  line[0] = (float)(n[2] * scale);
  line[1] = (float)(n[0] * scale);
  line[2] = (float)(n[1] * scale);
  line[3] = 1;
  return true;
}

void gl_record_write(const gl_cells *cells, uint32_t tet, const gl_shown *shown, unsigned sides, bool wild,
                     gl_record *out) {
  const uint32_t *v = &cells->mesh->arrays->tets[4 * (size_t)tet];
  const double *corner[4];
  double reference[2], p[4][3], eye[4];
  float *record = out->floats;
  for (int k = 0; k < 4; k++) corner[k] = cells->corners[v[k]];
  choose_reference(cells, corner, reference);
  for (int k = 0; k < 4; k++) { /* a shear keeps volumes */
    for (int axis = 0; axis < 2; axis++)
      p[k][axis] = corner[k][axis] - reference[axis] * (cells->frame.parallel ? 1 : corner[k][2]);
    p[k][2] = corner[k][2];
  }
  eye_coordinates(p, cells->frame.parallel, sides, eye);
  const unsigned k = choose_face(cells, p, sides, wild);
  write_record(cells, p, eye, shown, reference, k, record);
  out->has_extra = false;
  for (int i = 0; i < 3; i++) {
    const unsigned f = CELLIST_TET_FACE[k][i];
    float line[4];
    if (!find_line(cells, tet, f, !(sides & 17u << f), wild, line)) continue;
    if (!out->has_extra) out->extra = (gl_extra){0};
    memcpy(out->extra.lines[i], line, sizeof line);
    out->has_extra = true;
  }
  if (out->has_extra) record[2] = -1 - record[2]; /* so the shader knows */
  gl_record_light(cells, tet, record);
  if (cells->light.gradients == NULL) return;
  const uint8_t *face = CELLIST_TET_FACE[k];
  gl_light_of_points(&cells->light, (const uint32_t[4]){v[face[0]], v[face[1]], v[face[2]], v[k]}, out->lights);
}
