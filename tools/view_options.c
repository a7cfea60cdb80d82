/* SPDX-License-Identifier: BSD-3-Clause
 * View options: from --eye, --orbit and the like to a cellist_view. */
#include "view_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void view_options_init(view_options *options, option_spec table[VIEW_OPTION_COUNT]) {
  *options = (view_options){.fovy = 30, .parallel = NAN};
  options->eye.expected = options->target.expected = options->up.expected = 3;
  options->orbit.expected = 2;
  const option_spec filled[VIEW_OPTION_COUNT] = {
      {"eye", "X,Y,Z", "where the camera stands", OPTION_NUMBERS, &options->eye},
      {"target", "X,Y,Z", "what it looks at (the mesh's centre)", OPTION_NUMBERS, &options->target},
      {"up", "X,Y,Z", "which way is up (0,0,1)", OPTION_NUMBERS, &options->up},
      {"fovy", "DEGREES", "vertical field of view (30)", OPTION_NUMBER, &options->fovy},
      {"parallel", "HEIGHT", "parallel projection, the image HEIGHT high in the mesh's units", OPTION_NUMBER,
       &options->parallel},
      {"orbit", "AZIMUTH,ELEVATION", "look at the whole mesh from this direction, in degrees (30.96,34.45)",
       OPTION_NUMBERS, &options->orbit},
      {"near", "D", "show nothing nearer than this depth (0)", OPTION_NUMBER, &options->near_distance},
      {"clip", "NX,NY,NZ,D", "show only x with n.x <= D; or a box X0,Y0,Z0,X1,Y1,Z1; may be repeated (16 planes)",
       OPTION_TEXTS, &options->clips},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  memcpy(table, filled, sizeof filled);
}

/* Numbers separated by commas, all finite; returns how many, 0 if the text is anything else. */
static size_t parse_numbers(const char *text, double *numbers, size_t capacity) {
  for (size_t count = 0; count < capacity;) {
    char *end = NULL;
    numbers[count++] = strtod(text, &end);
    if (end == text || !isfinite(numbers[count - 1])) return 0;
    if (*end == '\0') return count;
    if (*end != ',') return 0;
    text = end + 1;
  }
  return 0;
}

static const char *resolve_clips(const text_list *clips, cellist_view *view) {
  static const char too_many[] = "there may be 16 clip planes at most; a box is six of them";
  for (size_t i = 0; i < clips->count; i++) {
    double n[6];
    switch (parse_numbers(clips->value[i], n, 6)) {
      case 4:
        if (n[0] == 0 && n[1] == 0 && n[2] == 0) return "--clip NX,NY,NZ,D needs a direction that is not 0";
        if (view->clip_count == CELLIST_MAX_CLIP_PLANES) return too_many;
        view->clips[view->clip_count++] = (cellist_clip_plane){{n[0], n[1], n[2]}, n[3]};
        break;
      case 6:
        if (n[0] > n[3] || n[1] > n[4] || n[2] > n[5]) return "--clip needs the box's lower corner first";
        if (!cellist_view_clip_box(view, n)) return too_many;
        break;
      default: return "--clip needs a plane NX,NY,NZ,D or a box X0,Y0,Z0,X1,Y1,Z1";
    }
  }
  return NULL;
}

const char *view_options_resolve(const view_options *options, const double bounds[6], cellist_view *view) {
  if (options->eye.count > 0 && options->orbit.count > 0) return "--eye and --orbit exclude each other";
  if (options->parallel <= 0) return "--parallel needs a height above 0";
  if (!(options->fovy > 0 && options->fovy < 180)) return "--fovy must lie between 0 and 180 degrees";
  if (options->near_distance < 0) return "--near must be at least 0";
  const bool has_orbit = options->orbit.count > 0;
  *view = cellist_view_orbit(bounds, has_orbit ? options->orbit.value[0] : CELLIST_VIEW_AZIMUTH,
                             has_orbit ? options->orbit.value[1] : CELLIST_VIEW_ELEVATION);
  if (options->eye.count > 0) {
    memcpy(view->eye, options->eye.value, sizeof view->eye);
    view->up[0] = view->up[1] = 0;
    view->up[2] = 1;
  }
  if (options->target.count > 0) memcpy(view->target, options->target.value, sizeof view->target);
  if (options->up.count > 0) memcpy(view->up, options->up.value, sizeof view->up);
  view->fovy_degrees = options->fovy;
  view->parallel_height = isnan(options->parallel) ? 0 : options->parallel;
  view->near_distance = options->near_distance;
  return resolve_clips(&options->clips, view);
}

cellist_view view_turned(const cellist_view *view, double fraction) {
  const double angle = 2 * 3.14159265358979323846 * fraction, c = cos(angle), s = sin(angle);
  const double length = sqrt(view->up[0] * view->up[0] + view->up[1] * view->up[1] + view->up[2] * view->up[2]);
  double axis[3], from[3];
  for (int k = 0; k < 3; k++) {
    axis[k] = length > 0 ? view->up[k] / length : 0;
    from[k] = view->eye[k] - view->target[k];
  }
  const double along = axis[0] * from[0] + axis[1] * from[1] + axis[2] * from[2];
  cellist_view turned = *view; /* Rodrigues' rotation of the eye about the target */
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double sideways = axis[i] * from[j] - axis[j] * from[i];
    turned.eye[k] = view->target[k] + c * from[k] + s * sideways + (1 - c) * along * axis[k];
  }
  return turned;
}
