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

#include "plain.h"
#include "records.h"

/* What counts as behind the eye without a near distance, in units. It only tells where a cell can be seen: a cell all
 * of whose back faces lie nearer is lost. */
static const double LEAST_DEPTH = 1e-9;

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
                                          (gl_corner_is_wild(&cells->picture, corner) ? GL_OUTSIDE_WILD : 0));
    if (cells->mesh->on_cells) continue;
    cells->points[i].scalar = cells->mesh->scalars[i];
    if (cells->intervals->knot_count < GL_POINT_INTERVALS)
      cells->points[i].outside |= gl_interval_of(cells->intervals, cells->mesh->scalars[i]) << GL_OUTSIDE_BITS;
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

bool gl_cells_find_shown(const gl_cells *cells, uint32_t tet, const gl_point *const points[4], gl_shown *shown) {
  const gl_intervals *intervals = cells->intervals;
  const gl_cells_mesh *mesh = cells->mesh;
  if (mesh->on_cells) {
    const float value = mesh->scalars[tet];
    if (isnan(value)) return false;
    for (int k = 0; k < 4; k++) shown->scalars[k] = value;
    shown->first = shown->last = gl_interval_of(intervals, value);
    return gl_intervals_show(intervals, shown->first, shown->last);
  }
  uint32_t first = UINT32_MAX, last = 0;
  float low = INFINITY;
  for (int k = 0; k < 4; k++) {
    const float value = points[k]->scalar;
    const uint32_t interval = points[k]->outside >> GL_OUTSIDE_BITS;
    if (isnan(value)) return false;
    shown->scalars[k] = value;
    low = value < low ? value : low;
    first = interval < first ? interval : first;
    last = interval > last ? interval : last;
  }
  if (intervals->knot_count >= GL_POINT_INTERVALS) { /* they do not fit beside the points */
    float high = low;
    for (int k = 0; k < 4; k++) high = shown->scalars[k] > high ? shown->scalars[k] : high;
    first = gl_interval_of(intervals, low);
    last = gl_interval_of(intervals, high);
  }
  /* Of the interval below a knot, one point alone matters to an isosurface only. */
  if (intervals->model != CELLIST_MODEL_ISOSURFACES)
    while (first < last && intervals->knots[first] <= low) first++;
  shown->first = first;
  shown->last = last;
  return gl_intervals_show(intervals, first, last);
}

/* Which faces of a tet are back faces (bit k: the one opposite to corner k) and which are front faces (bit 4 + k),
 * exactly; 0 if no part of it can be seen. */
static unsigned classify(const gl_cells *cells, uint32_t tet) {
  const cellist_mesh_arrays *arrays = cells->mesh->arrays;
  const uint32_t *v = &arrays->tets[4 * (size_t)tet];
  if (arrays->tet_flags[tet] & CELLIST_TET_FLAT) return 0;
  const gl_point *points = cells->points;
  if (points[v[0]].outside & points[v[1]].outside & points[v[2]].outside & points[v[3]].outside & GL_OUTSIDE_VIEW)
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
  const uint32_t *v = &cells->mesh->arrays->tets[4 * (size_t)tet];
  const gl_point *points[4];
  for (int k = 0; k < 4; k++) points[k] = &cells->points[v[k]];
  if (!gl_cells_find_shown(cells, tet, points, &cell->shown)) return false;
  cell->sides = classify(cells, tet);
  if (cell->sides == 0) return false;
  cell->outside = 0;
  for (int k = 0; k < 4; k++) {
    cell->outside |= cells->points[v[k]].outside;
    cell->corner[k] = cells->points[v[k]].at;
  }
  cell->wild = cell->outside & GL_OUTSIDE_WILD;
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

/* Optical depth that exact.glsl takes in one step, less what rounding may add; and with STEPS: each further step costs
 * what one costs, while cells that need more take what is made for any depth. */
static const float ONE_STEP = 0.9998f, FEW_STEPS = 16;

static float min_of(float a, float b) { return a < b ? a : b; }
static float max_of(float a, float b) { return a > b ? a : b; }

/* Of a cell without an extra that is neither wild nor at the near plane. Extinction is largest at an end or at the
 * knot, and no segment is longer than the longest edge. */
static gl_need need_of(const gl_cells *cells, const gl_shown *shown, float longest) {
  const uint32_t knots = shown->last - shown->first;
  if (knots > 3) return GL_NEED_DEPTH;
  const float *s = shown->scalars;
  const float low = min_of(min_of(s[0], s[1]), min_of(s[2], s[3])),
              high = max_of(max_of(s[0], s[1]), max_of(s[2], s[3]));
  float most = max_of(gl_intervals_extinction(cells->intervals, shown->first, low),
                      gl_intervals_extinction(cells->intervals, shown->last, high));
  for (uint32_t i = shown->first + 1; i <= shown->last; i++)
    most = max_of(most, gl_intervals_extinction(cells->intervals, i, low)); /* the knot's below it */
  const float depth = most * longest;
  if (!(depth <= FEW_STEPS)) return GL_NEED_DEPTH;
  return knots > 1 ? GL_NEED_FEW : depth <= ONE_STEP ? GL_NEED_LITTLE : GL_NEED_STEPS;
}

static gl_need need_of_cell(const gl_cells *cells, const struct cell *cell, bool has_extra) {
  static const uint8_t ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  if (has_extra || cell->outside & (GL_OUTSIDE_WILD | GL_OUTSIDE_NEAR)) return GL_NEED_ANYTHING;
  const double across[2] = {cells->frame.half_width / cells->picture.half_width,
                            cells->frame.half_height / cells->picture.half_height};
  double longest = 0;
  for (int i = 0; i < 6; i++) {
    const double *a = cell->corner[ends[i][0]], *b = cell->corner[ends[i][1]];
    const double x = (b[0] - a[0]) * across[0], y = (b[1] - a[1]) * across[1], z = b[2] - a[2];
    longest = fmax(longest, x * x + y * y + z * z);
  }
  return need_of(cells, &cell->shown, (float)sqrt(longest));
}

struct job {
  const gl_cells *cells;
  const uint32_t *order;
  gl_piece *pieces;
  const gl_cells_output *output;
  gl_plain_kernel *kernel;
};

static void widen(gl_piece *piece, const gl_corner *corners, int count) {
  for (int i = 0; i < count; i++) {
    const float at[2] = {corners[i].x, corners[i].y};
    for (int k = 0; k < 2; k++) {
      piece->low[k] = min_of(piece->low[k], at[k]);
      piece->high[k] = max_of(piece->high[k], at[k]);
    }
  }
}

/* Twice the area of a triangle, in half pictures. */
static float area_of(float ax, float ay, float bx, float by, float cx, float cy) {
  return fabsf((bx - ax) * (cy - ay) - (by - ay) * (cx - ax));
}

/* Adds corners to the piece's last run, or to a new one after them. area: twice their triangles', in half pictures. */
static void extend(const gl_cells *cells, gl_piece *piece, gl_run *runs, gl_run added, float area) {
  if (added.count == 0) return;
  gl_run *last = piece->run_count > 0 ? &runs[piece->run_count - 1] : NULL;
  added.area = 0.5f * area * (float)(cells->picture.half_width * cells->picture.half_height);
  if (last != NULL && last->is_fan == added.is_fan && last->need == added.need) {
    last->count += added.count;
    last->area += added.area;
  } else {
    runs[piece->run_count++] = added;
  }
  piece->triangle_count += added.count / 3;
}

/* What a pixel of a cell that needs the first takes llvmpipe by the program for the second, in nanoseconds beyond the
 * fastest for any cell, and what it takes to change programs. Measured, each within a factor of two, which moves a
 * frame by some hundredths. */
static const float PIXEL_PRICES[GL_NEED_COUNT][GL_NEED_COUNT] = {[GL_NEED_LITTLE] = {0, 2, 7, 13, 18},
                                                                 [GL_NEED_STEPS] = {0, 2, 7, 18, 23},
                                                                 [GL_NEED_FEW] = {0, 0, 8, 35, 40},
                                                                 [GL_NEED_DEPTH] = {0, 0, 0, 35, 40},
                                                                 [GL_NEED_ANYTHING] = {0}};
static const float CHANGE_PRICE = 13000;

/* Gives each run the program that makes all of them cheapest, one for what it needs or more, and joins those that then
 * have the same: Viterbi's way, run by run the least price of having come to each program. */
static void merge_runs(gl_piece *piece, gl_run *runs) {
  uint8_t from[GL_CELLS_GRAIN][GL_NEED_COUNT]; /* the program of the run before */
  float prices[GL_NEED_COUNT] = {0};
  for (uint32_t i = 0; i < piece->run_count; i++) {
    const bool same_kind = i == 0 || runs[i].is_fan == runs[i - 1].is_fan;
    uint8_t cheapest = 0;
    for (uint8_t need = 1; need < GL_NEED_COUNT; need++)
      if (prices[need] < prices[cheapest]) cheapest = need;
    const float changed = prices[cheapest] + CHANGE_PRICE;
    for (uint8_t need = 0; need < GL_NEED_COUNT; need++) {
      const bool keeps = same_kind && prices[need] <= changed;
      from[i][need] = keeps ? need : cheapest;
      prices[need] = need < runs[i].need
                         ? INFINITY
                         : (keeps ? prices[need] : changed) + runs[i].area * PIXEL_PRICES[runs[i].need][need];
    }
  }
  uint8_t best = 0;
  for (uint8_t need = 1; need < GL_NEED_COUNT; need++)
    if (prices[need] < prices[best]) best = need;
  for (uint32_t i = piece->run_count; i-- > 0;) {
    runs[i].need = (gl_need)best;
    best = from[i][best];
  }
  uint32_t kept = 0;
  for (uint32_t i = 0; i < piece->run_count; i++) {
    gl_run *before = kept > 0 ? &runs[kept - 1] : NULL;
    if (before != NULL && before->is_fan == runs[i].is_fan && before->need == runs[i].need) {
      before->count += runs[i].count;
      before->area += runs[i].area;
    } else {
      runs[kept++] = runs[i];
    }
  }
  piece->run_count = kept;
}

/* Where a piece's next triangles go. */
struct cursor {
  uint32_t corner, fan_corner;
};

static void add_corners(const struct job *job, gl_piece *piece, struct cursor *cursor, gl_need need,
                        const gl_corner *corners, int count) {
  memcpy(job->output->corners + cursor->corner, corners, (size_t)count * sizeof *corners);
  float area = 0;
  for (int i = 0; i < count; i += 3)
    area += area_of(corners[i].x, corners[i].y, corners[i + 1].x, corners[i + 1].y, corners[i + 2].x, corners[i + 2].y);
  const gl_run added = {.first = cursor->corner, .count = (uint32_t)count, .need = need};
  extend(job->cells, piece, job->output->runs + piece->begin, added, area);
  widen(piece, corners, count);
  cursor->corner += (uint32_t)count;
}

/* Any cell. */
static void prepare_cell(const struct job *job, gl_piece *piece, size_t i, struct cursor *cursor) {
  static const float nothing[GL_RECORD_FLOATS] = {0, 0, 1, 0}; /* the last interval lies before the first one */
  const gl_cells *cells = job->cells;
  const gl_cells_output *output = job->output;
  struct cell cell;
  gl_record record; /* everything is copied as a whole: the buffers may be write-combined memory */
  record.has_extra = false;
  const bool is_seen = look_at(cells, job->order[i], &cell);
  const bool is_fan = is_seen && piece->as_fans && !cell.wild && cell.sides >> 4 != 0;
  int count = 0;
  if (is_fan) {
    gl_fan_corner made[3 * GL_FAN_TRIANGLES];
    count = write_fan(cells, &cell, (float)i, &record, made);
    memcpy(output->fan_corners + cursor->fan_corner, made, (size_t)count * sizeof *made);
    float area = 0;
    for (int k = 0; k < count; k += 3)
      area += area_of(made[k].x, made[k].y, made[k + 1].x, made[k + 1].y, made[k + 2].x, made[k + 2].y);
    const gl_run added = {.first = cursor->fan_corner,
                          .count = (uint32_t)count,
                          .is_fan = true,
                          .need = need_of_cell(cells, &cell, false)};
    extend(cells, piece, output->runs + piece->begin, added, area);
    cursor->fan_corner += (uint32_t)count;
  } else if (is_seen) {
    gl_corner made[3 * GL_CELLS_TRIANGLES];
    count = write_footprint(cells, &cell, (float)i, &record, made);
    const gl_need need = piece->is_group ? GL_NEED_ANYTHING : need_of_cell(cells, &cell, record.has_extra);
    add_corners(job, piece, cursor, need, made, count);
    piece->left_count += piece->as_fans && count > 0;
  }
  if (piece->is_group) {
    if (!record.has_extra) record.extra = (gl_extra){0};
    record.extra.first_record = (float)piece->begin;
    record.extra.member_count = (float)piece->count;
    if (count == 0) memcpy(output->records[i], nothing, sizeof nothing);
  }
  if (record.has_extra || piece->is_group) {
    output->extras[i] = record.extra;
    piece->has_extras = true;
  }
  if (count == 0) return;
  memcpy(output->records[i], record.floats, sizeof record.floats);
  if (output->lights != NULL) memcpy(output->lights[i], record.lights, sizeof record.lights);
  piece->cell_count++;
}

/* One of four plain cells. */
static void take_plain(const struct job *job, gl_piece *piece, size_t i, gl_plain *plain, int lane,
                       struct cursor *cursor) {
  const gl_cells *cells = job->cells;
  gl_corner corners[3 * GL_CELLS_TRIANGLES];
  int count = 0;
  for (int k = 2; k < plain->corner_count[lane]; k++)
    for (int c = 0; c < 3; c++) {
      const float *at = plain->footprints[lane][c == 0 ? 0 : k - 2 + c];
      corners[count++] = (gl_corner){at[0], at[1], (float)i};
    }
  gl_record_light(cells, job->order[i], plain->records[lane]);
  memcpy(job->output->records[i], plain->records[lane], sizeof plain->records[lane]);
  add_corners(job, piece, cursor, need_of(cells, &plain->shown[lane], plain->longest[lane]), corners, count);
  piece->cell_count++;
}

static void prepare_piece(const struct job *job, gl_piece *piece) {
  struct cursor cursor = {3 * GL_CELLS_TRIANGLES * piece->begin, 3 * GL_FAN_TRIANGLES * piece->begin};
  piece->run_count = piece->triangle_count = piece->cell_count = piece->left_count = 0;
  piece->has_extras = false;
  for (int k = 0; k < 2; k++) {
    piece->low[k] = 1;
    piece->high[k] = -1;
  }
  const bool may_be_plain = !piece->is_group && !piece->as_fans && job->output->lights == NULL;
  size_t i = piece->begin;
  const size_t end = i + piece->count;
  for (; may_be_plain && i + GL_PLAIN_LANES <= end; i += GL_PLAIN_LANES) {
    gl_plain plain;
    job->kernel(job->cells, &job->order[i], &plain);
    for (int lane = 0; lane < GL_PLAIN_LANES; lane++)
      if (plain.left >> lane & 1)
        prepare_cell(job, piece, i + (size_t)lane, &cursor);
      else if (!(plain.nothing >> lane & 1))
        take_plain(job, piece, i + (size_t)lane, &plain, lane, &cursor);
  }
  for (; i < end; i++) prepare_cell(job, piece, i, &cursor);
  merge_runs(piece, job->output->runs + piece->begin);
}

static void prepare_pieces(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  const struct job *job = user;
  for (size_t i = begin; i < end; i++) prepare_piece(job, &job->pieces[i]);
}

void gl_cells_prepare(const gl_cells *cells, const uint32_t *order, gl_piece *pieces, size_t piece_count,
                      const gl_cells_output *output) {
  struct job job = {cells, order, pieces, output, gl_plain_portable};
#ifdef CELLIST_GL_AVX2
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) job.kernel = gl_plain_avx2;
#endif
  cellist_parallel_for(cells->context, piece_count, 1, prepare_pieces, &job);
}
