/* SPDX-License-Identifier: BSD-3-Clause
 * cellist info: what a mesh file holds. */
#include <cellist/pipeline.h>
#include <math.h>
#include <stdio.h>

#include "command.h"
#include "mesh_options.h"
#include "terminal.h"

/* A field's range over its finite values, magnitudes for vectors. */
struct range {
  double minimum, maximum;
  size_t bad_count;
};

static struct range range_of(const cellist_field *field, size_t count) {
  struct range range = {HUGE_VAL, -HUGE_VAL, 0};
  for (size_t i = 0; i < count; i++) {
    const double *v = &field->values[i * field->component_count];
    double value = v[0];
    if (field->component_count > 1) {
      value = 0;
      for (uint32_t k = 0; k < field->component_count; k++) value = hypot(value, v[k]);
    }
    if (!isfinite(value)) {
      range.bad_count++;
      continue;
    }
    range.minimum = fmin(range.minimum, value);
    range.maximum = fmax(range.maximum, value);
  }
  if (range.minimum > range.maximum) range.minimum = range.maximum = 0;
  return range;
}

static const char *place_of(const cellist_field *field) {
  return field->association == CELLIST_ON_POINTS ? "points" : "cells";
}

static size_t value_count(const cellist_mesh_arrays *arrays, const cellist_field *field) {
  return field->association == CELLIST_ON_POINTS ? arrays->point_count : arrays->tet_count;
}

static int report_json(const cellist_mesh *mesh) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  json_t *scalars = json_array();
  for (size_t i = 0; i < arrays->field_count; i++) {
    const cellist_field *field = &arrays->fields[i];
    const struct range range = range_of(field, value_count(arrays, field));
    json_array_append_new(
        scalars, json_pack("{s:s, s:s, s:i, s:f, s:f, s:I}", "name", field->name, "on", place_of(field), "components",
                           (int)field->component_count, "min", range.minimum, "max", range.maximum, "not_finite",
                           (json_int_t)range.bad_count));
  }
  const double *b = arrays->bounds;
  return terminal_print_json(json_pack(
      "{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:[f,f,f,f,f,f], s:o}", "points",
      (json_int_t)arrays->point_count, "cells", (json_int_t)facts->file_cell_count, "tets",
      (json_int_t)arrays->tet_count, "boundary_faces", (json_int_t)facts->boundary_face_count, "inverted_cells",
      (json_int_t)facts->inverted_count, "degenerate_cells", (json_int_t)facts->flat_count, "folded_faces",
      (json_int_t)facts->folded_face_count, "overfull_faces", (json_int_t)facts->overfull_face_count, "skipped_cells",
      (json_int_t)facts->skipped_cell_count, "hidden_cells", (json_int_t)facts->hidden_cell_count, "unused_points",
      (json_int_t)facts->unused_point_count, "bounds", b[0], b[1], b[2], b[3], b[4], b[5], "scalars", scalars));
}

static void print_count(const char *what, size_t count) { printf("%-18s %zu\n", what, count); }

static void print_flaw(const char *what, size_t count, const char *consequence) {
  if (count > 0) printf("%-18s %zu: %s\n", what, count, consequence);
}

static int report_text(const cellist_mesh *mesh) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  print_count("points", arrays->point_count);
  print_count("cells in the file", facts->file_cell_count);
  print_count("tets", arrays->tet_count);
  print_count("boundary faces", facts->boundary_face_count);
  const double *b = arrays->bounds;
  printf("%-18s %g %g %g to %g %g %g\n", "bounds", b[0], b[1], b[2], b[3], b[4], b[5]);
  print_flaw("skipped cells", facts->skipped_cell_count, "of lower dimension");
  print_flaw("hidden cells", facts->hidden_cell_count, "ghosts or blanked, left out");
  print_flaw("inverted tets", facts->inverted_count, "re-oriented");
  print_flaw("flat tets", facts->flat_count, "of zero volume, ordered but not drawn");
  print_flaw("folded faces", facts->folded_face_count, "both cells on one side; no order is right there");
  print_flaw("overfull faces", facts->overfull_face_count, "more than two cells; no order is right there");
  print_flaw("unused points", facts->unused_point_count, "no cell uses them");
  for (size_t i = 0; i < arrays->field_count; i++) {
    const cellist_field *field = &arrays->fields[i];
    const struct range range = range_of(field, value_count(arrays, field));
    printf("%-18s %s, on %s, %u component%s, %g to %g", i == 0 ? "scalars" : "", field->name, place_of(field),
           field->component_count, field->component_count == 1 ? "" : "s", range.minimum, range.maximum);
    if (range.bad_count > 0) printf(", %zu not finite", range.bad_count);
    printf("\n");
  }
  return terminal_finish();
}

int command_info(int argc, char **argv) {
  bool json = false;
  mesh_options options;
  option_spec mesh_table[MESH_OPTION_COUNT];
  mesh_options_init(&options, mesh_table);
  const option_spec table[] = {
      {"json", "", "print one JSON object", OPTION_FLAG, &json},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  static const char *const examples[] = {"cellist info mesh.vtu", "cellist info sample:gears --json", NULL};
  const command_usage usage = {
      "info", "MESH", "Says what a mesh (a file, or sample:NAME) holds.", 1, 1, examples, {table, mesh_table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);
  cellist_mesh_read_desc desc;
  const char *wrong = mesh_options_resolve(&options, &desc);
  if (wrong != NULL) return wrong_usage("info", "%s", wrong);

  cellist_context *context = terminal_context(0);
  if (context == NULL) return 1;
  cellist_mesh *mesh = NULL;
  const cellist_result result = cellist_pipeline_load(context, argv[1], &desc, &mesh);
  int status = 0;
  if (result != CELLIST_SUCCESS)
    status = terminal_failure(context, result);
  else
    status = json ? report_json(mesh) : report_text(mesh);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  return status;
}
