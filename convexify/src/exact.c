/* SPDX-License-Identifier: BSD-3-Clause
 * Exact geometry: planes through three points, vertices where a line meets a plane, and the signs that cutting asks
 * for, all exact on the coordinates as given.
 *
 * Coordinates become integers (differences to one origin, times a power of two), planes and vertices keep their exact
 * coefficients: a plane has degrees 2 and 3 in the coordinates, a meet 7 over 6, so a side test is a product sum of
 * degree 9 over stored numbers, not a determinant; comparing two meets has degree 13. A rounded copy answers first,
 * with a forward error bound. Stored coefficients instead of expansions or CGAL's lazy kernel: no tree to keep alive,
 * one exact test costs about four multiplications of a few limbs, and a meet of meets stays of degree 7 because every
 * edge keeps the two points or two planes of its line. */
#include "work.h"

/* Two rounded coordinates, 5 U each. */
static const double COMPARE_BOUND = 12 * 0x1p-53;
/* A difference of two products of rounded coefficients: 5 U each and one more; of sheared coordinates: 16 U a factor.
 */
static const double CROSS_BOUND = 8 * 0x1p-53;
static const double TURN_BOUND = 64 * 0x1p-53;
/* Below this a double's rounding is no longer relative; the work's own unit keeps sound data far above. */
static const double TINY = 1e-270;

void work_reserve(work *w, void *list, size_t count, size_t size) {
  LIST(void) *l = list;
  if (count <= l->capacity) return;
  size_t capacity = l->capacity + l->capacity / 2;
  if (capacity < 16) capacity = 16;
  if (capacity < count) capacity = count;
  void *items = cellist_reallocate(w->context, l->items, l->count, capacity, size);
  if (items == NULL) work_fail(w, CELLIST_ERROR_OUT_OF_MEMORY);
  l->items = items;
  l->capacity = capacity;
}

int work_compare3(const void *a, const void *b) {
  const uint32_t *x = a, *y = b;
  for (int k = 0; k < 3; k++)
    if (x[k] != y[k]) return x[k] < y[k] ? -1 : 1;
  return 0;
}

void *work_block(work *w, size_t count, size_t size) {
  w->block_scratch = cellist_allocate(w->context, count, size);
  if (w->block_scratch == NULL) work_fail(w, CELLIST_ERROR_OUT_OF_MEMORY);
  return w->block_scratch;
}

void work_block_end(work *w) {
  cellist_deallocate(w->context, w->block_scratch);
  w->block_scratch = NULL;
}

void work_fail(work *w, cellist_result result) {
  w->result = result;
  longjmp(w->failed, 1);
}

static exact_number keep(work *w, const wide *value) {
  if (w->limbs.count + value->length > UINT32_MAX)
    work_stop(w, CELLIST_ERROR_UNSUPPORTED, "convexify: more exact coefficients than 32 bits can address");
  work_reserve(w, &w->limbs, w->limbs.count + value->length, sizeof *w->limbs.items);
  const exact_number number = {value->sign * (int32_t)value->length, (uint32_t)w->limbs.count};
  if (value->length > 0) memcpy(&w->limbs.items[w->limbs.count], value->limb, value->length * sizeof value->limb[0]);
  w->limbs.count += value->length;
  return number;
}

static void load(const work *w, wide *out, exact_number number) {
  out->sign = (number.length > 0) - (number.length < 0);
  out->length = (size_t)(number.length < 0 ? -number.length : number.length);
  if (out->length > 0) memcpy(out->limb, &w->limbs.items[number.offset], out->length * sizeof out->limb[0]);
}

static void set_zero(wide *value) {
  value->sign = 0;
  value->length = 0;
}

static void set_small(wide *value, uint64_t to) {
  value->sign = value->length = to > 0;
  value->limb[0] = to;
}

/* The sign of a rounded value that is off by less than error, or 0: to be found exactly. */
static int filtered_sign(double value, double error) {
  if (!(error > TINY && fabs(value) > error)) return 0;
  return value > 0 ? 1 : -1;
}

/* *sum += the determinant of v[3 i + k]. sum, v: none of scratch. */
static void add_determinant3(wide *sum, const wide *v, wide scratch[2]) {
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    wide_determinant2(&scratch[0], &v[3 + i], &v[3 + j], &v[6 + i], &v[6 + j], &scratch[1]);
    wide_multiply(&scratch[1], &scratch[0], &v[k]);
    wide_add(sum, sum, &scratch[1]);
  }
}

/* The sign of a / p less b / q, p and q positive. */
static int compare_quotients(const wide *a, const wide *p, const wide *b, const wide *q, wide scratch[2]) {
  wide_multiply(&scratch[0], a, q);
  wide_multiply(&scratch[1], b, p);
  wide_subtract(&scratch[0], &scratch[0], &scratch[1]);
  return scratch[0].sign;
}

/* |value| * 2^exponent = mantissa * 2^*power with mantissa in [1, 2^64): off by 2 U at most. */
static double split_double(const wide *value, int *power) {
  *power = 0;
  if (value->sign == 0) return 0;
  const size_t n = value->length;
  double mantissa = (double)value->limb[n - 1];
  if (n > 1) mantissa += (double)value->limb[n - 2] * 0x1p-64;
  *power = 64 * (int)(n - 1);
  return value->sign * mantissa;
}

static double to_double(const wide *value, int exponent) {
  int power;
  const double mantissa = split_double(value, &power);
  return ldexp(mantissa, power + exponent);
}

static double quotient(const wide *numerator, const wide *denominator, int exponent) {
  int over, under;
  const double n = split_double(numerator, &over), d = split_double(denominator, &under);
  return ldexp(n / d, over - under + exponent);
}

void exact_begin(work *w, const double bounds[6], int lowest_exponent) {
  double extent = 0;
  for (int k = 0; k < 3; k++) {
    w->origin[k] = bounds[k];
    extent = fmax(extent, bounds[3 + k] / 2 - bounds[k] / 2);
  }
  w->base = lowest_exponent;
  w->shift = 0;
  if (extent > 0) frexp(extent, &w->shift);
}

static void coordinate(const work *w, wide *out, wide *scratch, double value, int axis) {
  wide_from_double(out, value, w->base);
  wide_from_double(scratch, w->origin[axis], w->base);
  wide_subtract(out, out, scratch);
}

uint32_t exact_add_point(work *w, const double position[3], uint32_t point) {
  work_vertex vertex = {.point = point};
  wide *value = &w->scratch[0];
  for (int k = 0; k < 3; k++) {
    coordinate(w, value, &w->scratch[1], position[k], k);
    vertex.p[k] = to_double(value, w->base - w->shift);
    vertex.exact[k] = keep(w, value);
  }
  set_small(value, 1);
  vertex.exact[3] = keep(w, value);
  list_push(w, &w->vertices, vertex);
  return (uint32_t)w->vertices.count - 1;
}

/* The power of two in which a plane's normal counts: an axis plane's is 1, a spanned one's are areas. The offset has
 * one length more. */
static int normal_power(const work *w, const work_plane *plane) {
  return plane->ids[0] == CELLIST_NONE ? 0 : 2 * (w->base - w->shift);
}

static uint32_t keep_plane(work *w, const wide *normal, const wide *offset, const uint32_t ids[3]) {
  work_plane plane = {.ids = {ids[0], ids[1], ids[2]}};
  const int power = normal_power(w, &plane);
  for (int k = 0; k < 3; k++) {
    plane.normal[k] = to_double(&normal[k], power);
    plane.exact[k] = keep(w, &normal[k]);
  }
  plane.offset = to_double(offset, power + w->base - w->shift);
  plane.exact[3] = keep(w, offset);
  list_push(w, &w->planes, plane);
  return (uint32_t)w->planes.count - 1;
}

uint32_t exact_add_plane(work *w, uint32_t a, uint32_t b, uint32_t c) {
  wide *u = &w->scratch[0], *v = &w->scratch[3], *normal = &w->scratch[6], *origin = &w->scratch[9];
  wide *offset = &w->scratch[10], *product = &w->scratch[11];
  for (int k = 0; k < 3; k++) {
    load(w, origin, w->vertices.items[a].exact[k]);
    load(w, &u[k], w->vertices.items[b].exact[k]);
    wide_subtract(&u[k], &u[k], origin);
    load(w, &v[k], w->vertices.items[c].exact[k]);
    wide_subtract(&v[k], &v[k], origin);
  }
  set_zero(offset);
  bool spans = false;
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    wide_determinant2(&normal[k], &u[i], &u[j], &v[i], &v[j], product);
    spans |= normal[k].sign != 0;
    load(w, origin, w->vertices.items[a].exact[k]);
    wide_multiply(product, &normal[k], origin);
    wide_subtract(offset, offset, product);
  }
  if (!spans) return CELLIST_NONE;
  return keep_plane(w, normal, offset, (const uint32_t[3]){a, b, c});
}

uint32_t exact_add_axis_plane(work *w, uint32_t axis, double offset) {
  wide *normal = &w->scratch[0], *d = &w->scratch[3];
  for (uint32_t k = 0; k < 3; k++) set_small(&normal[k], k == axis);
  coordinate(w, d, &w->scratch[4], offset, (int)axis);
  d->sign = -d->sign;
  list_push(w, &w->offsets, offset);
  return keep_plane(w, normal, d, (const uint32_t[3]){CELLIST_NONE, axis, (uint32_t)w->offsets.count - 1});
}

/* out = plane(vertex) times the vertex's w. */
static void evaluate(work *w, wide *out, wide *scratch, const work_vertex *vertex, const work_plane *plane) {
  wide *a = &scratch[0], *b = &scratch[1], *product = &scratch[2];
  set_zero(out);
  for (int k = 0; k < 4; k++) {
    if (vertex->exact[k].length == 0 || plane->exact[k].length == 0) continue;
    load(w, a, vertex->exact[k]);
    load(w, b, plane->exact[k]);
    wide_multiply(product, a, b);
    wide_add(out, out, product);
  }
}

static uint32_t keep_meet(work *w, wide *x, wide *weight) {
  work_vertex vertex = {.point = CELLIST_NONE};
  const int flip = weight->sign;
  for (int k = 0; k < 3; k++) {
    x[k].sign *= flip;
    vertex.exact[k] = keep(w, &x[k]);
  }
  weight->sign *= flip;
  for (int k = 0; k < 3; k++) vertex.p[k] = quotient(&x[k], weight, w->base - w->shift);
  vertex.exact[3] = keep(w, weight);
  list_push(w, &w->vertices, vertex);
  return (uint32_t)w->vertices.count - 1;
}

static uint32_t meet_of_points(work *w, uint32_t a, uint32_t b, uint32_t plane) {
  wide *at_a = &w->scratch[0], *at_b = &w->scratch[1], *x = &w->scratch[2], *weight = &w->scratch[5];
  wide *c = &w->scratch[6], *product = &w->scratch[7], *scratch = &w->scratch[8];
  evaluate(w, at_a, scratch, &w->vertices.items[a], &w->planes.items[plane]);
  evaluate(w, at_b, scratch, &w->vertices.items[b], &w->planes.items[plane]);
  wide_subtract(weight, at_b, at_a);
  for (int k = 0; k < 3; k++) {
    load(w, c, w->vertices.items[a].exact[k]);
    wide_multiply(&x[k], c, at_b);
    load(w, c, w->vertices.items[b].exact[k]);
    wide_multiply(product, c, at_a);
    wide_subtract(&x[k], &x[k], product);
  }
  return keep_meet(w, x, weight);
}

static uint32_t meet_of_planes(work *w, const uint32_t planes[3]) {
  wide *n = &w->scratch[0]; /* n[3 i + k] */
  wide *d = &w->scratch[9], *x = &w->scratch[12], *weight = &w->scratch[15], *cross = &w->scratch[16];
  wide *product = &w->scratch[17];
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) load(w, &n[3 * i + k], w->planes.items[planes[i]].exact[k]);
    load(w, &d[i], w->planes.items[planes[i]].exact[3]);
  }
  for (int k = 0; k < 3; k++) set_zero(&x[k]);
  set_zero(weight);
  for (int i = 0; i < 3; i++) {
    const wide *p = &n[3 * ((i + 1) % 3)], *q = &n[3 * ((i + 2) % 3)];
    for (int k = 0; k < 3; k++) {
      wide_determinant2(cross, &p[(k + 1) % 3], &p[(k + 2) % 3], &q[(k + 1) % 3], &q[(k + 2) % 3], product);
      wide_multiply(product, &d[i], cross);
      wide_subtract(&x[k], &x[k], product);
      if (i > 0) continue;
      wide_multiply(product, &n[k], cross);
      wide_add(weight, weight, product);
    }
  }
  return keep_meet(w, x, weight);
}

uint32_t exact_add_meet(work *w, const work_edge *line, uint32_t plane) {
  if (line->line_is_points) return meet_of_points(w, line->line[0], line->line[1], plane);
  return meet_of_planes(w, (const uint32_t[3]){line->line[0], line->line[1], plane});
}

int exact_side(work *w, uint32_t vertex, uint32_t plane) {
  const work_vertex *v = &w->vertices.items[vertex];
  const work_plane *p = &w->planes.items[plane];
  const double x = p->normal[0] * v->p[0], y = p->normal[1] * v->p[1], z = p->normal[2] * v->p[2];
  const double value = x + y + z + p->offset;
  const int sure = filtered_sign(value, SIDE_BOUND * (fabs(x) + fabs(y) + fabs(z) + fabs(p->offset)));
  if (sure != 0) return sure;
  if (p->ids[0] != CELLIST_NONE && (vertex == p->ids[0] || vertex == p->ids[1] || vertex == p->ids[2])) return 0;
  evaluate(w, &w->scratch[0], &w->scratch[1], v, p);
  return w->scratch[0].sign;
}

int exact_compare_axis(work *w, uint32_t a, uint32_t b, int axis) {
  if (a == b) return 0;
  const work_vertex *p = &w->vertices.items[a], *q = &w->vertices.items[b];
  const int sure = filtered_sign(p->p[axis] - q->p[axis], COMPARE_BOUND * (fabs(p->p[axis]) + fabs(q->p[axis])));
  if (sure != 0) return sure;
  wide *n = &w->scratch[0];
  load(w, &n[0], p->exact[axis]);
  load(w, &n[1], p->exact[3]);
  load(w, &n[2], q->exact[axis]);
  load(w, &n[3], q->exact[3]);
  return compare_quotients(&n[0], &n[1], &n[2], &n[3], &n[4]);
}

int exact_compare(work *w, uint32_t a, uint32_t b) {
  for (int axis = 0; axis < 3; axis++) {
    const int sign = exact_compare_axis(w, a, b, axis);
    if (sign != 0) return sign;
  }
  return 0;
}

static const wide *cross_exactly(work *w, const work_plane *a, const work_plane *b, int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  wide *n = &w->scratch[0];
  load(w, &n[0], a->exact[i]);
  load(w, &n[1], a->exact[j]);
  load(w, &n[2], b->exact[i]);
  load(w, &n[3], b->exact[j]);
  wide_determinant2(&n[4], &n[0], &n[1], &n[2], &n[3], &n[5]);
  return &n[4];
}

int exact_cross(work *w, uint32_t plane_a, uint32_t plane_b, int k) {
  const work_plane *a = &w->planes.items[plane_a], *b = &w->planes.items[plane_b];
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const double left = a->normal[i] * b->normal[j], right = a->normal[j] * b->normal[i];
  const int sure = filtered_sign(left - right, CROSS_BOUND * (fabs(left) + fabs(right)));
  return sure != 0 ? sure : cross_exactly(w, a, b, k)->sign;
}

double exact_cross_value(work *w, uint32_t plane_a, uint32_t plane_b, int k) {
  const work_plane *a = &w->planes.items[plane_a], *b = &w->planes.items[plane_b];
  return to_double(cross_exactly(w, a, b, k), normal_power(w, a) + normal_power(w, b));
}

double exact_height(work *w, uint32_t vertex, uint32_t plane) {
  const work_plane *p = &w->planes.items[plane];
  evaluate(w, &w->scratch[0], &w->scratch[1], &w->vertices.items[vertex], p);
  load(w, &w->scratch[1], w->vertices.items[vertex].exact[3]);
  return quotient(&w->scratch[0], &w->scratch[1], normal_power(w, p) + w->base - w->shift);
}

bool exact_same_plane(work *w, uint32_t plane_a, uint32_t plane_b) {
  if (plane_a == plane_b) return true;
  const uint32_t *a = w->planes.items[plane_a].ids, *b = w->planes.items[plane_b].ids;
  if (a[0] == CELLIST_NONE && b[0] == CELLIST_NONE)
    return a[1] == b[1] && w->offsets.items[a[2]] == w->offsets.items[b[2]];
  const uint32_t *spanned = a[0] == CELLIST_NONE ? b : a, other = a[0] == CELLIST_NONE ? plane_a : plane_b;
  for (int k = 0; k < 3; k++)
    if (exact_side(w, spanned[k], other) != 0) return false;
  return true;
}

int exact_same_direction(const work *w, uint32_t plane_a, uint32_t plane_b) {
  const work_plane *a = &w->planes.items[plane_a], *b = &w->planes.items[plane_b];
  int k = 0;
  for (int i = 1; i < 3; i++)
    if (fabs(a->normal[i]) > fabs(a->normal[k])) k = i;
  return (a->exact[k].length > 0) == (b->exact[k].length > 0) ? 1 : -1;
}

/* Six times the volume between the origin and the triangles. */
static wide *sum_volume(work *w, const uint32_t *triangles, size_t count) {
  wide *p = &w->scratch[0], *sum = &w->scratch[9];
  set_zero(sum);
  for (size_t t = 0; t < count; t++) {
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < 3; k++) load(w, &p[3 * c + k], w->vertices.items[triangles[3 * t + (size_t)c]].exact[k]);
    add_determinant3(sum, p, &w->scratch[10]);
  }
  return sum;
}

int exact_volume_sign(work *w, const uint32_t *triangles, size_t count) {
  return sum_volume(w, triangles, count)->sign;
}

double exact_volume(work *w, const uint32_t *triangles, size_t count) {
  return to_double(sum_volume(w, triangles, count), 3 * (w->base - w->shift)) / 6;
}

/* out[0], out[1]: 1024 y - shear[0] x and 1024 z - shear[1] x, over out[2]. */
static void shear_exactly(work *w, const int shear[2], uint32_t vertex, wide *out) {
  wide *x = &w->scratch[12], *factor = &w->scratch[13], *product = &w->scratch[14], *y = &w->scratch[15];
  const work_vertex *v = &w->vertices.items[vertex];
  load(w, x, v->exact[0]);
  for (int k = 0; k < 2; k++) {
    load(w, y, v->exact[1 + k]);
    set_small(factor, 1024);
    wide_multiply(&out[k], y, factor);
    set_small(factor, (uint64_t)shear[k]);
    wide_multiply(product, x, factor);
    wide_subtract(&out[k], &out[k], product);
  }
  load(w, &out[2], v->exact[3]);
}

static void shear_rounded(const work *w, const int shear[2], uint32_t vertex, double out[2], double *magnitude) {
  const double *p = w->vertices.items[vertex].p;
  for (int k = 0; k < 2; k++) {
    out[k] = 1024 * p[1 + k] - shear[k] * p[0];
    *magnitude = fmax(*magnitude, fabs(1024 * p[1 + k]) + fabs(shear[k] * p[0]));
  }
}

int exact_sheared_compare(work *w, const int shear[2], uint32_t a, uint32_t q) {
  double p[2], r[2], magnitude = 0;
  shear_rounded(w, shear, a, p, &magnitude);
  shear_rounded(w, shear, q, r, &magnitude);
  const int sure = filtered_sign(p[1] - r[1], TURN_BOUND * magnitude);
  if (sure != 0) return sure;
  wide *x = &w->scratch[0], *y = &w->scratch[3];
  shear_exactly(w, shear, a, x);
  shear_exactly(w, shear, q, y);
  return compare_quotients(&x[1], &x[2], &y[1], &y[2], &w->scratch[6]);
}

int exact_sheared_turn(work *w, const int shear[2], uint32_t a, uint32_t b, uint32_t q) {
  double p[2], r[2], s[2], magnitude = 0;
  shear_rounded(w, shear, a, p, &magnitude);
  shear_rounded(w, shear, b, r, &magnitude);
  shear_rounded(w, shear, q, s, &magnitude);
  const double turn = (r[0] - p[0]) * (s[1] - p[1]) - (r[1] - p[1]) * (s[0] - p[0]);
  const int sure = filtered_sign(turn, TURN_BOUND * 8 * magnitude * magnitude);
  if (sure != 0) return sure;
  wide *v = &w->scratch[0], *sum = &w->scratch[9];
  shear_exactly(w, shear, a, &v[0]);
  shear_exactly(w, shear, b, &v[3]);
  shear_exactly(w, shear, q, &v[6]);
  set_zero(sum);
  add_determinant3(sum, v, &w->scratch[10]);
  return sum->sign;
}

int exact_turn(work *w, int axis, uint32_t a, uint32_t b, uint32_t q) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const uint32_t id[3] = {a, b, q};
  const double *p = w->vertices.items[a].p, *r = w->vertices.items[b].p, *s = w->vertices.items[q].p;
  const double magnitude = fmax(fmax(fabs(p[x]) + fabs(p[y]), fabs(r[x]) + fabs(r[y])), fabs(s[x]) + fabs(s[y]));
  const double left = (r[x] - p[x]) * (s[y] - p[y]), right = (r[y] - p[y]) * (s[x] - p[x]);
  /* Each difference is off by 12 U of the magnitude: times the other factor, and twice. */
  const double error =
      TURN_BOUND * magnitude *
      (fabs(r[x] - p[x]) + fabs(s[y] - p[y]) + fabs(r[y] - p[y]) + fabs(s[x] - p[x]) + 64 * 0x1p-53 * magnitude);
  const int sure = filtered_sign(left - right, error);
  if (sure != 0) return sure;
  wide *v = &w->scratch[0], *sum = &w->scratch[9];
  for (int i = 0; i < 3; i++) {
    load(w, &v[3 * i], w->vertices.items[id[i]].exact[x]);
    load(w, &v[3 * i + 1], w->vertices.items[id[i]].exact[y]);
    load(w, &v[3 * i + 2], w->vertices.items[id[i]].exact[3]);
  }
  set_zero(sum);
  add_determinant3(sum, v, &w->scratch[10]);
  return sum->sign;
}

int exact_plane_along(work *w, const int shear[2], uint32_t plane) {
  wide *n = &w->scratch[0], *factor = &w->scratch[1], *product = &w->scratch[2], *sum = &w->scratch[3];
  const uint64_t direction[3] = {1024, (uint64_t)shear[0], (uint64_t)shear[1]};
  set_zero(sum);
  for (int k = 0; k < 3; k++) {
    load(w, n, w->planes.items[plane].exact[k]);
    set_small(factor, direction[k]);
    wide_multiply(product, n, factor);
    wide_add(sum, sum, product);
  }
  return sum->sign;
}

const double *exact_point(const work *w, uint32_t vertex) {
  const size_t point = w->vertices.items[vertex].point, given = w->mesh->point_count;
  return point < given ? &w->mesh->positions[3 * point] : &w->added_points.items[3 * (point - given)];
}

void exact_position(const work *w, uint32_t vertex, double position[3]) {
  const work_vertex *v = &w->vertices.items[vertex];
  const double *given = v->point != CELLIST_NONE ? exact_point(w, vertex) : NULL;
  for (int k = 0; k < 3; k++) position[k] = given != NULL ? given[k] : w->origin[k] + ldexp(v->p[k], w->shift);
}
