/* SPDX-License-Identifier: BSD-3-Clause
 * Gap arcs: every pair (boundary face through which rays leave a cell, boundary face through which they enter one) that
 * covers each other with the first one nearer puts the first one's cell in front of the second one's.
 *
 * Each arc is a true constraint: some ray meets both cells in that order. And each step of a ray from a cell through a
 * gap into the next cell is such a pair. So shared faces and gap arcs together order all cells, with no exterior
 * (the published way, Roettger et al. 2004, fills gaps with convex cells; whose constraints are false for pairs of
 * cells that no ray meets both, and cyclic in almost every view of most concave meshes).
 *
 * Candidates come from a grid over the entering faces' boxes in a picture; a pair is looked at in one cell of the
 * grid only (where the lower corner of the two boxes' common part lies). */
#include "gaps.h"

#include <math.h>
#include <string.h>

#include "../memory.h"
#include "overlap.h"

/* Faces per range of the parallel loop; the arcs' order depends on it only through the ranges' order. */
enum { CHUNK = 256 };

/* At most this many cells a side in the grid; memory only. */
enum { GRID_LIMIT = 1024 };

/* Entries of the grid and arcs that there is room for, for each boundary face. More entries make the grid coarser, more
 * arcs need more memory. */
enum { ENTRIES_A_FACE = 8, ARCS_A_FACE = 8 };

struct grid {
  uint32_t size;
  double origin[2], scale[2];
};

struct search {
  cellist_context *context;
  sort_gaps *gaps;
  sort_scene scene;
  struct grid grid;
  int cube_side; /* -1: the one picture */
};

cellist_result sort_gaps_create(cellist_context *context, const cellist_sorter_desc *mesh, sort_gaps *gaps) {
  const cellist_result result = sort_boundary_create(context, mesh, &gaps->boundary);
  if (result != CELLIST_SUCCESS) return result;
  const size_t faces = gaps->boundary.face_count, rows = gaps->boundary.row_count;
  gaps->worker_count = cellist_context_worker_count(context);
  gaps->rows = cellist_allocate(context, rows, sizeof *gaps->rows);
  gaps->places = cellist_allocate(context, rows, sizeof *gaps->places);
  gaps->part_list = cellist_allocate(context, rows, sizeof *gaps->part_list);
  gaps->faces = cellist_allocate(context, faces, sizeof *gaps->faces);
  gaps->vertices = cellist_allocate(context, gaps->boundary.vertex_count, sizeof *gaps->vertices);
  gaps->is_listed = cellist_allocate_zeroed(context, gaps->boundary.vertex_count, 1);
  gaps->starts = cellist_allocate(context, rows + 1, sizeof *gaps->starts);
  gaps->pending = cellist_allocate(context, rows, sizeof *gaps->pending);
  gaps->picture = cellist_allocate(context, gaps->boundary.vertex_count, 2 * sizeof *gaps->picture);
  gaps->sides = cellist_allocate(context, faces, sizeof *gaps->sides);
  gaps->boxes = cellist_allocate(context, faces, sizeof *gaps->boxes);
  gaps->leaving = cellist_allocate(context, faces, sizeof *gaps->leaving);
  gaps->entering = cellist_allocate(context, faces, sizeof *gaps->entering);
  gaps->buffers = cellist_allocate_zeroed(context, gaps->worker_count, sizeof *gaps->buffers);
  const size_t side = (size_t)ceil(sqrt((double)faces)) + 1, grid_size = side < GRID_LIMIT ? side : GRID_LIMIT;
  gaps->cell_starts = cellist_allocate(context, grid_size * grid_size + 2, sizeof *gaps->cell_starts);
  gaps->entry_capacity = ENTRIES_A_FACE * faces;
  gaps->entries = cellist_allocate(context, gaps->entry_capacity, sizeof *gaps->entries);
  gaps->chunks = cellist_allocate(context, faces / CHUNK + 1, sizeof *gaps->chunks);
  gaps->pair_capacity = 2 * ARCS_A_FACE * faces;
  gaps->pairs = cellist_allocate(context, gaps->pair_capacity, sizeof *gaps->pairs);
  gaps->target_capacity = ARCS_A_FACE * faces;
  gaps->targets = cellist_allocate(context, gaps->target_capacity, sizeof *gaps->targets);
  if (gaps->cell_starts == NULL || gaps->entries == NULL || gaps->chunks == NULL || gaps->pairs == NULL ||
      gaps->targets == NULL || gaps->buffers == NULL)
    return CELLIST_ERROR_OUT_OF_MEMORY;
  for (unsigned i = 0; i < gaps->worker_count; i++) { /* which worker finds how many is chance */
    sort_gap_buffer *buffer = &gaps->buffers[i];
    buffer->capacity = 4 * ARCS_A_FACE * faces / (gaps->worker_count + 1) + 64;
    buffer->pairs = cellist_allocate(context, buffer->capacity, sizeof *buffer->pairs);
    if (buffer->pairs == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  const bool ok = gaps->rows != NULL && gaps->places != NULL && gaps->part_list != NULL && gaps->faces != NULL &&
                  gaps->vertices != NULL && gaps->is_listed != NULL && gaps->starts != NULL && gaps->pending != NULL &&
                  gaps->picture != NULL && gaps->sides != NULL && gaps->boxes != NULL && gaps->leaving != NULL &&
                  gaps->entering != NULL && gaps->buffers != NULL;
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

void sort_gaps_release(cellist_context *context, sort_gaps *gaps) {
  sort_boundary_release(context, &gaps->boundary);
  for (unsigned i = 0; gaps->buffers != NULL && i < gaps->worker_count; i++)
    cellist_deallocate(context, gaps->buffers[i].pairs);
  cellist_deallocate(context, gaps->buffers);
  cellist_deallocate(context, gaps->rows);
  cellist_deallocate(context, gaps->places);
  cellist_deallocate(context, gaps->part_list);
  cellist_deallocate(context, gaps->faces);
  cellist_deallocate(context, gaps->vertices);
  cellist_deallocate(context, gaps->is_listed);
  cellist_deallocate(context, gaps->starts);
  cellist_deallocate(context, gaps->targets);
  cellist_deallocate(context, gaps->pending);
  cellist_deallocate(context, gaps->pairs);
  cellist_deallocate(context, gaps->picture);
  cellist_deallocate(context, gaps->sides);
  cellist_deallocate(context, gaps->boxes);
  cellist_deallocate(context, gaps->leaving);
  cellist_deallocate(context, gaps->entering);
  cellist_deallocate(context, gaps->cell_starts);
  cellist_deallocate(context, gaps->entries);
  cellist_deallocate(context, gaps->chunks);
  *gaps = (sort_gaps){0};
}

static void find_sides(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct search *search = user;
  const sort_boundary *boundary = &search->gaps->boundary;
  for (size_t i = begin; i < end; i++) {
    const uint32_t *v = &boundary->corners[3 * (size_t)search->gaps->faces[i]];
    const double *x = boundary->positions;
    search->gaps->sides[i] =
        (int8_t)sort_eye_side(&search->scene.eye, &x[3 * (size_t)v[0]], &x[3 * (size_t)v[1]], &x[3 * (size_t)v[2]]);
  }
}

static void find_boxes(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct search *search = user;
  sort_gaps *gaps = search->gaps;
  for (size_t i = begin; i < end; i++) {
    const uint32_t *v = &gaps->boundary.corners[3 * (size_t)gaps->faces[i]];
    if (gaps->sides[i] == 0)
      gaps->boxes[i] = (sort_box){{1, 1}, {-1, -1}};
    else if (search->cube_side < 0)
      gaps->boxes[i] = sort_picture_box(gaps->picture, search->scene.picture_error, v);
    else
      gaps->boxes[i] = sort_cube_box(search->scene.eye.at, gaps->boundary.positions, v, search->cube_side);
  }
}

/* The grid's cell of a coordinate, clamped. */
static uint32_t cell_of(const struct grid *grid, double x, int k) {
  const double at = (x - grid->origin[k]) * grid->scale[k];
  return at <= 0 ? 0 : at >= grid->size - 1 ? grid->size - 1 : (uint32_t)at;
}

struct cells {
  uint32_t low[2], high[2];
};

static struct cells cells_of(const struct grid *grid, const sort_box *box) {
  struct cells cells;
  for (int k = 0; k < 2; k++) {
    cells.low[k] = cell_of(grid, box->low[k], k);
    cells.high[k] = cell_of(grid, box->high[k], k);
  }
  return cells;
}

/* The box in single precision, not smaller. */
static sort_grid_entry make_entry(const sort_box *box, const struct cells *cells, uint32_t face) {
  sort_grid_entry entry = {.face = face};
  for (int k = 0; k < 2; k++) {
    entry.low[k] = nextafterf((float)box->low[k], -HUGE_VALF);
    entry.high[k] = nextafterf((float)box->high[k], HUGE_VALF);
    entry.cell[k] = (uint16_t)cells->low[k];
  }
  return entry;
}

/* Sorts faces into leaving and entering ones, and the entering ones into the grid. */
static void make_grid(struct search *search) {
  sort_gaps *gaps = search->gaps;
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  gaps->leaving_count = gaps->entering_count = 0;
  for (uint32_t i = 0; i < gaps->face_count; i++) {
    const sort_box *box = &gaps->boxes[i];
    if (box->low[0] > box->high[0]) continue;
    if (gaps->sides[i] < 0) {
      gaps->leaving[gaps->leaving_count++] = i;
      continue;
    }
    gaps->entering[gaps->entering_count++] = i;
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], box->low[k]);
      high[k] = fmax(high[k], box->high[k]);
    }
  }
  struct grid *grid = &search->grid;
  const double size = ceil(sqrt((double)gaps->entering_count));
  grid->size = size < 1 ? 1 : size > GRID_LIMIT ? GRID_LIMIT : (uint32_t)size;
  uint32_t *starts = gaps->cell_starts;
  size_t cell_count = 0;
  for (;; grid->size /= 2) { /* coarser until the entries fit: with one cell there is one a face */
    for (int k = 0; k < 2; k++) {
      grid->origin[k] = low[k];
      grid->scale[k] = high[k] > low[k] ? grid->size / (high[k] - low[k]) : 0;
    }
    cell_count = (size_t)grid->size * grid->size;
    /* A counting sort; counts stand two ahead, so that filling leaves starts in place. */
    memset(starts, 0, (cell_count + 2) * sizeof *starts);
    size_t sum = 0;
    for (size_t i = 0; i < gaps->entering_count && (sum <= gaps->entry_capacity || grid->size == 1); i++) {
      const struct cells cells = cells_of(grid, &gaps->boxes[gaps->entering[i]]);
      sum += (size_t)(cells.high[0] - cells.low[0] + 1) * (cells.high[1] - cells.low[1] + 1);
      for (uint32_t y = cells.low[1]; y <= cells.high[1]; y++)
        for (uint32_t x = cells.low[0]; x <= cells.high[0]; x++) starts[(size_t)y * grid->size + x + 2]++;
    }
    if (sum <= gaps->entry_capacity) break;
  }
  for (size_t i = 2; i < cell_count + 2; i++) starts[i] += starts[i - 1];
  for (size_t i = 0; i < gaps->entering_count; i++) {
    const struct cells cells = cells_of(grid, &gaps->boxes[gaps->entering[i]]);
    const sort_grid_entry entry = make_entry(&gaps->boxes[gaps->entering[i]], &cells, gaps->entering[i]);
    for (uint32_t y = cells.low[1]; y <= cells.high[1]; y++)
      for (uint32_t x = cells.low[0]; x <= cells.high[0]; x++)
        gaps->entries[starts[(size_t)y * grid->size + x + 1]++] = entry;
  }
}

static cellist_result add_pair(cellist_context *context, sort_gap_buffer *buffer, uint32_t far, uint32_t near) {
  const cellist_result result = sort_reserve(context, &buffer->pairs, &buffer->capacity, 2 * buffer->count,
                                             2 * buffer->count + 2, sizeof *buffer->pairs);
  if (result != CELLIST_SUCCESS) return result;
  buffer->pairs[2 * buffer->count] = far;
  buffer->pairs[2 * buffer->count + 1] = near;
  buffer->count++;
  return CELLIST_SUCCESS;
}

/* All pairs of one leaving face. */
static void search_face(struct search *search, sort_gap_buffer *buffer, uint32_t leaving) {
  const sort_gaps *gaps = search->gaps;
  const sort_boundary *boundary = &gaps->boundary;
  const struct cells cells = cells_of(&search->grid, &gaps->boxes[leaving]);
  const sort_grid_entry box = make_entry(&gaps->boxes[leaving], &cells, leaving);
  const uint32_t own = gaps->faces[leaving], near = gaps->places[boundary->rows[own]];
  const sort_face face = {&boundary->corners[3 * (size_t)own], &boundary->planes[own]};
  for (uint32_t y = cells.low[1]; y <= cells.high[1]; y++) {
    for (uint32_t x = cells.low[0]; x <= cells.high[0]; x++) {
      const size_t cell = (size_t)y * search->grid.size + x;
      const sort_grid_entry *end = &gaps->entries[gaps->cell_starts[cell + 1]];
      for (const sort_grid_entry *entry = &gaps->entries[gaps->cell_starts[cell]]; entry < end; entry++) {
        if (box.low[0] > entry->high[0] || entry->low[0] > box.high[0] || box.low[1] > entry->high[1] ||
            entry->low[1] > box.high[1])
          continue;
        if (x != (box.cell[0] > entry->cell[0] ? box.cell[0] : entry->cell[0]) ||
            y != (box.cell[1] > entry->cell[1] ? box.cell[1] : entry->cell[1]))
          continue;
        const uint32_t beyond = gaps->faces[entry->face], far = gaps->places[boundary->rows[beyond]];
        if (far == near || (gaps->parts != NULL && gaps->parts[far] != gaps->parts[near])) continue;
        buffer->candidate_count++;
        const sort_face other = {&boundary->corners[3 * (size_t)beyond], &boundary->planes[beyond]};
        if (!sort_leaves_before(&search->scene, face, other)) continue;
        if (buffer->result == CELLIST_SUCCESS) buffer->result = add_pair(search->context, buffer, far, near);
      }
    }
  }
}

static void search_range(void *user, size_t begin, size_t end, unsigned worker) {
  struct search *search = user;
  sort_gaps *gaps = search->gaps;
  sort_gap_buffer *buffer = &gaps->buffers[worker];
  sort_gap_chunk *chunk = &gaps->chunks[begin / CHUNK];
  *chunk = (sort_gap_chunk){worker, buffer->count, 0};
  for (size_t i = begin; i < end; i++) search_face(search, buffer, gaps->leaving[i]);
  chunk->count = buffer->count - chunk->begin;
}

/* One picture's arcs, appended to the pairs in the order of the leaving faces. */
static cellist_result search_picture(struct search *search) {
  sort_gaps *gaps = search->gaps;
  cellist_parallel_for(search->context, gaps->face_count, 4 * CHUNK, find_boxes, search);
  make_grid(search);
  const size_t chunk_count = (gaps->leaving_count + CHUNK - 1) / CHUNK;
  for (unsigned i = 0; i < gaps->worker_count; i++) {
    gaps->buffers[i].count = gaps->buffers[i].candidate_count = 0;
    gaps->buffers[i].result = CELLIST_SUCCESS;
  }
  cellist_parallel_for(search->context, gaps->leaving_count, CHUNK, search_range, search);
  size_t found = 0;
  for (unsigned i = 0; i < gaps->worker_count; i++) {
    if (gaps->buffers[i].result != CELLIST_SUCCESS) return gaps->buffers[i].result;
    found += gaps->buffers[i].count;
    gaps->candidate_count += gaps->buffers[i].candidate_count;
  }
  const cellist_result result = sort_reserve(search->context, &gaps->pairs, &gaps->pair_capacity, 2 * gaps->arc_count,
                                             2 * (gaps->arc_count + found), sizeof *gaps->pairs);
  if (result != CELLIST_SUCCESS) return result;
  for (size_t i = 0; i < chunk_count; i++) {
    const sort_gap_chunk *chunk = &gaps->chunks[i];
    if (chunk->count > 0)
      memcpy(&gaps->pairs[2 * gaps->arc_count], &gaps->buffers[chunk->worker].pairs[2 * chunk->begin],
             2 * chunk->count * sizeof *gaps->pairs);
    gaps->arc_count += chunk->count;
  }
  return CELLIST_SUCCESS;
}

/* Arcs by the farther row. */
static cellist_result group_arcs(cellist_context *context, sort_gaps *gaps) {
  const size_t rows = gaps->row_count;
  const cellist_result result =
      sort_reserve(context, &gaps->targets, &gaps->target_capacity, 0, gaps->arc_count, sizeof *gaps->targets);
  if (result != CELLIST_SUCCESS) return result;
  memset(gaps->starts, 0, (rows + 1) * sizeof *gaps->starts);
  memset(gaps->pending, 0, rows * sizeof *gaps->pending);
  for (size_t i = 0; i < gaps->arc_count; i++) gaps->starts[gaps->pairs[2 * i]]++;
  size_t sum = 0;
  for (size_t r = 0; r <= rows; r++) { /* now the end of each row; filling from behind makes it the start */
    sum += r < rows ? gaps->starts[r] : 0;
    gaps->starts[r] = sum;
  }
  for (size_t i = gaps->arc_count; i-- > 0;) {
    gaps->targets[--gaps->starts[gaps->pairs[2 * i]]] = gaps->pairs[2 * i + 1];
    gaps->pending[gaps->pairs[2 * i + 1]]++;
  }
  return CELLIST_SUCCESS;
}

/* Lists the faces of the active rows, and their vertices. */
static void list_faces(sort_gaps *gaps) {
  const sort_boundary *boundary = &gaps->boundary;
  gaps->face_count = gaps->vertex_count = 0;
  for (uint32_t i = 0; i < gaps->row_count; i++) {
    const uint32_t row = gaps->rows[i];
    gaps->places[row] = i;
    for (uint32_t face = boundary->row_faces[row]; face < boundary->row_faces[row + 1]; face++) {
      gaps->faces[gaps->face_count++] = face;
      for (size_t c = 0; c < 3; c++) {
        const uint32_t vertex = boundary->corners[3 * (size_t)face + c];
        if (gaps->is_listed[vertex]) continue;
        gaps->is_listed[vertex] = 1;
        gaps->vertices[gaps->vertex_count++] = vertex;
      }
    }
  }
  for (size_t i = 0; i < gaps->vertex_count; i++) gaps->is_listed[gaps->vertices[i]] = 0;
}

static cellist_result find_arcs(cellist_context *context, sort_gaps *gaps, const sort_eye *eye) {
  struct search search = {.context = context, .gaps = gaps, .cube_side = -1};
  search.scene = (sort_scene){.eye = *eye, .positions = gaps->boundary.positions};
  gaps->arc_count = gaps->candidate_count = 0;
  cellist_parallel_for(context, gaps->face_count, 4 * CHUNK, find_sides, &search);
  cellist_result result = CELLIST_SUCCESS;
  if (sort_picture_project(&gaps->boundary, gaps->vertices, gaps->vertex_count, eye, gaps->picture,
                           &search.scene.picture_error)) {
    search.scene.picture = gaps->picture;
    result = search_picture(&search);
  } else {
    search.scene.around_eye = true;
    for (search.cube_side = 0; search.cube_side < SORT_CUBE_SIDES && result == CELLIST_SUCCESS; search.cube_side++)
      result = search_picture(&search);
  }
  return result == CELLIST_SUCCESS ? group_arcs(context, gaps) : result;
}

cellist_result sort_gaps_find(cellist_context *context, sort_gaps *gaps, const sort_eye *eye) {
  if (gaps->parts != NULL || gaps->row_count != gaps->boundary.row_count) {
    gaps->parts = NULL;
    gaps->row_count = gaps->boundary.row_count;
    for (uint32_t i = 0; i < gaps->row_count; i++) gaps->rows[i] = i;
    list_faces(gaps);
  }
  return find_arcs(context, gaps, eye);
}

cellist_result sort_gaps_find_among(cellist_context *context, sort_gaps *gaps, const sort_eye *eye) {
  gaps->parts = gaps->part_list;
  list_faces(gaps);
  return find_arcs(context, gaps, eye);
}
