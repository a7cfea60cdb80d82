/* SPDX-License-Identifier: BSD-3-Clause
 * The psi table, by quadrature: panels at most half a unit deep, six Gauss points each. The closed forms with erfcx and
 * Dawson's function cancel in thin pieces, and the second moment has more of that. */
#include "psi.h"

#include <math.h>

/* exp(-40) is 4e-18: nothing behind that counts. */
static const double VISIBLE_DEPTH = 40;

static const double NODE[6] = {0.033765242898423986094, 0.16939530676686774317, 0.38069040695840154568,
                               0.61930959304159845432,  0.83060469323313225683, 0.96623475710157601391};
static const double WEIGHT[6] = {0.085662246189585172520, 0.18038078652406930378, 0.23395696728634552369,
                                 0.23395696728634552369,  0.18038078652406930378, 0.085662246189585172520};

void psi_means(double m, double share, double *first, double *second) {
  *first = *second = 0;
  if (isinf(m)) return;
  /* Depths if the extinction of one end held along the piece; for m = 0 only their proportion counts. */
  const double scale = m > 0 ? 2 * m : 1, a = (1 - share) * scale, b = share * scale;
  const double limit = fmin(m, VISIBLE_DEPTH);
  const int panels = 1 + (int)(2 * limit);
  double sum = 0, low = 0;
  for (int p = 1; p <= panels; p++) {
    const double y = limit * p / panels;
    const double high = p == panels && limit == m ? 1 : 2 * y / (a + sqrt(fmax(0, a * a + 2 * (b - a) * y)));
    for (int g = 0; g < 6; g++) {
      const double w = low + (high - low) * NODE[g], so_far = m > 0 ? w * (a + 0.5 * (b - a) * w) : 0;
      const double emitted = WEIGHT[g] * (high - low) * (a + (b - a) * w) * exp(-so_far);
      sum += emitted;
      *first += emitted * w;
      *second += emitted * w * w;
    }
    low = high;
  }
  *first /= sum;
  *second /= sum;
}

void psi_table_fill(float *table) {
  for (int j = 0; j < PSI_SHARES; j++)
    for (int i = 0; i < PSI_DEPTHS; i++) {
      const double u = (double)i / (PSI_DEPTHS - 1), root = u / (1 - u);
      double first, second;
      psi_means(root * root, (double)j / (PSI_SHARES - 1), &first, &second);
      float *entry = &table[2 * (j * PSI_DEPTHS + i)];
      entry[0] = (float)first;
      entry[1] = (float)second;
    }
}

void psi_look_up(const float *table, double m, double share, double *first, double *second) {
  const double root = sqrt(m), x = (isinf(root) ? 1 : root / (1 + root)) * (PSI_DEPTHS - 1);
  const double y = share * (PSI_SHARES - 1);
  const int i = x < PSI_DEPTHS - 2 ? (int)x : PSI_DEPTHS - 2, j = y < PSI_SHARES - 2 ? (int)y : PSI_SHARES - 2;
  double found[2];
  for (int k = 0; k < 2; k++) {
    const float *at = &table[2 * (j * PSI_DEPTHS + i) + k];
    const double low = at[0] + (x - i) * (at[2] - at[0]);
    const double high = at[2 * PSI_DEPTHS] + (x - i) * (at[2 * PSI_DEPTHS + 2] - at[2 * PSI_DEPTHS]);
    found[k] = low + (y - j) * (high - low);
  }
  *first = found[0];
  *second = found[1];
}
