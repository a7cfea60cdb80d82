/* SPDX-License-Identifier: BSD-3-Clause
 * Soak scene: a random scene as the arguments of `cellist render`, and as what these arguments mean. The scene that is
 * drawn is read from the text by the command's own tables, so that the text repeats it. */
#ifndef CELLIST_TESTS_SOAK_SCENE_H
#define CELLIST_TESTS_SOAK_SCENE_H

#include <cellist/pipeline.h>
#include <mesh_options.h>
#include <optics_options.h>
#include <order_options.h>
#include <surface_options.h>
#include <view_options.h>

enum { SOAK_ARGUMENTS = 64, SOAK_TEXT = 2048 };

typedef struct soak_scene {
  /* The words after `cellist render`, without -o; the first one is the mesh. */
  char text[SOAK_TEXT];
  size_t text_length;
  int argument_count;
  char *arguments[SOAK_ARGUMENTS];
  /* What they mean. */
  cellist_pipeline_desc desc;
  cellist_isosurface isos[LIST_CAPACITY];
  surface_options surface_texts; /* desc refers to what stands from here to sorting: do not copy a scene */
  cellist_pipeline_surface surfaces[LIST_CAPACITY];
  order_options sorting;
  view_options camera;
  unsigned size[2], threads;
  bool is_flawed; /* cells overlap: no picture is right */
  bool is_along;  /* the view runs along faces */
} soak_scene;

/* Makes scene number `index` of a seed: the same for ever. */
void soak_scene_make(uint64_t seed, uint64_t index, soak_scene *scene);

/* Prints the three commands that repeat it. */
void soak_scene_print(const soak_scene *scene);

#endif
