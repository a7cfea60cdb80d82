// SPDX-License-Identifier: BSD-3-Clause
// TetGen 1.5 (AGPL) with -pYc: the surface as given, without points of its own on it, up to the hull.
//
// TetGen runs in a child process, because surfaces that it cannot take may end the process that it runs in: by its own
// assertions (flips that find no way), by a segmentation fault (duplicated facets), or never. Such a surface is
// refused. The child also keeps TetGen's static state and its prints to itself.
#include "delaunay_tetgen.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tetgen.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

namespace {

// Processor time after which TetGen is taken for lost. It needs some 10 s for the worst surface of 16,000 triangles
// that was met (gears with coplanar and cocircular points); a smaller limit refuses large surfaces.
const rlim_t SECONDS_LIMIT = 900;

struct message_head {
  int result, point_count, tet_count;
};

bool write_all(int to, const void *bytes, size_t size) {
  const char *at = static_cast<const char *>(bytes);
  while (size > 0) {
    const ssize_t done = write(to, at, size);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done;
    size -= static_cast<size_t>(done);
  }
  return true;
}

bool read_all(int from, void *bytes, size_t size) {
  char *at = static_cast<char *>(bytes);
  while (size > 0) {
    const ssize_t done = read(from, at, size);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done;
    size -= static_cast<size_t>(done);
  }
  return true;
}

delaunay_result tetrahedralise(size_t point_count, const double *positions, size_t triangle_count,
                               const uint32_t *triangles, tetgenio *out) {
  try {
    tetgenio in;
    in.numberofpoints = static_cast<int>(point_count);
    in.pointlist = new REAL[3 * point_count];
    for (size_t i = 0; i < 3 * point_count; i++) in.pointlist[i] = positions[i];
    in.facetlist = new tetgenio::facet[triangle_count];
    for (size_t t = 0; t < triangle_count; t++) tetgenio::init(&in.facetlist[t]);
    in.numberoffacets = static_cast<int>(triangle_count);
    for (size_t t = 0; t < triangle_count; t++) {
      tetgenio::facet &facet = in.facetlist[t];
      facet.polygonlist = new tetgenio::polygon[1];
      facet.numberofpolygons = 1;
      tetgenio::init(&facet.polygonlist[0]);
      facet.polygonlist[0].vertexlist = new int[3];
      facet.polygonlist[0].numberofvertices = 3;
      for (size_t k = 0; k < 3; k++) facet.polygonlist[0].vertexlist[k] = static_cast<int>(triangles[3 * t + k]);
    }
    char switches[] = "pYcQ";
    ::tetrahedralize(switches, &in, out);
    return out->numberofcorners == 4 && out->tetrahedronlist != nullptr ? DELAUNAY_DONE : DELAUNAY_REFUSED;
  } catch (const std::bad_alloc &) {
    return DELAUNAY_NO_MEMORY;
  } catch (...) {
    return DELAUNAY_REFUSED;
  }
}

// The child: what TetGen made goes into the pipe.
[[noreturn]] void run_child(int to, size_t point_count, const double *positions, size_t triangle_count,
                            const uint32_t *triangles) {
  const int fatal[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU, SIGPIPE};
  for (const int number : fatal) signal(number, SIG_DFL);
  const rlimit no_core = {0, 0}, time = {SECONDS_LIMIT, SECONDS_LIMIT + 1};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &time);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  tetgenio *out = new (std::nothrow) tetgenio;
  message_head head = {DELAUNAY_NO_MEMORY, 0, 0};
  if (out != nullptr) head.result = tetrahedralise(point_count, positions, triangle_count, triangles, out);
  if (head.result == DELAUNAY_DONE) {
    head.point_count = out->numberofpoints;
    head.tet_count = out->numberoftetrahedra;
  }
  bool ok = write_all(to, &head, sizeof head);
  if (ok && head.result == DELAUNAY_DONE)
    ok = write_all(to, out->pointlist, 3 * sizeof(double) * static_cast<size_t>(head.point_count)) &&
         write_all(to, out->tetrahedronlist, 4 * sizeof(int) * static_cast<size_t>(head.tet_count));
  _exit(ok ? 0 : 1);
}

// Until something can be read, or the other end is closed. False: nobody waits any more.
bool wait_for(int from, delaunay_waiting waiting, void *user) {
  for (;;) {
    pollfd end = {from, POLLIN, 0};
    const int ready = poll(&end, 1, DELAUNAY_PATIENCE);
    if (ready > 0 || (ready < 0 && errno != EINTR)) return true;
    if (ready == 0 && !waiting(user)) return false;
  }
}

// The parent: takes what comes out of the pipe. A child that died before it was through is a surface refused.
delaunay_result receive(int from, delaunay_tets *tets) {
  message_head head;
  if (!read_all(from, &head, sizeof head)) return DELAUNAY_REFUSED;
  if (head.result != DELAUNAY_DONE) return static_cast<delaunay_result>(head.result);
  if (head.point_count < 0 || head.tet_count < 0) return DELAUNAY_REFUSED;
  const size_t points = 3 * static_cast<size_t>(head.point_count), corners = 4 * static_cast<size_t>(head.tet_count);
  char *block = new (std::nothrow) char[points * sizeof(double) + corners * sizeof(int)];
  if (block == nullptr) return DELAUNAY_NO_MEMORY;
  if (!read_all(from, block, points * sizeof(double) + corners * sizeof(int))) {
    delete[] block;
    return DELAUNAY_REFUSED;
  }
  tets->handle = block;
  tets->point_count = static_cast<size_t>(head.point_count);
  tets->positions = reinterpret_cast<const double *>(block);
  tets->tet_count = static_cast<size_t>(head.tet_count);
  tets->tets = reinterpret_cast<const int *>(block + points * sizeof(double));
  return DELAUNAY_DONE;
}

} // namespace

delaunay_result delaunay_compute(size_t point_count, const double *positions, size_t triangle_count,
                                 const uint32_t *triangles, delaunay_waiting waiting, void *user, delaunay_tets *tets) {
  int ends[2];
  if (pipe(ends) != 0) return DELAUNAY_REFUSED;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_child(ends[1], point_count, positions, triangle_count, triangles);
  }
  close(ends[1]);
  delaunay_result result = DELAUNAY_REFUSED;
  if (child > 0 && wait_for(ends[0], waiting, user)) {
    result = receive(ends[0], tets);
  } else if (child > 0) {
    kill(child, SIGKILL);
    result = DELAUNAY_CANCELLED;
  }
  close(ends[0]);
  while (child > 0 && waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  return result;
}

void delaunay_release(delaunay_tets *tets) {
  delete[] static_cast<char *>(tets->handle);
  *tets = delaunay_tets{};
}
