/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of the OpenGL renderer. For each mesh and size, as CSV: median seconds of a frame (read back included), the
 * processor's seconds that it took, the same for a probe on the same OpenGL (as many triangles of as many pixels, a
 * constant colour, blended into the same framebuffer), and the error against the reference caster; both methods, every
 * framebuffer. Beside them the error of VTK 9.1's projected tetrahedra on the same picture, as measured elsewhere.
 * Arguments: names of shared meshes; none: those of the published figures. */
#if __has_include(<GL/osmesa.h>)
#include <GL/osmesa.h>

#include <GL/glext.h> /* needs what osmesa.h brings */
#endif
#include <cellist/gl.h>
#include <cellist/raycast.h>
#include <cellist/sort.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double seconds(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void check(cellist_context *context, cellist_result result, const char *what) {
  if (result == CELLIST_SUCCESS) return;
  fprintf(stderr, "bench_gl: %s: %s\n", what, cellist_context_take_error(context));
  exit(1);
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

enum { FRAMES = 5 };

struct timing {
  double wall, processor;
};

static struct timing draw(cellist_context *context, cellist_gl *gl, const cellist_frame *frame,
                          const cellist_transfer *transfer, const uint32_t *order, size_t count,
                          const cellist_gl_settings *settings, cellist_image *image, cellist_gl_stats *stats) {
  double wall[FRAMES], processor[FRAMES];
  for (int i = 0; i < FRAMES; i++) {
    const double wall_begin = seconds(CLOCK_MONOTONIC), processor_begin = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(context, cellist_gl_render(gl, frame, transfer, order, count, settings, image, stats), "render");
    wall[i] = seconds(CLOCK_MONOTONIC) - wall_begin;
    processor[i] = seconds(CLOCK_PROCESS_CPUTIME_ID) - processor_begin;
  }
  qsort(wall, FRAMES, sizeof *wall, by_value);
  qsort(processor, FRAMES, sizeof *processor, by_value);
  return (struct timing){wall[FRAMES / 2], processor[FRAMES / 2]};
}

#if __has_include(<GL/osmesa.h>)
/* The probe: as many triangles and as many pixels, a constant colour, blended into floats; nothing else. */
static struct timing probe(uint64_t triangles, uint64_t fragments, uint32_t size) {
  static const int attributes[] = {
      OSMESA_PROFILE, OSMESA_CORE_PROFILE, OSMESA_CONTEXT_MAJOR_VERSION, 4, OSMESA_CONTEXT_MINOR_VERSION, 1, 0};
  static const char *const vertex =
      "#version 410 core\nlayout(location=0) in vec2 p;"
      "void main() { gl_Position = vec4(p, 0.0, 1.0); }";
  static const char *const fragment =
      "#version 410 core\nlayout(location=0) out vec4 c;"
      "void main() { c = vec4(0.001, 0.002, 0.003, 0.01); }";
  unsigned char token[4 * 16 * 16];
  OSMesaContext context = OSMesaCreateContextAttribs(attributes, NULL);
  if (context == NULL || !OSMesaMakeCurrent(context, token, GL_UNSIGNED_BYTE, 16, 16)) return (struct timing){NAN, NAN};
#define PROBE_LOAD(name, type) const type name = (type)(void (*)(void))OSMesaGetProcAddress(#name)
  PROBE_LOAD(glCreateShader, PFNGLCREATESHADERPROC);
  PROBE_LOAD(glShaderSource, PFNGLSHADERSOURCEPROC);
  PROBE_LOAD(glCompileShader, PFNGLCOMPILESHADERPROC);
  PROBE_LOAD(glCreateProgram, PFNGLCREATEPROGRAMPROC);
  PROBE_LOAD(glAttachShader, PFNGLATTACHSHADERPROC);
  PROBE_LOAD(glLinkProgram, PFNGLLINKPROGRAMPROC);
  PROBE_LOAD(glUseProgram, PFNGLUSEPROGRAMPROC);
  PROBE_LOAD(glGenVertexArrays, PFNGLGENVERTEXARRAYSPROC);
  PROBE_LOAD(glBindVertexArray, PFNGLBINDVERTEXARRAYPROC);
  PROBE_LOAD(glGenBuffers, PFNGLGENBUFFERSPROC);
  PROBE_LOAD(glBindBuffer, PFNGLBINDBUFFERPROC);
  PROBE_LOAD(glBufferData, PFNGLBUFFERDATAPROC);
  PROBE_LOAD(glEnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC);
  PROBE_LOAD(glVertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC);
  PROBE_LOAD(glGenFramebuffers, PFNGLGENFRAMEBUFFERSPROC);
  PROBE_LOAD(glBindFramebuffer, PFNGLBINDFRAMEBUFFERPROC);
  PROBE_LOAD(glGenRenderbuffers, PFNGLGENRENDERBUFFERSPROC);
  PROBE_LOAD(glBindRenderbuffer, PFNGLBINDRENDERBUFFERPROC);
  PROBE_LOAD(glRenderbufferStorage, PFNGLRENDERBUFFERSTORAGEPROC);
  PROBE_LOAD(glFramebufferRenderbuffer, PFNGLFRAMEBUFFERRENDERBUFFERPROC);
  const GLuint program = glCreateProgram();
  for (int i = 0; i < 2; i++) {
    const GLuint shader = glCreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
    glShaderSource(shader, 1, i ? &fragment : &vertex, NULL);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  glUseProgram(program);
  GLuint names[4];
  glGenFramebuffers(1, &names[0]);
  glBindFramebuffer(GL_FRAMEBUFFER, names[0]);
  glGenRenderbuffers(1, &names[1]);
  glBindRenderbuffer(GL_RENDERBUFFER, names[1]);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, (GLsizei)size, (GLsizei)size);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, names[1]);
  glViewport(0, 0, (GLsizei)size, (GLsizei)size);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  /* Right triangles of the mean number of pixels, at places from a multiplicative sequence. */
  float *corners = malloc(triangles * 6 * sizeof *corners);
  const float leg = (float)(2 * sqrt(2.0 * (double)fragments / (double)triangles) / size);
  uint32_t state = 1;
  for (uint64_t i = 0; i < triangles; i++) {
    float at[2];
    for (int k = 0; k < 2; k++) {
      state = state * 1664525u + 1013904223u;
      at[k] = -1 + (2 - leg) * (float)(state >> 8) * 0x1p-24f;
    }
    const float triangle[6] = {at[0], at[1], at[0] + leg, at[1], at[0], at[1] + leg};
    memcpy(corners + 6 * i, triangle, sizeof triangle);
  }
  glGenVertexArrays(1, &names[2]);
  glBindVertexArray(names[2]);
  glGenBuffers(1, &names[3]);
  glBindBuffer(GL_ARRAY_BUFFER, names[3]);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
  float *pixels = malloc(4 * (size_t)size * size * sizeof *pixels);
  double wall[FRAMES], processor[FRAMES];
  for (int i = 0; i < FRAMES; i++) {
    const double wall_begin = seconds(CLOCK_MONOTONIC), processor_begin = seconds(CLOCK_PROCESS_CPUTIME_ID);
    glClear(GL_COLOR_BUFFER_BIT);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(triangles * 6 * sizeof *corners), corners, GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, (GLsizei)(3 * triangles));
    glReadPixels(0, 0, (GLsizei)size, (GLsizei)size, GL_RGBA, GL_FLOAT, pixels);
    wall[i] = seconds(CLOCK_MONOTONIC) - wall_begin;
    processor[i] = seconds(CLOCK_PROCESS_CPUTIME_ID) - processor_begin;
  }
  free(corners);
  free(pixels);
  OSMesaMakeCurrent(NULL, NULL, 0, 0, 0);
  OSMesaDestroyContext(context);
  qsort(wall, FRAMES, sizeof *wall, by_value);
  qsort(processor, FRAMES, sizeof *processor, by_value);
  return (struct timing){wall[FRAMES / 2], processor[FRAMES / 2]};
}
#else
static struct timing probe(uint64_t triangles, uint64_t fragments, uint32_t size) {
  (void)triangles;
  (void)fragments;
  (void)size;
  return (struct timing){NAN, NAN};
}
#endif

/* Root of the mean square over covered pixels, and the largest difference, of premultiplied R G B A. */
static void compare(const cellist_image *image, const double *truth, size_t pixels, double *rmse, double *most) {
  static const char *const names[] = {"R", "G", "B", "A"};
  double sum = 0;
  size_t covered = 0;
  *most = 0;
  for (size_t i = 0; i < pixels; i++) {
    covered += truth[4 * i + 3] > 0 || cellist_image_channel(image, "A")[i] > 0;
    for (size_t c = 0; c < 4; c++) {
      const double difference = fabs(cellist_image_channel(image, names[c])[i] - truth[4 * i + c]);
      sum += difference * difference;
      *most = fmax(*most, difference);
    }
  }
  *rmse = covered > 0 ? sqrt(sum / (4.0 * (double)covered)) : 0;
}

/* Published errors of VTK 9.1 (vtkProjectedTetrahedraMapper, software OpenGL, 512x512, this camera and optics). */
static const struct peer {
  const char *mesh;
  double rmse, most;
} PEERS[] = {{"spx", 0.018, 0.25},       {"disk_out_ref", 0.016, 0.11}, {"impeller", 0.015, 0.40},
             {"sci_torso", 0.008, 0.13}, {"bluntfin", 0.026, 0.39},     {"post", 0.015, 0.16}};

static struct peer peer_of(const char *mesh, uint32_t size) {
  for (size_t i = 0; i < sizeof PEERS / sizeof PEERS[0]; i++)
    if (size == 512 && strcmp(PEERS[i].mesh, mesh) == 0) return PEERS[i];
  return (struct peer){mesh, NAN, NAN};
}

static void bench_mesh(cellist_context *context, cellist_gl *gl, const char *name) {
  char path[4096];
  snprintf(path, sizeof path, "%s/data/%s.vtu", CELLIST_SHARED_DIR, name);
  cellist_mesh *mesh = NULL;
  cellist_scalar scalar;
  check(context, cellist_mesh_read(context, path, NULL, &mesh), path);
  check(context, cellist_scalar_select(context, mesh, NULL, &scalar), path);
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const double *bounds = arrays->bounds;
  const double diagonal = hypot(hypot(bounds[3] - bounds[0], bounds[4] - bounds[1]), bounds[5] - bounds[2]);
  const cellist_transfer_desc transfer_desc = {.range = {scalar.minimum, scalar.maximum},
                                               .unit_distance = diagonal / 50};
  cellist_transfer transfer;
  check(context, cellist_transfer_load(context, &transfer_desc, &transfer), "ramp");
  const cellist_sorter_desc sorter_desc = {arrays->point_count, arrays->positions,  arrays->tet_count,
                                           arrays->tets,        arrays->neighbours, NULL};
  cellist_sorter *sorter = NULL;
  check(context, cellist_sorter_create(context, &sorter_desc, &sorter), "sorter");
  uint32_t *order = malloc(arrays->tet_count * sizeof *order);
  cellist_gl_group *groups = NULL;
  cellist_raycaster *caster = NULL;
  check(context, cellist_raycaster_create(context, mesh, &scalar, NULL, &caster), "caster");
  check(context, cellist_gl_upload(gl, mesh, &scalar), "upload");
  for (uint32_t size = 512; size <= 1024; size *= 2) {
    const cellist_view view = cellist_view_orbit(bounds, 30.96, 34.45);
    cellist_frame frame;
    check(context, cellist_frame_from_view(context, &view, size, size, &frame), "frame");
    cellist_viewpoint viewpoint = {.parallel = false};
    memcpy(viewpoint.position, frame.eye, sizeof viewpoint.position);
    check(context, cellist_sorter_sort(sorter, &viewpoint, order, NULL), "sort");
    const cellist_group *sorted = NULL;
    size_t group_count = 0;
    cellist_sorter_groups(sorter, &sorted, &group_count);
    groups = realloc(groups, (group_count + 1) * sizeof *groups);
    for (size_t i = 0; i < group_count; i++) groups[i] = (cellist_gl_group){sorted[i].begin, sorted[i].count};
    static const char *const channels[] = {"R", "G", "B", "A"};
    static const char *const formats[] = {"32f", "16f", "8"};
    cellist_image *image = NULL;
    check(context, cellist_image_create(context, size, size, channels, 4, &image), "image");
    double *truth = NULL;
    if (size == 512) {
      truth = malloc(4 * (size_t)size * size * sizeof *truth);
      const cellist_raycast_desc cast = {.precision = CELLIST_PRECISION_REFERENCE};
      const cellist_raycast_output output = {.rgba = truth};
      check(context, cellist_raycaster_render(caster, &frame, &transfer, &cast, &output, NULL), "reference");
    }
    for (int row = 0; row < (size == 512 ? 4 : 2); row++) { /* faces, fan, then faces with smaller framebuffers */
      const int format = row > 1 ? row - 1 : 0;
      const cellist_gl_settings settings = {.framebuffer = (cellist_framebuffer)format,
                                            .groups = groups,
                                            .group_count = group_count,
                                            .method = row == 1 ? CELLIST_GL_FAN : CELLIST_GL_FACES};
      cellist_gl_stats stats;
      const struct timing taken =
          draw(context, gl, &frame, &transfer, order, arrays->tet_count, &settings, image, &stats);
      double rmse = NAN, most = NAN;
      if (truth != NULL) compare(image, truth, (size_t)size * size, &rmse, &most);
      const struct timing least = probe(stats.triangle_count, stats.fragment_count, size);
      const struct peer vtk = peer_of(name, size);
      printf("%s,%zu,%u,%s,%s,%llu,%llu,%llu,%.4f,%.4f,%.4f,%.4f,%.2f,%.3g,%.3g,%.3g,%.3g\n", name, arrays->tet_count,
             size, row == 1 ? "fan" : "faces", formats[format], (unsigned long long)stats.triangle_count,
             (unsigned long long)stats.fragment_count, (unsigned long long)stats.group_count, taken.wall,
             taken.processor, least.wall, least.processor, least.processor / taken.processor, rmse, most, vtk.rmse,
             vtk.most);
      fflush(stdout);
    }
    free(truth);
    cellist_image_destroy(image);
  }
  cellist_raycaster_destroy(caster);
  free(order);
  free(groups);
  cellist_sorter_destroy(sorter);
  cellist_transfer_release(context, &transfer);
  cellist_scalar_release(context, &scalar);
  cellist_mesh_destroy(mesh);
}

int main(int argc, char **argv) {
  static const char *const meshes[] = {"spx", "disk_out_ref", "impeller", "sci_torso", "gears_t", "bluntfin", "post"};
  cellist_context *context = NULL;
  if (cellist_context_create(NULL, &context) != CELLIST_SUCCESS) return 1;
  cellist_gl *gl = NULL;
  check(context, cellist_gl_create(context, NULL, &gl), "create");
  printf(
      "mesh,tets,size,method,framebuffer,triangles,fragments,groups,seconds,processor_seconds,probe_seconds,"
      "probe_processor_seconds,share_of_probe,rmse,max,vtk_rmse,vtk_max\n");
  if (argc > 1)
    for (int i = 1; i < argc; i++) bench_mesh(context, gl, argv[i]);
  else
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) bench_mesh(context, gl, meshes[i]);
  cellist_gl_destroy(gl);
  cellist_context_destroy(context);
  return 0;
}
