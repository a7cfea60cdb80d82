/* SPDX-License-Identifier: BSD-3-Clause
 * Output: a file that is written whole or not at all, and a mesh in the user's order. Private to data/. */
#ifndef CELLIST_FORMATS_OUTPUT_H
#define CELLIST_FORMATS_OUTPUT_H

#include <cellist/mesh_write.h>
#include <stdio.h>

struct output {
  cellist_context *context;
  const char *path;
  char *partial; /* what is written until output_finish renames it; NULL: standard output or a device */
  FILE *file;
};

cellist_result output_open(cellist_context *context, const char *path, struct output *output);

/* False once anything went wrong; output_finish says what. */
void output_write(struct output *output, const void *bytes, size_t size);
void output_print(struct output *output, const char *format, ...) CELLIST_PRINTF(2, 3);

/* Closes and, if result is SUCCESS and all was written, gives the file its name; removes it otherwise. */
cellist_result output_finish(struct output *output, cellist_result result);

/* The mesh's points and tets by rising user's ids: [point_count], [tet_count] indices into the mesh's arrays; both are
 * the caller's. point_place[i]: where point i comes. */
struct output_order {
  uint32_t *points, *tets, *point_place;
};
cellist_result output_order_make(cellist_context *context, const cellist_mesh_arrays *arrays,
                                 struct output_order *order);
void output_order_release(cellist_context *context, struct output_order *order);

/* Values of one array as the file's numbers, in little- or big-endian order. */
struct output_values {
  bool is_float32; /* every value is a float */
  size_t count;
  uint8_t *bytes; /* the caller's */
  size_t size;
};
cellist_result output_values_make(cellist_context *context, const double *values, size_t component_count,
                                  const uint32_t *order, size_t count, bool big_endian, struct output_values *made);

/* Stores the lowest size bytes of value. */
void output_store(uint8_t *bytes, uint64_t value, size_t size, bool big_endian);

cellist_result write_vtu(struct output *output, const cellist_mesh *mesh);
cellist_result write_vtk(struct output *output, const cellist_mesh *mesh);

#endif
