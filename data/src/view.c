/* SPDX-License-Identifier: BSD-3-Clause
 * View: from eye, target and up to the ray of a pixel. */
#include <cellist/view.h>

#include <math.h>
#include <string.h>

static const double DEGREE = 0.017453292519943295;

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(double out[3], const double a[3], const double b[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Scales by the largest component first, so that neither tiny nor huge vectors lose their direction. */
static bool normalise(double v[3]) {
  const double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
  if (!(largest > 0) || !isfinite(largest)) return false;
  for (int k = 0; k < 3; k++) v[k] /= largest;
  const double length = sqrt(dot(v, v));
  for (int k = 0; k < 3; k++) v[k] /= length;
  return true;
}

cellist_view cellist_view_orbit(const double bounds[6], double azimuth_degrees, double elevation_degrees) {
  const double azimuth = azimuth_degrees * DEGREE, elevation = elevation_degrees * DEGREE;
  const double toward[3] = {cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation)};
  double half[3];
  for (int k = 0; k < 3; k++) half[k] = 0.5 * bounds[3 + k] - 0.5 * bounds[k];
  double half_diagonal = hypot(hypot(half[0], half[1]), half[2]);
  if (!(half_diagonal > 0)) half_diagonal = 1; /* a single point: any distance will do */
  const double distance = half_diagonal / sin(15 * DEGREE);
  cellist_view view = {.fovy_degrees = 30};
  /* cos 90 degrees is 6e-17 in floating point: within 1e-9 of the pole z is no up direction. */
  const bool at_pole = fabs(toward[2]) > 1 - 1e-15;
  view.up[at_pole ? 1 : 2] = 1;
  for (int k = 0; k < 3; k++) {
    view.target[k] = 0.5 * bounds[k] + 0.5 * bounds[3 + k];
    view.eye[k] = view.target[k] + distance * toward[k];
  }
  return view;
}

bool cellist_view_clip_box(cellist_view *view, const double box[6]) {
  if (view->clip_count + 6 > CELLIST_MAX_CLIP_PLANES) return false;
  for (int i = 0; i < 6; i++) {
    const double sign = i < 3 ? -1 : 1;
    cellist_clip_plane *plane = &view->clips[view->clip_count++];
    *plane = (cellist_clip_plane){{0, 0, 0}, sign * box[i]};
    plane->normal[i % 3] = sign;
  }
  return true;
}

/* Scaled by powers of two, which is exact unless it underflows, so that no product overflows later. */
static cellist_result copy_clips(cellist_context *context, const cellist_view *view, cellist_frame *frame) {
  if (view->clip_count > CELLIST_MAX_CLIP_PLANES)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the view has %u clip planes; there may be %d",
                        view->clip_count, CELLIST_MAX_CLIP_PLANES);
  frame->clip_count = view->clip_count;
  for (uint32_t i = 0; i < view->clip_count; i++) {
    const cellist_clip_plane *plane = &view->clips[i];
    const double *n = plane->normal;
    const double largest = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    if (!isfinite(n[0]) || !isfinite(n[1]) || !isfinite(n[2]) || !(largest > 0) || !isfinite(plane->offset))
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                          "clip plane %u (%g,%g,%g, %g) has no direction or is not finite", i, n[0], n[1], n[2],
                          plane->offset);
    int exponent = 0;
    frexp(largest, &exponent);
    for (int k = 0; k < 3; k++) frame->clips[i].normal[k] = ldexp(n[k], -exponent);
    frame->clips[i].offset = ldexp(plane->offset, -exponent);
  }
  return CELLIST_SUCCESS;
}

cellist_result cellist_frame_from_view(cellist_context *context, const cellist_view *view, uint32_t width,
                                       uint32_t height, cellist_frame *frame) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (view == NULL || frame == NULL || width == 0 || height == 0)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "a view needs an image of at least 1x1 pixels");
  for (int k = 0; k < 3; k++)
    if (!isfinite(view->eye[k]) || !isfinite(view->target[k]) || !isfinite(view->up[k]))
      return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the view's eye, target or up is not finite");
  const bool parallel = view->parallel_height != 0;
  if (parallel && !(view->parallel_height > 0 && isfinite(view->parallel_height)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the height of a parallel view must be above 0");
  if (!parallel && !(view->fovy_degrees > 0 && view->fovy_degrees < 180))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "the field of view is %g degrees; it must lie between 0 and 180", view->fovy_degrees);
  if (!(view->near_distance >= 0 && isfinite(view->near_distance)))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the near distance must be finite and at least 0");

  cellist_frame made = {.near_distance = view->near_distance, .parallel = parallel, .width = width, .height = height};
  memcpy(made.eye, view->eye, sizeof made.eye);
  double up[3];
  for (int k = 0; k < 3; k++) {
    made.forward[k] = view->target[k] - view->eye[k];
    up[k] = view->up[k];
  }
  if (!normalise(made.forward))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the view's eye and target are the same point");
  if (!normalise(up)) return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "the view's up vector is 0");
  cross(made.right, made.forward, up);
  /* The sine of the angle between up and the line of sight: below 1e-12 rounding decides where right is. */
  if (!(sqrt(dot(made.right, made.right)) > 1e-12) || !normalise(made.right))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT,
                        "the view's up vector is parallel to its line of sight");
  cross(made.up, made.right, made.forward);
  made.half_height = parallel ? 0.5 * view->parallel_height : tan(0.5 * view->fovy_degrees * DEGREE);
  made.half_width = made.half_height * width / height;
  const cellist_result result = copy_clips(context, view, &made);
  if (result == CELLIST_SUCCESS) *frame = made;
  return result;
}

void cellist_frame_ray(const cellist_frame *frame, double x, double y, double origin[3], double direction[3]) {
  const double across = (2 * x / frame->width - 1) * frame->half_width;
  const double upward = (1 - 2 * y / frame->height) * frame->half_height;
  for (int k = 0; k < 3; k++) {
    const double offset = across * frame->right[k] + upward * frame->up[k];
    origin[k] = frame->eye[k] + (frame->parallel ? offset : 0);
    direction[k] = frame->forward[k] + (frame->parallel ? 0 : offset);
  }
}

void cellist_frame_interval(const cellist_frame *frame, const double origin[3], const double direction[3],
                            double interval[2]) {
  double from = frame->near_distance, to = HUGE_VAL;
  for (uint32_t i = 0; i < frame->clip_count; i++) {
    const cellist_clip_plane *plane = &frame->clips[i];
    const double speed = dot(plane->normal, direction), left = plane->offset - dot(plane->normal, origin);
    if (speed > 0) {
      const double t = left / speed;
      to = t < to ? t : to;
    } else if (speed < 0) {
      const double t = left / speed;
      from = t > from ? t : from;
    } else if (left < 0) {
      to = -HUGE_VAL;
    }
  }
  const bool sees = from < to;
  interval[0] = sees ? from : HUGE_VAL;
  interval[1] = sees ? to : -HUGE_VAL;
}
