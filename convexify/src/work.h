/* SPDX-License-Identifier: BSD-3-Clause
 * Work: the state of one convexification, shared by convexify's own files. Private to the folder.
 *
 * The exterior is a set of pieces, each bounded by facets. A facet lies in a plane and is an unordered set of directed
 * edge uses, counter-clockwise seen from the plane's positive side; holes and slits need no special case. It has a cell
 * on either side: a tet, a piece (tet_count + its index) or CELLIST_NONE, outside. Edges and vertices are shared by
 * all facets that touch them, so the whole stays conforming: an edge split once is split for everyone.
 *
 * Failure (no memory, cancelled, inconsistent input) leaves by longjmp to the one entry that owns the work and frees
 * it: every block hangs on the work, so nothing leaks, and the geometry reads as geometry. No C++ frame is ever
 * crossed. */
#ifndef CELLIST_CONVEXIFY_WORK_H
#define CELLIST_CONVEXIFY_WORK_H

#include <base/random.h>
#include <base/wide.h>
#include <cellist/complex.h>
#include <cellist/convexify.h>
#include <setjmp.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

#define LIST(type)          \
  struct {                  \
    type *items;            \
    size_t count, capacity; \
  }

typedef LIST(uint32_t) id_list;
typedef LIST(double) double_list;
typedef LIST(uint64_t) key_list;

/* An exact integer in the pool of limbs: sign times the number of limbs, and where they begin. */
typedef struct exact_number {
  int32_t length;
  uint32_t offset;
} exact_number;

/* n.x + d, exact in integers and rounded in the work's own unit; positive on the side that orient3d calls positive. */
typedef struct work_plane {
  double normal[3], offset;
  exact_number exact[4];
  uint32_t ids[3]; /* vertices (all of them points), or CELLIST_NONE, axis, index of the offset */
  uint32_t choice; /* the last choice in which it competed */
} work_plane;

/* A point of the input, or a meet: exact as x y z over w > 0, and rounded, relative to the work's origin. */
typedef struct work_vertex {
  double p[3];
  exact_number exact[4];
  uint32_t point; /* id among the complex's points, or CELLIST_NONE */
  uint32_t stamp; /* the cut for which sign holds */
  uint32_t visited;
  int8_t sign;
} work_vertex;

typedef struct work_edge {
  uint32_t v[2];
  uint32_t first_use;
  uint32_t line[2]; /* two vertices that are points, or two planes */
  uint32_t stamp;
  uint32_t visited;
  uint32_t reflex_cell; /* the piece that is reflex here, as a cell, or CELLIST_NONE */
  bool line_is_points;
  bool is_flat; /* reflex, but counts as flat: see flat.c */
} work_edge;

typedef struct work_use {
  uint32_t edge, facet, next_in_edge, next_in_facet;
  bool forward; /* from v[0] to v[1] */
} work_use;

typedef struct work_facet {
  uint32_t plane, first_use;
  uint32_t cells[2]; /* on the plane's positive side, on its negative one */
  uint32_t shell;    /* the inward shell it belongs to, from 1; 0: none */
  uint32_t mark[2];  /* per side: component of the search with this facet's stamp */
  uint32_t stamp[2];
} work_facet;

/* A tree of boxes over a run of a set's items. */
typedef struct work_segment {
  uint32_t count, boxes; /* items; where its nodes' boxes begin */
} work_segment;

/* See set.c. Items that now belong to another piece stay until they are met; live counts the others. */
typedef struct work_set {
  id_list items;
  LIST(work_segment) segments;
  double_list boxes;
  size_t live;
} work_set;

typedef struct work_piece {
  work_set members; /* 2 facet + side */
  work_set reflex;  /* edges */
  work_set flat;    /* those that count as flat */
  id_list shells;   /* inward shells not yet joined to the rest: a member of each */
} work_piece;

/* One use of an edge by a facet that has the cell in question on the given side. */
typedef struct work_event {
  uint32_t use, facet;
  uint8_t side;
  int8_t direction;
  bool closing; /* turning counter-clockwise about the edge, the cell ends here; else it begins */
} work_event;

typedef struct cap_use {
  uint32_t edge, from, to, next, loop;
  uint32_t use; /* of a facet that falls apart */
  bool forward;
} cap_use;

typedef struct cap_loop {
  uint32_t first, outer, top, facet;
  double area;
  bool hole;
} cap_loop;

typedef struct search_component {
  uint32_t parent, pending, done_first, done_last, count, pending_last;
  int sign;
  bool finished;
} search_component;

typedef struct search_part {
  int sign; /* the side of the cut */
  uint32_t piece;
} search_part;

typedef struct search_node {
  uint32_t member, next;
} search_node;

typedef struct boundary_face {
  uint32_t v[3]; /* vertices, counter-clockwise from outside the tet */
  uint32_t tet;
  uint32_t plane;
} boundary_face;

typedef struct hull_face {
  uint32_t v[3]; /* vertices, counter-clockwise from outside */
  uint32_t plane;
} hull_face;

/* What lies on the hull's sides: see exterior.c. */
typedef struct hull_sides {
  key_list on;    /* vertex << 32 | plane, sorted: every vertex on every hull side */
  id_list start;  /* per vertex, into on */
  key_list chain; /* plane << 32 | edge << 1 | backward: the sides' chains of edges, to be summed */
  key_list by_plane;
} hull_sides;

/* The arrays of the complex to be. */
typedef struct output {
  double_list points, vertices;
  id_list planes, facet_planes, cells, starts, corners;
} output;

typedef struct work {
  cellist_context *context;
  jmp_buf failed;
  cellist_result result;
  const cellist_mesh_arrays *mesh;
  cellist_convexify_desc desc;
  random_state random;
  double flat;           /* radians up to which a reflex edge counts as flat; 0: none */
  bool retry_without_it; /* what it leaves is no complex */
  double progress;       /* reported so far, in per cent */
  size_t reflex_count;   /* edges at which some piece is reflex and does not count as flat */

  /* exact.c: lengths are integers times 2^base, and doubles times 2^-shift, both from the origin. 2^shift is the first
   * power of two above half of the extent. */
  int base, shift;
  double origin[3];
  LIST(uint64_t) limbs;
  LIST(work_plane) planes;
  LIST(work_vertex) vertices;
  LIST(double) offsets;
  wide scratch[24];

  /* boundary.c */
  LIST(double) added_points;
  id_list point_vertex; /* per mesh point: its vertex, or CELLIST_NONE */
  LIST(boundary_face) boundary;
  id_list contacts; /* tet, tet, 3 vertices counter-clockwise from outside the first */
  LIST(hull_face) hull;

  LIST(work_edge) edges;
  LIST(work_use) uses;
  LIST(work_facet) facets;
  LIST(work_piece) pieces;
  id_list edge_table;                       /* hash of input edges by their end points */
  id_list input_reflex_start, input_reflex; /* per input vertex: other ends of reflex input edges */

  /* scratch of one cut */
  uint32_t epoch, epoch_edges, choices;
  id_list touched, ids, split, on_plane, zeros, near, set_order;
  double_list set_boxes;
  LIST(work_event) events;
  LIST(cap_use) cap_uses;
  LIST(cap_loop) cap_loops;
  int cap_axis, cap_sign; /* the projection in which turns are taken, and its sense */
  id_list cap_facets;
  LIST(search_component) components;
  LIST(search_node) nodes;
  LIST(search_part) parts;
  id_list sorted;
  id_list hits;
  double_list box_scratch, node_scratch;
  hull_sides sides;
  void *block_scratch;    /* work_block */
  uint32_t *side_scratch; /* per boundary face: its hull side */

  struct delaunay *delaunay;
  output out;
  cellist_convexify_stats stats;
} work;

/* Leaves to the owner of the work with this result; the context has the message. */
_Noreturn void work_fail(work *w, cellist_result result);
/* The same with a message, as for printf. */
#define work_stop(w, result, ...) (cellist_fail((w)->context, result, __VA_ARGS__), work_fail(w, result))

/* Reports a stage (below) as done to this fraction; leaves with CANCELLED if the caller wants no more. */
enum { PROGRESS_BOUNDARY = 0, PROGRESS_CUT = 15, PROGRESS_MERGE = 80, PROGRESS_FINISH = 90, PROGRESS_END = 100 };
void work_progress(work *w, int from, int to, double fraction);

/* Room for count items; the new ones are undefined. */
void work_reserve(work *w, void *list, size_t count, size_t size);
/* The one temporary block, which a failure frees with the work; and its end. */
void *work_block(work *w, size_t count, size_t size);
void work_block_end(work *w);
#define list_push(w, list, ...)                                                                                     \
  (((list)->count == (list)->capacity ? work_reserve(w, list, (list)->count + 1, sizeof *(list)->items) : (void)0), \
   (list)->items[(list)->count++] = (__VA_ARGS__))
void work_release(work *w);

/* The uses u of a facet, for(...). */
#define EACH_USE(w, u, facet)                      \
  uint32_t u = (w)->facets.items[facet].first_use; \
  u != CELLIST_NONE;                               \
  u = (w)->uses.items[u].next_in_facet

/* Pieces are cells behind the tets. */
static inline uint32_t piece_cell(const work *w, size_t piece) { return (uint32_t)(w->mesh->tet_count + piece); }
static inline bool is_piece(const work *w, uint32_t cell) { return cell != CELLIST_NONE && cell >= w->mesh->tet_count; }
static inline work_piece *piece_of(work *w, uint32_t cell) { return &w->pieces.items[cell - w->mesh->tet_count]; }

static inline uint64_t work_mix(uint64_t h) {
  h ^= h >> 31;
  h *= 0x9e3779b97f4a7c15u;
  return h ^ h >> 29;
}

/* Sorts three ids; whether that took an odd number of swaps. */
static inline bool work_sort3(uint32_t v[3]) {
  bool odd = false;
  for (int pass = 0; pass < 3; pass++) {
    const int i = pass % 2;
    if (v[i] <= v[i + 1]) continue;
    const uint32_t swap = v[i];
    v[i] = v[i + 1];
    v[i + 1] = swap;
    odd = !odd;
  }
  return odd;
}

/* For qsort: by the first three ids that are there. */
int work_compare3(const void *a, const void *b);

/* ---- exact.c ------------------------------------------------------------------------------------- */

/* Chooses origin and units for coordinates within bounds with this lowest exponent. */
void exact_begin(work *w, const double bounds[6], int lowest_exponent);
uint32_t exact_add_point(work *w, const double position[3], uint32_t point);
/* CELLIST_NONE if the three are on one line. */
uint32_t exact_add_plane(work *w, uint32_t a, uint32_t b, uint32_t c);
uint32_t exact_add_axis_plane(work *w, uint32_t axis, double offset);
/* Where a line (through two points, or of two planes) meets a plane that it crosses. */
uint32_t exact_add_meet(work *w, const work_edge *line, uint32_t plane);
int exact_side(work *w, uint32_t vertex, uint32_t plane);
/* Sign of a's coordinate minus b's; of the first that differs in x, y, z. */
int exact_compare_axis(work *w, uint32_t a, uint32_t b, int axis);
int exact_compare(work *w, uint32_t a, uint32_t b);
/* Sign of component k of the cross product of two planes' normals. */
int exact_cross(work *w, uint32_t plane_a, uint32_t plane_b, int k);
/* That component, to a few units in the last place. */
double exact_cross_value(work *w, uint32_t plane_a, uint32_t plane_b, int k);
/* n.x + d at the vertex, likewise: the distance times the rounded normal's length. */
double exact_height(work *w, uint32_t vertex, uint32_t plane);
/* Whether two plane records are of one plane. */
bool exact_same_plane(work *w, uint32_t plane_a, uint32_t plane_b);
/* For planes known to be parallel: whether their normals agree (1) or oppose (-1). */
int exact_same_direction(const work *w, uint32_t plane_a, uint32_t plane_b);
/* Sign of the volume between the origin and these triangles: 3 vertices each, all points. */
int exact_volume_sign(work *w, const uint32_t *triangles, size_t count);
/* That volume, rounded, in the work's unit cubed: the same however a flat side is split into triangles. */
double exact_volume(work *w, const uint32_t *triangles, size_t count);
/* The turn a, b, q with the axis left out. */
int exact_turn(work *w, int axis, uint32_t a, uint32_t b, uint32_t q);
/* Seen along (1024, shear[0], shear[1]): sign of the turn a, b, q; sign of a's height minus q's; where the line meets.
 */
int exact_sheared_turn(work *w, const int shear[2], uint32_t a, uint32_t b, uint32_t q);
int exact_sheared_compare(work *w, const int shear[2], uint32_t a, uint32_t q);
int exact_plane_along(work *w, const int shear[2], uint32_t plane);
/* The coordinates of a vertex: as given if it is a point, else rounded. */
void exact_position(const work *w, uint32_t vertex, double position[3]);
/* Of a vertex that is a point. */
const double *exact_point(const work *w, uint32_t vertex);

/* Forward error of n.x + d on rounded coefficients, as a part of the sum of the terms' magnitudes: a coefficient is off
 * by 2 U, a vertex by 5 U (two conversions, one division), each term by 1 more, the sums by 3: 11. */
#define SIDE_BOUND (16 * 0x1p-53)

/* Offsets that convexify itself chooses (boxes, grids) are multiples of the extent's power of two less these bits. */
enum { ADDED_BITS = 12 };
/* TetGen's own points likewise. */
enum { MESHER_BITS = 45 };

/* ---- boundary.c, embedded.c, hull.c: what encloses the exterior --------------------------------------------- */

/* The mesh's boundary faces on vertices that are points, equal points merged, faces in contact paired. */
void boundary_gather(work *w);
/* Fails with GEOMETRY, naming cells, if boundary faces cross or touch other than at shared vertices and edges. */
void boundary_check_embedded(work *w);
void hull_gather(work *w);
void box_gather(work *w);

/* ---- exterior.c: facets and pieces of the uncut exterior ---------------------------------------------------- */

void exterior_build(work *w);
/* The edge between two points, made at its first use; *forward: from a to b. */
uint32_t work_point_edge(work *w, uint32_t a, uint32_t b, bool *forward);
uint32_t work_add_edge(work *w, uint32_t a, uint32_t b, uint32_t line_a, uint32_t line_b, bool line_is_points);
uint32_t work_add_facet(work *w, uint32_t plane, uint32_t front, uint32_t back);
void work_add_use(work *w, uint32_t facet, uint32_t edge, bool forward);
/* Both for an edge between points, from a to b. */
void work_use_points(work *w, uint32_t facet, uint32_t a, uint32_t b);
uint32_t work_add_piece(work *w);

/* ---- delaunay.c: the exterior as TetGen's tets, checked; false: none that holds, nothing changed ---------------- */

bool delaunay_build(work *w);
void delaunay_release_work(work *w);

/* ---- sectors.c: what is around an edge ------------------------------------------------------------------------ */

/* Sign of the turn from plane a's normal to plane b's about the edge's direction. */
int sector_turn(work *w, uint32_t edge, uint32_t plane_a, uint32_t plane_b);
/* Fills w->events with the cell's events at the edge, in counter-clockwise order, a begin first if there are any. */
void sectors_gather(work *w, uint32_t edge, uint32_t cell);
/* The event of the same sector as this use's side. */
work_event sector_mate(work *w, uint32_t use, int side);
/* -1: the sector between the two is above 180 degrees; 0: equal; 1: below. begin opens and end closes it. */
int sector_angle(work *w, uint32_t edge, const work_event *begin, const work_event *end);
/* The piece that is reflex at the edge, as a cell, or CELLIST_NONE. */
uint32_t sector_reflex_cell(work *w, uint32_t edge);

/* Gives the edge to the piece (as a cell) that is reflex there now, if that has changed. */
void edge_own(work *w, uint32_t edge, uint32_t cell);

/* ---- flat.c: a tolerance --------------------------------------------------------------------------------------- */

/* By how much the sector of two events exceeds 180 degrees, in radians, rounded up; pi where it is 90 or more. */
double flat_angle(work *w, const work_event *begin, const work_event *end);
/* Whether all reflex sectors of the cell at the edge count as flat. */
bool flat_edge(work *w, uint32_t edge, uint32_t cell);
/* How far a vertex of these members stands beyond the plane of one of them, at most, rounded up; the diagonal of their
 * box; both in the work's unit. */
double flat_overhang(work *w, const uint32_t *members, size_t count, double *diagonal);
/* Whether that is little enough to leave a piece as it is. */
bool flat_enough(work *w, const uint32_t *members, size_t count);

/* ---- set.c: what a plane comes near ---------------------------------------------------------------------------- */

typedef enum set_kind { SET_MEMBERS, SET_REFLEX, SET_FLAT } set_kind;

work_set *set_of(work *w, uint32_t piece, set_kind kind);
void set_push(work *w, work_set *set, uint32_t item);
/* Whether the item still belongs to the piece with this cell. */
bool set_holds(const work *w, uint32_t cell, set_kind kind, uint32_t item);
/* out: what the set holds. */
void set_list(work *w, uint32_t piece, set_kind kind, id_list *out);
/* Keeps set_near fast; to be called now and then. */
void set_arrange(work *w, uint32_t piece, set_kind kind);
/* out: all items with points within margin of the plane, and some more; some may have left the set. Bit 0 (2) of what
 * is returned: there were items wholly below (above) that are not in out. */
int set_near(work *w, const work_set *set, const double normal[3], double offset, double margin, id_list *out);
void set_release(work *w, work_set *set);

/* ---- cut.c, caps.c, search.c, locate.c ------------------------------------------------------------------------ */

/* Cuts a piece by a plane; false if the plane does not pass through it. New pieces are appended. */
bool piece_cut(work *w, uint32_t piece, uint32_t plane);
/* Makes facets of w->cap_uses, each a connected region; both sides are the piece's. Fills w->cap_facets. */
void caps_make(work *w, uint32_t plane, uint32_t cell);
/* Links w->cap_uses, which lie in the plane, into w->cap_loops, and finds the loop around each hole. */
void regions_find(work *w, uint32_t plane);
/* A further facet without edges, between the same cells in the same plane. */
uint32_t facet_beside(work *w, uint32_t facet);
/* Makes a facet of each connected region of this one; the new ones join w->touched. */
void facet_part(work *w, uint32_t facet);
/* Parts the piece along w->cap_facets. */
void pieces_part(work *w, uint32_t piece, uint32_t plane);
/* All members that hang together with this one, appended to out. */
void members_connected(work *w, uint32_t member, id_list *out);
/* Whether the closed surface of these members contains the vertex of the shell of member. */
bool surface_contains(work *w, const uint32_t *members, size_t count, uint32_t shell_member);

/* ---- choose.c, merge.c, finish.c ------------------------------------------------------------------------------ */

/* A plane to cut the piece with, or CELLIST_NONE if the piece is convex. */
uint32_t choose_plane(work *w, uint32_t piece);
void pieces_cut_by_grid(work *w);
void pieces_cut_all(work *w);
void pieces_merge(work *w);
void finish(work *w, cellist_complex **complex);

#endif
