/* SPDX-License-Identifier: BSD-3-Clause
 * The sRGB curve (IEC 61966-2-1) between encoded values and linear light, both 0..1. Private to the project. */
#ifndef CELLIST_SRGB_H
#define CELLIST_SRGB_H

#include <math.h>

static inline double linear_from_srgb(double x) { return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4); }

static inline double srgb_from_linear(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055; }

#endif
