/* SPDX-License-Identifier: BSD-3-Clause
 * The subcommands of `cellist`, one file each. argv[0] is the subcommand's name; the result is the exit status. */
#ifndef CELLIST_TOOLS_COMMAND_H
#define CELLIST_TOOLS_COMMAND_H

int command_info(int argc, char **argv);
int command_generate(int argc, char **argv);
int command_convexify(int argc, char **argv);
int command_convert(int argc, char **argv);
int command_render(int argc, char **argv);
int command_compare(int argc, char **argv);
int command_report(int argc, char **argv);
int command_sort(int argc, char **argv);

#endif
