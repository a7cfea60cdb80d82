/* SPDX-License-Identifier: BSD-3-Clause
 * View: where the camera is and which ray belongs to a pixel. The same for every renderer. */
#ifndef CELLIST_VIEW_H
#define CELLIST_VIEW_H

#include <cellist/context.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A half-space: points p with normal . p <= offset are kept, others are not seen. normal need not have length 1. */
typedef struct cellist_clip_plane {
  double normal[3], offset;
} cellist_clip_plane;

enum { CELLIST_MAX_CLIP_PLANES = 16 };

/* A camera in the mesh's frame and units, and what part of the mesh it looks at. */
typedef struct cellist_view {
  double eye[3];
  double target[3];       /* what the image's centre looks at */
  double up[3];           /* need not be orthogonal to the line of sight, must not be parallel to it */
  double fovy_degrees;    /* vertical field of view, 0 < fovy < 180; perspective if parallel_height is 0 */
  double parallel_height; /* height of the image in world units; above 0: parallel projection */
  double near_distance;   /* depth along the line of sight before which nothing is seen, at least 0 */
  uint32_t clip_count;    /* only what all of these keep is seen, of cells and of surfaces */
  cellist_clip_plane clips[CELLIST_MAX_CLIP_PLANES];
} cellist_view;

/* A view with its axes worked out, for an image of width x height pixels. */
typedef struct cellist_frame {
  double eye[3];
  double forward[3], right[3], up[3]; /* orthonormal */
  double half_width, half_height;     /* of the image, at depth 1 (perspective) or in world units (parallel) */
  double near_distance;
  bool parallel;
  uint32_t width, height;
  uint32_t clip_count;
  cellist_clip_plane clips[CELLIST_MAX_CLIP_PLANES]; /* scaled: the largest component of a normal is 0.5 to 1 */
} cellist_frame;

/* From where meshes are seen unless asked otherwise, in degrees. */
#define CELLIST_VIEW_AZIMUTH 30.96
#define CELLIST_VIEW_ELEVATION 34.45

/* A view of the whole: from direction (cos e cos a, cos e sin a, sin e) towards the bounds' centre, up z
 * (y where z is the line of sight), distance half the bounds' diagonal / sin 15 degrees, fovy 30 degrees.
 * bounds: lower corner, then upper corner. Threads: any. */
CELLIST_API cellist_view cellist_view_orbit(const double bounds[6], double azimuth_degrees, double elevation_degrees);

/* Adds the six planes of a box (lower corner, then upper corner): what lies outside is not seen. Returns false, and
 * adds nothing, if there is no room for six more. Threads: any. */
CELLIST_API bool cellist_view_clip_box(cellist_view *view, const double box[6]);

/* Works out the axes.
 * Errors: INVALID_ARGUMENT (a number that is not finite, eye equal to target, up parallel to the line of sight, an
 *   angle, distance or size out of range, a clip plane without a direction; the message says which). Threads: one call
 * per context at a time. */
CELLIST_API cellist_result cellist_frame_from_view(cellist_context *context, const cellist_view *view, uint32_t width,
                                                   uint32_t height, cellist_frame *frame);

/* The ray through image position (x, y) in pixels; pixel (i, j)'s centre is (i + 0.5, j + 0.5), row 0 is the top.
 * Points of the ray are origin + t * direction; t is the depth along frame->forward, seen from near_distance on.
 * direction is not normalised in perspective (its forward part is 1): a length is a difference in t times
 * |direction|. Arrays: origin and direction, 3 doubles each, filled. Threads: any. */
CELLIST_API void cellist_frame_ray(const cellist_frame *frame, double x, double y, double origin[3],
                                   double direction[3]);

/* The part of such a ray that is seen: from t = interval[0], at least near_distance, to interval[1], infinity without
 * clip planes. Where nothing is seen, interval[0] is infinity and interval[1] minus infinity. An end at a plane is
 * (offset - normal . origin) / (normal . direction) in double precision: off by at most 8 * 2^-53 times the sum of its
 * terms' sizes, over |normal . direction|. Arrays: 3, 3 and 2 doubles. Threads: any. */
CELLIST_API void cellist_frame_interval(const cellist_frame *frame, const double origin[3], const double direction[3],
                                        double interval[2]);

#ifdef __cplusplus
}
#endif
#endif
