/* SPDX-License-Identifier: BSD-3-Clause
 * Candidates: pairs of a leaving and an entering face that one picture cannot tell apart, nearest entering face first.
 *
 * They come from a grid over the entering faces' boxes; a pair is looked at in one cell of the grid only (where the
 * lower corner of the two boxes' common part lies). In each cell of the grid faces stand by depth, so that the search
 * for a leaving face can end where sheets hide the rest from it. */
#include "candidates.h"

#include <cellist/radix.h>
#include <math.h>
#include <string.h>

/* Leaving faces per range of the parallel loop; the arcs' order depends on it only through the ranges' order. */
enum { CHUNK = SORT_GAP_CHUNK };

/* Cells of the grid whose faces are looked at together, nearest first: those of most faces. Only speed depends on it.
 */
enum { TOGETHER = 32 };

/* When room for arcs does not suffice, there will be this many times what was needed, so that other views seldom need
 * more. What is not used costs no memory where the system gives out pages when they are touched. */
enum { HEADROOM = 4 };

static void find_boxes(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  sort_gap_search *search = user;
  sort_gaps *gaps = search->gaps;
  for (size_t i = begin; i < end; i++) {
    const uint32_t *v = &gaps->boundary.corners[3 * (size_t)gaps->faces[i]];
    if (gaps->sides[i] == 0)
      gaps->boxes[i] = (sort_box){.low = {1, 1}, .high = {-1, -1}};
    else if (search->cube_side < 0)
      gaps->boxes[i] =
          sort_picture_box(gaps->picture, gaps->depths, search->scene.picture_error, search->depth_error, v);
    else
      gaps->boxes[i] = sort_cube_box(search->scene.eye.at, gaps->boundary.positions, v, search->cube_side);
  }
}

/* The grid's cell of a coordinate, clamped. */
static uint32_t cell_of(const sort_grid *grid, double x, int k) {
  const double at = (x - grid->origin[k]) * grid->scale[k];
  return at <= 0 ? 0 : at >= grid->size - 1 ? grid->size - 1 : (uint32_t)at;
}

struct cells {
  uint32_t low[2], high[2];
};

static struct cells cells_of(const sort_grid *grid, const sort_box *box) {
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
  entry.nearest = nextafterf((float)box->nearest, -HUGE_VALF);
  entry.farthest = nextafterf((float)box->farthest, HUGE_VALF);
  return entry;
}

/* Orders like the depth, for all but NaN. */
static uint32_t depth_key(double depth) {
  const float near = (float)depth;
  uint32_t bits = 0;
  memcpy(&bits, &near, sizeof bits);
  return bits >> 31 ? ~bits : bits | 0x80000000u;
}

/* Sorts faces into leaving and entering ones, and the entering ones by depth and into the grid. */
static void make_grid(sort_gap_search *search) {
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
    gaps->keys[gaps->entering_count] = depth_key(box->nearest);
    gaps->entering[gaps->entering_count++] = i;
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], box->low[k]);
      high[k] = fmax(high[k], box->high[k]);
    }
  }
  cellist_radix_sort(gaps->keys, gaps->entering, gaps->entering_count, &gaps->keys[gaps->face_count],
                     &gaps->entering[gaps->face_count], 32);
  sort_grid *grid = &search->grid;
  const double size = ceil(sqrt((double)gaps->entering_count));
  grid->size = size < 1 ? 1 : size > SORT_GRID_LIMIT ? SORT_GRID_LIMIT : (uint32_t)size;
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

/* A place among the faces of one cell of the grid. */
struct cursor {
  const sort_grid_entry *at, *end;
  uint32_t x, y;
};

/* One leaving face and what is known of it. */
struct leaving {
  sort_grid_entry box;
  sort_face face;
  uint32_t near; /* its row's place */
  sort_sheets *sheets;
};

/* Moves on to the next entering face, this one included, that may lie behind the leaving one. */
static inline bool find_candidate(const sort_gaps *gaps, const struct leaving *leaving, struct cursor *cursor) {
  const sort_grid_entry *box = &leaving->box;
  for (; cursor->at < cursor->end; cursor->at++) {
    const sort_grid_entry *entry = cursor->at;
    if (entry->nearest > leaving->sheets->hidden_depth) break;
    if (box->low[0] > entry->high[0] || entry->low[0] > box->high[0] || box->low[1] > entry->high[1] ||
        entry->low[1] > box->high[1] || box->nearest > entry->farthest)
      continue;
    if (cursor->x != (box->cell[0] > entry->cell[0] ? box->cell[0] : entry->cell[0]) ||
        cursor->y != (box->cell[1] > entry->cell[1] ? box->cell[1] : entry->cell[1]))
      continue;
    const uint32_t far = gaps->places[gaps->boundary.rows[gaps->faces[entry->face]]];
    if (far != leaving->near && (gaps->parts == NULL || gaps->parts[far] == gaps->parts[leaving->near])) return true;
  }
  return false;
}

static void look_at(sort_gap_search *search, sort_gap_worker *worker, const struct leaving *leaving,
                    const sort_grid_entry *entry) {
  sort_gaps *gaps = search->gaps;
  const sort_boundary *boundary = &gaps->boundary;
  const uint32_t face = gaps->faces[entry->face];
  const sort_face entering = {&boundary->corners[3 * (size_t)face], &boundary->planes[face]};
  sort_cover cover = {.hidden = leaving->sheets->hidden_height};
  worker->candidate_count++;
  if (!sort_leaves_before(&search->scene, leaving->face, entering, &cover)) return;
  sort_pairs_add(&gaps->pairs, &worker->writer, gaps->places[boundary->rows[face]], leaving->near);
  if (cover.is_behind) sort_sheets_add(leaving->sheets, boundary, face, cover.crossing, entry->farthest, cover.highest);
}

/* All pairs of one leaving face. */
static void search_face(sort_gap_search *search, sort_gap_worker *worker, uint32_t face) {
  const sort_gaps *gaps = search->gaps;
  const sort_boundary *boundary = &gaps->boundary;
  const struct cells cells = cells_of(&search->grid, &gaps->boxes[face]);
  const uint32_t own = gaps->faces[face];
  struct leaving leaving = {.box = make_entry(&gaps->boxes[face], &cells, face),
                            .face = {&boundary->corners[3 * (size_t)own], &boundary->planes[own]},
                            .near = gaps->places[boundary->rows[own]],
                            .sheets = &worker->sheets};
  struct cursor cursors[TOGETHER];
  uint32_t x = cells.low[0], y = cells.low[1];
  sort_sheets_begin(&worker->sheets);
  while (y <= cells.high[1]) {
    size_t count = 0;
    for (; count < TOGETHER && y <= cells.high[1]; y++, x = cells.low[0]) {
      for (; count < TOGETHER && x <= cells.high[0]; x++) {
        const size_t cell = (size_t)y * search->grid.size + x;
        cursors[count] =
            (struct cursor){&gaps->entries[gaps->cell_starts[cell]], &gaps->entries[gaps->cell_starts[cell + 1]], x, y};
        count += find_candidate(gaps, &leaving, &cursors[count]);
      }
      if (x <= cells.high[0]) break;
    }
    while (count > 0) {
      size_t nearest = 0;
      for (size_t i = 1; i < count; i++)
        if (cursors[i].at->nearest < cursors[nearest].at->nearest) nearest = i;
      if (cursors[nearest].at->nearest > leaving.sheets->hidden_depth) break;
      look_at(search, worker, &leaving, cursors[nearest].at++);
      if (!find_candidate(gaps, &leaving, &cursors[nearest])) cursors[nearest] = cursors[--count];
    }
  }
}

static void search_range(void *user, size_t begin, size_t end, unsigned worker) {
  sort_gap_search *search = user;
  sort_gaps *gaps = search->gaps;
  sort_gap_worker *own = &gaps->workers[worker];
  sort_pair_range range = sort_pairs_begin(&gaps->pairs, &own->writer);
  const size_t before = own->writer.count;
  for (size_t i = begin; i < end; i++) search_face(search, own, gaps->leaving[i]);
  range.count = own->writer.count - before;
  gaps->ranges[gaps->range_count + begin / CHUNK] = range;
}

void sort_gap_search_begin(sort_gaps *gaps) {
  atomic_store(&gaps->pairs.taken, 0);
  for (unsigned i = 0; i < gaps->worker_count; i++)
    gaps->workers[i].writer = (sort_pair_writer){CELLIST_NONE, SORT_PAIR_BLOCK, 0};
}

/* Room for count arcs in all. */
static cellist_result reserve(sort_gap_search *search, size_t count) {
  sort_gaps *gaps = search->gaps;
  const size_t blocks = HEADROOM * sort_pairs_blocks(count, gaps->worker_count);
  uint32_t *targets = cellist_allocate(search->context, blocks, SORT_PAIR_BLOCK * sizeof *targets);
  if (targets == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_deallocate(search->context, gaps->targets);
  gaps->targets = targets;
  return sort_pairs_reserve(search->context, &gaps->pairs, blocks);
}

cellist_result sort_gap_search_picture(sort_gap_search *search) {
  sort_gaps *gaps = search->gaps;
  cellist_parallel_for(search->context, gaps->face_count, 4 * CHUNK, find_boxes, search);
  make_grid(search);
  const size_t taken = atomic_load(&gaps->pairs.taken);
  for (unsigned i = 0; i < gaps->worker_count; i++) gaps->workers[i].saved = gaps->workers[i].writer;
  for (;;) {
    size_t arc_count = 0, candidate_count = 0;
    for (unsigned i = 0; i < gaps->worker_count; i++) gaps->workers[i].candidate_count = 0;
    cellist_parallel_for(search->context, gaps->leaving_count, CHUNK, search_range, search);
    for (unsigned i = 0; i < gaps->worker_count; i++) {
      arc_count += gaps->workers[i].writer.count;
      candidate_count += gaps->workers[i].candidate_count;
    }
    if (atomic_load(&gaps->pairs.taken) <= gaps->pairs.capacity) {
      gaps->arc_count = arc_count;
      gaps->candidate_count += candidate_count;
      gaps->range_count += (gaps->leaving_count + CHUNK - 1) / CHUNK;
      return CELLIST_SUCCESS;
    }
    /* Counted, not all kept: once more. */
    const cellist_result result = reserve(search, arc_count);
    if (result != CELLIST_SUCCESS) return result;
    atomic_store(&gaps->pairs.taken, taken);
    for (unsigned i = 0; i < gaps->worker_count; i++) gaps->workers[i].writer = gaps->workers[i].saved;
  }
}
