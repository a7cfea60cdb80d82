/* SPDX-License-Identifier: BSD-3-Clause
 * Walk: every boundary face through which the ray's line enters the mesh begins a chain of cells, each left through the
 * one face through which the line leaves it, until a boundary face ends the chain.
 *
 * Why it always ends: the side tests are those of one displaced line (line.h), which enters and leaves each tet at most
 * once. So a chain is a path on which no tet has two predecessors, and its first one has none: it cannot return to a
 * tet, however flawed the mesh, and two chains share no tet. No step is counted and no tolerance is asked.
 *
 * In a sound mesh the chains follow one another. Where two overlap (crushed meshes, folds), their segments are merged
 * by depth: a picture that is finite and repeats, and the ray is counted. The line is followed from minus infinity, and
 * what lies before the near plane, or beyond other limits, is cut off at the end: a camera inside the mesh, on a face
 * or on a vertex is no special case. */
#include "reference_walk.h"

#include <math.h>
#include <string.h>

/* Chains that overlap by less than this share of the largest depth on the ray touch; only the count of fold rays
 * depends on it. Depths carry an error of some 1e-15 of the distance from the eye, more where a face is seen edge-on.
 */
static const double FOLD_TOLERANCE = 1e-10;

/* Three products, two sums and the interpolation along a segment: 8 u. */
static const double SCALAR_ROUNDING = 8 * 0x1p-53;

/* fmax is a call into the mathematical library, an eighth of the walk's time. */
static double larger(double a, double b) { return a > b ? a : b; }

static bool reserve(cellist_context *context, void **block, size_t *capacity, size_t count, size_t size) {
  if (count <= *capacity) return true;
  const size_t wanted = count < 64 ? 64 : 2 * count;
  void *grown = cellist_reallocate(context, *block, *capacity, wanted, size);
  if (grown == NULL) return false;
  *block = grown;
  *capacity = wanted;
  return true;
}

void walk_release(ray_walker *walker) {
  cellist_deallocate(walker->context, walker->entries);
  cellist_deallocate(walker->context, walker->segments);
  walker->entries = NULL;
  walker->segments = NULL;
  walker->entry_capacity = walker->segment_capacity = 0;
}

/* A point where the line passes a face, with what is interpolated there. */
struct crossing {
  double t, t_error, offset, scalar, largest_scalar, gradient[3];
};

static struct crossing cross_face(const ray_walker *walker, const line_point corner[3], const bool is_tie[3]) {
  const line_crossing at = line_cross_face(&walker->line, corner, is_tie);
  struct crossing crossing = {.t = at.depth, .t_error = at.depth_error, .offset = at.offset};
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (int c = 0; c < 3; c++) {
    if (walker->scalar->association == CELLIST_ON_POINTS) {
      const double value = walker->scalar->values[corner[c].id];
      crossing.scalar += at.weight[c] * value;
      least = value < least ? value : least;
      most = value > most ? value : most;
      crossing.largest_scalar = larger(crossing.largest_scalar, fabs(value));
    }
    if (walker->point_gradients != NULL)
      for (int k = 0; k < 3; k++)
        crossing.gradient[k] += at.weight[c] * walker->point_gradients[3 * (size_t)corner[c].id + (size_t)k];
  }
  /* A face of one value has that value: rounding must not put it on either side of an isosurface. */
  if (crossing.scalar < least) crossing.scalar = least;
  if (crossing.scalar > most) crossing.scalar = most;
  return crossing;
}

/* The line's side of a face's three edges if it is the same for all, else 0; corners and ties are filled. -1: the line
 * enters the tet there, 1: it leaves. */
static int face_side(ray_walker *walker, uint32_t face, line_point corner[3], bool is_tie[3]) {
  const uint32_t *tet = &walker->mesh->tets[face / 4 * 4];
  for (int c = 0; c < 3; c++) corner[c] = line_project(&walker->line, tet[CELLIST_TET_FACE[face % 4][c]]);
  const int first = line_side(&walker->line, &corner[0], &corner[1], &is_tie[0]);
  for (int c = 1; c < 3; c++)
    if (first == 0 || line_side(&walker->line, &corner[c], &corner[(c + 1) % 3], &is_tie[c]) != first) return 0;
  return first;
}

static bool collect_entries(void *user, const uint32_t *faces, size_t count) {
  ray_walker *walker = user;
  for (size_t i = 0; i < count; i++) {
    line_point corner[3];
    bool is_tie[3];
    if (face_side(walker, faces[i], corner, is_tie) >= 0) continue;
    if (!reserve(walker->context, (void **)&walker->entries, &walker->entry_capacity, walker->entry_count + 1,
                 sizeof *walker->entries))
      return false;
    walker->entries[walker->entry_count++] = (walk_entry){cross_face(walker, corner, is_tie).t, faces[i]};
  }
  return true;
}

static void sort_entries(walk_entry *entries, size_t count) {
  for (size_t i = 1; i < count; i++) {
    const walk_entry entry = entries[i];
    size_t j = i;
    for (; j > 0 && (entries[j - 1].t > entry.t || (entries[j - 1].t == entry.t && entries[j - 1].face > entry.face));
         j--)
      entries[j] = entries[j - 1];
    entries[j] = entry;
  }
}

/* Values at both ends of a cell's constant or linear fields. */
static void fill_segment(const ray_walker *walker, walk_segment *segment, uint32_t tet, const struct crossing *front,
                         const struct crossing *back) {
  const bool on_cells = walker->scalar->association == CELLIST_ON_CELLS;
  const struct crossing *ends[2] = {front, back};
  segment->tet = tet;
  if (!on_cells) {
    const double slope = walker->slopes != NULL ? (double)walker->slopes[tet] : 0;
    const double largest = larger(front->largest_scalar, back->largest_scalar);
    const double beside = slope * larger(front->offset, back->offset);
    segment->scalar_error = SCALAR_ROUNDING * largest + (beside < 2 * largest ? beside : 2 * largest);
  }
  for (int end = 0; end < 2; end++) {
    segment->t[end] = ends[end]->t;
    segment->t_error[end] = ends[end]->t_error;
    segment->scalar[end] = on_cells ? walker->scalar->values[tet] : ends[end]->scalar;
    if (walker->point_gradients != NULL)
      memcpy(segment->gradient[end], ends[end]->gradient, sizeof ends[end]->gradient);
    if (walker->cell_gradients != NULL)
      memcpy(segment->gradient[end], &walker->cell_gradients[3 * (size_t)tet], sizeof segment->gradient[end]);
  }
}

/* Moves one end of the segment (0: front, 1: back) to where the limit is, between its ends. */
static void cut_end(walk_segment *segment, int end, const walk_limits *limits) {
  const double share = (limits->t[end] - segment->t[0]) / (segment->t[1] - segment->t[0]);
  segment->t[end] = limits->t[end];
  segment->t_error[end] = limits->t_error[end];
  segment->scalar[end] = (1 - share) * segment->scalar[0] + share * segment->scalar[1];
  for (int k = 0; k < 3; k++)
    segment->gradient[end][k] = (1 - share) * segment->gradient[0][k] + share * segment->gradient[1][k];
}

static bool is_drawn(const ray_walker *walker, uint32_t tet) {
  if ((walker->mesh->tet_flags[tet] & CELLIST_TET_FLAT) != 0) return false;
  if (walker->scalar->association == CELLIST_ON_CELLS) return isfinite(walker->scalar->values[tet]);
  const uint32_t *v = &walker->mesh->tets[4 * (size_t)tet];
  const double *s = walker->scalar->values;
  return isfinite(s[v[0]]) && isfinite(s[v[1]]) && isfinite(s[v[2]]) && isfinite(s[v[3]]);
}

static bool add_segment(ray_walker *walker, uint32_t tet, const struct crossing *front, const struct crossing *back,
                        const walk_limits *limits) {
  walker->step_count++;
  if (!(back->t > limits->t[0] && front->t < limits->t[1])) return true;
  walker->ray_steps++;
  if (!(back->t > front->t) || !is_drawn(walker, tet)) return true;
  if (!reserve(walker->context, (void **)&walker->segments, &walker->segment_capacity, walker->segment_count + 1,
               sizeof *walker->segments))
    return false;
  walk_segment *segment = &walker->segments[walker->segment_count++];
  *segment = (walk_segment){0};
  fill_segment(walker, segment, tet, front, back);
  if (segment->t[0] < limits->t[0]) cut_end(segment, 0, limits);
  if (segment->t[1] > limits->t[1]) cut_end(segment, 1, limits);
  if (!(segment->t[1] > segment->t[0])) walker->segment_count--;
  return true;
}

/* The face that the line is passing: corners in the order in which every edge, seen along the line, turns the same way
 * round it (the order outwards for the tet that is left). is_tie[c]: the edge from corner c to the next met the line.
 */
struct passed_face {
  line_point corner[3];
  bool is_tie[3];
};

static uint32_t local_corner(const uint32_t tet[4], uint32_t point) {
  return tet[0] == point ? 0 : tet[1] == point ? 1 : tet[2] == point ? 2 : 3;
}

/* The corner of the tet that its face lacks. */
static uint32_t apex_of(const uint32_t tet[4], const struct passed_face *face) {
  for (uint32_t v = 0; v < 3; v++)
    if (tet[v] != face->corner[0].id && tet[v] != face->corner[1].id && tet[v] != face->corner[2].id) return tet[v];
  return tet[3];
}

/* Passes through a tet: replaces the face by the one through which the line leaves it, which has one edge of the first
 * and the apex. The line leaves where the sides of the two new edges differ as those of a face must. Returns the corner
 * that is not on that face. */
static uint32_t pass_tet(ray_walker *walker, const uint32_t tet[4], struct passed_face *face) {
  const line_point apex = line_project(&walker->line, apex_of(tet, face));
  int side[3];
  bool is_tie[3];
  for (int c = 0; c < 3; c++) side[c] = line_side(&walker->line, &face->corner[c], &apex, &is_tie[c]);
  /* Exactly one of the three edges fits; the last needs no question. */
  int from = 0;
  while (from < 2 && !(side[from] < 0 && side[(from + 1) % 3] > 0)) from++;
  const int to = (from + 1) % 3, lost = (from + 2) % 3;
  const uint32_t lost_id = face->corner[lost].id;
  *face = (struct passed_face){{face->corner[from], face->corner[to], apex},
                               {face->is_tie[from], is_tie[to], is_tie[from]}};
  return local_corner(tet, lost_id);
}

/* Follows one chain; *leaves_at is where it ends. */
static bool walk_chain(ray_walker *walker, uint32_t entry_face, const walk_limits *limits, double *leaves_at) {
  const cellist_mesh_arrays *mesh = walker->mesh;
  struct passed_face face, entry;
  (void)face_side(walker, entry_face, entry.corner, entry.is_tie);
  for (int c = 0; c < 3; c++) { /* outwards for the cell before it, if there were one */
    face.corner[c] = entry.corner[(3 - c) % 3];
    face.is_tie[c] = entry.is_tie[2 - c];
  }
  struct crossing front = cross_face(walker, face.corner, face.is_tie);
  for (uint32_t tet = entry_face / 4, lost; tet != CELLIST_NONE; tet = mesh->neighbours[4 * (size_t)tet + lost]) {
    lost = pass_tet(walker, &mesh->tets[4 * (size_t)tet], &face);
    struct crossing back = cross_face(walker, face.corner, face.is_tie);
    /* Depths never fall along a chain; where rounding says so, on faces seen edge-on, the length is 0. */
    if (!(back.t > front.t)) {
      back.t_error += front.t - back.t;
      back.t = front.t;
    }
    if (!add_segment(walker, tet, &front, &back, limits)) return false;
    front = back;
  }
  *leaves_at = front.t;
  return true;
}

static bool lies_before(const walk_segment *a, const walk_segment *b) {
  const double middle_a = 0.5 * a->t[0] + 0.5 * a->t[1], middle_b = 0.5 * b->t[0] + 0.5 * b->t[1];
  return middle_a < middle_b || (middle_a == middle_b && a->tet < b->tet);
}

/* Merges the segments of one more chain into those of earlier chains that reach beyond its beginning. */
static void merge_chain(walk_segment *segments, size_t chain_begin, size_t count) {
  for (size_t i = chain_begin; i < count; i++) {
    if (i == 0 || !lies_before(&segments[i], &segments[i - 1])) continue;
    const walk_segment moved = segments[i];
    size_t j = i;
    for (; j > 0 && lies_before(&moved, &segments[j - 1]); j--) segments[j] = segments[j - 1];
    segments[j] = moved;
  }
}

bool walk_ray(ray_walker *walker, const double origin[3], const double direction[3], const walk_limits *limits) {
  walker->entry_count = walker->segment_count = 0;
  walker->ray_steps = 0;
  line_begin(&walker->line, walker->mesh->positions, walker->mesh->bounds, origin, direction);
  if (!hierarchy_query(walker->hierarchy, origin, direction, collect_entries, walker)) return false;
  sort_entries(walker->entries, walker->entry_count);
  double reached = -HUGE_VAL;
  bool folds = false;
  for (size_t i = 0; i < walker->entry_count; i++) {
    const double enters_at = walker->entries[i].t;
    const size_t chain_begin = walker->segment_count;
    double leaves_at = enters_at;
    if (!walk_chain(walker, walker->entries[i].face, limits, &leaves_at)) return false;
    if (enters_at < reached) {
      merge_chain(walker->segments, chain_begin, walker->segment_count);
      const double tolerance = FOLD_TOLERANCE * fmax(fabs(enters_at), fmax(fabs(reached), fabs(leaves_at)));
      folds = folds || fmin(reached, leaves_at) - enters_at > tolerance;
    }
    reached = fmax(reached, leaves_at);
  }
  walker->ray_count += walker->entry_count > 0;
  walker->total_entries += walker->entry_count;
  walker->fold_ray_count += folds;
  walker->retry_count += walker->line.retry_count;
  return true;
}
