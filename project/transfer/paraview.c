/* SPDX-License-Identifier: BSD-3-Clause
 * ParaView: transfer functions from JSON presets, as ParaView's colour map editor exports them. jansson parses; its
 * memory is malloc's, since its hooks are global. */
#include <jansson.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "transfer_private.h"

static cellist_result fail(cellist_context *context, const char *path, const char *reason) {
  return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: %s", path, reason);
}

/* Numbers of an array in groups of four, the first of each ascending. *numbers is the caller's. */
static cellist_result read_quadruples(cellist_context *context, const char *path, const json_t *array, const char *name,
                                      double **numbers, size_t *count) {
  const size_t size = json_array_size(array);
  if (!json_is_array(array) || size == 0 || size % 4 != 0)
    return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: \"%s\" is not a list of groups of four numbers", path,
                        name);
  double *read = cellist_allocate(context, size, sizeof *read);
  if (read == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  cellist_result result = CELLIST_SUCCESS;
  for (size_t i = 0; i < size && result == CELLIST_SUCCESS; i++) {
    const json_t *number = json_array_get(array, i);
    read[i] = json_number_value(number);
    if (!json_is_number(number) || !isfinite(read[i]))
      result = cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: entry %zu of \"%s\" is not a number", path, i, name);
    else if (i % 4 == 0 && i > 0 && read[i] < read[i - 4])
      result = cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: \"%s\" does not ascend at entry %zu", path, name, i);
  }
  if (result == CELLIST_SUCCESS) {
    *numbers = read;
    *count = size / 4;
  } else {
    cellist_deallocate(context, read);
  }
  return result;
}

static cellist_result read_space(cellist_context *context, const char *path, const json_t *preset,
                                 colour_space *space) {
  static const struct {
    const char *name;
    colour_space space;
  } names[] = {{"RGB", COLOUR_RGB},    {"HSV", COLOUR_HSV},   {"Lab", COLOUR_LAB},
               {"CIELAB", COLOUR_LAB}, {"Step", COLOUR_STEP}, {"Diverging", COLOUR_DIVERGING}};
  const json_t *value = json_object_get(preset, "ColorSpace");
  *space = COLOUR_RGB;
  if (value == NULL) return CELLIST_SUCCESS;
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
    if (json_is_string(value) && strcmp(json_string_value(value), names[i].name) == 0) {
      *space = names[i].space;
      return CELLIST_SUCCESS;
    }
  return cellist_fail(context, CELLIST_ERROR_UNSUPPORTED,
                      "%s: ColorSpace '%s' is not one of RGB HSV Lab Diverging Step", path,
                      json_is_string(value) ? json_string_value(value) : "?");
}

static cellist_result read_preset(cellist_context *context, const char *path, const json_t *root,
                                  transfer_curve *curve) {
  const json_t *preset = json_is_array(root) ? json_array_get(root, 0) : root;
  if (!json_is_object(preset)) return fail(context, path, "not a ParaView preset (an object, or a list of one)");
  const json_t *colours = json_object_get(preset, "RGBPoints"), *points = json_object_get(preset, "Points");
  if (colours == NULL) return fail(context, path, "a ParaView preset without \"RGBPoints\"");
  cellist_result result = read_space(context, path, preset, &curve->space);
  double *numbers = NULL;
  size_t count = 0;
  if (result == CELLIST_SUCCESS) result = read_quadruples(context, path, colours, "RGBPoints", &numbers, &count);
  if (result != CELLIST_SUCCESS) return result;
  curve->colours = cellist_allocate(context, count, sizeof *curve->colours);
  for (size_t i = 0; i < count && curve->colours != NULL; i++) {
    const double *n = &numbers[4 * i];
    curve->colours[curve->colour_count++] = (colour_node){n[0], {n[1], n[2], n[3]}};
    if (n[1] < 0 || n[2] < 0 || n[3] < 0) result = fail(context, path, "a colour in \"RGBPoints\" is negative");
  }
  cellist_deallocate(context, numbers);
  if (curve->colours == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  if (result != CELLIST_SUCCESS) return result;

  if (points == NULL) { /* a colour map alone: opacity rises as the built-in ramp's does */
    curve->opacities = cellist_allocate(context, 2, sizeof *curve->opacities);
    if (curve->opacities == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    curve->opacities[0] = (opacity_node){curve->colours[0].x, 0, 0.5, 0};
    curve->opacities[1] = (opacity_node){curve->colours[curve->colour_count - 1].x, 0.4, 0.5, 0};
    curve->opacity_count = 2;
    return CELLIST_SUCCESS;
  }
  result = read_quadruples(context, path, points, "Points", &numbers, &count);
  if (result != CELLIST_SUCCESS) return result;
  curve->opacities = cellist_allocate(context, count, sizeof *curve->opacities);
  for (size_t i = 0; i < count && curve->opacities != NULL; i++) {
    const double *n = &numbers[4 * i];
    curve->opacities[curve->opacity_count++] = (opacity_node){n[0], n[1], n[2], n[3]};
    if (!(n[1] >= 0 && n[1] <= 1)) result = fail(context, path, "an opacity in \"Points\" is not within 0..1");
    if (!(n[2] >= 0 && n[2] <= 1 && n[3] >= 0 && n[3] <= 1))
      result = fail(context, path, "a midpoint or sharpness in \"Points\" is not within 0..1");
  }
  cellist_deallocate(context, numbers);
  return curve->opacities != NULL ? result : CELLIST_ERROR_OUT_OF_MEMORY;
}

cellist_result transfer_read_paraview(cellist_context *context, const char *path, transfer_curve *curve) {
  if (access(path, F_OK) != 0)
    return cellist_fail(context, CELLIST_ERROR_NOT_FOUND, "'%s' is neither a built-in transfer function nor a file",
                        path);
  json_error_t error;
  json_t *root = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
  if (root == NULL) {
    if (json_error_code(&error) == json_error_cannot_open_file)
      return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be read", path);
    return cellist_fail(context, CELLIST_ERROR_FORMAT, "%s: line %d: not JSON: %s", path, error.line, error.text);
  }
  const cellist_result result = read_preset(context, path, root, curve);
  json_decref(root);
  return result;
}
