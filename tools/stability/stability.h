/* SPDX-License-Identifier: BSD-3-Clause
 * Stability: a table of stiff and extreme scenes, each with what must happen, and the runner that judges every
 * renderer, the order and the convexifier by it. The tests and the report run the same table. Internal: not installed.
 *
 * A case passes if nothing is NaN, the picture lies within the case's limit of the double-precision reference caster
 * and the order has no inversion along rays. tests/stability judges the reference in turn, by quadrature in 80 bits and
 * by scaled copies of the scenes. */
#ifndef CELLIST_TOOLS_STABILITY_H
#define CELLIST_TOOLS_STABILITY_H

#include <cellist/generate.h>
#include <cellist/mesh.h>
#include <cellist/optics.h>
#include <cellist/pipeline.h>
#include <cellist/transfer.h>
#include <cellist/view.h>

enum { STABILITY_KNOTS = 80, STABILITY_ISOS = 4 };

/* One case, built. */
typedef struct stability_scene {
  cellist_context *context;
  cellist_result result;
  size_t point_count, point_capacity, tet_count, tet_capacity;
  double *points; /* x y z scalar */
  uint32_t *tets;
  bool on_cells; /* a cell's scalar is the mean of its corners' */
  cellist_mesh *mesh;
  cellist_transfer_knot knots[STABILITY_KNOTS];
  cellist_isosurface isos[STABILITY_ISOS];
  cellist_transfer transfer; /* of the knots above */
  cellist_optics optics;
  cellist_view view;
  uint32_t width, height;
} stability_scene;

typedef enum stability_group { STABILITY_STIFF, STABILITY_SHAPE, STABILITY_FRAME, STABILITY_VIEW } stability_group;

/* What a picture must be. */
typedef enum stability_expectation {
  STABILITY_PICTURE, /* the reference's, within the limit */
  STABILITY_FINITE,  /* cells overlap: no picture is right; a finite one, and the overlap is reported */
  STABILITY_EMPTY    /* nothing is to be seen: all zero */
} stability_expectation;

typedef enum stability_renderer {
  STABILITY_CAST,
  STABILITY_SOFT,
  STABILITY_FACES,
  STABILITY_FAN,
  STABILITY_RENDERER_COUNT
} stability_renderer;

/* Why a case is not held to the usual limit, or does not pass. */
typedef struct stability_excuse {
  const char *why;
  const char *listed; /* words of README's limits that list it */
} stability_excuse;

typedef struct stability_case {
  const char *name;
  stability_group group;
  const char *exercises, *must;
  void (*build)(stability_scene *scene, double parameter);
  double parameter;
  stability_expectation expectation;
  /* Largest difference to the reference, in parts of the picture's largest value, and why it is not smaller. 0: the
   * usual limit, see STABILITY_LIMIT. */
  double limit;
  const stability_excuse *reason;
  /* Pixels that may be further off, and why. */
  size_t strays;
  const stability_excuse *stray_reason;
  /* Does not pass, and why. By renderer; NULL: passes. */
  const stability_excuse *fails[STABILITY_RENDERER_COUNT];
} stability_case;

/* What single precision leaves of a picture whose cells are not extreme: some ten roundings of 6e-8 a cell, and a few
 * cells thick. Smaller, and rounding alone would fail cases; larger, and a wrong cell at a silhouette would pass. */
extern const double STABILITY_LIMIT;
/* Of `fan`, at the edges of its triangles. */
extern const double STABILITY_FAN_LIMIT;
extern const stability_excuse STABILITY_FAN_EXCUSE;

/* Case i, or NULL from the last one on. Threads: any. */
const stability_case *stability_case_at(size_t i);

/* "stiff", "shape", "frame", "view"; "cast", "soft", "faces", "fan". Threads: any. */
const char *stability_group_name(stability_group group);
const char *stability_renderer_name(stability_renderer renderer);

/* Builds a case's scene, to be given to stability_scene_release. Errors: as making the mesh; OUT_OF_MEMORY. */
cellist_result stability_build(cellist_context *context, const stability_case *which, stability_scene *scene);
void stability_scene_release(stability_scene *scene);

typedef enum stability_verdict {
  STABILITY_PASSES,
  STABILITY_KNOWN,   /* does not pass, and the table says why */
  STABILITY_REFUSED, /* the renderer or the convexifier says clearly that it does not do this */
  STABILITY_FAILS
} stability_verdict;

const char *stability_verdict_name(stability_verdict verdict);

/* How a picture compares with the reference. Errors are in parts of `peak`. */
typedef struct stability_picture {
  stability_verdict verdict;
  double rmse, max;     /* over pixels that either covers, R G B A */
  double peak;          /* the reference's largest value */
  size_t covered, over; /* pixels; those beyond the case's limit */
  double bound;         /* of the reference's own error, proved; infinity where none is known */
  double seconds, reference_seconds;
  char message[256]; /* why it does not pass, "" if it does */
} stability_picture;

/* Draws a scene by one renderer and judges it. Errors: OUT_OF_MEMORY and what the reference caster cannot do; a
 * renderer's own failure is a verdict. Threads: one call per context at a time. */
cellist_result stability_draw(cellist_context *context, const stability_case *which, const stability_scene *scene,
                              stability_renderer renderer, stability_picture *found);

/* How the order does along rays, see cellist_verification. */
typedef struct stability_order {
  stability_verdict verdict;
  size_t rays, pairs, inversions, group_pairs, overlaps;
  size_t groups, largest_group;
  size_t unsorted; /* cells that the order lacks */
  double seconds;
  char message[256];
} stability_order;

cellist_result stability_sort(cellist_context *context, const stability_case *which, const stability_scene *scene,
                              stability_order *found);

enum { STABILITY_EXTERIOR_COUNT = 4 };

/* What the convexifier makes of the mesh. */
typedef struct stability_exterior {
  stability_verdict verdict;
  size_t imaginary_cells;
  double volume_error, seconds;
  char message[256];
} stability_exterior;

/* exterior: 0..3, in the order of cellist_exterior. UNSUPPORTED in a build without the convexifier. */
cellist_result stability_convexify(cellist_context *context, const stability_scene *scene, unsigned exterior,
                                   stability_exterior *found);
const char *stability_exterior_name(unsigned exterior);

#endif
