/* SPDX-License-Identifier: BSD-3-Clause
 * Import: STL, OBJ and PLY by assimp's C interface; nothing of assimp is known outside of this file. What it makes is
 * checked like any other input: indices, coordinates, and that there is a triangle at all. */
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <base/srgb.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "import.h"
#include "ply_check.h"

/* assimp keeps the text of the last failure in one place for all threads: calls take turns. */
static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;

/* Where one file's content goes. */
struct target {
  cellist_context *context;
  const char *name;
  double *positions, *normals;
  float *colours;
  uint32_t *triangles;
  size_t point_count, triangle_count;
};

static size_t triangles_of(const struct aiMesh *mesh) {
  size_t count = 0;
  for (unsigned i = 0; i < mesh->mNumFaces; i++) count += mesh->mFaces[i].mNumIndices == 3;
  return count;
}

/* The file's colours are those of a screen. */
static float linear(ai_real value) {
  const double clamped = value > 0 ? (value < 1 ? (double)value : 1) : 0; /* NaN: 0 */
  return (float)linear_from_srgb(clamped);
}

static cellist_result add_points(struct target *target, const struct aiMesh *mesh, const double colour[3]) {
  for (unsigned i = 0; i < mesh->mNumVertices; i++) {
    const struct aiVector3D p = mesh->mVertices[i];
    const size_t at = 3 * target->point_count++;
    if (!isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z))
      return cellist_fail(target->context, CELLIST_ERROR_GEOMETRY, "%s: vertex %zu is not finite (%g %g %g)",
                          target->name, at / 3, (double)p.x, (double)p.y, (double)p.z);
    target->positions[at] = p.x;
    target->positions[at + 1] = p.y;
    target->positions[at + 2] = p.z;
    if (target->normals != NULL && mesh->mNormals != NULL) {
      const struct aiVector3D n = mesh->mNormals[i];
      const bool finite = isfinite(n.x) && isfinite(n.y) && isfinite(n.z);
      target->normals[at] = finite ? n.x : 0;
      target->normals[at + 1] = finite ? n.y : 0;
      target->normals[at + 2] = finite ? n.z : 0;
    }
    for (size_t k = 0; k < 3; k++) target->colours[at + k] = colour != NULL ? (float)colour[k] : 0.8f;
    if (colour == NULL && mesh->mColors[0] != NULL) {
      const struct aiColor4D c = mesh->mColors[0][i];
      target->colours[at] = linear(c.r);
      target->colours[at + 1] = linear(c.g);
      target->colours[at + 2] = linear(c.b);
    }
  }
  return CELLIST_SUCCESS;
}

static cellist_result add_mesh(struct target *target, const struct aiMesh *mesh, const double colour[3]) {
  const size_t first = target->point_count;
  const cellist_result result = add_points(target, mesh, colour);
  if (result != CELLIST_SUCCESS) return result;
  for (unsigned i = 0; i < mesh->mNumFaces; i++) {
    const struct aiFace *face = &mesh->mFaces[i];
    if (face->mNumIndices != 3) continue; /* points and lines */
    for (int c = 0; c < 3; c++) {
      if (face->mIndices[c] >= mesh->mNumVertices)
        return cellist_fail(target->context, CELLIST_ERROR_FORMAT, "%s: triangle %zu names vertex %u of %u",
                            target->name, target->triangle_count, face->mIndices[c], mesh->mNumVertices);
      target->triangles[3 * target->triangle_count + (size_t)c] = (uint32_t)(first + face->mIndices[c]);
    }
    target->triangle_count++;
  }
  return CELLIST_SUCCESS;
}

static cellist_result convert(struct target *target, const struct aiScene *scene, bool with_normals,
                              const double colour[3], cellist_surface **surface) {
  cellist_context *context = target->context;
  size_t point_count = 0, triangle_count = 0;
  bool has_normals = false;
  for (unsigned i = 0; i < scene->mNumMeshes; i++) {
    point_count += scene->mMeshes[i]->mNumVertices;
    triangle_count += triangles_of(scene->mMeshes[i]);
    has_normals = has_normals || scene->mMeshes[i]->mNormals != NULL;
  }
  if (triangle_count == 0)
    return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: there are no triangles in it", target->name);
  target->positions = cellist_allocate(context, point_count, 3 * sizeof *target->positions);
  target->colours = cellist_allocate(context, point_count, 3 * sizeof *target->colours);
  target->triangles = cellist_allocate(context, triangle_count, 3 * sizeof *target->triangles);
  if (with_normals && has_normals)
    target->normals = cellist_allocate_zeroed(context, point_count, 3 * sizeof *target->normals);
  if (target->positions == NULL || target->colours == NULL || target->triangles == NULL ||
      (with_normals && has_normals && target->normals == NULL))
    return CELLIST_ERROR_OUT_OF_MEMORY;
  for (unsigned i = 0; i < scene->mNumMeshes; i++) {
    const cellist_result result = add_mesh(target, scene->mMeshes[i], colour);
    if (result != CELLIST_SUCCESS) return result;
  }
  const cellist_surface_arrays arrays = {point_count,     target->positions, target->normals,
                                         target->colours, triangle_count,    target->triangles};
  return cellist_surface_create(context, &arrays, surface);
}

cellist_result surface_import(cellist_context *context, const char *name, const char *format, const void *bytes,
                              size_t size, bool with_normals, const double colour[3], cellist_surface **surface) {
  if (size > UINT_MAX)
    return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED, "%s: surface files of 4 GB or more are not read", name);
  if (strcmp(format, "ply") == 0) {
    const cellist_result sound = surface_check_ply(context, name, bytes, size);
    if (sound != CELLIST_SUCCESS) return sound;
  }
  struct target target = {.context = context, .name = name};
  cellist_result result;
  pthread_mutex_lock(&turn);
  const struct aiScene *scene =
      aiImportFileFromMemory(bytes, (unsigned)size, aiProcess_Triangulate | aiProcess_SortByPType, format);
  if (scene == NULL)
    result =
        cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: not read as %s: %.600s", name, format, aiGetErrorString());
  else
    result = CELLIST_SUCCESS;
  pthread_mutex_unlock(&turn);
  if (scene == NULL) return result;
  result = convert(&target, scene, with_normals, colour, surface);
  aiReleaseImport(scene);
  cellist_deallocate(context, target.positions);
  cellist_deallocate(context, target.normals);
  cellist_deallocate(context, target.colours);
  cellist_deallocate(context, target.triangles);
  return result;
}
