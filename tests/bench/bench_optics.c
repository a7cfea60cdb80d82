/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of pre-integration, as CSV: for each transfer function and size, processor seconds on one worker to make
 * the tables (unlit, lit) and to make them anew for a changed transfer function, and their error against quadrature: at
 * nodes, and between nodes at random scalars and lengths (premultiplied colour and opacity, root of the mean square and
 * largest).
 * Arguments: sizes NxL; none: the usual ones. */
#include <base/random.h>
#include <cellist/preintegration.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "../optics/segment.h"

static double processor_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void check(cellist_context *context, cellist_result result, const char *what) {
  if (result == CELLIST_SUCCESS) return;
  fprintf(stderr, "bench_optics: %s: %s\n", what, cellist_context_take_error(context));
  exit(1);
}

enum { REPEATS = 5, SAMPLES = 20000 };

/* The least of several times: of making the tables, and of making them anew. */
static void measure(cellist_context *context, const cellist_preintegration_desc *desc, const cellist_transfer *transfer,
                    double *create, double *update) {
  *create = *update = HUGE_VAL;
  for (int i = 0; i < REPEATS; i++) {
    cellist_preintegration *tables = NULL;
    double begin = processor_seconds();
    check(context, cellist_preintegration_create(context, desc, transfer, &tables), "create");
    *create = fmin(*create, processor_seconds() - begin);
    begin = processor_seconds();
    check(context, cellist_preintegration_update(tables, transfer), "update");
    *update = fmin(*update, processor_seconds() - begin);
    cellist_preintegration_destroy(tables);
  }
}

struct error {
  double square, most;
  size_t count;
};

static void note(struct error *error, double difference) {
  error->square += difference * difference;
  error->most = fmax(error->most, fabs(difference));
  error->count++;
}

static double rms(const struct error *error) { return sqrt(error->square / (double)error->count); }

static void compare(const cellist_preintegration *tables, const cellist_transfer *transfer, double front, double back,
                    double length, struct error *error, struct error *light) {
  cellist_preintegrated found;
  cellist_preintegration_look_up(tables, front, back, length, &found);
  const segment truth = segment_integrate(transfer, front, back, length);
  note(error, found.opacity - truth.opacity);
  for (int c = 0; c < 3; c++) {
    note(error, found.colour[c] - truth.colour[c]);
    note(light, found.front[c] - truth.front[c]);
    note(light, found.back[c] - truth.back[c]);
  }
}

static void bench(cellist_context *context, const char *name, uint32_t scalars, uint32_t lengths) {
  /* Segments up to the opacities' unit, most a tenth of it; the tables' last finite length is the longest. */
  const cellist_transfer_desc transfer_desc = {.source = name, .range = {0, 1}, .unit_distance = 1};
  cellist_transfer transfer;
  check(context, cellist_transfer_load(context, &transfer_desc, &transfer), name);
  cellist_preintegration_desc desc = {0, 1, 1 / log2(lengths - 1), scalars, lengths, false};
  double create, update, lit_create, lit_update;
  measure(context, &desc, &transfer, &create, &update);
  desc.lit = true;
  measure(context, &desc, &transfer, &lit_create, &lit_update);
  cellist_preintegration *tables = NULL;
  check(context, cellist_preintegration_create(context, &desc, &transfer, &tables), "create");
  struct error at_nodes = {0}, between = {0}, lit = {0};
  random_state random = {11};
  for (int i = 0; i < SAMPLES; i++) {
    const double f = (double)random_below(&random, scalars), b = (double)random_below(&random, scalars);
    const double k = (double)random_below(&random, lengths - 1);
    compare(tables, &transfer, f / (scalars - 1), b / (scalars - 1), -desc.length_unit * log2(1 - k / (lengths - 1)),
            &at_nodes, &lit);
    const double front = random_unit(&random), length = fmin(1, -0.1 * log(1 - random_unit(&random)));
    const double back = fmin(1, fmax(0, front + random_between(&random, -2, 2) * length));
    compare(tables, &transfer, front, back, length, &between, &lit);
  }
  printf("%s,%zu,%u,%u,%.5f,%.5f,%.5f,%.5f,%.3g,%.3g,%.3g,%.3g,%.3g,%.3g\n", name, transfer.knot_count, scalars,
         lengths, create, update, lit_create, lit_update, rms(&at_nodes), at_nodes.most, rms(&between), between.most,
         rms(&lit), lit.most);
  fflush(stdout);
  cellist_preintegration_destroy(tables);
  cellist_transfer_release(context, &transfer);
}

int main(int argc, char **argv) {
  static const char *const functions[] = {"ramp", "dense", "spikes", "viridis"};
  static const char *const usual[] = {"32x32", "64x32", "64x64", "128x64", "128x128", "128x256"};
  cellist_context *context = NULL;
  const cellist_context_desc desc = {.worker_count = 1};
  if (cellist_context_create(&desc, &context) != CELLIST_SUCCESS) return 1;
  printf(
      "transfer,knots,scalars,lengths,create_seconds,update_seconds,lit_create_seconds,lit_update_seconds,node_rmse,"
      "node_max,rmse,max,lit_rmse,lit_max\n");
  for (size_t f = 0; f < sizeof functions / sizeof *functions; f++)
    for (int i = 0; i < (argc > 1 ? argc - 1 : (int)(sizeof usual / sizeof *usual)); i++) {
      unsigned scalars = 0, lengths = 0;
      if (sscanf(argc > 1 ? argv[i + 1] : usual[i], "%ux%u", &scalars, &lengths) != 2 || scalars < 2 || lengths < 3)
        return 2;
      bench(context, functions[f], scalars, lengths);
    }
  cellist_context_destroy(context);
  return 0;
}
