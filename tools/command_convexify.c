/* SPDX-License-Identifier: BSD-3-Clause
 * cellist convexify: fills what lies between a mesh and its convex hull with convex cells, once, into a file. */
#include <cellist/convexify.h>
#include <cellist/order.h>
#include <cellist/pipeline.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include "clock.h"
#include "command.h"
#include "mesh_options.h"
#include "movie.h"
#include "terminal.h"

static const char *const EXTERIORS[] = {"hull", "box", "grid", "delaunay"};

/* The most memory that the process has held, in MB (Linux counts it in KiB). */
static double peak_megabytes(void) {
  struct rusage usage;
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return (double)usage.ru_maxrss * 1024 / 1e6;
}

static int report_json(const cellist_convexify_stats *s, const char *reason, double seconds) {
  return terminal_print_json(
      json_pack("{s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:f, s:f, s:f, s:I, s:f, s:b, s:I, s:f, s:f}",
                "exterior", EXTERIORS[s->exterior], "exterior_reason", reason, "exterior_facets",
                (json_int_t)s->exterior_facets, "imaginary_cells", (json_int_t)s->imaginary_cells, "facets",
                (json_int_t)s->facets, "planes", (json_int_t)s->planes, "cuts", (json_int_t)s->cuts, "merges",
                (json_int_t)s->merges, "hull_volume", s->hull_volume, "mesh_volume", s->mesh_volume, "imaginary_volume",
                s->imaginary_volume, "volume_error", s->volume_error, "seconds", seconds, "convexity_violations",
                (json_int_t)s->convexity_violations, "peak_mb", peak_megabytes(), "cached", s->cached, "flat_edges",
                (json_int_t)s->flat_edges, "flat_angle", s->flat_angle, "flat_distance", s->flat_distance));
}

static int report_text(const cellist_convexify_stats *s, const char *reason, double seconds) {
  printf("exterior          %s (%s)\n", EXTERIORS[s->exterior], reason);
  printf("imaginary cells   %zu\n", s->imaginary_cells);
  printf("facets            %zu in %zu planes\n", s->facets, s->planes);
  printf("cuts, merges      %zu, %zu\n", s->cuts, s->merges);
  printf("volume            hull %.9g = mesh %.9g + imaginary %.9g, off by %.2g of the hull\n", s->hull_volume,
         s->mesh_volume, s->imaginary_volume, s->volume_error);
  if (s->flat_edges > 0)
    printf("left flat         %zu edges of %.3g degrees at most; no cell stands farther than %.3g beyond a facet\n",
           s->flat_edges, s->flat_angle, s->flat_distance);
  printf("seconds           %.3f%s\n", seconds, s->cached ? ", read from the file" : "");
  return terminal_finish();
}

/* What the command makes: a complex of its own, or one of an order's. */
struct made {
  cellist_order *order;
  cellist_complex *own;
  const cellist_complex *complex;
  cellist_convexify_stats stats;
  const char *reason;
};

static cellist_result make(cellist_context *context, const cellist_mesh *mesh, const cellist_convexify_desc *desc,
                           bool choose, const char *path, struct made *made) {
  if (choose) {
    const cellist_order_desc how = {.convexify = desc, .needs_complex = true, .cache_file = path};
    const cellist_result result = cellist_order_create(context, mesh, &how, &made->order);
    if (result != CELLIST_SUCCESS) return result;
    made->reason = cellist_order_get_facts(made->order)->reason;
    made->complex = cellist_order_get_complex(made->order);
    if (made->complex != NULL) made->stats = *cellist_order_get_convexify_stats(made->order);
    if (made->complex != NULL) return CELLIST_SUCCESS;
  }
  /* Also for a convex mesh, where there is nothing to choose, and to say why nothing can be made. */
  const cellist_result result = cellist_convexify_cached(context, mesh, desc, path, &made->own, &made->stats);
  if (result != CELLIST_SUCCESS) return result;
  made->complex = made->own;
  if (choose && !made->stats.cached) {
    char note[CELLIST_CELLS_NOTE];
    snprintf(note, sizeof note, "%s: %s", EXTERIORS[made->stats.exterior], made->reason);
    return cellist_cells_write(context, path, cellist_cells_key_of(mesh, desc, 0), made->own, &made->stats, note);
  }
  if (!choose)
    made->reason = made->stats.exterior == desc->exterior ? "asked for" : "the boundary was refused by TetGen";
  return CELLIST_SUCCESS;
}

int command_convexify(int argc, char **argv) {
  const char *output = NULL, *movie = NULL, *exterior = "hull", *score = "own";
  unsigned candidates = 0, grid_size = 0;
  unsigned long long seed = 1;
  double flat = 0;
  bool json = false, keep_unmerged = false;
  mesh_options options;
  option_spec mesh_table[MESH_OPTION_COUNT];
  mesh_options_init(&options, mesh_table);
  const option_spec table[] = {
      {"o", "FILE.cells", "where the result is kept; read if it is there and fits", OPTION_TEXT, &output},
      {"exterior", "hull|box|grid|delaunay|auto", "what is added (hull); auto: the one that sorts fastest",
       OPTION_CHOICE, &exterior},
      {"candidates", "K", "reflex edges whose planes compete for a cut (20)", OPTION_COUNT, &candidates},
      {"score", "own|paper", "how candidates are compared (own)", OPTION_CHOICE, &score},
      {"flat", "DEGREES", "reflex edges this flat count as flat (0: none); the error is stated", OPTION_NUMBER, &flat},
      {"seed", "N", "of the random choice of candidates (1)", OPTION_SEED, &seed},
      {"grid-size", "N", "grid: planes along the longest axis", OPTION_COUNT, &grid_size},
      {"no-merge", "", "do not join neighbours whose union is convex", OPTION_FLAG, &keep_unmerged},
      {"movie", "DIR", "write the cutting as pictures: DIR/0000.png, ...", OPTION_TEXT, &movie},
      {"json", "", "print one JSON object", OPTION_FLAG, &json},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  static const char *const examples[] = {"cellist convexify mesh.vtu -o mesh.cells",
                                         "cellist convexify sample:gears -o gears.cells --exterior delaunay --json",
                                         "cellist convexify sample:gears -o gears.cells --movie pictures", NULL};
  const command_usage usage = {"convexify",
                               "MESH -o FILE.cells",
                               "Makes a mesh convex: fills the rest of its hull with convex cells, exactly.",
                               1,
                               1,
                               examples,
                               {table, mesh_table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);
  cellist_mesh_read_desc read_desc;
  const char *wrong = mesh_options_resolve(&options, &read_desc);
  if (wrong != NULL) return wrong_usage("convexify", "%s", wrong);
  if (!(flat >= 0 && flat < 90)) return wrong_usage("convexify", "--flat takes 0 to below 90 degrees");
  if (output == NULL) return wrong_usage("convexify", "-o FILE.cells is missing");

  cellist_convexify_desc desc = {.candidates = candidates,
                                 .score = strcmp(score, "paper") == 0 ? CELLIST_SCORE_PAPER : CELLIST_SCORE_OWN,
                                 .seed = seed,
                                 .flat_degrees = flat,
                                 .keep_unmerged = keep_unmerged,
                                 .grid_size = grid_size};
  for (int i = 0; i < 4; i++)
    if (strcmp(exterior, EXTERIORS[i]) == 0) desc.exterior = (cellist_exterior)i;

  cellist_context *context = terminal_context(0);
  if (context == NULL) return 1;
  cellist_mesh *mesh = NULL;
  struct made made = {0};
  cellist_result result = cellist_pipeline_load(context, argv[1], &read_desc, &mesh);
  const double begin = clock_seconds();
  if (result == CELLIST_SUCCESS) result = make(context, mesh, &desc, strcmp(exterior, "auto") == 0, output, &made);
  const double seconds = clock_seconds() - begin;
  size_t pictures = 0;
  if (result == CELLIST_SUCCESS && movie != NULL) result = movie_write(context, mesh, made.complex, movie, &pictures);
  int status = 0;
  if (result != CELLIST_SUCCESS) {
    status = terminal_failure(context, result);
  } else {
    terminal_clear_progress();
    status = json ? report_json(&made.stats, made.reason, seconds) : report_text(&made.stats, made.reason, seconds);
  }
  cellist_complex_destroy(made.own);
  cellist_order_destroy(made.order);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  return status;
}
