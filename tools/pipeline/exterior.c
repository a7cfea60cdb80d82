/* SPDX-License-Identifier: BSD-3-Clause
 * Exterior: which one makes sorting cheapest, and where it is kept.
 *
 * The choice is by work counted while sample views are sorted, weighed with committed constants, never by the clock.
 * Delaunay tets come first: they almost always leave nothing to the later stages of the sort, and then no other
 * exterior needs to be made. What was found is written into the file that keeps the complex. */
#include <cellist/order.h>

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "costs.h"
#include "pipeline.h"

#ifdef CELLIST_HAS_CONVEXIFY
#include <cellist/convexify.h>
#endif

/* Nanoseconds of the parts of a sort, measured once (spx, sci_torso, bunny_in, impeller, octopus_low): a cell in the
 * topological sort, a facet of larger cells, a tet that it leaves, and a pair of faces across a gap. Other values
 * choose other exteriors, never another picture. */
static const double CELL_WORK = 4.6, LINK_WORK = 12, LEFT_WORK = 55, PAIR_WORK = 100;

/* An exterior that leaves nothing to the later stages, or costs no more than this many plain sorts of the tets, is
 * taken without trying others: they too would add imaginary cells. */
static const double GOOD_ENOUGH = 2;

/* With more boundary faces than this, making an exterior takes minutes: gaps are ordered by overlap instead. */
static const size_t DELAUNAY_FACES = 400000, CUT_FACES = 60000;

enum { SAMPLE_VIEWS = 6 };

struct cellist_order {
  cellist_context *context;
  const cellist_mesh *mesh;
  cellist_sorter *sorter;
  cellist_order_facts facts;
  double work; /* of a view, in plain sorts of the tets */
  bool left;   /* the first stage of the sort left something in a view */
  cellist_complex *complex;
#ifdef CELLIST_HAS_CONVEXIFY
  cellist_convexify_stats stats; /* of complex */
#endif
};

static const char *const NAMES[] = {"auto", "none", "hull", "box", "grid", "delaunay"};

void cellist_order_destroy(cellist_order *order) {
  if (order == NULL) return;
  cellist_sorter_destroy(order->sorter);
  cellist_complex_destroy(order->complex);
  cellist_deallocate(order->context, order);
}

cellist_sorter *cellist_order_sorter(const cellist_order *order) { return order->sorter; }
const cellist_order_facts *cellist_order_get_facts(const cellist_order *order) { return &order->facts; }
const cellist_complex *cellist_order_get_complex(const cellist_order *order) { return order->complex; }

const struct cellist_convexify_stats *cellist_order_get_convexify_stats(const cellist_order *order) {
#ifdef CELLIST_HAS_CONVEXIFY
  if (order->complex != NULL) return &order->stats;
#endif
  (void)order;
  return NULL;
}

/* The order's sorter, with its complex if it has one. */
static cellist_result make_sorter(cellist_order *order, const uint8_t *wanted) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(order->mesh);
  cellist_sorter_desc desc = {.point_count = a->point_count,
                              .points = a->positions,
                              .tet_count = a->tet_count,
                              .tets = a->tets,
                              .neighbours = a->neighbours};
  cellist_sorter_complex complex;
  if (order->complex != NULL) {
    const cellist_complex_arrays *c = cellist_complex_get_arrays(order->complex);
    complex = (cellist_sorter_complex){.cell_count = c->cell_count,
                                       .point_count = c->point_count,
                                       .points = c->points,
                                       .offset_count = c->offset_count,
                                       .offsets = c->offsets,
                                       .plane_count = c->plane_count,
                                       .planes = c->planes,
                                       .facet_count = c->facet_count,
                                       .facet_planes = c->facet_planes,
                                       .facet_cells = c->facet_cells};
    order->facts.imaginary_cells = c->cell_count - c->tet_count;
    desc.complex = &complex;
  }
  const cellist_result result = wanted != NULL
                                    ? cellist_sorter_create_subset(order->context, &desc, wanted, &order->sorter)
                                    : cellist_sorter_create(order->context, &desc, &order->sorter);
  if (result == CELLIST_SUCCESS) order->facts.convex = cellist_sorter_is_convex(order->sorter);
  return result;
}

static cellist_result create_empty(cellist_context *context, const cellist_mesh *mesh, cellist_order **order) {
  *order = cellist_allocate_zeroed(context, 1, sizeof **order);
  if (*order == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  (*order)->context = context;
  (*order)->mesh = mesh;
  (*order)->facts.exterior = "none";
  return CELLIST_SUCCESS;
}

#ifdef CELLIST_HAS_CONVEXIFY

static cellist_convexify_desc convexify_desc(const cellist_order_desc *desc, cellist_order_exterior exterior) {
  static const cellist_exterior kinds[] = {[CELLIST_ORDER_HULL] = CELLIST_EXTERIOR_HULL,
                                           [CELLIST_ORDER_BOX] = CELLIST_EXTERIOR_BOX,
                                           [CELLIST_ORDER_GRID] = CELLIST_EXTERIOR_GRID,
                                           [CELLIST_ORDER_DELAUNAY] = CELLIST_EXTERIOR_DELAUNAY};
  cellist_convexify_desc how = {.seed = 1};
  if (desc->convexify != NULL) how = *desc->convexify;
  how.exterior = kinds[exterior];
  return how;
}

static const char *name_of(cellist_exterior exterior) {
  switch (exterior) {
    case CELLIST_EXTERIOR_BOX: return "box";
    case CELLIST_EXTERIOR_GRID: return "grid";
    case CELLIST_EXTERIOR_DELAUNAY: return "delaunay";
    default: return "hull";
  }
}

/* The directory and the one above it, if they are not there. */
static void make_directories(const char *path) {
  char above[4096];
  if (mkdir(path, 0777) == 0 || errno != ENOENT || strlen(path) >= sizeof above) return;
  snprintf(above, sizeof above, "%s", path);
  char *slash = strrchr(above, '/');
  if (slash == NULL || slash == above) return;
  *slash = '\0';
  if (mkdir(above, 0777) == 0) mkdir(path, 0777);
}

/* Files are made by these two; the first says whether one was there. */
struct keeper {
  const cellist_order_desc *desc;
  cellist_cells_key key;
  char path[4096]; /* "" : nothing is kept */
};

/* Raised whenever another exterior may be chosen for the same mesh. */
enum { CHOICE_VERSION = 1 };

static struct keeper make_keeper(const cellist_mesh *mesh, const cellist_order_desc *desc) {
  struct keeper keeper = {.desc = desc};
  if (desc->cache_directory == NULL && desc->cache_file == NULL) return keeper;
  const bool is_choice = desc->exterior == CELLIST_ORDER_AUTO;
  const cellist_convexify_desc how =
      convexify_desc(desc, is_choice ? CELLIST_ORDER_DELAUNAY : (cellist_order_exterior)desc->exterior);
  keeper.key = cellist_cells_key_of(mesh, &how, is_choice ? 2 * CHOICE_VERSION + desc->needs_complex : 0);
  int length = 0;
  if (desc->cache_file != NULL)
    length = snprintf(keeper.path, sizeof keeper.path, "%s", desc->cache_file);
  else
    length = snprintf(keeper.path, sizeof keeper.path, "%s/%016llx%016llx.cells", desc->cache_directory,
                      (unsigned long long)keeper.key.value[0], (unsigned long long)keeper.key.value[1]);
  if (length < 0 || (size_t)length >= sizeof keeper.path) keeper.path[0] = '\0';
  return keeper;
}

/* What a file says of the exterior: its note is "name: reason". */
static const char *take_note(const char *note, cellist_order_facts *facts) {
  for (size_t i = CELLIST_ORDER_NONE; i < sizeof NAMES / sizeof NAMES[0]; i++) {
    const size_t length = strlen(NAMES[i]);
    if (strncmp(note, NAMES[i], length) != 0 || strncmp(&note[length], ": ", 2) != 0) continue;
    snprintf(facts->reason, sizeof facts->reason, "%s", &note[length + 2]);
    return NAMES[i];
  }
  return NULL;
}

/* An order from the file, or *order stays NULL. */
static cellist_result read_kept(cellist_context *context, const cellist_mesh *mesh, const struct keeper *keeper,
                                cellist_order **order) {
  if (keeper->path[0] == '\0') return CELLIST_SUCCESS;
  cellist_order *made = NULL;
  char note[CELLIST_CELLS_NOTE];
  cellist_result result = create_empty(context, mesh, &made);
  if (result != CELLIST_SUCCESS) return result;
  result = cellist_cells_read(context, keeper->path, keeper->key, &made->complex, &made->stats, note);
  if (result == CELLIST_SUCCESS) {
    const char *name = take_note(note, &made->facts);
    if (name == NULL && made->complex != NULL) name = name_of(made->stats.exterior);
    if (name != NULL) made->facts.exterior = name;
    made->facts.cached = true;
    result = name == NULL ? CELLIST_ERROR_NOT_FOUND : make_sorter(made, NULL);
  }
  if (result == CELLIST_SUCCESS) {
    *order = made;
    return CELLIST_SUCCESS;
  }
  cellist_order_destroy(made);
  if (result == CELLIST_ERROR_OUT_OF_MEMORY) return result;
  cellist_context_take_error(context); /* no such file, or one that does not fit: made anew */
  return CELLIST_SUCCESS;
}

static cellist_result keep(const cellist_order *order, const struct keeper *keeper) {
  if (keeper->path[0] == '\0') return CELLIST_SUCCESS;
  /* A file of the caller's that is to hold a complex is not left without. */
  if (order->complex == NULL && keeper->desc->cache_file != NULL && keeper->desc->needs_complex) return CELLIST_SUCCESS;
  char note[CELLIST_CELLS_NOTE];
  snprintf(note, sizeof note, "%s: %s", order->facts.exterior, order->facts.reason);
  if (keeper->desc->cache_file == NULL) make_directories(keeper->desc->cache_directory);
  const cellist_result result =
      cellist_cells_write(order->context, keeper->path, keeper->key, order->complex, &order->stats, note);
  if (result != CELLIST_ERROR_IO || keeper->desc->cache_file != NULL) return result;
  cellist_log(order->context, CELLIST_LOG_WARNING, "%s; the exterior will be made again next time",
              cellist_context_take_error(order->context));
  return CELLIST_SUCCESS;
}

/* View i: directions on a golden spiral, at the distance that --orbit has. */
static cellist_viewpoint sample_view(const double bounds[6], int i) {
  cellist_viewpoint view = {{0, 0, 0}, false};
  const double z = (2 * i + 1.0) / SAMPLE_VIEWS - 1, turn = 2.399963229728653 * i, ring = sqrt(1 - z * z);
  const double direction[3] = {ring * cos(turn), ring * sin(turn), z};
  double diagonal = 0;
  for (int k = 0; k < 3; k++) diagonal = hypot(diagonal, bounds[3 + k] - bounds[k]);
  for (int k = 0; k < 3; k++) view.position[k] = 0.5 * bounds[k] + 0.5 * bounds[3 + k] + 1.93 * diagonal * direction[k];
  return view;
}

/* Counts the work of a view, by so many sample views. */
static cellist_result count_work(cellist_order *order, int views) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(order->mesh);
  uint32_t *list = cellist_allocate(order->context, a->tet_count, sizeof *list);
  if (list == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  double work = 0;
  cellist_result result = CELLIST_SUCCESS;
  for (int i = 0; i < views && result == CELLIST_SUCCESS; i++) {
    const cellist_viewpoint view = sample_view(a->bounds, i);
    cellist_sort_stats stats = {0};
    result = cellist_sorter_sort(order->sorter, &view, list, &stats);
    order->left |= stats.left_cell_count > 0;
    work += CELL_WORK * (double)(a->tet_count + stats.imaginary_cell_count) + LINK_WORK * (double)stats.link_count +
            LEFT_WORK * (double)stats.left_cell_count + PAIR_WORK * (double)stats.gap_candidate_count;
  }
  order->work = work / views / (CELL_WORK * (double)a->tet_count);
  cellist_deallocate(order->context, list);
  return result;
}

/* An order with one exterior. Errors: as cellist_order_create. */
static cellist_result try_exterior(cellist_context *context, const cellist_mesh *mesh, const cellist_order_desc *how,
                                   cellist_order_exterior exterior, cellist_order **order) {
  cellist_order *made = NULL;
  cellist_result result = create_empty(context, mesh, &made);
  if (result != CELLIST_SUCCESS) return result;
  const cellist_convexify_desc desc = convexify_desc(how, exterior);
  result = cellist_convexify(context, mesh, &desc, &made->complex, &made->stats);
  if (result == CELLIST_SUCCESS) result = make_sorter(made, NULL);
  if (result != CELLIST_SUCCESS) {
    cellist_order_destroy(made);
    return result;
  }
  made->facts.exterior = name_of(made->stats.exterior);
  *order = made;
  return CELLIST_SUCCESS;
}

struct choice {
  cellist_order *best;
  char tried[160]; /* what each costs */
  bool is_good;
};

__attribute__((format(printf, 2, 3))) static void note_try(struct choice *choice, const char *format, ...) {
  size_t length = strlen(choice->tried);
  if (length > 0 && length + 3 < sizeof choice->tried) {
    memcpy(&choice->tried[length], ", ", 3);
    length += 2;
  }
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(&choice->tried[length], sizeof choice->tried - length, format, arguments);
  va_end(arguments);
}

/* Takes a candidate if it is better than the best. It belongs to the choice from here on. */
static cellist_result consider(struct choice *choice, cellist_order *candidate) {
  const cellist_result result = count_work(candidate, SAMPLE_VIEWS);
  if (result != CELLIST_SUCCESS) {
    cellist_order_destroy(candidate);
    return result;
  }
  note_try(choice, "%s %.2f", candidate->facts.exterior, candidate->work);
  if (choice->best != NULL && choice->best->work <= candidate->work) {
    cellist_order_destroy(candidate);
    return CELLIST_SUCCESS;
  }
  cellist_order_destroy(choice->best);
  choice->best = candidate;
  choice->is_good = candidate->work <= GOOD_ENOUGH || !candidate->left;
  return CELLIST_SUCCESS;
}

/* The cheapest of what can be made. plain: an order without an exterior, which this takes. */
static cellist_result choose(cellist_order *plain, const cellist_order_desc *desc, struct choice *choice) {
  static const cellist_order_exterior candidates[] = {CELLIST_ORDER_DELAUNAY, CELLIST_ORDER_HULL, CELLIST_ORDER_GRID};
  cellist_context *context = plain->context;
  const size_t faces = cellist_mesh_get_facts(plain->mesh)->boundary_face_count;
  cellist_result result = CELLIST_SUCCESS;
  bool hull_tried = false;
  for (size_t i = 0; i < 3 && result == CELLIST_SUCCESS && !choice->is_good; i++) {
    const cellist_order_exterior exterior = candidates[i];
    if (faces > (exterior == CELLIST_ORDER_DELAUNAY ? DELAUNAY_FACES : CUT_FACES)) {
      note_try(choice, "%s not tried: %zu boundary faces", NAMES[exterior], faces);
      continue;
    }
    if (exterior == CELLIST_ORDER_HULL && hull_tried) continue;
    cellist_order *candidate = NULL;
    result = try_exterior(context, plain->mesh, desc, exterior, &candidate);
    if (result == CELLIST_ERROR_GEOMETRY || result == CELLIST_ERROR_INTERNAL) {
      note_try(choice, "%s cannot be made", NAMES[exterior]);
      cellist_log(context, CELLIST_LOG_INFO, "exterior %s: %s", NAMES[exterior], cellist_context_take_error(context));
      result = CELLIST_SUCCESS;
      continue;
    }
    hull_tried |= result == CELLIST_SUCCESS && strcmp(candidate->facts.exterior, "hull") == 0;
    if (result == CELLIST_SUCCESS) result = consider(choice, candidate);
  }
  const bool considered =
      result == CELLIST_SUCCESS && (choice->best == NULL || (!choice->is_good && !desc->needs_complex));
  if (!considered) {
    cellist_order_destroy(plain);
    return result;
  }
  return consider(choice, plain);
}

/* Whether making an exterior takes longer than the pictures to come would save by it. */
static cellist_result is_too_dear(cellist_order *plain, const cellist_order_desc *desc, bool *dear) {
  *dear = false;
  if (desc->exterior != CELLIST_ORDER_AUTO || desc->needs_complex || desc->pictures == 0) return CELLIST_SUCCESS;
  const cellist_result result = count_work(plain, 1);
  const double plain_sort = CELL_WORK * (double)cellist_mesh_get_arrays(plain->mesh)->tet_count;
  const double making = EXTERIOR_FACE_COST * (double)cellist_mesh_get_facts(plain->mesh)->boundary_face_count;
  *dear = desc->pictures * (plain->work - 1) * plain_sort < making;
  if (*dear)
    snprintf(plain->facts.reason, sizeof plain->facts.reason,
             "%u picture%s would not pay for an exterior: none %.2f (plain sort = 1), making one %.0f", desc->pictures,
             desc->pictures > 1 ? "s" : "", plain->work, making / plain_sort);
  return result;
}

/* What the mesh is given, after all that could be read. plain: as above. */
static cellist_result make(cellist_order *plain, const cellist_order_desc *desc, const struct keeper *keeper,
                           cellist_order **order) {
  cellist_result result;
  struct choice choice = {0};
  if (desc->exterior == CELLIST_ORDER_AUTO) {
    result = choose(plain, desc, &choice);
    if (result == CELLIST_SUCCESS)
      snprintf(choice.best->facts.reason, sizeof choice.best->facts.reason, "least work of %s (plain sort = 1)",
               choice.tried);
  } else {
    result = try_exterior(plain->context, plain->mesh, desc, desc->exterior, &choice.best);
    if (result == CELLIST_SUCCESS)
      snprintf(choice.best->facts.reason, sizeof choice.best->facts.reason, "%s",
               strcmp(choice.best->facts.exterior, NAMES[desc->exterior]) == 0 ? "asked for"
                                                                               : "the boundary was refused by TetGen");
    cellist_order_destroy(plain);
  }
  if (result == CELLIST_SUCCESS) result = keep(choice.best, keeper);
  if (result == CELLIST_SUCCESS)
    *order = choice.best;
  else
    cellist_order_destroy(choice.best);
  return result;
}

#endif

cellist_result cellist_order_create(cellist_context *context, const cellist_mesh *mesh, const cellist_order_desc *desc,
                                    cellist_order **order) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || order == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_order_create: mesh or order is NULL");
  const cellist_order_desc defaults = {0};
  if (desc == NULL) desc = &defaults;
  cellist_order *plain = NULL, *made = NULL;
  cellist_result result = create_empty(context, mesh, &plain);
  if (result == CELLIST_SUCCESS) result = make_sorter(plain, NULL);
  if (result != CELLIST_SUCCESS) {
    cellist_order_destroy(plain);
    return result;
  }
  const double begin = clock_seconds();
  if (plain->facts.convex || desc->exterior == CELLIST_ORDER_NONE) {
    snprintf(plain->facts.reason, sizeof plain->facts.reason, "%s",
             plain->facts.convex ? "the mesh is convex" : "asked for");
    made = plain;
  } else {
#ifdef CELLIST_HAS_CONVEXIFY
    const struct keeper keeper = make_keeper(mesh, desc);
    result = read_kept(context, mesh, &keeper, &made);
    bool dear = false;
    if (result == CELLIST_SUCCESS && made == NULL) result = is_too_dear(plain, desc, &dear);
    if (result == CELLIST_SUCCESS && dear)
      made = plain;
    else if (result == CELLIST_SUCCESS && made == NULL)
      result = make(plain, desc, &keeper, &made);
    else
      cellist_order_destroy(plain);
#else
    if (desc->exterior == CELLIST_ORDER_AUTO && !desc->needs_complex) {
      snprintf(plain->facts.reason, sizeof plain->facts.reason, "this build has no convexifier");
      made = plain;
    } else {
      cellist_order_destroy(plain);
      result = cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "this build has no convexifier for an exterior");
    }
#endif
  }
  /* The choice is the whole mesh's, so that what is kept does not depend on what is wanted. */
  if (result == CELLIST_SUCCESS && desc->wanted != NULL) {
    cellist_sorter_destroy(made->sorter);
    made->sorter = NULL;
    result = make_sorter(made, desc->wanted);
    if (result != CELLIST_SUCCESS) cellist_order_destroy(made);
  }
  if (result != CELLIST_SUCCESS) return result;
  made->facts.seconds = clock_seconds() - begin;
  *order = made;
  return CELLIST_SUCCESS;
}
