/* SPDX-License-Identifier: BSD-3-Clause
 * Writes VTU: appended raw data in zlib blocks, UInt64 headers, little-endian: what ParaView writes and reads fastest.
 *
 * The blocks of an array are compressed in parallel, each on its own, so the file does not depend on the number of
 * workers. Offsets stand before the data, so all arrays are compressed before the first byte is written. */
#include "output.h"

#include <string.h>
#include <zlib.h>

/* VTK's own block size; larger compresses no better, since deflate looks back 32 KiB. */
enum { BLOCK = 32768 };
/* Level 6 takes twice the time for 3 % less. */
enum { LEVEL = 4 };

struct packed {
  char *tag;      /* the DataArray's attributes, without the offset */
  uint8_t *bytes; /* header and blocks */
  size_t size;
};

struct packing {
  cellist_context *context;
  const uint8_t *bytes;
  size_t size, bound;
  uint8_t *blocks;     /* [block_count][bound] */
  size_t *block_sizes; /* 0: failed */
};

static void *zlib_allocate(void *user, unsigned count, unsigned size) { return cellist_allocate(user, count, size); }
static void zlib_deallocate(void *user, void *block) { cellist_deallocate(user, block); }

static void pack_blocks(void *user, size_t begin, size_t end, unsigned worker) {
  (void)worker;
  struct packing *packing = user;
  z_stream z = {.zalloc = zlib_allocate, .zfree = zlib_deallocate, .opaque = packing->context};
  for (size_t i = begin; i < end; i++) packing->block_sizes[i] = 0;
  if (deflateInit(&z, LEVEL) != Z_OK) return;
  for (size_t i = begin; i < end; i++) {
    const size_t left = packing->size - i * BLOCK;
    z.next_in = (Bytef *)packing->bytes + i * BLOCK;
    z.avail_in = (unsigned)(left < BLOCK ? left : BLOCK);
    z.next_out = packing->blocks + i * packing->bound;
    z.avail_out = (unsigned)packing->bound;
    if (deflate(&z, Z_FINISH) == Z_STREAM_END) packing->block_sizes[i] = z.total_out;
    deflateReset(&z);
  }
  deflateEnd(&z);
}

/* Compresses bytes (which it frees) into packed. */
static cellist_result pack(cellist_context *context, uint8_t *bytes, size_t size, struct packed *packed) {
  const size_t count = (size + BLOCK - 1) / BLOCK;
  struct packing job = {.context = context, .bytes = bytes, .size = size, .bound = compressBound(BLOCK)};
  job.blocks = cellist_allocate(context, count, job.bound);
  job.block_sizes = cellist_allocate(context, count, sizeof *job.block_sizes);
  cellist_result result =
      bytes != NULL && job.blocks != NULL && job.block_sizes != NULL ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) {
    cellist_parallel_for(context, count, 16, pack_blocks, &job);
    packed->size = count > 0 ? (3 + count) * sizeof(uint64_t) : sizeof(uint64_t);
    for (size_t i = 0; i < count; i++) {
      packed->size += job.block_sizes[i];
      if (job.block_sizes[i] == 0) result = CELLIST_ERROR_OUT_OF_MEMORY;
    }
  }
  if (result == CELLIST_SUCCESS) {
    packed->bytes = cellist_allocate(context, packed->size, 1);
    if (packed->bytes == NULL) result = CELLIST_ERROR_OUT_OF_MEMORY;
  }
  if (result == CELLIST_SUCCESS) {
    uint8_t *to = packed->bytes;
    output_store(to, count, 8, false);
    if (count > 0) {
      output_store(to + 8, BLOCK, 8, false);
      output_store(to + 16, size % BLOCK, 8, false);
      for (size_t i = 0; i < count; i++) output_store(to + 24 + 8 * i, job.block_sizes[i], 8, false);
      to += 24 + 8 * count;
    }
    for (size_t i = 0; i < count; i++) {
      memcpy(to, job.blocks + i * job.bound, job.block_sizes[i]);
      to += job.block_sizes[i];
    }
  } else {
    cellist_fail(context, CELLIST_ERROR_OUT_OF_MEMORY, "out of memory");
  }
  cellist_deallocate(context, job.blocks);
  cellist_deallocate(context, job.block_sizes);
  cellist_deallocate(context, bytes);
  return result;
}

/* Attributes with the name escaped for XML. */
static cellist_result make_tag(cellist_context *context, const char *type, const char *name, size_t component_count,
                               struct packed *packed) {
  const size_t capacity = 6 * strlen(name) + 128;
  char *tag = cellist_allocate(context, capacity, 1);
  if (tag == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  size_t at = (size_t)snprintf(tag, capacity, "type=\"%s\" Name=\"", type);
  for (const char *c = name; *c != '\0'; c++) {
    const char *escaped = *c == '&' ? "&amp;" : *c == '<' ? "&lt;" : *c == '"' ? "&quot;" : NULL;
    if (escaped != NULL)
      at += (size_t)snprintf(tag + at, capacity - at, "%s", escaped);
    else
      tag[at++] = (unsigned char)*c < ' ' ? ' ' : *c; /* XML has no control characters */
  }
  snprintf(tag + at, capacity - at, "\" NumberOfComponents=\"%zu\"", component_count);
  packed->tag = tag;
  return CELLIST_SUCCESS;
}

static cellist_result pack_values(cellist_context *context, const char *name, const double *values,
                                  size_t component_count, const uint32_t *order, size_t count, struct packed *packed) {
  struct output_values made;
  cellist_result result = output_values_make(context, values, component_count, order, count, false, &made);
  if (result != CELLIST_SUCCESS) return result;
  result = make_tag(context, made.is_float32 ? "Float32" : "Float64", name, component_count, packed);
  if (result == CELLIST_SUCCESS) return pack(context, made.bytes, made.size, packed);
  cellist_deallocate(context, made.bytes);
  return result;
}

enum { CONNECTIVITY, OFFSETS, TYPES, POINTS, FIRST_FIELD };

static cellist_result pack_cells(cellist_context *context, const cellist_mesh_arrays *arrays,
                                 const struct output_order *order, struct packed *packed) {
  const size_t count = arrays->tet_count;
  /* Offsets go up to 4 count: beyond Int32 they need Int64, and connectivity goes along. */
  const size_t each = count < (1u << 29) - 1 ? 4 : 8;
  const char *type = each == 4 ? "Int32" : "Int64";
  uint8_t *bytes = cellist_allocate(context, 4 * count, each);
  if (bytes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < 4 * count; i++) {
    const size_t tet = order->tets[i / 4];
    output_store(bytes + each * i, order->point_place[arrays->tets[4 * tet + i % 4]], each, false);
  }
  cellist_result result = pack(context, bytes, 4 * count * each, &packed[CONNECTIVITY]);
  if (result == CELLIST_SUCCESS) result = make_tag(context, type, "connectivity", 1, &packed[CONNECTIVITY]);
  if (result != CELLIST_SUCCESS) return result;
  bytes = cellist_allocate(context, count, each);
  if (bytes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < count; i++) output_store(bytes + each * i, 4 * (i + 1), each, false);
  result = pack(context, bytes, count * each, &packed[OFFSETS]);
  if (result == CELLIST_SUCCESS) result = make_tag(context, type, "offsets", 1, &packed[OFFSETS]);
  if (result != CELLIST_SUCCESS) return result;
  bytes = cellist_allocate(context, count, 1);
  if (bytes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (count > 0) memset(bytes, 10, count); /* VTK_TETRA */
  result = pack(context, bytes, count, &packed[TYPES]);
  return result == CELLIST_SUCCESS ? make_tag(context, "UInt8", "types", 1, &packed[TYPES]) : result;
}

static void print_array(struct output *output, const struct packed *packed, size_t *offset) {
  output_print(output, "        <DataArray %s format=\"appended\" offset=\"%zu\"/>\n", packed->tag, *offset);
  *offset += packed->size;
}

static void print_fields(struct output *output, const cellist_mesh_arrays *arrays, cellist_association association,
                         const struct packed *packed, size_t *offset) {
  for (size_t i = 0; i < arrays->field_count; i++)
    if (arrays->fields[i].association == association) print_array(output, &packed[FIRST_FIELD + i], offset);
}

static void print_file(struct output *output, const cellist_mesh_arrays *arrays, const struct packed *packed) {
  size_t offset = 0;
  output_print(output,
               "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
               "byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n"
               "  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n      <PointData>\n",
               arrays->point_count, arrays->tet_count);
  print_fields(output, arrays, CELLIST_ON_POINTS, packed, &offset);
  output_print(output, "      </PointData>\n      <CellData>\n");
  print_fields(output, arrays, CELLIST_ON_CELLS, packed, &offset);
  output_print(output, "      </CellData>\n      <Points>\n");
  print_array(output, &packed[POINTS], &offset);
  output_print(output, "      </Points>\n      <Cells>\n");
  for (int i = CONNECTIVITY; i <= TYPES; i++) print_array(output, &packed[i], &offset);
  output_print(output, "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n   _");
  for (int pass = CELLIST_ON_POINTS; pass <= CELLIST_ON_CELLS; pass++)
    for (size_t i = 0; i < arrays->field_count; i++)
      if ((int)arrays->fields[i].association == pass)
        output_write(output, packed[FIRST_FIELD + i].bytes, packed[FIRST_FIELD + i].size);
  output_write(output, packed[POINTS].bytes, packed[POINTS].size);
  for (int i = CONNECTIVITY; i <= TYPES; i++) output_write(output, packed[i].bytes, packed[i].size);
  output_print(output, "\n  </AppendedData>\n</VTKFile>\n");
}

cellist_result write_vtu(struct output *output, const cellist_mesh *mesh) {
  cellist_context *context = output->context;
  const cellist_mesh_arrays *arrays = cellist_mesh_get_arrays(mesh);
  const size_t count = FIRST_FIELD + arrays->field_count;
  struct output_order order = {0};
  struct packed *packed = cellist_allocate_zeroed(context, count, sizeof *packed);
  cellist_result result = packed != NULL ? output_order_make(context, arrays, &order) : CELLIST_ERROR_OUT_OF_MEMORY;
  if (result == CELLIST_SUCCESS) result = pack_cells(context, arrays, &order, packed);
  if (result == CELLIST_SUCCESS)
    result = pack_values(context, "Points", arrays->positions, 3, order.points, arrays->point_count, &packed[POINTS]);
  for (size_t i = 0; i < arrays->field_count && result == CELLIST_SUCCESS; i++) {
    const cellist_field *field = &arrays->fields[i];
    const bool on_points = field->association == CELLIST_ON_POINTS;
    result = cellist_progress(context, "writing", (double)i / (double)arrays->field_count);
    if (result == CELLIST_SUCCESS)
      result = pack_values(context, field->name, field->values, field->component_count,
                           on_points ? order.points : order.tets, on_points ? arrays->point_count : arrays->tet_count,
                           &packed[FIRST_FIELD + i]);
  }
  if (result == CELLIST_SUCCESS) print_file(output, arrays, packed);
  for (size_t i = 0; i < count && packed != NULL; i++) {
    cellist_deallocate(context, packed[i].tag);
    cellist_deallocate(context, packed[i].bytes);
  }
  cellist_deallocate(context, packed);
  output_order_release(context, &order);
  return result;
}
