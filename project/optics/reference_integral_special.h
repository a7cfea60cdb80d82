/* SPDX-License-Identifier: BSD-3-Clause
 * The two functions that the closed forms of linear extinction need and C lacks. Private to the reference caster. */
#ifndef CELLIST_REFERENCE_INTEGRAL_SPECIAL_H
#define CELLIST_REFERENCE_INTEGRAL_SPECIAL_H

/* exp(x^2) erfc(x) for x >= 0, to a relative 1e-15. */
double reference_erfcx(double x);

/* Dawson's integral exp(-x^2) * integral of exp(t^2) from 0 to x, for x >= 0, to a relative 1e-15. */
double reference_dawson(double x);

#endif
