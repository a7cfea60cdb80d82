/* SPDX-License-Identifier: BSD-3-Clause
 * BSP-XMPVO: exact order of non-convex meshes after Comba, Klosowski, Max, Mitchell, Silva and Williams ("Fast
 * polyhedral cell sorting for interactive rendering of unstructured grids", 1999).
 *
 * MPVO orders cells across the faces that they share. What lies in front of what across gaps comes from a BSP tree of
 * the boundary: its parts are visited from far to near. When a face that the eye sees from outside is passed and
 * its cell is not out yet (a cell behind it still waits for nearer parts of the tree), the cell joins a list, which the
 * paper calls partially projected. When all parts of a face that the eye sees from inside are passed, all that lies
 * behind it is out or in that list: its cell waits for those of the list whose face it covers. Cells come out when they
 * wait for nothing. So the cost is that of MPVO, and boundary faces times the list.
 *
 * Written from the paper's idea; done here: signs and the tests of pairs are the sorter's own, exact and fast, and
 * pairs whose bounding spheres are apart for the eye are never tested. Cycles, which the paper excludes, are cut where
 * the traversal ends. */
#include <math.h>
#include <string.h>

#include "../gaps/overlap.h"
#include "../memory.h"
#include "../signs/signs.h"
#include "../state.h"
#include "bsp.h"
#include "peer.h"

/* A cell's state is as the sorter's, but that the bit for other arcs says that the cell has boundary faces. */
enum { ON_BOUNDARY = SORT_HAS_ARCS };

/* Where the eye sees a face, roughly: the direction to it and half an angle around it; in parallel views a point of the
 * image and a radius. */
struct sight {
  float at[3], reach;
};

/* row waits for a cell; the next one that waits for the same cell. */
struct wait {
  uint32_t row, next;
};

struct peer_bsp_xmpvo {
  sort_cells cells;
  sort_planes planes;
  sort_boundary boundary;
  peer_bsp tree;
  uint8_t *state;
  float *spheres;       /* [4 face_count] centre and radius */
  int8_t *sides;        /* [face_count] 1: the eye is outside of the face */
  uint32_t *parts_left; /* [face_count] parts that the traversal has not passed */
  struct sight *sights; /* [face_count] */
  uint32_t *pending;    /* [row_count] faces and cells that the row's cell waits for */
  uint32_t *waiting;    /* [row_count] first of those that wait for the row's cell, in waits */
  uint8_t *is_out;      /* [row_count] */
  uint32_t *list;       /* [face_count] faces passed whose cells are not out */
  size_t list_count;
  struct wait *waits;
  size_t wait_count, wait_capacity;
  uint32_t *stack; /* [2 depth + 2] */
  uint32_t *order;
  size_t out, count; /* order[out] to order[count - 1] are ready */
};

static void make_spheres(struct peer_bsp_xmpvo *own) {
  for (size_t face = 0; face < own->boundary.face_count; face++) {
    const double *p[3];
    double centre[3], radius = 0;
    for (size_t c = 0; c < 3; c++) p[c] = &own->boundary.positions[3 * (size_t)own->boundary.corners[3 * face + c]];
    for (size_t k = 0; k < 3; k++) centre[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
    for (size_t c = 0; c < 3; c++)
      radius = fmax(radius, hypot(hypot(p[c][0] - centre[0], p[c][1] - centre[1]), p[c][2] - centre[2]));
    for (size_t k = 0; k < 3; k++) own->spheres[4 * face + k] = (float)centre[k];
    /* Room for the rounding of the centre and of sights. */
    const double size = fabs(centre[0]) + fabs(centre[1]) + fabs(centre[2]);
    own->spheres[4 * face + 3] = (float)(radius * 1.0001 + 1e-5 * size);
  }
}

static cellist_result allocate_all(cellist_context *context, struct peer_bsp_xmpvo *own) {
  const size_t faces = own->boundary.face_count, rows = own->boundary.row_count;
  own->state = cellist_allocate_zeroed(context, 4 * own->planes.group_count + 8, sizeof *own->state);
  own->spheres = cellist_allocate(context, faces, 4 * sizeof *own->spheres);
  own->sides = cellist_allocate(context, faces, sizeof *own->sides);
  own->parts_left = cellist_allocate(context, faces, sizeof *own->parts_left);
  own->sights = cellist_allocate(context, faces, sizeof *own->sights);
  own->pending = cellist_allocate(context, rows, sizeof *own->pending);
  own->waiting = cellist_allocate(context, rows, sizeof *own->waiting);
  own->is_out = cellist_allocate(context, rows, sizeof *own->is_out);
  own->list = cellist_allocate(context, faces, sizeof *own->list);
  own->stack = cellist_allocate(context, own->tree.depth + 1, 2 * sizeof *own->stack);
  const bool ok = own->state != NULL && own->spheres != NULL && own->sides != NULL && own->parts_left != NULL &&
                  own->sights != NULL && own->pending != NULL && own->waiting != NULL && own->is_out != NULL &&
                  own->list != NULL && own->stack != NULL;
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

cellist_result peer_prepare_bsp_xmpvo(cellist_peer *peer) {
  cellist_context *context = peer->context;
  struct peer_bsp_xmpvo *own = cellist_allocate_zeroed(context, 1, sizeof *own);
  if (own == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  peer->bsp_xmpvo = own;
  own->cells = sort_cells_of_mesh(&peer->mesh);
  cellist_result result = peer_prepare_centroids(peer);
  if (result == CELLIST_SUCCESS) result = sort_planes_create(context, &own->cells, &own->planes);
  if (result == CELLIST_SUCCESS) result = sort_boundary_create(context, &peer->mesh, &own->boundary);
  if (result == CELLIST_SUCCESS) result = peer_bsp_create(context, &own->boundary, &own->tree);
  if (result == CELLIST_SUCCESS) result = allocate_all(context, own);
  if (result == CELLIST_SUCCESS) make_spheres(own);
  return result;
}

void peer_release_bsp_xmpvo(cellist_peer *peer) {
  cellist_context *context = peer->context;
  struct peer_bsp_xmpvo *own = peer->bsp_xmpvo;
  if (own == NULL) return;
  sort_planes_release(context, &own->planes);
  sort_boundary_release(context, &own->boundary);
  peer_bsp_release(context, &own->tree);
  void *const blocks[] = {own->state,   own->spheres, own->sides, own->parts_left, own->sights, own->pending,
                          own->waiting, own->is_out,  own->list,  own->waits,      own->stack};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) cellist_deallocate(context, blocks[i]);
  cellist_deallocate(context, own);
}

static struct sight sight_of(const float sphere[4], const sort_eye *eye) {
  struct sight sight;
  double from[3], along = 0, length = 0;
  for (int k = 0; k < 3; k++) {
    from[k] = sphere[k] - (eye->parallel ? 0 : eye->at[k]);
    along += from[k] * eye->at[k];
    length += eye->parallel ? eye->at[k] * eye->at[k] : from[k] * from[k];
  }
  if (eye->parallel) {
    for (int k = 0; k < 3; k++) sight.at[k] = (float)(from[k] - along / length * eye->at[k]);
    sight.reach = sphere[3];
    return sight;
  }
  length = sqrt(length);
  const bool is_inside = !(length > sphere[3]); /* then the face may be anywhere */
  for (int k = 0; k < 3; k++) sight.at[k] = is_inside ? 0 : (float)(from[k] / length);
  sight.reach = is_inside ? 4 : (float)asin(sphere[3] / length) + 1e-6f;
  return sight;
}

/* False only if no ray meets both spheres. */
static bool may_cover(const struct sight *a, const struct sight *b) {
  const float x = a->at[0] - b->at[0], y = a->at[1] - b->at[1], z = a->at[2] - b->at[2], reach = a->reach + b->reach;
  return x * x + y * y + z * z <= reach * reach;
}

/* One less behind a cell. */
static void release_state(struct peer_bsp_xmpvo *own, uint32_t tet) {
  if (sort_let_go(&own->state[tet])) own->order[own->count++] = tet;
}

static void release_row(struct peer_bsp_xmpvo *own, uint32_t row) {
  if (--own->pending[row] == 0) release_state(own, own->boundary.row_tets[row]);
}

/* Puts out all cells that wait for nothing. */
static void put_out(struct peer_bsp_xmpvo *own) {
  while (own->out < own->count) {
    const uint32_t tet = own->order[own->out++];
    const uint8_t state = own->state[tet];
    for (uint32_t k = 0; k < 4; k++)
      if (state >> k & 1) release_state(own, own->cells.neighbours[4 * (size_t)tet + k]);
    if (!(state & ON_BOUNDARY)) continue;
    const uint32_t row = own->boundary.tet_rows[tet];
    own->is_out[row] = 1;
    for (uint32_t wait = own->waiting[row]; wait != CELLIST_NONE; wait = own->waits[wait].next)
      release_row(own, own->waits[wait].row);
  }
}

/* The face's cell waits for those in the list that the face covers. Cells that came out meanwhile leave the list. */
static cellist_result wait_for_list(cellist_peer *peer, const sort_scene *scene, uint32_t face) {
  struct peer_bsp_xmpvo *own = peer->bsp_xmpvo;
  const sort_boundary *boundary = &own->boundary;
  const uint32_t row = boundary->rows[face];
  const sort_face leaving = {&boundary->corners[3 * (size_t)face], &boundary->planes[face]};
  size_t kept = 0;
  for (size_t i = 0; i < own->list_count; i++) {
    const uint32_t other = own->list[i], other_row = boundary->rows[other];
    if (own->is_out[other_row]) continue;
    own->list[kept++] = other;
    if (other_row == row || !may_cover(&own->sights[face], &own->sights[other])) continue;
    const sort_face entering = {&boundary->corners[3 * (size_t)other], &boundary->planes[other]};
    if (!sort_leaves_before(scene, leaving, entering, NULL)) continue;
    const cellist_result result = sort_reserve(peer->context, &own->waits, &own->wait_capacity, own->wait_count,
                                               own->wait_count + 1, sizeof *own->waits);
    if (result != CELLIST_SUCCESS) return result;
    own->waits[own->wait_count] = (struct wait){row, own->waiting[other_row]};
    own->waiting[other_row] = (uint32_t)own->wait_count++;
    own->pending[row]++;
  }
  own->list_count = kept;
  return CELLIST_SUCCESS;
}

/* The traversal passes the parts in a node's plane: first those that the eye sees from outside, behind which cells
 * lie, as cells may touch there. */
static cellist_result pass(cellist_peer *peer, const sort_scene *scene, const peer_bsp_node *node) {
  struct peer_bsp_xmpvo *own = peer->bsp_xmpvo;
  const uint32_t *parts = &own->tree.parts[node->begin];
  for (uint32_t i = 0; i < node->count; i++) {
    const uint32_t face = parts[i];
    if (own->sides[face] <= 0) continue;
    if (own->parts_left[face] == own->tree.part_counts[face] && !own->is_out[own->boundary.rows[face]])
      own->list[own->list_count++] = face;
    own->parts_left[face]--;
  }
  for (uint32_t i = 0; i < node->count; i++) {
    const uint32_t face = parts[i];
    if (own->sides[face] >= 0 || --own->parts_left[face] > 0) continue;
    const cellist_result result = wait_for_list(peer, scene, face);
    if (result != CELLIST_SUCCESS) return result;
    release_row(own, own->boundary.rows[face]);
    put_out(own);
  }
  return CELLIST_SUCCESS;
}

static cellist_result traverse(cellist_peer *peer, const sort_scene *scene) {
  struct peer_bsp_xmpvo *own = peer->bsp_xmpvo;
  const sort_eye *eye = &scene->eye;
  /* Pairs: a node and how far it is: 0 untouched, 1 its farther side is done. */
  size_t height = 0;
  if (own->tree.node_count > 0) {
    own->stack[height++] = 0;
    own->stack[height++] = 0;
  }
  while (height > 0) {
    const uint32_t stage = own->stack[--height], at = own->stack[--height];
    const peer_bsp_node *node = &own->tree.nodes[at];
    int side = 0;
    if (node->face != CELLIST_NONE)
      side = own->sides[node->face];
    else if (eye->parallel)
      side = (eye->at[node->axis] > 0) - (eye->at[node->axis] < 0);
    else
      side = (eye->at[node->axis] > node->offset) - (eye->at[node->axis] < node->offset);
    uint32_t next = node->children[side <= 0];
    if (stage == 0) {
      own->stack[height++] = at;
      own->stack[height++] = 1;
    } else {
      const cellist_result result = pass(peer, scene, node);
      if (result != CELLIST_SUCCESS) return result;
      next = node->children[side > 0];
    }
    if (next == CELLIST_NONE) continue;
    own->stack[height++] = next;
    own->stack[height++] = 0;
  }
  return CELLIST_SUCCESS;
}

static void begin_view(struct peer_bsp_xmpvo *own, const sort_eye *eye) {
  const sort_boundary *boundary = &own->boundary;
  memset(own->pending, 0, boundary->row_count * sizeof *own->pending);
  memset(own->is_out, 0, boundary->row_count);
  memset(own->waiting, 0xff, boundary->row_count * sizeof *own->waiting);
  memcpy(own->parts_left, own->tree.part_counts, boundary->face_count * sizeof *own->parts_left);
  own->list_count = own->wait_count = 0;
  for (size_t face = 0; face < boundary->face_count; face++) {
    const double *p[3];
    for (size_t c = 0; c < 3; c++) p[c] = &boundary->positions[3 * (size_t)boundary->corners[3 * face + c]];
    own->sides[face] = (int8_t)sort_eye_side(eye, p[0], p[1], p[2]);
    own->sights[face] = sight_of(&own->spheres[4 * face], eye);
    own->pending[boundary->rows[face]] += own->sides[face] < 0;
  }
  for (size_t row = 0; row < boundary->row_count; row++) {
    uint8_t *state = &own->state[boundary->row_tets[row]];
    *state = (uint8_t)((*state | ON_BOUNDARY) + (own->pending[row] > 0 ? SORT_WAIT : 0));
  }
}

/* What still waits stands in a circle, or in front of one: the cell with the farthest centre comes out, and so on. */
static void cut_cycles(cellist_peer *peer, const sort_eye *eye) {
  struct peer_bsp_xmpvo *own = peer->bsp_xmpvo;
  const size_t tet_count = peer_fill_items(peer, eye, false);
  const peer_item *sorted = peer_radix_sort(peer->items, tet_count);
  for (size_t i = 0; i < tet_count && own->count < tet_count; i++) {
    const uint32_t tet = sorted[i].tet;
    if (!sort_is_waiting(own->state[tet])) continue;
    own->state[tet] = (uint8_t)((own->state[tet] | SORT_READY) + SORT_WAIT);
    release_state(own, tet);
    put_out(own);
  }
}

cellist_result peer_sort_bsp_xmpvo(cellist_peer *peer, const sort_eye *eye, uint32_t *order) {
  struct peer_bsp_xmpvo *own = peer->bsp_xmpvo;
  const size_t tet_count = peer->mesh.tet_count;
  const sort_scene scene = {.eye = *eye, .positions = own->boundary.positions, .around_eye = !eye->parallel};
  own->order = order;
  own->out = own->count = 0;
  sort_planes_find_states(peer->context, &own->cells, &own->planes, eye, own->state, NULL);
  begin_view(own, eye);
  for (uint32_t tet = 0; tet < tet_count; tet++)
    if (!sort_is_waiting(own->state[tet])) order[own->count++] = tet;
  put_out(own);
  const cellist_result result = traverse(peer, &scene);
  if (result != CELLIST_SUCCESS) return result;
  if (own->count < tet_count) cut_cycles(peer, eye);
  return CELLIST_SUCCESS;
}
