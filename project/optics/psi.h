/* SPDX-License-Identifier: BSD-3-Clause
 * The psi table (Moreland, Angel 2004): where in a piece of linear extinction what is seen of it lies, for every
 * transfer function. Private to project/.
 *
 * Of a piece of optical depth m on which extinction goes from e_f to e_b, with w = 0..1 from front to back, the table
 * holds the means of w and of w^2 over what is seen of it:
 *   first = 1 - q, q = (1 - psi) / (1 - zeta), zeta = exp(-m): colour = (1 - zeta) (q c_f + (1 - q) c_b)
 *   second, which light needs.
 * Neither cancels, both lie between 0 and 1. Axes: share = e_b / (e_f + e_b) and root = sqrt(m) / (1 + sqrt(m)), nodes
 * at both ends; the square root, because at share 1 psi falls as 1 / sqrt(m). */
#ifndef CELLIST_PSI_H
#define CELLIST_PSI_H

#include <cellist/context.h>

enum { PSI_DEPTHS = 256, PSI_SHARES = 128, PSI_FLOATS = 2 * PSI_DEPTHS * PSI_SHARES };

/* The means for one piece, to some 1e-10. m: at least 0, may be infinite; share: 0 to 1. */
CELLIST_API void psi_means(double m, double share, double *first, double *second);

/* Fills table[PSI_FLOATS]: first and second of depth i and share j at 2 (j PSI_DEPTHS + i). Cost: some 50 ms. */
CELLIST_API void psi_table_fill(float *table);

/* As a shader looks it up: bilinear. */
CELLIST_API void psi_look_up(const float *table, double m, double share, double *first, double *second);

#endif
