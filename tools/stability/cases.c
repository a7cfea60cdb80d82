/* SPDX-License-Identifier: BSD-3-Clause
 * Cases: the table. Each line says what a scene exercises and what must happen; how it is built stands in stiff.c,
 * shapes.c and views.c. */
#include "scene.h"

const double STABILITY_LIMIT = 2e-5;

#define SAME "the reference's picture"
#define CASE(which_group, which_name, what, happens, builder, value)                                          \
  .name = which_name, .group = STABILITY_##which_group, .exercises = what, .must = happens, .build = builder, \
  .parameter = value

/* Why a limit or a failure; README's words are checked by a test. */
#define EXCUSE(name, why, listed) static const stability_excuse name = {why, listed}
EXCUSE(SCALARS_IN_FLOATS, "scalars are kept to 6e-8 of their range: a narrow peak's width is off by that much",
       "`faces` and `fan` keep scalars in single precision");
EXCUSE(FLANKS_IN_FLOATS, "scalars are kept to 6e-8 of their range, which moves the flanks of peaks",
       "Peaks a thousandth of the scalar's range wide");
EXCUSE(DEPTHS_IN_FLOATS, "depths along the ray are kept to 6e-8 of the mesh's size: dense media show it",
       "keep depths along rays in single precision");
EXCUSE(LIGHT_BY_SAMPLES, "light by gradients at points is taken once a segment",
       "light by gradients at points is exact to second order");
EXCUSE(WIDE_VIEW, "rays at the edge run a hundred times farther across than deep", "a field of view of 179 degrees");

const double STABILITY_FAN_LIMIT = 5e-3;
const stability_excuse STABILITY_FAN_EXCUSE = {"OpenGL moves the corners of triangles",
                                               "`fan` errs where OpenGL moves a corner"};

static const stability_case CASES[] = {
    {CASE(STIFF, "depth-1e-12", "optical depth 1e-12 a cell", SAME, build_depth, 1e-12)},
    {CASE(STIFF, "depth-1e-9", "optical depth 1e-9 a cell", SAME, build_depth, 1e-9)},
    {CASE(STIFF, "depth-1e-6", "optical depth 1e-6 a cell", SAME, build_depth, 1e-6)},
    {CASE(STIFF, "depth-1e-3", "optical depth 1e-3 a cell", SAME, build_depth, 1e-3)},
    {CASE(STIFF, "depth-1e0", "optical depth 1e0 a cell", SAME, build_depth, 1e0)},
    {CASE(STIFF, "depth-1e3", "optical depth 1e3 a cell", SAME, build_depth, 1e3), .limit = 5e-5,
     .reason = &DEPTHS_IN_FLOATS},
    {CASE(STIFF, "depth-1e6", "optical depth 1e6 a cell", SAME, build_depth, 1e6)},
    {CASE(STIFF, "depth-1e9", "optical depth 1e9 a cell", SAME, build_depth, 1e9)},
    {CASE(STIFF, "step", "a transfer function that jumps", SAME, build_step, 5)},
    {CASE(STIFF, "step-opaque", "a jump to an opaque surface", SAME, build_step, 1e6)},
    {CASE(STIFF, "spike-1e-3", "peaks of half-width 1e-3", SAME, build_spike, 1e-3), .limit = 1e-4,
     .reason = &FLANKS_IN_FLOATS},
    {CASE(STIFF, "spike-1e-6", "peaks of half-width 1e-6", SAME, build_spike, 1e-6),
     .fails = {[STABILITY_FACES] = &SCALARS_IN_FLOATS, [STABILITY_FAN] = &SCALARS_IN_FLOATS}},
    {CASE(STIFF, "spike-1e-9", "peaks of half-width 1e-9", SAME, build_spike, 1e-9),
     .fails = {[STABILITY_FACES] = &SCALARS_IN_FLOATS, [STABILITY_FAN] = &SCALARS_IN_FLOATS}},
    {CASE(STIFF, "comb", "80 knots, up and down", SAME, build_comb, 0)},
    {CASE(STIFF, "surfaces-1e-3", "opaque isosurfaces 1e-3 apart", SAME, build_close_surfaces, 1e-3)},
    {CASE(STIFF, "surfaces-1e-6", "opaque isosurfaces 1e-6 apart", "the nearer one everywhere", build_close_surfaces,
          1e-6)},
    {CASE(STIFF, "plateau-above", "an isosurface's value held by a region, less around it", "a surface at its rim",
          build_plateau, -1)},
    {CASE(STIFF, "plateau-below", "an isosurface's value held by a region, more around it", "no surface there",
          build_plateau, 1)},
    {CASE(STIFF, "scalars-1e-30", "scalars of 1e-30", SAME, build_scalar_scale, 1e-30)},
    {CASE(STIFF, "scalars-1e30", "scalars of 1e30", SAME, build_scalar_scale, 1e30)},
    {CASE(STIFF, "scalars-1e-300", "scalars of 1e-300", SAME, build_scalar_scale, 1e-300)},
    {CASE(STIFF, "scalars-1e300", "scalars of 1e300", SAME, build_scalar_scale, 1e300)},
    {CASE(STIFF, "scalars-offset-1e9", "a range of 1e-3 at 1e9", SAME, build_scalar_offset, 1e9)},
    {CASE(STIFF, "scalars-on-cells", "constant cells under a jump", SAME, build_cell_step, 0)},
    {CASE(STIFF, "scalar-constant", "one scalar, on a knot", SAME, build_constant_scalar, 0)},
    {CASE(STIFF, "scalar-nan", "a point without a number, one infinite", "their cells are not drawn", build_nan_scalar,
          0)},
    {CASE(STIFF, "hdr-1e4", "colours from 1e-4 to 1e4", SAME, build_hdr, 1e4)},
    {CASE(STIFF, "hdr-1e12", "colours from 1e-12 to 1e12", SAME, build_hdr, 1e12)},
    {CASE(STIFF, "grazing-light", "light across the gradients, to 1e-3", SAME, build_grazing_light, 1e-3)},
    {CASE(STIFF, "grazing-light-points", "the same, by gradients at points", SAME, build_grazing_light, -1e-3),
     .limit = 5e-4, .reason = &LIGHT_BY_SAMPLES},
    {CASE(STIFF, "grazing-surface", "a lit surface seen at 0.6 degrees", SAME, build_grazing_surface, 1e-2)},
    {CASE(STIFF, "absorption", "absorption alone, depth 1e3 a cell", SAME, build_model, CELLIST_MODEL_ABSORPTION),
     .limit = 5e-5, .reason = &DEPTHS_IN_FLOATS},
    {CASE(STIFF, "emission", "emission alone, depth 1e3 a cell", SAME, build_model, CELLIST_MODEL_EMISSION)},
    {CASE(STIFF, "maximum", "the largest scalar on each ray", SAME, build_model, CELLIST_MODEL_MAXIMUM)},
    {CASE(SHAPE, "dihedral-1e-3", "a grid pressed to dihedral angles of 1e-3", SAME, build_flat_cells, 1e-3),
     .limit = 2e-4, .reason = &DEPTHS_IN_FLOATS},
    {CASE(SHAPE, "dihedral-1e-6", "a grid pressed to dihedral angles of 1e-6", SAME, build_flat_cells, 1e-6),
     .limit = 2e-4, .reason = &DEPTHS_IN_FLOATS},
    {CASE(SHAPE, "dihedral-1e-10", "a grid pressed to dihedral angles of 1e-10", SAME, build_flat_cells, 1e-10),
     .limit = 2e-4, .reason = &DEPTHS_IN_FLOATS},
    {CASE(SHAPE, "cap-1e-3", "a point 1e-3 over a face", SAME, build_cap, 1e-3)},
    {CASE(SHAPE, "cap-1e-6", "a point 1e-6 over a face", SAME, build_cap, 1e-6)},
    {CASE(SHAPE, "cap-1e-10", "a point 1e-10 over a face", SAME, build_cap, 1e-10)},
    {CASE(SHAPE, "wedge-1e-3", "a point 1e-3 beside an edge", SAME, build_wedge, 1e-3)},
    {CASE(SHAPE, "wedge-1e-6", "a point 1e-6 beside an edge", SAME, build_wedge, 1e-6)},
    {CASE(SHAPE, "wedge-1e-10", "a point 1e-10 beside an edge", SAME, build_wedge, 1e-10)},
    {CASE(SHAPE, "needle-1e-3", "a point 1e-3 beside a vertex", SAME, build_needle, 1e-3)},
    {CASE(SHAPE, "needle-1e-6", "a point 1e-6 beside a vertex", SAME, build_needle, 1e-6)},
    {CASE(SHAPE, "needle-1e-10", "a point 1e-10 beside a vertex", SAME, build_needle, 1e-10)},
    {CASE(SHAPE, "zero-volume", "flat tets on a side, turning its diagonals", SAME, build_zero_volume, 0)},
    {CASE(SHAPE, "inverted", "every third tet inside out", "re-oriented, then the reference's picture", build_inverted,
          0)},
    {CASE(SHAPE, "duplicate-cells", "cells given twice", "finite, the overlap counted", build_duplicate_cells, 0),
     .expectation = STABILITY_FINITE},
    {CASE(SHAPE, "coincident-points", "halves with points of their own on the seam", SAME, build_seam, 0)},
    {CASE(SHAPE, "gap-1e-12", "halves 1e-12 apart", SAME, build_seam, 1e-12)},
    {CASE(SHAPE, "overlap-1e-3", "halves that overlap by 1e-3", "finite, the overlap counted", build_seam, -1e-3),
     .expectation = STABILITY_FINITE},
    {CASE(SHAPE, "crushed", "a grid whose upper half is pressed through the lower", "finite, the overlap counted",
          build_crushed, 0),
     .expectation = STABILITY_FINITE},
    {CASE(SHAPE, "flaws", "each flaw that validation names", "finite, the overlap counted", build_flaws, 0),
     .expectation = STABILITY_FINITE},
    {CASE(SHAPE, "one-cell", "one cell", SAME, build_one_cell, 0)},
    {CASE(SHAPE, "no-cell", "no cell", "an empty picture", build_no_cell, 0), .expectation = STABILITY_EMPTY},
    {CASE(SHAPE, "flat-hull", "every point in one plane", "an empty picture", build_flat_hull, 0),
     .expectation = STABILITY_EMPTY},
    {CASE(SHAPE, "wheel-3", "3 sticks that lie on each other in a circle", "one group of them; the reference's picture",
          build_wheel, 3)},
    {CASE(SHAPE, "wheel-10", "10 sticks that lie on each other in a circle",
          "one group of them; the reference's picture", build_wheel, 10)},
    {CASE(SHAPE, "wheel-30", "30 sticks that lie on each other in a circle",
          "one group of them; the reference's picture", build_wheel, 30)},
    {CASE(SHAPE, "wheel-100", "100 sticks that lie on each other in a circle",
          "one group of them; the reference's picture", build_wheel, 100)},
    {CASE(SHAPE, "wheel-300", "300 sticks that lie on each other in a circle",
          "one group of them; the reference's picture", build_wheel, 300),
     .limit = 2e-4, .reason = &DEPTHS_IN_FLOATS},
    {CASE(FRAME, "offset-1e7", "1e7 sizes from the origin", SAME, build_offset, 1e7)},
    {CASE(FRAME, "offset-1e9", "1e9 sizes from the origin", SAME, build_offset, 1e9)},
    {CASE(FRAME, "offset-1e12", "1e12 sizes from the origin", SAME, build_offset, 1e12)},
    {CASE(FRAME, "scale-1e-20", "a mesh 1e-20 units large", SAME, build_scale, 1e-20)},
    {CASE(FRAME, "scale-1e20", "a mesh 1e20 units large", SAME, build_scale, 1e20)},
    {CASE(FRAME, "scale-1e-100", "a mesh 1e-100 units large", SAME, build_scale, 1e-100)},
    {CASE(FRAME, "scale-1e100", "a mesh 1e100 units large", SAME, build_scale, 1e100)},
    {CASE(FRAME, "aspect-across", "cells 1e6 times longer than thick, from the side", SAME, build_aspect_across, 1e6)},
    {CASE(FRAME, "aspect-along", "the same, along them", SAME, build_aspect_along, 1e6)},
    {CASE(VIEW, "eye-on-vertex", "the eye on a vertex", SAME, build_eye_on_vertex, 0)},
    {CASE(VIEW, "eye-on-edge", "the eye on an edge", SAME, build_eye_on_edge, 0)},
    {CASE(VIEW, "eye-in-face-plane", "the eye in the plane of inner faces", SAME, build_eye_in_face_plane, 2)},
    {CASE(VIEW, "eye-in-boundary-plane", "the eye in the plane of boundary faces", SAME, build_eye_in_face_plane, 0)},
    {CASE(VIEW, "eye-before-face", "the eye 1e-12 before a face, looking through it", SAME, build_eye_near_face,
          1e-12)},
    {CASE(VIEW, "eye-behind-face", "the eye 1e-12 behind a face", SAME, build_eye_near_face, -1e-12)},
    {CASE(VIEW, "eye-in-cell", "the eye inside a cell", SAME, build_eye_in_cell, 0)},
    {CASE(VIEW, "eye-in-cavity", "the eye inside a cavity", SAME, build_eye_in_cavity, 0)},
    {CASE(VIEW, "eye-far", "the eye 1e6 sizes away", SAME, build_eye_far, 4e6)},
    {CASE(VIEW, "along-faces", "a parallel view along faces", SAME, build_along_faces, 40)},
    {CASE(VIEW, "rays-in-faces", "a parallel view with rays in faces and edges",
          "each such ray counts one of the cells", build_rays_in_faces, 41)},
    {CASE(VIEW, "fovy-0.01", "0.01 degrees", SAME, build_narrow, 0.01)},
    {CASE(VIEW, "fovy-179", "179 degrees, from inside", SAME, build_wide, 179), .limit = 2e-4, .reason = &WIDE_VIEW},
    {CASE(VIEW, "near-plane", "the near plane through cells", SAME, build_near_plane, 0.98)},
    {CASE(VIEW, "near-plane-parallel", "the same in a parallel view", SAME, build_near_parallel, 1.01)},
    {CASE(VIEW, "image-1x1", "one pixel", SAME, build_image_size, 1)},
    {CASE(VIEW, "image-16384x1", "16384x1 pixels", SAME, build_image_size, 16384)},
    {CASE(VIEW, "image-1x16384", "1x16384 pixels", SAME, build_tall_image, 16384)},
};
enum { CASE_COUNT = sizeof CASES / sizeof CASES[0] };

const stability_case *stability_case_at(size_t i) { return i < CASE_COUNT ? &CASES[i] : NULL; }

const char *stability_group_name(stability_group group) {
  static const char *const names[] = {"stiff", "shape", "frame", "view"};
  return names[group];
}

const char *stability_renderer_name(stability_renderer renderer) {
  static const char *const names[] = {"cast", "soft", "faces", "fan"};
  return names[renderer];
}

const char *stability_verdict_name(stability_verdict verdict) {
  static const char *const names[] = {"passes", "known", "refused", "fails"};
  return names[verdict];
}
