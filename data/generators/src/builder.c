/* SPDX-License-Identifier: BSD-3-Clause
 * Builder: growing arrays of points and tets, the lattice that most generators are made of, the scalar, and sines
 * that do not depend on the machine. */
#include "builder.h"

#include <math.h>

/* A block with room for one more element, or NULL: the error is kept. */
static void *reserve(mesh_builder *builder, void *block, size_t count, size_t *capacity, size_t size) {
  if (builder->result != CELLIST_SUCCESS) return NULL;
  if (count < *capacity) return block;
  const size_t wanted = *capacity < 1024 ? 1024 : 2 * *capacity;
  void *grown = cellist_reallocate(builder->context, block, count, wanted, size);
  if (grown == NULL)
    builder->result = CELLIST_ERROR_OUT_OF_MEMORY;
  else
    *capacity = wanted;
  return grown;
}

uint32_t builder_point(mesh_builder *builder, double x, double y, double z) {
  double *positions =
      reserve(builder, builder->positions, builder->point_count, &builder->point_capacity, 3 * sizeof *positions);
  if (positions == NULL) return 0;
  builder->positions = positions;
  double *p = &positions[3 * builder->point_count];
  p[0] = x;
  p[1] = y;
  p[2] = z;
  return (uint32_t)builder->point_count++;
}

void builder_tet(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  uint32_t *tets = reserve(builder, builder->tets, builder->tet_count, &builder->tet_capacity, 4 * sizeof *tets);
  if (tets == NULL) return;
  builder->tets = tets;
  uint32_t *v = &tets[4 * builder->tet_count++];
  v[0] = a;
  v[1] = b;
  v[2] = c;
  v[3] = d;
}

uint32_t *builder_ids(mesh_builder *builder, size_t count) {
  if (builder->result != CELLIST_SUCCESS) return NULL;
  uint32_t *ids = cellist_allocate_zeroed(builder->context, count, sizeof *ids);
  if (ids == NULL) builder->result = CELLIST_ERROR_OUT_OF_MEMORY;
  return ids;
}

/* The node at a cell's corner; corner's bit k is the step along axis k. */
static size_t node_index(const mesh_lattice *lattice, const uint32_t cell[3], unsigned corner) {
  size_t at[3];
  for (int k = 0; k < 3; k++) {
    at[k] = cell[k] + (corner >> k & 1);
    if (lattice->closed[k] && at[k] == lattice->size[k]) at[k] = 0;
  }
  return (at[2] * (lattice->size[1] + 1) + at[1]) * (lattice->size[0] + 1) + at[0];
}

typedef void (*cell_visitor)(mesh_builder *builder, const mesh_lattice *lattice, const uint32_t cell[3],
                             uint32_t *nodes);

static void each_cell(mesh_builder *builder, const mesh_lattice *lattice, uint32_t *nodes, cell_visitor visit) {
  uint32_t cell[3];
  for (cell[2] = 0; cell[2] < lattice->size[2]; cell[2]++)
    for (cell[1] = 0; cell[1] < lattice->size[1]; cell[1]++)
      for (cell[0] = 0; cell[0] < lattice->size[0]; cell[0]++)
        if (lattice->has == NULL || lattice->has(lattice->shape, cell)) visit(builder, lattice, cell, nodes);
}

static void mark_nodes(mesh_builder *builder, const mesh_lattice *lattice, const uint32_t cell[3], uint32_t *nodes) {
  (void)builder;
  for (unsigned corner = 0; corner < 8; corner++) nodes[node_index(lattice, cell, corner)] = 1;
}

static void add_tets(mesh_builder *builder, const mesh_lattice *lattice, const uint32_t cell[3], uint32_t *nodes) {
  /* Kuhn's paths from corner 0 to corner 7; the odd ones with two corners exchanged, so that all are positive. */
  static const uint8_t path[6][4] = {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7},
                                     {0, 5, 1, 7}, {0, 3, 2, 7}, {0, 6, 4, 7}};
  for (int i = 0; i < 6; i++) {
    uint32_t v[4];
    for (int c = 0; c < 4; c++) v[c] = nodes[node_index(lattice, cell, path[i][c])];
    builder_tet(builder, v[0], v[1], v[2], v[3]);
  }
}

void builder_lattice(mesh_builder *builder, const mesh_lattice *lattice) {
  const uint32_t *size = lattice->size;
  const size_t node_count = ((size_t)size[0] + 1) * ((size_t)size[1] + 1) * ((size_t)size[2] + 1);
  uint32_t *nodes = builder_ids(builder, node_count);
  if (nodes == NULL) return;
  each_cell(builder, lattice, nodes, mark_nodes);
  for (size_t i = 0; i < node_count; i++) {
    if (nodes[i] == 0) continue;
    const uint32_t node[3] = {(uint32_t)(i % (size[0] + 1)), (uint32_t)(i / (size[0] + 1) % (size[1] + 1)),
                              (uint32_t)(i / (size[0] + 1) / (size[1] + 1))};
    double p[3] = {node[0], node[1], node[2]};
    if (lattice->place != NULL) lattice->place(lattice->shape, node, p);
    nodes[i] = builder_point(builder, p[0], p[1], p[2]);
  }
  each_cell(builder, lattice, nodes, add_tets);
  cellist_deallocate(builder->context, nodes);
}

/* A product of waves over a bowl, in coordinates of the bounding box: smooth, and different along every axis. */
static void fill_wave(const mesh_builder *builder, double *values) {
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < 3 * builder->point_count; i++) {
    const double x = builder->positions[i];
    if (x < low[i % 3]) low[i % 3] = x;
    if (x > high[i % 3]) high[i % 3] = x;
  }
  double half = 0; /* of the longest edge */
  for (int k = 0; k < 3; k++) half = high[k] - low[k] > 2 * half ? 0.5 * (high[k] - low[k]) : half;
  if (!(half > 0)) half = 1;
  for (size_t i = 0; i < builder->point_count; i++) {
    double q[3];
    for (int k = 0; k < 3; k++) q[k] = (builder->positions[3 * i + (size_t)k] - 0.5 * (low[k] + high[k])) / half;
    const double wave = sine_of_turns(0.75 * q[0] + 0.25 * q[1]) * cosine_of_turns(0.5 * q[1] - 0.75 * q[2]);
    values[i] = 0.5 + 0.35 * wave - 0.1 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  }
}

cellist_result builder_finish(mesh_builder *builder, cellist_mesh **mesh) {
  cellist_context *context = builder->context;
  cellist_result result = builder->result;
  double *values = NULL;
  if (result == CELLIST_SUCCESS) {
    values = cellist_allocate(context, builder->point_count, sizeof *values);
    result = values != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  }
  if (result == CELLIST_SUCCESS) {
    fill_wave(builder, values);
    if (builder->blind_point != CELLIST_NONE) values[builder->blind_point] = NAN;
    const cellist_field field = {"wave", CELLIST_ON_POINTS, 1, values};
    const cellist_mesh_desc desc = {.point_count = builder->point_count,
                                    .positions = builder->positions,
                                    .tet_count = builder->tet_count,
                                    .tets = builder->tets,
                                    .field_count = 1,
                                    .fields = &field};
    result = builder->repair ? cellist_mesh_create_repaired(context, &desc, mesh)
                             : cellist_mesh_create(context, &desc, mesh);
  }
  cellist_deallocate(context, values);
  cellist_deallocate(context, builder->positions);
  cellist_deallocate(context, builder->tets);
  return result;
}

static const double TWO_PI = 6.283185307179586;

/* Taylor sums for at most an eighth of a turn: x <= 0.79, so the first term left out is below 1e-17. */
static double small_sine(double turns) {
  const double x = TWO_PI * turns, x2 = x * x;
  double sum = 1;
  for (int n = 16; n >= 2; n -= 2) sum = 1 - x2 / (n * (n + 1)) * sum;
  return x * sum;
}

static double small_cosine(double turns) {
  const double x = TWO_PI * turns, x2 = x * x;
  double sum = 1;
  for (int n = 17; n >= 1; n -= 2) sum = 1 - x2 / (n * (n + 1)) * sum;
  return sum;
}

double sine_of_turns(double turns) {
  const double turn = turns - floor(turns);
  const int quarter = (int)(4 * turn + 0.5);
  const double rest = turn - 0.25 * quarter;
  switch (quarter & 3) {
    case 0: return small_sine(rest);
    case 1: return small_cosine(rest);
    case 2: return -small_sine(rest);
    default: return -small_cosine(rest);
  }
}

double cosine_of_turns(double turns) { return sine_of_turns(turns + 0.25); }

uint32_t square_root_below(double count) {
  uint32_t n = 1;
  while ((n + 1.0) * (n + 1.0) <= count) n++;
  return n;
}

uint32_t cube_root_below(double count) {
  uint32_t n = 1;
  while ((n + 1.0) * (n + 1.0) * (n + 1.0) <= count) n++;
  return n;
}

uint32_t cube_root_near(double count) {
  const double n = cube_root_below(count), more = n + 1;
  return (uint32_t)(more * more * more - count < count - n * n * n ? more : n);
}
