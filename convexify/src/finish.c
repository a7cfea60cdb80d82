/* SPDX-License-Identifier: BSD-3-Clause
 * Finish: checks what was made and hands it over as a complex. Between two cells all facets of a plane become one
 * polygon (the meet of two convex polygons is convex, so one loop remains once inner edges cancel; anything else is an
 * error, never a wrong complex). */
#include "work.h"

/* Facets between two reports: a few milliseconds. */
enum { PROGRESS_FACETS = 4096 };

typedef struct facet_key {
  uint32_t low, high, plane, facet;
} facet_key;

static int compare_facet_keys(const void *a, const void *b) {
  const uint32_t *x = a, *y = b;
  for (int i = 0; i < 4; i++)
    if (x[i] != y[i]) return x[i] < y[i] ? -1 : 1;
  return 0;
}

/* Edges at which an imaginary cell is reflex: those that count as flat, and violations. */
static void count_violations(work *w) {
  double largest = 0;
  w->stats.convexity_violations = w->stats.flat_edges = 0;
  for (size_t f = 0; f < w->facets.count; f++)
    for (int side = 0; side < 2; side++) {
      const uint32_t cell = w->facets.items[f].cells[side];
      if (!is_piece(w, cell)) continue;
      for (EACH_USE(w, u, f)) {
        const work_event mate = sector_mate(w, u, side);
        const work_event own = {u, (uint32_t)f, (uint8_t)side, w->uses.items[u].forward ? 1 : -1, !mate.closing};
        if (!mate.closing) continue;
        if (sector_angle(w, w->uses.items[u].edge, &own, &mate) >= 0) continue;
        const double angle = w->flat > 0 ? flat_angle(w, &own, &mate) : PI;
        if (angle <= w->flat) {
          w->stats.flat_edges++;
          largest = fmax(largest, angle);
        } else {
          w->stats.convexity_violations++;
        }
      }
    }
  w->stats.flat_angle = largest;
}

/* Numbers the pieces that are still in use. */
static void number_pieces(work *w, id_list *number, size_t *count) {
  work_reserve(w, number, w->pieces.count + 1, sizeof *number->items);
  memset(number->items, 0xff, w->pieces.count * sizeof *number->items);
  for (size_t f = 0; f < w->facets.count; f++)
    for (int side = 0; side < 2; side++) {
      const uint32_t cell = w->facets.items[f].cells[side];
      if (is_piece(w, cell)) number->items[cell - w->mesh->tet_count] = 0;
    }
  *count = 0;
  for (size_t p = 0; p < w->pieces.count; p++)
    if (number->items[p] == 0) number->items[p] = (uint32_t)(*count)++;
}

static uint32_t numbered(const work *w, const id_list *number, uint32_t cell) {
  return is_piece(w, cell) ? piece_cell(w, number->items[cell - w->mesh->tet_count]) : cell;
}

static void add_contacts(work *w) {
  for (size_t i = 0; i < w->contacts.count; i += 5) {
    const uint32_t *contact = &w->contacts.items[i];
    const uint32_t plane = exact_add_plane(w, contact[2], contact[3], contact[4]);
    if (plane == CELLIST_NONE) continue; /* no area: nothing passes through it */
    const uint32_t facet = work_add_facet(w, plane, contact[1], contact[0]);
    for (int k = 0; k < 3; k++) {
      const uint32_t a = contact[2 + k], b = contact[2 + (k + 1) % 3];
      work_add_use(w, facet, work_add_edge(w, a, b, a, b, true), true);
    }
  }
}

_Noreturn static void fail_polygon(work *w, uint32_t a, uint32_t b) {
  if (w->flat > 0) {
    w->retry_without_it = true;
    work_fail(w, CELLIST_ERROR_GEOMETRY);
  }
  work_stop(w, CELLIST_ERROR_GEOMETRY, "convexify: cells %u and %u of the complex do not meet in one polygon", a, b);
}

/* w->hits: from, to of each edge of the group's outline, counter-clockwise about the plane. */
static void gather_outline(work *w, const facet_key *keys, size_t count, uint32_t plane) {
  id_list *hits = &w->hits;
  hits->count = 0;
  for (size_t i = 0; i < count; i++) {
    const uint32_t facet = keys[i].facet, own = w->facets.items[facet].plane;
    const bool same = own == plane || exact_same_direction(w, own, plane) > 0;
    for (EACH_USE(w, u, facet)) {
      const uint32_t *v = w->edges.items[w->uses.items[u].edge].v;
      const bool forward = w->uses.items[u].forward == same;
      const uint32_t from = v[forward ? 0 : 1], to = v[forward ? 1 : 0];
      size_t j = 0;
      while (j < hits->count && (hits->items[j] != to || hits->items[j + 1] != from)) j += 2;
      if (j < hits->count) { /* used both ways: inside the polygon */
        hits->items[j] = hits->items[hits->count - 2];
        hits->items[j + 1] = hits->items[hits->count - 1];
        hits->count -= 2;
      } else {
        list_push(w, hits, from);
        list_push(w, hits, to);
      }
    }
  }
  if (hits->count < 6) fail_polygon(w, keys->low, keys->high);
}

/* w->sorted: the corners of the group's one polygon. */
static void trace_polygon(work *w, const facet_key *keys) {
  const id_list *hits = &w->hits;
  w->sorted.count = 0;
  uint32_t at = hits->items[0];
  do {
    list_push(w, &w->sorted, at);
    size_t j = 0;
    while (j < hits->count && hits->items[j] != at) j += 2;
    if (j == hits->count || w->sorted.count > hits->count / 2) fail_polygon(w, keys->low, keys->high);
    at = hits->items[j + 1];
  } while (at != hits->items[0]);
  if (w->sorted.count != hits->count / 2) fail_polygon(w, keys->low, keys->high);
}

static double polygon_volume(const work *w, const uint32_t *corners, size_t count) {
  double volume = 0;
  const double *o = w->vertices.items[corners[0]].p;
  for (size_t i = 1; i + 1 < count; i++) {
    const double *p = w->vertices.items[corners[i]].p, *q = w->vertices.items[corners[i + 1]].p;
    for (int k = 0; k < 3; k++) {
      const int j = (k + 1) % 3, l = (k + 2) % 3;
      volume += o[k] * (p[j] * q[l] - p[l] * q[j]);
    }
  }
  return volume / 6;
}

/* What finish() numbers and sums. */
typedef struct numbering {
  id_list *pieces, *planes, *vertices; /* new numbers, or CELLIST_NONE */
  double *volumes;                     /* of the imaginary cells */
} numbering;

static uint32_t vertex_number(work *w, const numbering *n, uint32_t v) {
  uint32_t *number = &n->vertices->items[v];
  if (*number != CELLIST_NONE) return *number;
  *number = (uint32_t)(w->out.vertices.count / 3);
  double p[3];
  exact_position(w, v, p);
  for (int k = 0; k < 3; k++) list_push(w, &w->out.vertices, p[k]);
  return *number;
}

/* The polygon with the corners w->sorted, in a facet's plane and between its cells. */
static void put_polygon(work *w, const numbering *n, uint32_t facet) {
  output *out = &w->out;
  const work_facet *f = &w->facets.items[facet];
  const work_plane *plane = &w->planes.items[f->plane];
  const uint32_t cells[2] = {numbered(w, n->pieces, f->cells[0]), numbered(w, n->pieces, f->cells[1])};
  uint32_t *plane_number = &n->planes->items[f->plane];
  if (*plane_number == CELLIST_NONE) {
    *plane_number = (uint32_t)(out->planes.count / 3);
    const bool spanned = plane->ids[0] != CELLIST_NONE;
    for (int k = 0; k < 3; k++)
      list_push(w, &out->planes, spanned ? w->vertices.items[plane->ids[k]].point : plane->ids[k]);
  }
  list_push(w, &out->facet_planes, *plane_number);
  const double volume = polygon_volume(w, w->sorted.items, w->sorted.count);
  for (int side = 0; side < 2; side++) {
    list_push(w, &out->cells, cells[side]);
    if (is_piece(w, cells[side])) n->volumes[cells[side] - w->mesh->tet_count] += side == 0 ? -volume : volume;
  }
  for (size_t i = 0; i < w->sorted.count; i++) {
    const uint32_t corner = vertex_number(w, n, w->sorted.items[i]);
    list_push(w, &out->corners, corner);
  }
  list_push(w, &out->starts, (uint32_t)out->corners.count);
}

static bool same_side(work *w, const facet_key *a, const facet_key *b) {
  const work_facet *f = &w->facets.items[a->facet], *g = &w->facets.items[b->facet];
  if (!exact_same_plane(w, f->plane, g->plane)) return false;
  return (f->cells[0] == g->cells[0]) == (exact_same_direction(w, f->plane, g->plane) > 0);
}

/* With a tolerance two cells may meet in several planes, and in several polygons of one plane. */
static void put_polygons(work *w, const numbering *n, facet_key *keys, size_t count) {
  for (size_t begin = 0, end; begin < count; begin = end) {
    end = begin + 1;
    for (size_t i = end; i < count; i++) {
      if (!same_side(w, &keys[begin], &keys[i])) continue;
      const facet_key swap = keys[end];
      keys[end++] = keys[i];
      keys[i] = swap;
    }
    const uint32_t plane = w->facets.items[keys[begin].facet].plane;
    gather_outline(w, &keys[begin], end - begin, plane);
    w->cap_uses.count = 0;
    for (size_t i = 0; i < w->hits.count; i += 2)
      list_push(
          w, &w->cap_uses,
          (cap_use){.edge = (uint32_t)i, .from = w->hits.items[i], .to = w->hits.items[i + 1], .loop = CELLIST_NONE});
    regions_find(w, plane);
    for (size_t i = 0; i < w->cap_loops.count; i++) {
      const cap_loop *loop = &w->cap_loops.items[i];
      if (loop->hole) fail_polygon(w, keys->low, keys->high);
      w->sorted.count = 0;
      uint32_t use = loop->first;
      do list_push(w, &w->sorted, w->cap_uses.items[use].from);
      while ((use = w->cap_uses.items[use].next) != loop->first);
      put_polygon(w, n, keys[begin].facet);
    }
  }
}

static double cubed_unit(const work *w) { return ldexp(1, 3 * w->shift); }

static void measure_mesh(work *w) {
  const cellist_mesh_arrays *mesh = w->mesh;
  long double sum = 0;
  for (size_t t = 0; t < mesh->tet_count; t++) {
    double e[3][3];
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < 3; k++)
        e[c][k] = ldexp(mesh->positions[3 * (size_t)mesh->tets[4 * t + 1 + (size_t)c] + (size_t)k] -
                            mesh->positions[3 * (size_t)mesh->tets[4 * t] + (size_t)k],
                        -w->shift);
    double volume = 0;
    for (int k = 0; k < 3; k++) {
      const int j = (k + 1) % 3, l = (k + 2) % 3;
      volume += e[0][k] * (e[1][j] * e[2][l] - e[1][l] * e[2][j]);
    }
    sum += volume / 6;
  }
  w->stats.mesh_volume = (double)sum;
  w->sorted.count = 0;
  for (size_t t = 0; t < w->hull.count; t++)
    for (int k = 0; k < 3; k++) list_push(w, &w->sorted, w->hull.items[t].v[k]);
  w->stats.hull_volume = exact_volume(w, w->sorted.items, w->hull.count);
}

/* The largest distance of a vertex of an imaginary cell beyond one of its facets' planes, in the mesh's unit. */
static double measure_overhang(work *w) {
  double most = 0, diagonal;
  for (size_t p = 0; p < w->pieces.count && w->stats.flat_edges > 0; p++) {
    set_list(w, (uint32_t)p, SET_MEMBERS, &w->sorted);
    if (w->sorted.count > 0 && w->pieces.items[p].flat.live > 0)
      most = fmax(most, flat_overhang(w, w->sorted.items, w->sorted.count, &diagonal));
  }
  return ldexp(most, w->shift);
}

static void sum_up(work *w, const double *volumes, size_t count) {
  measure_mesh(w);
  long double sum = 0;
  for (size_t i = 0; i < count; i++) sum += volumes[i];
  cellist_convexify_stats *stats = &w->stats;
  stats->imaginary_volume = (double)sum;
  stats->volume_error =
      stats->hull_volume > 0 ? fabs((double)(sum - (stats->hull_volume - stats->mesh_volume))) / stats->hull_volume : 0;
  stats->hull_volume *= cubed_unit(w);
  stats->mesh_volume *= cubed_unit(w);
  stats->imaginary_volume *= cubed_unit(w);
  stats->imaginary_cells = count;
  stats->facets = w->out.facet_planes.count;
  stats->planes = w->out.planes.count / 3;
}

/* The facets of each pair of cells, pair by pair; a facet that was merged away is none. Returns how many. */
static size_t sort_facets(work *w, const id_list *number, facet_key *keys) {
  size_t count = 0;
  for (size_t f = 0; f < w->facets.count; f++) {
    const uint32_t a = numbered(w, number, w->facets.items[f].cells[0]),
                   b = numbered(w, number, w->facets.items[f].cells[1]);
    if (a == b) continue;
    /* Two convex cells meet in one plane, whatever its number; the outside is no cell. */
    const bool outer = a == CELLIST_NONE || b == CELLIST_NONE;
    keys[count++] = (facet_key){a < b ? a : b, a < b ? b : a, outer ? w->facets.items[f].plane : 0, (uint32_t)f};
  }
  qsort(keys, count, sizeof *keys, compare_facet_keys);
  return count;
}

void finish(work *w, cellist_complex **complex) {
  count_violations(w);
  const double overhang = measure_overhang(w);
  add_contacts(w);
  size_t imaginary_count = 0;
  numbering n = {&w->ids, &w->touched, &w->split, NULL};
  number_pieces(w, n.pieces, &imaginary_count);
  work_reserve(w, n.planes, w->planes.count + 1, sizeof(uint32_t));
  work_reserve(w, n.vertices, w->vertices.count + 1, sizeof(uint32_t));
  memset(n.planes->items, 0xff, w->planes.count * sizeof(uint32_t));
  memset(n.vertices->items, 0xff, w->vertices.count * sizeof(uint32_t));
  work_reserve(w, &w->box_scratch, imaginary_count, sizeof(double));
  n.volumes = w->box_scratch.items;
  for (size_t i = 0; i < imaginary_count; i++) n.volumes[i] = 0;

  facet_key *keys = work_block(w, w->facets.count, sizeof *keys);
  const size_t count = sort_facets(w, n.pieces, keys);
  output *out = &w->out;
  list_push(w, &out->starts, 0);
  size_t reported = 0;
  for (size_t begin = 0, end; begin < count; begin = end) {
    if (begin >= reported) {
      work_progress(w, PROGRESS_FINISH, PROGRESS_END, (double)begin / (double)count);
      reported = begin + PROGRESS_FACETS;
    }
    for (end = begin + 1; end < count && memcmp(&keys[begin], &keys[end], 3 * sizeof(uint32_t)) == 0; end++) {
    }
    if (w->stats.flat_edges > 0) {
      put_polygons(w, &n, &keys[begin], end - begin);
      continue;
    }
    gather_outline(w, &keys[begin], end - begin, w->facets.items[keys[begin].facet].plane);
    trace_polygon(w, &keys[begin]);
    put_polygon(w, &n, keys[begin].facet);
  }
  sum_up(w, n.volumes, imaginary_count);

  for (size_t i = 0; i < 3 * w->mesh->point_count; i++) list_push(w, &out->points, w->mesh->positions[i]);
  for (size_t i = 0; i < w->added_points.count; i++) list_push(w, &out->points, w->added_points.items[i]);
  const cellist_complex_arrays arrays = {.tet_count = w->mesh->tet_count,
                                         .cell_count = w->mesh->tet_count + imaginary_count,
                                         .point_count = out->points.count / 3,
                                         .points = out->points.items,
                                         .offset_count = w->offsets.count,
                                         .offsets = w->offsets.items,
                                         .plane_count = out->planes.count / 3,
                                         .planes = out->planes.items,
                                         .facet_count = out->facet_planes.count,
                                         .facet_planes = out->facet_planes.items,
                                         .facet_cells = out->cells.items,
                                         .facet_starts = out->starts.items,
                                         .facet_vertices = out->corners.items,
                                         .flat_angle = w->stats.flat_angle,
                                         .flat_distance = overhang,
                                         .vertex_count = out->vertices.count / 3,
                                         .vertices = out->vertices.items};
  w->stats.flat_angle *= 180 / PI * (1 + 0x1p-50);
  w->stats.flat_distance = overhang;
  const cellist_result result = cellist_complex_create(w->context, &arrays, complex);
  if (result != CELLIST_SUCCESS) work_fail(w, result);
}
