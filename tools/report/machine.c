/* SPDX-License-Identifier: BSD-3-Clause
 * Machine: where and with what a report was made, so that it can be repeated. */
#include <cellist/version.h>
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "../terminal.h"
#include "report.h"

/* The first "model name" of /proc/cpuinfo. */
static void set_processor(json_t *machine) {
  FILE *file = fopen("/proc/cpuinfo", "r");
  char line[512];
  while (file != NULL && fgets(line, sizeof line, file) != NULL) {
    char *colon = strchr(line, ':');
    if (strncmp(line, "model name", 10) != 0 || colon == NULL) continue;
    line[strcspn(line, "\n")] = '\0';
    json_object_set_new(machine, "processor", terminal_text(colon + 2));
    break;
  }
  if (file != NULL) fclose(file);
}

static void set_output_of(json_t *machine, const char *name, const char *command) {
  FILE *pipe = popen(command, "r");
  char line[256] = "";
  if (pipe != NULL && fgets(line, sizeof line, pipe) != NULL) {
    line[strcspn(line, "\n")] = '\0';
    json_object_set_new(machine, name, terminal_text(line));
  }
  if (pipe != NULL) pclose(pipe);
}

json_t *report_machine(void) {
  json_t *machine = json_object();
  set_processor(machine);
  json_object_set_new(machine, "processors", json_integer(sysconf(_SC_NPROCESSORS_ONLN)));
  const double gibibytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE) / 0x1p30;
  json_object_set_new(machine, "memory_gib", json_real(gibibytes));
  struct utsname system;
  if (uname(&system) == 0) {
    char text[256];
    snprintf(text, sizeof text, "%.60s %.100s %.60s", system.sysname, system.release, system.machine);
    json_object_set_new(machine, "system", terminal_text(text));
  }
#ifdef __clang__
  json_object_set_new(machine, "compiler", terminal_text(__VERSION__));
#else
  json_object_set_new(machine, "compiler", terminal_text("gcc " __VERSION__));
#endif
#ifdef NDEBUG
  json_object_set_new(machine, "assertions", json_false());
#else
  json_object_set_new(machine, "assertions", json_true());
#endif
  json_object_set_new(machine, "cellist", json_string(CELLIST_VERSION_STRING));
  set_output_of(machine, "gnuplot", "gnuplot --version 2>/dev/null");
  const time_t now = time(NULL);
  struct tm broken;
  char date[64] = "";
  if (gmtime_r(&now, &broken) != NULL) strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", &broken);
  json_object_set_new(machine, "date", json_string(date));
  return machine;
}
