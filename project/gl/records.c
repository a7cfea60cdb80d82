/* SPDX-License-Identifier: BSD-3-Clause
 * Records: what the shader of `faces` reads of a cell (cell.glsl), and of its faces seen edge-on. */
#include "records.h"

#include <cellist/mesh.h>
#include <math.h>
#include <string.h>

/* What an exact sign leaves of a number that rounding made 0 or of the other sign: its size does not matter, as the
 * face is seen edge-on to the last digit. 0 itself would make a back face's cell infinitely long. */
static const double TINY_COORDINATE = 1e-12;
/* What single precision makes of 0 at a pixel of a line, whose numbers are at most 1 there: three roundings each. */
static const double LINE_ROUNDING = 4e-7;
/* In 1 / depth (parallel: depth) and units, what is as good as infinitely far towards the eye; its square and what it
 * is multiplied with fit a float. */
static const double FAR_OFF = 1e18;

static void cross(double out[3], const double a[3], const double b[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* A pixel's centre near the tet's picture, measured from the image's. Any is right, a near one loses no digits. */
static void choose_reference(const gl_cells *cells, const double *const corner[4], double reference[2]) {
  const bool parallel = cells->frame.parallel;
  const double limit[2] = {0.5 * cells->frame.width, 0.5 * cells->frame.height};
  bool in_front = true;
  for (int k = 0; k < 4; k++) in_front = in_front && (parallel || corner[k][2] > cells->picture.least_depth);
  for (int axis = 0; axis < 2; axis++) {
    double sum = 0;
    for (int k = 0; k < 4 && in_front; k++) sum += parallel ? corner[k][axis] : corner[k][axis] / corner[k][2];
    reference[axis] = floor(fmax(-limit[axis], fmin(limit[axis], 0.25 * sum)) + limit[axis]) + 0.5 - limit[axis];
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

/* A number that is linear in a cell, as the shader reads it: at the reference pixel on the back face's plane, its
 * change per pixel in x and y there, and what it grows by on the way to the eye (cell.glsl). p, w, edge: as
 * write_record. */
static void write_field(double edge[3][3], const double eye[4], unsigned k, bool parallel, const double at[4],
                        float out[3], float *growth) {
  const uint8_t *face = CELLIST_TET_FACE[k];
  /* Relative to one corner, so that a constant is one to the last digit. */
  double sum[3] = {0, 0, 0}, along = 0;
  for (int j = 0; j < 3; j++)
    for (int i = 0; i < 3; i++) sum[j] += at[face[i]] * edge[i][j];
  for (int c = 0; c < 4; c++) along += eye[c] * (at[c] - at[face[0]]);
  for (int j = 0; j < 3; j++) out[j] = (float)sum[j];
  *growth = (float)(parallel ? along : along + at[face[0]]);
}

/* p: the corners, sheared so that the reference pixel lies at 0. */
static void write_record(const gl_cells *cells, uint32_t tet, double p[4][3], const double eye[4],
                         const gl_shown *shown, const double reference[2], unsigned k, unsigned sides, unsigned lines,
                         gl_record *out) {
  const bool parallel = cells->frame.parallel;
  const uint8_t *face = CELLIST_TET_FACE[k];
  float *record = out->floats;
  double w[3];
  for (int i = 0; i < 3; i++) w[i] = parallel ? 1 : p[face[i]][2];
  double edge[3][3]; /* constant, x, y of each corner's barycentric coordinate / depth on the face's plane */
  for (int i = 0; i < 3; i++) {
    const int m = (i + 1) % 3, n = (i + 2) % 3;
    const double *b = p[face[m]], *c = p[face[n]];
    edge[i][0] = b[0] * c[1] - b[1] * c[0];
    edge[i][1] = b[1] * w[n] - w[m] * c[1];
    edge[i][2] = w[m] * c[0] - b[0] * w[n];
  }
  const double determinant = w[0] * edge[0][0] + p[face[0]][0] * edge[0][1] + p[face[0]][1] * edge[0][2];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) edge[i][j] /= determinant;
  /* The other faces, a front one (or one that does not end the ray) first. */
  int first = 0;
  while (first < 3 && sides & 1u << face[first] && !(lines & 1u << face[first])) first++;
  out->only_backs = first == 3;
  float planes[3][3];
  bool is_back[3];
  for (int i = 0; i < 3; i++) {
    const int from = (first + i) % 3;
    const bool is_line = lines & 1u << face[from];
    is_back[i] = sides & 1u << face[from] && !is_line;
    for (int j = 0; j < 3; j++) {
      const double far_off = j == 0 ? FAR_OFF : 0;
      planes[i][j] = is_line ? (float)far_off : (float)(edge[from][j] / -eye[face[from]]);
    }
  }
  double scalars[4], depths[4];
  for (int c = 0; c < 4; c++) {
    scalars[c] = shown->scalars[c];
    depths[c] = parallel ? p[c][2] : 1;
  }
  float unused;
  write_field(edge, eye, k, parallel, depths, &record[4], &unused);
  write_field(edge, eye, k, parallel, scalars, &record[8], &record[7]);
  for (int axis = 0; axis < 2; axis++) {
    const float at = (float)(reference[axis] + (axis == 0 ? 0.5 * cells->frame.width : 0.5 * cells->frame.height));
    record[axis] = is_back[1 + axis] ? -at : at;
  }
  record[2] = (float)shown->first;
  record[3] = (float)shown->last;
  memcpy(&record[12], planes[0], sizeof planes[0]);
  memcpy(&record[16], planes[1], sizeof planes[1]);
  for (int j = 0; j < 3; j++) record[11 + 4 * j] = planes[2][j];
  if (cells->light.gradients == NULL) return;
  double gradients[4][3];
  gl_light_of_points(&cells->light, &cells->mesh->arrays->tets[4 * (size_t)tet], gradients);
  for (int axis = 0; axis < 3; axis++) {
    double component[4];
    for (int c = 0; c < 4; c++) component[c] = gradients[c][axis];
    write_field(edge, eye, k, parallel, component, &out->lights[4 * axis], &out->lights[4 * axis + 3]);
  }
}

void gl_record_light(const gl_cells *cells, uint32_t tet, float record[GL_RECORD_FLOATS]) {
  record[20] = 1;
  record[21] = record[22] = record[23] = 0;
  if (!cells->light.enabled || cells->light.gradients != NULL) return;
  const cellist_mesh_arrays *arrays = cells->mesh->arrays;
  const uint32_t *v = &arrays->tets[4 * (size_t)tet];
  const double *corners[4];
  double scalars[4];
  for (int k = 0; k < 4; k++) {
    corners[k] = &arrays->positions[3 * (size_t)v[k]];
    scalars[k] = cells->mesh->values[cells->mesh->on_cells ? tet : v[k]];
  }
  gl_light_of_cell(&cells->light, corners, scalars, &record[20]);
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
  const double *const p[3] = {cells->points[id[0]].at, cells->points[id[1]].at, cells->points[id[2]].at};
  double u[3], v[3], n[3];
  for (int k = 0; k < 3; k++) {
    u[k] = p[1][k] - p[0][k];
    v[k] = p[2][k] - p[0][k];
  }
  cross(n, u, v);
  const double thickness = distance_from_line(p, n, cells->frame.parallel);
  if (!is_exact && (wild || !(thickness < GL_THIN_FACE))) return false;
  if (cells->frame.parallel) n[2] = -(n[0] * p[0][0] + n[1] * p[0][1]);
  const double size =
      fmax(fmax(fabs(n[0]) * cells->picture.half_width, fabs(n[1]) * cells->picture.half_height), fabs(n[2]));
  const double scale = size > 0 ? side / size : 0;
  line[0] = (float)(n[2] * scale);
  line[1] = (float)(n[0] * scale);
  line[2] = (float)(n[1] * scale);
  line[3] = (float)(LINE_ROUNDING + fmin(thickness, GL_THIN_FACE) * hypot(n[0], n[1]) * fabs(scale));
  return true;
}

void gl_record_write(const gl_cells *cells, uint32_t tet, const gl_shown *shown, unsigned sides, bool wild,
                     gl_record *out) {
  const uint32_t *v = &cells->mesh->arrays->tets[4 * (size_t)tet];
  const double *corner[4];
  double reference[2], p[4][3], eye[4];
  for (int k = 0; k < 4; k++) corner[k] = cells->points[v[k]].at;
  choose_reference(cells, corner, reference);
  for (int k = 0; k < 4; k++) { /* a shear keeps volumes */
    for (int axis = 0; axis < 2; axis++)
      p[k][axis] = corner[k][axis] - reference[axis] * (cells->frame.parallel ? 1 : corner[k][2]);
    p[k][2] = corner[k][2];
  }
  eye_coordinates(p, cells->frame.parallel, sides, eye);
  const unsigned k = choose_face(cells, p, sides, wild);
  unsigned lines = 0;
  for (int i = 0; i < 3; i++) {
    const unsigned f = CELLIST_TET_FACE[k][i];
    float line[4];
    if (!find_line(cells, tet, f, !(sides & 17u << f), wild, line)) continue;
    if (lines == 0) out->extra = (gl_extra){0};
    memcpy(out->extra.lines[i], line, sizeof line);
    lines |= 1u << f;
  }
  write_record(cells, tet, p, eye, shown, reference, k, sides, lines, out);
  out->has_extra = lines != 0 || out->only_backs;
  if (out->has_extra) {
    if (lines == 0) out->extra = (gl_extra){0};
    out->extra.only_backs = out->only_backs;
    out->floats[2] = -1 - out->floats[2]; /* so the shader knows */
  }
  gl_record_light(cells, tet, out->floats);
}
