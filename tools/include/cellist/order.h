/* SPDX-License-Identifier: BSD-3-Clause
 * Order: a sorter for a mesh, with the exterior that sorts it most cheaply, made once and kept in a file. */
#ifndef CELLIST_ORDER_H
#define CELLIST_ORDER_H

#include <cellist/complex.h>
#include <cellist/sort.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What fills the gaps of a concave mesh. The order is exact with each of them. */
typedef enum cellist_order_exterior {
  CELLIST_ORDER_AUTO, /* the one that makes sorting cheapest, by counted work over sample views */
  CELLIST_ORDER_NONE, /* nothing: cells with a gap between them are ordered by where their faces overlap */
  CELLIST_ORDER_HULL, /* as cellist_exterior: convex cells, made once */
  CELLIST_ORDER_BOX,
  CELLIST_ORDER_GRID,
  CELLIST_ORDER_DELAUNAY
} cellist_order_exterior;

/* Of cellist/convexify.h, which a build without convexifier lacks. */
struct cellist_convexify_desc;
struct cellist_convexify_stats;

/* {0} is valid: the best exterior, kept nowhere. */
typedef struct cellist_order_desc {
  cellist_order_exterior exterior;
  const struct cellist_convexify_desc *convexify; /* how exteriors are made; which one stands above. Read during the
                                                     call only; NULL: the defaults, with seed 1 */
  bool needs_complex;                             /* AUTO: not NONE, unless no exterior can be made */
  uint32_t pictures;           /* AUTO: how many there will be: too few for an exterior to pay get none, unless one is
                                  kept already; 0: many */
  const uint8_t *wanted;       /* as cellist_sorter_create_subset, read during the call only; NULL: all tets */
  const char *cache_directory; /* where complexes are kept (made if it is not there), or NULL; a place that cannot be
                                  written is a warning */
  const char *cache_file;      /* or the one file to keep this one in; what cannot be written then is an error */
} cellist_order_desc;

/* What an order is made with. */
typedef struct cellist_order_facts {
  const char *exterior; /* "none", "hull", "box", "grid", "delaunay" */
  char reason[224];     /* why this one; for AUTO with the work of each that was tried, plain sort = 1 */
  bool convex;          /* the mesh has no gaps */
  size_t imaginary_cells;
  double seconds; /* of making or reading the exterior, and of choosing */
  bool cached;    /* read from a file */
} cellist_order_facts;

typedef struct cellist_order cellist_order;

/* Makes an order for a mesh.
 * Arrays: the mesh is borrowed. desc may be NULL. *order is the caller's.
 * Errors: those of cellist_sorter_create; GEOMETRY (AUTO apart: a mesh that cannot be made convex; the message says
 *   why); UNSUPPORTED (an exterior in a build without convexifier); IO (cache_file); CANCELLED.
 * Threads: one call per context at a time. Cost: that of convexifying, up to three times for AUTO; of reading a file
 *   where one is there. */
CELLIST_API cellist_result cellist_order_create(cellist_context *context, const cellist_mesh *mesh,
                                                const cellist_order_desc *desc, cellist_order **order);

/* Frees the order and its sorter; NULL is legal. */
CELLIST_API void cellist_order_destroy(cellist_order *order);

/* The sorter, and what it is made with; they belong to the order. Threads: any. */
CELLIST_API cellist_sorter *cellist_order_sorter(const cellist_order *order);
CELLIST_API const cellist_order_facts *cellist_order_get_facts(const cellist_order *order);

/* The mesh made convex, and what that took; NULL if nothing fills the gaps. They belong to the order. Threads: any. */
CELLIST_API const cellist_complex *cellist_order_get_complex(const cellist_order *order);
CELLIST_API const struct cellist_convexify_stats *cellist_order_get_convexify_stats(const cellist_order *order);

#ifdef __cplusplus
}
#endif
#endif
