/* SPDX-License-Identifier: BSD-3-Clause
 * Colour: interpolation between two colours in the spaces that ParaView's presets name.
 *
 * HSV takes the shorter way round the hue circle. Lab is CIE L*a*b* of sRGB with the D65 white (IEC 61966-2-1).
 * Diverging is Moreland's Msh space ("Diverging Color Maps for Scientific Visualization", 2009, section 5): the polar
 * form of Lab, with an unsaturated point inserted between two saturated colours of different hue. */
#include <base/srgb.h>
#include <math.h>
#include <string.h>

#include "transfer_private.h"

static const double PI = 3.14159265358979323846;
static const double WHITE[3] = {0.9505, 1.0, 1.089};

static void hsv_from_rgb(const double rgb[3], double hsv[3]) {
  const double high = fmax(rgb[0], fmax(rgb[1], rgb[2])), low = fmin(rgb[0], fmin(rgb[1], rgb[2]));
  const double spread = high - low;
  hsv[0] = 0;
  if (spread > 0) {
    if (high == rgb[0])
      hsv[0] = (rgb[1] - rgb[2]) / spread / 6;
    else if (high == rgb[1])
      hsv[0] = 1.0 / 3 + (rgb[2] - rgb[0]) / spread / 6;
    else
      hsv[0] = 2.0 / 3 + (rgb[0] - rgb[1]) / spread / 6;
  }
  if (hsv[0] < 0) hsv[0] += 1;
  hsv[1] = high > 0 ? spread / high : 0;
  hsv[2] = high;
}

static void rgb_from_hsv(const double hsv[3], double rgb[3]) {
  for (int k = 0; k < 3; k++) {
    const double turn = 6 * (hsv[0] + (3 - k) % 3 / 3.0);
    const double hue = fabs(turn - 6 * floor(turn / 6) - 3) - 1;
    rgb[k] = hsv[2] * (1 - hsv[1] * (1 - fmin(1, fmax(0, hue))));
  }
}

static double lab_curve(double t) { return t > 0.008856 ? cbrt(t) : 7.787 * t + 16.0 / 116; }

static double lab_uncurve(double t) { return t * t * t > 0.008856 ? t * t * t : (t - 16.0 / 116) / 7.787; }

static void lab_from_rgb(const double rgb[3], double lab[3]) {
  const double r = linear_from_srgb(rgb[0]), g = linear_from_srgb(rgb[1]), b = linear_from_srgb(rgb[2]);
  const double x = lab_curve((0.4124 * r + 0.3576 * g + 0.1805 * b) / WHITE[0]);
  const double y = lab_curve((0.2126 * r + 0.7152 * g + 0.0722 * b) / WHITE[1]);
  const double z = lab_curve((0.0193 * r + 0.1192 * g + 0.9505 * b) / WHITE[2]);
  lab[0] = 116 * y - 16;
  lab[1] = 500 * (x - y);
  lab[2] = 200 * (y - z);
}

static void rgb_from_lab(const double lab[3], double rgb[3]) {
  const double fy = (lab[0] + 16) / 116;
  const double x = WHITE[0] * lab_uncurve(fy + lab[1] / 500), y = WHITE[1] * lab_uncurve(fy);
  const double z = WHITE[2] * lab_uncurve(fy - lab[2] / 200);
  const double linear[3] = {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
                            0.0557 * x - 0.2040 * y + 1.0570 * z};
  for (int k = 0; k < 3; k++) rgb[k] = fmin(1, fmax(0, srgb_from_linear(fmax(0, linear[k]))));
}

static void msh_from_rgb(const double rgb[3], double msh[3]) {
  double lab[3];
  lab_from_rgb(rgb, lab);
  msh[0] = sqrt(lab[0] * lab[0] + lab[1] * lab[1] + lab[2] * lab[2]);
  msh[1] = msh[0] > 0.001 ? acos(fmin(1, fmax(-1, lab[0] / msh[0]))) : 0;
  msh[2] = msh[1] > 0.001 ? atan2(lab[2], lab[1]) : 0;
}

static void rgb_from_msh(const double msh[3], double rgb[3]) {
  const double lab[3] = {msh[0] * cos(msh[1]), msh[0] * sin(msh[1]) * cos(msh[2]), msh[0] * sin(msh[1]) * sin(msh[2])};
  rgb_from_lab(lab, rgb);
}

static double hue_distance(double a, double b) {
  const double difference = fabs(a - b);
  return difference > PI ? 2 * PI - difference : difference;
}

/* The hue that an unsaturated colour of magnitude `unsaturated` needs to meet a saturated one (Moreland, section 5.3).
 */
static double adjusted_hue(const double saturated[3], double unsaturated) {
  if (saturated[0] >= unsaturated - 0.1) return saturated[2];
  const double spin =
      saturated[1] * sqrt(unsaturated * unsaturated - saturated[0] * saturated[0]) / (saturated[0] * sin(saturated[1]));
  return saturated[2] > -PI / 3 ? saturated[2] + spin : saturated[2] - spin;
}

static void mix_diverging(const double from[3], const double to[3], double s, double mixed[3]) {
  double a[3], b[3], msh[3];
  msh_from_rgb(from, a);
  msh_from_rgb(to, b);
  if (a[1] > 0.05 && b[1] > 0.05 && hue_distance(a[2], b[2]) > PI / 3) {
    const double middle = fmax(fmax(a[0], b[0]), 88);
    double *end = s < 0.5 ? b : a;
    s = s < 0.5 ? 2 * s : 2 * s - 1;
    end[0] = middle;
    end[1] = end[2] = 0;
  }
  if (a[1] < 0.05 && b[1] > 0.05)
    a[2] = adjusted_hue(b, a[0]);
  else if (b[1] < 0.05 && a[1] > 0.05)
    b[2] = adjusted_hue(a, b[0]);
  for (int k = 0; k < 3; k++) msh[k] = (1 - s) * a[k] + s * b[k];
  rgb_from_msh(msh, mixed);
}

static void mix_hsv(const double from[3], const double to[3], double s, double mixed[3]) {
  double a[3], b[3], hsv[3];
  hsv_from_rgb(from, a);
  hsv_from_rgb(to, b);
  if (a[0] - b[0] > 0.5) a[0] -= 1;
  if (b[0] - a[0] > 0.5) b[0] -= 1;
  for (int k = 0; k < 3; k++) hsv[k] = (1 - s) * a[k] + s * b[k];
  rgb_from_hsv(hsv, mixed);
}

static void mix_lab(const double from[3], const double to[3], double s, double mixed[3]) {
  double a[3], b[3], lab[3];
  lab_from_rgb(from, a);
  lab_from_rgb(to, b);
  for (int k = 0; k < 3; k++) lab[k] = (1 - s) * a[k] + s * b[k];
  rgb_from_lab(lab, mixed);
}

void colour_mix(colour_space space, const double from[3], const double to[3], double s, double mixed[3]) {
  switch (space) {
    case COLOUR_HSV: mix_hsv(from, to, s, mixed); return;
    case COLOUR_LAB: mix_lab(from, to, s, mixed); return;
    case COLOUR_DIVERGING: mix_diverging(from, to, s, mixed); return;
    case COLOUR_STEP: memcpy(mixed, to, 3 * sizeof *mixed); return; /* an interval has its end's colour */
    case COLOUR_RGB: break;
  }
  for (int k = 0; k < 3; k++) mixed[k] = (1 - s) * from[k] + s * to[k];
}
