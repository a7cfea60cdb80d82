/* SPDX-License-Identifier: BSD-3-Clause
 * BSP: a tree of planes that cut the boundary's faces into parts, so that for any eye the parts stand in an order in
 * which none covers one before it (Fuchs, Kedem and Naylor 1980).
 *
 * As Comba et al. ("Fast polyhedral cell sorting", 1999) do, each plane is the best of a few random ones by balance
 * and cuts. Planes across the axes compete with those of faces: with faces alone the tree of a convex boundary is a
 * list. On which side of a plane a mesh's own point lies is exact; points where planes cut edges are rounded, and
 * those within rounding of a plane count as in it. */
#include "bsp.h"

#include <base/random.h>
#include <math.h>
#include <stdlib.h>

#include "../memory.h"

/* A point that a plane made on an edge lies this far from its true place, in units of the coordinates' size, at most.
 * Smaller, and faces that meet in that point get parts without area. */
static const double MADE_POINT_ERROR = 1e-12;

enum {
  FACE_CANDIDATES = 6, /* random faces whose planes are tried */
  SAMPLE = 48,         /* parts that a candidate is tried on */
  CUT_COST = 4,        /* what a cut part costs against one more part on the larger side */
  FEW = 8              /* so few parts are not worth a plane that holds none of them */
};

struct vertex {
  double at[3];
  uint32_t id; /* in the boundary's positions; CELLIST_NONE: made by a cut */
};

struct part {
  size_t begin; /* of its vertices */
  uint32_t count, face;
};

struct plane {
  uint32_t face, axis;
  double offset;
};

/* Parts still to be put below a node. */
struct task {
  size_t begin, count; /* in pending */
  size_t depth;
  uint32_t parent, side;
};

struct builder {
  cellist_context *context;
  const sort_boundary *boundary;
  peer_bsp *tree;
  double size; /* of the largest coordinate */
  random_state random;
  struct vertex *vertices;
  size_t vertex_count, vertex_capacity;
  struct part *pending; /* a stack: each task's parts stand together */
  size_t pending_count, pending_capacity;
  struct part *sides[2]; /* of the node being made */
  size_t side_counts[2], side_capacities[2];
  struct task *tasks;
  size_t task_count, task_capacity;
};

static int side_of(const struct builder *builder, const struct plane *plane, const struct vertex *vertex) {
  const double doubt = vertex->id == CELLIST_NONE ? MADE_POINT_ERROR * builder->size : 0;
  if (plane->face == CELLIST_NONE) {
    const double height = vertex->at[plane->axis] - plane->offset;
    return height > doubt ? 1 : height < -doubt ? -1 : 0;
  }
  const sort_boundary *boundary = builder->boundary;
  const sort_face_plane *face = &boundary->planes[plane->face];
  const uint32_t *corners = &boundary->corners[3 * (size_t)plane->face];
  double height = 0, distance = 0, normal = 0;
  for (int k = 0; k < 3; k++) {
    const double d = vertex->at[k] - face->point[k];
    height += face->normal[k] * d;
    distance += fabs(d);
    normal += fabs(face->normal[k]);
  }
  const double rounding = face->doubt * distance + normal * doubt;
  if (height > rounding) return 1;
  if (-height > rounding) return -1;
  if (vertex->id == CELLIST_NONE) return 0;
  for (int c = 0; c < 3; c++)
    if (corners[c] == vertex->id) return 0;
  return cellist_orient3d(&boundary->positions[3 * (size_t)corners[0]], &boundary->positions[3 * (size_t)corners[1]],
                          &boundary->positions[3 * (size_t)corners[2]], vertex->at);
}

/* Bit 0: something of the part lies behind the plane; bit 1: before it. */
static unsigned sides_of(const struct builder *builder, const struct plane *plane, const struct part *part) {
  unsigned sides = 0;
  if (part->face == plane->face) return 0;
  for (uint32_t i = 0; i < part->count && sides != 3; i++) {
    const int side = side_of(builder, plane, &builder->vertices[part->begin + i]);
    sides |= side < 0 ? 1u : side > 0 ? 2u : 0;
  }
  return sides;
}

static cellist_result push_vertex(struct builder *builder, struct vertex vertex) {
  const cellist_result result =
      sort_reserve(builder->context, &builder->vertices, &builder->vertex_capacity, builder->vertex_count,
                   builder->vertex_count + 1, sizeof *builder->vertices);
  if (result == CELLIST_SUCCESS) builder->vertices[builder->vertex_count++] = vertex;
  return result;
}

static cellist_result push_part(struct builder *builder, int side, struct part part) {
  const cellist_result result =
      sort_reserve(builder->context, &builder->sides[side], &builder->side_capacities[side], builder->side_counts[side],
                   builder->side_counts[side] + 1, sizeof *builder->sides[side]);
  if (result == CELLIST_SUCCESS) builder->sides[side][builder->side_counts[side]++] = part;
  return result;
}

/* Where the plane crosses the edge from a to b; always the same point for the same edge. */
static struct vertex cut_edge(const struct builder *builder, const struct plane *plane, const struct vertex *a,
                              const struct vertex *b) {
  for (int k = 0; k < 3; k++) {
    if (a->at[k] == b->at[k]) continue;
    if (a->at[k] > b->at[k]) {
      const struct vertex *swap = a;
      a = b;
      b = swap;
    }
    break;
  }
  double heights[2] = {0, 0};
  const struct vertex *ends[2] = {a, b};
  for (int e = 0; e < 2; e++) {
    if (plane->face == CELLIST_NONE) {
      heights[e] = ends[e]->at[plane->axis] - plane->offset;
      continue;
    }
    const sort_face_plane *face = &builder->boundary->planes[plane->face];
    for (int k = 0; k < 3; k++) heights[e] += face->normal[k] * (ends[e]->at[k] - face->point[k]);
  }
  const double span = heights[0] - heights[1];
  const double t = span != 0 ? fmin(fmax(heights[0] / span, 0), 1) : 0.5;
  struct vertex cut = {.id = CELLIST_NONE};
  for (int k = 0; k < 3; k++) cut.at[k] = a->at[k] + t * (b->at[k] - a->at[k]);
  return cut;
}

/* What lies on one side (-1 or 1) of the plane becomes a part of its own. */
static cellist_result cut_part(struct builder *builder, const struct plane *plane, const struct part *part, int side) {
  struct part piece = {builder->vertex_count, 0, part->face};
  cellist_result result = CELLIST_SUCCESS;
  for (uint32_t i = 0; i < part->count && result == CELLIST_SUCCESS; i++) {
    const struct vertex here = builder->vertices[part->begin + i];
    const struct vertex next = builder->vertices[part->begin + (i + 1) % part->count];
    const int here_side = side_of(builder, plane, &here), next_side = side_of(builder, plane, &next);
    if (here_side != -side) result = push_vertex(builder, here);
    if (result == CELLIST_SUCCESS && here_side * next_side < 0)
      result = push_vertex(builder, cut_edge(builder, plane, &here, &next));
  }
  if (result != CELLIST_SUCCESS) return result;
  piece.count = (uint32_t)(builder->vertex_count - piece.begin);
  return push_part(builder, side > 0, piece);
}

static int compare_doubles(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* A plane across an axis through the middle of a sample. */
static struct plane middle_plane(struct builder *builder, const struct part *parts, size_t count, uint32_t axis) {
  double middles[SAMPLE];
  const size_t sample = count < SAMPLE ? count : SAMPLE;
  for (size_t i = 0; i < sample; i++)
    middles[i] = builder->vertices[parts[sample < count ? random_below(&builder->random, count) : i].begin].at[axis];
  qsort(middles, sample, sizeof *middles, compare_doubles);
  return (struct plane){CELLIST_NONE, axis, middles[sample / 2]};
}

/* The smaller, the better; negative: the plane does not part them. */
static double rate(struct builder *builder, const struct plane *plane, const struct part *parts, size_t count) {
  const size_t sample = count < SAMPLE ? count : SAMPLE;
  size_t behind = 0, before = 0, cut = 0;
  for (size_t i = 0; i < sample; i++) {
    const struct part *part = &parts[sample < count ? random_below(&builder->random, count) : i];
    const unsigned sides = sides_of(builder, plane, part);
    behind += sides == 1;
    before += sides == 2;
    cut += sides == 3;
  }
  const size_t larger = (behind > before ? behind : before) + cut;
  if (plane->face == CELLIST_NONE && 4 * larger > 3 * sample) return -1;
  return (double)(larger + CUT_COST * cut);
}

static struct plane choose(struct builder *builder, const struct part *parts, size_t count) {
  struct plane best = {parts[random_below(&builder->random, count)].face, 0, 0};
  double best_rate = HUGE_VAL;
  if (count == 1) return best;
  for (unsigned i = 0; i < FACE_CANDIDATES + 3; i++) {
    const bool across = i >= FACE_CANDIDATES;
    if (across && count <= FEW) break;
    const struct plane plane = across ? middle_plane(builder, parts, count, i - FACE_CANDIDATES)
                                      : (struct plane){parts[random_below(&builder->random, count)].face, 0, 0};
    const double rated = rate(builder, &plane, parts, count);
    if (rated < 0 || rated >= best_rate) continue;
    best = plane;
    best_rate = rated;
  }
  return best;
}

static cellist_result add_node(struct builder *builder, const struct task *task, const struct plane *plane) {
  peer_bsp *tree = builder->tree;
  const cellist_result result = sort_reserve(builder->context, &tree->nodes, &tree->node_capacity, tree->node_count,
                                             tree->node_count + 1, sizeof *tree->nodes);
  if (result != CELLIST_SUCCESS) return result;
  if (task->parent != CELLIST_NONE) tree->nodes[task->parent].children[task->side] = (uint32_t)tree->node_count;
  tree->nodes[tree->node_count++] = (peer_bsp_node){.children = {CELLIST_NONE, CELLIST_NONE},
                                                    .face = plane->face,
                                                    .axis = plane->axis,
                                                    .offset = plane->offset,
                                                    .begin = (uint32_t)tree->part_count};
  if (task->depth > tree->depth) tree->depth = task->depth;
  return CELLIST_SUCCESS;
}

/* Sends a part where it belongs: into the node just made, to one side of its plane, or to both. */
static cellist_result place(struct builder *builder, const struct plane *plane, const struct part *part) {
  peer_bsp *tree = builder->tree;
  const unsigned sides = sides_of(builder, plane, part);
  if (sides == 1 || sides == 2) return push_part(builder, sides == 2, *part);
  if (sides == 3) {
    const cellist_result result = cut_part(builder, plane, part, -1);
    return result == CELLIST_SUCCESS ? cut_part(builder, plane, part, 1) : result;
  }
  const cellist_result result = sort_reserve(builder->context, &tree->parts, &tree->part_capacity, tree->part_count,
                                             tree->part_count + 1, sizeof *tree->parts);
  if (result != CELLIST_SUCCESS) return result;
  tree->parts[tree->part_count++] = part->face;
  tree->nodes[tree->node_count - 1].count++;
  tree->part_counts[part->face]++;
  return CELLIST_SUCCESS;
}

static cellist_result push_task(struct builder *builder, int side, size_t depth, uint32_t parent) {
  const size_t count = builder->side_counts[side];
  if (count == 0) return CELLIST_SUCCESS;
  cellist_result result = sort_reserve(builder->context, &builder->tasks, &builder->task_capacity, builder->task_count,
                                       builder->task_count + 1, sizeof *builder->tasks);
  if (result == CELLIST_SUCCESS)
    result = sort_reserve(builder->context, &builder->pending, &builder->pending_capacity, builder->pending_count,
                          builder->pending_count + count, sizeof *builder->pending);
  if (result != CELLIST_SUCCESS) return result;
  for (size_t i = 0; i < count; i++) builder->pending[builder->pending_count + i] = builder->sides[side][i];
  builder->tasks[builder->task_count++] = (struct task){builder->pending_count, count, depth, parent, (uint32_t)side};
  builder->pending_count += count;
  return CELLIST_SUCCESS;
}

/* The task on top of the stack becomes a node and at most two tasks. */
static cellist_result split(struct builder *builder) {
  const struct task task = builder->tasks[--builder->task_count];
  const struct plane plane = choose(builder, &builder->pending[task.begin], task.count);
  builder->side_counts[0] = builder->side_counts[1] = 0;
  cellist_result result = add_node(builder, &task, &plane);
  for (size_t i = 0; i < task.count && result == CELLIST_SUCCESS; i++)
    result = place(builder, &plane, &builder->pending[task.begin + i]);
  builder->pending_count = task.begin;
  const uint32_t node = (uint32_t)(builder->tree->node_count - 1);
  for (int side = 0; side < 2 && result == CELLIST_SUCCESS; side++)
    result = push_task(builder, side, task.depth + 1, node);
  return result;
}

/* Each face is one part of the first task. */
static cellist_result begin(struct builder *builder) {
  const sort_boundary *boundary = builder->boundary;
  cellist_result result = CELLIST_SUCCESS;
  for (uint32_t face = 0; face < boundary->face_count && result == CELLIST_SUCCESS; face++) {
    result = push_part(builder, 0, (struct part){builder->vertex_count, 3, face});
    for (size_t c = 0; c < 3 && result == CELLIST_SUCCESS; c++) {
      struct vertex vertex = {.id = boundary->corners[3 * (size_t)face + c]};
      for (size_t k = 0; k < 3; k++) {
        vertex.at[k] = boundary->positions[3 * (size_t)vertex.id + k];
        builder->size = fmax(builder->size, fabs(vertex.at[k]));
      }
      result = push_vertex(builder, vertex);
    }
  }
  return result == CELLIST_SUCCESS ? push_task(builder, 0, 1, CELLIST_NONE) : result;
}

cellist_result peer_bsp_create(cellist_context *context, const sort_boundary *boundary, peer_bsp *tree) {
  tree->part_counts = cellist_allocate_zeroed(context, boundary->face_count, sizeof *tree->part_counts);
  if (tree->part_counts == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  struct builder builder = {.context = context, .boundary = boundary, .tree = tree, .random = {1}};
  cellist_result result = begin(&builder);
  while (builder.task_count > 0 && result == CELLIST_SUCCESS) result = split(&builder);
  cellist_deallocate(context, builder.vertices);
  cellist_deallocate(context, builder.pending);
  cellist_deallocate(context, builder.sides[0]);
  cellist_deallocate(context, builder.sides[1]);
  cellist_deallocate(context, builder.tasks);
  return result;
}

void peer_bsp_release(cellist_context *context, peer_bsp *tree) {
  cellist_deallocate(context, tree->nodes);
  cellist_deallocate(context, tree->parts);
  cellist_deallocate(context, tree->part_counts);
  *tree = (peer_bsp){0};
}
