/* SPDX-License-Identifier: BSD-3-Clause
 * Fast scene: what the fast walks read, for one frame. Private.
 *
 * Every vertex is transformed once a frame to {x, y, a, b}. A ray is a point (rx, ry); seen along the ray, a vertex
 * lies at (x - rx, y - ry), or at (x - rx a, y - ry a) where vertices may lie behind the eye. That is the 2-D basis of
 * [A] 4 and its appendix C, with the projection taken out of the walk: [A] projects a vertex with six multiplications
 * for every ray that comes by. Depth and scalar of a point are linear on a face in the two attributes a and b: z and s;
 * or in perspective 1 - f/z and s f/z, f the farthest depth, from which depths are measured then. 1/z itself would lose
 * the mesh's depth in its rounding where the eye is far away. */
#ifndef CELLIST_RAYCAST_FAST_SCENE_H
#define CELLIST_RAYCAST_FAST_SCENE_H

#include <cellist/mesh.h>
#include <cellist/view.h>

#include "../optics/fast_optics.h"
#include "fast_cells.h"

/* Lengths are in units of half the diagonal of the mesh's bounds; scalars as fast_transfer takes them. */
typedef struct fast_vertex {
  float x, y;
  float a, b; /* 1 - f/z and s f/z if the scene is reciprocal, else z and s */
} fast_vertex;

typedef struct fast_scene {
  const uint32_t *tets; /* the mesh's */
  fast_cells cells;
  fast_vertex *vertices;     /* [points] */
  const float *cell_scalars; /* [tets], NaN: not drawn; NULL: scalars are on points */
  bool has_nan;              /* some scalar is NaN */
  bool sheared;              /* rays are not parallel, and vertices may lie behind the eye: x - rx a */
  bool reciprocal;           /* a = 1 - f/z, never above 0 */
  float farthest;            /* f */
  bool clips;                /* something may lie outside of what is seen of a ray: tiles hold limits */
  bool wants_depth;          /* fill z and z_back */
  bool is_dense;             /* some extinction is above FAST_DENSE: watch for segments that it makes doubtful */
  bool perspective;
  double unit, depth_offset;  /* world depth = unit * z + depth_offset */
  uint32_t width, height;     /* of the image */
  const float *ray_x, *ray_y; /* [width], [height] */
  fast_transfer transfer;
} fast_scene;

/* A vertex as a ray sees it. */
typedef struct fast_point {
  float x, y, a, b;
} fast_point;

/* Both paths of the walk, and the search for entries, use this arithmetic (no fused operations), so that all agree bit
 * for bit about which faces a ray passes. */
static inline fast_point fast_see_vertex(const fast_scene *scene, fast_vertex v, float rx, float ry) {
  if (scene->sheared) return (fast_point){v.x - rx * v.a, v.y - ry * v.a, v.a, v.b};
  return (fast_point){v.x - rx, v.y - ry, v.a, v.b};
}

static inline fast_point fast_see(const fast_scene *scene, uint32_t vertex, float rx, float ry) {
  return fast_see_vertex(scene, scene->vertices[vertex], rx, ry);
}

/* Instead of a determinant of 0: small enough to change no weight that matters, large enough not to underflow. */
#define FAST_TINY 1e-30f

/* On which side of the ray the edge from p to q passes: det(p, q), never 0. Where it is 0, the ray counts as displaced
 * by an infinitesimal along x and a smaller one along y (as in line.h), so that the faces around an edge agree on who
 * has the ray; an edge seen as a point goes by the ids. Rounding can give a wrong side, but the same one wherever the
 * edge is met: products commute, and the difference is taken without a fused operation. */
static inline float fast_side(fast_point p, fast_point q, uint32_t p_id, uint32_t q_id) {
  const float side = p.x * q.y - p.y * q.x;
  if (side != 0) return side;
  if (p.y != q.y) return p.y > q.y ? FAST_TINY : -FAST_TINY;
  if (p.x != q.x) return q.x > p.x ? FAST_TINY : -FAST_TINY;
  return p_id < q_id ? FAST_TINY : -FAST_TINY;
}

/* A point on a face, by the weights of its corners (each at least 0, one above 0). */
typedef struct fast_crossing {
  float z, s;
} fast_crossing;

static inline fast_crossing fast_cross(const fast_scene *scene, const fast_point p[3], const float w[3]) {
  const float sum = w[0] + w[1] + w[2];
  const float a = w[0] * p[0].a + w[1] * p[1].a + w[2] * p[2].a;
  const float b = w[0] * p[0].b + w[1] * p[1].b + w[2] * p[2].b;
  if (scene->reciprocal) return (fast_crossing){scene->farthest * a / (sum - a), b / (sum - a)};
  return (fast_crossing){a / sum, b / sum};
}

/* The state of a walk at the face through which it enters a cell. */
typedef struct fast_stand {
  fast_place place;
  uint32_t id[3];    /* the face's vertices, counter-clockwise as the ray sees them */
  fast_point p[3];   /* where it sees them */
  float w[3];        /* det(p1, p2), det(p2, p0), det(p0, p1): the weights of the corners, all above 0 */
  fast_crossing now; /* where the ray passes the face */
} fast_stand;

/* Sets up the walk at a boundary face (4 * tet + corner opposite). Returns false if the ray does not enter there. */
static inline bool fast_enter(const fast_scene *scene, uint32_t face, float rx, float ry, fast_stand *stand) {
  const uint32_t tet = face >> 2, *v = &scene->tets[4 * (size_t)tet];
  const uint8_t *corner = CELLIST_TET_FACE[face & 3];
  stand->place = (fast_place){tet, v[face & 3], CELLIST_NONE};
  for (int k = 0; k < 3; k++) {
    stand->id[k] = v[corner[k]];
    stand->p[k] = fast_see(scene, stand->id[k], rx, ry);
  }
  for (int k = 0; k < 3; k++) {
    const int i = k < 2 ? k + 1 : 0, j = k > 0 ? k - 1 : 2;
    stand->w[k] = fast_side(stand->p[i], stand->p[j], stand->id[i], stand->id[j]);
    if (!(stand->w[k] > 0)) return false;
  }
  stand->now = fast_cross(scene, stand->p, stand->w);
  return true;
}

/* Weights whose sum is below this, times the square of the corners' distance from the ray, are little more than a few
 * rounding errors: a face seen edge-on, with no say in where the ray passes it. Smaller: colours from elsewhere on the
 * face (grids seen along an axis are full of such faces); larger: more rays cast twice. */
#define FAST_EDGE_ON 1e-5f

static inline bool fast_is_edge_on(const fast_point p[3], const float w[3]) {
  float reach = 0;
  for (int k = 0; k < 3; k++) reach = fmaxf(reach, p[k].x * p[k].x + p[k].y * p[k].y);
  return w[0] + w[1] + w[2] < FAST_EDGE_ON * reach;
}

/* In media as dense as this (per unit), rounding of depths shows: they are kept to some 2.5e-7 of a unit, so optical
 * depths to 5e-4. Larger: greater errors; smaller: more rays cast twice. */
#define FAST_DENSE 2e3f
/* Segments as short as a few of these roundings may be nothing else. */
#define FAST_SHORT 1e-6f
/* Light that passes a segment, as a share, below which its end is not seen; and of all light, below which errors are
 * not. */
#define FAST_UNSEEN 3e-4f
#define FAST_FAINT 1e-3f

/* Whether a segment shows the rounding of depths. dense: it has extinctions above FAST_DENSE at an end; crosses: it
 * passes a knot. A long segment of which only the front is seen does not: scalars at a face are right, wherever it is.
 */
static inline bool fast_is_doubtful(float extent, bool dense, bool crosses, float before, float after) {
  return before > FAST_FAINT &&
         ((extent < FAST_SHORT && (dense || crosses)) || (dense && after > FAST_UNSEEN * before));
}

static inline float fast_extinction(const fast_interval *interval, float s) {
  return interval->extinction + interval->extinction_slope * (s - interval->low);
}

/* Length of a ray per unit of depth. */
static inline float fast_ray_stretch(const fast_scene *scene, float rx, float ry) {
  return scene->perspective ? sqrtf(1 + rx * rx + ry * ry) : 1;
}

#endif
