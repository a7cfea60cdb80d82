/* SPDX-License-Identifier: BSD-3-Clause
 * Soak scene: see soak_scene.h. Numbers are written short and read back, so what is drawn is what the text says. */
#include "soak_scene.h"

#include <base/random.h>
#include <cellist/generate.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Appends an argument. */
static void say(soak_scene *scene, const char *format, ...) CELLIST_PRINTF(2, 3);
static void say(soak_scene *scene, const char *format, ...) {
  char *at = &scene->text[scene->text_length];
  const size_t room = SOAK_TEXT - scene->text_length;
  va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(at, room, format, arguments);
  va_end(arguments);
  if (length < 0 || (size_t)length >= room || scene->argument_count == SOAK_ARGUMENTS - 4) abort();
  scene->arguments[scene->argument_count++] = at;
  scene->text_length += (size_t)length + 1;
}

static bool one_in(random_state *random, uint64_t count) { return random_below(random, count) == 0; }
static double power(random_state *random, double low, double high) {
  return exp(random_between(random, log(low), log(high)));
}

/* ---- Mesh --------------------------------------------------------------------------------------------- */

static void choose_mesh(random_state *random, soak_scene *scene) {
  static const struct {
    const char *name;
    unsigned least, most; /* cells */
    unsigned parts;       /* largest number; 0: none */
  } meshes[] = {{"grid", 6, 2000, 0},
                {"grid", 6, 400, 0},
                {"ball", 30, 3000, 0},
                {"gears", 300, 3000, 8},
                {"torus", 100, 2000, 0},
                {"heat-sink", 60, 2000, 6},
                {"staircase", 50, 1500, 6},
                {"l-shape", 18, 1000, 0},
                {"shells", 300, 2500, 3},
                {"plates", 12, 1000, 12},
                {"swiss-cheese", 600, 3000, 2},
                {"slivers", 48, 2000, 0},
                {"cyclic", 3, 300, 12},
                {"cyclic", 3, 100, 3},
                {"two-spheres", 100, 1500, 0},
                {"tapered-cylinder", 100, 2000, 0},
                {"flaws", 24, 24, 0}};
  const size_t i = random_below(random, sizeof meshes / sizeof meshes[0]);
  const unsigned size = (unsigned)power(random, meshes[i].least, meshes[i].most + 1);
  char settings[128] = "";
  size_t length = 0;
  if (meshes[i].parts > 0 && !one_in(random, 3)) {
    const unsigned least = strcmp(meshes[i].name, "gears") == 0 ? 5 : 3;
    const unsigned parts =
        least + (unsigned)random_below(random, meshes[i].parts > least ? meshes[i].parts - least + 1 : 1);
    length += (size_t)snprintf(settings + length, sizeof settings - length, ",parts=%u", parts);
  }
  if (strcmp(meshes[i].name, "grid") == 0 && !one_in(random, 3))
    length += (size_t)snprintf(settings + length, sizeof settings - length, ",perturb=%.2g",
                               random_between(random, 0.02, 0.5));
  snprintf(settings + length, sizeof settings - length, ",seed=%u", (unsigned)random_below(random, 1000000));
  say(scene, "sample:%s:%u%s", meshes[i].name, size, settings);
  scene->is_flawed = strcmp(meshes[i].name, "flaws") == 0;
}

/* ---- Camera ------------------------------------------------------------------------------------------- */

/* Bounds of the scene's mesh; a mesh that cannot be made shows when it is drawn. */
static void find_bounds(const soak_scene *scene, double bounds[6]) {
  cellist_context *context = NULL;
  cellist_mesh *mesh = NULL;
  const double unit[6] = {0, 0, 0, 1, 1, 1};
  memcpy(bounds, unit, sizeof unit);
  if (cellist_context_create(&(cellist_context_desc){.worker_count = 1}, &context) != CELLIST_SUCCESS) abort();
  if (cellist_pipeline_load(context, scene->arguments[0], NULL, &mesh) == CELLIST_SUCCESS)
    memcpy(bounds, cellist_mesh_get_arrays(mesh)->bounds, 6 * sizeof bounds[0]);
  cellist_mesh_destroy(mesh);
  cellist_context_destroy(context);
}

static void say_place(random_state *random, soak_scene *scene, const char *option, const double bounds[6],
                      double reach) {
  double p[3];
  for (int k = 0; k < 3; k++) {
    const double half = 0.5 * (bounds[3 + k] - bounds[k]);
    p[k] = bounds[k] + half + reach * half * random_between(random, -1, 1);
  }
  say(scene, "--%s", option);
  say(scene, "%.4g,%.4g,%.4g", p[0], p[1], p[2]);
}

static void choose_camera(random_state *random, soak_scene *scene) {
  double bounds[6];
  find_bounds(scene, bounds);
  const double diagonal = hypot(hypot(bounds[3] - bounds[0], bounds[4] - bounds[1]), bounds[5] - bounds[2]);
  const uint64_t kind = random_below(random, 10);
  double distance = 2 * diagonal; /* about, to the middle */
  if (kind < 5) {
    say(scene, "--orbit");
    say(scene, "%.4g,%.4g", random_between(random, -180, 180), random_between(random, -90, 90));
  } else if (kind == 5) {
    say(scene, "--orbit");
    say(scene, "%d,%d", 45 * (int)random_below(random, 8), 45 * ((int)random_below(random, 5) - 2));
    scene->is_along = true;
  } else {
    say_place(random, scene, "eye", bounds, kind < 8 ? 1 : 4);
    say_place(random, scene, "target", bounds, 0.9);
    distance = kind < 8 ? 0.5 * diagonal : 1.5 * diagonal;
  }
  if (one_in(random, 4)) {
    say(scene, "--parallel");
    say(scene, "%.4g", diagonal * power(random, 0.05, 3));
  } else if (kind > 5 || one_in(random, 3)) {
    say(scene, "--fovy");
    say(scene, "%.4g", kind > 5 ? random_between(random, 10, 150) : random_between(random, 1, 60));
  }
  if (one_in(random, 6)) {
    say(scene, "--near");
    say(scene, "%.4g", distance * random_between(random, 0.1, 1.1));
  }
  for (unsigned planes = one_in(random, 6) ? 1 + (unsigned)random_below(random, 3) : 0; planes > 0; planes--) {
    double n[3], at = 0;
    for (int k = 0; k < 3; k++) {
      n[k] = random_between(random, -1, 1);
      at += n[k] *
            (0.5 * bounds[k] + 0.5 * bounds[3 + k] + 0.3 * (bounds[3 + k] - bounds[k]) * random_between(random, -1, 1));
    }
    say(scene, "--clip");
    say(scene, "%.4g,%.4g,%.4g,%.4g", n[0], n[1], n[2], at);
  }
}

/* ---- Optics ------------------------------------------------------------------------------------------- */

static void choose_optics(random_state *random, soak_scene *scene) {
  size_t count = 0;
  while (cellist_transfer_name(count) != NULL) count++;
  say(scene, "--tf");
  say(scene, "%s",
      one_in(random, 2) ? cellist_transfer_name(random_below(random, 3))
                        : cellist_transfer_name(random_below(random, count)));
  if (one_in(random, 4)) {
    const double low = random_between(random, -1, 0.5);
    say(scene, "--range");
    say(scene, "%.3g,%.3g", low, low + power(random, 0.05, 2));
  }
  if (!one_in(random, 4)) {
    say(scene, "--unit");
    say(scene, "diagonal/%.3g", power(random, 1, 200));
  }
  if (one_in(random, 3)) {
    say(scene, "--opacity-scale");
    say(scene, "%.3g", power(random, 1e-2, 1e2));
  }
  if (one_in(random, 4)) say(scene, "--opacity-convention"), say(scene, "image");
  const uint64_t model = random_below(random, 10);
  static const char *const names[] = {"absorption", "emission", "mip"};
  if (model < 3) say(scene, "--model"), say(scene, "%s", names[model]);
  if (model == 3) {
    say(scene, "--iso");
    const double first = random_between(random, -0.8, 0.8);
    if (one_in(random, 2))
      say(scene, "%.3g", first);
    else
      say(scene, "%.3g,%.3g", first, random_between(random, -0.8, 0.8));
    if (one_in(random, 2)) say(scene, "--iso-opacity"), say(scene, "%.2g", random_between(random, 0.1, 1));
  }
  if (model != 0 && model != 2 && one_in(random, 6)) {
    say(scene, "--light");
    if (one_in(random, 2))
      say(scene, "headlight");
    else
      say(scene, "%.2g,%.2g,%.2g", random_between(random, -1, 1), random_between(random, -1, 1),
          random_between(random, 0.1, 1));
    say(scene, "--samples");
    say(scene, "%u", 1 + (unsigned)random_below(random, 4));
  }
}

/* Opaque surfaces of the mesh's own cells. */
static void choose_surfaces(random_state *random, soak_scene *scene) {
  if (!one_in(random, 8)) return;
  for (unsigned count = one_in(random, 3) ? 2 : 1; count > 0; count--) {
    char source[64] = "boundary", colour[64] = "";
    const double low = random_between(random, -1, 0.8);
    if (!one_in(random, 4)) snprintf(source, sizeof source, "cells:wave=%.3g..%.3g", low, low + power(random, 0.1, 1));
    if (one_in(random, 2))
      snprintf(colour, sizeof colour, ",%.2g,%.2g,%.2g", random_unit(random), random_unit(random), random_unit(random));
    say(scene, "--surface");
    say(scene, "%s%s", source, colour);
  }
}

/* What only OpenGL takes. */
static void choose_gl(random_state *random, soak_scene *scene, bool is_fan) {
  if (one_in(random, 6)) say(scene, "--framebuffer"), say(scene, "%s", one_in(random, 2) ? "16f" : "8");
  if (is_fan || !one_in(random, 5)) return;
  say(scene, "--integration");
  if (one_in(random, 2))
    say(scene, "psi");
  else
    say(scene, "table:%ux%u", 128u << random_below(random, 2), 32u << random_below(random, 2));
}

static void choose_renderer(random_state *random, soak_scene *scene) {
  static const char *const names[] = {"cast", "cast", "cast", "soft", "soft", "soft", "faces", "faces", "fan"};
  static const char *const tets[] = {"32", "20", "16"};
  static const char *const exteriors[] = {"none", "hull", "box", "grid", "delaunay"};
  const char *name = names[random_below(random, sizeof names / sizeof names[0])];
  const bool is_fan = strcmp(name, "fan") == 0, is_cast = strcmp(name, "cast") == 0;
  say(scene, "--renderer");
  say(scene, "%s", name);
  if (is_cast && one_in(random, 2)) say(scene, "--tets"), say(scene, "%s", tets[random_below(random, 3)]);
  if (is_fan || strcmp(name, "faces") == 0) choose_gl(random, scene, is_fan);
  if (!is_cast && one_in(random, 3))
    say(scene, "--exterior"), say(scene, "%s", exteriors[random_below(random, sizeof exteriors / sizeof exteriors[0])]);
  say(scene, "--no-cache");
  say(scene, "--threads");
  say(scene, "%u", 1 + (unsigned)random_below(random, 4));
  if (one_in(random, 8)) say(scene, "--no-plan");
  say(scene, "--size");
  say(scene, "%ux%u", 16 + (unsigned)random_below(random, 40), 16 + (unsigned)random_below(random, 40));
}

/* ---- What the words mean ------------------------------------------------------------------------------ */

static void read_back(soak_scene *scene) {
  static const char *const renderers[] = {"auto", "faces", "fan", "soft", "cast"}; /* as cellist_renderer */
  static const char *const framebuffers[] = {"32f", "16f", "8"};                   /* as cellist_framebuffer */
  const char *renderer = "auto", *tets = "0", *framebuffer = "32f";
  optics_options look;
  option_spec view_table[VIEW_OPTION_COUNT], optics_table[OPTICS_OPTION_COUNT];
  option_spec order_table[ORDER_OPTION_COUNT], surface_table[SURFACE_OPTION_COUNT];
  view_options_init(&scene->camera, view_table);
  optics_options_init(&look, optics_table);
  order_options_init(&scene->sorting, order_table);
  surface_options_init(&scene->surface_texts, surface_table);
  const option_spec table[] = {
      {"renderer", "faces|fan|soft|cast", "", OPTION_CHOICE, &renderer},
      {"framebuffer", "32f|16f|8", "", OPTION_CHOICE, &framebuffer},
      {"tets", "32|20|16", "", OPTION_CHOICE, &tets},
      {"threads", "N", "", OPTION_COUNT, &scene->threads},
      {"size", "WxH", "", OPTION_SIZE, scene->size},
      {"no-plan", "", "", OPTION_FLAG, &scene->desc.no_plan},
      {NULL, NULL, NULL, OPTION_FLAG, NULL},
  };
  static const char *const examples[] = {NULL};
  const command_usage usage = {
      "render", "MESH", "", 1, 1, examples, {table, view_table, optics_table, order_table, surface_table}};
  char *arguments[SOAK_ARGUMENTS + 1] = {"render"};
  memcpy(arguments + 1, scene->arguments, (size_t)scene->argument_count * sizeof arguments[0]);
  size_t positional = 0;
  if (options_parse(&usage, scene->argument_count + 1, arguments, &positional) != PARSE_OK) abort();
  const char *wrong = optics_options_resolve(&look, scene->isos, &scene->desc.optics);
  const double unit[6] = {0, 0, 0, 1, 1, 1};
  cellist_view view;
  if (wrong == NULL) wrong = view_options_resolve(&scene->camera, unit, &view);
  if (wrong == NULL) wrong = order_options_resolve(&scene->sorting, &scene->desc.order);
  if (wrong == NULL)
    wrong = surface_options_resolve(&scene->surface_texts, scene->surfaces, &scene->desc.surface_count);
  if (wrong != NULL) {
    fprintf(stderr, "%s\n", wrong);
    soak_scene_print(scene);
    abort();
  }
  scene->desc.source = arguments[1];
  scene->desc.tets = (uint32_t)strtoul(tets, NULL, 10);
  scene->desc.surfaces = scene->surfaces;
  for (int i = 0; i < 5; i++)
    if (strcmp(renderer, renderers[i]) == 0) scene->desc.renderer = (cellist_renderer)i;
  for (int i = 0; i < 3; i++)
    if (strcmp(framebuffer, framebuffers[i]) == 0) scene->desc.framebuffer = (cellist_framebuffer)i;
}

void soak_scene_make(uint64_t seed, uint64_t index, soak_scene *scene) {
  random_state random = {seed};
  random.state = random_bits(&random) + index;
  random.state = random_bits(&random); /* indices in a row have nothing in common */
  *scene = (soak_scene){0};
  choose_mesh(&random, scene);
  choose_camera(&random, scene);
  choose_optics(&random, scene);
  choose_surfaces(&random, scene);
  choose_renderer(&random, scene);
  read_back(scene);
}

static void print_words(const soak_scene *scene, int from) {
  for (int i = from; i < scene->argument_count; i++) printf(" %s", scene->arguments[i]);
}

void soak_scene_print(const soak_scene *scene) {
  printf("  cellist render");
  print_words(scene, 0);
  printf(" -o a.exr\n  cellist render");
  print_words(scene, 0);
  printf(" --renderer cast --precision reference -o b.exr\n  cellist compare a.exr b.exr\n");
}
