/* SPDX-License-Identifier: BSD-3-Clause
 * cellist convert: any mesh that can be read, to a format that can be written. */
#include <cellist/mesh_write.h>
#include <cellist/pipeline.h>
#include <stdio.h>

#include "command.h"
#include "mesh_options.h"
#include "terminal.h"

int command_convert(int argc, char **argv) {
  mesh_options options;
  option_spec table[MESH_OPTION_COUNT];
  mesh_options_init(&options, table);
  static const char *const examples[] = {"cellist convert mesh.vtk mesh.vtu",
                                         "cellist convert --merge grid.xyz grid.vtu",
                                         "cellist convert --merge=1e-6 mesh.msh mesh.vtk", NULL};
  const command_usage usage = {
      "convert", "IN OUT", "Reads a mesh in any format and writes it as .vtu or .vtk, as tets in the file's order.",
      2,         2,        examples,
      {table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);
  cellist_mesh_read_desc desc;
  const char *wrong = mesh_options_resolve(&options, &desc);
  if (wrong != NULL) return wrong_usage("convert", "%s", wrong);

  cellist_context *context = terminal_context(0);
  if (context == NULL) return 1;
  cellist_mesh *mesh = NULL;
  cellist_result result = cellist_pipeline_load(context, argv[1], &desc, &mesh);
  if (result == CELLIST_SUCCESS) result = cellist_mesh_write(context, mesh, argv[2], NULL);
  const int status = result == CELLIST_SUCCESS ? 0 : terminal_failure(context, result);
  if (status == 0) fprintf(stderr, "wrote %s: %zu tets\n", argv[2], cellist_mesh_get_arrays(mesh)->tet_count);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  return status;
}
