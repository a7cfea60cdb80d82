/* SPDX-License-Identifier: BSD-3-Clause
 * Gmsh: what its files share. Private to data/. */
#ifndef CELLIST_FORMATS_GMSH_H
#define CELLIST_FORMATS_GMSH_H

#include "text.h"

/* Nodes and elements have numbers of their own, "tags", in any order and with gaps. */
struct gmsh_tags {
  size_t count, capacity;
  uint64_t *tags;    /* in the file's order, then sorted */
  uint32_t *indices; /* of the tags */
};

struct gmsh {
  cellist_context *context;
  const struct source *source;
  struct text text;
  bool is_binary, swap, is_version_4;
  struct grid *grid;
  struct gmsh_tags nodes, elements;
  size_t cell_capacity, corner_count, corner_capacity;
  size_t file_cell_count;
};

/* FORMAT with the line, or the byte of a binary file. */
cellist_result gmsh_fail(struct gmsh *gmsh, const char *format, ...) CELLIST_PRINTF(2, 3);

/* The next number: text, or size bytes (4 or 8) of an integer; 8 of a double. False if there is none. */
bool gmsh_next_integer(struct gmsh *gmsh, size_t size, int64_t *value);
bool gmsh_next_double(struct gmsh *gmsh, double *value);

/* A count of things of which each takes at least so many bytes of what is left. */
bool gmsh_next_count(struct gmsh *gmsh, size_t size, size_t text_bytes, size_t binary_bytes, size_t *count);

cellist_result gmsh_tags_add(struct gmsh *gmsh, struct gmsh_tags *tags, int64_t tag, size_t expected);
/* Sorts; false in *are_unique if two are equal. */
cellist_result gmsh_tags_sort(struct gmsh *gmsh, struct gmsh_tags *tags, bool *are_unique);
/* The index, or CELLIST_NONE. */
uint32_t gmsh_tags_find(const struct gmsh_tags *tags, int64_t tag);

/* gmsh_mesh.c: $Nodes and $Elements; the section's name has been read. */
cellist_result gmsh_read_nodes(struct gmsh *gmsh);
cellist_result gmsh_read_elements(struct gmsh *gmsh);
/* gmsh_mesh.c: after both: tags become ids. */
cellist_result gmsh_link(struct gmsh *gmsh);

#endif
