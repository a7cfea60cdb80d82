/* SPDX-License-Identifier: BSD-3-Clause
 * Scene: mesh, view and optics of one stability case, put together by straight code. Private to tools/stability/.
 *
 * Errors stick: after the first one all calls do nothing, and scene_finish reports it. */
#ifndef CELLIST_TOOLS_STABILITY_SCENE_H
#define CELLIST_TOOLS_STABILITY_SCENE_H

#include "stability.h"

/* The new point's id. value: its scalar. */
uint32_t scene_point(stability_scene *scene, double x, double y, double z, double value);
void scene_tet(stability_scene *scene, uint32_t a, uint32_t b, uint32_t c, uint32_t d);

/* n[0] x n[1] x n[2] unit cubes from the origin, six tets each (Kuhn), points moved by up to `jitter` along each axis,
 * with a scalar in 0..1 that is half a wave and half noise. `without`: the id of a cube to leave out, or CELLIST_NONE;
 * cube ids run along x, then y, then z. */
void scene_grid(stability_scene *scene, const uint32_t n[3], double jitter, uint32_t without);

/* Moves every point p to offset + scale * p, axis by axis. */
void scene_place(stability_scene *scene, const double scale[3], const double offset[3]);

/* A generated mesh instead of points and tets. */
void scene_generate(stability_scene *scene, const char *name, const cellist_generate_desc *desc);

/* Four knots within low..high, extinction up to `extinction` per unit length, each of its own colour. */
void scene_ramp(stability_scene *scene, double low, double high, double extinction);
void scene_knot(stability_scene *scene, double value, double extinction, double r, double g, double b);

/* The whole of the points or of the generated mesh from that direction, in degrees. */
void scene_look(stability_scene *scene, double azimuth, double elevation);
void scene_eye(stability_scene *scene, double x, double y, double z);
void scene_target(stability_scene *scene, double x, double y, double z);

/* Makes the mesh. Errors: those of making it. */
cellist_result scene_finish(stability_scene *scene);

/* The builders that cases name. */
void build_depth(stability_scene *scene, double depth);
void build_step(stability_scene *scene, double extinction);
void build_spike(stability_scene *scene, double half_width);
void build_comb(stability_scene *scene, double unused);
void build_close_surfaces(stability_scene *scene, double apart);
void build_plateau(stability_scene *scene, double sign);
void build_scalar_scale(stability_scene *scene, double scale);
void build_scalar_offset(stability_scene *scene, double offset);
void build_cell_step(stability_scene *scene, double unused);
void build_constant_scalar(stability_scene *scene, double unused);
void build_nan_scalar(stability_scene *scene, double unused);
void build_hdr(stability_scene *scene, double brightest);
void build_grazing_light(stability_scene *scene, double sine);
void build_grazing_surface(stability_scene *scene, double sine);
void build_model(stability_scene *scene, double model);
void build_flat_cells(stability_scene *scene, double thickness);
void build_cap(stability_scene *scene, double height);
void build_wedge(stability_scene *scene, double distance);
void build_needle(stability_scene *scene, double distance);
void build_zero_volume(stability_scene *scene, double unused);
void build_inverted(stability_scene *scene, double unused);
void build_duplicate_cells(stability_scene *scene, double unused);
void build_seam(stability_scene *scene, double gap);
void build_crushed(stability_scene *scene, double unused);
void build_flaws(stability_scene *scene, double unused);
void build_one_cell(stability_scene *scene, double unused);
void build_no_cell(stability_scene *scene, double unused);
void build_flat_hull(stability_scene *scene, double unused);
void build_wheel(stability_scene *scene, double sticks);
void build_offset(stability_scene *scene, double offset);
void build_scale(stability_scene *scene, double scale);
void build_aspect_across(stability_scene *scene, double aspect);
void build_aspect_along(stability_scene *scene, double aspect);
void build_eye_on_vertex(stability_scene *scene, double unused);
void build_eye_on_edge(stability_scene *scene, double unused);
void build_eye_in_face_plane(stability_scene *scene, double unused);
void build_eye_near_face(stability_scene *scene, double distance);
void build_eye_in_cell(stability_scene *scene, double unused);
void build_eye_in_cavity(stability_scene *scene, double unused);
void build_eye_far(stability_scene *scene, double distance);
void build_along_faces(stability_scene *scene, double columns);
void build_rays_in_faces(stability_scene *scene, double columns);
void build_narrow(stability_scene *scene, double degrees);
void build_wide(stability_scene *scene, double degrees);
void build_near_plane(stability_scene *scene, double depth);
void build_near_parallel(stability_scene *scene, double depth);
void build_image_size(stability_scene *scene, double width);
void build_tall_image(stability_scene *scene, double height);

#endif
