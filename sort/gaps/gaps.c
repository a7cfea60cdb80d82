/* SPDX-License-Identifier: BSD-3-Clause
 * Gap arcs: every pair (boundary face through which rays leave a cell, boundary face through which they enter one) that
 * covers each other with the first one nearer puts the first one's cell in front of the second one's.
 *
 * Each arc is a true constraint: some ray meets both cells in that order. And each step of a ray from a cell through a
 * gap into the next cell is such a pair. So shared faces and gap arcs together order all cells, with no exterior
 * (the published way, Roettger et al. 2004, fills gaps with convex cells; whose constraints are false for pairs of
 * cells that no ray meets both, and cyclic in almost every view of most concave meshes). Pairs between which every ray
 * meets another cell are left out where that is quick to see (sheets.h). */
#include "gaps.h"

#include <math.h>
#include <string.h>

#include "candidates.h"

/* Faces per range of the parallel loop. */
enum { CHUNK = 1024 };

/* Entries of the grid that there is room for, for each boundary face: with more the grid is finer. */
enum { ENTRIES_A_FACE = 8 };

/* Arcs that there is room for from the start, for each boundary face: more than any view of any sample or shared mesh
 * has. A view with still more allocates. */
enum { ARCS_A_FACE = 32 };

static void do_nothing(void *user, size_t begin, size_t end, unsigned worker) {
  (void)user, (void)begin, (void)end, (void)worker;
}

cellist_result sort_gaps_create(cellist_context *context, const cellist_sorter_desc *mesh, sort_gaps *gaps) {
  cellist_result result = sort_boundary_create(context, mesh, &gaps->boundary);
  if (result != CELLIST_SUCCESS) return result;
  const size_t faces = gaps->boundary.face_count, rows = gaps->boundary.row_count;
  const size_t vertices = gaps->boundary.vertex_count;
  gaps->worker_count = cellist_context_worker_count(context);
  gaps->rows = cellist_allocate(context, rows, sizeof *gaps->rows);
  gaps->places = cellist_allocate(context, rows, sizeof *gaps->places);
  gaps->part_list = cellist_allocate(context, rows, sizeof *gaps->part_list);
  gaps->faces = cellist_allocate(context, faces, sizeof *gaps->faces);
  gaps->vertices = cellist_allocate(context, vertices, sizeof *gaps->vertices);
  gaps->is_listed = cellist_allocate_zeroed(context, vertices, 1);
  gaps->starts = cellist_allocate(context, rows + 1, sizeof *gaps->starts);
  gaps->pending = cellist_allocate(context, rows, sizeof *gaps->pending);
  gaps->picture = cellist_allocate(context, vertices, 2 * sizeof *gaps->picture);
  gaps->depths = cellist_allocate(context, vertices, sizeof *gaps->depths);
  gaps->sides = cellist_allocate(context, faces, sizeof *gaps->sides);
  gaps->boxes = cellist_allocate(context, faces, sizeof *gaps->boxes);
  gaps->leaving = cellist_allocate(context, faces, sizeof *gaps->leaving);
  gaps->entering = cellist_allocate(context, faces, 2 * sizeof *gaps->entering);
  gaps->keys = cellist_allocate(context, faces, 2 * sizeof *gaps->keys);
  const size_t side = (size_t)ceil(sqrt((double)faces)) + 1,
               grid_size = side < SORT_GRID_LIMIT ? side : SORT_GRID_LIMIT;
  gaps->cell_starts = cellist_allocate(context, grid_size * grid_size + 2, sizeof *gaps->cell_starts);
  gaps->entry_capacity = ENTRIES_A_FACE * faces;
  gaps->entries = cellist_allocate(context, gaps->entry_capacity, sizeof *gaps->entries);
  gaps->ranges = cellist_allocate(context, faces / SORT_GAP_CHUNK + 1, SORT_CUBE_SIDES * sizeof *gaps->ranges);
  gaps->workers = cellist_allocate_zeroed(context, gaps->worker_count, sizeof *gaps->workers);
  if (gaps->workers == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (unsigned i = 0; i < gaps->worker_count; i++) {
    gaps->workers[i].sheets.places = cellist_allocate_zeroed(context, faces, sizeof *gaps->workers[i].sheets.places);
    if (gaps->workers[i].sheets.places == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  const size_t blocks = sort_pairs_blocks(ARCS_A_FACE * faces, gaps->worker_count);
  gaps->targets = cellist_allocate(context, blocks, SORT_PAIR_BLOCK * sizeof *gaps->targets);
  result = sort_pairs_reserve(context, &gaps->pairs, blocks);
  if (result != CELLIST_SUCCESS) return result;
  /* The context makes its workers when they are first called: now, so that no view has to. */
  if (faces > SORT_GAP_CHUNK) cellist_parallel_for(context, 2, 1, do_nothing, NULL);
  const bool ok = gaps->rows != NULL && gaps->places != NULL && gaps->part_list != NULL && gaps->faces != NULL &&
                  gaps->vertices != NULL && gaps->is_listed != NULL && gaps->starts != NULL && gaps->pending != NULL &&
                  gaps->picture != NULL && gaps->depths != NULL && gaps->sides != NULL && gaps->boxes != NULL &&
                  gaps->leaving != NULL && gaps->entering != NULL && gaps->keys != NULL && gaps->cell_starts != NULL &&
                  gaps->entries != NULL && gaps->ranges != NULL && gaps->targets != NULL;
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

void sort_gaps_release(cellist_context *context, sort_gaps *gaps) {
  sort_boundary_release(context, &gaps->boundary);
  for (unsigned i = 0; gaps->workers != NULL && i < gaps->worker_count; i++)
    cellist_deallocate(context, gaps->workers[i].sheets.places);
  sort_pairs_release(context, &gaps->pairs);
  void *const blocks[] = {gaps->rows,      gaps->places,  gaps->part_list, gaps->faces,   gaps->vertices,
                          gaps->is_listed, gaps->starts,  gaps->targets,   gaps->pending, gaps->picture,
                          gaps->depths,    gaps->sides,   gaps->boxes,     gaps->leaving, gaps->entering,
                          gaps->keys,      gaps->entries, gaps->ranges,    gaps->workers, gaps->cell_starts};
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) cellist_deallocate(context, blocks[i]);
  *gaps = (sort_gaps){0};
}

static void find_sides(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  sort_gap_search *search = user;
  const sort_boundary *boundary = &search->gaps->boundary;
  for (size_t i = begin; i < end; i++) {
    const uint32_t *v = &boundary->corners[3 * (size_t)search->gaps->faces[i]];
    const double *x = boundary->positions;
    search->gaps->sides[i] =
        (int8_t)sort_eye_side(&search->scene.eye, &x[3 * (size_t)v[0]], &x[3 * (size_t)v[1]], &x[3 * (size_t)v[2]]);
  }
}

/* Arcs by the farther row. */
static void group_arcs(sort_gaps *gaps) {
  const size_t rows = gaps->row_count;
  memset(gaps->starts, 0, (rows + 1) * sizeof *gaps->starts);
  memset(gaps->pending, 0, rows * sizeof *gaps->pending);
  size_t count = 0, sum = 0;
  for (size_t r = 0; r < gaps->range_count; r++) {
    sort_pair_range range = gaps->ranges[r];
    for (const uint32_t *pair; (pair = sort_pairs_next(&gaps->pairs, &range, &count)) != NULL;)
      for (size_t i = 0; i < count; i++) gaps->starts[pair[2 * i]]++;
  }
  for (size_t r = 0; r <= rows; r++) {
    const size_t here = r < rows ? gaps->starts[r] : 0;
    gaps->starts[r] = sum;
    sum += here;
  }
  /* Filling moves each start to its row's end, which is the next row's start. */
  for (size_t r = 0; r < gaps->range_count; r++) {
    sort_pair_range range = gaps->ranges[r];
    for (const uint32_t *pair; (pair = sort_pairs_next(&gaps->pairs, &range, &count)) != NULL;)
      for (size_t i = 0; i < count; i++) {
        gaps->targets[gaps->starts[pair[2 * i]]++] = pair[2 * i + 1];
        gaps->pending[pair[2 * i + 1]]++;
      }
  }
  memmove(&gaps->starts[1], gaps->starts, rows * sizeof *gaps->starts);
  gaps->starts[0] = 0;
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
  sort_gap_search search = {.context = context, .gaps = gaps, .cube_side = -1};
  search.scene = (sort_scene){.eye = *eye, .positions = gaps->boundary.positions};
  gaps->arc_count = gaps->candidate_count = gaps->range_count = 0;
  sort_gap_search_begin(gaps);
  cellist_parallel_for(context, gaps->face_count, CHUNK, find_sides, &search);
  cellist_result result = CELLIST_SUCCESS;
  if (sort_picture_project(&gaps->boundary, gaps->vertices, gaps->vertex_count, eye, gaps->picture, gaps->depths,
                           &search.scene.picture_error, &search.depth_error)) {
    search.scene.picture = gaps->picture;
    result = sort_gap_search_picture(&search);
  } else {
    search.scene.around_eye = true;
    for (search.cube_side = 0; search.cube_side < SORT_CUBE_SIDES && result == CELLIST_SUCCESS; search.cube_side++)
      result = sort_gap_search_picture(&search);
  }
  if (result == CELLIST_SUCCESS) group_arcs(gaps);
  return result;
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
