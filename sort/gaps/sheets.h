/* SPDX-License-Identifier: BSD-3-Clause
 * Sheets: connected entering faces that hide all that lies behind them from one leaving face. Private to sort/.
 *
 * A ray that leaves a cell through face e and later enters one through f orders the two; but if it enters another cell
 * g in between, then what orders e and g, the cells from g on, and what follows these order e and f as well. So f needs
 * no arc if faces that lie behind e and before f cover e. Do they? Take entering faces that overlap e, as the eye
 * sees them, and let each of their edges that crosses e be shared with another of them. The two faces lie on the
 * two sides of the edge; so in the inside of e the faces' union ends at no edge, thus nowhere, and is all of e. */
#ifndef CELLIST_SORT_SHEETS_H
#define CELLIST_SORT_SHEETS_H

#include "boundary.h"

/* Faces that may be part of a leaving face's sheets; only speed depends on it. */
enum { SORT_SHEET_LIMIT = 256 };

/* The faces of one leaving face's sheets so far. */
typedef struct sort_sheets {
  size_t count;
  uint32_t faces[SORT_SHEET_LIMIT];
  uint32_t roots[SORT_SHEET_LIMIT]; /* sheets as trees: a face's parent, itself if it is the root */
  uint32_t
      missing[SORT_SHEET_LIMIT];    /* of a root: edges that cross the leaving face and lead to no face of the sheet */
  float farthest[SORT_SHEET_LIMIT]; /* of a root: no face of the sheet lies farther */
  double highest[SORT_SHEET_LIMIT]; /* of a root: none lies higher above the leaving face's plane */
  float hidden_depth;               /* of the leaving face: entering faces that are farther need no arc to it, */
  double hidden_height;             /* and neither do those that are higher */
  uint32_t *places; /* [boundary.face_count] where in faces a face stands, if it is there; else anything */
} sort_sheets;

/* No face yet. */
void sort_sheets_begin(sort_sheets *sheets);

/* Adds an entering face which overlaps the leaving one and lies nowhere before it.
 * crossing: bits as sort_cover has them. */
void sort_sheets_add(sort_sheets *sheets, const sort_boundary *boundary, uint32_t face, uint32_t crossing,
                     float farthest, double highest);

#endif
