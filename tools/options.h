/* SPDX-License-Identifier: BSD-3-Clause
 * Options: one table says what a subcommand accepts; parsing and --help both read it. */
#ifndef CELLIST_TOOLS_OPTIONS_H
#define CELLIST_TOOLS_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

typedef enum option_kind {
  OPTION_FLAG,     /* bool *                       --strict */
  OPTION_TEXT,     /* const char **                --scalar NAME */
  OPTION_NUMBER,   /* double *, finite             --near D */
  OPTION_COUNT,    /* unsigned *, at least 1       --frames N */
  OPTION_SEED,     /* unsigned long long *         --seed N */
  OPTION_NUMBERS,  /* number_list *                --eye X,Y,Z */
  OPTION_SIZE,     /* unsigned[2]                  --size WxH */
  OPTION_CHOICE,   /* const char **, of choices    --renderer faces|cast */
  OPTION_TEXTS,    /* text_list *, may be repeated --peer NAME */
  OPTION_OPTIONAL, /* const char **, "" if bare    --merge[=DISTANCE] */
} option_kind;

enum { LIST_CAPACITY = 32 };

/* Numbers separated by commas; capacity says how many are asked for (0: one or more). */
typedef struct number_list {
  size_t expected, count;
  double value[LIST_CAPACITY];
} number_list;

typedef struct text_list {
  size_t count;
  const char *value[LIST_CAPACITY];
} text_list;

/* A table ends with an entry without a name. */
typedef struct option_spec {
  const char *name;     /* without the dashes; "o" is the only short one */
  const char *argument; /* as help shows it; for OPTION_CHOICE the words, separated by | */
  const char *help;
  option_kind kind;
  void *target; /* left alone unless the option is given */
} option_spec;

enum { MAX_TABLES = 6 };

/* What a subcommand is called with, for parsing and for --help. */
typedef struct command_usage {
  const char *name, *arguments, *summary;
  size_t minimum, maximum;              /* how many positional arguments */
  const char *const *examples;          /* ends with NULL */
  const option_spec *table[MAX_TABLES]; /* the first NULL ends it */
} command_usage;

typedef enum parse_result { PARSE_OK, PARSE_HELP_SHOWN, PARSE_WRONG } parse_result;

/* Parses argv (argv[0] is the subcommand's name), permutes it so that positional arguments come first from
 * argv[1] on, and counts them. Wrong usage prints one line on standard error, --help the page on standard output. */
parse_result options_parse(const command_usage *usage, int argc, char **argv, size_t *positional_count);

/* Exit status for a parse that is not PARSE_OK. */
static inline int parse_exit(parse_result result) { return result == PARSE_HELP_SHOWN ? 0 : 2; }

/* Says on standard error what is wrong with the usage; returns 2, for return wrong_usage(...). */
int wrong_usage(const char *command, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
