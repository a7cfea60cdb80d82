/* SPDX-License-Identifier: BSD-3-Clause
 * What a renderer holds, what one call to render works on, and the steps that share them. Private. */
#ifndef CELLIST_GL_RENDERER_H
#define CELLIST_GL_RENDERER_H

#include <cellist/gl.h>

#include "cells.h"
#include "context.h"
#include "integrators.h"
#include "limits.h"
#include "surface.h"
#include "target.h"

/* What a program does with a fragment of a cell (or, to resolve, with a pixel). */
typedef enum gl_stage {
  GL_STAGE_BLEND,         /* blends it over what is behind it */
  GL_STAGE_FAN,           /* the same, of fans */
  GL_STAGE_SMALL_GROUP,   /* composites the whole small group */
  GL_STAGE_LIST,          /* appends it to its pixel's list */
  GL_STAGE_LIST_RESOLVE,  /* blends the lists */
  GL_STAGE_LAYER,         /* keeps the farthest before the last layer */
  GL_STAGE_LAYER_RESOLVE, /* blends the layer */
  GL_STAGE_COUNT
} gl_stage;

/* Members of a small group, at most: each fragment then looks at all of them. As MOST in small_groups.frag. */
enum { GL_SMALL_GROUP = 16 };

/* What a program is made for: of the frame, then of what is drawn by one call. */
enum {
  GL_VARIANT_PARALLEL = 1,
  GL_VARIANT_DEPTH = 2,
  GL_VARIANT_LIT = 4, /* by gradients at points */
  GL_VARIANT_LIT_CELLS = 8,
  GL_VARIANT_LIMITS = 16,
  GL_VARIANT_PLAIN = 32,  /* nothing needs GL_NEED_ANYTHING */
  GL_VARIANT_LITTLE = 64, /* nor GL_NEED_DEPTH */
  GL_VARIANT_STEPS = 128, /* with LITTLE: something needs GL_NEED_STEPS */
  GL_VARIANT_FEW = 256,   /* nothing needs GL_NEED_DEPTH, something GL_NEED_FEW */
  GL_VARIANT_COUNT = 512
};

/* A program keeps its uniforms: name 0: not built yet. */
typedef struct gl_program {
  GLuint name;
  uint64_t frame; /* whose uniforms it has */
} gl_program;

/* A buffer that every batch writes anew. It keeps its memory: to get other memory from the system, empty, costs
 * software OpenGL as much as to write it. */
typedef struct gl_stream {
  GLuint buffer;
  size_t bytes; /* that it has */
} gl_stream;

/* Cells that are prepared and sent together: up to 296 bytes each then stay below 10 MB. */
enum { GL_CHUNK_CELLS = 32768 };

/* Memory of per-pixel lists, OpenGL 4.3: see list_nodes.glsl. */
typedef struct gl_lists {
  GLuint nodes, heads; /* buffers */
  size_t capacity;     /* in nodes */
  uint32_t width, height;
} gl_lists;

/* Textures of layers: see layer.frag. */
typedef struct gl_layers {
  GLuint framebuffers[2], colour, placed[2], depth;
  uint32_t width, height;
} gl_layers;

struct cellist_gl {
  cellist_context *context;
  const gl_backend *backend;
  void *state;
  gl_api api;
  char *device_name;
  bool has_lists;    /* OpenGL 4.3 */
  size_t list_bytes; /* as the descriptor's */
  size_t chunk_cells;
  double subpixel;    /* step of the grid that corners are moved to, in pixels */
  gl_cells_mesh mesh; /* arrays NULL: nothing uploaded */
  const cellist_mesh *source;
  const cellist_scalar *scalar;
  double *gradients; /* [3 points] once a frame was lit by them */
  gl_scale scale;
  gl_target target;
  gl_limits limits;
  gl_surface surface;
  uint64_t frame_count;
  gl_program programs[GL_STAGE_COUNT][GL_INTEGRATOR_COUNT][GL_VARIANT_COUNT];
  GLuint query, vertices, fan_vertices, no_vertices;
  gl_stream corners, fan_corners, records, lights;
  GLuint record_texture, light_texture;
  GLuint extra_buffer, extra_texture;
  GLuint interval_buffer, interval_texture;
  gl_tables tables;
  double longest;   /* edge of the mesh; negative: not known yet */
  gl_piece *pieces; /* [piece_capacity] */
  size_t piece_capacity;
  gl_run *runs;     /* [chunk_cells] */
  gl_extra *extras; /* [chunk_cells] */
  gl_lists lists;
  gl_layers layers;
};

/* One call to render. */
typedef struct gl_drawing {
  cellist_gl *gl;
  const cellist_frame *frame;
  const cellist_transfer *transfer;
  const cellist_gl_settings *settings;
  size_t order_count;
  bool with_depth, with_limits;
  surface_layer layer; /* behind the cells; {0}: nothing */
  gl_intervals intervals;
  gl_cells cells;
  GLuint program; /* in use */
  cellist_gl_stats stats;
} gl_drawing;

/* Texture units of the samplers. */
enum {
  GL_UNIT_RECORDS,
  GL_UNIT_INTERVALS,
  GL_UNIT_EXTRAS,
  GL_UNIT_LIGHTS,
  GL_UNIT_LAST_LAYER,
  GL_UNIT_LAYER_COLOUR,
  GL_UNIT_LIMITS,
  GL_UNIT_TABLES,                      /* up to three, see gl_tables_bind */
  GL_UNIT_SURFACE = GL_UNIT_TABLES + 3 /* five, see gl_surface_draw */
};

/* Makes the stage's program current, compiled when first used. need: of what it will draw. */
cellist_result gl_use_stage(gl_drawing *drawing, gl_stage stage, gl_need need);

/* Fails with the first error that OpenGL has recorded; what: was being done. */
cellist_result gl_check_errors(cellist_gl *gl, const char *what);

/* Prepares order[0..count) (at most gl->chunk_cells) with its small groups for a stage and sends it; group begins count
 * from order. */
cellist_result gl_batch_send(gl_drawing *drawing, gl_stage stage, const uint32_t *order, size_t count,
                             const cellist_gl_group *groups, size_t group_count, size_t *piece_count);
/* Draws what was sent: cells with the given stage (GL_STAGE_FAN: those that have no fan blended), small groups with
 * theirs. */
cellist_result gl_batch_draw(gl_drawing *drawing, size_t piece_count, gl_stage stage);

/* Whether a group's members are told apart by gl_batch_draw. */
bool gl_group_is_small(const gl_drawing *drawing, const cellist_gl_group *group);
/* Draws the members of one group, on each pixel in the order of their depths there. */
cellist_result gl_group_draw(gl_drawing *drawing, const uint32_t *members, size_t count);
void gl_groups_release(cellist_gl *gl);

#endif
