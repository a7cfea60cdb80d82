/* SPDX-License-Identifier: BSD-3-Clause
 * Flaws: for each finding that validation names a few tets that have it, apart from each other in a row. Some flaws
 * cannot come alone: cells on one side of a face cross, and hanging nodes touch. */
#include "builder.h"

#include <math.h>

/* From one group to the next. */
static const double STEP = 4;

struct row {
  mesh_builder *builder;
  double at;
};

static uint32_t point(struct row *row, double x, double y, double z) {
  return builder_point(row->builder, row->at + x, y, z);
}

/* The unit tet's corners at the next place. */
static void next_group(struct row *row, uint32_t v[4]) {
  row->at += STEP;
  v[0] = point(row, 0, 0, 0);
  v[1] = point(row, 1, 0, 0);
  v[2] = point(row, 0, 1, 0);
  v[3] = point(row, 0, 0, 1);
}

static void add_wrong_cells(struct row *row) {
  mesh_builder *builder = row->builder;
  uint32_t v[4];
  next_group(row, v);
  builder_tet(builder, v[0], v[2], v[1], v[3]); /* inverted */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  builder_tet(builder, v[1], v[2], v[0], point(row, 1, 1, 0)); /* flat */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], point(row, 0.25, 0.25, 0x1p-12)); /* needle */
  builder_tet(builder, v[0], v[2], v[1], point(row, 0.25, 0.25, -1));
  builder_tet(builder, v[0], v[1], v[3], point(row, 0.25, -1, 0.25)); /* uses the point 3 */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  builder_tet(builder, v[1], v[2], v[0], v[3]); /* duplicate */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  builder_tet(builder, v[0], v[1], v[2], v[0]);                              /* collapsed: left out */
  builder_tet(builder, v[0], v[2], v[1], builder_point(builder, NAN, 0, 0)); /* infinite: left out */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  builder->blind_point = v[0]; /* nan-scalar */
}

static void add_wrong_faces(struct row *row) {
  mesh_builder *builder = row->builder;
  uint32_t v[4];
  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  builder_tet(builder, v[0], v[1], v[2], point(row, 1, 1, 1)); /* folded, and crossing */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  const uint32_t below = point(row, 0, 0, -1), beside = point(row, 1, 1, -1);
  builder_tet(builder, v[0], v[2], v[1], below);
  builder_tet(builder, v[0], v[2], v[1], beside); /* overfull */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  const uint32_t middle = point(row, 0.5, 0.5, 0), under = point(row, 0, 0, -1);
  builder_tet(builder, v[0], middle, v[1], under); /* hanging, and touching along the edge 1 2 */
  builder_tet(builder, v[0], v[2], middle, under);

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  const uint32_t w[4] = {point(row, 0, 0, 0), point(row, 1, 0, 0), point(row, 0, 1, 0), point(row, 0, 0, -1)};
  builder_tet(builder, w[0], w[2], w[1], w[3]); /* seam, and coincident */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  builder_tet(builder, point(row, 0.25, 0.25, 0), point(row, 0.5, 0, -1), point(row, 0, 0.25, -1),
              point(row, 0.5, 0.5, -1)); /* touching: a corner in the middle of a face */

  next_group(row, v);
  builder_tet(builder, v[0], v[1], v[2], v[3]);
  builder_tet(builder, point(row, 0.25, 0.25, 0.25), point(row, 0.5, 0, -1), point(row, 0, 0.25, -1),
              point(row, 0.5, 0.5, -1)); /* crossing */
}

void generate_flaws(mesh_builder *builder) {
  struct row row = {builder, 0};
  builder->repair = true;
  add_wrong_cells(&row);
  add_wrong_faces(&row);
  point(&row, 1, 1, 1); /* unused */
}
