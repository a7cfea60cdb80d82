/* SPDX-License-Identifier: BSD-3-Clause
 * Cache: a complex in a file, so that convexifying is paid once.
 *
 * The file is the arrays as they are (doubles bit by bit, ids as 32 bits, in the byte order of the machine, which the
 * head tells), with the statistics, a note, a key and a checksum. The key is a hash of everything that the complex
 * depends on: this file's version, the mesh's points and tets, the options, the caller's purpose, and whether TetGen
 * was there. A file that is cut, changed, of another mesh or of other options is no error: the complex is made anew and
 * the file replaced, whole or not at all. */
#include <stdio.h>
#include <unistd.h>

#include "work.h"

/* To be raised whenever the same options give another complex, or the layout below changes. */
enum { CACHE_VERSION = 4, ARRAY_COUNT = 8 };
static const char MAGIC[8] = {'C', 'E', 'L', 'L', 'S', '\r', '\n', 26};
static const uint64_t BYTE_ORDER_MARK = 0x0102030405060708u;

typedef struct cache_head {
  char magic[8];
  uint64_t byte_order;
  uint64_t key[2];
  uint64_t checksum;  /* of the rest of the head and all arrays */
  uint64_t counts[8]; /* tets, cells, points, offsets, planes, facets, vertices, corners */
  double volumes[4];
  double flat[3];      /* radians, distance, degrees */
  uint64_t numbers[7]; /* exterior, cuts, merges, exterior_facets, convexity_violations, flat_edges, whether there is a
                          complex */
  char note[CELLIST_CELLS_NOTE];
} cache_head;

static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t size) {
  const unsigned char *p = bytes;
  for (; size >= 8; size -= 8, p += 8) {
    uint64_t word;
    memcpy(&word, p, 8);
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  uint64_t rest = size;
  for (size_t i = 0; i < size; i++) rest = rest << 8 | p[i];
  hash = (hash ^ rest) * 0xbf58476d1ce4e5b9u;
  return hash ^ hash >> 31;
}

cellist_cells_key cellist_cells_key_of(const cellist_mesh *of, const cellist_convexify_desc *desc, uint64_t purpose) {
  const cellist_mesh_arrays *mesh = cellist_mesh_get_arrays(of);
  const cellist_convexify_desc defaults = cellist_convexify_desc_default();
  if (desc == NULL) desc = &defaults;
#ifdef CELLIST_HAVE_TETGEN
  const uint64_t has_tetgen = 1;
#else
  const uint64_t has_tetgen = 0;
#endif
  uint64_t flat_bits;
  const double flat = desc->flat_degrees + 0.0; /* -0 is 0 */
  memcpy(&flat_bits, &flat, sizeof flat_bits);
  const uint64_t options[] = {CACHE_VERSION,       has_tetgen,
                              desc->exterior,      desc->candidates > 0 ? desc->candidates : defaults.candidates,
                              desc->score,         desc->seed,
                              desc->keep_unmerged, desc->grid_size,
                              mesh->point_count,   mesh->tet_count,
                              flat_bits,           purpose};
  cellist_cells_key key;
  for (int i = 0; i < 2; i++) {
    uint64_t hash = hash_bytes(i == 0 ? 0x243f6a8885a308d3u : 0x13198a2e03707344u, options, sizeof options);
    hash = hash_bytes(hash, mesh->positions, 3 * mesh->point_count * sizeof *mesh->positions);
    hash = hash_bytes(hash, mesh->tets, 4 * mesh->tet_count * sizeof *mesh->tets);
    key.value[i] = hash_bytes(hash, mesh->neighbours, 4 * mesh->tet_count * sizeof *mesh->neighbours);
  }
  return key;
}

/* The complex's arrays in the file's order; sizes in bytes. */
static void list_arrays(cellist_complex_arrays *a, const void **blocks[ARRAY_COUNT], size_t sizes[ARRAY_COUNT],
                        size_t corner_count) {
  const void **all[ARRAY_COUNT] = {(const void **)&a->points,         (const void **)&a->offsets,
                                   (const void **)&a->planes,         (const void **)&a->facet_planes,
                                   (const void **)&a->facet_cells,    (const void **)&a->facet_starts,
                                   (const void **)&a->facet_vertices, (const void **)&a->vertices};
  const size_t bytes[ARRAY_COUNT] = {24 * a->point_count, 8 * a->offset_count, 12 * a->plane_count,
                                     4 * a->facet_count,  8 * a->facet_count,  4 * (a->facet_count + 1),
                                     4 * corner_count,    24 * a->vertex_count};
  memcpy(blocks, all, sizeof all);
  memcpy(sizes, bytes, sizeof bytes);
}

static uint64_t checksum_of(const cache_head *head, const void **const blocks[ARRAY_COUNT],
                            const size_t sizes[ARRAY_COUNT]) {
  uint64_t hash = hash_bytes(head->key[0], head->counts, sizeof *head - offsetof(cache_head, counts));
  for (int i = 0; i < ARRAY_COUNT; i++) hash = hash_bytes(hash, *blocks[i], sizes[i]);
  return hash;
}

static void fill_stats(const cache_head *head, const cellist_complex_arrays *a, cellist_convexify_stats *stats) {
  *stats = (cellist_convexify_stats){.exterior = (cellist_exterior)head->numbers[0],
                                     .imaginary_cells = a->cell_count - a->tet_count,
                                     .facets = a->facet_count,
                                     .planes = a->plane_count,
                                     .cuts = head->numbers[1],
                                     .merges = head->numbers[2],
                                     .exterior_facets = head->numbers[3],
                                     .convexity_violations = head->numbers[4],
                                     .flat_edges = head->numbers[5],
                                     .flat_angle = head->flat[2],
                                     .flat_distance = head->flat[1],
                                     .hull_volume = head->volumes[0],
                                     .mesh_volume = head->volumes[1],
                                     .imaginary_volume = head->volumes[2],
                                     .volume_error = head->volumes[3],
                                     .cached = true};
}

/* Whether the rest of the file is exactly as long as the head says. */
static bool has_length(FILE *file, uint64_t payload) {
  if (fseeko(file, 0, SEEK_END) != 0) return false;
  const off_t end = ftello(file);
  return end >= 0 && (uint64_t)end == sizeof(cache_head) + payload &&
         fseeko(file, (off_t)sizeof(cache_head), SEEK_SET) == 0;
}

cellist_result cellist_cells_read(cellist_context *context, const char *path, cellist_cells_key key,
                                  cellist_complex **complex, cellist_convexify_stats *stats,
                                  char note[CELLIST_CELLS_NOTE]) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (path == NULL || complex == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_cells_read: path or complex is NULL");
  FILE *file = fopen(path, "rb");
  if (file == NULL) return cellist_fail(context, CELLIST_ERROR_NOT_FOUND, "%s cannot be read", path);
  cache_head head;
  cellist_complex_arrays a = {0};
  cellist_complex *made = NULL;
  const void **blocks[ARRAY_COUNT];
  size_t sizes[ARRAY_COUNT];
  bool usable = fread(&head, sizeof head, 1, file) == 1 && memcmp(head.magic, MAGIC, sizeof MAGIC) == 0 &&
                head.byte_order == BYTE_ORDER_MARK && head.key[0] == key.value[0] && head.key[1] == key.value[1];
  for (int i = 0; usable && i < 8; i++) usable = head.counts[i] <= UINT32_MAX;
  cellist_result result = CELLIST_SUCCESS;
  if (usable) {
    size_t *counts[] = {&a.tet_count,   &a.cell_count,  &a.point_count, &a.offset_count,
                        &a.plane_count, &a.facet_count, &a.vertex_count};
    for (int i = 0; i < 7; i++) *counts[i] = head.counts[i];
    a.flat_angle = head.flat[0];
    a.flat_distance = head.flat[1];
    list_arrays(&a, blocks, sizes, head.counts[7]);
    uint64_t payload = 0;
    for (int i = 0; i < ARRAY_COUNT; i++) payload += sizes[i];
    usable = has_length(file, payload);
    for (int i = 0; usable && i < ARRAY_COUNT; i++) {
      void *block = cellist_allocate(context, sizes[i], 1);
      *blocks[i] = block;
      if (block == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
      usable = block != NULL && (sizes[i] == 0 || fread(block, sizes[i], 1, file) == 1);
    }
    usable = usable && checksum_of(&head, (const void **const *)blocks, sizes) == head.checksum &&
             a.facet_starts[a.facet_count] == head.counts[7];
    if (usable && head.numbers[6] != 0) result = cellist_complex_create(context, &a, &made);
    for (int i = 0; i < ARRAY_COUNT; i++) cellist_deallocate(context, (void *)*blocks[i]);
  }
  fclose(file);
  if (result != CELLIST_SUCCESS) return result;
  if (!usable)
    return cellist_fail(context, CELLIST_ERROR_NOT_FOUND, "%s is damaged, or of another mesh or other options", path);
  *complex = made;
  if (stats != NULL) fill_stats(&head, &a, stats);
  if (note != NULL) memcpy(note, head.note, sizeof head.note);
  if (note != NULL) note[CELLIST_CELLS_NOTE - 1] = '\0';
  return CELLIST_SUCCESS;
}

static bool write_all(FILE *file, const cache_head *head, const void **const blocks[ARRAY_COUNT],
                      const size_t sizes[ARRAY_COUNT]) {
  bool ok = fwrite(head, sizeof *head, 1, file) == 1;
  for (int i = 0; ok && i < ARRAY_COUNT; i++) ok = sizes[i] == 0 || fwrite(*blocks[i], sizes[i], 1, file) == 1;
  return ok;
}

cellist_result cellist_cells_write(cellist_context *context, const char *path, cellist_cells_key key,
                                   const cellist_complex *complex, const cellist_convexify_stats *stats,
                                   const char *note) {
  static const uint32_t no_corners = 0;
  const cellist_convexify_stats none = {0};
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (path == NULL || (complex != NULL && stats == NULL))
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_cells_write: path or stats is NULL");
  if (stats == NULL) stats = &none;
  cellist_complex_arrays a = {.facet_starts = &no_corners};
  if (complex != NULL) a = *cellist_complex_get_arrays(complex);
  const size_t corner_count = a.facet_starts[a.facet_count];
  cache_head head = {.byte_order = BYTE_ORDER_MARK,
                     .key = {key.value[0], key.value[1]},
                     .counts = {a.tet_count, a.cell_count, a.point_count, a.offset_count, a.plane_count, a.facet_count,
                                a.vertex_count, corner_count},
                     .volumes = {stats->hull_volume, stats->mesh_volume, stats->imaginary_volume, stats->volume_error},
                     .flat = {a.flat_angle, a.flat_distance, stats->flat_angle},
                     .numbers = {stats->exterior, stats->cuts, stats->merges, stats->exterior_facets,
                                 stats->convexity_violations, stats->flat_edges, complex != NULL}};
  if (note != NULL) snprintf(head.note, sizeof head.note, "%s", note);
  memcpy(head.magic, MAGIC, sizeof MAGIC);
  const void **blocks[ARRAY_COUNT];
  size_t sizes[ARRAY_COUNT];
  list_arrays(&a, blocks, sizes, corner_count);
  head.checksum = checksum_of(&head, (const void **const *)blocks, sizes);

  const size_t length = strlen(path) + 32;
  char *partial = cellist_allocate(context, length, 1);
  if (partial == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  snprintf(partial, length, "%s.%ld.part", path, (long)getpid());
  FILE *file = fopen(partial, "wb");
  bool ok = file != NULL && write_all(file, &head, (const void **const *)blocks, sizes);
  if (file != NULL) ok = fclose(file) == 0 && ok;
  ok = ok && rename(partial, path) == 0;
  if (!ok && file != NULL) remove(partial);
  cellist_deallocate(context, partial);
  return ok ? CELLIST_SUCCESS : cellist_fail(context, CELLIST_ERROR_IO, "%s cannot be written", path);
}

cellist_result cellist_convexify_cached(cellist_context *context, const cellist_mesh *mesh,
                                        const cellist_convexify_desc *desc, const char *path, cellist_complex **complex,
                                        cellist_convexify_stats *stats) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || complex == NULL || path == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_convexify_cached: an argument is NULL");
  cellist_convexify_stats own;
  const cellist_cells_key key = cellist_cells_key_of(mesh, desc, 0);
  cellist_complex *made = NULL;
  cellist_result result = cellist_cells_read(context, path, key, &made, &own, NULL);
  if (result == CELLIST_ERROR_NOT_FOUND || (result == CELLIST_SUCCESS && made == NULL)) {
    cellist_context_take_error(context);
    result = cellist_convexify(context, mesh, desc, &made, &own);
    if (result == CELLIST_SUCCESS) result = cellist_cells_write(context, path, key, made, &own, NULL);
    if (result != CELLIST_SUCCESS) {
      cellist_complex_destroy(made);
      made = NULL;
    }
  }
  if (result != CELLIST_SUCCESS) return result;
  *complex = made;
  if (stats != NULL) *stats = own;
  return CELLIST_SUCCESS;
}
