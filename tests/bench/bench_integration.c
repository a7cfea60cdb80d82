/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of the ways to integrate and to light a cell through OpenGL, as CSV: for each mesh, transfer function and
 * method, processor seconds of a frame (the least of three, tables there already), the same relative to exact
 * integration without light, and the error against the reference caster (premultiplied R G B A over covered pixels).
 * Without light at 512x512, with tables of several sizes; with light by gradients at points at 256x256, with 1, 2 and 4
 * samples a segment. Opacities hold per diagonal/50; "ramp10" is ramp with ten times the extinction.
 * Arguments: names of shared meshes; none: those of the published figures. */
#include <cellist/gl.h>
#include <cellist/raycast.h>
#include <cellist/sort.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double processor_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void check(cellist_context *context, cellist_result result, const char *what) {
  if (result == CELLIST_SUCCESS) return;
  fprintf(stderr, "bench_integration: %s: %s\n", what, cellist_context_take_error(context));
  exit(1);
}

enum { FRAMES = 3 };

/* A mesh and what draws it. */
struct subject {
  cellist_context *context;
  const char *name;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_sorter *sorter;
  cellist_raycaster *caster;
  cellist_gl *gl;
  uint32_t *order;
  size_t tet_count;
  double diagonal;
};

/* One view of it under one transfer function and light. */
struct scene {
  const struct subject *subject;
  const char *transfer_name;
  cellist_transfer transfer;
  cellist_frame frame;
  cellist_light light;
  cellist_image *image;
  double *truth;
  double exact_seconds;
};

static void open_subject(cellist_context *context, cellist_gl *gl, const char *name, struct subject *made) {
  char path[4096];
  snprintf(path, sizeof path, "%s/data/%s.vtu", CELLIST_SHARED_DIR, name);
  *made = (struct subject){.context = context, .name = name, .gl = gl};
  check(context, cellist_mesh_read(context, path, NULL, &made->mesh), path);
  check(context, cellist_scalar_select(context, made->mesh, NULL, &made->scalar), path);
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(made->mesh);
  const double *bounds = arrays->bounds;
  made->diagonal = hypot(hypot(bounds[3] - bounds[0], bounds[4] - bounds[1]), bounds[5] - bounds[2]);
  made->tet_count = arrays->tet_count;
  const cellist_sorter_desc desc = {.point_count = arrays->point_count,
                                    .points = arrays->positions,
                                    .tet_count = arrays->tet_count,
                                    .tets = arrays->tets,
                                    .neighbours = arrays->neighbours};
  check(context, cellist_sorter_create(context, &desc, &made->sorter), "sorter");
  made->order = malloc(arrays->tet_count * sizeof *made->order);
  check(context, cellist_raycaster_create(context, made->mesh, &made->scalar, NULL, &made->caster), "caster");
  check(context, cellist_gl_upload(gl, made->mesh, &made->scalar), "upload");
}

static void close_subject(struct subject *subject) {
  cellist_raycaster_destroy(subject->caster);
  cellist_sorter_destroy(subject->sorter);
  free(subject->order);
  cellist_scalar_release(subject->context, &subject->scalar);
  cellist_mesh_destroy(subject->mesh);
}

/* Root of the mean square over covered pixels, and the largest difference. */
static void compare(const struct scene *scene, double *rmse, double *most) {
  static const char *const names[] = {"R", "G", "B", "A"};
  const size_t pixels = (size_t)scene->frame.width * scene->frame.height;
  double sum = 0;
  size_t covered = 0;
  *most = 0;
  for (size_t i = 0; i < pixels; i++) {
    covered += scene->truth[4 * i + 3] > 0 || cellist_image_channel(scene->image, "A")[i] > 0;
    for (size_t c = 0; c < 4; c++) {
      const double difference = fabs(cellist_image_channel(scene->image, names[c])[i] - scene->truth[4 * i + c]);
      sum += difference * difference;
      *most = fmax(*most, difference);
    }
  }
  *rmse = covered > 0 ? sqrt(sum / (4.0 * (double)covered)) : 0;
}

static void draw(struct scene *scene, cellist_integration integration, uint32_t scalars, uint32_t lengths,
                 uint32_t samples) {
  static const char *const methods[] = {"exact", "psi", "table"};
  const struct subject *subject = scene->subject;
  cellist_context *context = subject->context;
  const cellist_group *sorted = NULL;
  cellist_gl_settings settings = {.optics = {.light = scene->light,
                                             .sample_count = samples,
                                             .integration = integration,
                                             .table_size = {scalars, lengths}}};
  cellist_sorter_groups(subject->sorter, &sorted, &settings.group_count);
  cellist_gl_group *groups = malloc((settings.group_count + 1) * sizeof *groups);
  for (size_t i = 0; i < settings.group_count; i++) groups[i] = (cellist_gl_group){sorted[i].begin, sorted[i].count};
  settings.groups = groups;
  double least = HUGE_VAL;
  for (int i = 0; i <= FRAMES; i++) {
    const double begin = processor_seconds();
    check(context,
          cellist_gl_render(subject->gl, &scene->frame, &scene->transfer, subject->order, subject->tet_count, &settings,
                            scene->image, NULL),
          "render");
    if (i > 0) least = fmin(least, processor_seconds() - begin); /* the first one makes tables and programs */
  }
  if (integration == CELLIST_INTEGRATION_EXACT && samples == 0) scene->exact_seconds = least;
  double rmse, most;
  compare(scene, &rmse, &most);
  printf("%s,%zu,%u,%s,%s,%s,%u,%u,%u,%.4f,%.2f,%.3g,%.3g\n", subject->name, subject->tet_count, scene->frame.width,
         scene->transfer_name, scene->light.enabled ? "lit" : "unlit", methods[integration], scalars, lengths, samples,
         least, least / scene->exact_seconds, rmse, most);
  fflush(stdout);
  free(groups);
}

static void bench_scene(const struct subject *subject, const char *transfer_name, double scale, bool lit,
                        uint32_t size) {
  static const char *const channels[] = {"R", "G", "B", "A"};
  cellist_context *context = subject->context;
  struct scene scene = {.subject = subject, .transfer_name = transfer_name};
  const cellist_transfer_desc transfer_desc = {
      .source = strncmp(transfer_name, "ramp", 4) == 0 ? "ramp" : transfer_name,
      .range = {subject->scalar.minimum, subject->scalar.maximum},
      .unit_distance = subject->diagonal / 50,
      .opacity_scale = scale};
  check(context, cellist_transfer_load(context, &transfer_desc, &scene.transfer), transfer_name);
  const cellist_view view = cellist_view_orbit(cellist_mesh_get_arrays(subject->mesh)->bounds, 30.96, 34.45);
  check(context, cellist_frame_from_view(context, &view, size, size, &scene.frame), "frame");
  cellist_viewpoint viewpoint = {.parallel = false};
  memcpy(viewpoint.position, scene.frame.eye, sizeof viewpoint.position);
  check(context, cellist_sorter_sort(subject->sorter, &viewpoint, subject->order, NULL), "sort");
  check(context, cellist_image_create(context, size, size, channels, 4, &scene.image), "image");
  scene.truth = malloc(4 * (size_t)size * size * sizeof *scene.truth);
  if (lit) {
    scene.exact_seconds = NAN;
    scene.light =
        (cellist_light){.enabled = true,
                        .ambient = 0.3,
                        .diffuse = 0.7,
                        .specular = 0.5,
                        .shininess = 30,
                        .gradient_unit = 10 * (subject->scalar.maximum - subject->scalar.minimum) / subject->diagonal};
  }
  const cellist_raycast_desc cast = {.precision = CELLIST_PRECISION_REFERENCE, .optics = {.light = scene.light}};
  const cellist_raycast_output output = {.rgba = scene.truth};
  check(context, cellist_raycaster_render(subject->caster, &scene.frame, &scene.transfer, &cast, &output, NULL),
        "reference");
  if (lit) { /* what light costs is measured on the same picture without it */
    const cellist_light light = scene.light;
    cellist_gl_settings plain = {.framebuffer = CELLIST_FRAMEBUFFER_32F};
    scene.exact_seconds = HUGE_VAL;
    for (int i = 0; i <= FRAMES; i++) {
      const double begin = processor_seconds();
      check(context,
            cellist_gl_render(subject->gl, &scene.frame, &scene.transfer, subject->order, subject->tet_count, &plain,
                              scene.image, NULL),
            "render");
      if (i > 0) scene.exact_seconds = fmin(scene.exact_seconds, processor_seconds() - begin);
    }
    scene.light = light;
    for (uint32_t samples = 1; samples <= 4; samples *= 2) {
      draw(&scene, CELLIST_INTEGRATION_EXACT, 0, 0, samples);
      draw(&scene, CELLIST_INTEGRATION_PSI, 0, 0, samples);
      draw(&scene, CELLIST_INTEGRATION_TABLE, 64, 32, samples);
      draw(&scene, CELLIST_INTEGRATION_TABLE, 128, 32, samples);
    }
  } else {
    static const uint32_t sizes[][2] = {{32, 32}, {64, 32}, {64, 64}, {128, 32}, {128, 128}, {128, 256}};
    draw(&scene, CELLIST_INTEGRATION_EXACT, 0, 0, 0);
    draw(&scene, CELLIST_INTEGRATION_PSI, 0, 0, 0);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
      draw(&scene, CELLIST_INTEGRATION_TABLE, sizes[i][0], sizes[i][1], 0);
  }
  free(scene.truth);
  cellist_image_destroy(scene.image);
  cellist_transfer_release(context, &scene.transfer);
}

int main(int argc, char **argv) {
  static const char *const usual[] = {"spx", "disk_out_ref", "impeller", "sci_torso", "gears_t", "bluntfin", "post"};
  cellist_context *context = NULL;
  if (cellist_context_create(NULL, &context) != CELLIST_SUCCESS) return 1;
  cellist_gl *gl = NULL;
  check(context, cellist_gl_create(context, NULL, &gl), "create");
  printf(
      "mesh,tets,size,transfer,light,method,scalars,lengths,samples,processor_seconds,relative_to_exact_unlit,rmse,"
      "max\n");
  for (int i = 0; i < (argc > 1 ? argc - 1 : (int)(sizeof usual / sizeof *usual)); i++) {
    struct subject subject;
    open_subject(context, gl, argc > 1 ? argv[i + 1] : usual[i], &subject);
    bench_scene(&subject, "ramp", 1, false, 512);
    bench_scene(&subject, "ramp10", 10, false, 512);
    bench_scene(&subject, "spikes", 1, false, 512);
    bench_scene(&subject, "ramp", 1, true, 256);
    bench_scene(&subject, "dense", 1, true, 256);
    close_subject(&subject);
  }
  cellist_gl_destroy(gl);
  cellist_context_destroy(context);
  return 0;
}
