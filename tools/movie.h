/* SPDX-License-Identifier: BSD-3-Clause
 * Movie: the cutting of a mesh's exterior as numbered pictures. */
#ifndef CELLIST_TOOLS_MOVIE_H
#define CELLIST_TOOLS_MOVIE_H

#include <cellist/complex.h>

/* Writes directory/0000.png (the mesh alone), 0001.png and so on (with ever more imaginary cells), 61 at most; the
 * directory is made if it is not there. *pictures: how many were written, also on failure. Errors: IO, OUT_OF_MEMORY,
 * CANCELLED. */
cellist_result movie_write(cellist_context *context, const cellist_mesh *mesh, const cellist_complex *complex,
                           const char *directory, size_t *pictures);

#endif
