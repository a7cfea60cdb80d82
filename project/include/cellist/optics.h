/* SPDX-License-Identifier: BSD-3-Clause
 * Optics: what a picture shows of the scalar, the same for every renderer. The transfer function stands beside it. */
#ifndef CELLIST_OPTICS_H
#define CELLIST_OPTICS_H

#include <cellist/context.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a ray gathers. R G B are linear and premultiplied, A is 1 - transmittance; an image over a background b shows
 * colour + (1 - A) b. With extinction e(s) and colour c(s) from the transfer function, along the ray: */
typedef enum cellist_model {
  CELLIST_MODEL_EMISSION_ABSORPTION, /* integral of e c T, T = exp(- integral of e so far); A = 1 - T */
  CELLIST_MODEL_ABSORPTION,          /* black; A = 1 - T */
  CELLIST_MODEL_EMISSION,            /* integral of e c, nothing absorbed: A = 0 */
  CELLIST_MODEL_MAXIMUM,             /* c(largest scalar on the ray), A = 1; nothing where no drawn cell is met */
  CELLIST_MODEL_ISOSURFACES          /* surfaces s = iso value, front to back, each c(value) with its own opacity */
} cellist_model;

/* A surface of equal scalar. */
typedef struct cellist_isosurface {
  double value;
  double opacity; /* 0..1; 1 hides what is behind */
} cellist_isosurface;

/* Light from one direction on gradients G of the scalar, as in [C] section 8: the gradient is neither normalised nor
 * clamped, it is measured in gradient_unit; both sides of a surface are lit alike. A colour c becomes
 *   c (ambient + diffuse |G . L| / gradient_unit) + specular (|N . H|^shininess), N = G / |G|, H halfway between L and
 *   the way to the eye, both taken at the image's centre. Isosurfaces take N instead of G / gradient_unit. */
typedef struct cellist_light {
  bool enabled;
  double direction[3];  /* towards the light, in the mesh's frame; all 0: from the camera, against its forward axis */
  double ambient;       /* share of the colour without light */
  double diffuse;       /* share added where |G . L| is gradient_unit */
  double specular;      /* strength of the white highlight */
  double shininess;     /* its exponent, at least 1 where specular is not 0 */
  double gradient_unit; /* scalar per length that counts as 1, above 0 */
  bool cell_gradients;  /* one gradient a cell; false: least squares at points (over the edges that meet there, each
                           once, weight 1), linear inside a cell */
} cellist_light;

/* How a renderer through OpenGL integrates emission and absorption, and absorption alone, along a cell's segment. The
 * other models and the renderers on the processor are always exact. */
typedef enum cellist_integration {
  CELLIST_INTEGRATION_EXACT, /* split where the scalar crosses a knot, each piece as a series: errors of rounding */
  CELLIST_INTEGRATION_PSI,   /* split likewise, each piece by a table that holds for every transfer function */
  CELLIST_INTEGRATION_TABLE  /* one look-up in a table made for the transfer function (cellist/preintegration.h) */
} cellist_integration;

/* Nodes of tables along each scalar axis and along the length unless asked otherwise: more lengths change nothing. */
enum { CELLIST_TABLE_SCALARS = 128, CELLIST_TABLE_LENGTHS = 32 };

/* {0} is valid: emission and absorption, without light, exact. */
typedef struct cellist_optics {
  cellist_model model;
  size_t iso_count;
  const cellist_isosurface *isos; /* [iso_count], the caller's, in any order */
  cellist_light light;            /* for emission-absorption, emission and isosurfaces */
  uint32_t sample_count;          /* parts of a segment that are lit one by one by gradients at points, 1 to 4; 0: 1.
                                     The reference caster needs none */
  cellist_integration integration;
  uint32_t table_size[2]; /* of TABLE: nodes along each scalar axis and along the length; 0: those above */
} cellist_optics;

/* Checks what a caller made himself: a model that exists, at most four samples, finite isosurfaces with opacities of 0
 * to 1, and light whose numbers make sense where it is enabled.
 * Errors: INVALID_ARGUMENT (the message says what is wrong). Threads: one call per context at a time. Cost: linear in
 * isosurfaces. */
CELLIST_API cellist_result cellist_optics_check(cellist_context *context, const cellist_optics *optics);

/* The pixels that a renderer through OpenGL blends cells in. */
typedef enum cellist_framebuffer {
  CELLIST_FRAMEBUFFER_32F, /* four floats */
  CELLIST_FRAMEBUFFER_16F, /* four halves: each blend is rounded to 11 bits */
  CELLIST_FRAMEBUFFER_8    /* four bytes: faint cells vanish */
} cellist_framebuffer;

/* order[begin] to order[begin + count - 1] lie in front of each other in a circle: on every pixel they are composited
 * in the order of their depths there, which is exact as long as no two overlap. */
typedef struct cellist_gl_group {
  size_t begin, count;
} cellist_gl_group;

/* How groups are composited. The pictures differ by rounding. */
typedef enum cellist_gl_group_method {
  CELLIST_GL_GROUPS_AUTO,  /* up to 16 cells in one go; more: lists where OpenGL is 4.3 or later, else layers */
  CELLIST_GL_GROUPS_LISTS, /* always per-pixel lists; needs OpenGL 4.3 */
  CELLIST_GL_GROUPS_LAYERS /* always layer by layer from the far side (depth peeling): a pass a layer */
} cellist_gl_group_method;

#ifdef __cplusplus
}
#endif
#endif
