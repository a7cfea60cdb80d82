/* SPDX-License-Identifier: BSD-3-Clause
 * VTU: every way to write the same two tets reads as the same mesh; what is wrong with a file is said. */
#include <lz4.h>
#include <lzma.h>
#include <unistd.h>
#include <zlib.h>

#include "formats.h"

enum coding { ASCII, INLINE, RAW, BASE64 };
enum codec { NONE, ZLIB, LZ4, LZMA };

struct variant {
  enum coding coding;
  enum codec codec;
  size_t header_size;
  bool big_endian;
  const char *id_type; /* of connectivity and offsets */
  size_t id_size;
  const char *real_type;
  size_t real_size; /* 0: integers of one byte */
  int piece_count;
};

struct file {
  struct bytes xml, appended;
};

static void add_base64(struct bytes *to, const uint8_t *data, size_t size) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < size; i += 3) {
    const unsigned bits = (unsigned)data[i] << 16 | (unsigned)(i + 1 < size ? data[i + 1] : 0) << 8 |
                          (unsigned)(i + 2 < size ? data[i + 2] : 0);
    char group[4] = {digits[bits >> 18], digits[bits >> 12 & 63], digits[bits >> 6 & 63], digits[bits & 63]};
    if (i + 1 >= size) group[2] = '=';
    if (i + 2 >= size) group[3] = '=';
    bytes_add(to, group, 4);
  }
}

/* A block as its library packs it. */
static void add_packed(struct bytes *to, enum codec codec, const uint8_t *data, size_t size) {
  uint8_t packed[4096];
  uLongf zlib_size = sizeof packed;
  size_t packed_size = 0;
  if (codec == ZLIB) {
    assert_int_equal(compress(packed, &zlib_size, data, size), Z_OK);
    packed_size = zlib_size;
  } else if (codec == LZ4) {
    packed_size = (size_t)LZ4_compress_default((const char *)data, (char *)packed, (int)size, sizeof packed);
  } else {
    assert_int_equal(
        lzma_easy_buffer_encode(1, LZMA_CHECK_CRC32, NULL, data, size, packed, &packed_size, sizeof packed), LZMA_OK);
  }
  bytes_add(to, packed, packed_size);
}

/* Header and data of one array as they stand in the file. */
static void add_encoded(struct bytes *to, const struct variant *v, bool base64, const struct bytes *raw) {
  enum { BLOCK = 20 }; /* splits numbers, too */
  struct bytes header = {0}, data = {0};
  if (v->codec == NONE) {
    bytes_number(&header, raw->size, v->header_size, v->big_endian);
    bytes_add(&header, raw->data, raw->size); /* one stream with the header */
  } else {
    const size_t count = (raw->size + BLOCK - 1) / BLOCK;
    bytes_number(&header, count, v->header_size, v->big_endian);
    bytes_number(&header, BLOCK, v->header_size, v->big_endian);
    bytes_number(&header, raw->size % BLOCK, v->header_size, v->big_endian);
    for (size_t i = 0; i < count; i++) {
      const size_t before = data.size, left = raw->size - i * BLOCK;
      add_packed(&data, v->codec, raw->data + i * BLOCK, left < BLOCK ? left : BLOCK);
      bytes_number(&header, data.size - before, v->header_size, v->big_endian);
    }
  }
  if (base64) {
    add_base64(to, header.data, header.size); /* a stream of its own */
    add_base64(to, data.data, data.size);
  } else {
    bytes_add(to, header.data, header.size);
    bytes_add(to, data.data, data.size);
  }
  bytes_free(&header);
  bytes_free(&data);
}

static void add_array(struct file *file, const struct variant *v, const char *name, const char *type, size_t size,
                      bool is_real, int components, const double *values, size_t count) {
  static const char *const formats[] = {"ascii", "binary", "appended", "appended"};
  char tag[256];
  snprintf(tag, sizeof tag,
           "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"%s\" offset=\"%zu\">", type, name,
           components, formats[v->coding], file->appended.size);
  bytes_text(&file->xml, tag);
  bytes_text(&file->xml, "<InformationKey name=\"k\" location=\"l\">1</InformationKey>\n");
  struct bytes raw = {0};
  for (size_t i = 0; i < count; i++) {
    char number[32];
    snprintf(number, sizeof number, "%.17g ", values[i]);
    if (v->coding == ASCII) bytes_text(&file->xml, number);
    if (is_real && size > 1)
      bytes_float(&raw, values[i], size, v->big_endian);
    else
      bytes_number(&raw, (uint64_t)(int64_t)values[i], size, v->big_endian);
  }
  if (v->coding == INLINE) add_encoded(&file->xml, v, true, &raw);
  if (v->coding == RAW || v->coding == BASE64) add_encoded(&file->appended, v, v->coding == BASE64, &raw);
  bytes_free(&raw);
  bytes_text(&file->xml, "\n</DataArray>\n");
}

static struct bytes make_file(const struct variant *v) {
  static const char *const compressors[] = {"", " compressor=\"vtkZLibDataCompressor\"",
                                            " compressor=\"vtkLZ4DataCompressor\"",
                                            " compressor=\"vtkLZMADataCompressor\""};
  static const double scalars[] = {1, 2, 3, 4, -5}, vectors[] = {1, 2, 3, 4, 5, 6}, ghosts[] = {0, 0};
  static const double connectivity[] = {0, 1, 2, 3, 1, 2, 3, 4}, ends[] = {4, 8}, types[] = {10, 10};
  struct file file = {0};
  char text[512];
  snprintf(text, sizeof text,
           "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"%s\" header_type=\"%s\"%s>\n"
           "<UnstructuredGrid>\n<FieldData><DataArray type=\"String\" Name=\"t\" format=\"ascii\">65 0</DataArray>"
           "</FieldData>\n",
           v->big_endian ? "BigEndian" : "LittleEndian", v->header_size == 4 ? "UInt32" : "UInt64",
           compressors[v->codec]);
  bytes_text(&file.xml, text);
  for (int piece = 0; piece < v->piece_count; piece++) {
    double points[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    for (int i = 0; i < 15; i += 3) points[i] += 10 * piece;
    bytes_text(&file.xml, "<Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<PointData>\n");
    add_array(&file, v, "s &amp; t", v->real_type, v->real_size, v->real_size > 1, 1, scalars, 5);
    bytes_text(&file.xml, "</PointData>\n<CellData>\n");
    add_array(&file, v, "v", v->real_type, v->real_size, v->real_size > 1, 3, vectors, 6);
    add_array(&file, v, "vtkGhostType", "UInt8", 1, false, 1, ghosts, 2);
    bytes_text(&file.xml, "</CellData>\n<Points>\n");
    add_array(&file, v, "Points", v->real_type, v->real_size, v->real_size > 1, 3, points, 15);
    bytes_text(&file.xml, "</Points>\n<Cells>\n");
    add_array(&file, v, "connectivity", v->id_type, v->id_size, false, 1, connectivity, 8);
    add_array(&file, v, "offsets", v->id_type, v->id_size, false, 1, ends, 2);
    add_array(&file, v, "types", "UInt8", 1, false, 1, types, 2);
    bytes_text(&file.xml, "</Cells>\n</Piece>\n");
  }
  bytes_text(&file.xml, "</UnstructuredGrid>\n");
  if (v->coding == RAW) bytes_text(&file.xml, "<AppendedData encoding=\"raw\">\n  _");
  if (v->coding == BASE64) bytes_text(&file.xml, "<AppendedData encoding=\"base64\">_");
  bytes_add(&file.xml, file.appended.data, file.appended.size);
  if (v->coding >= RAW) bytes_text(&file.xml, "\n</AppendedData>\n");
  bytes_text(&file.xml, "</VTKFile>\n");
  bytes_free(&file.appended);
  return file.xml;
}

static void check_two_tets(const cellist_mesh *mesh, int piece_count) {
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  assert_int_equal(a->point_count, 5 * piece_count);
  assert_int_equal(a->tet_count, 2 * piece_count);
  assert_int_equal(a->field_count, 2);
  assert_string_equal(a->fields[0].name, "s & t");
  assert_int_equal(a->fields[1].component_count, 3);
  for (size_t i = 0; i < a->point_count; i++) {
    static const double scalars[] = {1, 2, 3, 4, -5};
    const uint32_t id = a->point_origin[i];
    assert_true(a->fields[0].values[i] == scalars[id % 5]);
    assert_true(a->positions[3 * i] == 10 * (id / 5) + (id % 5 == 1 || id % 5 == 4));
    assert_true(a->positions[3 * i + 1] == (id % 5 == 2 || id % 5 == 4));
  }
  for (size_t i = 0; i < a->tet_count; i++)
    for (int k = 0; k < 3; k++)
      assert_true(a->fields[1].values[3 * i + (size_t)k] == 1 + k + 3 * (int)(a->tet_origin[i] % 2));
  assert_true(mesh_volume6(mesh) == 3 * piece_count); /* 1 and 2 */
  assert_int_equal(cellist_mesh_get_facts(mesh)->boundary_face_count, 6 * piece_count);
}

static void check_variant(const struct variant *v) {
  cellist_context *context = harness_context(1);
  struct bytes bytes = make_file(v);
  cellist_mesh *mesh = read_bytes(context, "variant.vtu", &bytes);
  check_two_tets(mesh, v->piece_count);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
  bytes_free(&bytes);
}

TEST(every_coding_codec_header_and_byte_order_reads_alike)
{
  for (int coding = ASCII; coding <= BASE64; coding++)
    for (int codec = NONE; codec <= LZMA; codec++)
      for (int bits = 0; bits < 4; bits++) {
        const struct variant v = {.coding = (enum coding)coding,
                                  .codec = (enum codec)codec,
                                  .header_size = bits & 1 ? 8 : 4,
                                  .big_endian = (bits & 2) != 0,
                                  .id_type = "Int64",
                                  .id_size = 8,
                                  .real_type = bits & 1 ? "Float32" : "Float64",
                                  .real_size = bits & 1 ? 4 : 8,
                                  .piece_count = 1 + (bits & 1)};
        check_variant(&v);
      }
}

TEST(every_numeric_type_reads_alike)
{
  static const struct {
    const char *name;
    size_t size;
  } types[] = {{"Int8", 1},   {"UInt8", 1}, {"Int16", 2},  {"UInt16", 2},  {"Int32", 4},
               {"UInt32", 4}, {"Int64", 8}, {"UInt64", 8}, {"Float32", 4}, {"Float64", 8}};
  for (size_t t = 0; t < sizeof types / sizeof *types; t++)
    for (int big = 0; big < 2; big++) {
      struct variant v = {.coding = RAW,
                          .header_size = 8,
                          .big_endian = big != 0,
                          .id_type = "Int32",
                          .id_size = 4,
                          .real_type = "Float64",
                          .real_size = 8,
                          .piece_count = 1};
      if (t < 8) {
        v.id_type = types[t].name;
        v.id_size = types[t].size;
      } else {
        v.real_type = types[t].name;
        v.real_size = types[t].size;
      }
      check_variant(&v);
      if (t > 0) continue;
      v.real_type = "Int8"; /* points and values as bytes */
      v.real_size = 1;
      check_variant(&v);
    }
}

static cellist_result read_variant(cellist_context *context, void *user) {
  const struct bytes *bytes = user;
  cellist_mesh *mesh = NULL;
  const cellist_mesh_read_desc desc = {.merge = true};
  const cellist_result result = cellist_mesh_read_memory(context, "v.vtu", bytes->data, bytes->size, &desc, &mesh);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(every_failed_allocation_is_reported_and_leaks_nothing)
{
  for (int codec = NONE; codec <= LZMA; codec++) {
    const struct variant v = {.coding = codec == LZ4 ? INLINE : RAW,
                              .codec = (enum codec)codec,
                              .header_size = 4,
                              .id_type = "Int64",
                              .id_size = 8,
                              .real_type = "Float64",
                              .real_size = 8,
                              .piece_count = 2};
    struct bytes bytes = make_file(&v);
    check_allocation_failures(read_variant, &bytes);
    bytes_free(&bytes);
  }
}

TEST(a_cut_file_is_an_error_at_every_length)
{
  const struct variant v = {.coding = RAW,
                            .codec = ZLIB,
                            .header_size = 8,
                            .id_type = "Int64",
                            .id_size = 8,
                            .real_type = "Float64",
                            .real_size = 8,
                            .piece_count = 1};
  struct bytes bytes = make_file(&v);
  cellist_context *context = harness_context(1);
  /* What is cut off at the end is 32 bytes of closing tags, which nobody needs. */
  for (size_t size = 1; size + 32 < bytes.size; size++) {
    cellist_mesh *mesh = NULL;
    uint8_t *exact = malloc(size); /* reading beyond it shows */
    memcpy(exact, bytes.data, size);
    const cellist_result result = cellist_mesh_read_memory(context, "cut.vtu", exact, size, NULL, &mesh);
    if (result != CELLIST_ERROR_FORMAT) fail_msg("%zu bytes: %s", size, cellist_result_string(result));
    assert_non_null(strstr(cellist_context_take_error(context), "cut.vtu: "));
    free(exact);
  }
  harness_context_destroy(context);
  bytes_free(&bytes);
}

/* A file of one tet with pieces of it replaced. */
static void assert_refused(const char *from, const char *to, cellist_result expected, const char *part) {
  static const char file[] =
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points>"
      "<DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>"
      "<DataArray type=\"Int64\" Name=\"connectivity\">0 1 2 3</DataArray>"
      "<DataArray type=\"Int64\" Name=\"offsets\">4</DataArray>"
      "<DataArray type=\"UInt8\" Name=\"types\">10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
  char changed[4096];
  const char *at = strstr(file, from);
  assert_non_null(at);
  snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - file), file, to, at + strlen(from));
  cellist_context *context = harness_context(1);
  if (expected == CELLIST_SUCCESS)
    cellist_mesh_destroy(read_text(context, "one.vtu", changed));
  else
    assert_unreadable(context, "one.vtu", changed, expected, part);
  harness_context_destroy(context);
}

TEST(lies_are_named)
{
  const cellist_result format = CELLIST_ERROR_FORMAT;
  assert_refused("0 1 2 3<", "0 1 2 3<", CELLIST_SUCCESS, "");
  assert_refused("0 1 2 3<", "0 1 2 4<", format, "one.vtu: cell 0 uses point 4, but there are only 4 points");
  assert_refused("0 1 2 3<", "0 1 2 -3<", format, "array 'connectivity': value 3");
  assert_refused("0 1 2 3<", "0 1 2<", format, "array 'connectivity': has fewer numbers");
  assert_refused("0 1 2 3<", "0 1 2 3 4<", format, "array 'connectivity': has more numbers");
  assert_refused("0 1 2 3<", "0 1 2 3.5<", format, "array 'connectivity': value 3");
  assert_refused("NumberOfPoints=\"4\"", "NumberOfPoints=\"-4\"", format, "NumberOfPoints");
  assert_refused("NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000000000\"", CELLIST_ERROR_UNSUPPORTED, "points");
  assert_refused("NumberOfPoints=\"4\"", "NumberOfPoints=\"99999999\"", format, "fewer numbers");
  assert_refused("NumberOfCells=\"1\"", "NumberOfCells=\"999999999999\"", format, "fewer numbers");
  assert_refused("\"offsets\">4", "\"offsets\">3", format, "connectivity");
  assert_refused("\"offsets\">4", "\"offsets\">-1", format, "lies before its begin");
  assert_refused("\"types\">10", "\"types\">41", CELLIST_ERROR_UNSUPPORTED, "cell 0 is of VTK's type 41");
  assert_refused("\"types\">10", "\"types\">12", format, "cell 0 of VTK's type 12 has 4 points instead of 8");
  assert_refused("<Cells>", "<Cell>", format, "XML");
  assert_refused("<VTKFile ", "<!DOCTYPE a [<!ENTITY b \"c\">]><VTKFile ", format, "document type");
  assert_refused("\"UnstructuredGrid\">", "\"ImageData\">", CELLIST_ERROR_UNSUPPORTED, "of type ImageData");
  assert_refused("\"UnstructuredGrid\">", "\"UnstructuredGrid\" compressor=\"x\">", CELLIST_ERROR_UNSUPPORTED, "'x'");
  assert_refused("\"types\">", "\"types\" format=\"appended\" offset=\"0\">", format, "no appended data");
  assert_refused("\"types\">10", "\"types\" format=\"binary\">AQAAAAoAAAA=", CELLIST_SUCCESS, "");
  assert_refused("\"types\">10", "\"types\" format=\"binary\">/////woAAAA=", format, "beyond the end");
}

TEST(deep_and_long_xml_is_refused)
{
  cellist_context *context = harness_context(1);
  struct bytes bytes = {0};
  bytes_text(&bytes, "<VTKFile type=\"UnstructuredGrid\">");
  for (int i = 0; i < 100000; i++) bytes_text(&bytes, "<a>");
  cellist_mesh *mesh = NULL;
  assert_failure(context, cellist_mesh_read_memory(context, "deep", bytes.data, bytes.size, NULL, &mesh),
                 CELLIST_ERROR_FORMAT, "nest deeper than");
  bytes.size = 0;
  bytes_text(&bytes, "<VTKFile type=\"");
  for (int i = 0; i < 1 << 18; i++) bytes_text(&bytes, "aaaaaaaa");
  assert_failure(context, cellist_mesh_read_memory(context, "long", bytes.data, bytes.size, NULL, &mesh),
                 CELLIST_ERROR_FORMAT, "a tag is longer");
  bytes_free(&bytes);
  harness_context_destroy(context);
}

TEST(ghost_cells_and_lower_dimensions_are_left_out_and_counted)
{
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = read_text(
      context, "ghost.vtu",
      "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"6\" NumberOfCells=\"5\"><CellData>"
      "<DataArray type=\"UInt8\" Name=\"vtkGhostType\">0 0 1 32 0</DataArray>"
      "<DataArray type=\"Float32\" Name=\"c\">10 11 12 13 14</DataArray></CellData><Points>"
      "<DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1 nan 0 0</DataArray></Points>"
      "<Cells><DataArray type=\"Int64\" Name=\"connectivity\">0 1 2 0 1 2 3 0 1 2 4 1 2 3 4 0 1 2 5</DataArray>"
      "<DataArray type=\"Int64\" Name=\"offsets\">3 7 11 15 19</DataArray>"
      "<DataArray type=\"UInt8\" Name=\"types\">5 10 10 10 "
      "10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>");
  const cellist_mesh_facts *facts = cellist_mesh_get_facts(mesh);
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  assert_int_equal(facts->file_cell_count, 5);
  assert_int_equal(facts->skipped_cell_count, 1);
  assert_int_equal(facts->hidden_cell_count, 2);
  assert_int_equal(facts->infinite_cell_count, 1);
  assert_int_equal(a->tet_count, 1);
  assert_int_equal(a->tet_origin[0], 1);
  assert_true(a->fields[0].values[0] == 11);
  assert_int_equal(a->field_count, 1);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}

static void write_file(const char *path, const struct bytes *bytes) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes->data, 1, bytes->size, file), bytes->size);
  assert_int_equal(fclose(file), 0);
}

static cellist_result read_path(cellist_context *context, void *user) {
  cellist_mesh *mesh = NULL;
  const cellist_result result = cellist_mesh_read(context, user, NULL, &mesh);
  cellist_mesh_destroy(mesh);
  return result;
}

TEST(a_parallel_file_joins_its_pieces)
{
  char folder[64], piece[96], parallel[96], text[256];
  snprintf(folder, sizeof folder, "pvtu_%ld", (long)getpid());
  snprintf(piece, sizeof piece, "%s.vtu", folder);
  snprintf(parallel, sizeof parallel, "%s.pvtu", folder);
  const struct variant v = {.coding = RAW,
                            .codec = LZ4,
                            .header_size = 8,
                            .id_type = "Int64",
                            .id_size = 8,
                            .real_type = "Float32",
                            .real_size = 4,
                            .piece_count = 2};
  struct bytes bytes = make_file(&v);
  write_file(piece, &bytes);
  bytes.size = 0;
  snprintf(
      text, sizeof text,
      "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid><Piece Source=\"%s\"/></PUnstructuredGrid></VTKFile>",
      piece);
  bytes_text(&bytes, text);
  write_file(parallel, &bytes);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = NULL;
  assert_success(context, cellist_mesh_read(context, parallel, NULL, &mesh));
  check_two_tets(mesh, 2);
  cellist_mesh_destroy(mesh);
  assert_failure(context, cellist_mesh_read_memory(context, "m.pvtu", bytes.data, bytes.size, NULL, &mesh),
                 CELLIST_ERROR_UNSUPPORTED, "m.pvtu: names other files");
  check_allocation_failures(read_path, parallel);
  remove(piece);
  assert_failure(context, cellist_mesh_read(context, parallel, NULL, &mesh), CELLIST_ERROR_IO, "cannot be opened");
  remove(parallel);
  harness_context_destroy(context);
  bytes_free(&bytes);
}

TEST(structured_pieces_fit_together)
{
  static const char file[] =
      "<VTKFile type=\"StructuredGrid\"><StructuredGrid WholeExtent=\"0 2 0 1 0 1\"><Piece Extent=\"0 1 0 1 0 1\">"
      "<PointData><DataArray type=\"Int8\" Name=\"x\">0 1 0 1 0 1 0 1</DataArray></PointData><CellData>"
      "<DataArray type=\"Int8\" Name=\"c\">7</DataArray></CellData><Points><DataArray type=\"Float32\" "
      "NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1</DataArray></Points></Piece>"
      "<Piece Extent=\"1 2 0 1 0 1\"><PointData><DataArray type=\"Int8\" Name=\"x\">1 2 1 2 1 2 1 2</DataArray>"
      "</PointData><CellData><DataArray type=\"Int8\" Name=\"c\">8</DataArray></CellData><Points><DataArray "
      "type=\"Float32\" NumberOfComponents=\"3\">1 0 0 2 0 0 1 1 0 2 1 0 1 0 1 2 0 1 1 1 1 2 1 1</DataArray></Points>"
      "</Piece></StructuredGrid></VTKFile>";
  struct bytes bytes = {0};
  bytes_text(&bytes, file);
  check_allocation_failures(read_variant, &bytes);
  bytes_free(&bytes);
  cellist_context *context = harness_context(1);
  cellist_mesh *mesh = read_text(context, "two.vts", file);
  const cellist_mesh_arrays *a = cellist_mesh_get_arrays(mesh);
  assert_int_equal(a->point_count, 12);
  assert_int_equal(a->tet_count, 12);
  assert_true(mesh_volume6(mesh) == 12);
  assert_int_equal(cellist_mesh_get_facts(mesh)->boundary_face_count, 20); /* ten squares */
  assert_int_equal(cellist_mesh_get_facts(mesh)->inverted_count, 0);
  for (size_t i = 0; i < a->point_count; i++) assert_true(a->fields[0].values[i] == a->positions[3 * i]);
  for (size_t i = 0; i < a->tet_count; i++) assert_true(a->fields[1].values[i] == 7 + a->tet_origin[i]);
  cellist_mesh_destroy(mesh);
  harness_context_destroy(context);
}
