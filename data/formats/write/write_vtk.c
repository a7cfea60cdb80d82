/* SPDX-License-Identifier: BSD-3-Clause
 * Writes VTK's legacy format 3.0, binary (which is big-endian): read by every program of the last twenty years. */
#include "output.h"

#include <string.h>

/* One portion of numbers in the file's order. */
static void print_ids(struct output *output, size_t count, uint32_t (*id_at)(const void *user, size_t at),
                      const void *user) {
  uint8_t bytes[4 * 1024];
  for (size_t begin = 0; begin < count; begin += 1024) {
    const size_t part = count - begin < 1024 ? count - begin : 1024;
    for (size_t i = 0; i < part; i++) output_store(bytes + 4 * i, id_at(user, begin + i), 4, true);
    output_write(output, bytes, 4 * part);
  }
  output_print(output, "\n");
}

struct cells {
  const cellist_mesh_arrays *arrays;
  const struct output_order *order;
};

static uint32_t cell_number(const void *user, size_t at) {
  const struct cells *cells = user;
  if (at % 5 == 0) return 4;
  const size_t tet = cells->order->tets[at / 5];
  return cells->order->point_place[cells->arrays->tets[4 * tet + at % 5 - 1]];
}

static uint32_t cell_type(const void *user, size_t at) {
  (void)user, (void)at;
  return 10; /* VTK_TETRA */
}

static cellist_result print_values(struct output *output, const char *prefix, const char *name, const double *values,
                                   size_t component_count, const uint32_t *order, size_t count) {
  struct output_values made;
  const cellist_result result = output_values_make(output->context, values, component_count, order, count, true, &made);
  if (result != CELLIST_SUCCESS) return result;
  output_print(output, "%s", prefix);
  /* A name is one word: what is not plain is written as %XX, which readers undo. */
  for (const char *c = name; *c != '\0'; c++) {
    const unsigned char byte = (unsigned char)*c;
    const bool is_plain = byte > ' ' && byte < 127 && byte != '"' && byte != '%';
    output_print(output, is_plain ? "%c" : "%%%02X", byte);
  }
  const char *type = made.is_float32 ? "float" : "double";
  if (name[0] == '\0')
    output_print(output, "%s\n", type);
  else
    output_print(output, " %zu %zu %s\n", component_count, count, type);
  output_write(output, made.bytes, made.size);
  output_print(output, "\n");
  cellist_deallocate(output->context, made.bytes);
  return CELLIST_SUCCESS;
}

static cellist_result print_fields(struct output *output, const cellist_mesh_arrays *arrays,
                                   cellist_association association, const uint32_t *order, size_t count) {
  size_t field_count = 0;
  for (size_t i = 0; i < arrays->field_count; i++) field_count += arrays->fields[i].association == association;
  if (field_count == 0) return CELLIST_SUCCESS;
  output_print(output, "%s %zu\nFIELD FieldData %zu\n", association == CELLIST_ON_POINTS ? "POINT_DATA" : "CELL_DATA",
               count, field_count);
  for (size_t i = 0; i < arrays->field_count; i++) {
    const cellist_field *field = &arrays->fields[i];
    if (field->association != association) continue;
    const char *name = field->name[0] != '\0' ? field->name : "unnamed";
    const cellist_result result = print_values(output, "", name, field->values, field->component_count, order, count);
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

cellist_result write_vtk(struct output *output, const cellist_mesh *mesh) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  if (arrays->tet_count > INT32_MAX / 5)
    return cellist_fail(output->context, CELLIST_ERROR_UNSUPPORTED,
                        "%s: %zu tets are more than the legacy VTK format can count; write a .vtu", output->path,
                        arrays->tet_count);
  struct output_order order;
  cellist_result result = output_order_make(output->context, arrays, &order);
  if (result == CELLIST_SUCCESS) {
    char points[64];
    snprintf(points, sizeof points, "POINTS %zu ", arrays->point_count);
    output_print(output, "# vtk DataFile Version 3.0\nwritten by cellist\nBINARY\nDATASET UNSTRUCTURED_GRID\n");
    result = print_values(output, points, "", arrays->positions, 3, order.points, arrays->point_count);
  }
  if (result == CELLIST_SUCCESS) {
    const struct cells cells = {arrays, &order};
    output_print(output, "CELLS %zu %zu\n", arrays->tet_count, 5 * arrays->tet_count);
    print_ids(output, 5 * arrays->tet_count, cell_number, &cells);
    output_print(output, "CELL_TYPES %zu\n", arrays->tet_count);
    print_ids(output, arrays->tet_count, cell_type, NULL);
    result = print_fields(output, arrays, CELLIST_ON_POINTS, order.points, arrays->point_count);
  }
  if (result == CELLIST_SUCCESS) result = print_fields(output, arrays, CELLIST_ON_CELLS, order.tets, arrays->tet_count);
  output_order_release(output->context, &order);
  return result;
}
