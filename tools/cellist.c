/* SPDX-License-Identifier: BSD-3-Clause
 * cellist: dispatch to the subcommands. */
#include <cellist/version.h>
#include <stdio.h>
#include <string.h>

#include "command.h"
#include "terminal.h"

static const struct {
  const char *name, *summary;
  int (*run)(int argc, char **argv);
} COMMANDS[] = {
    {"info", "what a mesh file holds", command_info},
    {"generate", "make a sample mesh", command_generate},
    {"convert", "read a mesh in one format, write it in another", command_convert},
    {"sort", "put the cells in visibility order, check and time it", command_sort},
#ifdef CELLIST_HAS_CONVEXIFY
    {"convexify", "fill what a mesh lacks of its convex hull", command_convexify},
#endif
    {"render", "draw a mesh", command_render},
    {"report", "draw by every renderer and setting: error against run time", command_report},
    {"compare", "measure how far an image is from a reference", command_compare},
};
enum { COMMAND_COUNT = sizeof COMMANDS / sizeof COMMANDS[0] };

static void print_usage(FILE *to) {
  fprintf(to, "usage: cellist COMMAND [arguments]\n\nDraws unstructured volume meshes in exact visibility order.\n\n");
  for (size_t i = 0; i < COMMAND_COUNT; i++) fprintf(to, "  %-10s %s\n", COMMANDS[i].name, COMMANDS[i].summary);
  fprintf(to, "\ncellist COMMAND --help tells more; cellist --version prints the version.\n");
}

int main(int argc, char **argv) {
  if (argc < 2) {
    print_usage(stderr);
    return 2;
  }
  if (strcmp(argv[1], "--help") == 0) {
    print_usage(stdout);
    return terminal_finish();
  }
  if (strcmp(argv[1], "--version") == 0) {
    printf("cellist %s\n", CELLIST_VERSION_STRING);
    return terminal_finish();
  }
  for (size_t i = 0; i < COMMAND_COUNT; i++)
    if (strcmp(argv[1], COMMANDS[i].name) == 0) return COMMANDS[i].run(argc - 1, argv + 1);
  fprintf(stderr, "cellist: there is no command '%s' (see cellist --help)\n", argv[1]);
  return 2;
}
