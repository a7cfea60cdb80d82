/* SPDX-License-Identifier: BSD-3-Clause
 * Cells of a frame: everything that is subtracted is subtracted here, in double and relative to the eye and to a pixel
 * near the cell, so that float suffices in the shaders, also for a mesh far from the origin or a needle of a cell.
 *
 * With the eye at the origin and g_k the gradient (times volume) of corner k's barycentric coordinate, that
 * coordinate is -g_k.p / V at the eye; its sign says on which side of face k the eye lies, and is decided exactly. A
 * face with sign 0 contains the eye (or the direction): no ray crosses it, so it is neither back nor front. */
#include "cells.h"

#include <cellist/predicates.h>
#include <math.h>
#include <string.h>

/* What an exact sign leaves of a number that rounding made 0 or of the other sign: its size does not matter, as the
 * face is seen edge-on to the last digit. 0 itself would make a back face's cell infinitely long. */
static const double TINY_COORDINATE = 1e-12;
/* What counts as behind the eye without a near distance, relative to the mesh's size. It only tells where a cell can
 * be seen: a cell all of whose back faces lie nearer is lost. */
static const double LEAST_SHARE = 1e-9;

/* Bits of a point: beyond each side of the view, before the near plane; and whether it is wild. */
enum { OUTSIDE_VIEW = 31, OUTSIDE_WILD = 32 };

static void cross(double out[3], const double a[3], const double b[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void gl_cells_mesh_release(cellist_context *context, gl_cells_mesh *mesh) {
  cellist_deallocate(context, mesh->scalars);
  *mesh = (gl_cells_mesh){0};
}

cellist_result gl_cells_mesh_make(cellist_context *context, const cellist_mesh *mesh, const cellist_scalar *scalar,
                                  gl_cells_mesh *made) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const bool on_cells = scalar->association == CELLIST_ON_CELLS;
  if (scalar->count != (on_cells ? arrays->tet_count : arrays->point_count) ||
      (scalar->values == NULL && scalar->count > 0))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the scalar has %zu values, the mesh %zu %s",
                        scalar->count, on_cells ? arrays->tet_count : arrays->point_count,
                        on_cells ? "tets" : "points");
  float *scalars = cellist_allocate(context, scalar->count, sizeof *scalars);
  if (scalars == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  const gl_scale scale = gl_scale_of(scalar);
  for (size_t i = 0; i < scalar->count; i++) {
    const double value = scalar->values[i];
    scalars[i] = isfinite(value) ? (float)((value - scale.offset) * scale.factor) : NAN;
  }
  *made = (gl_cells_mesh){arrays, on_cells, scalar->values, scalars};
  return CELLIST_SUCCESS;
}

static void transform_range(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  gl_cells *cells = user;
  const cellist_frame *frame = &cells->frame;
  const double half_width = 0.5 * frame->width, half_height = 0.5 * frame->height;
  for (size_t i = begin; i < end; i++) {
    const double *position = &cells->mesh->arrays->positions[3 * i];
    double from_eye[3], *corner = cells->corners[i];
    for (int k = 0; k < 3; k++) from_eye[k] = position[k] - frame->eye[k];
    corner[0] = corner[1] = corner[2] = 0;
    for (int k = 0; k < 3; k++) {
      corner[0] += from_eye[k] * frame->right[k];
      corner[1] += from_eye[k] * frame->up[k];
      corner[2] += from_eye[k] * frame->forward[k];
    }
    corner[0] *= half_width / frame->half_width;
    corner[1] *= half_height / frame->half_height;
    const double w = frame->parallel ? 1 : corner[2];
    cells->outside[i] = (uint8_t)((corner[0] < -half_width * w) | (corner[0] > half_width * w) << 1 |
                                  (corner[1] < -half_height * w) << 2 | (corner[1] > half_height * w) << 3 |
                                  (corner[2] < frame->near_distance) << 4 |
                                  (gl_corner_is_wild(&cells->picture, corner) ? OUTSIDE_WILD : 0));
  }
}

void gl_cells_release(gl_cells *cells) {
  cellist_deallocate(cells->context, cells->corners);
  cellist_deallocate(cells->context, cells->outside);
  *cells = (gl_cells){0};
}

cellist_result gl_cells_begin(cellist_context *context, const gl_cells_mesh *mesh, const cellist_frame *frame,
                              const gl_intervals *intervals, const gl_light *light, double margin, gl_cells *cells) {
  const size_t count = mesh->arrays->point_count;
  const double *bounds = mesh->arrays->bounds;
  gl_cells made = {.context = context, .mesh = mesh, .frame = *frame, .intervals = intervals};
  const double size = fmax(bounds[3] - bounds[0], fmax(bounds[4] - bounds[1], bounds[5] - bounds[2]));
  made.picture = (gl_picture){.half_width = 0.5 * frame->width,
                              .half_height = 0.5 * frame->height,
                              .least_depth = fmax(0.5 * frame->near_distance, LEAST_SHARE * size),
                              .margin = margin,
                              .parallel = frame->parallel};
  made.light = *light;
  double sideways[3];
  cross(sideways, frame->right, frame->up);
  made.handedness = dot(sideways, frame->forward) > 0 ? 1 : -1;
  made.corners = cellist_allocate(context, count, sizeof *made.corners);
  made.outside = cellist_allocate(context, count, 1);
  if (made.corners == NULL || made.outside == NULL) {
    gl_cells_release(&made);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  *cells = made;
  cellist_parallel_for(context, count, 4096, transform_range, cells);
  return CELLIST_SUCCESS;
}

/* The scaled scalars of a tet's corners and the transfer function's intervals that they touch. */
struct shown {
  float scalars[4];
  uint32_t first, last;
};

/* Whether anything of the tet can be seen. */
static bool find_shown(const gl_cells *cells, uint32_t tet, struct shown *shown) {
  const gl_cells_mesh *mesh = cells->mesh;
  const uint32_t *v = &mesh->arrays->tets[4 * (size_t)tet];
  float low = INFINITY, high = -INFINITY;
  for (int k = 0; k < 4; k++) {
    const float value = mesh->on_cells ? mesh->scalars[tet] : mesh->scalars[v[k]];
    if (isnan(value)) return false;
    shown->scalars[k] = value;
    low = fminf(low, value);
    high = fmaxf(high, value);
  }
  shown->first = gl_interval_of(cells->intervals, low);
  shown->last = gl_interval_of(cells->intervals, high);
  return gl_intervals_show(cells->intervals, shown->first, shown->last);
}

/* Which faces of a tet are back faces (bit k: the one opposite to corner k) and which are front faces (bit 4 + k),
 * exactly; 0 if no part of it can be seen. */
static unsigned classify(const gl_cells *cells, uint32_t tet) {
  const cellist_mesh_arrays *arrays = cells->mesh->arrays;
  const uint32_t *v = &arrays->tets[4 * (size_t)tet];
  if (arrays->tet_flags[tet] & CELLIST_TET_FLAT) return 0;
  if (cells->outside[v[0]] & cells->outside[v[1]] & cells->outside[v[2]] & cells->outside[v[3]] & OUTSIDE_VIEW)
    return 0;
  unsigned sides = 0;
  for (unsigned k = 0; k < 4; k++) {
    const uint8_t *face = CELLIST_TET_FACE[k];
    const double *a = &arrays->positions[3 * (size_t)v[face[0]]], *b = &arrays->positions[3 * (size_t)v[face[1]]],
                 *c = &arrays->positions[3 * (size_t)v[face[2]]];
    const int inward = cells->frame.parallel ? cellist_orient3d_direction(a, b, c, cells->frame.forward)
                                             : -cellist_orient3d(a, b, c, cells->frame.eye);
    if (inward != 0) sides |= inward > 0 ? 1u << k : 16u << k;
  }
  return sides & 15 ? sides : 0;
}

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
static void write_record(const gl_cells *cells, double p[4][3], const double eye[4], const struct shown *shown,
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

static void write_light(const gl_cells *cells, uint32_t tet, float record[]) {
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

/* The line that a face seen edge-on is in the picture. Worked out from the face's points in the order of their ids, so
 * that both cells at the face find the same numbers; on which side the cell lies is told by the order in which it names
 * them. */
static void write_line(const gl_cells *cells, uint32_t tet, unsigned face, float line[4]) {
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
  const double *p = cells->corners[id[0]], *q = cells->corners[id[1]], *r = cells->corners[id[2]];
  double u[3], v[3], n[3];
  for (int k = 0; k < 3; k++) {
    u[k] = q[k] - p[k];
    v[k] = r[k] - p[k];
  }
  cross(n, u, v);
  if (cells->frame.parallel) n[2] = -(n[0] * p[0] + n[1] * p[1]);
  const double size =
      fmax(fmax(fabs(n[0]) * cells->picture.half_width, fabs(n[1]) * cells->picture.half_height), fabs(n[2]));
  const double scale = size > 0 ? side / size : 0;
  line[0] = (float)(n[2] * scale);
  line[1] = (float)(n[0] * scale);
  line[2] = (float)(n[1] * scale);
  line[3] = 0;
}

/* Writes one cell, its gradients too where lights is not NULL, and extra if it has faces seen edge-on; returns the
 * number of triangle corners, 0 if it shows nothing. */
static int prepare_cell(const gl_cells *cells, uint32_t tet, float record_id, float record[], float *lights,
                        gl_extra *extra, bool *has_extra, gl_corner *out) {
  struct shown shown;
  if (!find_shown(cells, tet, &shown)) return 0;
  const unsigned sides = classify(cells, tet);
  if (sides == 0) return 0;
  const uint32_t *v = &cells->mesh->arrays->tets[4 * (size_t)tet];
  const bool wild =
      (cells->outside[v[0]] | cells->outside[v[1]] | cells->outside[v[2]] | cells->outside[v[3]]) & OUTSIDE_WILD;
  const double *corner[4];
  for (int k = 0; k < 4; k++) corner[k] = cells->corners[v[k]];
  double polygon[GL_FOOTPRINT_CORNERS][2];
  const int polygon_count = wild ? gl_footprint_of_wild_tet(&cells->picture, corner, sides & 15, polygon)
                                 : gl_footprint_of_tet(&cells->picture, corner, sides & 15, polygon);
  if (polygon_count == 0) return 0;
  int count = 0;
  for (int i = 2; i < polygon_count; i++)
    for (int c = 0; c < 3; c++) {
      const double *at = polygon[c == 0 ? 0 : i - 2 + c];
      out[count++] = (gl_corner){(float)(at[0] / cells->picture.half_width),
                                 (float)(at[1] / cells->picture.half_height), record_id};
    }
  double reference[2], p[4][3], eye[4];
  choose_reference(cells, corner, reference);
  for (int k = 0; k < 4; k++) { /* a shear keeps volumes */
    for (int axis = 0; axis < 2; axis++)
      p[k][axis] = corner[k][axis] - reference[axis] * (cells->frame.parallel ? 1 : corner[k][2]);
    p[k][2] = corner[k][2];
  }
  eye_coordinates(p, cells->frame.parallel, sides, eye);
  const unsigned k = choose_face(cells, p, sides, wild);
  write_record(cells, p, eye, &shown, reference, k, record);
  *has_extra = false;
  for (int i = 0; i < 3; i++)
    if (!(sides & 17u << CELLIST_TET_FACE[k][i])) {
      write_line(cells, tet, CELLIST_TET_FACE[k][i], extra->lines[i]);
      *has_extra = true;
    }
  if (*has_extra) record[2] = -1 - record[2]; /* so the shader knows */
  record[24] = 1;
  record[25] = record[26] = record[27] = 0;
  if (lights != NULL) {
    const uint8_t *face = CELLIST_TET_FACE[k];
    gl_light_of_points(&cells->light, (const uint32_t[4]){v[face[0]], v[face[1]], v[face[2]], v[k]}, lights);
  } else if (cells->light.enabled) {
    write_light(cells, tet, record);
  }
  return count;
}

struct job {
  const gl_cells *cells;
  const uint32_t *order;
  gl_piece *pieces;
  const gl_cells_output *output;
};

static void widen(gl_piece *piece, const gl_corner *corners, int count) {
  for (int i = 0; i < count; i++) {
    const float at[2] = {corners[i].x, corners[i].y};
    for (int k = 0; k < 2; k++) {
      piece->low[k] = fminf(piece->low[k], at[k]);
      piece->high[k] = fmaxf(piece->high[k], at[k]);
    }
  }
}

static void prepare_piece(const struct job *job, gl_piece *piece) {
  static const float nothing[GL_RECORD_FLOATS] = {0, 0, 1, 0}; /* the last interval lies before the first one */
  const gl_cells_output *output = job->output;
  gl_corner *corners = output->corners + (size_t)3 * GL_CELLS_TRIANGLES * piece->begin;
  piece->corner_count = piece->cell_count = 0;
  for (int k = 0; k < 2; k++) {
    piece->low[k] = 1;
    piece->high[k] = -1;
  }
  for (size_t i = piece->begin; i < piece->begin + piece->count; i++) {
    /* copied as a whole: the buffers may be write-combined memory */
    float record[GL_RECORD_FLOATS], lights[GL_LIGHT_FLOATS];
    gl_corner made[3 * GL_CELLS_TRIANGLES];
    gl_extra extra = {0};
    bool has_extra = false;
    const int made_count = prepare_cell(job->cells, job->order[i], (float)i, record,
                                        output->lights != NULL ? lights : NULL, &extra, &has_extra, made);
    if (piece->is_group) {
      extra.first_record = (float)piece->begin;
      extra.member_count = (float)piece->count;
      if (made_count == 0) memcpy(output->records[i], nothing, sizeof nothing);
    }
    if (has_extra || piece->is_group) memcpy(&output->extras[i], &extra, sizeof extra);
    if (made_count == 0) continue;
    memcpy(output->records[i], record, sizeof record);
    if (output->lights != NULL) memcpy(output->lights[i], lights, sizeof lights);
    memcpy(corners + piece->corner_count, made, (size_t)made_count * sizeof *made);
    widen(piece, made, made_count);
    piece->corner_count += (uint32_t)made_count;
    piece->cell_count++;
  }
}

static void prepare_pieces(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  for (size_t i = begin; i < end; i++) prepare_piece(job, &job->pieces[i]);
}

void gl_cells_prepare(const gl_cells *cells, const uint32_t *order, gl_piece *pieces, size_t piece_count,
                      const gl_cells_output *output) {
  struct job job = {cells, order, pieces, output};
  cellist_parallel_for(cells->context, piece_count, 1, prepare_pieces, &job);
}
