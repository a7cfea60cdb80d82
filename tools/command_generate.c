/* SPDX-License-Identifier: BSD-3-Clause
 * cellist generate: a sample mesh to a file. */
#include <cellist/generate.h>
#include <cellist/mesh_write.h>
#include <stdio.h>

#include "command.h"
#include "options.h"
#include "terminal.h"

static int list_generators(bool json) {
  json_t *names = json_array();
  for (size_t i = 0; cellist_generator_name(i) != NULL; i++) {
    if (json)
      json_array_append_new(names, json_string(cellist_generator_name(i)));
    else
      printf("%-18s %s\n", cellist_generator_name(i), cellist_generator_purpose(i));
  }
  if (json) return terminal_print_json(names);
  json_decref(names);
  return terminal_finish();
}

int command_generate(int argc, char **argv) {
  const char *output = NULL;
  bool list = false, json = false;
  double size = 0, perturb = 0;
  unsigned long long seed = 1;
  unsigned parts = 0;
  const option_spec table[] = {
      {"o", "MESH.vtu", "where to, .vtu or .vtk", OPTION_TEXT, &output},
      {"list", "", "print the names and what each is good for", OPTION_FLAG, &list},
      {"size", "N", "about N cells (each sample has its own default)", OPTION_NUMBER, &size},
      {"seed", "N", "for samples with chance in them (1)", OPTION_SEED, &seed},
      {"perturb", "P", "grid: move inner points by up to P of a cell, 0..0.5 (0)", OPTION_NUMBER, &perturb},
      {"parts", "N", "how many teeth, fins, steps, plates ... (as --list says)", OPTION_COUNT, &parts},
      {"json", "", "print what was made as one JSON object", OPTION_FLAG, &json},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  static const char *const examples[] = {"cellist generate --list", "cellist generate gears -o gears.vtu",
                                         "cellist generate ball -o ball.vtu --size 1000000 --seed 7", NULL};
  const command_usage usage = {
      "generate", "NAME -o MESH.vtu", "Makes a sample mesh, the same on every machine.", 0, 1, examples, {table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);
  if (list) return list_generators(json);
  if (positional != 1) return wrong_usage("generate", "expected NAME");
  if (output == NULL) return wrong_usage("generate", "-o MESH is missing");
  if (!(size >= 0 && size <= 1e9)) return wrong_usage("generate", "--size must lie between 1 and 1e9");
  if (!(perturb >= 0 && perturb <= 0.5)) return wrong_usage("generate", "--perturb must lie between 0 and 0.5");

  cellist_context *context = terminal_context(0);
  if (context == NULL) return 1;
  const cellist_generate_desc desc = {.size = (size_t)size, .seed = seed, .perturb = perturb, .parts = parts};
  cellist_mesh *mesh = NULL;
  cellist_result result = cellist_generate(context, argv[1], &desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_mesh_write(context, mesh, output, NULL);
  int status = 0;
  if (result != CELLIST_SUCCESS) {
    status = terminal_failure(context, result);
  } else {
    const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
    if (json)
      status = terminal_print_json(json_pack("{s:s, s:o, s:I, s:I}", "name", argv[1], "file", terminal_text(output),
                                             "points", (json_int_t)arrays->point_count, "tets",
                                             (json_int_t)arrays->tet_count));
    else
      fprintf(stderr, "wrote %s: %zu tets, %zu points\n", output, arrays->tet_count, arrays->point_count);
  }
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  return status;
}
