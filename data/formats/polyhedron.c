/* SPDX-License-Identifier: BSD-3-Clause
 * Polyhedra: each becomes tets from its middle to its faces. Triangles are taken as they are, quadrilaterals are cut
 * through their smallest id (as hexahedra cut theirs, so both agree), larger faces into a fan about their own middle,
 * which the cells on both sides share. Points that are added carry the mean of the fields.
 *
 * The faces' order of corners is not trusted: it is made consistent across edges, each of which must have two faces.
 * Convex cells have their middle inside; so has any cell that is star-shaped about it, and these are taken too. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "grid.h"

/* Of the cell's volume: what a tet may be turned inside out. Faces with three corners in line give tets whose sign is
 * rounding; 0 refuses these, 1e-3 lets real dents through. */
static const double DENT_TOLERANCE = 1e-9;

/* From here on a face is cut about its middle. */
enum { FAN_CORNERS = 5 };

struct big_face {
  size_t ordinal;
  size_t size;
  const uint32_t *sorted;
};

struct edge {
  uint32_t low, high, face;
  bool is_reversed; /* the face goes from high to low */
};

struct splitting {
  cellist_context *context;
  struct grid *grid;
  struct grid made;
  size_t polyhedron_count, big_face_count, big_corner_count, tet_count, group_count;
  size_t numbers;                  /* of the faces' that the cells so far have used */
  size_t most_faces, most_corners; /* of one cell */
  uint32_t *big_face_point;        /* [big_face_count] the group of the nth big face of the file */
  struct edge *edges;              /* [most_corners] scratch of one cell */
  uint32_t *face_at;               /* [most_faces] where each face begins in the stream */
  int8_t *turn;                    /* [most_faces] 1 as given, -1 reversed, 0 not known yet */
  uint32_t *queue;                 /* [most_faces] */
};

static cellist_result fail(const struct splitting *splitting, size_t cell, const char *reason) {
  const struct grid *grid = splitting->grid;
  return cellist_fail(splitting->context, CELLIST_ERROR_UNSUPPORTED, "%s: cell %zu is a polyhedron that %s", grid->file,
                      grid->cell_origin != NULL ? grid->cell_origin[cell] : cell, reason);
}

/* Counts what a polyhedron needs and checks that its numbers stand in the file's. */
static cellist_result count_polyhedron(struct splitting *splitting, size_t cell) {
  const struct grid *grid = splitting->grid;
  size_t at = grid->face_starts != NULL ? grid->face_starts[cell] : SIZE_MAX;
  if (at >= grid->face_count) return fail(splitting, cell, "has no faces");
  const size_t face_count = grid->faces[at++];
  size_t corner_count = 0;
  if (face_count < 4) return fail(splitting, cell, "has fewer than four faces");
  for (size_t f = 0; f < face_count; f++) {
    if (at >= grid->face_count || grid->faces[at] > grid->face_count - at - 1)
      return fail(splitting, cell, "goes on beyond the end of the faces");
    const size_t size = grid->faces[at++];
    if (size < 3) return fail(splitting, cell, "has a face of fewer than three points");
    for (size_t k = 0; k < size; k++)
      if (grid->faces[at + k] >= grid->point_count) return fail(splitting, cell, "uses a point that is not there");
    at += size;
    corner_count += size;
    splitting->tet_count += size < FAN_CORNERS ? size - 2 : size;
    if (size < FAN_CORNERS) continue;
    splitting->big_face_count++;
    splitting->big_corner_count += size;
  }
  /* Cells that share their numbers would make many tets of a small file. */
  splitting->numbers += 1 + face_count + corner_count;
  if (splitting->numbers > grid->face_count || grid->face_count >= CELLIST_NONE)
    return fail(splitting, cell, "shares its faces' numbers with another");
  splitting->polyhedron_count++;
  if (face_count > splitting->most_faces) splitting->most_faces = face_count;
  if (corner_count > splitting->most_corners) splitting->most_corners = corner_count;
  return CELLIST_SUCCESS;
}

static int compare_ids(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

static int compare_corners(const struct big_face *a, const struct big_face *b) {
  if (a->size != b->size) return a->size < b->size ? -1 : 1;
  for (size_t k = 0; k < a->size; k++)
    if (a->sorted[k] != b->sorted[k]) return a->sorted[k] < b->sorted[k] ? -1 : 1;
  return 0;
}

static int compare_big_faces(const void *a, const void *b) {
  const struct big_face *x = a, *y = b;
  const int order = compare_corners(x, y);
  return order != 0 ? order : (x->ordinal > y->ordinal) - (x->ordinal < y->ordinal);
}

/* The mean of corners, of positions and of all fields on points, becomes point number at. */
static void add_mean(struct splitting *splitting, const uint32_t *ids, size_t count, size_t at) {
  struct grid *made = &splitting->made;
  for (size_t f = 0; f <= made->field_count; f++) {
    const bool is_field = f < made->field_count;
    if (is_field && made->fields[f].association != CELLIST_ON_POINTS) continue;
    const size_t width = is_field ? made->fields[f].component_count : 3;
    double *values = is_field ? (double *)made->fields[f].values : made->points;
    for (size_t c = 0; c < width; c++) {
      double sum = 0;
      for (size_t k = 0; k < count; k++) sum += values[width * ids[k] + c] / (double)count;
      values[width * at + c] = sum;
    }
  }
}

/* Big faces with the same corners become one group, whose middle is one point. */
static cellist_result group_big_faces(struct splitting *splitting) {
  const struct grid *grid = splitting->grid;
  cellist_context *context = splitting->context;
  struct big_face *faces = cellist_allocate(context, splitting->big_face_count, sizeof *faces);
  uint32_t *pool = cellist_allocate(context, splitting->big_corner_count, sizeof *pool), *to = pool;
  splitting->big_face_point = cellist_allocate(context, splitting->big_face_count, sizeof *splitting->big_face_point);
  if (faces == NULL || pool == NULL || splitting->big_face_point == NULL) {
    cellist_deallocate(context, faces);
    cellist_deallocate(context, pool);
    return CELLIST_ERROR_OUT_OF_MEMORY;
  }
  size_t count = 0;
  for (size_t cell = 0; cell < grid->cell_count; cell++) {
    if (grid->types[cell] != GRID_POLYHEDRON) continue;
    size_t at = grid->face_starts[cell];
    for (size_t left = grid->faces[at++]; left > 0; left--) {
      const size_t size = grid->faces[at++];
      if (size >= FAN_CORNERS) {
        memcpy(to, &grid->faces[at], size * sizeof *to);
        qsort(to, size, sizeof *to, compare_ids);
        faces[count] = (struct big_face){count, size, to};
        count++;
        to += size;
      }
      at += size;
    }
  }
  qsort(faces, count, sizeof *faces, compare_big_faces);
  for (size_t i = 0; i < count; i++) {
    if (i == 0 || compare_corners(&faces[i - 1], &faces[i]) != 0) {
      /* The points stand after the file's and one for each polyhedron. */
      const size_t point = grid->point_count + splitting->polyhedron_count + splitting->group_count++;
      add_mean(splitting, faces[i].sorted, faces[i].size, point);
    }
    splitting->big_face_point[faces[i].ordinal] =
        (uint32_t)(grid->point_count + splitting->polyhedron_count + splitting->group_count - 1);
  }
  cellist_deallocate(context, faces);
  cellist_deallocate(context, pool);
  return CELLIST_SUCCESS;
}

static int compare_edges(const void *a, const void *b) {
  const struct edge *x = a, *y = b;
  if (x->low != y->low) return x->low < y->low ? -1 : 1;
  if (x->high != y->high) return x->high < y->high ? -1 : 1;
  return (x->face > y->face) - (x->face < y->face);
}

/* Turns the cell's faces so that every edge is passed once in each direction, from the first face outwards along
 * shared edges; false if some edge has not exactly two faces, or the surface is in pieces or has one side only. */
static bool orient_faces(struct splitting *splitting, size_t face_count) {
  const uint32_t *stream = splitting->grid->faces;
  struct edge *edges = splitting->edges;
  size_t edge_count = 0;
  for (uint32_t f = 0; f < face_count; f++) {
    const size_t size = stream[splitting->face_at[f] - 1];
    const uint32_t *ids = &stream[splitting->face_at[f]];
    for (size_t k = 0; k < size; k++) {
      const uint32_t a = ids[k], b = ids[(k + 1) % size];
      if (a == b) return false;
      edges[edge_count++] = (struct edge){a < b ? a : b, a < b ? b : a, f, a > b};
    }
  }
  if (edge_count % 2 != 0) return false;
  qsort(edges, edge_count, sizeof *edges, compare_edges);
  for (size_t i = 0; i < edge_count; i += 2) {
    const bool is_pair = edges[i].low == edges[i + 1].low && edges[i].high == edges[i + 1].high;
    const bool is_third = i + 2 < edge_count && edges[i].low == edges[i + 2].low && edges[i].high == edges[i + 2].high;
    if (!is_pair || is_third || edges[i].face == edges[i + 1].face) return false;
  }
  memset(splitting->turn, 0, face_count);
  splitting->turn[0] = 1;
  splitting->queue[0] = 0;
  size_t head = 0, tail = 1;
  while (head < tail) {
    const uint32_t f = splitting->queue[head++];
    const size_t size = stream[splitting->face_at[f] - 1];
    const uint32_t *ids = &stream[splitting->face_at[f]];
    for (size_t k = 0; k < size; k++) {
      const uint32_t a = ids[k], b = ids[(k + 1) % size];
      const struct edge wanted = {a < b ? a : b, a < b ? b : a, f, a > b};
      const struct edge *own = bsearch(&wanted, edges, edge_count, sizeof *edges, compare_edges);
      const struct edge *other = &edges[(size_t)(own - edges) ^ 1]; /* the pair stands together */
      const int8_t turn = (int8_t)(own->is_reversed != other->is_reversed ? splitting->turn[f] : -splitting->turn[f]);
      if (splitting->turn[other->face] == -turn) return false;
      if (splitting->turn[other->face] != 0) continue;
      splitting->turn[other->face] = turn;
      splitting->queue[tail++] = other->face;
    }
  }
  return tail == face_count;
}

static double volume6(const double *points, const uint32_t v[4]) {
  const double *a = &points[3 * (size_t)v[0]], *b = &points[3 * (size_t)v[1]];
  const double *c = &points[3 * (size_t)v[2]], *d = &points[3 * (size_t)v[3]];
  const double x[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, y[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  const double z[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
  return z[0] * (x[1] * y[2] - x[2] * y[1]) + z[1] * (x[2] * y[0] - x[0] * y[2]) + z[2] * (x[0] * y[1] - x[1] * y[0]);
}

/* Appends the tet of a face's triangle (a, b, c), counter-clockwise from outside, and the middle. */
static void add_tet(struct grid *made, size_t *tet, uint32_t a, uint32_t b, uint32_t c, uint32_t middle,
                    bool is_turned) {
  uint32_t *v = &made->connectivity[*tet];
  v[0] = is_turned ? b : a;
  v[1] = is_turned ? a : b;
  v[2] = c;
  v[3] = middle;
  *tet += 4;
}

/* The tets of one polyhedron at made->connectivity[begin...]; ordinal: of the file's big faces so far. */
static cellist_result fill_polyhedron(struct splitting *splitting, size_t cell, uint32_t middle, size_t begin,
                                      size_t *end, size_t *ordinal) {
  struct grid *made = &splitting->made;
  const uint32_t *stream = splitting->grid->faces;
  size_t at = splitting->grid->face_starts[cell];
  const size_t face_count = stream[at++];
  for (size_t f = 0; f < face_count; f++) {
    splitting->face_at[f] = (uint32_t)(at + 1);
    at += 1 + stream[at];
  }
  if (!orient_faces(splitting, face_count)) return fail(splitting, cell, "is not closed");
  *end = begin;
  for (size_t f = 0; f < face_count; f++) {
    const size_t size = stream[splitting->face_at[f] - 1];
    const uint32_t *ids = &stream[splitting->face_at[f]];
    /* A tet with the middle last is positive if its triangle turns clockwise from outside. */
    const bool is_turned = splitting->turn[f] > 0;
    if (size >= FAN_CORNERS) {
      const uint32_t face_middle = splitting->big_face_point[(*ordinal)++];
      for (size_t k = 0; k < size; k++) add_tet(made, end, ids[k], ids[(k + 1) % size], face_middle, middle, is_turned);
      continue;
    }
    size_t first = 0;
    for (size_t k = 1; k < size; k++)
      if (ids[k] < ids[first]) first = k;
    for (size_t k = 1; k + 1 < size; k++)
      add_tet(made, end, ids[first], ids[(first + k) % size], ids[(first + k + 1) % size], middle, is_turned);
  }
  double total = 0, worst = 0;
  for (size_t i = begin; i < *end; i += 4) total += volume6(made->points, &made->connectivity[i]);
  for (size_t i = begin; i < *end; i += 4) {
    uint32_t *v = &made->connectivity[i];
    if (total < 0) { /* the first face was given the wrong way round */
      const uint32_t swap = v[0];
      v[0] = v[1];
      v[1] = swap;
    }
    worst = fmin(worst, volume6(made->points, v));
  }
  return -worst <= DENT_TOLERANCE * fabs(total) ? CELLIST_SUCCESS : fail(splitting, cell, "is not convex");
}

/* Whether the cell is to be left out by grid_to_mesh; *culprit: the corner that says so, or any. */
static bool is_left_out(const struct grid *grid, size_t cell, uint32_t *culprit) {
  size_t at = grid->face_starts[cell];
  size_t left = grid->faces[at++];
  *culprit = grid->faces[at + 1];
  const bool is_hidden = grid->hidden_cells != NULL && grid->hidden_cells[cell];
  for (; left > 0 && !is_hidden; left--)
    for (size_t corners = grid->faces[at++]; corners > 0; corners--, at++) {
      const double *p = &grid->points[3 * (size_t)grid->faces[at]];
      *culprit = grid->faces[at];
      if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]) ||
          (grid->hidden_points != NULL && grid->hidden_points[*culprit]))
        return true;
    }
  return is_hidden;
}

/* All face corners of a cell: its middle is their mean. The edges' memory holds them meanwhile. */
static void add_middle(struct splitting *splitting, size_t cell, size_t point) {
  const uint32_t *stream = splitting->grid->faces;
  size_t at = splitting->grid->face_starts[cell], count = 0;
  uint32_t *corners = (uint32_t *)splitting->edges;
  for (size_t left = stream[at++]; left > 0; left--) {
    const size_t size = stream[at++];
    memcpy(&corners[count], &stream[at], size * sizeof *corners);
    count += size;
    at += size;
  }
  add_mean(splitting, corners, count, point);
}

static cellist_result fill_cells(struct splitting *splitting) {
  const struct grid *grid = splitting->grid;
  struct grid *made = &splitting->made;
  size_t end = 0, ordinal = 0, polyhedron = 0;
  for (size_t cell = 0; cell < grid->cell_count; cell++) {
    const uint32_t origin = grid->cell_origin != NULL ? grid->cell_origin[cell] : (uint32_t)cell;
    const size_t begin = end;
    size_t each = 4;
    uint8_t type = GRID_TETRA;
    uint32_t culprit = 0;
    if (grid->types[cell] != GRID_POLYHEDRON) {
      each = grid->offsets[cell + 1] - grid->offsets[cell];
      type = grid->types[cell];
      if (each > 0) memcpy(&made->connectivity[end], &grid->connectivity[grid->offsets[cell]], each * sizeof(uint32_t));
      end += each;
    } else if (is_left_out(grid, cell, &culprit)) {
      /* One cell, so that one is counted. */
      for (int k = 0; k < 4; k++) made->connectivity[end++] = culprit;
      for (size_t at = grid->face_starts[cell], left = grid->faces[at++]; left > 0; left--) {
        ordinal += grid->faces[at] >= FAN_CORNERS;
        at += 1 + grid->faces[at];
      }
      polyhedron++;
    } else {
      const size_t middle = grid->point_count + polyhedron++;
      add_middle(splitting, cell, middle);
      const cellist_result result = fill_polyhedron(splitting, cell, (uint32_t)middle, begin, &end, &ordinal);
      if (result != CELLIST_SUCCESS) return result;
    }
    const bool is_hidden = grid->hidden_cells != NULL && grid->hidden_cells[cell];
    size_t at = begin;
    do {
      made->types[made->cell_count] = type;
      made->cell_origin[made->cell_count] = origin;
      made->face_starts[made->cell_count] = cell; /* where fields come from, for now */
      if (made->hidden_cells != NULL) made->hidden_cells[made->cell_count] = is_hidden;
      made->offsets[made->cell_count++] = at;
      at += each;
    } while (at < end);
  }
  made->offsets[made->cell_count] = end;
  return CELLIST_SUCCESS;
}

/* Points and their fields with room for the added ones. */
static cellist_result extend_points(struct splitting *splitting, size_t added) {
  struct grid *grid = splitting->grid, *made = &splitting->made;
  cellist_context *context = splitting->context;
  made->file = grid->file;
  made->skipped_cell_count = grid->skipped_cell_count;
  made->point_count = grid->point_count + added;
  if (made->point_count >= CELLIST_NONE)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: has too many points and polyhedra", grid->file);
  made->points = cellist_allocate_zeroed(context, made->point_count, 3 * sizeof *made->points);
  if (made->points == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  memcpy(made->points, grid->points, 3 * grid->point_count * sizeof *made->points);
  if (grid->hidden_points != NULL) {
    made->hidden_points = cellist_allocate_zeroed(context, made->point_count, 1);
    if (made->hidden_points == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    memcpy(made->hidden_points, grid->hidden_points, grid->point_count);
  }
  for (size_t f = 0; f < grid->field_count; f++) {
    cellist_field *field = &grid->fields[f];
    if (field->association != CELLIST_ON_POINTS) continue;
    const size_t size = field->component_count * sizeof(double);
    double *values = cellist_allocate_zeroed(context, made->point_count, size);
    if (values == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    memcpy(values, field->values, grid->point_count * size);
    cellist_deallocate(context, (void *)field->values);
    field->values = values;
  }
  made->fields = grid->fields;
  made->field_count = grid->field_count;
  grid->fields = NULL;
  grid->field_count = 0;
  return CELLIST_SUCCESS;
}

static cellist_result allocate_cells(struct splitting *splitting) {
  const struct grid *grid = splitting->grid;
  cellist_context *context = splitting->context;
  struct grid *made = &splitting->made;
  const size_t most = grid->cell_count + splitting->tet_count;
  made->types = cellist_allocate(context, most, 1);
  made->offsets = cellist_allocate(context, most + 1, sizeof *made->offsets);
  made->connectivity =
      cellist_allocate(context, grid->offsets[grid->cell_count] + 4 * most, sizeof *made->connectivity);
  made->cell_origin = cellist_allocate(context, most, sizeof *made->cell_origin);
  made->face_starts = cellist_allocate(context, most, sizeof *made->face_starts);
  if (grid->hidden_cells != NULL) made->hidden_cells = cellist_allocate(context, most, 1);
  splitting->edges = cellist_allocate(context, splitting->most_corners, sizeof *splitting->edges);
  splitting->face_at = cellist_allocate(context, splitting->most_faces, sizeof *splitting->face_at);
  splitting->turn = cellist_allocate(context, splitting->most_faces, 1);
  splitting->queue = cellist_allocate(context, splitting->most_faces, sizeof *splitting->queue);
  const bool ok = made->types != NULL && made->offsets != NULL && made->connectivity != NULL &&
                  made->cell_origin != NULL && made->face_starts != NULL && splitting->edges != NULL &&
                  splitting->face_at != NULL && splitting->turn != NULL && splitting->queue != NULL &&
                  (grid->hidden_cells == NULL || made->hidden_cells != NULL);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

/* Values on cells go to each of a cell's tets. */
static cellist_result spread_cell_fields(struct splitting *splitting) {
  struct grid *made = &splitting->made;
  for (size_t f = 0; f < made->field_count; f++) {
    cellist_field *field = &made->fields[f];
    if (field->association != CELLIST_ON_CELLS) continue;
    const size_t width = field->component_count;
    double *values = cellist_allocate(splitting->context, made->cell_count, width * sizeof *values);
    if (values == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    for (size_t i = 0; i < made->cell_count; i++)
      memcpy(&values[width * i], &field->values[width * made->face_starts[i]], width * sizeof *values);
    cellist_deallocate(splitting->context, (void *)field->values);
    field->values = values;
  }
  cellist_deallocate(splitting->context, made->face_starts);
  made->face_starts = NULL;
  return CELLIST_SUCCESS;
}

cellist_result grid_split_polyhedra(cellist_context *context, struct grid *grid) {
  struct splitting splitting = {.context = context, .grid = grid};
  cellist_result result = CELLIST_SUCCESS;
  for (size_t cell = 0; cell < grid->cell_count && result == CELLIST_SUCCESS; cell++)
    if (grid->types[cell] == GRID_POLYHEDRON) result = count_polyhedron(&splitting, cell);
  if (result == CELLIST_SUCCESS)
    result = extend_points(&splitting, splitting.polyhedron_count + splitting.big_face_count);
  if (result == CELLIST_SUCCESS) result = allocate_cells(&splitting);
  if (result == CELLIST_SUCCESS) result = group_big_faces(&splitting);
  if (result == CELLIST_SUCCESS) result = fill_cells(&splitting);
  if (result == CELLIST_SUCCESS) result = spread_cell_fields(&splitting);
  cellist_deallocate(context, splitting.big_face_point);
  cellist_deallocate(context, splitting.edges);
  cellist_deallocate(context, splitting.face_at);
  cellist_deallocate(context, splitting.turn);
  cellist_deallocate(context, splitting.queue);
  grid_release(context, grid);
  if (result == CELLIST_SUCCESS) {
    /* Faces that two cells share were counted twice. */
    splitting.made.point_count -= splitting.big_face_count - splitting.group_count;
    *grid = splitting.made;
  } else {
    grid_release(context, &splitting.made);
  }
  return result;
}
