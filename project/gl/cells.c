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

#include "records.h"

/* What counts as behind the eye without a near distance, in units. It only tells where a cell can be seen: a cell all
 * of whose back faces lie nearer is lost. */
static const double LEAST_DEPTH = 1e-9;

/* Bits of a point: beyond each side of the view, before the near plane; and whether it is wild. */
enum { OUTSIDE_VIEW = 31, OUTSIDE_NEAR = 16, OUTSIDE_WILD = 32 };

/* Of right, up, forward. */
static int handedness_of(const cellist_frame *frame) {
  const double *r = frame->right, *u = frame->up, *f = frame->forward;
  const double volume =
      (r[1] * u[2] - r[2] * u[1]) * f[0] + (r[2] * u[0] - r[0] * u[2]) * f[1] + (r[0] * u[1] - r[1] * u[0]) * f[2];
  return volume > 0 ? 1 : -1;
}

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
  const double half_width = 0.5 * frame->width, half_height = 0.5 * frame->height, per_unit = 1 / cells->unit;
  for (size_t i = begin; i < end; i++) {
    const double *position = &cells->mesh->arrays->positions[3 * i];
    double from_eye[3], *corner = cells->points[i].at;
    for (int k = 0; k < 3; k++) from_eye[k] = (position[k] - frame->eye[k]) * per_unit;
    corner[0] = corner[1] = corner[2] = 0;
    for (int k = 0; k < 3; k++) {
      corner[0] += from_eye[k] * frame->right[k];
      corner[1] += from_eye[k] * frame->up[k];
      corner[2] += from_eye[k] * frame->forward[k];
    }
    corner[0] *= half_width / frame->half_width;
    corner[1] *= half_height / frame->half_height;
    const double w = frame->parallel ? 1 : corner[2];
    cells->points[i].outside = (uint32_t)((corner[0] < -half_width * w) | (corner[0] > half_width * w) << 1 |
                                          (corner[1] < -half_height * w) << 2 | (corner[1] > half_height * w) << 3 |
                                          (corner[2] < frame->near_distance) << 4 |
                                          (gl_corner_is_wild(&cells->picture, corner) ? OUTSIDE_WILD : 0));
    cells->points[i].scalar = cells->mesh->on_cells ? 0 : cells->mesh->scalars[i];
  }
}

void gl_cells_release(gl_cells *cells) {
  cellist_deallocate(cells->context, cells->points);
  *cells = (gl_cells){0};
}

double gl_unit_of(const cellist_mesh_arrays *mesh) {
  const double *bounds = mesh->bounds;
  const double size = fmax(bounds[3] - bounds[0], fmax(bounds[4] - bounds[1], bounds[5] - bounds[2]));
  return size > 0 && isfinite(size) ? ldexp(1, (int)fmax(-1000, fmin(1000, ilogb(size)))) : 1;
}

cellist_result gl_cells_begin(cellist_context *context, const gl_cells_mesh *mesh, const cellist_frame *frame,
                              const gl_intervals *intervals, const gl_light *light, double margin, gl_cells *cells) {
  const size_t count = mesh->arrays->point_count;
  gl_cells made = {
      .context = context, .mesh = mesh, .frame = *frame, .unit = gl_unit_of(mesh->arrays), .intervals = intervals};
  made.frame.near_distance /= made.unit;
  if (frame->parallel) {
    made.frame.half_width /= made.unit;
    made.frame.half_height /= made.unit;
  }
  made.picture = (gl_picture){.half_width = 0.5 * frame->width,
                              .half_height = 0.5 * frame->height,
                              .least_depth = fmax(0.5 * made.frame.near_distance, LEAST_DEPTH),
                              .margin = margin,
                              .parallel = frame->parallel};
  made.light = *light;
  made.handedness = handedness_of(frame);
  made.points = cellist_allocate(context, count, sizeof *made.points);
  if (made.points == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  *cells = made;
  cellist_parallel_for(context, count, 4096, transform_range, cells);
  return CELLIST_SUCCESS;
}

/* Whether anything of the tet can be seen. */
static bool find_shown(const gl_cells *cells, uint32_t tet, gl_shown *shown) {
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
  /* Of the interval below a knot, one point alone matters to an isosurface only. */
  if (cells->intervals->model != CELLIST_MODEL_ISOSURFACES && shown->first < shown->last)
    while (shown->first < shown->last && cells->intervals->knots[shown->first] <= low) shown->first++;
  return gl_intervals_show(cells->intervals, shown->first, shown->last);
}

/* Which faces of a tet are back faces (bit k: the one opposite to corner k) and which are front faces (bit 4 + k),
 * exactly; 0 if no part of it can be seen. */
static unsigned classify(const gl_cells *cells, uint32_t tet) {
  const cellist_mesh_arrays *arrays = cells->mesh->arrays;
  const uint32_t *v = &arrays->tets[4 * (size_t)tet];
  if (arrays->tet_flags[tet] & CELLIST_TET_FLAT) return 0;
  const gl_point *points = cells->points;
  if (points[v[0]].outside & points[v[1]].outside & points[v[2]].outside & points[v[3]].outside & OUTSIDE_VIEW)
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

/* What is known of a cell before it is written. */
struct cell {
  uint32_t tet;
  gl_shown shown;
  unsigned sides;
  uint32_t outside; /* of any corner */
  bool wild;
  const double *corner[4];
};

/* Whether anything of the cell can be seen. */
static bool look_at(const gl_cells *cells, uint32_t tet, struct cell *cell) {
  cell->tet = tet;
  if (!find_shown(cells, tet, &cell->shown)) return false;
  cell->sides = classify(cells, tet);
  if (cell->sides == 0) return false;
  const uint32_t *v = &cells->mesh->arrays->tets[4 * (size_t)tet];
  cell->outside = 0;
  for (int k = 0; k < 4; k++) {
    cell->outside |= cells->points[v[k]].outside;
    cell->corner[k] = cells->points[v[k]].at;
  }
  cell->wild = cell->outside & OUTSIDE_WILD;
  return true;
}

/* Writes a cell's footprint and record; returns the number of triangle corners, 0 if it shows nothing. */
static int write_footprint(const gl_cells *cells, const struct cell *cell, float record_id, gl_record *record,
                           gl_corner *out) {
  double polygon[GL_FOOTPRINT_CORNERS][2];
  const unsigned back = cell->sides & 15;
  const int polygon_count = cell->wild ? gl_footprint_of_wild_tet(&cells->picture, cell->corner, back, polygon)
                                       : gl_footprint_of_tet(&cells->picture, cell->corner, back, polygon);
  if (polygon_count == 0) return 0;
  int count = 0;
  for (int i = 2; i < polygon_count; i++)
    for (int c = 0; c < 3; c++) {
      const double *at = polygon[c == 0 ? 0 : i - 2 + c];
      out[count++] = (gl_corner){(float)(at[0] / cells->picture.half_width),
                                 (float)(at[1] / cells->picture.half_height), record_id};
    }
  gl_record_write(cells, cell->tet, &cell->shown, cell->sides, cell->wild, record);
  return count;
}

/* Writes a cell's fan and what its record needs for it; returns the number of triangle corners. */
static int write_fan(const gl_cells *cells, const struct cell *cell, float record_id, gl_record *record,
                     gl_fan_corner *out) {
  memset(record->floats, 0, sizeof record->floats);
  record->floats[2] = (float)cell->shown.first;
  record->floats[3] = (float)cell->shown.last;
  gl_record_light(cells, cell->tet, record->floats);
  return gl_fan_of_tet(&cells->picture, cell->corner, cell->shown.scalars, cell->sides, record_id, out);
}

/* As THICK in exact.glsl, less what rounding may add. */
static const float THICK = 0.4999f;

/* Whether no segment in the cell is deeper than THICK, if its scalars lie in one interval: extinction is largest at an
 * end, and no segment is longer than the longest edge. */
static bool is_thin(const gl_cells *cells, const struct cell *cell) {
  static const uint8_t ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  const double across[2] = {cells->frame.half_width / cells->picture.half_width,
                            cells->frame.half_height / cells->picture.half_height};
  const float *texel = &cells->intervals->texels[GL_INTERVAL_FLOATS * (size_t)cell->shown.first];
  double longest = 0;
  for (int i = 0; i < 6; i++) {
    const double *a = cell->corner[ends[i][0]], *b = cell->corner[ends[i][1]];
    const double x = (b[0] - a[0]) * across[0], y = (b[1] - a[1]) * across[1], z = b[2] - a[2];
    longest = fmax(longest, x * x + y * y + z * z);
  }
  float most = 0;
  for (int k = 0; k < 4; k++) {
    const float at = fmaxf(0, fminf(1, (cell->shown.scalars[k] - texel[0]) * texel[2]));
    most = fmaxf(most, texel[7] + at * (texel[11] - texel[7]));
  }
  return most * (float)sqrt(longest) <= THICK;
}

/* What a cell adds to its piece's traits; interval: the piece's. */
static unsigned traits_of(const gl_cells *cells, const struct cell *cell, bool has_extra, uint32_t interval) {
  unsigned traits = has_extra || cell->outside & (OUTSIDE_WILD | OUTSIDE_NEAR) ? GL_PIECE_SPECIAL : 0;
  if (cell->shown.first != cell->shown.last || cell->shown.first != interval)
    traits |= GL_PIECE_MANY;
  else if (!is_thin(cells, cell))
    traits |= GL_PIECE_DEEP;
  return traits;
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

/* Adds corners to the piece's last run, or to a new one after them. */
static void extend(gl_piece *piece, gl_run *runs, bool is_fan, uint32_t first, uint32_t count) {
  if (count == 0) return;
  gl_run *last = piece->run_count > 0 ? &runs[piece->run_count - 1] : NULL;
  if (last != NULL && last->is_fan == is_fan)
    last->count += count;
  else
    runs[piece->run_count++] = (gl_run){first, count, is_fan};
  piece->triangle_count += count / 3;
}

static void prepare_piece(const struct job *job, gl_piece *piece) {
  static const float nothing[GL_RECORD_FLOATS] = {0, 0, 1, 0}; /* the last interval lies before the first one */
  const gl_cells *cells = job->cells;
  const gl_cells_output *output = job->output;
  uint32_t corner = 3 * GL_CELLS_TRIANGLES * piece->begin, fan_corner = 3 * GL_FAN_TRIANGLES * piece->begin;
  piece->run_count = piece->triangle_count = piece->cell_count = piece->left_count = 0;
  piece->traits = piece->is_group ? GL_PIECE_ANY : 0;
  piece->interval = 0;
  for (int k = 0; k < 2; k++) {
    piece->low[k] = 1;
    piece->high[k] = -1;
  }
  for (size_t i = piece->begin; i < piece->begin + piece->count; i++) {
    struct cell cell;
    gl_record record; /* everything is copied as a whole: the buffers may be write-combined memory */
    record.has_extra = false;
    const bool is_seen = look_at(cells, job->order[i], &cell);
    const bool is_fan = is_seen && piece->as_fans && !cell.wild && cell.sides >> 4 != 0;
    int count = 0;
    if (is_fan) {
      gl_fan_corner made[3 * GL_FAN_TRIANGLES];
      count = write_fan(cells, &cell, (float)i, &record, made);
      memcpy(output->fan_corners + fan_corner, made, (size_t)count * sizeof *made);
      extend(piece, output->runs + piece->begin, true, fan_corner, (uint32_t)count);
      fan_corner += (uint32_t)count;
    } else if (is_seen) {
      gl_corner made[3 * GL_CELLS_TRIANGLES];
      count = write_footprint(cells, &cell, (float)i, &record, made);
      memcpy(output->corners + corner, made, (size_t)count * sizeof *made);
      extend(piece, output->runs + piece->begin, false, corner, (uint32_t)count);
      widen(piece, made, count);
      corner += (uint32_t)count;
      piece->left_count += piece->as_fans && count > 0;
    }
    if (piece->is_group) {
      if (!record.has_extra) record.extra = (gl_extra){0};
      record.extra.first_record = (float)piece->begin;
      record.extra.member_count = (float)piece->count;
      if (count == 0) memcpy(output->records[i], nothing, sizeof nothing);
    }
    if (record.has_extra || piece->is_group) memcpy(&output->extras[i], &record.extra, sizeof record.extra);
    if (count == 0) continue;
    if (piece->cell_count == 0) piece->interval = cell.shown.first;
    piece->traits |= traits_of(cells, &cell, record.has_extra, piece->interval);
    memcpy(output->records[i], record.floats, sizeof record.floats);
    if (output->lights != NULL) memcpy(output->lights[i], record.lights, sizeof record.lights);
    piece->cell_count++;
  }
  if (!(piece->traits & GL_PIECE_MANY)) return;
  piece->traits &= ~(unsigned)GL_PIECE_DEEP; /* one kind of call for all of them */
  piece->interval = 0;
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
