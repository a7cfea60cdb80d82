/* SPDX-License-Identifier: BSD-3-Clause
 * cellist sort: a mesh's cells in visibility order, how long that takes, whether it is right, and how peers fare. */
#include <cellist/order.h>
#include <cellist/pipeline.h>
#include <cellist/sort.h>
#include <cellist/sort_peers.h>
#include <cellist/sort_verify.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "command.h"
#include "mesh_options.h"
#include "order_options.h"
#include "terminal.h"
#include "view_options.h"

struct sort_options {
  unsigned views, repeat, threads, rays;
  const char *order;
  text_list peers;
  bool json;
};

/* One way to sort, over all views. */
struct score {
  const char *name;
  double *seconds; /* [views * repeat] */
  size_t count;
  size_t rays, pairs, inversions, group_pairs, overlaps, violations;
};

struct totals {
  bool exact;
  size_t left_cells, component_cells, groups, largest_group, cells_in_groups, unsorted, exact_signs, gap_candidates,
      gap_arcs;
};

/* Everything that the run holds. */
struct run {
  const struct sort_options *options;
  cellist_context *context;
  const cellist_mesh_arrays *arrays;
  cellist_sorter_desc desc;
  const cellist_mesh *mesh;
  cellist_order_desc order_desc;
  cellist_order *made; /* the sorter and its exterior */
  cellist_sorter *sorter;
  cellist_verifier *verifier;
  cellist_peer *peers[LIST_CAPACITY];
  struct score scores[LIST_CAPACITY + 1]; /* ours first */
  struct totals totals;
  uint32_t *order;
  uint8_t *seen; /* [tet_count] */
};

static double median(struct score *score) { return terminal_median(score->seconds, score->count); }

/* View i of n: directions on a golden spiral, at the distance that --orbit has. */
static cellist_view spread_view(const double bounds[6], unsigned i, unsigned n) {
  const double golden = 137.50776405003785, degrees = 180 / acos(-1);
  const double elevation = asin((2 * i + 1.0) / n - 1) * degrees;
  return cellist_view_orbit(bounds, fmod(golden * i, 360), elevation);
}

static cellist_viewpoint viewpoint_of(const cellist_view *view) {
  cellist_viewpoint viewpoint = {{0, 0, 0}, view->parallel_height > 0};
  for (int k = 0; k < 3; k++)
    viewpoint.position[k] = viewpoint.parallel ? view->target[k] - view->eye[k] : view->eye[k];
  return viewpoint;
}

static cellist_result check(struct run *run, const cellist_viewpoint *viewpoint, const cellist_group *groups,
                            size_t group_count, unsigned view, struct score *score) {
  if (run->verifier == NULL) return CELLIST_SUCCESS;
  cellist_verification found;
  const size_t rays = (run->options->rays + run->options->views - 1) / run->options->views;
  cellist_result result =
      cellist_verifier_check(run->verifier, viewpoint, run->order, groups, group_count, rays, view, &found);
  cellist_certificate certificate;
  if (result == CELLIST_SUCCESS)
    result = cellist_order_certify(run->context, &run->desc, viewpoint, run->order, groups, group_count, &certificate);
  if (result != CELLIST_SUCCESS) return result;
  score->violations += certificate.violations;
  score->rays += found.ray_count;
  score->pairs += found.pairs;
  score->inversions += found.inversions;
  score->group_pairs += found.group_pairs;
  score->overlaps += found.overlaps;
  return CELLIST_SUCCESS;
}

static size_t count_unsorted(struct run *run) {
  size_t missing = 0;
  memset(run->seen, 0, run->desc.tet_count);
  for (size_t i = 0; i < run->desc.tet_count; i++)
    if (run->order[i] < run->desc.tet_count) run->seen[run->order[i]] = 1;
  for (size_t i = 0; i < run->desc.tet_count; i++) missing += run->seen[i] == 0;
  return missing;
}

static cellist_result sort_view(struct run *run, const cellist_viewpoint *viewpoint, unsigned view) {
  cellist_sort_stats stats = {0};
  cellist_result result = CELLIST_SUCCESS;
  for (unsigned i = 0; i < run->options->repeat && result == CELLIST_SUCCESS; i++) {
    const double begin = clock_seconds();
    result = cellist_sorter_sort(run->sorter, viewpoint, run->order, &stats);
    run->scores[0].seconds[run->scores[0].count++] = clock_seconds() - begin;
  }
  if (result != CELLIST_SUCCESS) return result;
  struct totals *totals = &run->totals;
  totals->exact &= stats.exact;
  totals->groups += stats.group_count;
  totals->cells_in_groups += stats.cells_in_groups;
  if (stats.largest_group > totals->largest_group) totals->largest_group = stats.largest_group;
  totals->unsorted += count_unsorted(run);
  totals->exact_signs += stats.exact_sign_count;
  totals->left_cells += stats.left_cell_count;
  totals->component_cells += stats.component_cell_count;
  totals->gap_candidates += stats.gap_candidate_count;
  totals->gap_arcs += stats.gap_arc_count;
  const cellist_group *groups = NULL;
  size_t group_count = 0;
  cellist_sorter_groups(run->sorter, &groups, &group_count);
  return check(run, viewpoint, groups, group_count, view, &run->scores[0]);
}

static cellist_result sort_peers(struct run *run, const cellist_viewpoint *viewpoint, unsigned view) {
  for (size_t p = 0; p < run->options->peers.count; p++) {
    struct score *score = &run->scores[p + 1];
    cellist_result result = CELLIST_SUCCESS;
    for (unsigned i = 0; i < run->options->repeat && result == CELLIST_SUCCESS; i++) {
      const double begin = clock_seconds();
      result = cellist_peer_sort(run->peers[p], viewpoint, run->order);
      score->seconds[score->count++] = clock_seconds() - begin;
    }
    if (result == CELLIST_SUCCESS) result = check(run, viewpoint, NULL, 0, view, score);
    if (result != CELLIST_SUCCESS) return result;
  }
  return CELLIST_SUCCESS;
}

/* Writes "cell_id tet_index" a line, far to near: the cell's id in the user's file, and which of the cell's tets it is
 * (0 unless the cell was split); a group between lines "[" and "]". */
static cellist_result write_order(struct run *run, const char *path) {
  const uint32_t *origin = run->arrays->tet_origin;
  const size_t count = run->arrays->tet_count;
  uint32_t last = 0;
  for (size_t i = 0; i < count; i++) last = origin[i] > last ? origin[i] : last;
  uint32_t *counts = cellist_allocate_zeroed(run->context, (size_t)last + 1, sizeof *counts);
  uint32_t *index = cellist_allocate(run->context, count, sizeof *index);
  const bool is_output = strcmp(path, "-") == 0;
  FILE *file = counts == NULL || index == NULL ? NULL : is_output ? stdout : fopen(path, "w");
  cellist_result result = CELLIST_SUCCESS;
  if (counts == NULL || index == NULL)
    result = CELLIST_ERROR_OUT_OF_MEMORY;
  else if (file == NULL)
    result = cellist_fail(run->context, CELLIST_ERROR_IO, "%s: cannot be written", path);
  if (result == CELLIST_SUCCESS) {
    for (size_t i = 0; i < count; i++) index[i] = counts[origin[i]]++;
    const cellist_group *groups = NULL;
    size_t group_count = 0, g = 0;
    cellist_sorter_groups(run->sorter, &groups, &group_count);
    for (size_t i = 0; i < count; i++) {
      if (g < group_count && groups[g].begin == i) fputs("[\n", file);
      fprintf(file, "%u %u\n", origin[run->order[i]], index[run->order[i]]);
      if (g < group_count && groups[g].begin + groups[g].count == i + 1) {
        fputs("]\n", file);
        g++;
      }
    }
    const bool is_lost = ferror(file) != 0;
    if ((!is_output && fclose(file) != 0) || is_lost)
      result = cellist_fail(run->context, CELLIST_ERROR_IO, "%s: cannot be written", path);
  }
  cellist_deallocate(run->context, counts);
  cellist_deallocate(run->context, index);
  return result;
}

static cellist_result prepare(struct run *run) {
  const struct sort_options *options = run->options;
  const cellist_mesh_arrays *a = run->arrays;
  run->desc = (cellist_sorter_desc){.point_count = a->point_count,
                                    .points = a->positions,
                                    .tet_count = a->tet_count,
                                    .tets = a->tets,
                                    .neighbours = a->neighbours};
  run->totals.exact = true;
  run->order = cellist_allocate(run->context, a->tet_count, sizeof *run->order);
  run->seen = cellist_allocate(run->context, a->tet_count, 1);
  if (run->order == NULL || run->seen == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = cellist_order_create(run->context, run->mesh, &run->order_desc, &run->made);
  if (result == CELLIST_SUCCESS) run->sorter = cellist_order_sorter(run->made);
  if (result == CELLIST_SUCCESS && options->rays > 0)
    result = cellist_verifier_create(run->context, &run->desc, &run->verifier);
  for (size_t p = 0; p <= options->peers.count && result == CELLIST_SUCCESS; p++) {
    run->scores[p].name = p == 0 ? "cellist" : options->peers.value[p - 1];
    run->scores[p].seconds = cellist_allocate(run->context, (size_t)options->views * options->repeat, sizeof(double));
    if (run->scores[p].seconds == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    if (p > 0) result = cellist_peer_create(run->context, &run->desc, run->scores[p].name, &run->peers[p - 1]);
  }
  return result;
}

static void release(struct run *run) {
  for (size_t p = 0; p <= run->options->peers.count; p++) {
    cellist_deallocate(run->context, run->scores[p].seconds);
    if (p > 0) cellist_peer_destroy(run->peers[p - 1]);
  }
  cellist_verifier_destroy(run->verifier);
  cellist_order_destroy(run->made);
  cellist_deallocate(run->context, run->seen);
  cellist_deallocate(run->context, run->order);
}

static int report_json(struct run *run, size_t cell_count) {
  const double views = run->options->views, seconds = median(&run->scores[0]);
  const struct totals *totals = &run->totals;
  json_t *object = json_object();
  json_object_set_new(object, "cells", json_integer((json_int_t)cell_count));
  json_object_set_new(object, "tets", json_integer((json_int_t)run->desc.tet_count));
  const cellist_order_facts *facts = cellist_order_get_facts(run->made);
  json_object_set_new(object, "imaginary_cells", json_integer((json_int_t)facts->imaginary_cells));
  json_object_set_new(object, "exterior", json_string(facts->exterior));
  json_object_set_new(object, "exterior_reason", json_string(facts->reason));
  json_object_set_new(object, "exterior_seconds", json_real(facts->seconds));
  json_object_set_new(object, "cached", json_boolean(facts->cached));
  json_object_set_new(object, "order", json_string(totals->exact ? "exact" : "approximate"));
  json_object_set_new(object, "views", json_integer(run->options->views));
  json_object_set_new(object, "seconds_median", json_real(seconds));
  json_object_set_new(object, "mcells_per_second",
                      terminal_number(seconds > 0 ? 1e-6 * (double)run->desc.tet_count / seconds : 0));
  json_object_set_new(object, "groups", json_real((double)totals->groups / views));
  json_object_set_new(object, "largest_group", json_integer((json_int_t)totals->largest_group));
  json_object_set_new(object, "cells_in_groups", json_real((double)totals->cells_in_groups / views));
  json_object_set_new(object, "unsorted", json_integer((json_int_t)totals->unsorted));
  json_object_set_new(object, "exact_signs", json_real((double)totals->exact_signs / views));
  json_object_set_new(object, "left_cells", json_real((double)totals->left_cells / views));
  json_object_set_new(object, "component_cells", json_real((double)totals->component_cells / views));
  json_object_set_new(object, "gap_candidates", json_real((double)totals->gap_candidates / views));
  json_object_set_new(object, "gap_arcs", json_real((double)totals->gap_arcs / views));
  json_object_set_new(object, "rays", json_integer((json_int_t)run->scores[0].rays));
  json_object_set_new(object, "pairs", json_integer((json_int_t)run->scores[0].pairs));
  json_object_set_new(object, "inversions", json_integer((json_int_t)run->scores[0].inversions));
  json_object_set_new(object, "group_pairs", json_integer((json_int_t)run->scores[0].group_pairs));
  json_object_set_new(object, "overlaps", json_integer((json_int_t)run->scores[0].overlaps));
  json_object_set_new(object, "violations", json_integer((json_int_t)run->scores[0].violations));
  json_t *peers = json_array();
  for (size_t p = 1; p <= run->options->peers.count; p++) {
    struct score *score = &run->scores[p];
    json_array_append_new(peers, json_pack("{s:s, s:f, s:I, s:I, s:I}", "name", score->name, "seconds_median",
                                           median(score), "pairs", (json_int_t)score->pairs, "inversions",
                                           (json_int_t)score->inversions, "violations", (json_int_t)score->violations));
  }
  json_object_set_new(object, "peers", peers);
  return terminal_print_json(object);
}

static int report_text(struct run *run, const char *mesh_name) {
  const bool to_output = run->options->order != NULL && strcmp(run->options->order, "-") == 0;
  FILE *to = to_output ? stderr : stdout;
  const double views = run->options->views;
  const struct totals *totals = &run->totals;
  fprintf(to, "%s: %zu tets, %u view%s, order: %s\n", mesh_name, run->desc.tet_count, run->options->views,
          run->options->views == 1 ? "" : "s", totals->exact ? "exact" : "approximate");
  const cellist_order_facts *facts = cellist_order_get_facts(run->made);
  fprintf(to, "exterior: %s, %zu imaginary cells, %.3f s%s (%s)\n", facts->exterior, facts->imaginary_cells,
          facts->seconds, facts->cached ? ", read from the cache" : "", facts->reason);
  fprintf(to, "a view: %.1f groups with %.1f cells (largest: %zu), %.1f gap arcs of %.1f pairs, %.1f exact signs\n",
          (double)totals->groups / views, (double)totals->cells_in_groups / views, totals->largest_group,
          (double)totals->gap_arcs / views, (double)totals->gap_candidates / views,
          (double)totals->exact_signs / views);
  for (size_t p = 0; p <= run->options->peers.count; p++) {
    struct score *score = &run->scores[p];
    const double seconds = median(score);
    fprintf(to, "%-16s %.3f ms a view, %.1f ns a tet", score->name, 1e3 * seconds,
            run->desc.tet_count > 0 ? 1e9 * seconds / (double)run->desc.tet_count : 0);
    if (run->options->rays > 0) {
      fprintf(to, "; %zu rays, %zu pairs, %zu inversions, %zu shared faces violated", score->rays, score->pairs,
              score->inversions, score->violations);
      if (score->group_pairs > 0) fprintf(to, ", %zu pairs inside groups", score->group_pairs);
      if (score->overlaps > 0) fprintf(to, ", %zu pairs of overlapping cells", score->overlaps);
    }
    fputc('\n', to);
  }
  return terminal_finish();
}

static cellist_result sort_all(struct run *run, const view_options *camera) {
  for (unsigned i = 0; i < run->options->views; i++) {
    cellist_result result = cellist_progress(run->context, "sorting", (double)i / run->options->views);
    if (result != CELLIST_SUCCESS) return result;
    cellist_view view;
    view_options_resolve(camera, run->arrays->bounds, &view);
    if (run->options->views > 1) {
      const double parallel_height = view.parallel_height;
      view = spread_view(run->arrays->bounds, i, run->options->views);
      view.parallel_height = parallel_height;
    }
    const cellist_viewpoint viewpoint = viewpoint_of(&view);
    result = sort_view(run, &viewpoint, i);
    if (result == CELLIST_SUCCESS && run->options->order != NULL) result = write_order(run, run->options->order);
    if (result == CELLIST_SUCCESS) result = sort_peers(run, &viewpoint, i);
    if (result != CELLIST_SUCCESS) return result;
  }
  return cellist_progress(run->context, "sorting", 1);
}

static const char *check_options(const struct sort_options *options) {
  if (options->order != NULL && options->views > 1) return "--order writes the order of one view, not of --views";
  if (options->order != NULL && options->json && strcmp(options->order, "-") == 0)
    return "--order - and --json both want standard output";
  for (size_t p = 0; p < options->peers.count; p++) {
    size_t i = 0;
    while (cellist_peer_name(i) != NULL && strcmp(cellist_peer_name(i), options->peers.value[p]) != 0) i++;
    if (cellist_peer_name(i) == NULL) return "--peer is one of centroid, centroid_compare, mpvo_nc, power, bsp_xmpvo";
  }
  return NULL;
}

int command_sort(int argc, char **argv) {
  struct sort_options options = {.views = 1, .repeat = 1};
  view_options camera;
  mesh_options input;
  order_options sorting;
  cellist_order_desc order_desc;
  option_spec view_table[VIEW_OPTION_COUNT], mesh_table[MESH_OPTION_COUNT], order_table[ORDER_OPTION_COUNT];
  mesh_options_init(&input, mesh_table);
  order_options_init(&sorting, order_table);
  view_options_init(&camera, view_table);
  const option_spec table[] = {
      {"views", "N", "N well-spread directions instead of one view", OPTION_COUNT, &options.views},
      {"repeat", "N", "sort each view N times; times are medians (1)", OPTION_COUNT, &options.repeat},
      {"threads", "N", "threads to use (one per processor)", OPTION_COUNT, &options.threads},
      {"order", "FILE", "write the order: cell_id tet_index a line, far to near, groups in brackets", OPTION_TEXT,
       &options.order},
      {"verify", "RAYS", "cast that many rays over all views, look at all shared faces, and count what is wrong",
       OPTION_COUNT, &options.rays},
      {"peer", "NAME", "also centroid, centroid_compare, mpvo_nc, power or bsp_xmpvo; may be repeated", OPTION_TEXTS,
       &options.peers},
      {"json", "", "print what was found as one JSON object", OPTION_FLAG, &options.json},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  static const char *const examples[] = {
      "cellist sort mesh.vtu --views 20 --verify 20000", "cellist sort mesh.vtu --orbit 45,20 --order order.txt",
      "cellist sort sample:ball --repeat 9 --threads 1 --peer centroid --json", NULL};
  const command_usage usage = {"sort",
                               "MESH",
                               "Puts the cells of a mesh (a file, or sample:NAME) in visibility order.",
                               1,
                               1,
                               examples,
                               {table, view_table, order_table, mesh_table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);
  cellist_mesh_read_desc read = {0};
  cellist_view view;
  const double unit_bounds[6] = {0, 0, 0, 1, 1, 1};
  const char *wrong = check_options(&options);
  if (wrong == NULL) wrong = mesh_options_resolve(&input, &read);
  if (wrong == NULL) wrong = order_options_resolve(&sorting, &order_desc);
  if (wrong == NULL) wrong = view_options_resolve(&camera, unit_bounds, &view);
  if (wrong != NULL) return wrong_usage("sort", "%s", wrong);

  cellist_context *context = terminal_context(options.threads);
  if (context == NULL) return 1;
  cellist_mesh *mesh = NULL;
  struct run run = {.options = &options, .context = context, .order_desc = order_desc};
  cellist_result result = cellist_pipeline_load(context, argv[1], &read, &mesh);
  if (result == CELLIST_SUCCESS) {
    run.arrays = cellist_mesh_get_arrays(mesh);
    run.mesh = mesh;
    result = prepare(&run);
  }
  if (result == CELLIST_SUCCESS) result = sort_all(&run, &camera);
  int status = 0;
  if (result != CELLIST_SUCCESS)
    status = terminal_failure(context, result);
  else
    status =
        options.json ? report_json(&run, cellist_mesh_get_facts(mesh)->file_cell_count) : report_text(&run, argv[1]);
  release(&run);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  return status;
}
