/* SPDX-License-Identifier: BSD-3-Clause
 * XML: the frame of a VTK XML file by expat; inline data are only located, appended data never parsed.
 *
 * Hostile input: document types (and with them entities) are refused, elements nest at most DEPTH_LIMIT deep, a tag is
 * at most two portions long. Expat's memory is the context's. Its allocation functions take no user pointer, so the
 * context of the running parse stands in a thread-local variable; nothing else does. */
#include "xml.h"

#include <expat.h>
#include <stdlib.h>
#include <string.h>

/* VTK's own files nest 6 deep; every level costs expat memory. */
enum { DEPTH_LIMIT = 32 };
/* Bytes given to expat at once. A tag longer than two portions is refused: expat scans an unfinished tag again with
 * every portion. */
enum { PORTION = 1 << 18 };

struct reader {
  cellist_context *context;
  const struct source *source;
  struct xml_document *document;
  XML_Parser parser;
  cellist_result result;
  int depth;
  bool in_array, stopped;
  enum xml_section section; /* XML_SECTION_COUNT: outside */
  size_t array_capacity, piece_capacity;
  size_t markup_end; /* the byte after the last tag */
};

static _Thread_local cellist_context *parsing;

/* Blocks carry their size in front, because reallocating needs it; 64 bytes keep the alignment. */
enum { SIZE_PREFIX = 64 };

static void *expat_allocate(size_t size) {
  if (size > SIZE_MAX - SIZE_PREFIX) return NULL;
  char *block = cellist_allocate(parsing, size + SIZE_PREFIX, 1);
  if (block == NULL) return NULL;
  memcpy(block, &size, sizeof size);
  return block + SIZE_PREFIX;
}

static void expat_deallocate(void *block) {
  if (block != NULL) cellist_deallocate(parsing, (char *)block - SIZE_PREFIX);
}

static void *expat_reallocate(void *block, size_t size) {
  if (block == NULL) return expat_allocate(size);
  size_t old_size;
  memcpy(&old_size, (char *)block - SIZE_PREFIX, sizeof old_size);
  void *moved = expat_allocate(size);
  if (moved == NULL) return NULL;
  memcpy(moved, block, old_size < size ? old_size : size);
  expat_deallocate(block);
  return moved;
}

static void stop(struct reader *reader, cellist_result result) {
  if (reader->result == CELLIST_SUCCESS) reader->result = result;
  XML_StopParser(reader->parser, XML_FALSE);
}

static size_t position(const struct reader *reader) { return (size_t)XML_GetCurrentByteIndex(reader->parser); }

#define FAIL(reader, ...) \
  stop(reader, source_fail_at((reader)->context, (reader)->source, position(reader), __VA_ARGS__))

static const char *attribute(const char **attributes, const char *name) {
  for (; attributes[0] != NULL; attributes += 2)
    if (strcmp(attributes[0], name) == 0) return attributes[1];
  return NULL;
}

/* A decimal number that fits; false otherwise. *after: what follows it. */
static bool parse_integer(const char *text, int64_t *value, const char **after) {
  while (*text == ' ' || *text == '\n' || *text == '\t') text++;
  char *end = NULL;
  const long long parsed = strtoll(text, &end, 10);
  if (end == text || parsed < INT64_MIN / 4 || parsed > INT64_MAX / 4) return false;
  *value = parsed;
  *after = end;
  return true;
}

static bool parse_count(const char *text, uint64_t *value) {
  int64_t parsed = 0;
  const char *after = NULL;
  if (text == NULL || !parse_integer(text, &parsed, &after) || parsed < 0) return false;
  while (*after == ' ' || *after == '\n' || *after == '\t') after++;
  *value = (uint64_t)parsed;
  return *after == '\0';
}

static bool parse_extent(const char *text, int64_t extent[6]) {
  for (int i = 0; i < 6; i++)
    if (text == NULL || !parse_integer(text, &extent[i], &text) || extent[i] > INT32_MAX || extent[i] < INT32_MIN)
      return false;
  for (int i = 0; i < 6; i += 2)
    if (extent[i + 1] < extent[i]) return false;
  return true;
}

static char *copy_string(cellist_context *context, const char *text) {
  char *copy = cellist_allocate(context, strlen(text) + 1, 1);
  if (copy != NULL) memcpy(copy, text, strlen(text) + 1);
  return copy;
}

/* Room for one more in a growing array; false when there is none. */
static bool reserve(struct reader *reader, void **array, size_t count, size_t *capacity, size_t size) {
  if (count < *capacity) return true;
  const size_t wanted = *capacity > 0 ? 2 * *capacity : 16;
  void *grown = cellist_reallocate(reader->context, *array, count, wanted, size);
  if (grown == NULL) {
    stop(reader, CELLIST_ERROR_OUT_OF_MEMORY);
    return false;
  }
  *array = grown;
  *capacity = wanted;
  return true;
}

static void start_file(struct reader *reader, const char **attributes) {
  struct xml_document *document = reader->document;
  const char *type = attribute(attributes, "type"), *order = attribute(attributes, "byte_order");
  const char *header = attribute(attributes, "header_type"), *compressor = attribute(attributes, "compressor");
  if (type == NULL) type = "(none)";
  if (strcmp(type, "UnstructuredGrid") == 0) document->kind = XML_UNSTRUCTURED;
  if (strcmp(type, "StructuredGrid") == 0) document->kind = XML_STRUCTURED;
  if (strcmp(type, "PUnstructuredGrid") == 0) document->kind = XML_PARALLEL_UNSTRUCTURED;
  if (document->kind == XML_NO_MESH) {
    stop(reader,
         cellist_fail(reader->context, CELLIST_ERROR_UNSUPPORTED,
                      "%s: is a VTK file of type %.64s; only UnstructuredGrid, PUnstructuredGrid and StructuredGrid "
                      "hold meshes",
                      reader->source->name, type));
    return;
  }
  const bool is_little = order == NULL || strcmp(order, "LittleEndian") == 0;
  if (!is_little && strcmp(order, "BigEndian") != 0) FAIL(reader, "byte_order is '%.32s'", order);
  document->swap = is_little != element_machine_is_little();
  document->header_size = 4;
  if (header != NULL && strcmp(header, "UInt64") == 0)
    document->header_size = 8;
  else if (header != NULL && strcmp(header, "UInt32") != 0)
    FAIL(reader, "header_type is '%.32s', not UInt32 or UInt64", header);
  static const char *const names[] = {"", "vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor"};
  if (compressor == NULL) return;
  for (int kind = CODEC_NONE; kind <= CODEC_LZMA; kind++) {
    document->codec = (enum codec_kind)kind;
    if (strcmp(compressor, names[kind]) == 0) return;
  }
  stop(reader, cellist_fail(reader->context, CELLIST_ERROR_UNSUPPORTED, "%s: compressor '%.64s' is not known",
                            reader->source->name, compressor));
}

static void start_piece(struct reader *reader, const char **attributes) {
  struct xml_document *document = reader->document;
  if (!reserve(reader, (void **)&document->pieces, document->piece_count, &reader->piece_capacity,
               sizeof *document->pieces))
    return;
  struct xml_piece piece = {.first_array = document->array_count};
  if (document->kind == XML_UNSTRUCTURED &&
      (!parse_count(attribute(attributes, "NumberOfPoints"), &piece.point_count) ||
       !parse_count(attribute(attributes, "NumberOfCells"), &piece.cell_count))) {
    FAIL(reader, "a piece's NumberOfPoints or NumberOfCells is missing or no count");
    return;
  }
  if (document->kind == XML_STRUCTURED && !parse_extent(attribute(attributes, "Extent"), piece.extent)) {
    FAIL(reader, "a piece's Extent is missing or not six ordered numbers");
    return;
  }
  if (document->kind == XML_PARALLEL_UNSTRUCTURED) {
    const char *file = attribute(attributes, "Source");
    if (file == NULL || file[0] == '\0') {
      FAIL(reader, "a piece has no Source");
      return;
    }
    piece.file = copy_string(reader->context, file);
    if (piece.file == NULL) {
      stop(reader, CELLIST_ERROR_OUT_OF_MEMORY);
      return;
    }
  }
  document->pieces[document->piece_count++] = piece;
}

static bool parse_type(const char *text, enum element_type *type) {
  static const char *const names[] = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                      "UInt32", "Int64", "UInt64", "Float32", "Float64"};
  for (int i = ELEMENT_INT8; i <= ELEMENT_FLOAT64; i++)
    if (strcmp(text, names[i]) == 0) {
      *type = (enum element_type)i;
      return true;
    }
  *type = ELEMENT_UINT8;
  return false;
}

static void start_array(struct reader *reader, const char **attributes) {
  struct xml_document *document = reader->document;
  /* Of several time steps the first one is read. */
  const char *step = attribute(attributes, "TimeStep");
  if (step != NULL && strcmp(step, "0") != 0) return;
  if (reader->section == XML_SECTION_COUNT || document->piece_count == 0) return;
  if (!reserve(reader, (void **)&document->arrays, document->array_count, &reader->array_capacity,
               sizeof *document->arrays))
    return;
  struct xml_array array = {.section = reader->section, .component_count = 1};
  const char *type = attribute(attributes, "type"), *name = attribute(attributes, "Name");
  const char *format = attribute(attributes, "format"), *offset = attribute(attributes, "offset");
  const char *components = attribute(attributes, "NumberOfComponents");
  array.has_numbers = type != NULL && parse_type(type, &array.type);
  array.format = format == NULL || strcmp(format, "ascii") == 0 ? XML_ASCII
                 : strcmp(format, "binary") == 0                ? XML_INLINE
                                                                : XML_APPENDED;
  if (array.format == XML_APPENDED && strcmp(format, "appended") != 0)
    FAIL(reader, "an array's format is '%.32s'", format);
  if (array.format == XML_APPENDED && !parse_count(offset, &array.offset))
    FAIL(reader, "an appended array's offset is missing or no count");
  uint64_t count = 1;
  if (components != NULL && components[0] != '\0' && (!parse_count(components, &count) || count > UINT16_MAX))
    FAIL(reader, "an array's NumberOfComponents is '%.32s'", components);
  array.component_count = count > 0 ? (uint32_t)count : 1;
  if (reader->result != CELLIST_SUCCESS) return;
  array.name = copy_string(reader->context, name != NULL ? name : "");
  if (array.name == NULL) {
    stop(reader, CELLIST_ERROR_OUT_OF_MEMORY);
    return;
  }
  document->arrays[document->array_count++] = array;
  reader->in_array = true;
}

static void start_appended(struct reader *reader, const char **attributes) {
  struct xml_document *document = reader->document;
  const char *encoding = attribute(attributes, "encoding");
  document->appended_is_base64 = encoding == NULL || strcmp(encoding, "base64") == 0;
  if (!document->appended_is_base64 && strcmp(encoding, "raw") != 0) {
    FAIL(reader, "the appended data's encoding is '%.32s', not raw or base64", encoding);
    return;
  }
  size_t at = reader->markup_end;
  const uint8_t *bytes = reader->source->bytes;
  while (at < reader->source->size && (bytes[at] == ' ' || (bytes[at] >= '\t' && bytes[at] <= '\r'))) at++;
  if (at == reader->source->size || bytes[at] != '_') {
    FAIL(reader, "no underscore begins the appended data");
    return;
  }
  document->has_appended = true;
  document->appended = at + 1;
  reader->stopped = true;
  XML_StopParser(reader->parser, XML_FALSE);
}

static void on_start(void *user, const char *name, const char **attributes) {
  static const char *const sections[] = {"PointData", "CellData", "Points", "Cells"};
  struct reader *reader = user;
  struct xml_document *document = reader->document;
  if (reader->result != CELLIST_SUCCESS || reader->stopped) return; /* what is left of the tag that failed */
  reader->markup_end = position(reader) + (size_t)XML_GetCurrentByteCount(reader->parser);
  if (reader->depth++ == DEPTH_LIMIT) {
    FAIL(reader, "elements nest deeper than %d", DEPTH_LIMIT);
  } else if (reader->depth == 1) {
    if (strcmp(name, "VTKFile") == 0)
      start_file(reader, attributes);
    else
      FAIL(reader, "the first element is '%.64s', not VTKFile", name);
  } else if (reader->in_array) {
    return; /* an InformationKey: stands before the data */
  } else if (reader->depth == 2 && strcmp(name, "AppendedData") == 0) {
    start_appended(reader, attributes);
  } else if (reader->depth == 2) {
    const char *whole = attribute(attributes, "WholeExtent");
    if (document->kind == XML_STRUCTURED && !parse_extent(whole, document->whole_extent))
      FAIL(reader, "WholeExtent is missing or not six ordered numbers");
  } else if (reader->depth == 3 && strcmp(name, "Piece") == 0) {
    start_piece(reader, attributes);
  } else if (reader->depth == 4) {
    for (int i = 0; i < XML_SECTION_COUNT; i++)
      if (strcmp(name, sections[i]) == 0) reader->section = (enum xml_section)i;
  } else if (reader->depth == 5 && strcmp(name, "DataArray") == 0) {
    start_array(reader, attributes);
  }
}

static void on_end(void *user, const char *name) {
  struct reader *reader = user;
  (void)name;
  struct xml_document *document = reader->document;
  if (reader->result != CELLIST_SUCCESS || reader->stopped) return;
  if (reader->depth == 4) reader->section = XML_SECTION_COUNT;
  if (reader->depth == 5 && reader->in_array) {
    struct xml_array *array = &document->arrays[document->array_count - 1];
    array->end = position(reader);
    array->begin = reader->markup_end < array->end ? reader->markup_end : array->end;
    reader->in_array = false;
  }
  reader->markup_end = position(reader) + (size_t)XML_GetCurrentByteCount(reader->parser);
  reader->depth--;
}

static void on_document_type(void *user, const char *name, const char *system, const char *public, int has_subset) {
  struct reader *reader = user;
  (void)name, (void)system, (void)public, (void)has_subset;
  FAIL(reader, "has a document type; VTK files have none");
}

static void feed(struct reader *reader) {
  const struct source *source = reader->source;
  size_t fed = 0;
  do {
    const size_t part = source->size - fed < PORTION ? source->size - fed : PORTION;
    const bool is_last = fed + part == source->size;
    const enum XML_Status status = XML_Parse(reader->parser, (const char *)source->bytes + fed, (int)part, is_last);
    fed += part;
    if (reader->stopped || reader->result != CELLIST_SUCCESS) return;
    if (status != XML_STATUS_OK) {
      const enum XML_Error error = XML_GetErrorCode(reader->parser);
      if (error == XML_ERROR_NO_MEMORY)
        reader->result = cellist_fail(reader->context, CELLIST_ERROR_OUT_OF_MEMORY, "%s: out of memory", source->name);
      else
        reader->result = source_fail_at(reader->context, source, position(reader), "XML: %s", XML_ErrorString(error));
      return;
    }
    if (!is_last && fed > position(reader) + 2 * (size_t)PORTION) {
      reader->result =
          source_fail_at(reader->context, source, position(reader), "a tag is longer than %d bytes", PORTION);
      return;
    }
  } while (fed < source->size);
}

cellist_result xml_read(cellist_context *context, const struct source *source, struct xml_document *document) {
  static const XML_Memory_Handling_Suite suite = {expat_allocate, expat_reallocate, expat_deallocate};
  *document = (struct xml_document){.budget = source->size};
  struct reader reader = {.context = context, .source = source, .document = document, .section = XML_SECTION_COUNT};
  parsing = context;
  reader.parser = XML_ParserCreate_MM(NULL, &suite, NULL);
  if (reader.parser == NULL) {
    parsing = NULL;
    return cellist_fail(context, CELLIST_ERROR_OUT_OF_MEMORY, "%s: out of memory", source->name);
  }
  XML_SetUserData(reader.parser, &reader);
  XML_SetElementHandler(reader.parser, on_start, on_end);
  XML_SetStartDoctypeDeclHandler(reader.parser, on_document_type);
  feed(&reader);
  XML_ParserFree(reader.parser);
  parsing = NULL;
  if (reader.result == CELLIST_SUCCESS && document->piece_count == 0)
    reader.result = source_fail(context, source, "holds no piece of a mesh");
  if (reader.result != CELLIST_SUCCESS) xml_release(context, document);
  return reader.result;
}

void xml_release(cellist_context *context, struct xml_document *document) {
  for (size_t i = 0; i < document->array_count; i++) cellist_deallocate(context, document->arrays[i].name);
  for (size_t i = 0; i < document->piece_count; i++) cellist_deallocate(context, document->pieces[i].file);
  cellist_deallocate(context, document->arrays);
  cellist_deallocate(context, document->pieces);
  *document = (struct xml_document){0};
}

size_t xml_first_array(const struct xml_document *document, size_t piece, size_t *end) {
  *end = piece + 1 < document->piece_count ? document->pieces[piece + 1].first_array : document->array_count;
  return document->pieces[piece].first_array;
}

const struct xml_array *xml_find(const struct xml_document *document, size_t piece, enum xml_section section,
                                 const char *name) {
  size_t end = 0;
  for (size_t i = xml_first_array(document, piece, &end); i < end; i++) {
    const struct xml_array *array = &document->arrays[i];
    if (array->section == section && (name == NULL || strcmp(array->name, name) == 0)) return array;
  }
  return NULL;
}

cellist_result read_vtk_xml(cellist_context *context, const struct source *source, struct grid *grid) {
  struct xml_document document;
  *grid = (struct grid){0};
  cellist_result result = xml_read(context, source, &document);
  if (result != CELLIST_SUCCESS) return result;
  if (document.kind == XML_UNSTRUCTURED) result = read_vtu(context, source, &document, grid);
  if (document.kind == XML_STRUCTURED) result = read_vts(context, source, &document, grid);
  if (document.kind == XML_PARALLEL_UNSTRUCTURED) result = read_pvtu(context, source, &document, grid);
  xml_release(context, &document);
  if (result != CELLIST_SUCCESS) grid_release(context, grid);
  return result;
}
