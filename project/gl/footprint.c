/* SPDX-License-Identifier: BSD-3-Clause
 * Footprints. The union of a tet's back faces is a triangle or a quadrangle, told by the exact signs of its faces; it
 * is grown by what the rasteriser may move a corner (OpenGL snaps them to 1/256 pixel), so that the fragment program,
 * not the rasteriser, decides where the cell ends. Drawn as they are, faces lost or gained up to 1/256 pixel at every
 * edge inside the mesh, 5e-5 in a slab that should be smooth. Corners too sharp to grow get a rectangle instead. */
#include "footprint.h"

#include <cellist/mesh.h>
#include <math.h>
#include <string.h>

/* By the back faces: around one (or around three: the face that is not one), or the four corners of two. */
const uint8_t GL_FOOTPRINT_RINGS[16][5] = {
    {0},          {3, 1, 2, 3}, {3, 0, 2, 3},    {4, 2, 0, 3, 1}, {3, 0, 1, 3}, {4, 1, 0, 3, 2}, {4, 0, 1, 3, 2},
    {3, 0, 1, 2}, {3, 0, 1, 2}, {4, 1, 0, 2, 3}, {4, 0, 1, 2, 3}, {3, 0, 1, 3}, {4, 0, 2, 1, 3}, {3, 0, 2, 3},
    {3, 1, 2, 3}, {0}};

bool gl_corner_is_wild(const gl_picture *picture, const double corner[3]) {
  const double w = picture->parallel ? 1 : corner[2];
  return !(w > picture->least_depth && fabs(corner[0]) <= GL_FAR_OUT * picture->half_width * w &&
           fabs(corner[1]) <= GL_FAR_OUT * picture->half_height * w);
}

/* The rectangle along the polygon's longest edge, grown by the margin. */
static int box_around(const gl_picture *picture, double (*polygon)[2], int count, double out[][2]) {
  double along[2] = {1, 0}, longest = 0;
  for (int i = 0; i < count; i++) {
    const double *a = polygon[i], *b = polygon[(i + 1) % count];
    const double length = hypot(b[0] - a[0], b[1] - a[1]);
    if (!(length > longest)) continue;
    longest = length;
    along[0] = (b[0] - a[0]) / length;
    along[1] = (b[1] - a[1]) / length;
  }
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (int i = 0; i < count; i++) {
    const double *p = polygon[i];
    const double at[2] = {p[0] * along[0] + p[1] * along[1], p[1] * along[0] - p[0] * along[1]};
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], at[k] - picture->margin);
      high[k] = fmax(high[k], at[k] + picture->margin);
    }
  }
  for (int i = 0; i < 4; i++) {
    const double u = i == 1 || i == 2 ? high[0] : low[0], v = i >= 2 ? high[1] : low[1];
    out[i][0] = u * along[0] - v * along[1];
    out[i][1] = u * along[1] + v * along[0];
  }
  return 4;
}

/* Moves every edge of a convex polygon outwards by the margin. */
static int grow(const gl_picture *picture, double (*polygon)[2], int count, double out[][2]) {
  double area = 0, normals[GL_FOOTPRINT_CORNERS][2];
  for (int i = 0; i < count; i++) {
    const double *a = polygon[i], *b = polygon[(i + 1) % count];
    area += a[0] * b[1] - a[1] * b[0];
  }
  for (int i = 0; i < count; i++) {
    const double *a = polygon[i], *b = polygon[(i + 1) % count];
    const double dx = b[0] - a[0], dy = b[1] - a[1], length = copysign(sqrt(dx * dx + dy * dy), area);
    if (!(fabs(length) > 0)) return box_around(picture, polygon, count, out);
    normals[i][0] = dy / length;
    normals[i][1] = -dx / length;
  }
  for (int i = 0; i < count; i++) {
    const double *m = normals[(i + count - 1) % count], *n = normals[i];
    const double turn = 1 + m[0] * n[0] + m[1] * n[1];
    if (!(turn > GL_SHARPEST_TURN)) return box_around(picture, polygon, count, out);
    for (int k = 0; k < 2; k++) out[i][k] = polygon[i][k] + picture->margin * (m[k] + n[k]) / turn;
  }
  return count;
}

int gl_footprint_of_tet(const gl_picture *picture, const double *const corners[4], unsigned back,
                        double out[GL_FOOTPRINT_CORNERS][2]) {
  const uint8_t *ring = GL_FOOTPRINT_RINGS[back & 15];
  double polygon[GL_FOOTPRINT_CORNERS][2];
  for (int i = 0; i < ring[0]; i++) {
    const double *corner = corners[ring[1 + i]];
    const double w = picture->parallel ? 1 : corner[2];
    polygon[i][0] = corner[0] / w;
    polygon[i][1] = corner[1] / w;
  }
  return ring[0] > 0 ? grow(picture, polygon, ring[0], out) : 0;
}

enum { PLANES = 5, MAX_CORNERS = 2 * (3 + PLANES) }; /* rounding may make a plane cut a needle more than twice */

/* Above 0 on the side of the picture, or of what lies beyond the least depth. */
static double distance(const gl_picture *picture, int plane, const double corner[3]) {
  const double w = picture->parallel ? 1 : corner[2];
  switch (plane) {
    case 0: return picture->parallel ? 1 : corner[2] - picture->least_depth;
    case 1: return picture->half_width * w + corner[0];
    case 2: return picture->half_width * w - corner[0];
    case 3: return picture->half_height * w + corner[1];
    default: return picture->half_height * w - corner[1];
  }
}

/* Sutherland and Hodgman's cut of a polygon by one plane. */
static int cut(const gl_picture *picture, int plane, double (*in)[3], int count, double (*out)[3]) {
  int kept = 0;
  for (int i = 0; i < count && kept < MAX_CORNERS - 1; i++) {
    const double *a = in[i], *b = in[(i + 1) % count];
    const double da = distance(picture, plane, a), db = distance(picture, plane, b);
    if (da >= 0) memcpy(out[kept++], a, sizeof out[0]);
    if ((da >= 0) == (db >= 0)) continue;
    const double t = da / (da - db);
    for (int k = 0; k < 3; k++) out[kept][k] = a[k] + t * (b[k] - a[k]);
    kept++;
  }
  return kept;
}

int gl_footprint_of_wild_tet(const gl_picture *picture, const double *const corners[4], unsigned back,
                             double out[GL_FOOTPRINT_CORNERS][2]) {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (int k = 0; k < 4; k++) {
    if (!(back & 1u << k)) continue;
    double polygons[2][MAX_CORNERS][3];
    int count = 3, now = 0;
    for (int i = 0; i < 3; i++) memcpy(polygons[0][i], corners[CELLIST_TET_FACE[k][i]], sizeof polygons[0][i]);
    for (int plane = 0; plane < PLANES && count > 0; plane++) {
      count = cut(picture, plane, polygons[now], count, polygons[1 - now]);
      now = 1 - now;
    }
    for (int i = 0; i < count; i++)
      for (int axis = 0; axis < 2; axis++) {
        const double w = picture->parallel ? 1 : polygons[now][i][2];
        const double half = axis == 0 ? picture->half_width : picture->half_height;
        const double at = fmax(-half, fmin(half, polygons[now][i][axis] / w));
        low[axis] = fmin(low[axis], at - 1); /* a pixel: the cut's own rounding is far below */
        high[axis] = fmax(high[axis], at + 1);
      }
  }
  if (!(low[0] < high[0])) return 0;
  for (int i = 0; i < 4; i++) {
    out[i][0] = i == 1 || i == 2 ? high[0] : low[0];
    out[i][1] = i >= 2 ? high[1] : low[1];
  }
  return 4;
}
