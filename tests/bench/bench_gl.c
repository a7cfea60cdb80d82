/* SPDX-License-Identifier: BSD-3-Clause
 * Benchmark of the OpenGL renderer. For each mesh and size, as CSV: least seconds of nine frames (read back included),
 * the processor's seconds that it took, the same for a probe on the same OpenGL (as many triangles of as many pixels, a
 * constant colour, blended into the same framebuffer), and the error against the reference caster; both methods, every
 * framebuffer. Beside them the error of VTK 9.1's projected tetrahedra on the same picture, as measured elsewhere.
 * Arguments: names of shared meshes; none: those of the published figures. --transfer NAME: instead of ramp;
 * --no-errors: no reference, which takes the longest; --faces: nothing but faces in full precision. */
#if __has_include(<GL/osmesa.h>)
#include <GL/osmesa.h>

#include <GL/glext.h> /* needs what osmesa.h brings */
#endif
#include <cellist/gl.h>
#include <cellist/raycast.h>
#include <cellist/sort.h>
#include <malloc.h>
#include <math.h>
#include <stdbool.h>
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

enum { FRAMES = 9 };

struct timing {
  double wall, processor;
};

static struct timing least_of(double wall[FRAMES], double processor[FRAMES]) {
  qsort(wall, FRAMES, sizeof *wall, by_value);
  qsort(processor, FRAMES, sizeof *processor, by_value);
  return (struct timing){wall[0], processor[0]};
}

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
  return least_of(wall, processor);
}

#if __has_include(<GL/osmesa.h>)
/* What the probe calls. */
#define PROBE_LIST(X)                                          \
  X(AttachShader, PFNGLATTACHSHADERPROC)                       \
  X(BindBuffer, PFNGLBINDBUFFERPROC)                           \
  X(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                 \
  X(BindRenderbuffer, PFNGLBINDRENDERBUFFERPROC)               \
  X(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                 \
  X(BufferData, PFNGLBUFFERDATAPROC)                           \
  X(CompileShader, PFNGLCOMPILESHADERPROC)                     \
  X(CreateProgram, PFNGLCREATEPROGRAMPROC)                     \
  X(CreateShader, PFNGLCREATESHADERPROC)                       \
  X(EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC) \
  X(FramebufferRenderbuffer, PFNGLFRAMEBUFFERRENDERBUFFERPROC) \
  X(GenBuffers, PFNGLGENBUFFERSPROC)                           \
  X(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                 \
  X(GenRenderbuffers, PFNGLGENRENDERBUFFERSPROC)               \
  X(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                 \
  X(LinkProgram, PFNGLLINKPROGRAMPROC)                         \
  X(RenderbufferStorage, PFNGLRENDERBUFFERSTORAGEPROC)         \
  X(ShaderSource, PFNGLSHADERSOURCEPROC)                       \
  X(UseProgram, PFNGLUSEPROGRAMPROC)                           \
  X(VertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC)

struct probe_api {
#define PROBE_MEMBER(name, type) type name;
  PROBE_LIST(PROBE_MEMBER)
};

static void set_up_probe(const struct probe_api *api, uint32_t size) {
  static const char *const texts[2] = {
      "#version 410 core\nlayout(location=0) in vec2 p;"
      "void main() { gl_Position = vec4(p, 0.0, 1.0); }",
      "#version 410 core\nlayout(location=0) out vec4 c;"
      "void main() { c = vec4(0.001, 0.002, 0.003, 0.01); }"};
  const GLuint program = api->CreateProgram();
  for (int i = 0; i < 2; i++) {
    const GLuint shader = api->CreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
    api->ShaderSource(shader, 1, &texts[i], NULL);
    api->CompileShader(shader);
    api->AttachShader(program, shader);
  }
  api->LinkProgram(program);
  api->UseProgram(program);
  GLuint names[4];
  api->GenFramebuffers(1, &names[0]);
  api->BindFramebuffer(GL_FRAMEBUFFER, names[0]);
  api->GenRenderbuffers(1, &names[1]);
  api->BindRenderbuffer(GL_RENDERBUFFER, names[1]);
  api->RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, (GLsizei)size, (GLsizei)size);
  api->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, names[1]);
  glViewport(0, 0, (GLsizei)size, (GLsizei)size);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  api->GenVertexArrays(1, &names[2]);
  api->BindVertexArray(names[2]);
  api->GenBuffers(1, &names[3]);
  api->BindBuffer(GL_ARRAY_BUFFER, names[3]);
  api->EnableVertexAttribArray(0);
  api->VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
}

/* Right triangles of the mean number of pixels, at places from a multiplicative sequence. */
static float *probe_corners(uint64_t triangles, uint64_t fragments, uint32_t size) {
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
  return corners;
}

/* The probe: as many triangles and as many pixels, a constant colour, blended into floats; nothing else. */
static struct timing probe(uint64_t triangles, uint64_t fragments, uint32_t size) {
  static const int attributes[] = {
      OSMESA_PROFILE, OSMESA_CORE_PROFILE, OSMESA_CONTEXT_MAJOR_VERSION, 4, OSMESA_CONTEXT_MINOR_VERSION, 1, 0};
  unsigned char token[4 * 16 * 16];
  OSMesaContext context = OSMesaCreateContextAttribs(attributes, NULL);
  if (context == NULL || !OSMesaMakeCurrent(context, token, GL_UNSIGNED_BYTE, 16, 16)) return (struct timing){NAN, NAN};
  struct probe_api api;
#define PROBE_LOAD(name, type) api.name = (type)(void (*)(void))OSMesaGetProcAddress("gl" #name);
  PROBE_LIST(PROBE_LOAD)
  set_up_probe(&api, size);
  float *corners = probe_corners(triangles, fragments, size);
  float *pixels = malloc(4 * (size_t)size * size * sizeof *pixels);
  double wall[FRAMES], processor[FRAMES];
  for (int i = 0; i < FRAMES; i++) {
    const double wall_begin = seconds(CLOCK_MONOTONIC), processor_begin = seconds(CLOCK_PROCESS_CPUTIME_ID);
    glClear(GL_COLOR_BUFFER_BIT);
    api.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(triangles * 6 * sizeof *corners), corners, GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, (GLsizei)(3 * triangles));
    glReadPixels(0, 0, (GLsizei)size, (GLsizei)size, GL_RGBA, GL_FLOAT, pixels);
    wall[i] = seconds(CLOCK_MONOTONIC) - wall_begin;
    processor[i] = seconds(CLOCK_PROCESS_CPUTIME_ID) - processor_begin;
  }
  free(corners);
  free(pixels);
  OSMesaMakeCurrent(NULL, NULL, 0, 0, 0);
  OSMesaDestroyContext(context);
  return least_of(wall, processor);
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

/* A mesh with all that draws it. */
struct subject {
  const char *name;
  cellist_context *context;
  cellist_gl *gl;
  cellist_mesh *mesh;
  cellist_scalar scalar;
  cellist_transfer transfer;
  cellist_sorter *sorter;
  cellist_raycaster *caster;
  uint32_t *order;
  size_t tet_count, group_count;
  cellist_gl_group *groups;
};

static void open_subject(struct subject *subject, const char *transfer) {
  cellist_context *context = subject->context;
  char path[4096];
  snprintf(path, sizeof path, "%s/data/%s.vtu", CELLIST_SHARED_DIR, subject->name);
  check(context, cellist_mesh_read(context, path, NULL, &subject->mesh), path);
  check(context, cellist_scalar_select(context, subject->mesh, NULL, &subject->scalar), path);
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(subject->mesh);
  const double *bounds = arrays->bounds;
  const double diagonal = hypot(hypot(bounds[3] - bounds[0], bounds[4] - bounds[1]), bounds[5] - bounds[2]);
  const cellist_transfer_desc transfer_desc = {
      .source = transfer, .range = {subject->scalar.minimum, subject->scalar.maximum}, .unit_distance = diagonal / 50};
  check(context, cellist_transfer_load(context, &transfer_desc, &subject->transfer), "transfer function");
  const cellist_sorter_desc sorter_desc = {arrays->point_count, arrays->positions,  arrays->tet_count,
                                           arrays->tets,        arrays->neighbours, NULL};
  check(context, cellist_sorter_create(context, &sorter_desc, &subject->sorter), "sorter");
  check(context, cellist_raycaster_create(context, subject->mesh, &subject->scalar, NULL, &subject->caster), "caster");
  check(context, cellist_gl_upload(subject->gl, subject->mesh, &subject->scalar), "upload");
  subject->tet_count = arrays->tet_count;
  subject->order = malloc(arrays->tet_count * sizeof *subject->order);
}

static void close_subject(struct subject *subject) {
  cellist_raycaster_destroy(subject->caster);
  free(subject->order);
  free(subject->groups);
  cellist_sorter_destroy(subject->sorter);
  cellist_transfer_release(subject->context, &subject->transfer);
  cellist_scalar_release(subject->context, &subject->scalar);
  cellist_mesh_destroy(subject->mesh);
}

static void sort_cells(struct subject *subject, const cellist_frame *frame) {
  cellist_viewpoint viewpoint = {.parallel = false};
  memcpy(viewpoint.position, frame->eye, sizeof viewpoint.position);
  check(subject->context, cellist_sorter_sort(subject->sorter, &viewpoint, subject->order, NULL), "sort");
  const cellist_group *sorted = NULL;
  cellist_sorter_groups(subject->sorter, &sorted, &subject->group_count);
  subject->groups = realloc(subject->groups, (subject->group_count + 1) * sizeof *subject->groups);
  for (size_t i = 0; i < subject->group_count; i++)
    subject->groups[i] = (cellist_gl_group){sorted[i].begin, sorted[i].count};
}

/* One row; truth may be NULL. */
static void bench_frame(struct subject *subject, const cellist_frame *frame, cellist_gl_method method,
                        cellist_framebuffer format, const double *truth, cellist_image *image) {
  static const char *const formats[] = {"32f", "16f", "8"};
  const cellist_gl_settings settings = {
      .framebuffer = format, .groups = subject->groups, .group_count = subject->group_count, .method = method};
  cellist_gl_stats stats;
  const struct timing taken = draw(subject->context, subject->gl, frame, &subject->transfer, subject->order,
                                   subject->tet_count, &settings, image, &stats);
  double rmse = NAN, most = NAN;
  if (truth != NULL) compare(image, truth, (size_t)frame->width * frame->height, &rmse, &most);
  const struct timing least = probe(stats.triangle_count, stats.fragment_count, frame->width);
  const struct peer vtk = peer_of(subject->name, frame->width);
  printf("%s,%zu,%u,%s,%s,%llu,%llu,%llu,%.4f,%.4f,%.4f,%.4f,%.2f,%.3g,%.3g,%.3g,%.3g\n", subject->name,
         subject->tet_count, frame->width, method == CELLIST_GL_FAN ? "fan" : "faces", formats[format],
         (unsigned long long)stats.triangle_count, (unsigned long long)stats.fragment_count,
         (unsigned long long)stats.group_count, taken.wall, taken.processor, least.wall, least.processor,
         least.processor / taken.processor, rmse, most, vtk.rmse, vtk.most);
  fflush(stdout);
}

static void bench_mesh(struct subject *subject, const char *transfer, bool with_errors, bool faces_only) {
  static const char *const channels[] = {"R", "G", "B", "A"};
  cellist_context *context = subject->context;
  open_subject(subject, transfer);
  for (uint32_t size = 512; size <= 1024; size *= 2) {
    const cellist_view view = cellist_view_orbit(cellist_mesh_get_arrays(subject->mesh)->bounds, 30.96, 34.45);
    cellist_frame frame;
    check(context, cellist_frame_from_view(context, &view, size, size, &frame), "frame");
    sort_cells(subject, &frame);
    cellist_image *image = NULL;
    check(context, cellist_image_create(context, size, size, channels, 4, &image), "image");
    double *truth = NULL;
    if (size == 512 && with_errors) {
      truth = malloc(4 * (size_t)size * size * sizeof *truth);
      const cellist_raycast_desc cast = {.precision = CELLIST_PRECISION_REFERENCE};
      const cellist_raycast_output output = {.rgba = truth};
      check(context, cellist_raycaster_render(subject->caster, &frame, &subject->transfer, &cast, &output, NULL),
            "reference");
    }
    bench_frame(subject, &frame, CELLIST_GL_FACES, CELLIST_FRAMEBUFFER_32F, truth, image);
    if (!faces_only) bench_frame(subject, &frame, CELLIST_GL_FAN, CELLIST_FRAMEBUFFER_32F, truth, image);
    if (size == 512 && !faces_only) {
      bench_frame(subject, &frame, CELLIST_GL_FACES, CELLIST_FRAMEBUFFER_16F, truth, image);
      bench_frame(subject, &frame, CELLIST_GL_FACES, CELLIST_FRAMEBUFFER_8, truth, image);
    }
    free(truth);
    cellist_image_destroy(image);
  }
  close_subject(subject);
}

int main(int argc, char **argv) {
  static const char *const published[] = {"spx",     "disk_out_ref", "impeller", "sci_torso",
                                          "gears_t", "bluntfin",     "post"};
  /* Memory that OpenGL frees stays with the process. Otherwise the probe pays for empty pages in every frame, or not,
   * as the renderer happened to have taught malloc before. */
  mallopt(M_MMAP_THRESHOLD, 32 << 20); /* glibc takes no more */
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  const char *transfer = NULL;
  bool with_errors = true, faces_only = false;
  int first = 1;
  for (; first < argc && argv[first][0] == '-'; first++)
    if (strcmp(argv[first], "--no-errors") == 0)
      with_errors = false;
    else if (strcmp(argv[first], "--faces") == 0)
      faces_only = true;
    else if (strcmp(argv[first], "--transfer") == 0 && first + 1 < argc)
      transfer = argv[++first];
  cellist_context *context = NULL;
  if (cellist_context_create(NULL, &context) != CELLIST_SUCCESS) return 1;
  cellist_gl *gl = NULL;
  check(context, cellist_gl_create(context, NULL, &gl), "create");
  printf(
      "mesh,tets,size,method,framebuffer,triangles,fragments,groups,seconds,processor_seconds,probe_seconds,"
      "probe_processor_seconds,share_of_probe,rmse,max,vtk_rmse,vtk_max\n");
  const int count = argc > first ? argc - first : (int)(sizeof published / sizeof *published);
  for (int i = 0; i < count; i++) {
    struct subject subject = {.name = argc > first ? argv[first + i] : published[i], .context = context, .gl = gl};
    bench_mesh(&subject, transfer, with_errors, faces_only);
  }
  cellist_gl_destroy(gl);
  cellist_context_destroy(context);
  return 0;
}
