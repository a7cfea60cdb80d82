/* SPDX-License-Identifier: BSD-3-Clause
 * cellist render: a mesh to a picture, or to several: a turntable, or one view repeated for its timing. */
#include <cellist/pipeline.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "command.h"
#include "mesh_options.h"
#include "optics_options.h"
#include "order_options.h"
#include "render_report.h"
#include "surface_options.h"
#include "terminal.h"
#include "view_options.h"

/* Medians and counts over the frames drawn. */
struct tally {
  double *sort, *draw;
  size_t count;
};

static bool has_ending(const char *name, const char *ending) {
  const size_t length = strlen(name), tail = strlen(ending);
  return length >= tail && strcmp(name + length - tail, ending) == 0;
}

/* The name of picture number index: a turntable's pattern holds one %d or %0Nd. Returns false if it does not. */
static bool picture_name(const char *pattern, unsigned index, char *name, size_t size) {
  const char *percent = strchr(pattern, '%');
  if (percent == NULL) return false;
  const char *at = percent + 1;
  int width = 0;
  if (*at == '0') at++;
  while (*at >= '0' && *at <= '9' && width < 100) width = 10 * width + (*at++ - '0');
  if (*at != 'd' || strchr(at, '%') != NULL) return false;
  const int written = snprintf(name, size, "%.*s%0*u%s", (int)(percent - pattern), pattern, width, index, at + 1);
  return written > 0 && (size_t)written < size;
}

static const char *check_options(const struct render_options *options) {
  if (options->outputs.count == 0) return "-o IMAGE is missing";
  if (options->error < 0 || options->time < 0) return "--error and --time need a number above 0";
  if (options->error > 0 && options->time > 0) return "--error and --time exclude each other";
  if ((options->error > 0 || options->time > 0) && strcmp(options->renderer, "auto") != 0)
    return "--error and --time choose the renderer themselves";
  if (options->explain && options->no_plan) return "--explain and --no-plan exclude each other";
  for (size_t i = 0; i < options->outputs.count; i++) {
    const char *name = options->outputs.value[i];
    char expanded[4096];
    if (strcmp(name, "-") == 0) {
      if (options->json) return "-o - and --json both want standard output";
      if (options->turntable > 0) return "--turntable needs file names";
      continue;
    }
    if (!has_ending(name, ".exr") && !has_ending(name, ".png")) return "-o needs a name that ends in .exr or .png";
    if (options->turntable > 0 && !picture_name(name, 0, expanded, sizeof expanded))
      return "--turntable needs a pattern such as -o a%04d.png";
  }
  if (options->turntable > 0 && options->frames > 1) return "--frames and --turntable exclude each other";
  return NULL;
}

static cellist_result write_pictures(cellist_context *context, const struct render_options *options,
                                     const cellist_image *image, unsigned index) {
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < options->outputs.count && result == CELLIST_SUCCESS; i++) {
    const char *path = options->outputs.value[i];
    char expanded[4096];
    if (options->turntable > 0 && picture_name(path, index, expanded, sizeof expanded)) path = expanded;
    result =
        cellist_image_write(context, image, path, options->background.count > 0 ? options->background.value : NULL);
  }
  return result;
}

static cellist_result draw_all(cellist_context *context, const struct render_options *options, const cellist_view *view,
                               cellist_pipeline *pipeline, struct tally *tally, cellist_pipeline_stats *stats) {
  const unsigned count = options->turntable > 0 ? options->turntable : options->frames;
  for (unsigned i = 0; i < count; i++) {
    cellist_result result = cellist_progress(context, "drawing", (double)i / count);
    if (result != CELLIST_SUCCESS) return result;
    const cellist_view turned = options->turntable > 0 ? view_turned(view, (double)i / count) : *view;
    cellist_image *image = NULL;
    cellist_pipeline_forget_order(pipeline); /* each frame's time is to be a whole one */
    result = cellist_pipeline_draw(pipeline, &turned, options->size[0], options->size[1], &image, stats);
    if (result == CELLIST_SUCCESS && (options->turntable > 0 || i + 1 == count))
      result = write_pictures(context, options, image, i);
    cellist_image_destroy(image);
    if (result != CELLIST_SUCCESS) return result;
    tally->sort[tally->count] = stats->sort_seconds;
    tally->draw[tally->count++] = stats->draw_seconds;
  }
  return cellist_progress(context, "drawing", 1);
}

/* The same view with everything that the plan leaves out, for its times. */
static cellist_result draw_without_plan(cellist_context *context, const cellist_pipeline_desc *desc,
                                        const struct render_options *options, const cellist_view *view,
                                        cellist_pipeline_stats *stats) {
  cellist_pipeline_desc everything = *desc;
  everything.no_plan = true;
  cellist_pipeline *pipeline = NULL;
  cellist_image *image = NULL;
  cellist_result result = cellist_pipeline_create(context, &everything, &pipeline);
  if (result == CELLIST_SUCCESS)
    result = cellist_pipeline_draw(pipeline, view, options->size[0], options->size[1], &image, stats);
  cellist_image_destroy(image);
  cellist_pipeline_destroy(pipeline);
  return result;
}

static cellist_pipeline_desc pipeline_desc(const struct render_options *options, const char *source) {
  cellist_pipeline_desc desc = {.source = source, .no_plan = options->no_plan};
  if (strcmp(options->renderer, "faces") == 0) desc.renderer = CELLIST_RENDERER_FACES;
  if (strcmp(options->renderer, "fan") == 0) desc.renderer = CELLIST_RENDERER_FAN;
  if (strcmp(options->renderer, "soft") == 0) desc.renderer = CELLIST_RENDERER_SOFT;
  if (strcmp(options->renderer, "cast") == 0) desc.renderer = CELLIST_RENDERER_CAST;
  if (strcmp(options->backend, "osmesa") == 0) desc.backend = CELLIST_BACKEND_OSMESA;
  if (strcmp(options->backend, "egl") == 0) desc.backend = CELLIST_BACKEND_EGL;
  if (strcmp(options->backend, "glfw") == 0) desc.backend = CELLIST_BACKEND_GLFW;
  if (strcmp(options->framebuffer, "16f") == 0) desc.framebuffer = CELLIST_FRAMEBUFFER_16F;
  if (strcmp(options->framebuffer, "8") == 0) desc.framebuffer = CELLIST_FRAMEBUFFER_8;
  desc.width = options->size[0];
  desc.height = options->size[1];
  desc.frames = options->turntable > 0 ? options->turntable : options->frames;
  desc.error = options->error;
  desc.seconds = options->time;
  if (options->tets != NULL) desc.tets = (uint32_t)strtoul(options->tets, NULL, 10);
  desc.precision = strcmp(options->precision, "fast") == 0 ? CELLIST_PRECISION_FAST : CELLIST_PRECISION_REFERENCE;
  return desc;
}

int command_render(int argc, char **argv) {
  struct render_options options = {.size = {512, 512},
                                   .frames = 1,
                                   .renderer = "auto",
                                   .backend = "auto",
                                   .framebuffer = "32f",
                                   .precision = "fast"};
  options.background.expected = 3;
  view_options camera;
  optics_options look;
  mesh_options input;
  order_options sorting;
  static surface_options scene; /* some 100 kB */
  option_spec order_table[ORDER_OPTION_COUNT];
  option_spec view_table[VIEW_OPTION_COUNT], optics_table[OPTICS_OPTION_COUNT], mesh_table[MESH_OPTION_COUNT];
  option_spec scene_table[SURFACE_OPTION_COUNT];
  surface_options_init(&scene, scene_table);
  mesh_options_init(&input, mesh_table);
  order_options_init(&sorting, order_table);
  view_options_init(&camera, view_table);
  optics_options_init(&look, optics_table);
  const option_spec table[] = {
      {"o", "IMAGE", "where to, .exr or .png; may be repeated; - is EXR on standard output", OPTION_TEXTS,
       &options.outputs},
      {"size", "WxH", "pixels (512x512)", OPTION_SIZE, options.size},
      {"renderer", "auto|faces|fan|soft|cast",
       "how: cell projection with OpenGL (per pixel, by triangles) or without, or ray casting (auto: soft or cast, by "
       "counted work)",
       OPTION_CHOICE, &options.renderer},
      {"precision", "fast|reference", "of cast: single precision, or double with a proved bound (fast)", OPTION_CHOICE,
       &options.precision},
      {"tets", "32|20|16", "of cast, fast: bytes a cell of the compact mesh (the fastest layout)", OPTION_CHOICE,
       &options.tets},
      {"context", "auto|osmesa|egl|glfw", "where OpenGL comes from; glfw needs a display (auto)", OPTION_CHOICE,
       &options.backend},
      {"framebuffer", "32f|16f|8", "of faces, fan: bits of a colour that cells are blended in (32f)", OPTION_CHOICE,
       &options.framebuffer},
      {"background", "R,G,B", "what PNG pictures are laid over, linear 0..1 (nothing: transparent)", OPTION_NUMBERS,
       &options.background},
      {"frames", "N", "draw N times; times are medians (1)", OPTION_COUNT, &options.frames},
      {"turntable", "N", "N pictures of a full turn, -o a%04d.png", OPTION_COUNT, &options.turntable},
      {"threads", "N", "threads to use (one per processor)", OPTION_COUNT, &options.threads},
      {"error", "E", "choose the cheapest way whose root mean square error is expected to be at most this",
       OPTION_NUMBER, &options.error},
      {"time", "T", "choose the closest way whose frame is expected to take at most T seconds", OPTION_NUMBER,
       &options.time},
      {"explain", "", "say what the scene did not need, and what leaving it out saved (draws a frame without the plan)",
       OPTION_FLAG, &options.explain},
      {"no-plan", "", "do everything, also what the scene does not need", OPTION_FLAG, &options.no_plan},
      {"json", "", "print what was done as one JSON object", OPTION_FLAG, &options.json},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  static const char *const examples[] = {
      "cellist render sample:gears -o gears.png",
      "cellist render mesh.vtu -o a.exr -o a.png --scalar velocity:mag --tf viridis --orbit 45,20",
      "cellist render mesh.vtu -o a.exr --eye 3,0,1 --target 0,0,0 --fovy 40 --tf mine.json --unit diagonal/50",
      "cellist render mesh.vtu -o cut.png --clip 1,0,0,0.5 --surface wing.stl,0.8,0.6,0.2 --surface cells:p=3..",
      "cellist render mesh.vtu -o turn%04d.png --turntable 90 --background 1,1,1",
      NULL};
  const command_usage usage = {
      "render", "MESH -o IMAGE", "Draws a mesh (a file, or sample:NAME[:SIZE][,seed=N][,perturb=P][,parts=N]).", 1,
      1,        examples,        {table, view_table, optics_table, order_table, scene_table, mesh_table}};
  size_t positional = 0;
  const parse_result parsed = options_parse(&usage, argc, argv, &positional);
  if (parsed != PARSE_OK) return parse_exit(parsed);
  const char *wrong = check_options(&options);
  cellist_pipeline_desc desc = pipeline_desc(&options, argv[1]);
  cellist_isosurface isos[LIST_CAPACITY];
  if (wrong == NULL) wrong = optics_options_resolve(&look, isos, &desc.optics);
  if (wrong == NULL) wrong = mesh_options_resolve(&input, &desc.read);
  if (wrong == NULL) wrong = order_options_resolve(&sorting, &desc.order);
  cellist_pipeline_surface surfaces[LIST_CAPACITY];
  desc.surfaces = surfaces;
  if (wrong == NULL) wrong = surface_options_resolve(&scene, surfaces, &desc.surface_count);
  cellist_view view;
  const double unit_bounds[6] = {0, 0, 0, 1, 1, 1};
  if (wrong == NULL) wrong = view_options_resolve(&camera, unit_bounds, &view);
  if (wrong != NULL) return wrong_usage("render", "%s", wrong);

  const double begin = clock_seconds();
  cellist_context *context = terminal_context(options.threads);
  if (context == NULL) return 1;
  const unsigned count = options.turntable > 0 ? options.turntable : options.frames;
  struct tally tally = {calloc(count, sizeof(double)), calloc(count, sizeof(double)), 0};
  cellist_pipeline *pipeline = NULL;
  cellist_pipeline_stats stats = {0};
  cellist_mesh *mesh = NULL;
  cellist_result result = tally.sort != NULL && tally.draw != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) result = cellist_pipeline_load(context, argv[1], &desc.read, &mesh);
  const double load = clock_seconds() - begin;
  if (result == CELLIST_SUCCESS) { /* the view needs the mesh, and the pipeline chooses for the view */
    view_options_resolve(&camera, cellist_mesh_get_arrays(mesh)->bounds, &view);
    desc.mesh = mesh;
    desc.view = &view;
    result = cellist_pipeline_create(context, &desc, &pipeline);
  }
  if (result == CELLIST_SUCCESS) result = draw_all(context, &options, &view, pipeline, &tally, &stats);
  cellist_pipeline_stats full = {0};
  if (result == CELLIST_SUCCESS && options.explain) result = draw_without_plan(context, &desc, &options, &view, &full);
  int status = 0;
  if (result != CELLIST_SUCCESS) {
    status = terminal_failure(context, result);
  } else {
    stats.load_seconds += load;
    const struct render_outcome outcome = {.options = &options,
                                           .mesh_name = argv[1],
                                           .pipeline = pipeline,
                                           .stats = stats,
                                           .sort = terminal_median(tally.sort, tally.count),
                                           .draw = terminal_median(tally.draw, tally.count),
                                           .total = clock_seconds() - begin,
                                           .full = options.explain ? &full : NULL};
    status = options.json ? render_report_json(&outcome) : render_report_text(&outcome);
  }
  free(tally.sort);
  free(tally.draw);
  cellist_pipeline_destroy(pipeline);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
  return status;
}
