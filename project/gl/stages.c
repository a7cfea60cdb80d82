/* SPDX-License-Identifier: BSD-3-Clause
 * Stages: which texts a program is put together from, and what it is told once a frame. */
#include <stdio.h>

#include "program.h"
#include "renderer.h"

extern const char cellist_text_faces_vert[], cellist_text_everywhere_vert[], cellist_text_segment_glsl[],
    cellist_text_cell_glsl[], cellist_text_fan_vert[], cellist_text_fan_glsl[], cellist_text_handed_glsl[],
    cellist_text_hand_on_glsl[], cellist_text_faces_frag[], cellist_text_small_groups_frag[],
    cellist_text_list_nodes_glsl[], cellist_text_list_frag[], cellist_text_list_resolve_frag[],
    cellist_text_layer_frag[], cellist_text_layer_resolve_frag[];

static cellist_result build(cellist_gl *gl, gl_stage stage, gl_integrator integrator, unsigned variant,
                            GLuint *program) {
  static const struct {
    const char *nodes, *main;
  } stages[GL_STAGE_COUNT] = {
      [GL_STAGE_BLEND] = {NULL, cellist_text_faces_frag},
      [GL_STAGE_FAN] = {NULL, cellist_text_faces_frag},
      [GL_STAGE_SMALL_GROUP] = {NULL, cellist_text_small_groups_frag},
      [GL_STAGE_LIST] = {cellist_text_list_nodes_glsl, cellist_text_list_frag},
      [GL_STAGE_LIST_RESOLVE] = {cellist_text_list_nodes_glsl, cellist_text_list_resolve_frag},
      [GL_STAGE_LAYER] = {NULL, cellist_text_layer_frag},
      [GL_STAGE_LAYER_RESOLVE] = {NULL, cellist_text_layer_resolve_frag},
  };
  const bool of_pixels = stage == GL_STAGE_LIST_RESOLVE || stage == GL_STAGE_LAYER_RESOLVE;
  const bool of_fans = stage == GL_STAGE_FAN;
  const char *const of_corners[] = {"#define HANDED flat out\n", cellist_text_handed_glsl, cellist_text_hand_on_glsl,
                                    of_fans ? cellist_text_fan_vert : cellist_text_faces_vert, NULL};
  const char *const everywhere[] = {cellist_text_everywhere_vert, NULL};
  const char *fragment[GL_INTEGRATOR_TEXTS + 6], *before = "";
  size_t count = 0;
  if (stages[stage].nodes != NULL) fragment[count++] = stages[stage].nodes;
  if (!of_pixels) {
    fragment[count++] = "#define HANDED flat in\n";
    fragment[count++] = cellist_text_handed_glsl;
    before = gl_integrator_texts(integrator, variant & GL_VARIANT_LIT, &fragment[count]);
    while (fragment[count] != NULL) count++;
    fragment[count++] = cellist_text_segment_glsl;
    fragment[count++] = of_fans ? cellist_text_fan_glsl : cellist_text_cell_glsl;
  }
  fragment[count++] = stages[stage].main;
  fragment[count] = NULL;
  static const char *const names[] = {"#define PARALLEL\n",  "#define WITH_DEPTH\n",  "",
                                      "#define LIT_CELLS\n", "#define WITH_LIMITS\n", "#define PLAIN\n",
                                      "#define LITTLE\n",    "#define STEPS\n",       "#define FEW\n"};
  char defines[512];
  size_t length = (size_t)snprintf(defines, sizeof defines, "%s", before);
  for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++)
    if (variant & 1u << i) length += (size_t)snprintf(defines + length, sizeof defines - length, "%s", names[i]);
  return gl_program_build(gl->context, &gl->api, stages[stage].nodes != NULL ? 430 : 410, defines,
                          of_pixels ? everywhere : of_corners, fragment, program);
}

static void set_light(const gl_drawing *drawing, GLuint program) {
  const gl_api *api = &drawing->gl->api;
  const gl_light *light = &drawing->cells.light;
  const uint32_t sample_count = drawing->settings->optics.sample_count;
  const double *l = light->towards, *h = light->halfway;
  api->Uniform1i(api->GetUniformLocation(program, "samples"), sample_count > 0 ? (GLint)sample_count : 1);
  api->Uniform3f(api->GetUniformLocation(program, "towards"), (float)l[0], (float)l[1], (float)l[2]);
  api->Uniform3f(api->GetUniformLocation(program, "halfway"), (float)h[0], (float)h[1], (float)h[2]);
  api->Uniform4f(api->GetUniformLocation(program, "shares"), (float)light->light.ambient, (float)light->light.diffuse,
                 (float)light->light.specular, (float)light->light.shininess);
}

/* A program keeps its uniforms; those of this frame are set when it is first used in it. Names that a program does not
 * have are at -1, which OpenGL overlooks. */
static void set_uniforms(const gl_drawing *drawing, gl_integrator integrator, GLuint program) {
  static const struct {
    const char *name;
    GLint unit;
  } samplers[] = {{"records", GL_UNIT_RECORDS},       {"intervals", GL_UNIT_INTERVALS},
                  {"extras", GL_UNIT_EXTRAS},         {"lights", GL_UNIT_LIGHTS},
                  {"last_layer", GL_UNIT_LAST_LAYER}, {"layer_colour", GL_UNIT_LAYER_COLOUR},
                  {"limits", GL_UNIT_LIMITS}};
  const gl_api *api = &drawing->gl->api;
  const cellist_frame *frame = drawing->frame;
  for (size_t i = 0; i < sizeof samplers / sizeof samplers[0]; i++)
    api->Uniform1i(api->GetUniformLocation(program, samplers[i].name), samplers[i].unit);
  api->Uniform1f(api->GetUniformLocation(program, "near_distance"), (float)drawing->cells.frame.near_distance);
  api->Uniform1f(api->GetUniformLocation(program, "subpixel"), (float)drawing->gl->subpixel);
  api->Uniform2f(api->GetUniformLocation(program, "centre"), 0.5f * (float)frame->width, 0.5f * (float)frame->height);
  api->Uniform2f(api->GetUniformLocation(program, "slope"), (float)(2 * frame->half_width / frame->width),
                 (float)(2 * frame->half_height / frame->height));
  api->Uniform1i(api->GetUniformLocation(program, "width"), (GLint)frame->width);
  if (drawing->cells.light.gradients != NULL) set_light(drawing, program);
  gl_tables_bind(api, &drawing->gl->tables, integrator, drawing->cells.unit, program, GL_UNIT_TABLES);
}

static unsigned variant_of(const gl_drawing *drawing, gl_stage stage, gl_integrator integrator, gl_need need) {
  const gl_light *light = &drawing->cells.light;
  unsigned variant = (drawing->frame->parallel ? GL_VARIANT_PARALLEL : 0) |
                     (drawing->with_depth ? GL_VARIANT_DEPTH : 0) | (drawing->with_limits ? GL_VARIANT_LIMITS : 0);
  if (light->gradients != NULL)
    variant |= GL_VARIANT_LIT;
  else if (light->enabled)
    variant |= GL_VARIANT_LIT_CELLS;
  if ((stage != GL_STAGE_BLEND && stage != GL_STAGE_FAN) || need == GL_NEED_ANYTHING) return variant;
  variant |= GL_VARIANT_PLAIN;
  if (integrator != GL_INTEGRATOR_EXACT || light->gradients != NULL || need > GL_NEED_FEW) return variant;
  if (need == GL_NEED_FEW) return variant | GL_VARIANT_FEW;
  return variant | GL_VARIANT_LITTLE | (need == GL_NEED_STEPS ? GL_VARIANT_STEPS : 0);
}

cellist_result gl_use_stage(gl_drawing *drawing, gl_stage stage, gl_need need) {
  cellist_gl *gl = drawing->gl;
  const gl_integrator integrator = gl_integrator_of(&drawing->settings->optics);
  const unsigned variant = variant_of(drawing, stage, integrator, need);
  gl_program *program = &gl->programs[stage][integrator][variant];
  if (program->name == 0) {
    const cellist_result result = build(gl, stage, integrator, variant, &program->name);
    if (result != CELLIST_SUCCESS) return result;
  }
  if (drawing->program != program->name) gl->api.UseProgram(program->name);
  drawing->program = program->name;
  if (program->frame != gl->frame_count) set_uniforms(drawing, integrator, program->name);
  program->frame = gl->frame_count;
  return CELLIST_SUCCESS;
}
