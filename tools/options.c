/* SPDX-License-Identifier: BSD-3-Clause
 * Options: getopt_long driven by our tables. */
#include "options.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_OPTIONS = 96, HELP_CODE = MAX_OPTIONS, FIRST_CODE = 256 };

int wrong_usage(const char *command, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fprintf(stderr, "cellist %s: ", command);
  vfprintf(stderr, format, arguments);
  fprintf(stderr, " (see cellist %s --help)\n", command);
  va_end(arguments);
  return 2;
}

static bool parse_number(const char *text, double *value, const char **end) {
  char *stop = NULL;
  errno = 0;
  *value = strtod(text, &stop);
  *end = stop;
  return stop != text && isfinite(*value);
}

static bool parse_count(const char *text, unsigned *value, const char **end) {
  char *stop = NULL;
  errno = 0;
  const unsigned long parsed = strtoul(text, &stop, 10);
  *end = stop;
  *value = (unsigned)parsed;
  return stop != text && text[0] != '-' && errno == 0 && parsed >= 1 && parsed <= 2147483647;
}

static bool parse_numbers(const char *text, number_list *list) {
  number_list parsed = {.expected = list->expected};
  for (const char *at = text;; at++) {
    const char *end = NULL;
    if (parsed.count == LIST_CAPACITY || !parse_number(at, &parsed.value[parsed.count], &end)) return false;
    parsed.count++;
    if (*end == '\0') break;
    if (*end != ',') return false;
    at = end;
  }
  if (parsed.expected > 0 && parsed.count != parsed.expected) return false;
  *list = parsed;
  return true;
}

static bool parse_size(const char *text, unsigned size[2]) {
  unsigned parsed[2];
  const char *end = NULL;
  if (!parse_count(text, &parsed[0], &end) || *end != 'x') return false;
  if (!parse_count(end + 1, &parsed[1], &end) || *end != '\0') return false;
  size[0] = parsed[0];
  size[1] = parsed[1];
  return true;
}

static bool is_choice(const char *choices, const char *word) {
  const size_t length = strlen(word);
  for (const char *at = choices; at != NULL && length > 0; at = strchr(at, '|')) {
    at += *at == '|';
    if (strncmp(at, word, length) == 0 && (at[length] == '|' || at[length] == '\0')) return true;
  }
  return false;
}

/* NULL if all is well, else what the argument should have been. */
static const char *store(const option_spec *option, const char *argument) {
  const char *end = "";
  switch (option->kind) {
    case OPTION_FLAG: *(bool *)option->target = true; return NULL;
    case OPTION_TEXT: *(const char **)option->target = argument; return NULL;
    case OPTION_OPTIONAL: *(const char **)option->target = argument != NULL ? argument : ""; return NULL;
    case OPTION_NUMBER: {
      double value = 0;
      if (!parse_number(argument, &value, &end) || *end != '\0') return "a finite number";
      *(double *)option->target = value;
      return NULL;
    }
    case OPTION_COUNT: {
      unsigned value = 0;
      if (!parse_count(argument, &value, &end) || *end != '\0') return "a whole number from 1 on";
      *(unsigned *)option->target = value;
      return NULL;
    }
    case OPTION_SEED: {
      char *stop = NULL;
      errno = 0;
      const unsigned long long value = strtoull(argument, &stop, 10);
      if (stop == argument || *stop != '\0' || errno != 0 || argument[0] == '-') return "a whole number";
      *(unsigned long long *)option->target = value;
      return NULL;
    }
    case OPTION_NUMBERS: return parse_numbers(argument, option->target) ? NULL : option->argument;
    case OPTION_SIZE: return parse_size(argument, option->target) ? NULL : "WIDTHxHEIGHT, each at least 1";
    case OPTION_CHOICE:
      if (!is_choice(option->argument, argument)) return option->argument;
      *(const char **)option->target = argument;
      return NULL;
    case OPTION_TEXTS: {
      text_list *list = option->target;
      if (list->count == LIST_CAPACITY) return "fewer of them";
      list->value[list->count++] = argument;
      return NULL;
    }
  }
  return "something else";
}

static void print_option(const char *name, const char *argument, option_kind kind, const char *help) {
  char left[96];
  const char *dashes = strlen(name) == 1 ? "-" : "--";
  const char *joint = kind == OPTION_FLAG || kind == OPTION_OPTIONAL ? "" : " ";
  snprintf(left, sizeof left, "%s%s%s%s", dashes, name, joint, argument);
  if (strlen(left) > 26)
    printf("  %s\n  %-26s %s\n", left, "", help);
  else
    printf("  %-26s %s\n", left, help);
}

static void print_help(const command_usage *usage) {
  printf("usage: cellist %s %s [options]\n\n%s\n\n", usage->name, usage->arguments, usage->summary);
  for (size_t t = 0; t < MAX_TABLES && usage->table[t] != NULL; t++)
    for (const option_spec *option = usage->table[t]; option->name != NULL; option++)
      print_option(option->name, option->argument, option->kind, option->help);
  print_option("help", "", OPTION_FLAG, "this page");
  printf("\nexamples:\n");
  for (size_t i = 0; usage->examples[i] != NULL; i++) printf("  %s\n", usage->examples[i]);
}

parse_result options_parse(const command_usage *usage, int argc, char **argv, size_t *positional_count) {
  const option_spec *spec[MAX_OPTIONS];
  struct option longs[MAX_OPTIONS + 2];
  int count = 0;
  for (size_t t = 0; t < MAX_TABLES && usage->table[t] != NULL; t++)
    for (const option_spec *option = usage->table[t]; option->name != NULL && count < MAX_OPTIONS; option++) {
      const int has = option->kind == OPTION_FLAG       ? no_argument
                      : option->kind == OPTION_OPTIONAL ? optional_argument
                                                        : required_argument;
      spec[count] = option;
      longs[count] = (struct option){option->name, has, NULL, FIRST_CODE + count};
      count++;
    }
  longs[count] = (struct option){"help", no_argument, NULL, FIRST_CODE + HELP_CODE};
  longs[count + 1] = (struct option){0};

  opterr = 0;
  optind = 0; /* glibc: start anew, subcommands may be run one after the other */
  for (;;) {
    const int before = optind == 0 ? 1 : optind;
    int code = getopt_long(argc, argv, ":o:", longs, NULL);
    if (code == -1) break;
    if (code == FIRST_CODE + HELP_CODE) {
      print_help(usage);
      return PARSE_HELP_SHOWN;
    }
    if (code == 'o') {
      for (int i = 0; i < count; i++)
        if (strcmp(spec[i]->name, "o") == 0) code = FIRST_CODE + i;
    }
    if (code == ':') {
      wrong_usage(usage->name, "%s needs an argument", argv[optind - 1]);
      return PARSE_WRONG;
    }
    if (code < FIRST_CODE) {
      wrong_usage(usage->name, "there is no option %s", argv[optind > before ? optind - 1 : before]);
      return PARSE_WRONG;
    }
    const option_spec *option = spec[code - FIRST_CODE];
    const char *expected = store(option, optarg);
    if (expected != NULL) {
      wrong_usage(usage->name, "%s%s '%s': expected %s", strlen(option->name) == 1 ? "-" : "--", option->name, optarg,
                  expected);
      return PARSE_WRONG;
    }
  }
  *positional_count = (size_t)(argc - optind);
  for (size_t i = 0; i < *positional_count; i++) argv[1 + i] = argv[(size_t)optind + i];
  if (*positional_count < usage->minimum || *positional_count > usage->maximum) {
    wrong_usage(usage->name, "expected %s", usage->arguments);
    return PARSE_WRONG;
  }
  return PARSE_OK;
}
