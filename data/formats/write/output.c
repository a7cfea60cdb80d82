/* SPDX-License-Identifier: BSD-3-Clause
 * Output: files under a temporary name until they are whole; arrays in the user's order. */
#include "output.h"

#include <cellist/radix.h>
#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static cellist_result fail_io(cellist_context *context, const char *path, int reason) {
  char text[128] = "";
  if (strerror_r(reason, text, sizeof text) != 0) text[0] = '\0';
  return cellist_fail(context, CELLIST_ERROR_IO, "%s: cannot be written: %s", path, text);
}

cellist_result output_open(cellist_context *context, const char *path, struct output *output) {
  *output = (struct output){.context = context, .path = path};
  if (strcmp(path, "-") == 0) {
    output->file = stdout;
    return CELLIST_SUCCESS;
  }
  struct stat status;
  const bool is_device = stat(path, &status) == 0 && !S_ISREG(status.st_mode);
  if (!is_device) {
    const size_t room = strlen(path) + 32;
    output->partial = cellist_allocate(context, room, 1);
    if (output->partial == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
    snprintf(output->partial, room, "%s.%ld.part", path, (long)getpid());
  }
  output->file = fopen(is_device ? path : output->partial, "wb");
  if (output->file != NULL) return CELLIST_SUCCESS;
  const cellist_result result = fail_io(context, path, errno);
  cellist_deallocate(context, output->partial);
  return result;
}

void output_write(struct output *output, const void *bytes, size_t size) {
  if (size > 0) fwrite(bytes, 1, size, output->file); /* the stream remembers a failure */
}

void output_print(struct output *output, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vfprintf(output->file, format, arguments);
  va_end(arguments);
}

cellist_result output_finish(struct output *output, cellist_result result) {
  errno = 0;
  bool ok = fflush(output->file) == 0 && !ferror(output->file);
  int reason = errno;
  if (output->file != stdout && fclose(output->file) != 0 && ok) {
    ok = false;
    reason = errno;
  }
  if (ok && result == CELLIST_SUCCESS && output->partial != NULL && rename(output->partial, output->path) != 0) {
    ok = false;
    reason = errno;
  }
  if (result == CELLIST_SUCCESS && !ok) result = fail_io(output->context, output->path, reason != 0 ? reason : EIO);
  if (result != CELLIST_SUCCESS && output->partial != NULL) unlink(output->partial);
  cellist_deallocate(output->context, output->partial);
  return result;
}

/* Indices by rising key, ties by index. */
static cellist_result order_by(cellist_context *context, const uint32_t *keys, size_t count, uint32_t **order) {
  uint64_t *wide = cellist_allocate(context, count, sizeof *wide);
  uint64_t *scratch_wide = cellist_allocate(context, count, sizeof *scratch_wide);
  uint32_t *scratch = cellist_allocate(context, count, sizeof *scratch);
  *order = cellist_allocate(context, count, sizeof **order);
  const bool ok = wide != NULL && scratch_wide != NULL && scratch != NULL && *order != NULL;
  for (size_t i = 0; i < count && ok; i++) {
    wide[i] = keys[i];
    (*order)[i] = (uint32_t)i;
  }
  if (ok) cellist_radix_sort(wide, *order, count, scratch_wide, scratch, 32);
  cellist_deallocate(context, wide);
  cellist_deallocate(context, scratch_wide);
  cellist_deallocate(context, scratch);
  return ok ? CELLIST_SUCCESS : CELLIST_ERROR_OUT_OF_MEMORY;
}

cellist_result output_order_make(cellist_context *context, const cellist_mesh_arrays *arrays,
                                 struct output_order *order) {
  *order = (struct output_order){0};
  cellist_result result = order_by(context, arrays->point_origin, arrays->point_count, &order->points);
  if (result == CELLIST_SUCCESS) result = order_by(context, arrays->tet_origin, arrays->tet_count, &order->tets);
  if (result != CELLIST_SUCCESS) return result;
  order->point_place = cellist_allocate(context, arrays->point_count, sizeof *order->point_place);
  if (order->point_place == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  for (size_t i = 0; i < arrays->point_count; i++) order->point_place[order->points[i]] = (uint32_t)i;
  return CELLIST_SUCCESS;
}

void output_order_release(cellist_context *context, struct output_order *order) {
  cellist_deallocate(context, order->points);
  cellist_deallocate(context, order->tets);
  cellist_deallocate(context, order->point_place);
  *order = (struct output_order){0};
}

void output_store(uint8_t *bytes, uint64_t value, size_t size, bool big_endian) {
  for (size_t i = 0; i < size; i++) bytes[i] = (uint8_t)(value >> 8 * (big_endian ? size - 1 - i : i));
}

/* NaN counts as a float: its payload is no value. */
static bool fits_float(double value) {
  if (value != value) return true;
  if (!(value >= -3.4028234663852886e38 && value <= 3.4028234663852886e38)) return value - value != value - value;
  return (double)(float)value == value;
}

cellist_result output_values_make(cellist_context *context, const double *values, size_t component_count,
                                  const uint32_t *order, size_t count, bool big_endian, struct output_values *made) {
  *made = (struct output_values){.is_float32 = true, .count = count * component_count};
  for (size_t i = 0; i < made->count && made->is_float32; i++) made->is_float32 = fits_float(values[i]);
  const size_t each = made->is_float32 ? sizeof(float) : sizeof(double);
  made->size = made->count * each;
  made->bytes = cellist_allocate(context, made->count, each);
  if (made->bytes == NULL) return CELLIST_ERROR_OUT_OF_MEMORY;
  uint8_t *to = made->bytes;
  for (size_t i = 0; i < count; i++)
    for (size_t c = 0; c < component_count; c++, to += each) {
      const double value = values[(size_t)order[i] * component_count + c];
      uint64_t bits = 0;
      if (made->is_float32) {
        const float narrow = (float)value;
        uint32_t narrow_bits;
        memcpy(&narrow_bits, &narrow, sizeof narrow_bits);
        bits = narrow_bits;
      } else {
        memcpy(&bits, &value, sizeof bits);
      }
      output_store(to, bits, each, big_endian);
    }
  return CELLIST_SUCCESS;
}

cellist_result cellist_mesh_write(cellist_context *context, const cellist_mesh *mesh, const char *path,
                                  const cellist_mesh_write_desc *desc) {
  if (context == NULL) return CELLIST_ERROR_INVALID_ARGUMENT;
  if (mesh == NULL || path == NULL)
    return cellist_fail(context, CELLIST_ERROR_INVALID_ARGUMENT, "cellist_mesh_write: mesh or path is NULL");
  const size_t length = strlen(path);
  cellist_mesh_format format = desc != NULL ? desc->format : CELLIST_MESH_FORMAT_BY_NAME;
  if (format == CELLIST_MESH_FORMAT_BY_NAME)
    format = length >= 4 && strcmp(path + length - 4, ".vtk") == 0 ? CELLIST_MESH_FORMAT_VTK : CELLIST_MESH_FORMAT_VTU;
  struct output output;
  cellist_result result = output_open(context, path, &output);
  if (result != CELLIST_SUCCESS) return result;
  result = format == CELLIST_MESH_FORMAT_VTK ? write_vtk(&output, mesh) : write_vtu(&output, mesh);
  return output_finish(&output, result);
}
