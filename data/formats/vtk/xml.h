/* SPDX-License-Identifier: BSD-3-Clause
 * XML: what a VTK XML file says about itself, and where its arrays' data stand. Private to data/. */
#ifndef CELLIST_FORMATS_XML_H
#define CELLIST_FORMATS_XML_H

#include "../element.h"
#include "../source.h"
#include "codec.h"

enum xml_kind { XML_NO_MESH, XML_UNSTRUCTURED, XML_STRUCTURED, XML_PARALLEL_UNSTRUCTURED };
enum xml_section { XML_POINT_DATA, XML_CELL_DATA, XML_POINTS, XML_CELLS, XML_SECTION_COUNT };
enum xml_format { XML_ASCII, XML_INLINE, XML_APPENDED };

struct xml_array {
  char *name; /* "" if it has none */
  enum xml_section section;
  enum xml_format format;
  bool has_numbers; /* false: strings, bits: nothing that a mesh can use */
  enum element_type type;
  uint32_t component_count;
  uint64_t offset;   /* appended: from the byte after the underscore */
  size_t begin, end; /* the inline data's bytes in the file */
};

struct xml_piece {
  uint64_t point_count, cell_count;
  int64_t extent[6];
  size_t first_array; /* its arrays go up to the next piece's first */
  char *file;         /* of a parallel file's piece, or NULL */
};

struct xml_document {
  enum xml_kind kind;
  bool swap;
  size_t header_size; /* 4 or 8 bytes */
  enum codec_kind codec;
  bool has_appended, appended_is_base64;
  size_t appended; /* the byte after the underscore */
  int64_t whole_extent[6];
  size_t piece_count, array_count;
  struct xml_piece *pieces;
  struct xml_array *arrays;
  size_t budget; /* encoded bytes that arrays may still read: each byte of the file counts for one array only */
};

/* Errors: FORMAT (not XML, cut, no VTKFile, a document type, too deep), OUT_OF_MEMORY. */
cellist_result xml_read(cellist_context *context, const struct source *source, struct xml_document *document);
void xml_release(cellist_context *context, struct xml_document *document);

/* The piece's arrays: the first one's index, and the one after the last. */
size_t xml_first_array(const struct xml_document *document, size_t piece, size_t *end);

/* The array of a piece's section; name NULL: the first. NULL if there is none. */
const struct xml_array *xml_find(const struct xml_document *document, size_t piece, enum xml_section section,
                                 const char *name);

/* array.c: decodes a whole array. *count: values to expect, or SIZE_MAX: as many as there are, then told. *values is
 * the caller's. */
cellist_result xml_decode(cellist_context *context, const struct source *source, struct xml_document *document,
                          const struct xml_array *array, enum element_kind kind, size_t *count, void **values);

/* array.c: the point and cell data of one piece into the grid, whose counts are set; ghost arrays hide. */
cellist_result xml_read_fields(cellist_context *context, const struct source *source, struct xml_document *document,
                               size_t piece, struct grid *grid);

/* array.c: the coordinates of one piece with point_count points. */
cellist_result xml_read_points(cellist_context *context, const struct source *source, struct xml_document *document,
                               size_t piece, size_t point_count, double **points);

/* One for each kind. */
cellist_result read_vtu(cellist_context *context, const struct source *source, struct xml_document *document,
                        struct grid *grid);
cellist_result read_vts(cellist_context *context, const struct source *source, struct xml_document *document,
                        struct grid *grid);
cellist_result read_pvtu(cellist_context *context, const struct source *source, struct xml_document *document,
                         struct grid *grid);

/* Any of them. */
cellist_result read_vtk_xml(cellist_context *context, const struct source *source, struct grid *grid);

#endif
