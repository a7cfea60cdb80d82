/* SPDX-License-Identifier: BSD-3-Clause
 * cellist info: what a mesh file holds, and whether it is sound. */
#include <cellist/pipeline.h>
#include <cellist/validate.h>
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

static void set_count(json_t *object, const char *name, size_t count) {
  json_object_set_new(object, name, json_integer((json_int_t)count));
}

static json_t *scalars_of(const cellist_mesh_arrays *arrays) {
  json_t *scalars = json_array();
  for (size_t i = 0; i < arrays->field_count; i++) {
    const cellist_field *field = &arrays->fields[i];
    const struct range range = range_of(field, value_count(arrays, field));
    json_array_append_new(
        scalars, json_pack("{s:o, s:s, s:i, s:f, s:f, s:I}", "name", terminal_text(field->name), "on", place_of(field),
                           "components", (int)field->component_count, "min", range.minimum, "max", range.maximum,
                           "not_finite", (json_int_t)range.bad_count));
  }
  return scalars;
}

/* Every finding that was made: its count, how bad it is, and the first ids. */
static json_t *findings_of(const cellist_report *report) {
  static const char *const severities[] = {"note", "warning", "flaw"};
  json_t *findings = json_object();
  for (cellist_finding_kind kind = 0; kind < CELLIST_FINDING_COUNT; kind++) {
    const cellist_finding *finding = &report->findings[kind];
    if (finding->count == 0) continue;
    json_t *ids = json_array();
    for (size_t i = 0; i < finding->id_count; i++) json_array_append_new(ids, json_integer(finding->ids[i]));
    json_t *entry = json_object();
    set_count(entry, "count", finding->count);
    json_object_set_new(entry, "severity", json_string(severities[cellist_finding_severity(kind)]));
    json_object_set_new(entry, "ids", ids);
    json_object_set_new(findings, cellist_finding_name(kind), entry);
  }
  return findings;
}

static int report_json(const cellist_mesh *mesh, const cellist_report *report) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  const double *b = arrays->bounds;
  json_t *object = json_object();
  set_count(object, "points", arrays->point_count);
  set_count(object, "cells", facts->file_cell_count);
  set_count(object, "tets", arrays->tet_count);
  set_count(object, "boundary_faces", report->boundary_face_count);
  set_count(object, "components", report->component_count);
  set_count(object, "cavities", report->cavity_count);
  json_object_set_new(object, "convex", json_boolean(report->is_convex));
  set_count(object, "reflex_edges", report->reflex_edge_count);
  set_count(object, "inverted_cells", report->inverted_cell_count);
  set_count(object, "degenerate_cells", report->degenerate_cell_count);
  set_count(object, "folded_faces", report->folded_face_count);
  set_count(object, "overfull_faces", report->overfull_face_count);
  set_count(object, "nonmanifold_edges", report->nonmanifold_edge_count);
  set_count(object, "nonmanifold_vertices", report->nonmanifold_vertex_count);
  set_count(object, "crossing_faces", report->crossing_face_count);
  set_count(object, "touching_faces", report->touching_face_count);
  set_count(object, "skipped_cells", facts->skipped_cell_count);
  set_count(object, "hidden_cells", facts->hidden_cell_count);
  set_count(object, "merged_points", facts->merged_point_count);
  set_count(object, "flaws", report->flaw_count);
  set_count(object, "warnings", report->warning_count);
  json_object_set_new(object, "bounds", json_pack("[f,f,f,f,f,f]", b[0], b[1], b[2], b[3], b[4], b[5]));
  json_object_set_new(object, "scalars", scalars_of(arrays));
  json_object_set_new(object, "findings", findings_of(report));
  return terminal_print_json(object);
}

static void print_count(const char *what, size_t count) { printf("%-22s %zu\n", what, count); }

static void print_finding(const cellist_report *report, cellist_finding_kind kind) {
  static const char *const severities[] = {"note", "warning", "flaw"};
  const cellist_finding *finding = &report->findings[kind];
  if (finding->count == 0) return;
  printf("%-8s %-13s %zu: %s", severities[cellist_finding_severity(kind)], cellist_finding_name(kind), finding->count,
         cellist_finding_description(kind));
  for (size_t i = 0; i < finding->id_count; i++) printf("%s%u", i == 0 ? " (ids " : " ", finding->ids[i]);
  if (finding->id_count > 0) printf("%s)", finding->count > finding->id_count ? " ..." : "");
  printf("\n");
}

static int report_text(const cellist_mesh *mesh, const cellist_report *report) {
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  print_count("points", arrays->point_count);
  print_count("cells in the file", facts->file_cell_count);
  print_count("tets", arrays->tet_count);
  if (facts->skipped_cell_count > 0) print_count("skipped, below 3-D", facts->skipped_cell_count);
  if (facts->hidden_cell_count > 0) print_count("hidden or ghost cells", facts->hidden_cell_count);
  if (facts->merged_point_count > 0) print_count("merged points", facts->merged_point_count);
  print_count("components", report->component_count);
  print_count("cavities", report->cavity_count);
  print_count("boundary faces", report->boundary_face_count);
  print_count("reflex edges", report->reflex_edge_count);
  print_count("non-manifold edges", report->nonmanifold_edge_count);
  print_count("non-manifold vertices", report->nonmanifold_vertex_count);
  printf("%-22s %s\n", "convex", report->is_convex ? "yes" : "no");
  const double *b = arrays->bounds;
  printf("%-22s %g %g %g to %g %g %g\n", "bounds", b[0], b[1], b[2], b[3], b[4], b[5]);
  for (size_t i = 0; i < arrays->field_count; i++) {
    const cellist_field *field = &arrays->fields[i];
    const struct range range = range_of(field, value_count(arrays, field));
    printf("%-22s %s, on %s, %u component%s, %g to %g", i == 0 ? "scalars" : "", field->name, place_of(field),
           field->component_count, field->component_count == 1 ? "" : "s", range.minimum, range.maximum);
    if (range.bad_count > 0) printf(", %zu not finite", range.bad_count);
    printf("\n");
  }
  for (cellist_finding_kind kind = 0; kind < CELLIST_FINDING_COUNT; kind++) print_finding(report, kind);
  printf("%s\n", report->flaw_count > 0      ? "The mesh has flaws."
                 : report->warning_count > 0 ? "The mesh is sound, with warnings."
                                             : "The mesh is sound.");
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
  const command_usage usage = {"info",
                               "MESH",
                               "Says what a mesh (a file, or sample:NAME) holds, and whether it is sound.",
                               1,
                               1,
                               examples,
                               {table, mesh_table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);
  cellist_mesh_read_desc desc;
  const char *wrong = mesh_options_resolve(&options, &desc);
  if (wrong != NULL) return wrong_usage("info", "%s", wrong);

  cellist_context *context = terminal_context(0);
  if (context == NULL) return 1;
  cellist_mesh *mesh = NULL;
  cellist_report report;
  cellist_result result = cellist_pipeline_load(context, argv[1], &desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_validate(context, mesh, NULL, &report);
  int status = 0;
  if (result != CELLIST_SUCCESS)
    status = terminal_failure(context, result);
  else
    status = json ? report_json(mesh, &report) : report_text(mesh, &report);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  return status;
}
